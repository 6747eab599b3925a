//! verify: spectra of tunnel runs. In: series by sample, raw spectra. Out: projections under the taper; covariances of real and
//! imaginary parts, averaged over neighbouring frequencies.

use super::super::evidence::{BIN, Cov, Residual};
use nalgebra::{Complex, SMatrix};
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Nothing is taken from this much at either end, s: there the windows are off-centre and noisier than inside.
pub(super) const QUIET_S: f64 = 0.2;
/// Rise of the taper at both ends, s.
pub(super) const RAMP_S: f64 = 0.4;
/// Part of itself added to the diagonal of a measured covariance, so that it can be factored.
const RIDGE: f64 = 1e-2;

/// Cross-spectrum of the six channels at one frequency.
pub(super) type Spectrum = SMatrix<Complex<f64>, 6, 6>;

/// Sine and cosine projections of a run at one sample rate.
pub(super) struct Projector {
    taper: Vec<f64>,
    fft: Arc<dyn RealToComplex<f64>>,
    scale: f64,
    bins: usize,
}

impl Projector {
    pub(super) fn new(samples: usize, interval_s: f64, bins: usize) -> Self {
        let taper: Vec<f64> = (0..samples)
            .map(|i| {
                // A function of time alone, so that projections at two sample rates agree; sin⁴ keeps their aliases below 1e-8.
                let edge = (i.min(samples - i) as f64 * interval_s - QUIET_S).max(0.0);
                if edge >= RAMP_S { 1.0 } else { (std::f64::consts::FRAC_PI_2 * edge / RAMP_S).sin().powi(4) }
            })
            .collect();
        let power: f64 = taper.iter().map(|w| w * w).sum();
        // |Z|² is then the one-sided density per rad/s.
        let scale = (interval_s / (std::f64::consts::PI * power)).sqrt();
        Self { taper, fft: RealFftPlanner::new().plan_fft_forward(samples), scale, bins }
    }
    /// Projections of six series given by sample; zero frequency is scaled to the variance of a part.
    pub(super) fn project(&self, series: &[[f64; 6]]) -> Residual {
        let mut out = vec![0.0; self.bins * BIN];
        let mut input = self.fft.make_input_vec();
        let mut output = self.fft.make_output_vec();
        for c in 0..6 {
            for ((x, s), w) in input.iter_mut().zip(series).zip(&self.taper) {
                *x = s[c] * w;
            }
            if self.fft.process(&mut input, &mut output).is_err() {
                return vec![f64::NAN; self.bins * BIN];
            }
            for (k, z) in output.iter().take(self.bins).enumerate() {
                let s = if k == 0 { self.scale * std::f64::consts::FRAC_1_SQRT_2 } else { self.scale };
                out[k * BIN + c] = z.re * s;
                out[k * BIN + 6 + c] = z.im * s;
            }
        }
        out
    }
}

/// Mean over neighbouring bins, each brought to this one's frequency by the local power law of its channels, so that a steep
/// spectrum is neither flattened (a plain mean over a sixth to each side of ω⁴ is 5 % too high) nor cut at the end of the band.
/// The width grows with frequency (a sixth) and is at least three bins to each side, save at the lowest, where it is symmetric.
pub(super) fn averaged(raw: &[Cov]) -> Vec<Cov> {
    let n = raw.len();
    let x: Vec<f64> = (0..n).map(|k| ((k + 1) as f64).ln()).collect();
    let within = |k: usize, w: usize| k.saturating_sub(w)..(k + w + 1).min(n);
    (0..n)
        .map(|k| {
            let w = (k / 6).max(3).min(k.max(1));
            let exponents: [f64; BIN] = std::array::from_fn(|c| {
                let wide = within(k, 2 * w);
                slope(&x[wide.clone()], &raw[wide].iter().map(|m| m[(c, c)].max(f64::MIN_POSITIVE).ln()).collect::<Vec<_>>())
            });
            let mut sum = Cov::zeros();
            for j in within(k, w) {
                let to: [f64; BIN] = std::array::from_fn(|c| (0.5 * exponents[c] * (x[k] - x[j])).exp());
                sum += raw[j].map_with_location(|r, c, m| m * to[r] * to[c]);
            }
            let m = sum / within(k, w).len() as f64;
            m + Cov::from_diagonal(&m.diagonal()) * RIDGE
        })
        .collect()
}

/// Slope of the straight line through points.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(x), mean(y));
    let (xy, xx) = x.iter().zip(y).fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (y - my), b + (x - mx).powi(2)));
    if xx > 0.0 { xy / xx } else { 0.0 }
}

/// Covariance of real and imaginary parts of a circular vector with covariance `E z zᴴ = s`.
pub(super) fn real_form(s: &Spectrum) -> Cov {
    let mut m = Cov::zeros();
    for i in 0..6 {
        for k in 0..6 {
            let (re, im) = (0.5 * s[(i, k)].re, 0.5 * s[(i, k)].im);
            m[(i, k)] = re;
            m[(6 + i, 6 + k)] = re;
            m[(6 + i, k)] = im;
            m[(i, 6 + k)] = -im;
        }
    }
    m
}
