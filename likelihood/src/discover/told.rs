//! likelihood: effects that their own errors cannot tell from none. In: the best set. Out: the same without them.
//!
//! A set's probability takes the noise's and the gusts' spectra for certain; where they are others, effects make up for the difference and seem
//! sure. The errors that are stated hold whatever those are (`robust.rs`), and an effect whose strengths they do not tell from zero (Wald's test
//! with the sandwich: White, Econometrica 50, 1982; Kent, Biometrika 69, 1982) is not there as far as the runs can say.

use super::polish::names;
use super::weigh::{Weighed, weigh};
use super::{LEFT, describe, more, strengths};
use crate::engine::{Engine, Fit};
use crate::model::{Id, Number};
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Probability of strengths as large by chance from which on they are told from none.
const BY_CHANCE: f64 = 0.01;
/// Most steps of a climb and of scoring without such an effect.
const STEPS: [usize; 2] = [10, 6];

/// A fit without effects that its errors do not tell from none, the least sure first, and all sets without them weighed there. One without which
/// more than noise is left stays: something is there, and its numbers are what is not known.
pub(super) fn told_from_none(engine: &Engine, mut fit: Fit, mut weighed: Weighed, log: &mut Vec<String>) -> (Fit, Weighed) {
    let mut kept: Vec<&'static str> = Vec::new();
    let mut gone: Vec<&'static str> = Vec::new();
    loop {
        let robust = engine.robust(&fit);
        let open = (0..fit.model.members.len()).filter(|&k| {
            let m = &fit.model.members[k];
            !m.declared && !m.random && !kept.contains(&m.effect.family)
        });
        let chances = open.filter_map(|k| Some((k, by_chance(&robust, k)?)));
        let Some((k, chance)) = chances.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, chance)| *chance > BY_CHANCE) else {
            break;
        };
        let family = fit.model.members[k].effect.family;
        let mut without = fit.model.clone();
        without.members.remove(k);
        let less = engine.climb(&without, true, STEPS[0]).map(|less| engine.settle_random(&less, STEPS[1]));
        let is_as_likely = |less: &Fit| by_ratio(&fit, &robust, k, less).is_none_or(|chance| chance > BY_CHANCE);
        match less
            .ok()
            .filter(|less| less.chi < LEFT && is_as_likely(less))
            .and_then(|less| Some((weigh(engine, &less.model)?, less)))
        {
            Some((again, less)) => {
                log.push(format!(
                    "{family} is as large by chance with {chance:.2}; {} nats less without it: {}",
                    more(fit.total, less.total),
                    describe(&less.model)
                ));
                (fit, weighed) = (less, again);
                gone.push(family);
                weighed.leave_out(&gone);
            }
            None => kept.push(family),
        }
    }
    if !gone.is_empty() {
        log.push(format!("told from none: {}", names(&fit.model)));
    }
    (fit, weighed)
}

/// Probability that a member's strengths are as large by chance, together or the surest alone, whichever says less; none where it has none in the
/// fit. Together: two that stand for each other may be known well where each of them is not. Alone: of three that gusts which are not seen move in
/// step the differences seem known to a hundredth of each.
fn by_chance(fit: &Fit, member: usize) -> Option<f64> {
    let places: Vec<usize> = strengths(fit, member).filter(|&i| fit.numbers[i].value.abs() > 0.0).collect();
    let values = DVector::from_iterator(places.len(), places.iter().map(|&i| fit.numbers[i].value));
    let covariance = DMatrix::from_fn(places.len(), places.len(), |i, k| fit.covariance[(places[i], places[k])]);
    let alone = |i: usize| wald(&values.rows(i, 1).into_owned(), covariance.view((i, i), (1, 1)).into_owned());
    let surest = (0..places.len()).filter_map(alone).fold(1.0, f64::min);
    Some(wald(&values, covariance.clone())?.max(surest))
}

