//! pid: least squares weighted by spectrum. In: stacked series. Out: estimates and covariance for stationary coloured noise.
//!
//! A cosine transform is linear and the balances are linear in the parameters, so they hold for every cosine of the rows as they
//! do for the rows. There the residuals of stationary noise of any colour are nearly independent, with variance S(f), and are
//! weighted by 1/S, which the residuals themselves give. `Σ_k S_k X_k X_kᵀ` is the double sum of Morelli and Klein (J. Aircraft
//! 34(2), 1997) after Parseval. The weight besides takes the noise of differentiation, which grows as the fourth power of
//! frequency, out of regressors and response alike, and with it the bias that noise in regressors brings (Klein and Morelli,
//! Aircraft System Identification, 2006, ch. 7). Rows should fade out smoothly at both ends, or what happens at the ends spreads
//! over all cosines.

use super::colour::fast_length;
use super::reflect::Triangle;
use super::{Coloured, RegressionSeries};
use crate::shared::Shared;
use nalgebra::{DMatrix, DVector};
use realfft::{RealFftPlanner, RealToComplex};
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::sync::Arc;

/// One series as cosine amplitudes.
#[derive(Clone, Debug)]
pub(super) struct Cosines {
    pub(super) regressors: Vec<Vec<f64>>,
    pub(super) response: Vec<f64>,
}

impl Cosines {
    /// What these have beyond others.
    pub(super) fn less(mut self, other: &Self) -> Self {
        let pairs = self.regressors.iter_mut().zip(&other.regressors).chain([(&mut self.response, &other.response)]);
        pairs.for_each(|(a, b)| a.iter_mut().zip(b).for_each(|(a, b)| *a -= b));
        self
    }
    pub(super) fn len(&self) -> usize {
        self.response.len()
    }
}

/// What a transform of a length, of which so many amplitudes are wanted, needs.
struct Transform {
    fft: Arc<dyn RealToComplex<f64>>,
    shift: Vec<(f64, f64)>,
}

/// Transforms of the lengths used last.
static TRANSFORMS: Shared<(usize, usize), Transform> = Shared::new(4);

impl Transform {
    fn new(n: usize, count: usize) -> Self {
        let shift = (0..count.min(n)).map(|k| (PI * k as f64 / (2.0 * n as f64)).sin_cos()).collect();
        Self { fft: RealFftPlanner::new().plan_fft_forward(n), shift }
    }
}

/// The first `count` orthonormal cosine amplitudes (DCT-II) of a series' weighted rows, followed by a few zeros for a fast length: by the
/// Fourier transform of the even rows followed by the odd ones backward (Makhoul, IEEE Trans. ASSP 28(1), 1980).
pub(super) fn cosines(s: &RegressionSeries, count: usize) -> Cosines {
    let n = fast_length(s.response.len());
    let transform = TRANSFORMS.get((n, count), || Transform::new(n, count));
    let Transform { fft, shift } = &*transform;
    let (mut folded, mut out, mut scratch) = (fft.make_input_vec(), fft.make_output_vec(), fft.make_scratch_vec());
    let unit = (2.0 / n as f64).sqrt();
    let mut transform = |x: &[f64]| -> Vec<f64> {
        folded.fill(0.0);
        for (i, v) in x.iter().enumerate() {
            folded[if i % 2 == 0 { i / 2 } else { n - 1 - i / 2 }] = *v;
        }
        fft.process_with_scratch(&mut folded, &mut out, &mut scratch).expect("buffers are made by the plan");
        // Beyond the middle: the conjugate of its mirror image.
        let at = |k: usize| out.get(k).map_or_else(|| out[n - k].conj(), |z| *z);
        let amplitude = |(k, (sine, cosine)): (usize, &(f64, f64))| unit * (at(k).re * cosine + at(k).im * sine);
        let mut c: Vec<f64> = shift.iter().enumerate().map(amplitude).collect();
        if let Some(mean) = c.first_mut() {
            *mean *= FRAC_1_SQRT_2;
        }
        c
    };
    Cosines { regressors: s.regressors.iter().map(|x| transform(x)).collect(), response: transform(&s.response) }
}

/// Half-width of the average over neighbouring amplitudes that estimates the spectrum: 25 of them leave its variance 8 %.
const NEIGHBOURS: usize = 12;
/// Weights from residuals from weights: this often. Three rounds settle estimates to a few per cent of their standard error.
const ROUNDS: usize = 3;

/// Estimates, covariance and degrees of freedom; `None` when the cosines do not determine them.
pub(super) fn weighted(series: &[&Cosines], columns: &[usize]) -> Option<Coloured> {
    let Settled { spectra, estimate, bread } = settle(series, columns)?;
    let rows: usize = series.iter().map(|s| s.response.len()).sum();
    let chi2: f64 = series
        .iter()
        .zip(&spectra)
        .map(|(s, variance)| residual(s, columns, &estimate).iter().zip(variance).map(|(e, v)| e * e / v).sum::<f64>())
        .sum();
    let variance = chi2 / (rows - columns.len()) as f64;
    Some(Coloured::of_exact(estimate, Some(bread * variance), rows as f64))
}

