//! discover tests: closing on rigid bodies in free flight. In: the bundled campaign of a blimp, flights of an independent integrator. Out: what is
//! named, what is not, and how well runs held out are predicted.

use super::common::{closed, families, measured};
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use windfall_discover::close::{Closing, HeldOut, Verdict};
use windfall_discover::tracks::TrackEvidence;
use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};
use windfall_model::{Campaign, Data, FreeState, Measured, PointRecord};
use windfall_sim::{Seed, record_free};

/// What the truth of made flights has beyond the source's model, and what each flight has of its own.
#[derive(Clone, Copy, Default)]
struct Truth {
    /// Displaced air over that declared, less 1.
    buoyancy: f64,
    /// Gondola and propellers further ahead than declared, m.
    ahead_m: f64,
    /// Yawing moment coefficient beyond that declared.
    yawing: f64,
}

const MASS: f64 = 0.10482;
const GONDOLA: f64 = 0.05407;
const GRAVITY: f64 = 9.8;

/// Position (north, east, down), roll, pitch, yaw, velocity and rates along the body: the source's own state.
type Flight = [f64; 12];

fn body_from_ned([roll, pitch, yaw]: [f64; 3]) -> Matrix3<f64> {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    #[rustfmt::skip]
    let m = Matrix3::new(
        cp * cy, cp * sy, -sp,
        sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp,
        cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp,
    );
    m
}

/// The source's printed coefficients, drag, side force and lift, and moments about wind axes with the rate damping among them, turned to the body.
fn air(v: Vector3<f64>, w: Vector3<f64>, truth: &Truth) -> [Vector3<f64>; 2] {
    let speed = v.norm();
    let (a, b) = (v.z.atan2(v.x), (v.y / speed).asin());
    let q = 0.5 * 1.2187 * speed * speed * 0.25;
    let (drag, side, lift) =
        (0.2425 + 4.4195 * a * a + 7.5080 * b * b, 0.0083 - 0.0744 * a * a - 2.1140 * b, 0.1594 + 2.9375 * a + 4.5537 * b * b);
    let moments = Vector3::new(
        0.0131 - 0.0301 * a - 0.5256 * b,
        0.0568 + 0.0933 * a + 5.2357 * b.powi(4),
        0.0006 - 0.0012 * a - 0.0936 * b + truth.yawing,
    );
    let damping = Vector3::new(-0.0503 * w.x, -0.0264 * w.y, -0.0137 * w.z);
    let ((sa, ca), (sb, cb)) = (a.sin_cos(), b.sin_cos());
    let wind = Matrix3::new(ca * cb, -ca * sb, -sa, sb, cb, 0.0, sa * cb, -sa * sb, ca);
    [wind * Vector3::new(-drag, side, -lift) * q, wind * (moments * q + damping)]
}

/// Rates of the state, put together about the centre of mass.
fn rates(s: &Flight, inputs: &[f64], truth: &Truth) -> Flight {
    let angles = [s[3], s[4], s[5]];
    let (v, w) = (Vector3::new(s[6], s[7], s[8]), Vector3::new(s[9], s[10], s[11]));
    // Inputs in the order of their names: gondola x, y, z, thrust left, right.
    let gondola = Vector3::new(inputs[0] + truth.ahead_m, inputs[1], inputs[2]);
    let rest = Vector3::new(-0.0432, -0.0003, 0.0079);
    let mass = MASS + GONDOLA;
    let centre = (rest * MASS + gondola * GONDOLA) / mass;
    let turn = body_from_ned(angles);
    let down = turn * Vector3::z() * GRAVITY;
    let [force_of_air, moment_of_air] = air(v, w, truth);
    let pulls = [
        (rest, down * MASS),
        (gondola, down * GONDOLA),
        (Vector3::zeros(), down * (-0.15204 * (1.0 + truth.buoyancy))),
        (Vector3::new(0.0, -0.15, inputs[2]), Vector3::x() * inputs[3]),
        (Vector3::new(0.0, 0.15, inputs[2]), Vector3::x() * inputs[4]),
        (Vector3::zeros(), force_of_air),
    ];
    let force: Vector3<f64> = pulls.iter().map(|(_, f)| f).sum();
    let torque: Vector3<f64> = moment_of_air + pulls.iter().map(|(r, f)| (r - centre).cross(f)).sum::<Vector3<f64>>();
    let point = |m: f64, r: Vector3<f64>| (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * m;
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.03, 0.015, 0.01)) + point(GONDOLA, gondola) - point(mass, centre);
    let w_rate = inertia.try_inverse().expect("an inertia") * (torque - w.cross(&(inertia * w)));
    let v_rate = force / mass - w_rate.cross(&centre) - w.cross(&w.cross(&centre)) - w.cross(&v);
    let p = turn.transpose() * v;
    let ((sr, cr), tp, cp) = (angles[0].sin_cos(), angles[1].tan(), angles[1].cos());
    let euler = [w.x + (sr * w.y + cr * w.z) * tp, cr * w.y - sr * w.z, (sr * w.y + cr * w.z) / cp];
    let all = p.iter().chain(&euler).chain(v_rate.iter()).chain(w_rate.iter()).copied();
    let mut out = [0.0; 12];
    out.iter_mut().zip(all).for_each(|(o, x)| *o = x);
    out
}

