//! discover: the sets of effects that a search ended with. In: what it found. Out: sets and effects with their probabilities, rivals, and what those contradict.

use super::judged::NotNamed;
use super::result::{EffectLine, SetLine};
use crate::words::listed;
use windfall_likelihood::{Discovery, Engine, FamilySet, SOMETHING_ELSE, beside_something_else};

/// What is told of sets of effects.
pub(super) struct Told {
    /// Sets with something else among them. Where something is unexplained it acts in every set.
    pub(super) sets: Vec<FamilySet>,
    /// Whether nothing is unexplained.
    pub(super) is_explained: bool,
}

impl Told {
    pub(super) fn of(found: &Discovery, engine: &Engine, is_explained: bool) -> Self {
        let open = if is_explained { Vec::new() } else { beside_something_else(engine, found) };
        let sets = if open.is_empty() { found.sets_and_something_else() } else { open };
        Self { sets, is_explained }
    }

    /// Whether an effect of the fit is named. Where something else acts, only what is as probable beside it, itself or a rival in its place: the fit may
    /// have made the effect stand for what else acts.
    pub(super) fn stands(&self, family: &str) -> bool {
        let rivals = rivals(&self.sets, family);
        let is_it = |f: &str| f == family || rivals.iter().any(|r| r == f);
        let acts = probability_of(&self.sets, |s| s.families.iter().any(|f| is_it(f)));
        self.is_explained || acts * RIVAL > RIVAL - 1.0
    }
}

/// Sets with all that is in them and their probabilities, down to a thousandth.
pub(super) fn sets(sets: &[FamilySet]) -> Vec<SetLine> {
    let line = |(set, probability): (&FamilySet, f64)| SetLine {
        families: set.families.iter().map(|f| (*f).to_owned()).collect(),
        probability,
    };
    sets.iter().zip(weights(sets)).filter(|(_, p)| *p > 1e-3).map(line).collect()
}

/// Families of the most probable set and effects of the fit that are not named, each with the reason.
pub(super) fn not_named(found: &Discovery, told: &Told, contradicted: &[&str], effects: &[EffectLine]) -> Vec<NotNamed> {
    let of_fit = found.after.model.members.iter().filter(|m| !m.declared).map(|m| m.effect.family);
    let of_fit: Vec<&str> = of_fit.collect();
    let reason = |family: &str| {
        if found.stand_ins.contains(&family) {
            let what: Vec<String> = found.faint.iter().map(|l| format!("{} over {}", l.channel, l.variable)).collect();
            let which = if what.is_empty() { String::new() } else { format!(" ({})", listed(&what)) };
            return format!("gusts weaker than any tunnel's, or of a band as narrow as a tone, stand for something else{which}");
        }
        if contradicted.contains(&family) {
            return format!("the search ended before any set stayed, and sets with it are less likely than one in {RIVAL}");
        }
        if !told.is_explained && of_fit.contains(&family) {
            return "something is unexplained, and smooth loads or free accelerations in its place explain nearly as much"
                .to_owned();
        }
        format!(
            "the model that was fitted is without it: a set without it is within {RIVAL} to one as likely, or the search ended before"
        )
    };
    let best = told.sets.first().into_iter().flat_map(|s| s.families.iter().copied());
    let mut all: Vec<&str> = best.filter(|f| *f != SOMETHING_ELSE).collect();
    if !told.is_explained {
        all.extend(&of_fit);
    }
    let line = |family: &&str| NotNamed {
        family: (*family).to_owned(),
        probability: probability(&told.sets, family),
        reason: reason(family),
    };
    let is_named = |family: &&&str| effects.iter().any(|e| e.family == **family);
    all.sort_unstable();
    all.dedup();
    all.iter().filter(|f| !is_named(f)).map(line).collect()
}

/// Families of the most probable set that are not named, by what a reason is given for.
pub(super) fn beside(sets: &[SetLine], effects: &[EffectLine], reason: impl Fn(&str) -> String) -> Vec<NotNamed> {
    let of = |family: &String| NotNamed {
        family: family.clone(),
        probability: sets.iter().filter(|s| s.families.contains(family)).map(|s| s.probability).sum(),
        reason: reason(family),
    };
    let is_named = |family: &&String| effects.iter().any(|e| e.family == **family);
    sets.first().into_iter().flat_map(|s| &s.families).filter(|f| !is_named(f)).map(of).collect()
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
    probability_of(sets, |s| s.families.contains(&family))
}

