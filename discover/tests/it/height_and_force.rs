//! discover tests: height and specific force of one flight in one likelihood. In: made climbs of a rocket whose altimeter or drag is not as declared. Out:
//! which of the two is named, how much of it, and what nothing leaves.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt::Write as _;
use windfall_discover::close::{Closing, Options, Verdict, close};
use windfall_discover::tracks::TrackEvidence;
use windfall_model::effects::find;
use windfall_model::{Acts, Campaign, Data, Plant};
use windfall_scenarios::read_campaign;
use windfall_sim::fly_point_states;

const HEAD: &str = r#"
[campaign]
name = "climbs"
[vehicle]
mass_kg = 17.0
reference_diameter_m = 0.15
[axes]
down = "-Z"
[environment]
gravity_m_s2 = 9.80665
atmosphere = "us-1976"
launch_height_m = 500.0
[sensors]
position_std_m = 0.5
specific_force_std_m_s2 = 0.2
height = "pressure"
[columns]
fZ_m_s2 = { names = ["ax", "ay", "az"], along = [3.0, 0.0, 4.0] }
[aero.point_mass]
CD = { over = "mach", at = [0.0, 1.0], values = [0.4, 0.4] }
declared = []
"#;

/// Climbs read from files: declared as in [`HEAD`], flown with what `change` does to the declared plant; white noise of the stated sizes and an offset of the
/// accelerometer of its own in every run, whose case is turned.
fn climbs(name: &str, runs: u32, change: impl Fn(&mut Plant)) -> Campaign {
    let folder = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("the target folder can be written to");
    let mut text = HEAD.to_owned();
    for k in 0..runs {
        let _ = write!(text, "[[run]]\nfile = \"{k}.csv\"\nkind = \"coast\"\nuse = \"identify\"\n");
        let rows: String = (0..20).map(|i| format!("{},{},0,0,0\n", f64::from(i), f64::from(i))).collect();
        std::fs::write(folder.join(format!("{k}.csv")), format!("t_s,Z_m,ax,ay,az\n{rows}")).expect("writable");
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text).expect("writable");
    let mut truth = read_campaign(&path).expect("well-formed").plant;
    change(&mut truth);
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(11);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    for k in 0..runs {
        let t_s: Vec<f64> = (0..400).map(|i| 0.03 * f64::from(i)).collect();
        let (height, speed, offset) = (300.0 + 20.0 * draw(), 160.0 + 5.0 * draw(), 0.3 * draw());
        let flown = fly_point_states(&truth, &t_s, &[], [-height, 0.0, 0.0], [-speed, 0.0, 0.0]).expect("a climb");
        let mut rows = String::from("t_s,Z_m,ax,ay,az\n");
        for (t, s) in t_s.iter().zip(flown) {
            let seen = -s.position[0] + truth.altimeter_error_m(windfall_model::frames::Vec3::from_array(s.velocity));
            // Upward along the body; the sensor's axes are turned about y so that its x has three fifths of it.
            let up = -(s.acceleration[0] - 9.80665) + offset + 0.2 * draw();
            let _ = writeln!(rows, "{t},{},{},{},{}", seen + 0.5 * draw(), 0.6 * up, draw(), 0.8 * up);
        }
        std::fs::write(folder.join(format!("{k}.csv")), rows).expect("writable");
    }
    read_campaign(&path).expect("well-formed")
}

fn closed(c: &Campaign) -> Closing {
    let closing = close(c, &Options::default()).expect("closes");
    eprintln!("{:?} {:?}", closing.verdict, closing.residual_after.per_channel);
    for e in &closing.effects {
        eprintln!("  {} p {:.1e} rivals {:?} {:?}", e.family, e.p_value, e.rivals, e.parameters);
    }
    closing
}

/// The one family that is named, with its first number within three standard errors of what was planted.
fn named(c: &Campaign, family: &str, planted: f64) {
    let closing = closed(c);
    let all: Vec<&str> = closing.effects.iter().map(|e| e.family.as_str()).collect();
    assert_eq!(all, [family]);
    let p = &closing.effects[0].parameters[0];
    let std = p.std_error.expect("free");
    assert!((p.estimate - planted).abs() < 3.0 * std && std < 0.05 * planted, "{p:?}, planted {planted}");
    assert!(closing.effects[0].rivals.is_empty(), "{:?}", closing.effects[0].rivals);
}

/// The accelerometer says that there is no more drag, whatever the height looks like.
#[test]
fn recover_an_error_of_the_vents_and_no_drag() {
    named(&climbs("vents", 2, |p| p.point.pressure_coefficient = 0.05), "static-pressure", 0.05);
}

#[test]
fn recover_drag_and_no_error_of_the_vents() {
    named(&climbs("drag", 2, |p| (find("drag", Acts::Altimeter).expect("in the catalogue").apply)(p, &[0.2])), "drag", 0.2);
}

/// Two runs and six, where what each run has of its own is part of the covariance.
#[test]
fn recover_nothing_from_climbs_as_declared() {
    for runs in [2, 6] {
        let closing = closed(&climbs(&format!("nothing-{runs}"), runs, |_| {}));
        assert_eq!((closing.effects.len(), closing.verdict), (0, Verdict::Consistent), "{runs} runs");
        let channels: Vec<&str> = closing.residual.per_channel.iter().map(|c| c.channel.as_str()).collect();
        assert_eq!(channels, ["X", "fX"]);
        // What is stated, in the channels' own units; white noise known from half of 800 numbers or more.
        for (noise, stated) in closing.noise.iter().zip([0.5, 0.2]) {
            assert!((noise.learnt_std / stated - 1.0).abs() < 0.2 && (noise.declared_std - stated).abs() < 1e-12, "{noise:?}");
        }
    }
}

/// Neither a place nor an offset of the accelerometer shows, which are part of the initial state.
#[test]
fn law_residual_forgets_place_and_offset() {
    let mut c = climbs("offset", 1, |_| {});
    let all = [0];
    let evidence = |c: &Campaign| TrackEvidence::new(c, &all, &c.plant).expect("long enough");
    let z = evidence(&c).residual(&c.plant);
    let Data::Point(track) = &mut c.runs[0].data else { panic!("a track") };
    track.specific_force_m_s2[0].iter_mut().flatten().for_each(|x| *x += 5.0);
    let moved = evidence(&c).residual(&c.plant);
    // Rounding of bases found twice, over noise of one.
    assert!(z.iter().zip(&moved).all(|(a, b)| (a - b).abs() < 1e-6));
    // Of 200 groups of 2 samples in two channels three numbers are the state's, and one order of the forces is left out.
    let scale: f64 = z.iter().map(|x| x * x).sum::<f64>() / evidence(&c).samples() as f64;
    // White noise of a mean of two samples: half of one.
    assert!((scale * 2.0 - 1.0).abs() < 0.3, "{scale}");
}
