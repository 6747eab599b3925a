//! sim tests: chance. In: spectra and standard deviations. Out: whether realisations have them.

use crate::common::*;
use std::f64::consts::PI;
use windfall_model::{Disturbance, Entry, Operator, Release, Shape, TunnelSpeed, Turbulence, WakeShedding};
use windfall_sim::{Channel, Seed, fly, fly_truth, realise};

const SHAPES: [Shape; 4] = [
    Shape::DrydenLongitudinal { time_s: 0.08 },
    Shape::DrydenLateral { time_s: 0.08 },
    Shape::Narrow { centre_rad_s: 12.0, bandwidth_rad_s: 3.0 },
    Shape::Band { centre_rad_s: 12.0, bandwidth_rad_s: 18.0 },
];

fn samples(shape: Shape, run: u64, n: usize, h: f64) -> Vec<f64> {
    let d = Disturbance { entry: Entry::AirVelocity(0), rms: 0.3, shape };
    realise(&d, h, n, Seed { campaign: 11, run }.normals(Channel::Gust(0)))
}

/// Variance of 2000 s: its sampling error is `√(2 t_c/T)` with a correlation time t_c near 0.1-0.7 s, 3 % at most; four of them.
#[test]
fn law_realised_rms() {
    for (run, shape) in (0..).zip(SHAPES) {
        let x = samples(shape, run, 400_000, 0.005);
        let variance = x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64;
        assert!((variance / 0.09 - 1.0).abs() < 0.1, "{shape:?}: {variance}");
        // Started from its stationary covariance: the first samples of many runs have it too (400 runs: 7 %, four of them).
        let first = (0..400).map(|run| samples(shape, run, 1, 0.005)[0].powi(2)).sum::<f64>() / 400.0;
        assert!((first / 0.09 - 1.0).abs() < 0.28, "{shape:?}: {first}");
    }
}

/// Periodogram, averaged over 400 windows of 20 s and 9 neighbouring frequencies (error 1/√3600 = 1.7 %; five of them and 3 %
/// for the Hann window's width), against `Disturbance::density`.
#[test]
fn law_realised_spectrum() {
    let (h, n) = (0.005, 4000);
    for shape in SHAPES {
        let d = Disturbance { entry: Entry::AirVelocity(0), rms: 0.3, shape };
        let x = samples(shape, 5, n * 400, h);
        for bin in [10, 20, 40, 60, 100, 200] {
            let found = (bin - 4..=bin + 4).map(|b| density_at(&x, n, h, b)).sum::<f64>() / 9.0;
            let expected = (bin - 4..=bin + 4).map(|b| d.density(2.0 * PI * b as f64 / (n as f64 * h))).sum::<f64>() / 9.0;
            assert!((found / expected - 1.0).abs() < 0.12, "{shape:?} bin {bin}: {found} against {expected}");
        }
    }
}

/// One-sided density per rad/s at one frequency, Hann window, averaged over windows of n samples.
fn density_at(x: &[f64], n: usize, h: f64, bin: usize) -> f64 {
    let table: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            let (hann, angle) = (1.0 - (2.0 * PI * i as f64 / n as f64).cos(), 2.0 * PI * (bin * i % n) as f64 / n as f64);
            (hann * angle.cos(), hann * angle.sin())
        })
        .collect();
    let power = |w: &[f64]| {
        let (c, s) = w.iter().zip(&table).fold((0.0, 0.0), |(c, s), (x, (tc, ts))| (c + x * tc, s + x * ts));
        c * c + s * s
    };
    let mean = x.chunks_exact(n).map(power).sum::<f64>() / (x.len() / n) as f64;
    // Mean square of the Hann window is 1.5; one-sided in rad/s: 2 h/(2π).
    mean * h / (n as f64 * 1.5) / PI
}

/// Gusts reach the flight with their size: airspeed along and angle across, of a body too heavy to follow them.
#[test]
fn law_gusts_act_with_their_rms() {
    let mut plant = lander();
    plant.tether = None;
    plant.vehicle.mass_kg = 1e9;
    plant.environment.gravity_m_s2 = 0.0;
    let inertia = &mut plant.vehicle.inertia;
    (inertia.xx, inertia.yy, inertia.zz) = (1e9, 1e9, 1e9);
    plant.turbulence =
        Turbulence { axial_rms_m_s: 0.2, lateral_rms_m_s: 0.3, axial_scale_m: 0.6, lateral_scale_m: 0.6, bandwidth: 0.0 };
    let mut order = flight(600.0, 50.0, 7.43, REST);
    order.numerics.relative_tolerance = 1e-5;
    order.numerics.absolute_tolerance = 1e-7;
    let (truth, _) = fly_truth(&plant, &order, Seed { campaign: 3, run: 0 }).expect("flies");
    let n = truth.len() as f64;
    let lateral = truth.alpha_t_rad.iter().zip(&truth.airspeed_m_s).map(|(a, v)| (v * a.sin()).powi(2)).sum::<f64>() / n;
    let axial = truth.alpha_t_rad.iter().zip(&truth.airspeed_m_s).map(|(a, v)| (v * a.cos() - 7.43).powi(2)).sum::<f64>() / n;
    // Sampling error of the variance √(2·0.1/600) = 2 %, interpolation takes up to 3 %.
    assert!((lateral / 0.18 - 1.0).abs() < 0.1, "{lateral}");
    assert!((axial / 0.04 - 1.0).abs() < 0.1, "{axial}");
}

