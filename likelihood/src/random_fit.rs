//! likelihood: sizes and shapes of random members together with all other numbers. In: a model. Out: slopes of the likelihood over their
//! logarithms, and the model at its likeliest.
//!
//! Scoring (Fisher; Mehra 1970 for the innovations of a filter): the information is that of the innovations' slopes and of their variances'.

use crate::engine::{Engine, Fit, penalty, totals};
use crate::filter::{NodeInnovations, Seen};
use crate::gram::step_within;
use crate::model::{Model, Number};
use nalgebra::{DMatrix, DMatrixView, DVector};
use windfall_model::Role;

/// What a model's runs say of its numbers and of the logarithms of its random members' numbers, those in the order of [`random_numbers`].
pub(crate) struct RandomSlopes {
    /// Log-likelihood.
    pub(crate) here: f64,
    /// By random number, by run.
    pub(crate) slopes: Vec<Vec<Slopes>>,
    /// Expected information of all: numbers first, then random ones.
    pub(crate) information: DMatrix<f64>,
    /// Slopes of the log-likelihood, in that order.
    pub(crate) gradient: DVector<f64>,
}

impl Engine {
    /// Slopes at a model, by columns and for random numbers by differences: of filters beside the pass, or of passes of their own where
    /// slopes are to be exact; none where a model departs.
    pub(crate) fn random_slopes(&self, model: &Model, numbers: &[Number]) -> Option<RandomSlopes> {
        let (others, steps): (Vec<Model>, Vec<f64>) = random_numbers(model).into_iter().map(|place| moved(model, place)).unzip();
        let base = self.with_rows(model, numbers, if self.exact_gusts { &[] } else { &others }).ok()?;
        let of = |(k, by): (usize, &f64)| {
            let own = self.exact_gusts.then(|| self.sum(&others[k], &[], &[]));
            let own = own.transpose().ok()?;
            let one = |(r, run): (usize, &Seen)| match &own {
                Some(own) => slopes(&run.innovations, &own.runs[r].innovations, *by),
                None => slopes(&run.innovations, &run.beside[k], *by),
            };
            Some(base.iter().enumerate().map(one).collect())
        };
        let slopes: Vec<Vec<Slopes>> = steps.iter().enumerate().map(of).collect::<Option<_>>()?;
        let (n, m) = (numbers.len(), slopes.len());
        let (g, b, here) = totals(&base, n);
        let mut information = DMatrix::zeros(n + m, n + m);
        let mut gradient = DVector::zeros(n + m);
        information.view_mut((0, 0), (n, n)).copy_from(&g);
        gradient.rows_mut(0, n).copy_from(&b);
        for (k, own) in slopes.iter().enumerate() {
            gradient[n + k] = own.iter().flat_map(|s| &s.likelihood).sum();
            for (l, other) in slopes.iter().enumerate() {
                information[(n + k, n + l)] = own.iter().zip(other).map(|(x, y)| x.information(y)).sum();
            }
            // A column's slope is that of what is predicted: the innovation's has the other sign.
            let cross: DVector<f64> = base.iter().zip(own).map(|(seen, s)| -s.by_columns(seen, n)).sum();
            information.view_mut((0, n + k), (n, 1)).copy_from(&cross);
            information.view_mut((n + k, 0), (1, n)).tr_copy_from(&cross);
        }
        Some(RandomSlopes { here, slopes, information, gradient })
    }

    /// Log-likelihood of a model, and of others that differ from it a little in random members alone.
    pub(crate) fn likelihoods_beside(&self, model: &Model, others: &[Model]) -> Option<(f64, Vec<f64>)> {
        let runs = self.with_rows(model, &[], others).ok()?;
        let of = |k: usize| runs.iter().flat_map(|run| &run.beside[k].nodes).sum();
        Some((runs.iter().map(|run| run.log_likelihood).sum(), (0..others.len()).map(of).collect()))
    }

