//! likelihood: errors of what every set has, over all sets that the runs cannot tell apart, and beside what is known to be missing. In: a fit,
//! the sets weighed at it. Out: the fit with errors that span them.
//!
//! The errors of one set take it for certain. Where a scale of the tunnel speed is as likely as none, drag is known no better than that scale,
//! whatever one of the two says of itself (Draper 1995; Hoeting, Madigan, Raftery and Volinsky 1999).

use super::weigh::{GENERIC, SURE, Weighed};
use crate::engine::Fit;
use crate::gram::Posterior;
use crate::model::{Id, Model, Number};
use crate::search::{Set, is_within};
use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal};
use windfall_pid::NORMAL_95;

/// What one set says of a number: its weight, the number's mean (or that over the chosen set's), its standard deviation.
pub(super) type Said = [f64; 3];

/// A fit with the errors of declared parameters and uncertain constants widened until ± 1.96 of them hold 95 % of what all sets within twenty to
/// one of its own say, each by its probability; as it was where its own set is not among those weighed.
pub(super) fn across_sets(fit: Fit, weighed: &Weighed) -> Fit {
    let members = fit.model.members.iter().filter(|m| !m.random && !m.declared).count();
    let is_member = |&u: &usize| weighed.families[u].1.is_none() && weighed.families[u].0 < GENERIC;
    let is_own = |s: &&Set| s.units.len() == members && s.units.iter().all(is_member);
    let Some(own) = weighed.sets.iter().find(is_own) else { return fit };
    let Some(here) = posterior(weighed, own) else { return fit };
    let near = within_twenty_to_one(weighed, own);
    widened(fit, |number, std| {
        let at = weighed.base.iter().position(|&b| weighed.whole.numbers[b].id == number.id)?;
        let one = |(weight, p): &(f64, Posterior)| {
            let share = (p.covariance[(at, at)] / here.covariance[(at, at)]).sqrt();
            [*weight, p.mean[at] - here.mean[at], std * share]
        };
        Some(half_width(&near.iter().map(one).collect::<Vec<_>>()) / NORMAL_95)
    })
}

/// What a set says of the numbers that every set has, the first, and of its own.
fn posterior(weighed: &Weighed, set: &Set) -> Option<Posterior> {
    let places: Vec<usize> = weighed.base.iter().copied().chain(set.columns.iter().map(|&c| weighed.others[c])).collect();
    weighed.whole.posterior(&places)
}

/// Sets within twenty to one of a set, with their odds against it.
fn within_twenty_to_one(weighed: &Weighed, of: &Set) -> Vec<(f64, Posterior)> {
    let near = weighed.sets.iter().filter(|s| is_within(s.gain, of.gain, SURE));
    near.filter_map(|s| Some(((s.gain - of.gain).exp(), posterior(weighed, s)?))).collect()
}

/// What the best sets beside generic alternatives, weighed at `model`, say of the numbers that every set has: of each its weights, values and
/// deviations.
pub(super) fn said_beside(weighed: &Weighed, model: &Model) -> Vec<(Id, Vec<Said>)> {
    let Some(best) = weighed.sets.first() else { return Vec::new() };
    let near = within_twenty_to_one(weighed, best);
    let one = |(at, &b): (usize, &usize)| {
        let id = weighed.whole.numbers[b].id;
        let said = near.iter().map(|(weight, p)| [*weight, p.mean[at] + origin(model, id), p.covariance[(at, at)].sqrt()]);
        (id, said.collect())
    };
    weighed.base.iter().enumerate().map(one).collect()
}

/// From where a number counts: parameters of the structure are steps from the model's own.
fn origin(model: &Model, id: Id) -> f64 {
    if let Id::Declared(i) = id { model.declared[i] } else { 0.0 }
}

/// A fit of a model of which something is known to be missing: the errors of the numbers that every set has, about its own estimates, are those over
/// all that is `said` of them beside what is missing, within and between (Draper 1995). Generic alternatives have the truth's form only nearly:
/// by what they move a number, that far it may be off, to either side.
pub(super) fn beside_what_is_missing(fit: Fit, said: &[(Id, Vec<Said>)]) -> Fit {
    let model = fit.model.clone();
    widened(fit, |number, std| {
        let (_, said) = said.iter().find(|(id, _)| *id == number.id)?;
        Some(about(number.value + origin(&model, number.id), std, said))
    })
}

/// Root mean square about a value of what is said, each with the value's own deviation or more.
fn about(value: f64, std: f64, said: &[Said]) -> f64 {
    let all: f64 = said.iter().map(|[weight, ..]| weight).sum();
    let square = |[weight, mean, other]: &Said| weight * (std.max(*other).powi(2) + (mean - value).powi(2));
    (said.iter().map(square).sum::<f64>() / all).sqrt()
}

/// The fit with the errors that `error` has for its numbers, of which it is given each with its own error; never narrowed.
fn widened(fit: Fit, error: impl Fn(&Number, f64) -> Option<f64>) -> Fit {
    let wider = |(i, number): (usize, &Number)| {
        let std = fit.covariance[(i, i)].sqrt();
        error(number, std).filter(|e| e.is_finite()).map_or(1.0, |e| (e / std).max(1.0))
    };
    let wider: Vec<f64> = fit.numbers.iter().enumerate().map(wider).collect();
    let covariance = DMatrix::from_fn(wider.len(), wider.len(), |i, k| wider[i] * fit.covariance[(i, k)] * wider[k]);
    Fit { covariance, ..fit }
}

