//! likelihood: sizes and shapes of random members. In: a model. Out: slopes of the likelihood over their logarithms, and the model at its
//! likeliest.
//!
//! Scoring (Fisher; Mehra 1970 for the innovations of a filter): the information is that of the innovations' slopes and of their variances'.

use crate::engine::{Engine, Fit};
use crate::filter::Seen;
use crate::model::Model;
use nalgebra::{DMatrix, DVector};
use windfall_model::Role;

/// What a model's runs say of the logarithms of its random members' numbers, in the order of [`random_numbers`].
pub(crate) struct RandomSlopes {
    /// Log-likelihood.
    pub(crate) here: f64,
    /// By number, by run.
    pub(crate) slopes: Vec<Vec<Slopes>>,
    /// Expected information.
    pub(crate) information: DMatrix<f64>,
}

impl Engine {
    /// Slopes at a model, by differences; none where a model departs.
    pub(crate) fn random_slopes(&self, model: &Model) -> Option<RandomSlopes> {
        let base = self.traced(model, &[]).ok()?;
        let one = |place| {
            let (next, by) = moved(model, place);
            Some(slopes(&base, &self.traced(&next, &[]).ok()?, by))
        };
        let slopes: Vec<Vec<Slopes>> = random_numbers(model).into_iter().map(one).collect::<Option<_>>()?;
        let n = slopes.len();
        let each = |a: usize, b: usize| slopes[a].iter().zip(&slopes[b]).map(|(x, y)| x.information(y)).sum::<f64>();
        let information = DMatrix::from_fn(n, n, each);
        Some(RandomSlopes { here: base.iter().map(|s| s.log_likelihood).sum(), slopes, information })
    }

    /// Sizes and shapes of the random members, the rest held, by at most `most` steps of scoring, then a climb; the better of before and
    /// after.
    pub(crate) fn settle_random(&self, fit: &Fit, most: usize) -> Fit {
        /// Longest step of a logarithm; what a number may be known by without the data; gain of log-likelihood that is not worth a step.
        const LONGEST: f64 = 1.2;
        const VAGUE: f64 = 3.0;
        const WORTH: f64 = 0.1;
        let places = random_numbers(&fit.model);
        if places.is_empty() {
            return fit.clone();
        }
        let mut model = fit.model.clone();
        for _ in 0..most {
            let Some(RandomSlopes { here, slopes, mut information }) = self.random_slopes(&model) else { break };
            let gradient = DVector::from_fn(slopes.len(), |i, _| slopes[i].iter().flat_map(|s| &s.likelihood).sum());
            (0..places.len()).for_each(|i| information[(i, i)] += 1.0 / (VAGUE * VAGUE));
            let Some(cholesky) = information.cholesky() else { break };
            let step = cholesky.solve(&gradient);
            let expected = 0.5 * gradient.dot(&step);
            let mut fraction = (LONGEST / step.amax().max(1e-12)).min(1.0);
            let mut better = None;
            for _ in 0..4 {
                let mut next = model.clone();
                for (&(m, i), s) in places.iter().zip(step.iter()) {
                    let [low, high] = log_range(&model, m, i);
                    next.members[m].values[i] =
                        (model.members[m].values[i].max(1e-12).ln() + fraction * s).clamp(low, high).exp();
                }
                if self.sum(&next, &[], &[]).is_ok_and(|s| s.log_likelihood > here) {
                    better = Some(next);
                    break;
                }
                fraction *= 0.35;
            }
            let Some(next) = better else { break };
            model = next;
            if expected < WORTH {
                break;
            }
        }
        match self.climb(&model, false, 3) {
            Ok(after) if after.total > fit.total => after,
            _ => fit.clone(),
        }
    }
}

/// Slopes of a run's innovations (whitened), of the logarithms of their variances, and of its nodes' log-likelihoods.
pub(crate) struct Slopes {
    innovations: Vec<f64>,
    variances: Vec<f64>,
    pub(crate) likelihood: Vec<f64>,
}

impl Slopes {
    /// Expected information of two numbers.
    fn information(&self, other: &Self) -> f64 {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        product(&self.innovations, &other.innovations) + 0.5 * product(&self.variances, &other.variances)
    }
}

fn slopes(base: &[Seen], moved: &[Seen], by: f64) -> Vec<Slopes> {
    let one = |(base, moved): (&Seen, &Seen)| {
        let mut slopes = Slopes { innovations: Vec::new(), variances: Vec::new(), likelihood: Vec::new() };
        for (a, b) in base.trace.nodes.iter().zip(&moved.trace.nodes) {
            for (x, y) in a.channels.iter().zip(&b.channels) {
                slopes.innovations.push((y.value - x.value) / (by * x.variance.sqrt()));
                slopes.variances.push((y.variance / x.variance).ln() / by);
            }
        }
        slopes.likelihood = base.nodes.iter().zip(&moved.nodes).map(|(a, b)| (b - a) / by).collect();
        slopes
    };
    base.iter().zip(moved).map(one).collect()
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
        .filter(|&(k, i)| model.members[k].parameters[i].role == Role::Strength || model.members[k].values[i] > 0.0)
        .collect()
}

/// Smallest size of a random input over the largest plausible.
const SMALLEST: f64 = 3e-4;
/// Smallest shape of a random input over the largest.
const SMALLEST_SHAPE: f64 = 1e-3;

fn log_range(model: &Model, member: usize, i: usize) -> [f64; 2] {
    let p = &model.members[member].parameters[i];
    let low = if p.role == Role::Strength { SMALLEST * p.high } else { p.low.max(SMALLEST_SHAPE * p.high) };
    [low.ln(), p.high.ln()]
}