    /// What integrating over the logarithms of the random members' numbers takes off the log-likelihood at its top, by Laplace's
    /// approximation (Kass and Raftery 1995); nothing without such members.
    pub(crate) fn random_price(&self, model: &Model) -> f64 {
        let n = random_numbers(model).len();
        if n == 0 {
            return 0.0;
        }
        let Some(RandomSlopes { information, .. }) = self.random_slopes(model, &[]) else { return 0.0 };
        let scaled = information * (VAGUE * VAGUE) + DMatrix::identity(n, n);
        let own: f64 = scaled.cholesky().map_or(0.0, |c| c.l_dirty().diagonal().iter().map(|x| x.ln()).sum());
        own + if model.members.iter().any(|m| m.random && self.moves_air(m)) { self.bursts_price } else { 0.0 }
    }

    /// A model at its likeliest, sizes and shapes of random members with all other numbers but shapes, by at most `most` steps of scoring
    /// and a climb; the better of before and after.
    pub(crate) fn settle_random(&self, fit: &Fit, most: usize) -> Fit {
        if random_numbers(&fit.model).is_empty() {
            return fit.clone();
        }
        match self.climb(&self.scored_up(&fit.model, most, WORTH), false, 3) {
            Ok(after) if after.total > fit.total => after,
            _ => fit.clone(),
        }
    }

    /// A fit with random members settled by slopes of passes of their own: beside a pass they are right to first order in the motion, which in
    /// strong gusts leaves sizes a fifth of a standard error off.
    pub(crate) fn settle_exactly(&self, fit: &Fit) -> Fit {
        const STEPS: usize = 3;
        if random_numbers(&fit.model).is_empty() {
            return fit.clone();
        }
        let mut exact = self.clone();
        exact.exact_gusts = true;
        match self.climb(&exact.scored_up(&fit.model, STEPS, WORTH_EXACTLY), true, 10) {
            Ok(after) if after.total > fit.total => after,
            _ => fit.clone(),
        }
    }

    /// A model after at most `most` steps of scoring, the last where a step was expected to gain less than `worth`.
    fn scored_up(&self, model: &Model, most: usize, worth: f64) -> Model {
        let mut model = model.clone();
        for _ in 0..most {
            let Some((next, expected)) = self.scored(&model) else { break };
            model = next;
            if expected < worth {
                break;
            }
        }
        model
    }

    /// The model a step of scoring further, and what a whole step was expected to gain: of all numbers or, where far from the runs none of those
    /// helps, of the random members' alone. None where no step raises the posterior.
    fn scored(&self, model: &Model) -> Option<(Model, f64)> {
        self.scored_in(model, &self.free(model, false)).or_else(|| self.scored_in(model, &[]))
    }

    /// A step in those numbers and the random members', shortened until the posterior rises.
    fn scored_in(&self, model: &Model, numbers: &[Number]) -> Option<(Model, f64)> {
        let places = random_numbers(model);
        let RandomSlopes { here, mut information, mut gradient, .. } = self.random_slopes(model, numbers)?;
        let n = numbers.len();
        let scale = |i: usize| numbers.get(i).map_or(VAGUE, |number| number.prior);
        (0..n).for_each(|i| gradient[i] -= numbers[i].value / numbers[i].prior.powi(2));
        // In units of the priors, whose information is then one.
        information = DMatrix::from_fn(n + places.len(), n + places.len(), |i, k| {
            scale(i) * information[(i, k)] * scale(k) + f64::from(u8::from(i == k))
        });
        let scaled = DVector::from_fn(gradient.len(), |i, _| scale(i) * gradient[i]);
        let leaves = |i: usize, by: f64| numbers.get(i).is_some_and(|number| number.leaves(by));
        let (step, _) = step_within(information, scaled.clone(), leaves)?;
        let expected = 0.5 * scaled.dot(&step);
        let longest = |i: usize| if i < n { LONGEST } else { LONGEST_LOG / VAGUE };
        let mut fraction = (0..step.len()).map(|i| longest(i) / step[i].abs().max(1e-12)).fold(1.0, f64::min);
        for _ in 0..4 {
            let mut next = model.clone();
            numbers.iter().enumerate().for_each(|(i, number)| next.change(number, fraction * scale(i) * step[i]));
            for (k, &(m, i)) in places.iter().enumerate() {
                let [low, high] = log_range(model, m, i);
                let by = fraction * VAGUE * step[n + k];
                next.members[m].values[i] = (model.members[m].values[i].max(1e-12).ln() + by).clamp(low, high).exp();
            }
            let there = self.sum(&next, &[], &[]).map(|s| s.log_likelihood - penalty(&self.free(&next, false)));
            if there.is_ok_and(|there| there > here - penalty(&self.free(model, false))) {
                return Some((next, expected));
            }
            fraction *= 0.35;
        }
        None
    }
}

