//! discover: the sets of effects that a search ended with. In: what it found. Out: sets and effects with their probabilities, rivals, and what those contradict.

use super::result::SetLine;
use windfall_likelihood::{Discovery, FamilySet};

/// Sets with their probabilities, down to a thousandth; what only stands for something else is in none.
pub(super) fn sets(found: &Discovery) -> Vec<SetLine> {
    let mut all: Vec<SetLine> = Vec::new();
    for (set, probability) in found.sets.iter().zip(weights(&found.sets)) {
        let named = set.families.iter().filter(|f| !found.stand_ins.contains(f));
        let families: Vec<String> = named.map(|f| (*f).to_owned()).collect();
        match all.iter_mut().find(|line| line.families == families) {
            Some(line) => line.probability += probability,
            None => all.push(SetLine { families, probability }),
        }
    }
    all.retain(|line| line.probability > 1e-3);
    all
}

/// Probability of each set.
fn weights(sets: &[FamilySet]) -> Vec<f64> {
    let top = sets.first().map_or(0.0, |s| s.gain);
    let all: Vec<f64> = sets.iter().map(|s| (s.gain - top).exp()).collect();
    let sum: f64 = all.iter().sum();
    all.iter().map(|w| w / sum).collect()
}

/// Probability of the sets that have a family.
pub(super) fn probability(sets: &[FamilySet], family: &str) -> f64 {
    sets.iter().zip(weights(sets)).filter(|(s, _)| s.families.contains(&family)).map(|(_, w)| w).sum()
}

/// Families of the last fit that the sets weighed there hold for less likely than one in twenty: the search ended before a set stayed, and they are
/// no effects that were found.
pub(super) fn contradicted(found: &Discovery) -> Vec<&'static str> {
    let members = found.after.model.members.iter().filter(|m| !m.declared && !m.random);
    let families = members.map(|m| m.effect.family).filter(|f| !found.stand_ins.contains(f));
    families.filter(|f| is_unlikely(&found.sets, f)).collect()
}

/// Less than one in [`RIVAL`].
fn is_unlikely(sets: &[FamilySet], family: &str) -> bool {
    probability(sets, family) * RIVAL < 1.0
}

/// What is said of those.
pub(super) fn unsettled(contradicted: &[&str]) -> String {
    let (what, verb) = (contradicted.join(" and "), if contradicted.len() == 1 { "stands" } else { "stand" });
    format!(
        "the search ended before any set of effects stayed: {what} {verb} in its last fit and less likely than one in twenty among all sets \
         weighed there, so what is behind is not named"
    )
}

/// Families that take this one's place at odds of less than twenty, or whose best fit is less than that from the best set's: how plausible a
/// size was beforehand does not say that the runs tell two families apart.
pub(super) fn rivals(found: &Discovery, family: &str) -> Vec<String> {
    let Some(best) = found.sets.first() else { return Vec::new() };
    let rest: Vec<&str> = best.families.iter().copied().filter(|f| *f != family).collect();
    let in_its_place = |s: &&FamilySet| {
        s.families.len() == best.families.len() && !s.families.contains(&family) && rest.iter().all(|r| s.families.contains(r))
    };
    let near = |s: &&FamilySet| best.gain - s.gain < RIVAL.ln() || best.fit - s.fit < RIVAL.ln();
    let mut all: Vec<String> = Vec::new();
    for other in found.sets.iter().filter(in_its_place).filter(near).flat_map(|s| &s.families).filter(|f| !rest.contains(f)) {
        if !all.iter().any(|f| f == other) {
            all.push((*other).to_owned());
        }
    }
    all
}

/// Odds below which another family is a rival.
const RIVAL: f64 = 20.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// Three sets with gains two apart. What is in the best or the second may be named, what the third alone has may not.
    #[test]
    fn exact_probabilities() {
        let set = |families: &[&'static str], gain: f64| FamilySet { families: families.to_vec(), gain, fit: gain };
        let sets = [set(&["magnus", "swirl"], 10.0), set(&["mass", "swirl"], 8.0), set(&["inertia", "swirl"], 6.0)];
        let sum = 1.0 + (-2.0_f64).exp() + (-4.0_f64).exp();
        assert!((probability(&sets, "mass") - (-2.0_f64).exp() / sum).abs() < 1e-12);
        assert!((probability(&sets, "swirl") - 1.0).abs() < 1e-12);
        assert_eq!(
            ["swirl", "magnus", "mass", "inertia", "contact"].map(|f| is_unlikely(&sets, f)),
            [false, false, false, true, true]
        );
    }
}
