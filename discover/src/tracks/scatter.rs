//! discover: poses judged by the scatter between runs alone. In: a few slow numbers of every run's residual. Out: their covariance, and whether
//! what is left repeats.
//!
//! Poses are often smoothed before they are published, and a model's error is smooth as well: samples along a flight are no witnesses of each
//! other, and sensor noise is far below what flights of the same settings differ by. So a run is a few numbers - what a steady push
//! along and a steady turn about each axis would leave, and one slow wave in each channel - with one covariance, common to all runs, which is that
//! of these very numbers over the runs (growth curves: Potthoff and Roy, Biometrika 51, 1964; Rao, Biometrika 52, 1965). An effect
//! gains by what it takes out of the scatter between runs, and by nothing else. Of a covariance of K numbers from n runs,
//! Rao's estimates scatter as if n − K − 1 runs had been flown: gains and intervals are held back by that.

use super::bins::{BIN, Cov};
use crate::residual::ChannelResidual;
use nalgebra::{DMatrix, DVector, SVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Numbers of a run where there are runs enough for their covariance: a push, a turn and a wave in each channel; else without waves.
const MANY: usize = BIN;
const FEW: usize = BIN / 2;
/// Runs per number from which all are used.
const RUNS_PER_NUMBER: usize = 2;

/// How many numbers of each run are used.
pub(super) fn numbers(runs: usize) -> usize {
    if runs >= RUNS_PER_NUMBER * MANY { MANY } else { FEW }
}

/// Share of a gain of log-likelihood that counts with so many runs, in [0, 1); zero where the covariance takes all of them.
pub(super) fn share(runs: usize) -> f64 {
    let n = runs as f64;
    ((n - numbers(runs) as f64 - 1.0) / n).max(0.0)
}

/// What a variance stated with so many runs' own covariance, K numbers each, is to be multiplied by: that covariance is too small by (n − K)/n, and an
/// estimate weighted by it scatters (n − 2)/(n − K − 1) times more than with the true one (Rao, Biometrika 54, 1967); at least one run to spare.
pub(super) fn widened(runs: usize) -> f64 {
    let (n, k) = (runs as f64, numbers(runs) as f64);
    n * (n - 2.0).max(1.0) / ((n - k).max(1.0) * (n - k - 1.0).max(1.0))
}

/// Mean of `z zᵀ` over the runs, a bin each.
pub(super) fn between_runs(z: &[f64]) -> Cov {
    let runs = (z.len() / BIN).max(1);
    let square = |b: &[f64]| {
        let v = SVector::<f64, BIN>::from_column_slice(b);
        v * v.transpose()
    };
    z.chunks_exact(BIN).map(square).sum::<Cov>() / runs as f64
}

/// Scatter between runs beside what sensor noise leaves in each.
pub(super) fn with_noise(noise: &[Cov], scatter: &Cov) -> Vec<Cov> {
    noise.iter().map(|n| n + scatter).collect()
}

/// Whether one channel's numbers repeat from run to run or follow the runs' inputs: the squares that a regression on a constant and the inputs takes
/// away, over those that it leaves, both summed over the channel's numbers, so that a number which hardly scatters hardly counts; an F test whose degrees of
/// freedom are those of so many numbers of unequal size (Satterthwaite 1946). `values` has a column for each number of the
/// channel, a row for each run.
pub(super) fn judge(channel: &str, values: &DMatrix<f64>, inputs: &DMatrix<f64>, fitted: f64) -> ChannelResidual {
    let (runs, count) = values.shape();
    let rms = (values.norm_squared() / values.len().max(1) as f64).sqrt();
    let mut design = DMatrix::from_element(runs, 1 + inputs.ncols(), 1.0);
    for (k, column) in inputs.column_iter().enumerate() {
        let about = column.add_scalar(-column.mean());
        let size = about.norm() / (runs as f64).sqrt();
        // An input in which runs do not differ is no regressor.
        let different = size > 1e-9 * column.amax();
        design.set_column(k + 1, &if different { about / size } else { DVector::zeros(runs) });
    }
    let svd = design.svd(true, false);
    let rank = svd.singular_values.iter().filter(|s| **s > 1e-6 * (runs as f64).sqrt()).count();
    let spare = runs as f64 - rank as f64 - fitted;
    let (Some(u), true) = (svd.u, spare >= 1.0) else {
        return ChannelResidual { channel: channel.to_owned(), rms, expected_rms: rms, p_value: 1.0 };
    };
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
    let (mut followed, mut rest, mut squares) = (0.0, 0.0, 0.0);
    for z in values.column_iter() {
        let of_number: f64 = order[..rank].iter().map(|k| u.column(*k).dot(&z).powi(2)).sum();
        let scatter = (z.norm_squared() - of_number).max(f64::MIN_POSITIVE) / spare;
        followed += of_number / rank as f64;
        rest += scatter;
        squares += scatter * scatter;
    }
    let numbers = rest * rest / squares;
    let p_value = FisherSnedecor::new(rank as f64 * numbers, spare * numbers).map_or(1.0, |f| f.sf(followed / rest));
    let expected_rms = (rest / count.max(1) as f64).sqrt();
    ChannelResidual { channel: channel.to_owned(), rms, expected_rms, p_value }
}

#[cfg(test)]
mod tests;