/// A record at 60 Hz: by Heun's method at 2 ms, another than the program's.
fn record(start: Flight, inputs: &[f64], truth: &Truth, seconds: f64) -> PointRecord {
    const STEPS: usize = 8;
    let h = 1.0 / 60.0 / STEPS as f64;
    let samples = (60.0 * seconds).round() as usize;
    let mut s = start;
    let mut track = PointRecord { measured: Measured::Pose, ..PointRecord::default() };
    let mut position: [Vec<f64>; 3] = Default::default();
    let tunnel = Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
    for i in 0..samples {
        track.t_s.push(i as f64 / 60.0);
        // Tunnel X is down, Y north, Z east.
        position.iter_mut().zip([s[2], s[0], s[1]]).for_each(|(c, x)| c.push(x));
        let r = Rotation::<Tunnel, Body>::from_matrix(tunnel * body_from_ned([s[3], s[4], s[5]]).transpose());
        track.attitude.push(r.to_quaternion());
        for _ in 0..STEPS {
            let a = rates(&s, inputs, truth);
            let ahead: Flight = std::array::from_fn(|k| s[k] + h * a[k]);
            let b = rates(&ahead, inputs, truth);
            s = std::array::from_fn(|k| s[k] + 0.5 * h * (a[k] + b[k]));
        }
    }
    track.position_m = position.map(Some);
    track
}

/// Flights of the bundled campaign's settings with a truth, each with a little of its own: displaced air (0.3 %), thrusts (4 %), gondola (2
/// mm), and another start.
fn made(truth: Truth, seed: u64) -> Campaign {
    let mut c = measured("gliding-blimp/campaign.toml");
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    for run in &mut c.runs {
        let own = Truth { buoyancy: truth.buoyancy + 0.003 * draw(), ahead_m: truth.ahead_m + 0.002 * draw(), ..truth };
        let mut inputs = run.inputs.clone();
        let both = 0.04 * draw();
        inputs[3..].iter_mut().for_each(|t| *t *= 1.0 + both + 0.01 * draw());
        let start = [
            0.0,
            0.0,
            -1.0,
            0.03 * draw(),
            -0.05 + 0.03 * draw(),
            draw(),
            0.45 + 0.05 * draw(),
            0.02 * draw(),
            0.05 + 0.02 * draw(),
            0.03 * draw(),
            0.03 * draw(),
            if run.kind == "straight" { 0.0 } else { -0.4 },
        ];
        run.data = Data::Point(record(start, &inputs, &own, 12.0));
    }
    c
}

/// Flights by other equations with nothing undeclared but what each has of its own: nothing is named, and what is left is not called
/// systematic.
#[test]
fn law_nothing_is_named_where_nothing_is_missing() {
    for seed in [1, 2] {
        let closing = closed(&made(Truth::default(), seed));
        assert_eq!((families(&closing), closing.verdict), (Vec::new(), Verdict::Consistent), "seed {seed}");
    }
}

