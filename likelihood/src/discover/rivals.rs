//! likelihood: what one more run would say between sets of effects. In: a discovery, the information of a run. Out: expected odds, bounds.
//!
//! Information adds over runs: with normal equations `G, b` of the campaign and `G'` of a run flown as the model of set T says, the data of
//! both are expected at `G + G', b + G' θ_T`, and every set's marginal likelihood follows without another pass.

use super::weigh::{Weighed, weigh, with_set};
use super::{Discovery, score};
use crate::engine::Engine;
use crate::gram::Gram;
use crate::model::{Id, Model, Number};
use crate::search::{Set, weigh as weigh_set};
use nalgebra::{DMatrix, DVector};
use windfall_model::CATALOGUE;

/// Sets that a campaign's runs cannot tell apart, and what tells them apart.
pub struct Rivals<'a> {
    engine: &'a Engine,
    model: &'a Model,
    weighed: Weighed,
    /// Of each set, ascending.
    families: Vec<Vec<&'static str>>,
}

/// A pair of sets, by their place, with the log odds of the first over the second as things are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RivalPair {
    /// The better.
    pub best: usize,
    /// Its rival.
    pub rival: usize,
    /// Log odds of the first over the second.
    pub log_odds: f64,
}

/// A strength that was not found, with its standard error as things are.
#[derive(Clone, Debug, PartialEq)]
pub struct Unseen {
    /// Family.
    pub family: &'static str,
    /// Parameter.
    pub parameter: String,
    /// Unit.
    pub unit: &'static str,
    /// Largest plausible size.
    pub plausible: f64,
    place: usize,
}

impl<'a> Rivals<'a> {
    /// All sets weighed at what was found; `None` where the model departs.
    #[must_use]
    pub fn new(engine: &'a Engine, found: &'a Discovery) -> Option<Self> {
        let model = &found.after.model;
        let weighed = weigh(engine, model)?;
        let families = weighed.sets.iter().map(|s| weighed.families_of(s)).collect();
        Some(Self { engine, model, weighed, families })
    }

    /// Families of a set, ascending.
    #[must_use]
    pub fn families(&self, set: usize) -> &[&'static str] {
        &self.families[set]
    }

    /// The named set beside every other that is less than `odds` from it either way, with what was plausible beforehand or by the likelihood at
    /// their estimates alone, each by its best form; likeliest first. What is far better was given up for a generic alternative.
    #[must_use]
    pub fn pairs(&self, odds: f64) -> Vec<RivalPair> {
        let sets = &self.weighed.sets;
        let named = self.model.found();
        let Some(best) = (0..sets.len()).find(|&s| self.families[s] == named) else { return Vec::new() };
        let mut seen = vec![named];
        let mut all = Vec::new();
        for rival in 0..sets.len() {
            let log_odds = sets[best].gain - sets[rival].gain;
            let families = &self.families[rival];
            let fit = sets[best].fit - sets[rival].fit;
            let as_large = sets[best].units.len() == sets[rival].units.len();
            if (log_odds.abs() < odds.ln() || as_large && fit.abs() < odds.ln()) && !seen.contains(families) {
                seen.push(families.clone());
                all.push(RivalPair { best, rival, log_odds });
            }
        }
        all
    }

    /// The model that a set makes of what was found.
    #[must_use]
    pub fn model(&self, set: usize) -> Model {
        with_set(self.model, &self.weighed, &self.weighed.sets[set], self.engine)
    }

    /// Information of other runs on every number of every set, whitened as the campaign's; `None` where the model departs in them.
    #[must_use]
    pub fn information(&self, of: &Engine) -> Option<DMatrix<f64>> {
        of.sum(self.model, &self.weighed.whole.numbers, &[]).ok().map(|s| s.g)
    }

