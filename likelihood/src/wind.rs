//! likelihood: tunnel speed. In: its noisy record and its noise. Out: the speed at any time, and what the record's noise does to the motion.
//!
//! The true tunnel speed is twice integrated Brownian motion (Wahba 1978); its intensity maximises the likelihood of the record alone,
//! filtered sample by sample with the noise that was learnt, coloured or not (Harvey 1989, §3.4), and it is smoothed (Bryson and Frazier
//! 1963). It enters the motion as a known input: whoever throttles the tunnel watches the model, so that speed and gusts are not
//! independent, and a likelihood of both would take the one for the other. What the smoother leaves is white below its bandwidth,
//! at the density of the record's own noise, and acts on the motion as such.

use crate::noise::ChannelNoise;
use nalgebra::{Matrix4, Vector4};

/// Decades of intensity over the noise's variance (per s⁵) searched, and the width at which the search ends.
const DECADES: [f64; 2] = [-6.0, 8.0];
const WIDTH: f64 = 0.05;
/// Samples in which the first speed and its derivatives are found; their innovations say little of the noise.
const SETTLED: usize = 50;

/// A run's tunnel speed.
#[derive(Clone, Debug)]
pub(crate) struct Speed {
    /// Time of the first sample, s.
    start_s: f64,
    interval_s: f64,
    /// Speed (m/s) and its rate (m/s²) at the samples.
    smoothed: Vec<[f64; 2]>,
    /// Density of what is left of the record's noise, (m/s)² s.
    pub(crate) density: f64,
    /// Sums over the record's innovations: squares, expected squares, squares over expected, count.
    pub(crate) innovations: [f64; 4],
}

impl Speed {
    pub(crate) fn new(record_m_s: &[f64], interval_s: f64, noise: &ChannelNoise, missing: &dyn Fn(usize) -> bool) -> Self {
        let measured: Vec<Option<f64>> = record_m_s.iter().enumerate().map(|(i, v)| (!missing(i)).then_some(*v)).collect();
        let variance = (noise.white + noise.coloured).max(1e-12);
        let filter = |decade: f64| Filter::new(interval_s, noise, 10.0_f64.powf(decade) * variance);
        let decade = windfall_pid::golden::minimise(|x| filter(x).cost(&measured), DECADES, WIDTH);
        let (smoothed, innovations) = filter(decade).smooth(&measured);
        let share = measured.iter().flatten().count() as f64 / measured.len().max(1) as f64;
        let r = noise.correlation;
        let density = (noise.white + noise.coloured * (1.0 + r) / (1.0 - r)) * interval_s / share.max(0.01);
        Self { start_s: 0.0, interval_s, smoothed, density, innovations }
    }

    /// The same with its first sample at that time of the record, s.
    pub(crate) fn from(self, start_s: f64) -> Self {
        Self { start_s, ..self }
    }

    /// Speed and its rate at a time of the record, by Hermite's cubic; beyond the ends the first or last speed.
    pub(crate) fn at(&self, t_s: f64) -> [f64; 2] {
        let (h, last) = (self.interval_s, self.smoothed.len() - 1);
        let x = (t_s - self.start_s) / h;
        if x <= 0.0 || last == 0 {
            return [self.smoothed[0][0], 0.0];
        }
        if x >= last as f64 {
            return [self.smoothed[last][0], 0.0];
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the last sample")]
        let i = x as usize;
        let s = x - i as f64;
        let ([p, m], [q, n]) = (self.smoothed[i], self.smoothed[(i + 1).min(last)]);
        let (m, n, s2) = (m * h, n * h, s * s);
        let (a, b) = (2.0 * (p - q) + m + n, 3.0 * (q - p) - 2.0 * m - n);
        [p + s * m + s2 * (b + s * a), (m + 2.0 * s * b + 3.0 * s2 * a) / h]
    }
}

/// Value, two derivatives, coloured noise.
struct Filter {
    phi: Matrix4<f64>,
    added: Vector4<f64>,
    white: f64,
    coloured: f64,
}

impl Filter {
    fn new(h: f64, noise: &ChannelNoise, intensity: f64) -> Self {
        let r = noise.correlation;
        #[rustfmt::skip]
        let phi = Matrix4::new(
            1.0, h,   0.5 * h * h, 0.0,
            0.0, 1.0, h,           0.0,
            0.0, 0.0, 1.0,         0.0,
            0.0, 0.0, 0.0,         r,
        );
        let added = Vector4::new(0.0, 0.0, intensity * h, noise.coloured * (1.0 - r * r));
        Self { phi, added, white: noise.white.max(1e-6 * noise.coloured).max(1e-18), coloured: noise.coloured }
    }

    fn start(&self, y: &[Option<f64>]) -> (Vector4<f64>, Matrix4<f64>) {
        let first = y.iter().flatten().next().copied().unwrap_or(0.0);
        (Vector4::new(first, 0.0, 0.0, 0.0), Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 25.0, self.coloured)))
    }

    /// Innovation, its variance, and P Hᵀ.
    fn innovation(&self, y: f64, x: &Vector4<f64>, p: &Matrix4<f64>) -> (f64, f64, Vector4<f64>) {
        let ph = p.column(0) + p.column(3);
        (y - x[0] - x[3], ph[0] + ph[3] + self.white, ph)
    }

    fn predict(&self, x: &mut Vector4<f64>, p: &mut Matrix4<f64>) {
        *x = self.phi * *x;
        *p = self.phi * *p * self.phi.transpose() + Matrix4::from_diagonal(&self.added);
        *p = 0.5 * (*p + p.transpose());
    }

    /// Minus twice the log-likelihood, up to a constant.
    fn cost(&self, y: &[Option<f64>]) -> f64 {
        let (mut x, mut p) = self.start(y);
        let mut sum = 0.0;
        for y in y {
            if let Some(y) = y {
                let (nu, s, ph) = self.innovation(*y, &x, &p);
                sum += nu * nu / s + s.ln();
                x += ph * (nu / s);
                p -= ph * ph.transpose() / s;
            }
            self.predict(&mut x, &mut p);
        }
        sum
    }

    /// Smoothed value and rate, and sums over the innovations.
    fn smooth(&self, y: &[Option<f64>]) -> (Vec<[f64; 2]>, [f64; 4]) {
        let (mut x, mut p) = self.start(y);
        let mut sums = [0.0; 4];
        // After each update: state, covariance, and what the sample said.
        let mut kept = Vec::with_capacity(y.len());
        for (k, y) in y.iter().enumerate() {
            let mut said = None;
            if let Some(y) = y {
                let (nu, s, ph) = self.innovation(*y, &x, &p);
                if k >= SETTLED {
                    sums = [sums[0] + nu * nu, sums[1] + s, sums[2] + nu * nu / s, sums[3] + 1.0];
                }
                x += ph * (nu / s);
                p -= ph * ph.transpose() / s;
                said = Some((nu / s, ph / s));
            }
            kept.push((x, p, said));
            self.predict(&mut x, &mut p);
        }
        let mut later = Vector4::zeros();
        let mut smoothed = vec![[0.0; 2]; y.len()];
        for (k, (x, p, said)) in kept.iter().enumerate().rev() {
            let best = x - p * later;
            smoothed[k] = [best[0], best[1]];
            if let Some((weight, gain)) = said {
                // (I - K H)ᵀ λ - Hᵀ ν / s, with H = (1, 0, 0, 1).
                let back = gain.dot(&later) + weight;
                later[0] -= back;
                later[3] -= back;
            }
            later = self.phi.transpose() * later;
        }
        (smoothed, sums)
    }
}

#[cfg(test)]
mod tests;