/// Helium lost: displaced air 2 % less than declared, and the value is in its interval of three standard errors.
#[test]
fn recover_lost_helium() {
    let closing = closed(&made(Truth { buoyancy: -0.02, ..Truth::default() }, 11));
    assert_eq!(families(&closing), ["buoyancy"]);
    let found = &closing.effects[0].parameters[0];
    let std = found.std_error.expect("free");
    assert!((found.estimate + 0.02).abs() < 3.0 * std && std < 0.003, "{found:?}");
    let [before, after] = held(&closing);
    assert!(after < 0.8 * before, "{before} {after} m");
}

/// A body bent to one side: the yawing moment is found by its family or one that is said to be its rival.
#[test]
#[ignore = "slow: nightly"]
fn recover_a_body_askew() {
    let closing = closed(&made(Truth { yawing: -0.004, ..Truth::default() }, 12));
    let first = &closing.effects[0];
    assert!(first.family == "asymmetry" || first.rivals.iter().any(|r| r == "asymmetry"), "{first:?}");
    if first.family == "asymmetry" {
        let cn = &first.parameters[2];
        assert!((cn.estimate + 0.004).abs() < 3.0 * cn.std_error.expect("free"), "{cn:?}");
    }
}

/// Position error on runs held out, before and after, m.
fn held(c: &Closing) -> [f64; 2] {
    let of = |h: &HeldOut| h.position_rms_m;
    [&c.before, &c.after].map(|side| side.hold_out.as_ref().and_then(of).expect("runs held out"))
}

/// What the declared model is off by, channel by channel, beside what two flights of the same settings differ by: rms of the slow numbers of all
/// flights, and of the differences of twins over √2, m and rad over the samples of a track.
fn error_and_repeatability(c: &Campaign) -> [[f64; 2]; 6] {
    let all: Vec<usize> = (0..c.runs.len()).collect();
    let evidence = TrackEvidence::new(c, &all, &c.plant).expect("flies");
    let z = evidence.residual(&c.plant);
    let numbers = z.len() / c.runs.len();
    let of = |run: usize, k: usize| z[run * numbers + k];
    let twins: Vec<[usize; 2]> = all
        .iter()
        .filter_map(|&i| (i + 1..c.runs.len()).find(|&j| c.runs[j].inputs == c.runs[i].inputs).map(|j| [i, j]))
        .collect();
    assert!(twins.len() > 30, "{}", twins.len());
    let per_sample = (2.0 * 48.0_f64).sqrt();
    std::array::from_fn(|channel| {
        let own = [channel, channel + 6];
        let error: f64 = all.iter().flat_map(|&r| own.map(|k| of(r, k).powi(2))).sum::<f64>() / all.len() as f64;
        let apart: f64 = twins.iter().flat_map(|[a, b]| own.map(|k| 0.5 * (of(*a, k) - of(*b, k)).powi(2))).sum::<f64>();
        [error, apart / twins.len() as f64].map(|square| square.sqrt() / per_sample)
    })
}

/// Of made flights without anything undeclared the error is what flights differ by: their ratio is one within the scatter of 35 pairs
/// (15 %, three times over). The makers' model of the measured ones is off by more than that somewhere.
#[test]
fn law_the_floor_is_what_twins_differ_by() {
    for (name, c, more) in
        [("made", made(Truth::default(), 21), false), ("measured", measured("gliding-blimp/campaign.toml"), true)]
    {
        let all = error_and_repeatability(&c);
        let ratios = all.map(|[error, floor]| error / floor);
        eprintln!("{name}: error and repeatability {all:.4?}, ratios {ratios:.2?}");
        assert_eq!(ratios.iter().any(|r| *r > 1.45), more, "{name}: {ratios:?}");
    }
}

/// The measured set as it is bundled. Figures are in `docs/measured.md`; here what is said at all, and that held-out flights are never predicted
/// worse with what is named than without.
#[test]
fn recover_what_the_blimp_leaves_open() {
    let closing = closed(&measured("gliding-blimp/campaign.toml"));
    assert!(closing.verdict != Verdict::Consistent, "{:?}", closing.verdict);
    let [before, after] = held(&closing);
    assert!((0.3..0.7).contains(&before) && after < 1.02 * before, "{before} {after} m");
}

