//! discover: the contest of sets of effects on tracks. In: tracks, a declared model. Out: the set that the runs speak for, and all next to it.

use super::settings::Settings;
use super::{amounts, catalogue, declared, problem, settled_fit};
use crate::DiscoverError;
use crate::tracks::{EffectInstance, Free, Problem, TrackEvidence, TrackFit, TrackModel};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use windfall_likelihood::{CONTRADICTED, UNFLOWN, log_mean};
use windfall_model::{Campaign, Effect, Measured, Parameter, Role};

/// Log odds by which a larger set must beat a smaller one: gains are held back already by what few runs know of their scatter
/// ([`TrackContest::factor`]), and 1 in 100 campaigns without an effect get one all the same (`law_few_false_names` of the tests).
const SURE: f64 = 1.0;
/// The same of poses, twenty to one: flights of unlike settings do not scatter alike, which one covariance for all takes no note of, and
/// controls have shown odds of six to one for an effect that was not there.
const SURE_OF_POSES: f64 = 3.0;
/// Prior standard deviations of an effect's strengths, as shares of the most that a body can have: each as likely, for effects are of any
/// size.
const PLAUSIBLE: [f64; 4] = [0.3, 0.1, 0.03, 0.01];
/// The same of a declared parameter over its size: knows nothing of it.
const VAGUE: f64 = 30.0;
/// Most effects in a set, and most moves of the search.
const MOST: usize = 4;
const MOVES: usize = 12;

/// A set with its fit.
#[derive(Clone)]
pub(super) struct ScoredSet {
    /// Places in [`TrackContest::families`], in the order of the fit's effects after those declared.
    pub(super) families: Vec<usize>,
    pub(super) fit: TrackFit,
    /// Log marginal likelihood, costs taken off.
    pub(super) score: f64,
}

impl ScoredSet {
    /// Place of its `k`-th family among the fit's effects: after those declared.
    pub(super) fn place(&self, k: usize) -> usize {
        self.fit.hypothesis.effects.len() - self.families.len() + k
    }
    pub(super) fn has(&self, effect: &Effect) -> bool {
        self.fit.hypothesis.effects.iter().any(|e| e.effect == effect)
    }
}

/// A search and its outcome.
pub(super) struct TrackContest<'a> {
    pub(super) campaign: &'a Campaign,
    settings: &'a Settings,
    select: Option<&'a TrackEvidence>,
    pub(super) evidence: TrackEvidence,
    pub(super) families: Vec<&'static Effect>,
    /// The declared model alone, and every family alone beside it, at the evidence of the end.
    pub(super) declared: ScoredSet,
    pub(super) singles: Vec<ScoredSet>,
    pub(super) best: ScoredSet,
    /// Sets that differ from the best by one family more, less, or other.
    pub(super) neighbours: Vec<ScoredSet>,
}

impl<'a> TrackContest<'a> {
    pub(super) fn new(
        campaign: &'a Campaign,
        settings: &'a Settings,
        runs: &[usize],
        select: Option<&'a TrackEvidence>,
    ) -> Result<Self, DiscoverError> {
        let mut evidence = TrackEvidence::new(campaign, runs, &campaign.plant)?;
        let start = declared(campaign, settings, evidence.components());
        let fit = settled_fit(campaign, &mut evidence, start)?;
        evidence.settle(&fit.hypothesis.plant(&campaign.plant));
        let families = catalogue(campaign.body()).filter(|e| !campaign.knowledge.effects.iter().any(|(d, _)| d == e)).collect();
        let start = ScoredSet { families: Vec::new(), fit, score: f64::NEG_INFINITY };
        Ok(Self {
            campaign,
            settings,
            select,
            evidence,
            families,
            declared: start.clone(),
            singles: Vec::new(),
            best: start,
            neighbours: Vec::new(),
        })
    }

