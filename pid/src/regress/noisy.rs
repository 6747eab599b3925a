//! pid: regression on regressors that carry the instruments' noise. In: amplitudes of what was recorded, and of what draws of the noise add
//! to them. Out: estimates without the bias of that noise, their covariance, and whether the residual is the instruments' at all.
//!
//! Noise in an angle is in regressors and response alike. The normal equations of what was recorded are those of the truth and, on average,
//! the products of the noise with itself: these are taken off (Fuller, Measurement Error Models, 1987, §2.2 and 3.1), as draws give them.
//! Draws also give the scatter of the estimating equations: what happens at the ends of a run is in every cosine alike, so that no spectrum
//! tells it.

use super::spectral::{Cosines, dot, residual, spectrum};
use nalgebra::DMatrix;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// What noise-corrected regression finds.
pub(super) struct Corrected {
    pub(super) estimate: Vec<f64>,
    pub(super) covariance: DMatrix<f64>,
    /// Power of each regressor's own motion, the others taken out, over that of the noise in it.
    pub(super) signal_to_noise: Vec<f64>,
    /// Residual power where it matters over that of the instruments' noise.
    pub(super) excess: f64,
    /// Chance that the instruments' noise leaves so much.
    pub(super) excess_p: f64,
}

/// One series: what was recorded and what each draw of the noise adds to it.
#[derive(Clone, Copy)]
pub(super) struct Recorded<'a> {
    pub(super) cosines: &'a Cosines,
    pub(super) draws: &'a [Cosines],
}

/// Weights from residuals from weights: this often, as without noise.
const ROUNDS: usize = 3;

/// Corrected estimates; `bread` and `estimate` are those of a fit that takes regressors as exact under these weights.
pub(super) fn corrected(
    series: &[Recorded<'_>],
    columns: &[usize],
    fit: impl Fn(&[Vec<f64>]) -> Option<(Vec<f64>, DMatrix<f64>)>,
) -> Option<Corrected> {
    let p = columns.len();
    let draws = series.first()?.draws.len();
    let mut spectra: Vec<Vec<f64>> = series.iter().map(|s| vec![1.0; s.cosines.len()]).collect();
    let mut found = None;
    for round in 0..=ROUNDS {
        let (estimate, bread) = fit(&spectra)?;
        let own = noise_products(series, columns, &spectra);
        let square = own.columns(0, p).into_owned();
        let with_response = own.column(p).into_owned();
        // (X'X − N)⁻¹ = (1 − (X'X)⁻¹N)⁻¹ (X'X)⁻¹: without noise to the last digit the fit's own.
        let back = (DMatrix::identity(p, p) - &bread * &square).try_inverse()?;
        let moved = nalgebra::DVector::from_vec(estimate) - &bread * with_response;
        let estimate: Vec<f64> = (&back * moved).as_slice().to_vec();
        if round < ROUNDS {
            spectra = series.iter().map(|s| spectrum(&residual(s.cosines, columns, &estimate))).collect();
        } else {
            found = Some((estimate, back * bread, square));
        }
    }
    let (estimate, inverse, square) = found?;
    let scores: Vec<Vec<f64>> = (0..draws).map(|d| score(series, columns, &spectra, &estimate, d)).collect();
    let covariance = &inverse * scatter(&scores, p) * inverse.transpose();
    let signal_to_noise = (0..p)
        .map(|j| {
            let own = inverse.column(j) / inverse[(j, j)];
            let noise = own.dot(&(&square * &own));
            if noise > 0.0 { 1.0 / (inverse[(j, j)] * noise) } else { f64::INFINITY }
        })
        .collect();
    let (excess, excess_p) = excess(series, columns, &spectra, &estimate, &inverse);
    Some(Corrected { estimate, covariance, signal_to_noise, excess, excess_p })
}

/// Mean weighted products of what draws add: columns with columns, and with the response in the last.
fn noise_products(series: &[Recorded<'_>], columns: &[usize], spectra: &[Vec<f64>]) -> DMatrix<f64> {
    let p = columns.len();
    let mut sum = DMatrix::zeros(p, p + 1);
    for (s, spectrum) in series.iter().zip(spectra) {
        let share = 1.0 / s.draws.len() as f64;
        for d in s.draws {
            for (i, &a) in columns.iter().enumerate() {
                for (j, &b) in columns.iter().enumerate() {
                    sum[(i, j)] += share * dot(&d.regressors[a], &d.regressors[b], spectrum);
                }
                sum[(i, p)] += share * dot(&d.regressors[a], &d.response, spectrum);
            }
        }
    }
    sum
}

/// The estimating equations' left-hand side as a draw of the noise makes it.
fn score(series: &[Recorded<'_>], columns: &[usize], spectra: &[Vec<f64>], estimate: &[f64], draw: usize) -> Vec<f64> {
    let mut sum = vec![0.0; columns.len()];
    for (s, spectrum) in series.iter().zip(spectra) {
        let d = &s.draws[draw];
        let e = residual(d, columns, estimate);
        for (sum, &c) in sum.iter_mut().zip(columns) {
            *sum += dot(&s.cosines.regressors[c], &e, spectrum) + dot(&d.regressors[c], &e, spectrum);
        }
    }
    sum
}

fn scatter(scores: &[Vec<f64>], p: usize) -> DMatrix<f64> {
    let n = scores.len() as f64;
    let mean: Vec<f64> = (0..p).map(|i| scores.iter().map(|s| s[i]).sum::<f64>() / n).collect();
    let product = |i: usize, j: usize| scores.iter().map(|s| (s[i] - mean[i]) * (s[j] - mean[j])).sum::<f64>() / (n - 1.0);
    DMatrix::from_fn(p, p, product)
}

/// Residual power over that of the draws, each cosine counted as much as it moves an estimate; of the parameter for which it is least
/// likely. Powers of draws are taken for χ² of their own mean and variance (Satterthwaite 1946).
fn excess(
    series: &[Recorded<'_>],
    columns: &[usize],
    spectra: &[Vec<f64>],
    estimate: &[f64],
    inverse: &DMatrix<f64>,
) -> (f64, f64) {
    let draws = series.first().map_or(0, |s| s.draws.len());
    let mut worst = (1.0, 1.0);
    for j in 0..columns.len() {
        let (mut own, mut of_draws) = (0.0, vec![0.0; draws]);
        for (s, spectrum) in series.iter().zip(spectra) {
            let share = |k: usize| {
                let moves: f64 = columns.iter().enumerate().map(|(i, &c)| inverse[(j, i)] * s.cosines.regressors[c][k]).sum();
                (moves / spectrum[k]).powi(2)
            };
            let shares: Vec<f64> = (0..spectrum.len()).map(share).collect();
            let power = |e: Vec<f64>| -> f64 { e.iter().zip(&shares).map(|(e, share)| share * e * e).sum() };
            own += power(residual(s.cosines, columns, estimate));
            for (sum, d) in of_draws.iter_mut().zip(s.draws) {
                *sum += power(residual(d, columns, estimate));
            }
        }
        let n = draws as f64;
        let mean = of_draws.iter().sum::<f64>() / n;
        let variance = of_draws.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        let freedom = (2.0 * mean * mean / variance).max(1.0);
        let p = ChiSquared::new(freedom).map_or(1.0, |c| c.sf(freedom * own / mean));
        if p < worst.1 || p == 0.0 && own / mean > worst.0 {
            worst = (own / mean, p);
        }
    }
    worst
}

#[cfg(test)]
mod tests;
