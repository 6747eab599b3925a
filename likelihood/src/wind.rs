//! likelihood: how lively the tunnel speed is. In: its noisy record and its noise. Out: intensity of the wandering second derivative.
//!
//! The true tunnel speed is twice integrated Brownian motion (Wahba 1978); its intensity maximises the likelihood of the record alone,
//! filtered sample by sample with the noise that was learnt, coloured or not (Harvey 1989, §3.4).

use crate::noise::ChannelNoise;
use nalgebra::{Matrix4, Vector4};

/// Decades of intensity over the noise's variance (per s⁵) searched, and the width at which the search ends.
const DECADES: [f64; 2] = [-6.0, 8.0];
const WIDTH: f64 = 0.05;

/// Root of the most likely intensity, m/s³ per root second.
pub(crate) fn jerk_root(speed_m_s: &[f64], interval_s: f64, noise: &ChannelNoise) -> f64 {
    let variance = (noise.white + noise.coloured).max(1e-12);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let value = |x: f64| cost(speed_m_s, interval_s, noise, 10.0_f64.powf(x) * variance);
    let [mut a, mut b] = DECADES;
    let (mut c, mut d) = (b - golden * (b - a), a + golden * (b - a));
    let (mut at_c, mut at_d) = (value(c), value(d));
    while b - a > WIDTH {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = value(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = value(d);
        }
    }
    (10.0_f64.powf(0.5 * (a + b)) * variance).sqrt()
}

/// Minus twice the log-likelihood, up to a constant.
fn cost(y: &[f64], h: f64, noise: &ChannelNoise, intensity: f64) -> f64 {
    let r = noise.correlation;
    #[rustfmt::skip]
    let phi = Matrix4::new(
        1.0, h,   0.5 * h * h, 0.0,
        0.0, 1.0, h,           0.0,
        0.0, 0.0, 1.0,         0.0,
        0.0, 0.0, 0.0,         r,
    );
    let mut x = Vector4::new(y.first().copied().unwrap_or(0.0), 0.0, 0.0, 0.0);
    let mut p = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 25.0, noise.coloured));
    let white = noise.white.max(1e-6 * noise.coloured);
    let mut sum = 0.0;
    for y in y {
        let ph = p.column(0) + p.column(3);
        let s = ph[0] + ph[3] + white;
        let innovation = y - x[0] - x[3];
        sum += innovation * innovation / s + s.ln();
        let gain = ph / s;
        x += gain * innovation;
        p -= gain * ph.transpose();
        x = phi * x;
        p = phi * p * phi.transpose();
        p = 0.5 * (p + p.transpose());
        p[(2, 2)] += intensity * h;
        p[(3, 3)] += noise.coloured * (1.0 - r * r);
    }
    sum
}
