//! likelihood: standard errors that hold where the noise or the gusts are not quite the model's. In: a fit. Out: its numbers' covariance.
//!
//! A model whose gusts or noise have another spectrum than the data's leaves innovations that are correlated from node to node; its
//! information then overstates what was learnt. Estimates of maximum likelihood are still consistent, and their covariance is
//! `A⁻¹ J A⁻¹` with A the information and J the score's covariance in the long run (Huber 1967; White 1982; Newey and West 1987).

use crate::engine::{Engine, Fit};
use crate::filter::SETTLED_S;
use crate::model::{Model, Number};
use crate::random_fit::RandomSlopes;
use crate::shock::{Innovation, Trace};
use nalgebra::{DMatrix, DVector, SMatrix};
use windfall_model::POSE;

/// Time over which innovations may be correlated, s; Bartlett's weights fall to zero there.
const MEMORY_S: f64 = 1.0;

type Correlation = SMatrix<f64, POSE, POSE>;

/// Whitened innovations of a run by node, none where nothing was measured, and the columns' slopes of them.
struct Whitened {
    innovations: Vec<Option<[f64; POSE]>>,
    slopes: Vec<Option<DMatrix<f64>>>,
}

impl Whitened {
    fn of(trace: &Trace) -> Self {
        let taken = trace.nodes.iter().map(|n| (n.channels.len() == POSE && n.t_s > SETTLED_S).then_some(&n.channels));
        let taken: Vec<_> = taken.collect();
        let root = |c: &Innovation| c.variance.sqrt();
        Self {
            innovations: taken.iter().map(|n| n.map(|n| std::array::from_fn(|c| n[c].value / root(&n[c])))).collect(),
            slopes: taken
                .iter()
                .map(|n| n.map(|n| DMatrix::from_fn(POSE, n[0].columns.len(), |c, j| n[c].columns[j] / root(&n[c]))))
                .collect(),
        }
    }
}

/// Bartlett's weight of a lag among `most`.
fn weight(lag: usize, most: usize) -> f64 {
    1.0 - lag as f64 / (most as f64 + 1.0)
}

/// Correlation of whitened innovations with those `lag` nodes later, over all runs: for every lag up to `most`, weighted.
fn correlations(runs: &[Whitened], most: usize) -> Vec<Correlation> {
    let count = runs.iter().flat_map(|r| &r.innovations).flatten().count().max(1) as f64;
    (0..=most)
        .map(|lag| {
            let mut sum = Correlation::zeros();
            for run in runs {
                for pair in run.innovations.windows(lag + 1) {
                    if let (Some(now), Some(later)) = (pair[0], pair[lag]) {
                        sum += Correlation::from_fn(|a, b| now[a] * later[b]);
                    }
                }
            }
            sum * (weight(lag, most) / count)
        })
        .collect()
}

/// The covariance in the long run of a score by `n` numbers, `Σ Dᵀ(k) R(lag) D(k + lag)` over both signs of the lag.
fn long_run(runs: &[Whitened], n: usize, most: usize) -> DMatrix<f64> {
    let correlations = correlations(runs, most);
    let mut all = DMatrix::zeros(n, n);
    for run in runs {
        for (k, slope) in run.slopes.iter().enumerate() {
            let Some(slope) = slope else { continue };
            let mut later = DMatrix::<f64>::zeros(POSE, n);
            for (lag, r) in correlations.iter().enumerate() {
                let share = if lag == 0 { 0.5 } else { 1.0 };
                if let Some(Some(other)) = run.slopes.get(k + lag) {
                    later.gemm(share, r, other, 1.0);
                }
            }
            all.gemm_tr(1.0, slope, &later, 1.0);
        }
    }
    &all + all.transpose()
}

/// The score's covariance with that of the prior: what is known beforehand scatters as it says.
fn score(runs: &[Whitened], most: usize, numbers: &[Number]) -> DMatrix<f64> {
    let mut score = long_run(runs, numbers.len(), most);
    numbers.iter().enumerate().for_each(|(i, n)| score[(i, i)] += n.prior.powi(-2));
    score
}