/// Probability of such sets; rounding of their sum does not take it above one, nor the sum of none below zero.
fn probability_of(sets: &[FamilySet], is_such: impl Fn(&FamilySet) -> bool) -> f64 {
    sets.iter().zip(weights(sets)).filter(|(s, _)| is_such(s)).map(|(_, w)| w).sum::<f64>().abs().min(1.0)
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
pub(super) fn rivals(sets: &[FamilySet], family: &str) -> Vec<String> {
    let sets: Vec<&FamilySet> = sets.iter().filter(|s| s.families != [SOMETHING_ELSE]).collect();
    let Some(best) = sets.first() else { return Vec::new() };
    let rest: Vec<&str> = best.families.iter().copied().filter(|f| *f != family).collect();
    let in_its_place = |s: &&&FamilySet| {
        s.families.len() == best.families.len() && !s.families.contains(&family) && rest.iter().all(|r| s.families.contains(r))
    };
    let near = |s: &&&FamilySet| best.gain - s.gain < RIVAL.ln() || best.fit - s.fit < RIVAL.ln();
    let mut all: Vec<String> = Vec::new();
    for other in sets.iter().filter(in_its_place).filter(near).flat_map(|s| &s.families).filter(|f| !rest.contains(f)) {
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

    fn set(families: &[&'static str], gain: f64, fit: f64) -> FamilySet {
        FamilySet { families: families.to_vec(), gain, fit }
    }

    /// Gains of hundreds of nats have probabilities too. Every family of the most probable set is named or has a reason, and probabilities
    /// are of what is listed.
    #[test]
    fn exact_every_member_is_named_or_has_a_reason() {
        let all = [set(&["magnus", "turbulence"], 900.0, 0.0), set(&["magnus"], 898.0, 0.0), set(&["turbulence"], 897.0, 0.0)];
        let weights = [1.0, (-2.0_f64).exp(), (-3.0_f64).exp()];
        let sum: f64 = weights.iter().sum();
        let lines = sets(&all);
        let expected = [vec!["magnus", "turbulence"], vec!["magnus"], vec!["turbulence"]];
        assert_eq!(lines.len(), 3);
        for ((line, families), weight) in lines.iter().zip(expected).zip(weights) {
            assert!(line.families == families && (line.probability - weight / sum).abs() < 1e-12, "{line:?}");
        }
        let left = beside(&lines, &[], str::to_uppercase);
        let found: Vec<(&str, &str)> = left.iter().map(|n| (n.family.as_str(), n.reason.as_str())).collect();
        assert_eq!(found, [("magnus", "MAGNUS"), ("turbulence", "TURBULENCE")]);
        assert!((left[1].probability - (1.0 + weights[2]) / sum).abs() < 1e-12, "{left:?}");
        assert!((probability(&all, "magnus") - left[0].probability).abs() < 1e-12);
    }

    /// Beside something else an effect is named from nineteen twentieths on, itself or a rival in its place; where nothing is unexplained whatever its sets say.
    #[test]
    fn exact_what_stands_beside_something_else() {
        let with = |families: &[&'static str], p: f64| FamilySet {
            families: families.iter().copied().chain([SOMETHING_ELSE]).collect(),
            gain: p.ln(),
            fit: 0.0,
        };
        let told = |sets: Vec<FamilySet>, is_explained: bool| Told { sets, is_explained };
        let sets = |alone: f64| vec![with(&["magnus"], 0.96 - alone), with(&["mass"], alone), with(&[], 0.04)];
        assert!(told(sets(0.01), false).stands("magnus") && told(sets(0.3), false).stands("magnus"));
        assert!(!told(vec![with(&["magnus"], 0.94), with(&[], 0.06)], false).stands("magnus"));
        assert!(!told(vec![with(&[], 0.6), with(&["magnus"], 0.4)], false).stands("magnus"));
        assert!(told(vec![with(&[], 0.6), with(&["magnus"], 0.4)], true).stands("magnus"));
    }

    /// Something else takes no family's place.
    #[test]
    fn law_something_else_is_no_rival() {
        let all = [set(&[SOMETHING_ELSE], 41.0, 80.0), set(&["magnus"], 40.0, 70.0), set(&["mass"], 39.0, 70.0)];
        assert_eq!(rivals(&all, "magnus"), ["mass"]);
    }

    /// ln 20 is 2.996: a family takes another's place within it by plausibility or by fit alone, and in the best set's company
    /// only.
    #[test]
    fn exact_rivals_within_twenty_to_one() {
        let best = set(&["magnus", "swirl"], 40.0, 70.0);
        let near = set(&["mass", "swirl"], 37.1, 10.0);
        let fits = set(&["inertia", "swirl"], 4.0, 67.1);
        let far = set(&["contact", "swirl"], 36.9, 66.9);
        let alone = set(&["drag"], 39.0, 69.0);
        let other = set(&["draught", "mass"], 39.0, 69.0);
        let all = [best, near, fits, far, alone, other];
        assert_eq!(rivals(&all, "magnus"), ["mass", "inertia"]);
        assert!(rivals(&all, "swirl").is_empty());
    }
}
