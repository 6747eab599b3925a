//! pid: how good a fit is. In: series and estimates. Out: residuals, R², whiteness.

use super::RegressionSeries;
use pulp::{Arch, Simd, WithSimd};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Weighted residuals of each series.
pub(super) fn residuals(series: &[&RegressionSeries], columns: &[usize], estimate: &[f64]) -> Vec<Vec<f64>> {
    let one = |s: &&RegressionSeries| -> Vec<f64> {
        let mut e = s.response.clone();
        for (&column, p) in columns.iter().zip(estimate) {
            for (e, x) in e.iter_mut().zip(&s.regressors[column]) {
                *e -= p * x;
            }
        }
        e
    };
    series.iter().map(one).collect()
}

/// Share of the response's variance about its mean that the model explains (eq. 4.18), weighted rows.
pub(super) fn determination(series: &[&RegressionSeries], rss: f64) -> f64 {
    let weight = |s: &RegressionSeries, i: usize| s.weight.get(i).copied().unwrap_or(1.0);
    let pairs = || series.iter().flat_map(|s| s.response.iter().enumerate().map(move |(i, wy)| (weight(s, i), wy)));
    let (w2, w2y) = pairs().fold((0.0, 0.0), |(a, b), (w, wy)| (a + w * w, b + w * wy));
    let mean = w2y / w2;
    let about_mean: f64 = pairs().map(|(w, wy)| (wy - w * mean).powi(2)).sum();
    if about_mean > 0.0 { 1.0 - rss / about_mean } else { 0.0 }
}

/// Lags of the test.
const LAGS: usize = 20;

/// Sums of products with what is 1 to 20 samples later: all lags in one pass, which the vector unit can take; each sum in the order of its
/// samples, so that the unit decides on no bit.
struct Lagged<'a>(&'a [f64]);

impl WithSimd for Lagged<'_> {
    type Output = [f64; LAGS];
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut sums = [0.0; LAGS];
        for w in self.0.windows(LAGS + 1) {
            for (sum, y) in sums.iter_mut().zip(&w[1..]) {
                *sum += w[0] * y;
            }
        }
        let tail = &self.0[self.0.len() - LAGS..];
        for (i, x) in tail.iter().enumerate() {
            for (sum, y) in sums.iter_mut().zip(&tail[i + 1..]) {
                *sum += x * y;
            }
        }
        sums
    }
}

/// Portmanteau test over all series; p = 1 when no series is long enough to test.
pub(super) fn ljung_box(residuals: &[Vec<f64>]) -> f64 {
    let (mut q, mut freedom) = (0.0, 0.0);
    for v in residuals.iter().filter(|v| v.len() > 2 * LAGS) {
        let n = v.len() as f64;
        let r0 = v.iter().map(|x| x * x).sum::<f64>();
        if r0 <= 0.0 {
            continue;
        }
        let sums = Arch::new().dispatch(Lagged(v));
        for (k, sum) in (1..=LAGS).zip(sums) {
            let r = sum / r0;
            q += n * (n + 2.0) * r * r / (n - k as f64);
        }
        freedom += LAGS as f64;
    }
    ChiSquared::new(freedom).map_or(1.0, |c| c.sf(q))
}

#[cfg(test)]
mod tests;
