//! pid: how lively the tunnel speed is. In: its noisy record. Out: intensity of the jerk that moves it, and the noise on top.
//!
//! The true tunnel speed is taken as twice integrated Brownian motion, which a smoothing spline of fifth degree estimates
//! (Wahba 1978): `d²V_W/dt²` wanders with intensity q. q and the sensor's variance maximise the likelihood of the record alone
//! (Kalman filter, variance concentrated out; Harvey 1989, §3.4).

use nalgebra::{Matrix3, Vector3};

/// Liveliness of a tunnel-speed record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Liveliness {
    /// Intensity q of the wandering second derivative, (m/s³)²/s.
    pub intensity: f64,
    /// Standard deviation of the sensor's noise, m/s.
    pub noise_std: f64,
}

/// Decades of q/σ² (per s⁵) searched, and the width at which the search ends.
const DECADES: [f64; 2] = [-6.0, 10.0];
const WIDTH: f64 = 0.02;

/// Most likely liveliness of a record sampled every `interval_s`.
pub fn liveliness(speed_m_s: &[f64], interval_s: f64) -> Liveliness {
    let decade = crate::golden::minimise(|x| filter(speed_m_s, interval_s, 10.0_f64.powf(x)).0, DECADES, WIDTH);
    let ratio = 10.0_f64.powf(decade);
    let variance = filter(speed_m_s, interval_s, ratio).1;
    Liveliness { intensity: ratio * variance, noise_std: variance.sqrt() }
}

/// Minus twice the concentrated log-likelihood (up to a constant) and the sensor's variance, at a ratio q/σ².
fn filter(y: &[f64], h: f64, ratio: f64) -> (f64, f64) {
    #[rustfmt::skip]
    let phi = Matrix3::new(
        1.0, h,   0.5 * h * h,
        0.0, 1.0, h,
        0.0, 0.0, 1.0,
    );
    let first = y.first().copied().unwrap_or(0.0);
    let mut x = Vector3::new(first, 0.0, 0.0);
    // Nothing known of speed and its derivatives, against a noise variance of one.
    let mut p = Matrix3::from_diagonal(&Vector3::new(1e8, 1e8, 1e8));
    let (mut squares, mut logs, mut count) = (0.0, 0.0, 0.0);
    for (i, y) in y.iter().enumerate() {
        let s = p[(0, 0)] + 1.0;
        let innovation = y - x[0];
        // The first three innovations only fix the state.
        if i >= 3 {
            squares += innovation * innovation / s;
            logs += s.ln();
            count += 1.0;
        }
        let gain = p.column(0) / s;
        x += gain * innovation;
        p -= gain * p.row(0);
        p = 0.5 * (p + p.transpose());
        x = phi * x;
        p = phi * p * phi.transpose();
        p[(2, 2)] += ratio * h;
    }
    let variance = (squares / f64::max(count, 1.0)).max(f64::MIN_POSITIVE);
    (count * variance.ln() + logs, variance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn recover_planted_liveliness_and_noise() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (h, q, std) = (1.0 / 150.0, 0.04, 2.5e-3);
        let (mut v, mut a, mut b) = (7.4, 0.0, 0.0);
        let mut speed = Vec::new();
        for _ in 0..6000 {
            speed.push(v + std * normal());
            v += h * (a + 0.5 * h * b);
            a += h * b;
            b += (q * h).sqrt() * normal();
        }
        let found = liveliness(&speed, h);
        // Variance of noise: 2/6000, three sigma and a little. Intensity: some 120 effective numbers, so 13 % a sigma.
        assert!((found.noise_std / std - 1.0).abs() < 0.03, "{found:?}");
        assert!((found.intensity / q).ln().abs() < 0.5, "{found:?}");
    }
}
