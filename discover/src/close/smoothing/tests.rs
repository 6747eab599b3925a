//! discover tests: spectra of records against white noise, a swing and Fourier sums written out; units of the page.

use super::*;
use crate::close::tests::sage;
use rand::SeedableRng as _;
use rand_distr::{Distribution, StandardNormal};

/// White noise of standard deviation σ has the one-sided density 2σ²Δt at every frequency; a drift adds nothing. Bands above 5 Hz
/// hold 200 lines and more of two runs: each is within 5/√200 of it.
#[test]
fn exact_density_of_white_noise() {
    let (dt, std) = (1.0 / 150.0, 0.3);
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut run = |n: usize, slope: f64| -> Vec<f64> {
        (0..n).map(|i| slope * i as f64 + std * Distribution::<f64>::sample(&StandardNormal, &mut rng)).collect()
    };
    let (a, b) = (run(6000, 0.01), run(9000, -0.02));
    let found = density(&[(&a, dt), (&b, dt)]);
    let above: Vec<_> = found.iter().filter(|(f, _)| *f > 5.0).collect();
    assert!(above.len() > 20);
    for (f, p) in above {
        assert!((p / (2.0 * std * std * dt) - 1.0).abs() < 5.0 / 200.0_f64.sqrt(), "{f} Hz: {p}");
    }
}

/// A swing stands in the band of its frequency, a ninetieth of three decades wide, and a drift beside it in none.
#[test]
fn exact_place_of_a_swing() {
    let (dt, f) = (0.01, 3.0);
    let x: Vec<f64> =
        (0..10_000).map(|i| f64::from(i) * dt).map(|t| 2.0 * (std::f64::consts::TAU * f * t).cos() + 0.5 * t).collect();
    let found = density(&[(&x, dt)]);
    let top = found.iter().max_by(|a, b| a.1.total_cmp(&b.1)).expect("bands");
    let width = 5000.0_f64.powf(1.0 / BANDS as f64) - 1.0;
    assert!((top.0 / f - 1.0).abs() < width, "{}", top.0);
    let far =
        found.iter().filter(|(at, _)| !(0.5..2.0).contains(&(at / f))).map(|p| p.1).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    assert!(far < 1e-4 * top.1, "{far} of {}", top.1);
}

#[test]
fn exact_a_line_leaves_nothing() {
    let x: Vec<f64> = (0..50).map(|i| 3.0 - 0.25 * f64::from(i)).collect();
    assert!(without_line(&x).iter().all(|v| v.abs() < 1e-12));
    // Far from zero too: three numbers a last bit apart from one to the next.
    let far = 2.0_f64.powi(40);
    let bit = far * f64::EPSILON;
    let x = [far, far + bit, far + 2.0 * bit];
    assert!(without_line(&x).iter().all(|v| v.abs() < 0.1 * bit), "{:?}", without_line(&x));
}

/// Nine samples have four lines, each in a band of its own: 2 Δt |Σ w e^(−2πi k j/n) e|²/Σ w² of what the straight line by a
/// factorisation leaves.
#[test]
fn exact_density_of_nine_samples() {
    let (n, dt, tau) = (9, 0.3, std::f64::consts::TAU);
    let x: Vec<f64> = (0..n).map(|j| (0.7 * (j * j) as f64).sin() + 0.4 * j as f64).collect();
    let a = nalgebra::DMatrix::from_fn(n, 2, |j, k| if k == 0 { 1.0 } else { j as f64 });
    let b = nalgebra::DVector::from_column_slice(&x);
    let left = &b - &a * a.clone().svd(true, true).solve(&b, 1e-12).expect("a line");
    let taper: Vec<f64> = (0..n).map(|j| (0.5 * tau * (2 * j + 1) as f64 / (2 * n) as f64).sin()).collect();
    let found = density(&[(&x, dt)]);
    assert_eq!(found.len(), 4);
    for (k, (f, power)) in (1..).zip(found) {
        let along = |of: fn(f64) -> f64| (0..n).map(|j| taper[j] * left[j] * of(tau * (k * j) as f64 / n as f64)).sum::<f64>();
        let expected = 2.0 * dt * (along(f64::cos).powi(2) + along(f64::sin).powi(2)) / taper.iter().map(|w| w * w).sum::<f64>();
        assert!((f - k as f64 / 2.7).abs() < 1e-12 && (power - expected).abs() < 1e-12, "{k}: {power} {expected}");
    }
}

/// Angles in degrees, and their noise and spectra: white noise of σ has the amplitude σ √(2 Δt).
#[test]
fn exact_units_of_the_page() {
    let c = sage(1.5);
    let Data::Tunnel(record) = &c.runs[0].data else { panic!("a tunnel run") };
    let all = smoothing(&c, &Smoother::Spline { knot_s: 0.1 }).expect("smooths");
    // Six digits are kept.
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * b.abs();
    for (channel, rad, std_rad) in [
        (3, &record.attitude_rad[0], c.plant.sensors.roll_std_rad),
        (5, &record.attitude_rad[2], c.plant.sensors.pitch_yaw_std_rad),
    ] {
        let degrees: Vec<f64> = rad.iter().map(|x| x.to_degrees()).collect();
        let signal = &all.signals.runs[0].channels[channel];
        assert!(signal.measured.iter().zip(&degrees).all(|(a, b)| near(*a, *b)) && signal.measured.len() == degrees.len());
        assert!(near(signal.noise_std.expect("stated"), std_rad.to_degrees()));
        let raw = &all.spectra[channel].series[0];
        let expected = density(&[(&degrees, record.interval_s())]);
        assert!(
            raw.x.len() == expected.len() && raw.y.iter().zip(expected).all(|(y, (_, power))| near(*y, power.sqrt())),
            "{raw:?}"
        );
        let noise = &all.spectra[channel].series[2];
        let level = std_rad.to_degrees() * (2.0 * record.interval_s()).sqrt();
        assert!(noise.role == Role::Noise && noise.y.iter().all(|y| near(*y, level)), "{noise:?} {level}");
    }
}
