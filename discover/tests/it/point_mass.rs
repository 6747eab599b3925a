//! discover tests: point-mass evidence on flights with a planted effect and on measured sets. In: simulated and shared tracks.
//! Out: families, held-out position errors.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::io::Write as _;
use std::path::PathBuf;
use windfall_discover::close::{Options, Verdict, close, p_value};
use windfall_discover::tracks::{EffectInstance, Free, Problem, TrackEvidence, TrackFit, TrackModel};
use windfall_model::effects::find;
use windfall_model::{Acts, CATALOGUE, Campaign, Data, Knowledge, Plant, PointRecord, Run, Use};
use windfall_scenarios::read_campaign;
use windfall_sim::fly_point;

fn measured(test: &str, file: &str) -> Option<Campaign> {
    let root = std::env::var_os("WINDFALL_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join("data/measured").join(file);
    if !path.is_file() {
        // Past the harness, which keeps to itself what a passing test prints.
        let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
        return None;
    }
    Some(read_campaign(&path).expect("a shared campaign is well-formed"))
}

fn runs(c: &Campaign, used: Use) -> Vec<usize> {
    (0..c.runs.len()).filter(|&i| c.runs[i].used == used).collect()
}

fn evidence(c: &Campaign, used: Use) -> TrackEvidence {
    TrackEvidence::new(c, &runs(c, used), &c.plant).expect("tracks are long enough")
}

fn problem<'a>(c: &'a Campaign, e: &'a TrackEvidence) -> Problem<'a> {
    Problem { evidence: e, base: &c.plant, declared: &c.declared }
}

fn declared(c: &Campaign, e: &TrackEvidence) -> TrackFit {
    let generic = vec![0.0; e.components()];
    let start = TrackModel {
        declared: c.plant.aero.values.clone(),
        constants: Vec::new(),
        effects: Vec::new(),
        generic,
        priors: Vec::new(),
        scatter: None,
    };
    problem(c, e).fit(&start, false)
}

/// A family beside what a fit has, fitted in full.
fn with(c: &Campaign, e: &TrackEvidence, fit: &TrackFit, family: &str) -> TrackFit {
    let mut h = fit.hypothesis.clone();
    h.effects.push(EffectInstance::null(find(family, Acts::PointMass).expect("in the catalogue"), &c.inputs));
    problem(c, e).fit(&h, true)
}

/// Chance of the gain of `n` numbers over a fit, as few runs allow it.
fn chance(e: &TrackEvidence, over: &TrackFit, fit: &TrackFit, n: usize) -> f64 {
    let factor = e.witnesses().map_or(1.0, |w| w.factor(over.free.len(), n));
    p_value(2.0 * (fit.log_likelihood - over.log_likelihood) * factor, n, 1)
}

/// Every family of the catalogue fitted in full, with its p-value; the best by log-likelihood less half a log sample per strength, first.
fn ranked(c: &Campaign, e: &TrackEvidence, fit: &TrackFit) -> Vec<(f64, &'static str, f64, TrackFit)> {
    let penalty = 0.5 * (e.samples() as f64).ln();
    let families = CATALOGUE.into_iter().filter(|e| e.acts.on(Acts::PointMass)).map(|e| e.family);
    let mut all: Vec<_> = families
        .map(|family| {
            let full = with(c, e, fit, family);
            let n = full.free.len() - fit.free.len();
            let score = full.log_likelihood - fit.log_likelihood - penalty * n as f64;
            (score, family, chance(e, fit, &full, n), full)
        })
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (score, family, p, full) in &all {
        let values = full.hypothesis.effects.last().map(|e| &e.values);
        eprintln!("  {family}: {score:.1}, p {p:.1e}, {:?} {values:?}", full.stop);
    }
    all
}

#[test]
fn recover_drag_of_balls_dropped_in_air() {
    // In-sample rms before and after, m, of the data's note; printed digits.
    for (ball, before, after) in [("tennis-ball", 0.91, 0.15), ("yellow-whiffle-ball", 3.80, 0.36)] {
        let Some(c) = measured("recover_drag_of_balls_dropped_in_air", &format!("ball-drops/{ball}.toml")) else { return };
        let mut e = evidence(&c, Use::Identify);
        let start = declared(&c, &e);
        let all = ranked(&c, &e, &start);
        e.settle(&all[0].3.hypothesis.plant(&c.plant));
        let fit = problem(&c, &e).fit(&all[0].3.hypothesis, false);
        let (rms0, rms1) = (e.rms_m(&start.hypothesis.plant(&c.plant)), e.rms_m(&fit.hypothesis.plant(&c.plant)));
        let held = evidence(&c, Use::HoldOut);
        eprintln!(
            "{ball}: {rms0:.3} {rms1:.3} m, CD {:?} ± {:.3}; held out {:.3} {:.3} m",
            fit.hypothesis.effects[0].values,
            fit.std_error(Free::Effect(0, 0)),
            held.rms_m(&start.hypothesis.plant(&c.plant)),
            held.rms_m(&fit.hypothesis.plant(&c.plant))
        );
        assert_eq!(all[0].1, "drag", "{ball}");
        assert!(all[0].2 < 1e-4);
        assert!((rms0 - before).abs() < 0.006, "{ball} {rms0}");
        // Weighted for drift, not for rms, so up to a twentieth above the best.
        assert!(rms1 < 1.05 * (after + 0.005), "{ball} {rms1}");
    }
}

#[test]
fn recover_nothing_from_heavy_balls() {
    for ball in ["bowling-ball", "golf-ball"] {
        let Some(c) = measured("recover_nothing_from_heavy_balls", &format!("ball-drops/{ball}.toml")) else { return };
        let e = evidence(&c, Use::Identify);
        let start = declared(&c, &e);
        for (_, family, p, _) in ranked(&c, &e, &start) {
            // One in a hundred over the families of point masses.
            assert!(p > 0.01 / 7.0, "{ball}: {family} p {p:.2e}");
        }
        let left = e.channel_residuals(&start.residual, 0);
        assert!(left.iter().all(|c| c.p_value > 0.01), "{ball}: {left:?}");
    }
}

/// The other drop of the golf ball alone asks for 0.7 m/s² that the first one lacks: of one flight a steady push is its own, and what one
/// replaces is not named. Drag of the light balls is no such thing, though the two drops of the whiffle ball ask for different amounts of it.
#[test]
fn recover_no_name_from_a_push_of_one_flight() {
    for (ball, named) in [("golf-ball", false), ("bowling-ball", false), ("tennis-ball", true), ("yellow-whiffle-ball", true)] {
        let Some(mut c) = measured("recover_no_name_from_a_push_of_one_flight", &format!("ball-drops/{ball}.toml")) else {
            return;
        };
        for swapped in [false, true] {
            let closing = close(&c, &Options::default()).expect("closes");
            let families: Vec<&str> = closing.effects.iter().map(|e| e.family.as_str()).collect();
            assert_eq!(families, if named { vec!["drag"] } else { vec![] }, "{ball}, swapped {swapped}");
            let open = (ball == "golf-ball" && swapped) || ball == "yellow-whiffle-ball";
            assert_eq!(closing.verdict == Verdict::Unexplained, open, "{ball}, swapped {swapped}: {:?}", closing.unexplained);
            for run in &mut c.runs {
                run.used = if run.used == Use::Identify { Use::HoldOut } else { Use::Identify };
            }
        }
    }
}

/// A campaign of launches of the ball of `like` with planted values, white noise of 2 mm, uneven sampling.
fn planted(plant: &Plant, truth: &Plant, inputs: &[f64], axes: [bool; 3], seed: u64) -> Campaign {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    let density = plant.point.air_density_kg_m3;
    let launch = |(k, u): (usize, &f64)| {
        let mut t_s = vec![0.0];
        while t_s.len() < 80 {
            let last = t_s[t_s.len() - 1];
            t_s.push(last + 0.006 * (1.0 + 0.1 * draw().clamp(-3.0, 3.0)));
        }
        let (p, v) = if axes[1] {
            ([-1.0 + 0.05 * draw(), 0.0, 0.0], [-1.5 + 0.2 * draw(), 5.0 + 0.2 * draw(), 0.2 * draw()])
        } else {
            ([0.0; 3], [2.0 + 0.2 * draw(), 0.0, 0.0])
        };
        let flown = fly_point(&truth.for_run(k, &[*u]), density, &t_s, p, v).expect("a flight of half a second");
        let position_m =
            std::array::from_fn(|a| axes[a].then(|| flown.iter().map(|r| r[a] + 0.002 * draw()).collect::<Vec<f64>>()));
        Run {
            name: format!("launch-{k}"),
            kind: "launch".to_owned(),
            used: Use::Identify,
            inputs: vec![*u],
            data: Data::Point(PointRecord { t_s, position_m, ..PointRecord::default() }),
            notes: Vec::new(),
        }
    };
    let runs: Vec<Run> = inputs.iter().enumerate().map(launch).collect();
    Campaign {
        name: "planted".to_owned(),
        plant: plant.clone(),
        declared: vec![true],
        inputs: vec!["spin".to_owned()],
        runs,
        knowledge: Knowledge::default(),
    }
}

/// Drops have no settings.
#[test]
fn recover_drag_of_a_dropped_ball_without_run_inputs() {
    let plant = ball().expect("a campaign file of one ball");
    let mut truth = plant.clone();
    truth.aero.values = vec![0.5];
    let mut c = planted(&plant, &truth, &[0.0; 6], [true; 3], 9);
    c.inputs.clear();
    c.runs.iter_mut().for_each(|r| r.inputs.clear());
    let r = close(&c, &Options::default()).expect("the declared model fits");
    assert!(r.effects.is_empty(), "drag is declared: {:?}", r.effects);
    let line = &r.before.parameters[0];
    // 3 standard errors: one in 370, seed fixed.
    assert!((line.estimate - 0.5).abs() < 3.0 * line.std_error.expect("free"), "{line:?}");
}

/// A light ball with declared drag 0.45.
fn ball() -> Option<Plant> {
    let text = "[campaign]\nname = \"ball\"\n[vehicle]\nmass_kg = 0.0027\nreference_diameter_m = 0.040\n[axes]\ndown = \"-Z\"\n[environment]\ngravity_m_s2 = 9.80665\nair_density_kg_m3 = 1.19\n[sensors]\nposition_std_m = 0.002\n[aero.point_mass]\nCD = 0.45\n[[run]]\nfile = \"a.csv\"\nkind = \"launch\"\nuse = \"identify\"\n";
    let dir = std::env::temp_dir().join(format!("windfall-point-{}-{:?}", std::process::id(), std::thread::current().id()));
    std::fs::create_dir_all(&dir).ok()?;
    std::fs::write(dir.join("campaign.toml"), text).ok()?;
    let rows: String = (0..20).map(|i| format!("{},0,0,{}\n", 0.01 * f64::from(i), -0.001 * f64::from(i * i))).collect();
    std::fs::write(dir.join("a.csv"), format!("t_s,X_m,Y_m,Z_m\n{rows}")).ok()?;
    let plant = read_campaign(&dir.join("campaign.toml")).ok().map(|c| c.plant);
    std::fs::remove_dir_all(&dir).ok()?;
    plant
}

#[test]
fn recover_planted_lift_per_input_and_drag() {
    let plant = ball().expect("a campaign file of one ball");
    let mut truth = plant.clone();
    truth.aero.values = vec![0.5];
    truth.point.lift_per_input = vec![2e-4];
    let c = planted(&plant, &truth, &[-1000.0, 0.0, 1000.0, -500.0, 500.0, 800.0], [true; 3], 3);
    let e = evidence(&c, Use::Identify);
    let start = declared(&c, &e);
    let all = ranked(&c, &e, &start);
    assert_eq!(all[0].1, "spin-lift");
    let fit = &all[0].3;
    for (free, planted) in
        [(Free::Declared(0), 0.5), (Free::Effect(0, 0), 2e-4), (Free::Effect(0, 1), 0.0), (Free::Effect(0, 2), 0.0)]
    {
        // 3 standard errors: one in 370 per number, seed fixed.
        let (value, error) = (fit.hypothesis.get(free), fit.std_error(free));
        assert!((value - planted).abs() < 3.0 * error, "{free:?}: {value} ± {error}, planted {planted}");
    }
    // White noise of 2 mm, six initial numbers and three parameters out of 240 a run.
    let rms = e.rms_m(&fit.hypothesis.plant(&c.plant));
    assert!((rms / 0.002 - (1.0_f64 - 6.0 / 240.0).sqrt()).abs() < 4.0 / (2.0 * 1440.0_f64).sqrt(), "{rms}");
}

/// A ball with declared drag a third too high, held: less drag is named, and its amount in all is what was planted.
#[test]
fn recover_drag_that_is_less_than_declared() {
    let mut plant = ball().expect("a campaign file of one ball");
    plant.aero.values = vec![0.6];
    let mut truth = plant.clone();
    truth.aero.values = vec![0.45];
    let mut c = planted(&plant, &truth, &[0.0; 8], [true; 3], 11);
    c.inputs.clear();
    c.runs.iter_mut().for_each(|r| r.inputs.clear());
    c.declared = vec![false];
    let r = close(&c, &Options::default()).expect("flies");
    let drag = r.effects.iter().find(|e| e.family == "drag").unwrap_or_else(|| panic!("named: {:?}", r.effects));
    let cd = &drag.parameters[0];
    // 3 standard errors: one in 370, seed fixed.
    assert!((cd.estimate + 0.15).abs() < 3.0 * cd.std_error.expect("free") && !cd.at_end, "{cd:?}");
}

/// Drag that a setting raises by a factor of six is stated at the settings flown, not at settings of zero, and in all is never negative.
#[test]
fn recover_drag_at_the_settings_flown() {
    let plant = ball().expect("a campaign file of one ball");
    let mut truth = plant.clone();
    truth.aero.values = vec![0.0];
    truth.point.drag_per_input = vec![0.4];
    let c = planted(&plant, &truth, &[1.0, 6.0, 1.0, 6.0, 3.0, 4.0, 2.0, 5.0], [true; 3], 12);
    let r = close(&c, &Options::default()).expect("flies");
    let drag = r.effects.iter().find(|e| e.family == "drag").unwrap_or_else(|| panic!("named: {:?}", r.effects));
    let in_all = drag.flown.iter().find(|f| f.in_all).expect("an amount");
    for (value, planted) in [(&in_all.least, 0.4), (&in_all.most, 2.4)] {
        // 3 standard errors: one in 370, seed fixed.
        assert!((value.estimate - planted).abs() < 3.0 * value.std_error, "{value:?}");
    }
    assert!(drag.shown_parameters().all(|p| p.name != "CD"), "{:?}", drag.parameters);
}

/// Falls of 8 s under a parachute whose area the setting raises by six: the first fit, of one coefficient for all, leads far from where the
/// flights were laid, and comes to its end.
#[test]
fn recover_drag_of_falls_that_differ_by_six() {
    let mut plant = ball().expect("a campaign file of one ball");
    (plant.vehicle.mass_kg, plant.vehicle.diameter_m, plant.sensors.position_std_m) = (1.0, 0.3, 0.01);
    plant.aero.values = vec![0.8];
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut c = planted(&plant, &plant, &[1.0, 6.0, 1.0, 6.0, 1.0, 6.0], [true, false, false], 5);
    for run in &mut c.runs {
        let mut truth = plant.clone();
        truth.aero.values = vec![0.8 * run.inputs[0]];
        let t_s: Vec<f64> = (0..160).map(|i| 0.05 * f64::from(i)).collect();
        let flown = fly_point(&truth, 1.19, &t_s, [0.0; 3], [0.1 * draw(), 0.0, 0.0]).expect("falls");
        let down = flown.iter().map(|p| p[0] + 0.01 * draw()).collect();
        run.data = Data::Point(PointRecord { t_s, position_m: [Some(down), None, None], ..PointRecord::default() });
    }
    let r = close(&c, &Options::default()).expect("the declared model fits");
    let drag = r.effects.iter().find(|e| e.family == "drag").unwrap_or_else(|| panic!("named: {:?}", r.effects));
    let slope = drag.parameters.iter().find(|p| p.name == "CD_per_spin").expect("follows the setting");
    assert!((slope.estimate - 0.8).abs() < 3.0 * slope.std_error.expect("free"), "{slope:?}");
}

#[test]
fn law_residual_forgets_the_initial_state_and_unmeasured_axes() {
    let plant = ball().expect("a campaign file of one ball");
    let mut c = planted(&plant, &plant, &[0.0; 2], [true, false, false], 5);
    let e = evidence(&c, Use::Identify);
    let z = e.residual(&c.plant);
    for run in &mut c.runs {
        if let Data::Point(track) = &mut run.data {
            for x in track.position_m.iter_mut().flatten().flatten() {
                *x += 7.0;
            }
        }
    }
    let moved = evidence(&c, Use::Identify).residual(&c.plant);
    // Nothing depends on place: 1e-9 m is the rounding of bases found twice.
    assert!(z.iter().zip(&moved).all(|(a, b)| (a - b).abs() < 1e-9));
    let mut pushed = c.plant.clone();
    pushed.point.acceleration = windfall_model::frames::Vec3::new(0.0, 3.0, -2.0);
    assert_eq!(e.residual(&pushed), z);
    // The residual's square is that of the track: the basis is orthonormal and the state is taken out.
    let rms = e.rms_m(&c.plant);
    let sum: f64 = z.iter().map(|x| x * x).sum();
    // Step of the least squares, 1e-9 m.
    assert!((sum - rms * rms * 160.0).abs() < 1e-11, "{sum} {rms}");
}

#[test]
fn exact_parabola_leaves_nothing_in_vacuum() {
    let mut plant = ball().expect("a campaign file of one ball");
    plant.aero.values = vec![0.0];
    let t_s: Vec<f64> = (0..50).map(|i| 0.01 * f64::from(i) + 0.003 * f64::from(i % 2)).collect();
    let g = plant.environment.gravity_m_s2;
    let down: Vec<f64> = t_s.iter().map(|t| 3.0 - 2.0 * t + 0.5 * g * t * t).collect();
    let mut c = planted(&plant, &plant, &[0.0], [true, false, false], 5);
    c.runs[0].data = Data::Point(PointRecord { t_s, position_m: [Some(down), None, None], ..PointRecord::default() });
    let e = evidence(&c, Use::Identify);
    // Tolerance of the integrator, 1e-11 of metres.
    assert!(e.rms_m(&plant) < 1e-9);
    let series = e.series(&plant);
    assert!((series[0].velocity_m_s[0] + 2.0).abs() < 1e-8 && (series[0].position_m[0] - 3.0).abs() < 1e-8, "{series:?}");
}

/// Anchors of the data's note, per axis: gravity 20.3 mm, drag 11.4 mm, decoy 9.7 mm, spin lift 3.0 mm. Its split differs from the
/// campaign's (and single spikes are removed here), so they are met to 5 %. Beside lift, drag that spin changes.
#[test]
#[ignore = "slow: nightly"]
fn recover_table_tennis_by_the_closing_loop() {
    let Some(c) = measured("recover_table_tennis_by_the_closing_loop", "table-tennis/campaign.toml") else { return };
    let held = evidence(&c, Use::HoldOut);
    let mut vacuum = c.plant.clone();
    vacuum.aero.values = vec![0.0];
    let gravity = 1e3 * held.rms_m(&vacuum);
    let r = close(&c, &Options::default()).expect("the declared model fits");
    for e in &r.effects {
        eprintln!("{} p {:.2e} held-out gain {:?} rivals {:?}", e.family, e.p_value, e.held_out_gain, e.rivals);
    }
    let rms =
        |h: &Option<windfall_discover::close::HeldOut>| 1e3 * h.as_ref().and_then(|h| h.position_rms_m).expect("runs held out");
    let (before, after) = (rms(&r.before.hold_out), rms(&r.after.hold_out));
    eprintln!("held out: gravity {gravity:.2}, declared {before:.2}, closed {after:.2} mm; {:?}", r.residual_after);
    assert!((gravity / 20.3 - 1.0).abs() < 0.05 && (before / 11.4 - 1.0).abs() < 0.05, "{gravity} {before}");
    let families: Vec<&str> = r.effects.iter().map(|e| e.family.as_str()).collect();
    assert_eq!(families, ["spin-lift", "drag"]);
    assert!(r.effects[0].rivals.is_empty(), "{:?}", r.effects[0].rivals);
    assert!(after < 1.7, "{after}");
}

/// The tosses' gravity is 9.60 m/s2 for 9.81, and the cube comes to rest 2.2 % too low: the unit of length, or the clock. No force that a
/// cube can have does it.
#[test]
fn recover_the_unit_of_length_of_the_cube_tosses() {
    let Some(c) = measured("recover_the_unit_of_length_of_the_cube_tosses", "cube-tosses/campaign.toml") else { return };
    let r = close(&c, &Options::default()).expect("the declared model fits");
    assert_eq!(r.effects.len(), 1, "{:?}", r.effects);
    let effect = &r.effects[0];
    let mut both: Vec<&str> = effect.rivals.iter().map(String::as_str).chain([effect.family.as_str()]).collect();
    both.sort_unstable();
    assert_eq!(both, ["length-scale", "time-base"]);
    if effect.family == "length-scale" {
        let [low, high] = effect.parameters[0].ci95.expect("an interval");
        // Rest heights of 51.25 mm over 52.4 mm declared, which the closing does not know.
        assert!(low < -0.0219 && -0.0219 < high, "{low} {high}");
    }
    assert!(!r.unexplained.is_empty(), "every toss has a push of its own beyond noise");
}

/// An effect beside one that the campaign declares, settings far from zero: the other is named, its numbers are those put in.
#[test]
fn recover_an_effect_beside_a_declared_one() {
    let plant = ball().expect("a campaign file of one ball");
    let mut truth = plant.clone();
    truth.point.lift_per_input = vec![2e-4];
    truth.point.acceleration = windfall_model::frames::Vec3::new(0.0, 0.5, 0.0);
    let mut c = planted(&plant, &truth, &[1000.0, 2000.0, 3000.0, 1500.0, 2500.0, 2800.0, 1200.0, 2200.0], [true; 3], 21);
    let push = find("constant-acceleration", Acts::PointMass).expect("in the catalogue");
    c.knowledge.effects = vec![(push, vec![0.0, 0.1, 0.0])];
    let r = close(&c, &Options::default()).expect("the declared model fits");
    assert_eq!(r.effects.iter().map(|e| e.family.as_str()).collect::<Vec<_>>(), ["spin-lift"]);
    for (name, planted) in [("CL_per_spin", 2e-4), ("CL_constant", 0.0)] {
        let line = r.effects[0].parameters.iter().find(|p| p.name == name).expect("a parameter of lift");
        let error = line.std_error.expect("free");
        eprintln!("{name} {} ± {error}", line.estimate);
        // 3 standard errors: one in 370 per number, seed fixed.
        assert!((line.estimate - planted).abs() < 3.0 * error, "{name}: {} ± {error}", line.estimate);
    }
}

/// Campaigns in which nothing acts but a push of each launch's own: names are false. At 2 % a draw 72 % of all sixteens have none, and the
/// sixteen of these seeds are among them.
#[test]
#[ignore = "slow: nightly"]
fn law_few_false_names() {
    let plant = ball().expect("a campaign file of one ball");
    let mut false_names = Vec::new();
    for seed in 0..16 {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7000 + seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut c = planted(&plant, &plant, &[], [true; 3], seed);
        let size = if seed % 2 == 0 { 0.0 } else { 0.3 };
        for k in 0..11_u32 {
            let mut own = plant.clone();
            own.point.acceleration = windfall_model::frames::Vec3::new(size * draw(), size * draw(), size * draw());
            c.runs.extend(planted(&plant, &own, &[500.0 * f64::from(k % 3)], [true; 3], 50 * seed + 7000 + u64::from(k)).runs);
        }
        let r = close(&c, &Options::default()).expect("the declared model fits");
        false_names.extend(r.effects.iter().map(|e| (seed, e.family.clone(), e.p_value)));
    }
    assert!(false_names.is_empty(), "{false_names:?}");
}

/// Launches that a push of their own scatters, nothing else: an effect common to all is named no more often than stated.
#[test]
fn law_scatter_between_launches_is_no_effect() {
    let plant = ball().expect("a campaign file of one ball");
    let (campaigns, launches, level) = (20, 11, 0.05);
    let mut below = [0_u32; 2];
    for seed in 0..campaigns {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let mut c = planted(&plant, &plant, &[], [true; 3], seed);
        for k in 0..launches {
            let mut own = plant.clone();
            // 0.4 m/s² over half a second: 5 cm, 25 times the noise.
            own.point.acceleration = windfall_model::frames::Vec3::new(0.4 * draw(), 0.4 * draw(), 0.4 * draw());
            c.runs.extend(planted(&plant, &own, &[0.0], [true; 3], 100 * seed + k).runs);
        }
        // Drag is known. Estimated too, it comes out low: a push that speeds a ball up also raises the speed its drag is taken at.
        c.declared = vec![false];
        let e = evidence(&c, Use::Identify);
        let start = declared(&c, &e);
        let push = find("constant-acceleration", Acts::PointMass).expect("in the catalogue");
        let mut h = start.hypothesis.clone();
        h.effects.push(EffectInstance::null(push, &c.inputs));
        let fit = problem(&c, &e).fit(&h, false);
        below[0] += u32::from(chance(&e, &start, &fit, 3) < level);
        below[1] += u32::from(p_value(2.0 * (fit.log_likelihood - start.log_likelihood), 3, 1) < level);
    }
    eprintln!("of {campaigns} campaigns below {level}: with Box's factor {}, without {}", below[0], below[1]);
    // Binomial, 20 draws at 5 %: 5 or more has probability 0.3 %. Without a push of each launch's own in the covariance three in
    // four were below.
    assert!(below[0] < 5, "{below:?}");
}

/// A bow of the tracker's axis that all launches share: far beyond chance, but no effect while it is within the stated accuracy.
#[test]
fn law_an_error_of_the_tracker_that_all_runs_share_is_no_effect() {
    let plant = ball().expect("a campaign file of one ball");
    for (bow_m, told) in [(0.003, false), (0.03, true)] {
        let mut c = planted(&plant, &plant, &[0.0; 12], [true; 3], 11);
        for run in &mut c.runs {
            if let Data::Point(track) = &mut run.data {
                let end = track.t_s[track.t_s.len() - 1];
                for (x, t) in track.position_m[2].iter_mut().flatten().zip(&track.t_s) {
                    *x += 4.0 * bow_m * (t / end) * (1.0 - t / end);
                }
            }
        }
        let e = evidence(&c, Use::Identify);
        let start = declared(&c, &e);
        let mut h = start.hypothesis.clone();
        h.effects.push(EffectInstance::null(find("constant-acceleration", Acts::PointMass).expect("in it"), &c.inputs));
        let fit = problem(&c, &e).fit(&h, false);
        let p = chance(&e, &start, &fit, 3);
        assert!(p < 1e-3, "{p}");
        assert_eq!(e.tells(&start.residual, &fit.residual), told, "{bow_m}");
        // The rms of a parabola of height b with a line taken out is b·√(4/45), less what drag takes of its shape: below 2 mm, above.
        assert_eq!(bow_m * (4.0_f64 / 45.0).sqrt() > 0.002, told);
    }
}
