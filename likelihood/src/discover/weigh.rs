//! likelihood: all sets weighed at a model. In: a model. Out: sets by log marginal likelihood, and the model that a set makes.

use super::{against_family, cost};
use crate::check::Alternative;
use crate::engine::{Engine, always};
use crate::filter::Departed;
use crate::gram::Gram;
use crate::model::{Id, Member, Model, Number, candidates};
use crate::search::{Set, Unit, search, units};
use windfall_model::{CATALOGUE, Effect};

/// Most effects in a set.
pub(super) const MOST: usize = 4;

/// Log odds by which a larger set must beat a smaller one to be chosen: twenty to one.
pub(super) const SURE: f64 = 3.0;

impl Weighed {
    /// The smallest set that the best does not beat by [`SURE`], the best of that size.
    pub(super) fn choice(&self) -> &Set {
        let best = &self.sets[0];
        let enough = |s: &&Set| s.gain >= best.gain - SURE;
        self.sets.iter().filter(enough).min_by_key(|s| s.units.len()).unwrap_or(best)
    }

    /// Families of a set, ascending.
    pub(super) fn families_of(&self, set: &Set) -> Vec<&'static str> {
        let mut all: Vec<&str> = families_of(&self.families, set).collect();
        all.sort_unstable();
        all
    }

    /// Sets with one of those families are no more among them.
    pub(super) fn leave_out(&mut self, families: &[&str]) {
        self.sets.retain(|s| !families_of(&self.families, s).any(|f| families.contains(&f)));
    }

    /// Sets with that family are less likely by so many nats.
    pub(super) fn lessen(&mut self, family: &str, by: f64) {
        for s in &mut self.sets {
            if families_of(&self.families, s).any(|f| f == family) {
                s.gain -= by;
                s.fit -= by;
            }
        }
        self.sets.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    }
}

/// Families of a set's units, without generic alternatives.
pub(super) fn families_of(families: &[(usize, Option<usize>)], set: &Set) -> impl Iterator<Item = &'static str> {
    set.units.iter().filter_map(|&u| CATALOGUE.get(families[u].0).map(|e| e.family))
}

pub(super) struct Weighed {
    pub(super) gram: Gram,
    /// Everything, with the places of what every set has and of the others.
    pub(super) whole: Gram,
    pub(super) base: Vec<usize>,
    pub(super) others: Vec<usize>,
    pub(super) units: Vec<Unit>,
    pub(super) families: Vec<(usize, Option<usize>)>,
    pub(super) sets: Vec<Set>,
    pub(super) total: f64,
}

/// All candidates weighed at a model.
pub(super) fn weigh(engine: &Engine, model: &Model) -> Option<Weighed> {
    weigh_beside(engine, model, &[])
}

/// All candidates and generic alternatives weighed at a model.
pub(super) fn weigh_beside(engine: &Engine, model: &Model, alternatives: &[Alternative]) -> Option<Weighed> {
    let mut numbers = model.known(&engine.campaign);
    numbers.extend(model.of_members(false));
    numbers.extend(candidates(&engine.campaign, model));
    let mut generic = Vec::new();
    let mut group: Vec<usize> = Vec::new();
    for (k, a) in alternatives.iter().enumerate() {
        for basis in &a.bases {
            let id = Id::Generic(generic.len());
            numbers.push(Number {
                id,
                value: 0.0,
                prior: a.prior,
                range: [f64::NEG_INFINITY, f64::INFINITY],
                at_end: [false; 2],
                step: 1.0,
            });
            generic.push((a.site, *basis));
            group.push(k);
        }
    }
    // An effect that these runs give no slope of is not weighed.
    let sum = loop {
        match engine.sum(model, &numbers, &generic) {
            Ok(sum) => break sum,
            Err(Departed { column: Some(place), .. }) => {
                let Id::Strength(family, form, _) = numbers[place].id else { return None };
                numbers.retain(|n| !matches!(n.id, Id::Strength(f, o, _) if f == family && o == form));
            }
            Err(_) => return None,
        }
    };
    outcome(engine, model, Gram::new(numbers, sum.g, sum.b, sum.log_likelihood), alternatives.len(), &group)
}

/// All sets of what a gram has, `alternatives` groups of generic columns among it.
fn outcome(engine: &Engine, model: &Model, gram: Gram, alternatives: usize, group: &[usize]) -> Option<Weighed> {
    let base: Vec<usize> = places(&gram.numbers, |n| always(n.id, model));
    let others: Vec<usize> =
        places(&gram.numbers, |n| !always(n.id, model) && gram.g[(index(&gram.numbers, n.id), index(&gram.numbers, n.id))] > 0.0);
    let floor = gram.posterior(&base)?;
    let left = gram.given(&base, &others)?;
    let group_of = |id: Id| -> Option<(usize, f64)> {
        match id {
            Id::Strength(family, ..) => Some((family, cost(&Member::null(CATALOGUE[family], &engine.campaign), engine))),
            Id::Member(m, _) => Some((place_of(model.members[m].effect)?, cost(&model.members[m], engine))),
            Id::Generic(i) => Some((GENERIC + group[i], against_family().ln() + (alternatives as f64).ln())),
            _ => None,
        }
    };
    let key = |id: Id| match id {
        Id::Strength(family, form, _) => (family, form + 1),
        Id::Member(m, _) => (place_of(model.members[m].effect).unwrap_or(0), 0),
        Id::Generic(i) => (GENERIC + group[i], 0),
        _ => (usize::MAX, 0),
    };
    let all = units(&left.numbers, &group_of, &key);
    let families = all.iter().map(|u| {
        let (family, form) = key(left.numbers[u.columns[0]].id);
        (family, form.checked_sub(1))
    });
    let families = families.collect();
    // What the present members' values have brought is put back into the floor: the likelihood of the empty set.
    let shift = gram.log_likelihood - quadratic_here(&gram);
    let sets = search(&left, &all, if alternatives == 0 { MOST } else { MOST + 1 });
    let total = shift + floor.gain + sets[0].gain;
    Some(Weighed { gram: left, whole: gram, base, others, units: all, families, sets, total })
}