#[test]
#[ignore = "slow: minutes; twenty coefficients with priors"]
fn recover_what_is_left_beside_uncertain_coefficients() {
    let closing = closed(&measured("gliding-blimp/uncertain.toml"));
    assert!(closing.effects.iter().all(|e| e.parameters.iter().any(|p| p.std_error.is_some())));
    let [before, after] = held(&closing);
    assert!(after < 1.02 * before, "{before} {after} m");
}

/// As many tosses as were measured, each as long, with the noise that is stated, of a cube whose centre of mass is so far along its z.
fn tossed(ahead_m: f64, seed: u64) -> Campaign {
    let mut c = measured("cube-tosses/campaign.toml");
    let mut truth = c.plant.clone();
    truth.vehicle.p_origin_cm += Vec3::new(0.0, 0.0, ahead_m);
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    for (i, run) in c.runs.iter_mut().enumerate() {
        let Data::Point(measured) = &run.data else { panic!("a track") };
        let start = FreeState {
            p_tunnel_origin: Vec3::new(-0.15, 0.2 * draw(), 0.2 * draw()),
            attitude: measured.attitude[0],
            v_tunnel_origin: Vec3::new(0.5 * draw(), 0.5 * draw(), 0.5 * draw()),
            w_tunnel_body: Vec3::new(2.0 * draw(), 2.0 * draw(), 2.0 * draw()),
        };
        let seconds = (measured.t_s.len() - 1) as f64 / 148.0;
        let noise = Seed { campaign: seed, run: i as u64 };
        run.data = Data::Point(record_free(&truth, seconds, 148.0, &start, Some(noise)).expect("flies").record);
    }
    c
}

/// A body that the air does not damp: nothing is named where nothing is missing, and a shifted centre of mass is found, of which flights alone cannot say
/// that it is not the tracked point.
#[test]
fn recover_a_shifted_centre_of_mass_of_tosses_and_nothing_from_others() {
    let nothing = closed(&tossed(0.0, 5));
    assert_eq!((families(&nothing), nothing.verdict), (Vec::new(), Verdict::Consistent));
    // Three positions of 0.03 mm each.
    let [before, _] = held(&nothing);
    assert!((4e-5..6e-5).contains(&before), "{before} m");
    let closing = closed(&tossed(0.004, 6));
    let [only] = &closing.effects[..] else { panic!("{:?}", families(&closing)) };
    let (other, sign) = if only.family == "center-of-mass" { ("tracked-point", 1.0) } else { ("center-of-mass", -1.0) };
    assert!(only.rivals.iter().any(|r| r == other), "{only:?}");
    let z = &only.parameters[2];
    let std = z.std_error.expect("free");
    assert!((sign * z.estimate - 0.004).abs() < 3.0 * std && std < 4e-4, "{z:?}");
}

/// The measured tosses. Clock and unit of length are the same of free fall, centre of mass and tracked point of a body that nothing holds; drag beside them
/// is a cube's (1.3 to 2.2 on the circle of its edge).
#[test]
fn recover_what_the_cube_tosses_lack() {
    let closing = closed(&measured("cube-tosses/campaign.toml"));
    let pairs = [["time-base", "length-scale"], ["center-of-mass", "tracked-point"]];
    assert_eq!(closing.effects.len(), 3, "{:?}", families(&closing));
    let drag = &closing.effects.iter().find(|e| e.family == "drag").expect("named").parameters[0];
    assert!((1.0..2.5).contains(&drag.estimate) && drag.std_error.is_some_and(|s| s > 0.1), "{drag:?}");
    for pair in pairs {
        let e = closing.effects.iter().find(|e| pair.contains(&e.family.as_str())).expect("one of the two");
        assert!(pair.iter().all(|f| *f == e.family || e.rivals.iter().any(|r| r == f)), "{e:?}");
    }
    let [before, after] = held(&closing);
    // White noise alone leaves 0.05 mm.
    assert!(after < 0.75 * before && (5e-5..1.5e-4).contains(&after), "{before} {after} m");
}
