//! likelihood: close rivals fitted. In: the best set and all sets weighed at it. Out: the likeliest of it and its rivals, each weighed by its own fit.
//!
//! Sets are weighed by columns at the fit of one of them. In gusts those leave out that a number also changes how uncertain a prediction is, and a
//! rival may be several nats likelier than they say: those that are close are fitted before one of them is named. What runs kept for choosing say
//! counts as well.

use super::polish::climb_down;
use super::weigh::{Weighed, weigh, with_set};
use super::{describe, more, predicted, score};
use crate::engine::{Engine, Fit};
use crate::search::{is_above, is_behind};

/// Nats within which a rival is fitted, and most of them.
const CLOSE: f64 = 6.0;
const MOST: usize = 4;
/// Most steps of scoring of a rival's random members.
const STEPS: usize = 4;
/// Nats by which a rival must be likelier to take the place of the best.
const LIKELIER: f64 = 0.5;

/// The best set, or one as large that its own fit makes likelier; sets that were fitted have the gain of their fits.
pub(super) fn rivals_fitted(engine: &Engine, fit: Fit, weighed: Weighed, log: &mut Vec<String>) -> (Fit, Weighed) {
    if fit.model.members.iter().any(super::Member::is_local) {
        return (fit, weighed);
    }
    let own = fit.model.found();
    let mut weighed = weighed;
    let Some(gain) = weighed.sets.iter().find(|s| weighed.families_of(s) == own).map(|s| s.gain) else { return (fit, weighed) };
    let all = |fit: &Fit| score(engine, fit) + predicted(engine, fit);
    let here = all(&fit);
    let mut tried: Vec<Vec<&str>> = vec![own.clone()];
    let mut best: Option<(f64, Fit)> = None;
    for k in 0..weighed.sets.len() {
        let set = &weighed.sets[k];
        let of_set = weighed.families_of(set);
        if tried.len() > MOST || is_behind(set.gain, gain, CLOSE) {
            break;
        }
        if own.is_empty() || of_set.len() != own.len() || tried.contains(&of_set) {
            continue;
        }
        let rival = climb_down(engine, &with_set(&fit.model, &weighed, set, engine));
        tried.push(of_set);
        let rival = rival.map(|r| engine.settle_random(&engine.climb(&r.model, true, 8).unwrap_or(r), STEPS));
        let Some(rival) = rival.filter(|r| r.model.found() == tried[tried.len() - 1]) else { continue };
        let there = all(&rival);
        log.push(format!(
            "rival by its own fit {}, by columns {}: {}",
            more(there, here),
            more(weighed.sets[k].gain, gain),
            describe(&rival.model)
        ));
        weighed.sets[k].gain = gain + there - here;
        if best.as_ref().is_none_or(|(score, _)| there > *score) {
            best = Some((there, rival));
        }
    }
    weighed.sets.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    match best {
        Some((there, rival)) if is_above(there, here, LIKELIER) => match weigh(engine, &rival.model) {
            Some(again) => at_rival(rival, again, &weighed, [there - here, gain]),
            None => (fit, weighed),
        },
        _ => (fit, weighed),
    }
}

