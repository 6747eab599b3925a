//! likelihood: which set of effects. In: normal equations of all candidates. Out: sets with their log marginal likelihood, best first.
//!
//! Singles, pairs, and larger sets grown from the best; every set is weighed anew, so that a member which another makes needless
//! drops out. A family costs the logarithm of the odds against it, a form that of its family's forms.

use crate::gram::Gram;
use crate::model::Id;
use std::collections::BTreeMap;

/// Something that may be part of a set: a family in one form, or a generic alternative.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Group of units of which a set has at most one.
    pub group: usize,
    /// Places of its columns.
    pub columns: Vec<usize>,
    /// Logarithm of its prior odds against, positive.
    pub cost: f64,
}

/// A set with its gain over the empty one, its costs taken off.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// Units by their place, ascending.
    pub units: Vec<usize>,
    /// Log marginal likelihood over that of the empty set, less costs.
    pub gain: f64,
    /// Log-likelihood at its estimates over that of the empty set.
    pub fit: f64,
    /// Columns that are in it: strengths that would leave their range are out.
    pub columns: Vec<usize>,
    /// Their estimates.
    pub estimates: Vec<f64>,
}

/// Sets kept at each size, and the largest size.
const KEPT: usize = 24;

/// Weighs sets of up to `most` units; `gram` has declared parameters and constants eliminated.
#[must_use]
pub(crate) fn search(gram: &Gram, units: &[Unit], most: usize) -> Vec<Set> {
    let mut all: BTreeMap<Vec<usize>, Set> = BTreeMap::new();
    let empty = Set { units: Vec::new(), gain: 0.0, fit: 0.0, columns: Vec::new(), estimates: Vec::new() };
    all.insert(Vec::new(), empty.clone());
    let mut level = vec![empty];
    for size in 1..=most {
        let mut next: Vec<Set> = Vec::new();
        for set in &level {
            for (u, unit) in units.iter().enumerate() {
                if set.units.iter().any(|&other| units[other].group == unit.group) {
                    continue;
                }
                let mut members = set.units.clone();
                members.push(u);
                members.sort_unstable();
                if all.contains_key(&members) {
                    continue;
                }
                if let Some(weighed) = weigh(gram, units, &members) {
                    all.insert(members, weighed.clone());
                    next.push(weighed);
                }
            }
        }
        next.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        // Pairs are grown from all singles that are worth anything, larger sets from the best.
        next.truncate(if size == 1 { 60 } else { KEPT });
        if next.is_empty() {
            break;
        }
        level = next;
    }
    let mut sets: Vec<Set> = all.into_values().collect();
    sets.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    sets
}

/// One set. Strengths are dropped, the farthest out first, until all lie in their range; a unit that loses all of them is no member.
pub(crate) fn weigh(gram: &Gram, units: &[Unit], members: &[usize]) -> Option<Set> {
    let mut columns: Vec<usize> = members.iter().flat_map(|&u| units[u].columns.iter().copied()).collect();
    let cost: f64 = members.iter().map(|&u| units[u].cost).sum();
    loop {
        if members.iter().any(|&u| !units[u].columns.iter().any(|c| columns.contains(c))) {
            return None;
        }
        let posterior = gram.posterior(&columns)?;
        let beyond = |i: usize| {
            let n = &gram.numbers[columns[i]];
            let v = posterior.mean[i];
            (n.range[0] - v).max(v - n.range[1]) / n.prior
        };
        let worst = (0..columns.len()).filter(|&i| beyond(i) > 0.0).max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)));
        let Some(worst) = worst else {
            let is_strength = |i: &usize| matches!(gram.numbers[columns[*i]].id, Id::Strength(..) | Id::Member(..));
            let of_unit = |&u: &usize| {
                let own = (0..columns.len()).filter(is_strength).filter(|&i| units[u].columns.contains(&columns[i]));
                of_any_size(own.map(|i| (posterior.mean[i], posterior.covariance[(i, i)], gram.numbers[columns[i]].prior)))
            };
            let sizes: f64 = members.iter().map(of_unit).sum();
            return Some(Set {
                units: members.to_vec(),
                gain: posterior.gain + sizes - cost,
                fit: posterior.fit,
                estimates: posterior.mean.iter().copied().collect(),
                columns,
            });
        };
        columns.remove(worst);
    }
}

/// Widths of a strength's prior, each as likely: effects are of any size, and where the runs know one to a thousandth of what is plausible, a
/// single width asks seven nats of it for being small.
const WIDTHS: [f64; 4] = [1.0, 0.1, 0.01, 0.001];

/// Least share of an effect's sizes that the runs can show.
const LEAST_SHOWN: f64 = 1e-6;