/// Probability that a member's numbers make the runs as much likelier by chance as a fit is than one without it, by the most that the robust variance
/// of a strength is of the fit's own.
fn by_ratio(fit: &Fit, robust: &Fit, member: usize, less: &Fit) -> Option<f64> {
    let is_own = |n: &&Number| matches!(n.id, Id::Member(m, _) if m == member);
    let wider = strengths(fit, member).map(|i| robust.covariance[(i, i)] / fit.covariance[(i, i)]).fold(1.0, f64::max);
    likelihood_ratio(fit.log_likelihood - less.log_likelihood, wider, fit.numbers.iter().filter(is_own).count())
}

/// Probability of such a gain of log-likelihood by chance: twice it, over what the variance is of the model's own (Kent 1982), has as many degrees of
/// freedom as numbers were fitted. What is known together with its shape only, as a size with its width, looks like none to Wald's test.
fn likelihood_ratio(gain: f64, wider: f64, numbers: usize) -> Option<f64> {
    Some(ChiSquared::new(numbers as f64).ok()?.sf((2.0 * gain / wider).max(0.0)))
}

/// Probability that numbers with this covariance about zero are as far from it.
fn wald(numbers: &DVector<f64>, covariance: DMatrix<f64>) -> Option<f64> {
    let distance = numbers.dot(&covariance.cholesky()?.solve(numbers));
    Some(ChiSquared::new(numbers.len() as f64).ok()?.sf(distance))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{bare, fit, in_gusts, member, number};
    use super::*;
    use crate::model::Model;

    /// By the closed forms: erfc(z/√2) of one number, exp(−z²/2) of two, and of two that are each uncertain but not their sum.
    #[test]
    fn exact_chance_of_numbers_as_large() {
        let one = wald(&DVector::from_element(1, 0.98), DMatrix::from_element(1, 1, 0.25)).expect("definite");
        assert!((one - 0.049_995_79).abs() < 1e-7, "{one}");
        let two = wald(&DVector::from_vec(vec![3.0, 0.0]), DMatrix::identity(2, 2)).expect("definite");
        assert!((two - (-4.5_f64).exp()).abs() < 1e-12, "{two}");
        let c = DMatrix::from_row_slice(2, 2, &[1.0, -0.99, -0.99, 1.0]);
        let sum = wald(&DVector::from_vec(vec![0.5, 0.5]), c).expect("definite");
        assert!((sum - (-0.5_f64 * 0.5 / 0.01).exp()).abs() < 1e-12, "{sum}");
        assert!(wald(&DVector::zeros(0), DMatrix::zeros(0, 0)).is_none());
        // The same distances by the likelihood; a loss is none.
        let twice = likelihood_ratio(9.0, 2.0, 2).expect("two numbers");
        assert!((twice - (-4.5_f64).exp()).abs() < 1e-12, "{twice}");
        assert!((likelihood_ratio(-1.0, 1.0, 3).expect("three") - 1.0).abs() < 1e-12 && likelihood_ratio(1.0, 1.0, 0).is_none());
    }

    /// By the likelihood's ratio: exp(−gain/wider) of two strengths, of which the less well known says how wide.
    #[test]
    fn exact_chance_by_the_ratio() {
        let (engine, _) = in_gusts();
        let model = Model { members: vec![member(&engine, "center-of-mass")], ..bare() };
        let numbers = [0, 2].map(|i| number(Id::Member(0, i), 0.1, 1.0)).to_vec();
        let of = |covariance: [f64; 2], log_likelihood: f64| {
            fit(model.clone(), numbers.clone(), DMatrix::from_diagonal(&covariance.to_vec().into()), [0.0, log_likelihood])
        };
        let (own, robust, less) = (of([0.3, 0.2], 57.0), of([0.36, 0.5], 57.0), of([0.3, 0.2], 53.0));
        let chance = by_ratio(&own, &robust, 0, &less).expect("two numbers");
        assert!((chance - (-4.0_f64 / 2.5).exp()).abs() < 1e-12, "{chance}");
    }
}
