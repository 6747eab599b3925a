//! likelihood tests: a filter's first state and what it looks at, by rotations, differences and laws. Also a model with all that a filter knows.

use super::*;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use windfall_model::{LooseMass, Record, Sensors, Turbulence, WakeShedding, frames::Vec3};
use windfall_pid::equations::Local;

/// A loose part, gusts on all axes, moments of the wake, and instruments with every error.
pub(super) fn plant() -> Plant {
    let mut plant = windfall_scenarios::read_bundled("sage-unperturbed").expect("a bundled scenario").declared_plant;
    plant.vehicle.p_origin_cm = Vec3::new(0.02, -0.013, 0.017);
    plant.vehicle.loose = Some(LooseMass { mass_kg: 0.05, frequency_hz: 2.3, damping_ratio: 0.13, x_cm_m: 0.04, in_full: 1.0 });
    plant.turbulence =
        Turbulence { axial_rms_m_s: 0.11, lateral_rms_m_s: 0.17, axial_scale_m: 0.5, lateral_scale_m: 0.3, bandwidth: 0.0 };
    plant.shedding = WakeShedding { moment_rms: 0.013, strouhal: 0.21, bandwidth: 0.3 };
    plant.sensors = Sensors {
        wind_scale: 0.03,
        wind_delay_s: 0.011,
        pose_delay_s: 0.004,
        misalignment_rad: [0.02, -0.03, 0.04],
        length_scale: 0.05,
        time_base: 0.02,
        ..plant.sensors
    };
    plant
}

/// Coloured on two channels.
pub(super) fn noise() -> PerChannel<ChannelNoise> {
    let mut noise = [0.03, 0.04, 0.05, 0.07, 0.06, 0.08, 0.01].map(ChannelNoise::white);
    (noise[1].coloured, noise[1].correlation) = (0.0023, 0.8);
    (noise[4].coloured, noise[4].correlation) = (0.0041, 0.6);
    noise
}

/// Thirty nodes of three samples of a model that moves and turns steadily while the tunnel grows faster.
pub(super) fn run() -> Prepared {
    let (n, dt) = (90, 1.0 / 225.0);
    let t_s: Vec<f64> = (0..n).map(|i| f64::from(i) * dt).collect();
    let along = |from: f64, rate: f64| t_s.iter().map(|t| from + rate * t).collect::<Vec<f64>>();
    let record = Record {
        position_m: [along(0.1, 0.3), along(0.2, -0.5), along(-0.1, 0.4)],
        attitude_rad: [along(0.4, 0.7), along(0.25, -0.9), along(-0.3, 0.6)],
        vw_m_s: along(7.0, 0.4),
        ps_pa: vec![101_325.0; t_s.len()],
        ts_k: vec![299.0; t_s.len()],
        t_s,
        ..Record::default()
    };
    Prepared::new(0, "short", &record, 287.05, 3.0 * dt, &ChannelNoise::white(1e-5))
}

/// Crooked numbers of order one.
pub(super) fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut rng)
}

/// A state near the first, all of whose numbers differ from zero.
pub(super) fn state(f: &Filter<'_>, next: &mut impl FnMut() -> f64) -> Vec<f64> {
    let mut z = f.start();
    z[..f.states].iter_mut().for_each(|z| *z += 0.1 * next());
    z
}

/// Body to tunnel: about x, then the new y, then the new z (thesis eq. B.14).
fn turned(angles: [f64; 3]) -> Matrix3<f64> {
    let about = |axis: &nalgebra::Unit<Vector3<f64>>, angle: f64| Rotation3::from_axis_angle(axis, angle);
    let [x, y, z] = angles;
    (about(&Vector3::x_axis(), x) * about(&Vector3::y_axis(), y) * about(&Vector3::z_axis(), z)).into_inner()
}