/// The model's own covariance, grown to the variances that a score's covariance leaves. A second's correlations are known to some
/// percent only: errors grow by them, and never fall below the model's own.
fn grown(own: &DMatrix<f64>, score: &DMatrix<f64>) -> DMatrix<f64> {
    let found = own * score * own;
    let grown = |i: usize| (found[(i, i)] / own[(i, i)]).max(1.0).sqrt();
    DMatrix::from_fn(own.nrows(), own.ncols(), |i, k| grown(i) * own[(i, k)] * grown(k))
}

impl Engine {
    /// The same fit with the covariance that holds whatever the noise's and the gusts' spectra are; as it was where it cannot be had.
    #[must_use]
    pub fn robust(&self, fit: &Fit) -> Fit {
        let covariance = self.sandwich(fit).filter(|c| (0..c.nrows()).all(|i| c[(i, i)].is_finite() && c[(i, i)] > 0.0));
        Fit { covariance: covariance.unwrap_or_else(|| fit.covariance.clone()), ..fit.clone() }
    }

    fn sandwich(&self, fit: &Fit) -> Option<DMatrix<f64>> {
        let seen = self.traced(&fit.model, &fit.numbers).ok()?;
        let runs: Vec<Whitened> = seen.iter().map(|seen| Whitened::of(&seen.trace)).collect();
        let grown = grown(&fit.covariance, &score(&runs, self.memory(), &fit.numbers));
        let unseen = self.by_unseen_gusts(fit)?;
        Some(grown + &unseen * unseen.transpose())
    }

    /// By how much the numbers move where the part of the gusts that the motion does not show is twice as large as their form has it. Only
    /// the form tells of that part, and its mean square adds to drag: a spectrum with more of it makes the same record.
    fn by_unseen_gusts(&self, fit: &Fit) -> Option<DVector<f64>> {
        if !fit.model.members.iter().any(|m| m.random && self.moves_air(m)) {
            return Some(DVector::zeros(fit.numbers.len()));
        }
        let mut twice = self.clone();
        twice.unseen = 4.0;
        let slopes = |engine: &Self| Some(engine.sum(&fit.model, &fit.numbers, &[]).ok()?.b);
        Some(&fit.covariance * (slopes(&twice)? - slopes(self)?))
    }

    /// [`MEMORY_S`] in nodes.
    fn memory(&self) -> usize {
        let step_s = self.runs.first().map_or(1.0, crate::run::Prepared::step_s);
        crate::run::whole(MEMORY_S / step_s).max(1)
    }

    /// Covariance of the logarithms of the random members' numbers, and the model's own. The information is what innovations and their variances
    /// say by their slopes; the score's covariance is that of what the nodes say in the long run.
    pub(crate) fn random_covariance(&self, model: &Model) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let RandomSlopes { slopes, information, .. } = self.random_slopes(model, &[])?;
        let n = slopes.len();
        let mut score = DMatrix::zeros(n, n);
        for run in 0..self.runs.len() {
            let of: Vec<&[f64]> = slopes.iter().map(|m| m[run].likelihood.as_slice()).collect();
            score += autocovariance(&of, self.memory());
        }
        let inverse = information.try_inverse()?;
        Some((&inverse * score * &inverse, inverse))
    }
}

/// Covariance of the sums of series that are correlated over `most` steps.
fn autocovariance(series: &[&[f64]], most: usize) -> DMatrix<f64> {
    let n = series.len();
    let length = series.first().map_or(0, |s| s.len());
    let mut all = DMatrix::zeros(n, n);
    for k in 0..length {
        let now = DVector::from_fn(n, |i, _| series[i][k]);
        let mut later = 0.5 * &now;
        for lag in 1..=most.min(length - 1 - k) {
            (0..n).for_each(|i| later[i] += weight(lag, most) * series[i][k + lag]);
        }
        all += &now * later.transpose();
    }
    &all + all.transpose()
}

#[cfg(test)]
mod tests;