    pub(super) fn problem(&self) -> Problem<'_> {
        problem(self.campaign, &self.evidence)
    }

    /// An effect at null beside the runs.
    pub(super) fn null(&self, effect: &'static Effect) -> EffectInstance {
        self.settings.null(effect, self.campaign)
    }

    pub(super) fn family_name(&self, place: usize) -> String {
        self.families[place].family.to_owned()
    }

    /// Factor on twice a gain of log-likelihood by `tested` numbers, as few runs allow it.
    pub(super) fn factor(&self, tested: usize) -> f64 {
        self.evidence.factor(self.declared.fit.free.len(), tested)
    }

    /// The best set without its `k`-th family.
    pub(super) fn without(&self, k: usize) -> Option<&ScoredSet> {
        let mut rest = self.best.families.clone();
        rest.remove(k);
        if rest.is_empty() { Some(&self.declared) } else { self.neighbours.iter().find(|s| s.families == rest) }
    }

    /// Moves by one family at a time until no set next to the best is better.
    pub(super) fn run(mut self) -> Result<Self, DiscoverError> {
        let mut been: Vec<Vec<usize>> = Vec::new();
        for _ in 0..MOVES {
            self.weigh();
            let mut key = self.best.families.clone();
            key.sort_unstable();
            let Some(next) = self.next().filter(|_| !been.contains(&key)) else { break };
            been.push(key);
            self.evidence.settle(&next.fit.hypothesis.plant(&self.campaign.plant));
            self.best = next;
        }
        Ok(self)
    }

    /// Takes another set for the best, and weighs what is next to it on the evidence as it lies.
    pub(super) fn stand_at(&mut self, set: ScoredSet) {
        self.best = set;
        self.weigh();
    }

    /// Fits the declared model, the best set and all its neighbours to the evidence as it lies.
    fn weigh(&mut self) {
        let h = declared(self.campaign, self.settings, self.evidence.components());
        let fit = self.problem().fit(&h, false);
        self.declared = ScoredSet { families: Vec::new(), score: f64::NEG_INFINITY, fit };
        self.declared.score = self.score(&self.declared.fit, 0);
        let at = self.best.families.clone();
        let all = 0..self.families.len();
        let less = |k: usize| at.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, f)| *f).collect::<Vec<_>>();
        let with = |set: &[usize], f: usize| set.iter().copied().chain([f]).collect::<Vec<_>>();
        let mut wanted: Vec<Vec<usize>> = vec![at.clone()];
        wanted.extend((0..at.len()).map(less));
        let others: Vec<usize> = all.clone().filter(|f| !at.contains(f)).collect();
        if at.len() < MOST {
            wanted.extend(others.iter().map(|&f| with(&at, f)));
        }
        wanted.extend((0..at.len()).flat_map(|k| others.iter().map(move |&f| (k, f))).map(|(k, f)| with(&less(k), f)));
        wanted.extend(all.map(|f| vec![f]).filter(|s| at.len() != 1 || s[0] != at[0]));
        let kept = self.best.fit.hypothesis.clone();
        wanted.sort();
        wanted.dedup();
        let bare = TrackModel { effects: Vec::new(), ..kept.clone() };
        // The likelihood may have several tops: the best set is sought from null as well.
        let likelier = |set: Vec<usize>| {
            let starts: &[&TrackModel] = if set == at && !at.is_empty() { &[&kept, &bare] } else { &[&kept] };
            let fits = starts.iter().filter_map(|near| self.fitted(&set, near));
            fits.max_by(|a, b| a.fit.log_likelihood.total_cmp(&b.fit.log_likelihood))
        };
        let mut fitted: Vec<ScoredSet> = wanted.into_par_iter().filter_map(likelier).collect();
        self.singles = fitted.iter().filter(|s| s.families.len() == 1).cloned().collect();
        if let Some(i) = fitted.iter().position(|s| s.families == at) {
            self.best = fitted.swap_remove(i);
        }
        fitted.retain(|s| is_next_to(&s.families, &at) && s.families != at);
        self.neighbours = fitted;
    }

    /// An effect where its fit starts: at null; of specific forces a strength that is never negative at a quarter of the most that a body
    /// can have, for without drag the initial velocity is not seen, and a step from there leads anywhere.
    fn started(&self, effect: &'static Effect) -> EffectInstance {
        let mut instance = self.null(effect);
        if self.campaign.measured() == Measured::SpecificForce {
            for (p, v) in instance.parameters.iter().zip(&mut instance.values) {
                if p.role == Role::Strength && p.low == 0.0 {
                    *v = 0.25 * p.high;
                }
            }
        }
        instance
    }

    /// A set fitted in full, from the values that its members have in `near`. A strength that would leave what a body can have is held at
    /// null, one that would take away more than there is at all that there is; `None` where a family has none left.
    fn fitted(&self, set: &[usize], near: &TrackModel) -> Option<ScoredSet> {
        let mut h = declared(self.campaign, self.settings, near.generic.len());
        h.generic.clone_from(&near.generic);
        let own = h.effects.len();
        h.effects.extend(set.iter().map(|&f| {
            let from_near = self.campaign.measured() != Measured::SpecificForce;
            let known = near.effects.iter().find(|e| from_near && e.effect == self.families[f]);
            known.cloned().unwrap_or_else(|| self.started(self.families[f]))
        }));
        loop {
            let fit = self.problem().fit(&h, true);
            if !fit.log_likelihood.is_finite() {
                return None;
            }
            let edge = |&(k, i): &(usize, usize)| {
                let e = &fit.hypothesis.effects[k];
                let (p, v) = (&e.parameters[i], e.values[i]);
                let held = !fit.free.contains(&Free::Effect(k, i));
                p.role == Role::Strength && held && (v - p.null).abs() > 1e-12 && !takes_all(p, v)
            };
            let places = (own..h.effects.len()).flat_map(|k| (0..h.effects[k].values.len()).map(move |i| (k, i)));
            if let Some((k, i)) = places.clone().find(edge) {
                let p = &mut h.effects[k].parameters[i];
                (p.low, p.high) = (p.null, p.null);
                h.effects[k].values[i] = h.effects[k].parameters[i].null;
                continue;
            }
            let lives = |k: usize| numbers_of(&fit, k) > 0;
            let sound = |k: usize| !amounts::is_overdrawn(self.campaign, self.settings.runs(), &fit, k);
            return (own..h.effects.len()).all(|k| lives(k) && sound(k)).then(|| {
                let score = self.score(&fit, set.len());
                ScoredSet { families: set.to_vec(), fit, score }
            });
        }
    }

    /// Log marginal likelihood by Laplace's approximation with normal priors about null, the mean over their widths, effect by effect, less
    /// what the families cost; with it what the runs kept for choosing say.
    fn score(&self, fit: &TrackFit, families: usize) -> f64 {
        let own = fit.hypothesis.effects.len() - families;
        let ways = PLAUSIBLE.len().pow(families as u32);
        let each = (0..ways).map(|way| {
            let width = |k: usize| PLAUSIBLE[way / PLAUSIBLE.len().pow(k.saturating_sub(own) as u32) % PLAUSIBLE.len()];
            self.marginal(fit, &width)
        });
        let all: Vec<f64> = each.collect();
        let mean = log_mean(&all);
        let added: usize = (own..fit.hypothesis.effects.len()).map(|k| numbers_of(fit, k)).sum();
        let gain = (fit.log_likelihood - self.declared.fit.log_likelihood) * self.factor(added);
        gain + mean - families as f64 * (self.families.len() as f64).ln() + self.predicted(fit)
    }

    /// Log predictive density of the runs kept for choosing; zero without such runs.
    fn predicted(&self, fit: &TrackFit) -> f64 {
        self.select.map_or(0.0, |s| problem(self.campaign, s).predictive(fit).max(UNFLOWN))
    }

    /// What integrating over the free numbers gives beside the likelihood at its maximum, with a prior width for every effect.
    fn marginal(&self, fit: &TrackFit, width: &dyn Fn(usize) -> f64) -> f64 {
        let n = fit.free.len();
        if n == 0 {
            return 0.0;
        }
        let prior: Vec<f64> = fit.free.iter().map(|f| self.prior(fit, *f, width)).collect();
        let departures = DVector::from_fn(n, |i, _| match fit.free[i] {
            Free::Constant(_) | Free::Declared(_) => 0.0,
            f => fit.hypothesis.get(f) / prior[i],
        });
        // A declared prior is in the covariance and the likelihood already; what is left of it is its norm.
        let open = |i: usize| fit.hypothesis.prior(fit.free[i]).is_none();
        let scaled = DMatrix::from_fn(n, n, |i, j| fit.covariance[(i, j)] / (prior[i] * prior[j]));
        let wide = DMatrix::from_fn(n, n, |i, j| scaled[(i, j)] + f64::from(u8::from(i == j && open(i))));
        let (Some(of_data), Some(of_both)) = (scaled.cholesky(), wide.cholesky()) else { return f64::NEG_INFINITY };
        let ln = |c: &nalgebra::Cholesky<f64, nalgebra::Dyn>| c.l_dirty().diagonal().iter().map(|x| x.ln()).sum::<f64>();
        ln(&of_data) - ln(&of_both) - 0.5 * departures.dot(&of_both.solve(&departures))
    }

    fn prior(&self, fit: &TrackFit, f: Free, width: &dyn Fn(usize) -> f64) -> f64 {
        if let Some((_, std)) = fit.hypothesis.prior(f) {
            return std;
        }
        match f {
            Free::Declared(i) => VAGUE * self.campaign.plant.aero.values[i].abs().max(1.0),
            Free::Constant(i) => fit.hypothesis.constants[i].0.std,
            Free::Effect(k, i) => {
                let p = &fit.hypothesis.effects[k].parameters[i];
                if p.role == Role::Strength { width(k) * p.high } else { 0.5 * fit.hypothesis.get(f).abs().max(1e-12) }
            }
        }
    }

    fn sure(&self) -> f64 {
        if self.campaign.measured() == Measured::Pose { SURE_OF_POSES } else { SURE }
    }

    /// Where to move: a smaller set that the best does not beat by [`Self::sure`] or that the runs kept for choosing prefer; else the best of
    /// those that beat it, a larger one by as much.
    fn next(&self) -> Option<ScoredSet> {
        let n = self.best.families.len();
        let smaller = (0..n).filter_map(|k| self.without(k));
        let needless = smaller.filter(|s| !self.tells(s, &self.best));
        if let Some(s) = needless.max_by(|a, b| a.score.total_cmp(&b.score)) {
            return Some(s.clone());
        }
        let better = |s: &&ScoredSet| match s.families.len().cmp(&n) {
            std::cmp::Ordering::Greater => self.tells(&self.best, s),
            std::cmp::Ordering::Equal => s.score > self.best.score + 0.01,
            std::cmp::Ordering::Less => false,
        };
        self.neighbours.iter().filter(better).max_by(|a, b| a.score.total_cmp(&b.score)).cloned()
    }

    /// Whether one set says more than a smaller one: surely, more than the tracker's stated error could make, and not contradicted by the runs
    /// kept for choosing.
    fn tells(&self, less: &ScoredSet, more: &ScoredSet) -> bool {
        more.score > less.score + self.sure()
            && self.predicted(&more.fit) >= self.predicted(&less.fit) - CONTRADICTED
            && self.evidence.tells(&less.fit.residual, &more.fit.residual)
    }
}

/// Whether a strength takes away all that there is of an amount.
fn takes_all(p: &Parameter, value: f64) -> bool {
    p.net.is_some() && value < p.null && p.is_at_end(value)
}

/// How many numbers an effect of a fit has: those that were fitted, and amounts that it takes away whole.
pub(super) fn numbers_of(fit: &TrackFit, k: usize) -> usize {
    let e = &fit.hypothesis.effects[k];
    let counts = |i: usize| fit.free.contains(&Free::Effect(k, i)) || takes_all(&e.parameters[i], e.values[i]);
    (0..e.values.len()).filter(|i| counts(*i)).count()
}

/// Whether a set differs from another by one family more, less, or other, or not at all.
fn is_next_to(set: &[usize], at: &[usize]) -> bool {
    let missing = at.iter().filter(|f| !set.contains(f)).count();
    missing <= 1 && set.len() + missing <= at.len() + 1
}

#[cfg(test)]
pub(super) mod tests;
