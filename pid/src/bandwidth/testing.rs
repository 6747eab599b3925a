//! pid: noise, motion and filters for the tests of bandwidth.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{PI, TAU};

pub(super) fn white(seed: u64, n: usize, std: f64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    (0..n).map(|_| std * draw()).collect()
}

/// First-order noise of that standard deviation and correlation from one row to the next.
pub(super) fn coloured(seed: u64, n: usize, std: f64, correlation: f64) -> Vec<f64> {
    let drive = std * (1.0 - correlation * correlation).sqrt();
    let step = |last: &mut f64, w: f64| {
        *last = correlation * *last + w;
        Some(*last)
    };
    white(seed + 77, n, drive).into_iter().scan(0.0, step).collect()
}

/// Noise of that standard deviation with a resonance: frequency as a share of the rate, quality factor.
pub(super) fn resonance(seed: u64, n: usize, std: f64, frequency: f64, quality: f64) -> Vec<f64> {
    let radius = (-PI * frequency / quality).exp();
    let (first, second) = (2.0 * radius * (TAU * frequency).cos(), -radius * radius);
    let step = |last: &mut [f64; 2], w: f64| {
        *last = [first * last[0] + second * last[1] + w, last[0]];
        Some(last[0])
    };
    let all: Vec<f64> = white(seed + 991, n + 2000, 1.0).into_iter().scan([0.0; 2], step).skip(2000).collect();
    let size = (all.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt();
    all.iter().map(|x| std * x / size).collect()
}

/// Two modes of about 1 Hz that decay, and a slow one.
pub(super) fn motion(n: usize, rate_hz: f64, amplitude: f64, which: u64) -> Vec<f64> {
    let shift = which as f64;
    let at = |t: f64| {
        (-0.1 * t).exp() * (TAU * 0.96 * t + shift).sin() + 0.3 * (TAU * 0.31 * t).cos() + 0.05 * (TAU * 1.9 * t + shift).sin()
    };
    (0..n).map(|i| amplitude * at(i as f64 / rate_hz)).collect()
}

/// Butterworth's filter of that order by the bilinear transform, corner as a share of the rate, from rest at the first value.
pub(super) fn butterworth(x: &[f64], order: usize, corner: f64) -> Vec<f64> {
    let k = (PI * corner).tan();
    let first = x[0];
    let mut y: Vec<f64> = x.iter().map(|v| v - first).collect();
    for pair in 0..order / 2 {
        let angle = if order.is_multiple_of(2) {
            PI * (2 * pair + 1) as f64 / (2 * order) as f64
        } else {
            PI * (pair + 1) as f64 / order as f64
        };
        let (damping, whole) = (2.0 * angle.cos(), 1.0 + 2.0 * angle.cos() * k + k * k);
        let gain = k * k / whole;
        run(&mut y, [gain, 2.0 * gain, gain], [2.0 * (k * k - 1.0) / whole, (1.0 - damping * k + k * k) / whole]);
    }
    if order % 2 == 1 {
        let gain = k / (1.0 + k);
        run(&mut y, [gain, gain, 0.0], [(k - 1.0) / (k + 1.0), 0.0]);
    }
    y.iter().map(|v| v + first).collect()
}

fn run(y: &mut [f64], b: [f64; 3], a: [f64; 2]) {
    let (mut z, mut w) = (0.0, 0.0);
    for v in y {
        let out = b[0] * *v + z;
        z = b[1] * *v - a[0] * out + w;
        w = b[2] * *v - a[1] * out;
        *v = out;
    }
}

pub(super) fn forward_backward(x: &[f64], filter: &dyn Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let mut y = filter(x);
    y.reverse();
    let mut y = filter(&y);
    y.reverse();
    y
}

/// Rows at a rate on straight lines between samples of another, from the first sample on.
pub(super) fn on_straight_lines(samples: &[f64], from_hz: f64, to_hz: f64) -> Vec<f64> {
    let last = (samples.len() - 1) as f64;
    (0..)
        .map(|i| f64::from(i) * from_hz / to_hz)
        .take_while(|at| *at <= last + 1e-9)
        .map(|at| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place among the samples")]
            let j = ((at + 1e-9) as usize).min(samples.len() - 2);
            samples[j] + (at - j as f64) * (samples[j + 1] - samples[j])
        })
        .collect()
}
