//! discover: poses judged by the scatter between runs alone. In: a few slow numbers of every run's residual. Out: their covariance, and whether
//! what is left repeats.
//!
//! Poses are often smoothed before they are published, and a model's error is smooth as well: samples along a flight are no witnesses of each
//! other, and sensor noise is far below what flights of the same settings differ by. So a run is a few numbers - what a steady push
//! along and a steady turn about each axis would leave, and one slow wave in each channel - with one covariance, common to all runs, which is that
//! of these very numbers over the runs (growth curves: Potthoff and Roy, Biometrika 51, 1964; Rao, Biometrika 52, 1965). An effect
//! gains by what it takes out of the scatter between runs, and by nothing else. Of a covariance of K numbers from n runs,
//! Rao's estimates scatter as if n − K − 1 runs had been flown: gains and intervals are held back by that.

use super::bins::{BIN, Cov, Residual};
use crate::residual::ChannelResidual;
use nalgebra::{DMatrix, DVector, SVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use statrs::function::gamma::ln_gamma;
use windfall_likelihood::NearFit;

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

/// Scatter between runs, as some runs tell it.
#[derive(Clone, Debug)]
pub struct Between {
    covariance: Cov,
    runs: usize,
    /// How many numbers of each run it is of; rows and columns of the others are zero.
    numbers: usize,
}

impl Between {
    /// Mean of `z zᵀ` over the runs, a bin each, its correlations shrunk by as much as the errors of these means ask for (Schäfer and Strimmer,
    /// Stat. Appl. Genet. Mol. Biol. 4, 2005): of few runs some direction has next to no scatter by chance, and a likelihood with that covariance has sharp tops
    /// wherever one is small.
    pub(super) fn of(z: &[f64], numbers: usize) -> Self {
        let runs = z.chunks_exact(BIN);
        let n = runs.len().max(1) as f64;
        let square = |b: &[f64]| {
            let v = SVector::<f64, BIN>::from_column_slice(b);
            v * v.transpose()
        };
        let mut covariance = runs.clone().map(square).sum::<Cov>() / n;
        let pairs = || (0..BIN).flat_map(|i| (0..i).map(move |k| (i, k)));
        let correlated = |(i, k): (usize, usize)| {
            let (s, size) = (covariance[(i, k)], covariance[(i, i)] * covariance[(k, k)]);
            let errors = runs.clone().map(|b| (b[i] * b[k] - s).powi(2)).sum::<f64>() / (n * (n - 1.0).max(1.0));
            if size > 0.0 { [errors / size, s * s / size] } else { [0.0; 2] }
        };
        let [errors, squares] = pairs().map(correlated).fold([0.0; 2], |sum, x| [sum[0] + x[0], sum[1] + x[1]]);
        let kept = if squares > 0.0 { (1.0 - errors / squares).max(0.0) } else { 1.0 };
        for (i, k) in pairs() {
            covariance[(i, k)] *= kept;
            covariance[(k, i)] *= kept;
        }
        Self { covariance, runs: runs.len(), numbers }
    }

    /// With what sensor noise leaves in each run.
    pub(super) fn with_noise(&self, noise: &[Cov]) -> Vec<Cov> {
        noise.iter().map(|n| n + self.covariance).collect()
    }

    /// Log density of the numbers of other runs, its slopes by what `columns` are the slopes of, and the information on that. A covariance of n
    /// runs makes it Student's t with n − K + 1 degrees of freedom (Geisser and Cornfield, J. R. Stat. Soc. B 25, 1963): a run far off weighs less.
    pub(super) fn of_others(&self, noise: &[Cov], z: &[f64], columns: &[Residual], used: usize) -> Option<NearFit> {
        let k = self.numbers.min(used);
        let (runs, size) = (self.runs as f64, k as f64);
        let freedom = (runs - size + 1.0).max(1.0);
        let mut all = NearFit {
            off: DVector::zeros(columns.len()),
            log_likelihood: 0.0,
            slopes: DVector::zeros(columns.len()),
            information: DMatrix::zeros(columns.len(), columns.len()),
        };
        for (r, noise) in noise.iter().enumerate() {
            let scale = DMatrix::from_fn(k, k, |i, j| noise[(i, j)] + self.covariance[(i, j)]) * (runs / freedom);
            let root = scale.cholesky()?;
            let own = |x: &[f64]| DVector::from_column_slice(&x[r * BIN..r * BIN + k]);
            let white = |x: &[f64]| root.l_dirty().solve_lower_triangular(&own(x));
            let z = white(z)?;
            let white: Vec<DVector<f64>> = columns.iter().map(|a| white(a)).collect::<Option<_>>()?;
            let squares = z.norm_squared();
            let log_det: f64 = root.l_dirty().diagonal().iter().map(|x| x.ln()).sum();
            let of_size = ln_gamma(0.5 * (freedom + size)) - ln_gamma(0.5 * freedom) - 0.5 * size * (0.5 * freedom).ln();
            all.log_likelihood += of_size - log_det - 0.5 * (freedom + size) * (squares / freedom).ln_1p();
            let weight = (freedom + size) / (freedom + squares);
            for (i, a) in white.iter().enumerate() {
                all.slopes[i] -= weight * a.dot(&z);
                white.iter().enumerate().for_each(|(j, b)| all.information[(i, j)] += weight * a.dot(b));
            }
        }
        Some(all)
    }
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