/// First place of the generic alternatives among families.
pub(super) const GENERIC: usize = 1000;

/// What the quadratic says that present values gain over nulls.
pub(super) fn quadratic_here(gram: &Gram) -> f64 {
    let v = nalgebra::DVector::from_iterator(gram.numbers.len(), gram.numbers.iter().map(|n| n.value));
    gram.b_here.dot(&v) + 0.5 * v.dot(&(&gram.g * &v))
}

pub(super) fn places(numbers: &[Number], keep: impl Fn(&Number) -> bool) -> Vec<usize> {
    (0..numbers.len()).filter(|&i| keep(&numbers[i])).collect()
}

pub(super) fn index(numbers: &[Number], id: Id) -> usize {
    numbers.iter().position(|n| n.id == id).unwrap_or(0)
}

pub(super) fn place_of(effect: &Effect) -> Option<usize> {
    CATALOGUE.iter().position(|e| std::ptr::eq(*e, effect))
}

/// The model with a set's units as members at their estimates; random and declared members stay.
pub(super) fn with_set(model: &Model, w: &Weighed, set: &Set, engine: &Engine) -> Model {
    let mut next = model.clone();
    next.members.retain(|m| m.random || m.declared);
    for &u in &set.units {
        let (family, form) = w.families[u];
        let mut member = match form {
            Some(form) => {
                let null = Member::null(CATALOGUE[family], &engine.campaign);
                let values = null.forms()[form].clone();
                Member { values, ..null }
            }
            None => match model.members.iter().find(|m| place_of(m.effect) == Some(family)) {
                Some(m) => m.clone(),
                None => continue,
            },
        };
        let strengths: Vec<usize> = member.strengths().collect();
        strengths.iter().for_each(|&i| member.values[i] = 0.0);
        for (c, estimate) in set.columns.iter().zip(&set.estimates) {
            if !w.units[u].columns.contains(c) {
                continue;
            }
            if let Id::Strength(_, _, i) | Id::Member(_, i) = w.gram.numbers[*c].id {
                member.values[i] = *estimate;
            }
        }
        next.members.push(member);
    }
    // What every set has moves with the set.
    let joint: Vec<usize> = w.base.iter().copied().chain(set.columns.iter().map(|&c| w.others[c])).collect();
    if let Some(p) = w.whole.posterior(&joint) {
        for (&place, mean) in w.base.iter().zip(p.mean.iter()) {
            let n = &w.whole.numbers[place];
            if !matches!(n.id, Id::Member(..)) {
                next.change(n, mean - n.value);
            }
        }
    }
    next
}

/// What stands in a set for anything that no effect of the catalogue is.
pub const SOMETHING_ELSE: &str = "something-else";

/// Families of a set, whatever their forms.
#[derive(Clone, Debug, PartialEq)]
pub struct FamilySet {
    /// Ascending.
    pub families: Vec<&'static str>,
    /// Log marginal likelihood over the empty set's, costs taken off.
    pub gain: f64,
    /// Log-likelihood of its best form at its estimates over the empty set's.
    pub fit: f64,
}

/// Families of each set with those of the random members, merged over forms, best first.
pub(super) fn named(w: &Weighed, model: &Model) -> Vec<FamilySet> {
    let random = random_families(model);
    merged(w.sets.iter().map(|s| (families_of(&w.families, s).chain(random.iter().copied()).collect(), s.gain, s.fit)))
}

/// Families of a model's random members that were found.
pub(super) fn random_families(model: &Model) -> Vec<&'static str> {
    model.members.iter().filter(|m| m.random && !m.declared).map(|m| m.effect.family).collect()
}

/// Sets of families with gain and fit, each set once, best first.
pub(super) fn merged(sets: impl Iterator<Item = (Vec<&'static str>, f64, f64)>) -> Vec<FamilySet> {
    let mut all: Vec<FamilySet> = Vec::new();
    for (mut families, gain, fit) in sets {
        families.sort_unstable();
        match all.iter_mut().find(|other| other.families == families) {
            Some(same) => {
                let (a, b) = (same.gain.max(gain), same.gain.min(gain));
                same.gain = a + (b - a).exp().ln_1p();
                same.fit = same.fit.max(fit);
            }
            None => all.push(FamilySet { families, gain, fit }),
        }
    }
    all.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    all
}

#[cfg(test)]
mod tests;