    /// Expected log odds of the set that is true over the other with such information beside the campaign's: of the pair's first where it is
    /// true, of its second where that is. The other may take any of its forms.
    #[must_use]
    pub fn expected(&self, pair: RivalPair, information: &DMatrix<f64>) -> Option<[f64; 2]> {
        let one = |truth: usize, other: usize| -> Option<f64> {
            let gram = self.with(&self.weighed.sets[truth], information)?;
            let gain = |s: &Set| weigh_set(&gram, &self.weighed.units, &s.units).map(|s| s.gain);
            let forms = (0..self.families.len()).filter(|&s| self.families[s] == self.families[other]);
            let against = forms.filter_map(|s| gain(&self.weighed.sets[s])).fold(f64::NEG_INFINITY, f64::max);
            Some(gain(&self.weighed.sets[truth])? - against)
        };
        Some([one(pair.best, pair.rival)?, one(pair.rival, pair.best)?])
    }

    /// Normal equations with information of runs in which a set is true, the numbers that every set has eliminated.
    fn with(&self, truth: &Set, information: &DMatrix<f64>) -> Option<Gram> {
        let w = &self.weighed;
        let joint: Vec<usize> = w.base.iter().copied().chain(truth.columns.iter().map(|&c| w.others[c])).collect();
        let posterior = w.whole.posterior(&joint)?;
        let mut theta = DVector::zeros(w.whole.numbers.len());
        joint.iter().zip(posterior.mean.iter()).for_each(|(&i, m)| theta[i] = *m);
        let whole = Gram { g: &w.whole.g + information, b: &w.whole.b + information * theta, ..w.whole.clone() };
        whole.given(&w.base, &w.others)
    }

    /// Strengths that were not found, each in the form that hides it best, with the standard error that they have beside the named set.
    #[must_use]
    pub fn unseen(&self) -> Vec<(Unseen, f64)> {
        let w = &self.weighed;
        let present: Vec<&str> = self.model.members.iter().map(|m| m.effect.family).collect();
        let mut all: Vec<(Unseen, f64)> = Vec::new();
        for (place, n) in w.whole.numbers.iter().enumerate() {
            let Id::Strength(family, _, parameter) = n.id else { continue };
            let effect = CATALOGUE[family];
            let Some(std) = self.error(place, None).filter(|_| !present.contains(&effect.family)) else { continue };
            let p = &(effect.parameters)(&self.engine.campaign.inputs)[parameter];
            let one = Unseen { family: effect.family, parameter: p.name.clone(), unit: p.unit, plausible: p.usual, place };
            match all.iter_mut().find(|(u, _)| (u.family, &u.parameter) == (one.family, &one.parameter)) {
                Some(old) if old.1 < std => *old = (one, std),
                Some(_) => {}
                None => all.push((one, std)),
            }
        }
        all
    }

    /// Standard error of an unseen strength with such information beside the campaign's.
    #[must_use]
    pub fn sharpened(&self, unseen: &Unseen, information: &DMatrix<f64>) -> Option<f64> {
        self.error(unseen.place, Some(information))
    }

    fn error(&self, place: usize, information: Option<&DMatrix<f64>>) -> Option<f64> {
        let w = &self.weighed;
        let mut joint = w.base.clone();
        joint.extend(
            (0..w.whole.numbers.len()).filter(|&i| matches!(w.whole.numbers[i].id, Id::Member(..)) && !w.base.contains(&i)),
        );
        // A strength that the data bound is not held by its prior.
        let free = |n: &Number, i: usize| if i == place { Number { prior: 1e3 * n.prior, ..*n } } else { *n };
        let numbers = w.whole.numbers.iter().enumerate().map(|(i, n)| free(n, i)).collect();
        joint.push(place);
        let g = information.map_or_else(|| w.whole.g.clone(), |i| &w.whole.g + i);
        let covariance = Gram { g, numbers, ..w.whole.clone() }.posterior(&joint)?.covariance;
        let last = joint.len() - 1;
        Some(covariance[(last, last)].sqrt()).filter(|s| s.is_finite())
    }
}

/// Log odds of one model over another, both fitted to an engine's runs from where they are; `None` where both depart.
#[must_use]
pub fn log_odds(engine: &Engine, one: &Model, other: &Model) -> Option<f64> {
    let end = |m: &Model| engine.climb(m, true, 8).ok().map(|f| score(engine, &f));
    match (end(one), end(other)) {
        (Some(a), Some(b)) => Some(a - b),
        (Some(_), None) => Some(f64::INFINITY),
        (None, Some(_)) => Some(f64::NEG_INFINITY),
        (None, None) => None,
    }
}

#[cfg(test)]
mod tests;
