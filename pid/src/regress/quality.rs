//! pid: how good a fit is. In: series and estimates. Out: residuals, R², whiteness.

use super::{RegressionSeries, weight};
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
        for (i, e) in e.iter_mut().enumerate() {
            *e *= weight(s, i);
        }
        e
    };
    series.iter().map(one).collect()
}

/// Share of the response's variance about its mean that the model explains (eq. 4.18), weighted rows.
pub(super) fn determination(series: &[&RegressionSeries], rss: f64) -> f64 {
    let pairs = || series.iter().flat_map(|s| s.response.iter().enumerate().map(move |(i, y)| (weight(s, i), y)));
    let (w2, w2y) = pairs().fold((0.0, 0.0), |(a, b), (w, y)| (a + w * w, b + w * w * y));
    let mean = w2y / w2;
    let about_mean: f64 = pairs().map(|(w, y)| (w * (y - mean)).powi(2)).sum();
    if about_mean > 0.0 { 1.0 - rss / about_mean } else { 0.0 }
}

/// Portmanteau test over all series; p = 1 when no series is long enough to test.
pub(super) fn ljung_box(residuals: &[Vec<f64>]) -> f64 {
    const LAGS: usize = 20;
    let (mut q, mut freedom) = (0.0, 0.0);
    for v in residuals.iter().filter(|v| v.len() > 2 * LAGS) {
        let n = v.len() as f64;
        let r0 = v.iter().map(|x| x * x).sum::<f64>();
        if r0 <= 0.0 {
            continue;
        }
        // All lags in one pass, which the vector unit can take; each sum in the order of its samples.
        let mut sums = [0.0; LAGS];
        let add = |sums: &mut [f64; LAGS], x: f64, later: &[f64]| {
            for (sum, y) in sums.iter_mut().zip(later) {
                *sum += x * y;
            }
        };
        let (pairs, tail) = (v.windows(LAGS + 1), &v[v.len() - LAGS..]);
        pairs.for_each(|w| add(&mut sums, w[0], &w[1..]));
        (0..LAGS).for_each(|i| add(&mut sums, tail[i], &tail[i + 1..]));
        for (k, sum) in (1..=LAGS).zip(sums) {
            let r = sum / r0;
            q += n * (n + 2.0) * r * r / (n - k as f64);
        }
        freedom += LAGS as f64;
    }
    ChiSquared::new(freedom).map_or(1.0, |c| c.sf(q))
}