/// The first state's origin is where the record starts and moves as the record does, and its body rates are `Rᵀ Ṙ`: by central differences
/// along a motion whose angles and origin change steadily (1e-5 s: 1e-10 of third derivatives of order one, rounding 1e-11).
#[test]
fn exact_start_moves_as_the_record() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    let z = f.start();
    let arm = Vector3::from(plant.vehicle.p_origin_cm.to_array());
    let q = run.start;
    let at = |t: f64| turned(std::array::from_fn(|k| q[3 + k][0] + t * q[3 + k][1]));
    let cm = |t: f64| Vector3::from_fn(|k, _| q[k][0] + t * q[k][1]) + at(t) * arm;
    const SMALL: f64 = 1e-5;
    let velocity = (cm(SMALL) - cm(-SMALL)) / (2.0 * SMALL);
    let w = at(0.0).transpose() * (at(SMALL) - at(-SMALL)) / (2.0 * SMALL);
    let rates = [w[(2, 1)], w[(0, 2)], w[(1, 0)]];
    for k in 0..3 {
        assert!((z[k] - cm(0.0)[k]).abs() < 1e-14 && (z[3 + k] - q[3 + k][0]).abs() < 1e-15);
        assert!((z[6 + k] - velocity[k]).abs() < 1e-9, "{k}: {} for {}", z[6 + k], velocity[k]);
        assert!((z[9 + k] - rates[k]).abs() < 1e-9, "{k}: {} for {}", z[9 + k], rates[k]);
    }
    // The record's lines, to what a cubic through them leaves.
    assert!((q[1][1] + 0.5).abs() < 1e-9 && (q[4][1] + 0.9).abs() < 1e-9);
    assert!((f.step_s - 3.0 / 225.0 / 1.02).abs() < 1e-15);
}

/// The first covariance: motion's as stated, a loose part's of a centimetre and of that times its frequency, nothing between motion and inputs;
/// inputs and coloured noise are as they stay: a step leaves their covariance.
#[test]
fn law_start_is_stationary() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    assert_eq!(f.states, MOTION + 3 * 3 + 2 * 2 + 2 * 2);
    let local = Local {
        rate: [0.0; MOTION],
        by_state: [[0.0; MOTION]; MOTION],
        by_added: [[0.0; ADDED]; MOTION],
        by_speed: [[0.0; 2]; MOTION],
    };
    let mut work = Work::new(&f);
    f.transition(2, &local, false, &mut work);
    let p = DMatrix::from_row_slice(f.n, f.n, &f.start_covariance(&f.random));
    let phi = DMatrix::from_row_slice(f.n, f.n, &work.phi);
    let next = &phi * &p * phi.transpose() + DMatrix::from_fn(f.n, f.n, |i, k| work.q[i.max(k) * f.n + i.min(k)]);
    for i in 0..f.n {
        for k in 0..f.n {
            if i >= MOTION && k >= MOTION {
                // Steps of a lag's exponential, 1e-8 of it at most.
                let scale = (p[(i, i)] * p[(k, k)]).sqrt();
                assert!((next[(i, k)] - p[(i, k)]).abs() <= 1e-9 * scale, "{i} {k}: {} {}", next[(i, k)], p[(i, k)]);
                continue;
            }
            let expected = match i {
                _ if i != k => 0.0,
                ..STATES => START_STD[i].powi(2),
                12 | 13 => 1e-4,
                _ => 1e-4 * (TAU * 2.3).powi(2),
            };
            assert!((p[(i, k)] - expected).abs() <= 1e-14 * expected, "{i} {k}");
        }
    }
    // Not of a smaller block than there is: all of inputs and noise vary.
    assert!((MOTION..f.states).all(|i| p[(i, i)] > 0.0));
}

/// Tunnel speed by instruments that lag and err: the record's speed later over its scale; its rate is the slope over true time, of which a
/// record's second has 1/(1 + time base), to h² of a smooth speed's third derivative.
#[test]
fn exact_speed_by_instruments() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    let (t, small) = (0.1234, 1e-5);
    let [speed, rate] = f.speed(&plant, t);
    // What the smoother makes of a ramp is the ramp within its noise of 1e-5 m/s.
    assert!((speed * 1.03 - (7.0 + 0.4 * (t + 0.011 - 0.004))).abs() < 1e-4, "{speed}");
    let slope = (f.speed(&plant, t + small)[0] - f.speed(&plant, t - small)[0]) / (2.0 * small);
    assert!((rate - slope * 1.02).abs() < 1e-8 && (rate * 1.03 / 1.02 - 0.4).abs() < 1e-2, "{rate} {slope}");
}