/// What [`WIDTHS`] of their priors add to the log marginal likelihood that the widest alone gives, of an effect's strengths: of each its posterior
/// mean and variance beside everything else, and its prior's standard deviation. Exact where there is one. An effect all of whose strengths are of
/// a width below what the runs know them to is none: they could not show it (a prior without mass about zero: Johnson and Rossell 2010).
#[must_use]
pub(crate) fn of_any_size(strengths: impl Iterator<Item = (f64, f64, f64)>) -> f64 {
    let (mut all, mut hidden, mut is_none) = (0.0, 0.0, true);
    for (mean, variance, prior) in strengths {
        is_none = false;
        // What the likelihood alone says: normal about `at` with variance `own`.
        let told = 1.0 / variance - 1.0 / (prior * prior);
        // Not above zero, or not a number: nothing is said.
        if told.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            continue;
        }
        let own = 1.0 / told;
        let at = mean * own / variance;
        let log = |width: f64| {
            let spread = (width * prior).powi(2) + own;
            -0.5 * (at * at / spread + spread.ln())
        };
        let each = WIDTHS.map(log);
        let sum = log_mean(&each);
        all += sum - each[0];
        let not_shown = WIDTHS.iter().zip(each).filter(|(w, _)| (*w * prior).powi(2) < own);
        hidden += (not_shown.map(|(_, l)| (l - sum).exp()).sum::<f64>() / WIDTHS.len() as f64).ln();
    }
    if is_none { 0.0 } else { all + (1.0 - f64::exp(hidden)).max(LEAST_SHOWN).ln() }
}

/// Whether a score is above another by more than so many nats.
pub(crate) fn is_above(there: f64, here: f64, by: f64) -> bool {
    there > here + by
}

/// Whether a score is above another or below it by less than so many nats.
pub(crate) fn is_within(there: f64, here: f64, by: f64) -> bool {
    there > here - by
}

/// Whether a score is below another by more than so many nats.
pub(crate) fn is_behind(there: f64, here: f64, by: f64) -> bool {
    there < here - by
}

/// Logarithm of the mean of what these are logarithms of; at least one, finite.
#[must_use]
pub fn log_mean(logs: &[f64]) -> f64 {
    log_sum(logs) - (logs.len() as f64).ln()
}

/// Logarithm of the sum of what these are logarithms of; of none, minus infinity.
#[must_use]
pub(crate) fn log_sum(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most.is_finite() { most + logs.iter().map(|l| (l - most).exp()).sum::<f64>().ln() } else { most }
}