/// What a logarithm of a random number may be known by without the data; its longest step, and that of others in their priors' standard
/// deviations; gain of log-likelihood that is not worth a step.
const VAGUE: f64 = 3.0;
const LONGEST_LOG: f64 = 1.2;
const LONGEST: f64 = 3.0;
const WORTH: f64 = 0.1;
const WORTH_EXACTLY: f64 = 0.01;

/// Slopes of a run's innovations (whitened), of the logarithms of their variances, and of its nodes' log-likelihoods.
pub(crate) struct Slopes {
    pub(crate) innovations: Vec<f64>,
    pub(crate) variances: Vec<f64>,
    pub(crate) likelihood: Vec<f64>,
}

impl Slopes {
    /// Expected information of two numbers.
    fn information(&self, other: &Self) -> f64 {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        product(&self.innovations, &other.innovations) + 0.5 * product(&self.variances, &other.variances)
    }

    /// Sum of its innovations' slopes times the whitened slopes by `n` columns, of the same run.
    fn by_columns(&self, seen: &Seen, n: usize) -> DVector<f64> {
        let rows = DMatrixView::from_slice(&seen.rows, n + 1, self.innovations.len());
        (rows * DVector::from_column_slice(&self.innovations)).rows(0, n).into_owned()
    }
}

/// Slopes from a pass and one whose random number is `by` further in its logarithm.
pub(crate) fn slopes(base: &NodeInnovations, moved: &NodeInnovations, by: f64) -> Slopes {
    let mut slopes = Slopes { innovations: Vec::new(), variances: Vec::new(), likelihood: Vec::new() };
    for (k, (a, b)) in base.variances.iter().zip(&moved.variances).enumerate() {
        for c in (0..a.len()).filter(|&c| a[c] > 0.0) {
            let (ratio, innovation) = (b[c] / a[c], base.whitened[k][c]);
            slopes.innovations.push((moved.whitened[k][c] * ratio.sqrt() - innovation) / by);
            slopes.variances.push(ratio.ln() / by);
        }
    }
    slopes.likelihood = base.nodes.iter().zip(&moved.nodes).map(|(a, b)| (b - a) / by).collect();
    slopes
}

/// A model with a random member's number a step further in its logarithm, away from the upper end of its range; and that step.
fn moved(model: &Model, (member, i): (usize, usize)) -> (Model, f64) {
    const STEP: f64 = 1e-3;
    let [low, high] = log_range(model, member, i);
    let up = model.members[member].values[i].max(low.exp()).ln() + STEP < high;
    let by = if up { STEP } else { -STEP };
    let mut moved = model.clone();
    moved.members[member].values[i] *= by.exp();
    (moved, by)
}

/// Places of the sizes and shapes of random members; a shape of zero stands for its absence and stays so.
pub(crate) fn random_numbers(model: &Model) -> Vec<(usize, usize)> {
    model
        .members
        .iter()
        .enumerate()
        .filter(|(_, m)| m.random)
        .flat_map(|(k, m)| (0..m.values.len()).map(move |i| (k, i)))
        .filter(|&(k, i)| match model.members[k].parameters[i].role {
            Role::Strength => true,
            Role::AeroPlace => false,
            _ => model.members[k].values[i] > 0.0,
        })
        .collect()
}

/// Smallest size of a random input over the largest plausible.
const SMALLEST: f64 = 1e-5;
/// Smallest shape of a random input over the largest.
const SMALLEST_SHAPE: f64 = 1e-3;

pub(crate) fn log_range(model: &Model, member: usize, i: usize) -> [f64; 2] {
    let p = &model.members[member].parameters[i];
    let low = if p.role == Role::Strength { SMALLEST * p.high } else { p.low.max(SMALLEST_SHAPE * p.high) };
    [low.ln(), p.high.ln()]
}

#[cfg(test)]
pub(crate) mod tests;