/// A rival in the place of the best, all sets weighed at it; those fitted before keep what their fits say of the two.
fn at_rival(rival: Fit, mut again: Weighed, before: &Weighed, [ahead, gain]: [f64; 2]) -> (Fit, Weighed) {
    let own = rival.model.found();
    let here = again.sets.iter().find(|s| again.families_of(s) == own).map(|s| s.gain);
    let old = before.sets.iter().filter(|s| s.gain >= gain).map(|s| (before.families_of(s), s.gain)).collect::<Vec<_>>();
    if let Some(here) = here {
        for k in 0..again.sets.len() {
            let of_set = again.families_of(&again.sets[k]);
            if let Some((_, was)) = old.iter().find(|(f, _)| *f == of_set && *f != own) {
                again.sets[k].gain = again.sets[k].gain.min(here + was - gain - ahead);
            }
        }
    }
    again.sets.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    (rival, again)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{apart, bare, fit, in_gusts, member, number, set, unit, weighed};
    use super::*;
    use crate::flown::{flown, flown_by};
    use crate::model::{Id, Member, Model};
    use nalgebra::DMatrix;
    use windfall_model::{CATALOGUE, Use};

    /// A centre of mass a tenth of a millimetre off, taken for a lander that is not symmetric: the likelier rival takes the place, and both are as far
    /// apart as their fits.
    #[test]
    fn law_the_likelier_rival_takes_the_place() {
        let (engine, truth) = flown(6.0, "center-of-mass", &[0.0, 1e-4, 0.0]);
        let asymmetry = CATALOGUE.iter().find(|e| e.family == "asymmetry").expect("an effect of the catalogue");
        let taken = Model { members: vec![Member::null(asymmetry, &engine.campaign)], ..truth };
        let fit = engine.climb(&taken, true, 12).expect("a fit");
        let (before, weighed) = (score(&engine, &fit), weigh(&engine, &fit.model).expect("weighed"));
        let (after, weighed) = rivals_fitted(&engine, fit, weighed, &mut Vec::new());
        assert_eq!(after.model.found(), ["center-of-mass"]);
        let gain = |family: &str| weighed.sets.iter().find(|s| weighed.families_of(s) == [family]).expect("a set").gain;
        let (fits, sets) = (score(&engine, &after) - before, gain("center-of-mass") - gain("asymmetry"));
        assert!(fits > 3.0 && (fits - sets).abs() < 0.05, "{fits} {sets}");
        // From there the other does not take it, and has the gain of its fit.
        let weighed = weigh(&engine, &after.model).expect("weighed");
        let (again, weighed) = rivals_fitted(&engine, after, weighed, &mut Vec::new());
        assert_eq!(again.model.found(), ["center-of-mass"]);
        let gain = |family: &str| weighed.sets.iter().find(|s| weighed.families_of(s) == [family]).expect("a set").gain;
        let sets = gain("center-of-mass") - gain("asymmetry");
        assert!((fits - sets).abs() < 0.05, "{fits} {sets}");
    }

    /// A run kept for choosing counts: of the same two each has the gain of both runs.
    #[test]
    fn law_a_run_that_chooses_counts() {
        let off = [0.0, 1e-4, 0.0];
        let (engine, truth) = flown_by("center-of-mass", &[(Use::Identify, 6.0, &off), (Use::Select, 4.0, &off)]);
        let asymmetry = CATALOGUE.iter().find(|e| e.family == "asymmetry").expect("an effect of the catalogue");
        let taken = Model { members: vec![Member::null(asymmetry, &engine.campaign)], ..truth };
        let fit = engine.climb(&taken, true, 12).expect("a fit");
        let before = [score(&engine, &fit), predicted(&engine, &fit)];
        let weighed = weigh(&engine, &fit.model).expect("weighed");
        let (after, weighed) = rivals_fitted(&engine, fit, weighed, &mut Vec::new());
        let own = score(&engine, &after) - before[0];
        let other = predicted(&engine, &after) - before[1];
        let gain = |family: &str| weighed.sets.iter().find(|s| weighed.families_of(s) == [family]).expect("a set").gain;
        let sets = gain("center-of-mass") - gain("asymmetry");
        assert!(other.abs() > 0.5 && (own + other - sets).abs() < 0.05, "{own} {other} {sets}");
    }

    /// A set that was fitted before is as far behind the rival as the fits were, where weighing at the rival says no less.
    #[test]
    fn exact_gains_of_fits_stay() {
        let (engine, _) = in_gusts();
        let families = ["center-of-mass", "asymmetry", "damping-shape", "swirl"];
        let places = families.map(|f| CATALOGUE.iter().position(|e| e.family == f).expect("an effect of the catalogue"));
        let all = |gains: [f64; 4]| {
            let numbers = vec![number(Id::Constant(0), 0.0, 1.0), number(Id::Generic(0), 0.0, 1.0)];
            let sets = (0..4).map(|i| set(&[i], gains[i])).collect();
            let units = places.map(|p| unit(p, &[0], 0.0)).to_vec();
            weighed(apart(numbers, &[1.0; 2], &[0.0; 2], 0.0), units, places.map(|p| (p, None)).to_vec(), sets)
        };
        let rival =
            fit(Model { members: vec![member(&engine, "asymmetry")], ..bare() }, Vec::new(), DMatrix::zeros(0, 0), [0.0; 2]);
        // Of a best with 20 and a rival 4 ahead, which has 31 at itself: 27 for the best at most, and 29 for one that was 2 ahead.
        let (_, after) = at_rival(rival, all([30.0, 31.0, 30.5, 12.0]), &all([20.0, 24.0, 22.0, 25.0]), [4.0, 20.0]);
        let gain = |family: &str| after.sets.iter().find(|s| after.families_of(s) == [family]).expect("a set").gain;
        let found = families.map(gain);
        assert!(found.iter().zip([27.0, 31.0, 29.0, 12.0]).all(|(f, e)| (f - e).abs() < 1e-12), "{found:?}");
    }
}