/// Wake shedding shakes the model in pitch and yaw and leaves the air alone.
#[test]
fn law_wake_shedding_acts_as_moment() {
    let mut plant = lander();
    plant.aero.values[3] = 0.0;
    let mut order = flight(5.0, 50.0, 7.43, REST);
    order.numerics.relative_tolerance = 1e-7;
    let still = flown(&plant, &order);
    plant.shedding = WakeShedding { moment_rms: 0.05, strouhal: 0.05, bandwidth: 0.3 };
    let shaken = flown(&plant, &order);
    assert!(still.w_tunnel_body.iter().all(|w| worst(w, &[0.0; 3]) < 1e-9));
    let peak = |axis: usize| shaken.w_tunnel_body.iter().fold(0.0_f64, |a, w| a.max(w[axis].abs()));
    assert!(peak(1) > 0.05 && peak(2) > 0.05 && peak(0) < 0.01, "{} {} {}", peak(0), peak(1), peak(2));
    // The air itself is steady: before the model has moved, nothing is seen of it.
    assert!(worst(&[shaken.airspeed_m_s[0], shaken.alpha_t_rad[0]], &[7.43, 0.0]) < 1e-12);
}

/// The unsteady hand, seen through a very slow model and no gains: its rms after a short lag, and speed correlated over its time.
#[test]
fn law_unsteady_hand_has_its_rms() {
    let plant = lander();
    let hand = Operator {
        trim_m_s: Some(7.4),
        height_gain_per_s: 0.0,
        rate_gain: 0.0,
        integral_gain_per_s2: 0.0,
        lag_s: 0.01,
        unsteady_rms_m_s: 0.2,
        unsteady_time_s: 1.0,
        hold_x_m: 0.0,
    };
    let mut order = flight(1500.0, 10.0, 0.0, REST);
    order.speed = TunnelSpeed::Operator(hand);
    order.numerics.relative_tolerance = 1e-5;
    order.numerics.absolute_tolerance = 1e-6;
    let truth = flown(&plant, &order);
    let e: Vec<f64> = truth.vw_m_s.iter().map(|v| v - 7.4).collect();
    let covariance = |lag: usize| e.iter().zip(&e[lag..]).map(|(a, b)| a * b).sum::<f64>() / (e.len() - lag) as f64;
    // Sampling error of the variance √(2·1/1500) = 4 %; three of them. Correlation at half its time: (1 + 1) e^{−1}.
    assert!((covariance(0) / 0.04 - 1.0).abs() < 0.13, "{}", covariance(0));
    assert!((covariance(5) / covariance(0) - 2.0 * (-1.0_f64).exp()).abs() < 0.05);
}

/// Noise of each sensor has the stated deviation and is the same whatever else is random.
#[test]
fn law_sensor_noise_is_its_own() {
    let mut plant = lander();
    plant.sensors = crate::instruments::sensors();
    let mut order = flight(20.0, 150.0, 7.43, Release { rates_rad_s: [0.1, 0.1, 0.0], ..REST });
    order.sensor_noise = true;
    let seed = Seed { campaign: 5, run: 2 };
    let noise = |plant: &windfall_model::Plant| {
        let noisy = fly(plant, &order, seed).expect("flies").record;
        let clean = fly(plant, &windfall_model::Flight { sensor_noise: false, ..order.clone() }, seed).expect("flies").record;
        let differences = |k: usize| noisy.channels()[k].iter().zip(clean.channels()[k]).map(|(a, b)| a - b).collect();
        std::array::from_fn::<Vec<f64>, 7, _>(differences)
    };
    let calm = noise(&plant);
    let std = [7.5e-4, 7.5e-4, 7.5e-4, 0.0623_f64.to_radians(), 0.11_f64.to_radians(), 0.11_f64.to_radians(), 2.57e-3];
    for (series, std) in calm.iter().zip(std) {
        let found = (series.iter().map(|x| x * x).sum::<f64>() / series.len() as f64).sqrt();
        // 3001 samples: 1.3 %, four of them.
        assert!((found / std - 1.0).abs() < 0.055, "{found} {std}");
    }
    plant.turbulence =
        Turbulence { axial_rms_m_s: 0.1, lateral_rms_m_s: 0.1, axial_scale_m: 0.6, lateral_scale_m: 0.6, bandwidth: 0.0 };
    order.numerics.relative_tolerance = 1e-6;
    let gusty = noise_of(&plant, &order, seed);
    for (a, b) in calm.iter().zip(&gusty) {
        assert!(worst(a, b) < 1e-12);
    }
}

fn noise_of(plant: &windfall_model::Plant, order: &windfall_model::Flight, seed: Seed) -> [Vec<f64>; 7] {
    let noisy = fly(plant, order, seed).expect("flies").record;
    let clean = fly(plant, &windfall_model::Flight { sensor_noise: false, ..order.clone() }, seed).expect("flies").record;
    std::array::from_fn(|k| noisy.channels()[k].iter().zip(clean.channels()[k]).map(|(a, b)| a - b).collect())
}