/// Weights that the residuals themselves give, with the estimate that leaves them.
struct Settled {
    spectra: Vec<Vec<f64>>,
    estimate: Vec<f64>,
    bread: DMatrix<f64>,
}

fn settle(series: &[&Cosines], columns: &[usize]) -> Option<Settled> {
    let mut spectra: Vec<Vec<f64>> = series.iter().map(|s| vec![1.0; s.response.len()]).collect();
    let (mut estimate, mut bread) = solve(series, &spectra, columns)?;
    for _ in 0..ROUNDS {
        let next = |(s, old): (&&Cosines, &Vec<f64>)| spectrum(&freed(s, columns, &estimate, &bread, old));
        spectra = series.iter().zip(&spectra).map(next).collect();
        (estimate, bread) = solve(series, &spectra, columns)?;
    }
    Some(Settled { spectra, estimate, bread })
}

/// Spectra of the residuals that these columns leave, one variance for each amplitude of each series.
pub(super) fn spectra(series: &[&Cosines], columns: &[usize]) -> Option<Vec<Vec<f64>>> {
    settle(series, columns).map(|s| s.spectra)
}

/// All columns and the response of a series over the root of its spectrum.
pub(super) fn whitened(s: &Cosines, spectrum: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let weight: Vec<f64> = spectrum.iter().map(|v| v.sqrt().recip()).collect();
    let n = weight.len();
    let x = DMatrix::from_fn(n, s.regressors.len(), |k, c| weight[k] * s.regressors[c][k]);
    (x, DVector::from_fn(n, |k, _| weight[k] * s.response[k]))
}

pub(super) fn residual(s: &Cosines, columns: &[usize], estimate: &[f64]) -> Vec<f64> {
    let mut e = s.response.clone();
    for (&column, p) in columns.iter().zip(estimate) {
        for (e, x) in e.iter_mut().zip(&s.regressors[column]) {
            *e -= p * x;
        }
    }
    e
}

/// Residuals as they would be, in variance, had no amplitude drawn the fit to itself (HC2 of MacKinnon and White, J.
/// Econometrics 29(3), 1985).
fn freed(s: &Cosines, columns: &[usize], estimate: &[f64], bread: &DMatrix<f64>, spectrum: &[f64]) -> Vec<f64> {
    let mut e = residual(s, columns, estimate);
    for (k, e) in e.iter_mut().enumerate() {
        let mut leverage = 0.0;
        for (a, &i) in columns.iter().enumerate() {
            for (b, &j) in columns.iter().enumerate() {
                leverage += s.regressors[i][k] * bread[(a, b)] * s.regressors[j][k];
            }
        }
        // An amplitude that decides the fit alone says nothing about the noise; 0.05 keeps it from deciding the spectrum.
        *e /= (1.0 - leverage / spectrum[k]).max(0.05).sqrt();
    }
    e
}

/// Sum of products over a spectrum.
pub(super) fn dot(a: &[f64], b: &[f64], spectrum: &[f64]) -> f64 {
    a.iter().zip(b).zip(spectrum).map(|((a, b), v)| a * b / v).sum()
}

/// Moving average of squares, one-sided at the ends. Its floor is rounding: 1e-14 of the mean.
pub(super) fn spectrum(e: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; e.len() + 1];
    for (k, v) in e.iter().enumerate() {
        sum[k + 1] = sum[k] + v * v;
    }
    let floor = (1.0e-14 * sum[e.len()] / e.len() as f64).max(f64::MIN_POSITIVE);
    let average = |k: usize| {
        let (from, to) = (k.saturating_sub(NEIGHBOURS), (k + NEIGHBOURS + 1).min(e.len()));
        ((sum[to] - sum[from]) / (to - from) as f64).max(floor)
    };
    (0..e.len()).map(average).collect()
}

/// Weighted least squares by QR, columns scaled: estimate and (XᵀWX)⁻¹.
pub(super) fn solve(series: &[&Cosines], spectra: &[Vec<f64>], columns: &[usize]) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let rows: usize = series.iter().map(|s| s.response.len()).sum();
    if rows <= columns.len() {
        return None;
    }
    let weights: Vec<Vec<f64>> = spectra.iter().map(|s| s.iter().map(|variance| variance.sqrt().recip()).collect()).collect();
    let stacked = |of: &dyn Fn(&Cosines) -> &Vec<f64>| -> Vec<f64> {
        series.iter().zip(&weights).flat_map(|(s, weights)| of(s).iter().zip(weights).map(|(x, w)| w * x)).collect()
    };
    let mut x: Vec<Vec<f64>> = columns.iter().map(|&column| stacked(&|s| &s.regressors[column])).collect();
    x.push(stacked(&|s| &s.response));
    let triangle = Triangle::of(x);
    if !triangle.scale.iter().all(|s| s.is_normal()) {
        return None;
    }
    let unscaled = triangle.inverse()?;
    Some(((&unscaled * &triangle.z).as_slice().to_vec(), &unscaled * unscaled.transpose()))
}

#[cfg(test)]
mod tests;