/// Units of numbers: strengths of one form together.
#[must_use]
pub(crate) fn units(
    numbers: &[crate::model::Number],
    group_of: &dyn Fn(Id) -> Option<(usize, f64)>,
    key: &dyn Fn(Id) -> (usize, usize),
) -> Vec<Unit> {
    let mut all: BTreeMap<(usize, usize), Unit> = BTreeMap::new();
    for (place, n) in numbers.iter().enumerate() {
        let Some((group, cost)) = group_of(n.id) else { continue };
        all.entry(key(n.id)).or_insert_with(|| Unit { group, columns: Vec::new(), cost }).columns.push(place);
    }
    all.into_values().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Number;
    use nalgebra::{DMatrix, DVector};

    fn number(i: usize, range: [f64; 2]) -> Number {
        Number { id: Id::Generic(i), value: 0.0, prior: 1.0, range, at_end: [false; 2], step: 1.0 }
    }

    /// Three columns of which the third nearly repeats the first; data that the first and the second make.
    fn gram(range: [f64; 2]) -> Gram {
        let g = DMatrix::from_row_slice(3, 3, &[100.0, 0.0, 95.0, 0.0, 50.0, 0.0, 95.0, 0.0, 100.0]);
        let b = &g * DVector::from_vec(vec![1.0, -2.0, 0.0]);
        Gram::new((0..3).map(|i| number(i, range)).collect(), g, b, 0.0)
    }

    fn one_each() -> Vec<Unit> {
        (0..3).map(|i| Unit { group: i, columns: vec![i], cost: 30.0_f64.ln() }).collect()
    }

    #[test]
    fn recover_the_set_that_made_the_data() {
        let sets = search(&gram([f64::NEG_INFINITY, f64::INFINITY]), &one_each(), 3);
        assert_eq!(sets[0].units, [0, 1]);
        // Posterior means: g v / (g + 1).
        assert!((sets[0].estimates[0] - 100.0 / 101.0).abs() < 1e-12 && (sets[0].estimates[1] + 100.0 / 51.0).abs() < 1e-12);
        // ½ yᵀy − ½ ln |I + G| − 2 ln 30 by hand.
        let gain =
            0.5 * (100.0_f64.powi(2) / 101.0 + 100.0_f64.powi(2) / 51.0) - 0.5 * (101.0_f64 * 51.0).ln() - 2.0 * 30.0_f64.ln();
        assert!((sets[0].gain - gain).abs() < 1e-9, "{} {gain}", sets[0].gain);
        // b v − ½ g v² at those means.
        let [v, w] = [100.0 / 101.0, -100.0 / 51.0];
        let fit = 100.0 * v - 50.0 * v * v - 100.0 * w - 25.0 * w * w;
        assert!((sets[0].fit - fit).abs() < 1e-9, "{} {fit}", sets[0].fit);
    }

    #[test]
    fn law_a_strength_outside_its_range_is_no_member() {
        let sets = search(&gram([0.0, 5.0]), &one_each(), 3);
        assert_eq!(sets[0].units, [0]);
        assert!(sets.iter().all(|s| !s.units.contains(&1)));
    }

    /// Of one strength: the mean over widths of what each of them gives by itself, without those that the runs cannot show.
    #[test]
    fn exact_a_strength_of_any_size() {
        for (told, at) in [(1e8_f64, 3e-4), (1e8, 0.9), (4.0, 0.5), (3e4, 0.0)] {
            let alone = |prior: f64, id: Id| {
                let number = Number { id, prior, ..number(0, [f64::NEG_INFINITY, f64::INFINITY]) };
                Gram::new(vec![number], DMatrix::from_element(1, 1, told), DVector::from_element(1, told * at), 0.0)
            };
            let unit = [Unit { group: 0, columns: vec![0], cost: 2.0 }];
            let gain = |g: &Gram| weigh(g, &unit, &[0]).expect("definite").gain;
            let shown: Vec<f64> =
                WIDTHS.iter().filter(|w| *w * told.sqrt() >= 1.0).map(|w| gain(&alone(*w, Id::Generic(0)))).collect();
            let mean = log_mean(&shown) + (shown.len() as f64 / 4.0).ln();
            let any = gain(&alone(1.0, Id::Strength(0, 0, 0)));
            assert!((any - mean).abs() < 1e-6 * mean.abs().max(1.0), "{told} {at}: {any} {mean}");
        }
    }

    /// Two strengths of which the runs say nothing are no effect; one that is seen makes the pair one, whatever the other is.
    #[test]
    fn law_what_cannot_be_shown_is_none() {
        let blind = (0.0, 1.0, 1.0);
        assert!((of_any_size([blind, blind].into_iter()) - LEAST_SHOWN.ln()).abs() < 1e-12);
        let seen = (0.5, 1e-6, 1.0);
        let one = of_any_size([seen].into_iter());
        assert!((of_any_size([seen, blind].into_iter()) - one).abs() < 1e-9 && one.abs() < 5.0);
        assert!(of_any_size(std::iter::empty()).abs() < 1e-15);
    }

    /// Eliminating what every set has changes no gain but by that of what is eliminated.
    #[test]
    fn exact_elimination() {
        let whole = gram([f64::NEG_INFINITY, f64::INFINITY]);
        let left = whole.given(&[1], &[0, 2]).expect("a definite matrix");
        let difference = |a: &[usize], b: &[usize]| {
            whole.posterior(a).expect("definite").gain
                - whole.posterior(&[1]).expect("definite").gain
                - left.posterior(b).expect("definite").gain
        };
        assert!(difference(&[1, 0], &[0]).abs() < 1e-10);
        assert!(difference(&[1, 0, 2], &[0, 1]).abs() < 1e-10);
    }

    /// A strength in another unit adds the same, where the data know it about as well as its prior does, and where two widths are shown.
    #[test]
    fn law_a_strength_in_another_unit() {
        for variance in [0.03, 0.0008] {
            let adds = |unit: f64| of_any_size([(0.2 * unit, variance * unit * unit, 0.3 * unit)].into_iter());
            assert!((adds(7.3) - adds(1.0)).abs() < 1e-12, "{} {}", adds(7.3), adds(1.0));
        }
    }

    /// Of two strengths out of their ranges the one farther out in deviations of its prior goes first, and the other is then within its own.
    #[test]
    fn law_the_farthest_out_goes_first() {
        for (priors, left) in [([10.0, 0.1], 0), ([0.1, 10.0], 1)] {
            let g = 1e6 * DMatrix::from_row_slice(2, 2, &[1.0, 0.8, 0.8, 1.0]);
            let b = &g * DVector::from_vec(vec![-0.5, 1.3]);
            let ranges = [[0.0, f64::INFINITY], [f64::NEG_INFINITY, 1.0]];
            let numbers = (0..2).map(|i| Number { prior: priors[i], ..number(i, ranges[i]) }).collect();
            let unit = [Unit { group: 0, columns: vec![0, 1], cost: 2.0 }];
            let set = weigh(&Gram::new(numbers, g, b, 0.0), &unit, &[0]).expect("a set");
            assert_eq!(set.columns, [left]);
        }
    }

    #[test]
    fn exact_above_within_and_behind() {
        assert!(is_above(10.6, 7.5, 3.0) && !is_above(10.4, 7.5, 3.0));
        assert!(is_within(4.6, 7.5, 3.0) && !is_within(4.4, 7.5, 3.0) && is_within(9.0, 7.5, 3.0));
        assert!(is_behind(4.4, 7.5, 3.0) && !is_behind(4.6, 7.5, 3.0));
    }
}