/// What a basis looks at: velocity through the air turned into the body, angles by its components (thesis B.42-B.48).
#[test]
fn exact_view_of_a_state() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    let mut z = state(&f, &mut numbers(1));
    // Gusts that are felt, each axis' first state.
    (z[MOTION], z[MOTION + 3], z[MOTION + 6]) = (0.7, -1.3, 2.1);
    let k = 7;
    let view = f.view(&z, k);
    let air = Vector3::new(-f.speed(&plant, run.nodes[k].t_s)[0] + 0.7, -1.3, 2.1);
    let u = turned([z[3], z[4], z[5]]).transpose() * (Vector3::new(z[6], z[7], z[8]) - air);
    for (found, expected) in [
        (view.speed_m_s, u.norm()),
        (view.alpha_rad, u[2].atan2(u[0])),
        (view.beta_rad, u[1].atan2(u[0])),
        (view.tunnel_speed_m_s, 0.7 - air[0]),
        (view.height_m, z[0]),
        (view.away_m[0], z[1]),
        (view.away_m[1], z[2]),
        (view.roll_rad, z[3]),
        (view.rates_rad_s[1], z[10]),
    ] {
        assert!((found - expected).abs() < 1e-13, "{found} for {expected}");
    }
}

/// What the air adds: each gust with what is not known of it, the rate of its lag, a tenth of its own time, behind `x + ζ T ẋ`, and moments of
/// the wake; in the quarters of a step the record's time.
#[test]
fn exact_air_adds_gusts_and_moments() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    let z = state(&f, &mut numbers(13));
    let (k, unknown) = (4, [0.3, -0.5, 0.7]);
    let added = f.air(&z, k, Stage::Now, unknown).1;
    for (axis, (scale_m, zeta)) in [(0.5, 1.0), (0.3, 3.0_f64.sqrt()), (0.3, 3.0_f64.sqrt())].into_iter().enumerate() {
        let q = &z[MOTION + 3 * axis..][..3];
        let lag_s = 0.1 * scale_m / run.speed_m_s;
        let rate = (q[1] + zeta * q[2] - q[0]) / lag_s;
        assert!((added[axis] - q[0] - unknown[axis]).abs() < 1e-15);
        assert!((added[3 + axis] - rate).abs() < 1e-12 * rate.abs(), "{axis}: {} for {rate}", added[3 + axis]);
    }
    // The pitching moment's oscillator comes first.
    for (found, expected) in added[6..].iter().zip([0.0, 0.0, 0.0, 0.0, z[MOTION + 9], z[MOTION + 11]]) {
        assert!((found - expected).abs() < 1e-15);
    }
    let air = f.air(&z, k, Stage::Quarter(3), [0.0; 3]).0;
    assert!((air.t_s - run.nodes[k].t_s - 0.75 * 3.0 / 225.0).abs() < 1e-15);
}

/// A trace has a transition from each node to the next, and none from the last.
#[test]
fn law_trace_ends_at_the_last_node() {
    let (plant, noise, run) = (plant(), noise(), run());
    let seen = pass(&run, &PassSetting { keep: Keep::Trace, ..PassSetting::plain(&plant, &noise) }).expect("a pass");
    let (last, others) = seen.trace.nodes.split_last().expect("nodes");
    assert_eq!(others.len(), 29);
    assert!(last.phi.is_empty() && others.iter().all(|node| node.phi.len() == seen.states * seen.states));
}

/// What the tunnel speed's record lacks by its drift is air along the stream, as its transition has it.
#[test]
fn exact_a_drift_of_the_speed_is_air_along_the_stream() {
    let (mut plant, noise, run) = (plant(), noise(), run());
    plant.drift.speed_rms_m_s = 0.05;
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    let mut z = f.start();
    let added = |z: &[f64]| f.air(z, 4, Stage::Now, [0.0; 3]).1;
    let still = added(&z);
    let (at, _) = f.inputs().find(|(_, input)| input.entry == Entry::RecordedSpeed).expect("a drift");
    z[at] += 0.3;
    let moved = added(&z);
    assert!((moved[0] - still[0] - 0.3).abs() < 1e-15 && moved[1..] == still[1..], "{moved:?} {still:?}");
}