/// The distance from zero within which 95 % of what is said lies, by bisection.
fn half_width(said: &[Said]) -> f64 {
    let normal = Normal::standard();
    let all: f64 = said.iter().map(|[weight, ..]| weight).sum();
    let within = |h: f64| {
        let one = |[weight, mean, std]: &Said| weight * (normal.cdf((h - mean) / std) - normal.cdf((-h - mean) / std));
        said.iter().map(one).sum::<f64>() / all
    };
    let [mut low, mut high] = [0.0, said.iter().map(|[_, mean, std]| mean.abs() + 3.0 * std).fold(0.0, f64::max)];
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if within(middle) < 0.95 { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::super::tests::{bare, fit, in_gusts, member, number, set, unit, weighed};
    use super::*;
    use crate::gram::Gram;
    use nalgebra::DVector;

    /// One set leaves its own 1.96 deviations; a second of a thousandth hardly more; one as likely reaches to where nine tenths of it lie.
    #[test]
    fn exact_half_width_of_two_sets() {
        let one = half_width(&[[1.0, 0.0, 2.0]]);
        assert!((one - 2.0 * NORMAL_95).abs() < 1e-4, "{one}");
        let faint = half_width(&[[1.0, 0.0, 1.0], [0.001, 100.0, 1.0]]);
        assert!(faint > NORMAL_95 && faint < 1.01 * NORMAL_95, "{faint}");
        let far = half_width(&[[1.0, 0.0, 1.0], [1.0, 100.0, 2.0]]);
        assert!((far - (100.0 + 2.0 * 1.281_551_6)).abs() < 1e-3, "{far}");
    }

    /// One that agrees leaves the deviation; one apart adds its distance; two are weighed; a wider one's own deviation counts.
    #[test]
    fn exact_deviation_about_a_value() {
        for (said, expected) in [
            (vec![[0.3, 7.0, 0.1]], 2.0),
            (vec![[1.0, 10.0, 1.0]], 13.0_f64.sqrt()),
            (vec![[3.0, 7.0, 1.0], [1.0, 11.0, 4.0]], (0.75_f64 * 4.0 + 0.25 * (16.0 + 16.0)).sqrt()),
        ] {
            let found = about(7.0, 2.0, &said);
            assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
        }
    }

    /// A set with one effect and the empty one, which moves the number that both have: 95 % of the two normal laws lie within 1.96 of the stated errors,
    /// and correlations stay. What is said beside alternatives counts from where the model's parameters are, and a number that is apart is off by that.
    #[test]
    fn exact_errors_across_two_sets() {
        let numbers = vec![number(Id::Declared(0), 0.0, 30.0), number(Id::Generic(0), 0.0, 1.3)];
        let g = DMatrix::from_row_slice(2, 2, &[40.0, 35.0, 35.0, 50.0]);
        let b = DVector::from_vec(vec![20.0, 30.0]);
        // The normal posterior of those at the places: A = G + S⁻².
        let by_hand = |places: &[usize]| {
            let a = DMatrix::from_fn(places.len(), places.len(), |i, k| {
                g[(places[i], places[k])] + if i == k { numbers[places[i]].prior.powi(-2) } else { 0.0 }
            });
            let inverse = a.try_inverse().expect("definite");
            let mean = &inverse * DVector::from_fn(places.len(), |i, _| b[places[i]]);
            (mean[0], inverse[(0, 0)].sqrt())
        };
        let (one, none) = (by_hand(&[0, 1]), by_hand(&[0]));
        let sets = vec![set(&[0], 5.0), set(&[], 4.3), set(&[], 1.0)];
        let whole = Gram::new(numbers.clone(), g.clone(), b.clone(), 0.0);
        let w = weighed(whole, vec![unit(0, &[0], 0.0)], vec![(0, None)], sets);
        let (engine, _) = in_gusts();
        let model = Model { declared: vec![7.0], members: vec![member(&engine, "damping-shape")], ..bare() };
        let covariance = DMatrix::from_row_slice(2, 2, &[0.09, -0.03, -0.03, 0.04]);
        let own = fit(model.clone(), vec![numbers[0], number(Id::Member(0, 0), 0.0, 1.0)], covariance, [0.0; 2]);
        let after = across_sets(own.clone(), &w).covariance;
        let (half, normal) = (NORMAL_95 * after[(0, 0)].sqrt(), Normal::standard());
        let within = |mean: f64, std: f64| normal.cdf((half - mean) / std) - normal.cdf((-half - mean) / std);
        let odds = (-0.7_f64).exp();
        let share = (within(0.0, 0.3) + odds * within(none.0 - one.0, 0.3 * none.1 / one.1)) / (1.0 + odds);
        assert!((share - 0.95).abs() < 1e-6, "{share}");
        assert!((after[(1, 1)] - 0.04).abs() < 1e-15 && (after[(0, 1)] + 0.03 * (after[(0, 0)] / 0.09).sqrt()).abs() < 1e-12);
        let said = said_beside(&w, &model);
        assert!(said.len() == 1 && said[0].1.len() == 2);
        for (found, expected) in said[0].1.iter().zip([[1.0, 7.0 + one.0, one.1], [odds, 7.0 + none.0, none.1]]) {
            assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9), "{found:?} {expected:?}");
        }
        let mut apart = own;
        apart.numbers[0].value = 0.2;
        let after = beside_what_is_missing(apart, &[(Id::Declared(0), vec![[0.4, 8.2, 0.1]])]).covariance;
        assert!(
            (after[(0, 0)] - 1.09).abs() < 1e-12 && (after[(0, 1)] + 0.03 * (1.09_f64 / 0.09).sqrt()).abs() < 1e-12,
            "{after}"
        );
    }
}
