//! discover: joint fit of a model to tracks. In: evidence and starting values. Out: estimates, covariance, likelihood.
//!
//! Parameters by Gauss-Newton on the whitened residual; sizes of the unmodelled residual by maximum likelihood.

use super::bins::{Cov, Residual};
use super::evidence::TrackEvidence;
use super::likelihood::{Effort, Whitening, components, total};
use super::model::{Free, TrackModel};
use super::normal::NormalEquations;
use super::scatter::Between;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use windfall_likelihood::{NearFit, Top, top};
use windfall_model::{Plant, Role};
use windfall_pid::StopReason;

/// Most iterations of the joint fit: quadratic ones need five, those from far off with halved steps more.
const ITERATIONS: usize = 25;
/// Most halvings of a step: a first step is a thousand times too long at the most.
const HALVINGS: usize = 10;
/// Starting variance of the unmodelled residual, in units of its component (a hundredth of the noise floor).
const GENERIC_START: f64 = 1e-2;

/// What stays the same over all models.
pub struct Problem<'a> {
    /// Residuals.
    pub evidence: &'a TrackEvidence,
    /// Declared plant.
    pub base: &'a Plant,
    /// Which parameters of its structure are declared.
    pub declared: &'a [bool],
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct TrackFit {
    /// Values.
    pub hypothesis: TrackModel,
    /// The free numbers, in order.
    pub free: Vec<Free>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Log-likelihood, up to a constant of the evidence.
    pub log_likelihood: f64,
    /// Residual of the data.
    pub residual: Residual,
    /// Why it stopped.
    pub stop: StopReason,
}

impl TrackFit {
    /// Standard error of a free number; infinite when it was not free.
    #[must_use]
    pub fn std_error(&self, f: Free) -> f64 {
        self.free.iter().position(|g| *g == f).map_or(f64::INFINITY, |i| self.covariance[(i, i)].max(0.0).sqrt())
    }
}

/// A number that the data do not determine beside the others.
struct Undetermined(Free);

/// A model's residual, and what weighs it with sizes of the unmodelled residual found for it.
struct Weighed {
    z: Residual,
    whitening: Whitening,
    /// With the priors in it.
    log_likelihood: f64,
}

/// Where one iteration has taken the free numbers.
enum Moved {
    /// What the model is there.
    Further(Weighed),
    Settled,
    /// The normal equations have no solution, and nothing that could be held is to blame.
    NotExcited,
    /// Free numbers that do nothing to these data.
    Unseen(Vec<Free>),
}

impl Problem<'_> {
    /// Slopes of the residual by the free numbers of a model whose residual is `at`.
    fn columns(&self, h: &TrackModel, free: &[Free], at: &Residual) -> Vec<Residual> {
        let moved: Vec<(Plant, f64)> = free
            .iter()
            .map(|f| {
                let (moved, step) = h.moved(*f);
                (moved.plant(self.base), step)
            })
            .collect();
        let slope = |(plant, step): &(Plant, f64)| {
            let scale = 1.0 / step;
            self.evidence.residual(plant).iter().zip(at).map(|(x, y)| (x - y) * scale).collect()
        };
        moved.par_iter().map(slope).collect()
    }

    /// Fits everything together from the model's values; `shapes` says whether shapes move too. Strengths stay within their plausible range;
    /// those held at an end of it, and those that the data cannot tell from the rest, which are at null, are not among the free numbers of the fit.
    #[must_use]
    pub fn fit(&self, start: &TrackModel, shapes: bool) -> TrackFit {
        let mut start = start.clone();
        let mut pinned = Vec::new();
        loop {
            match self.fit_with(&start, shapes, &pinned) {
                Ok(fit) => return fit,
                Err(Undetermined(f)) => {
                    if let Free::Effect(e, i) = f
                        && start.effects[e].parameters[i].role == Role::Strength
                    {
                        start.effects[e].values[i] = start.effects[e].parameters[i].null;
                    }
                    pinned.push(f);
                }
            }
        }
    }

    /// One fit with some numbers left as they are.
    fn fit_with(&self, start: &TrackModel, shapes: bool, pinned: &[Free]) -> Result<TrackFit, Undetermined> {
        let mut h = start.clone();
        let mut free = h.free(self.declared, shapes);
        for f in free.clone() {
            let [low, high] = h.range(f);
            h.set(f, h.get(f).clamp(low, high));
        }
        free.retain(|f| !pinned.contains(f));
        let mut fit = TrackFit {
            hypothesis: h.clone(),
            free: free.clone(),
            covariance: DMatrix::zeros(free.len(), free.len()),
            log_likelihood: f64::NEG_INFINITY,
            residual: Vec::new(),
            stop: StopReason::Iterations,
        };
        let Some(mut at) = self.weighed(&mut h) else {
            fit.stop = StopReason::NotFinite;
            return Ok(fit);
        };
        let begun = (h.clone(), at.log_likelihood);
        for _ in 0..ITERATIONS {
            match self.iterate(&mut h, &free, &at, &mut fit)? {
                Moved::Further(there) => at = there,
                Moved::Settled => {
                    fit.stop = StopReason::Converged;
                    break;
                }
                Moved::NotExcited => {
                    fit.stop = StopReason::NotExcited;
                    return Ok(fit);
                }
                Moved::Unseen(unseen) => return self.fit_with(start, shapes, &[pinned, &unseen].concat()),
            }
        }
        // Shrunk scatter is not the likeliest: steps that lower the squares may end below where they began.
        let mut end = self.weighed(&mut h);
        if end.as_ref().is_none_or(|e| e.log_likelihood < begun.1) {
            h = begun.0;
            end = self.weighed(&mut h);
        }
        let Some(end) = end else { return Ok(fit) };
        (fit.hypothesis, fit.residual, fit.log_likelihood) = (h, end.z, end.log_likelihood);
        Ok(fit)
    }

    /// A model weighed, its sizes found; `None` where it cannot be flown.
    fn weighed(&self, h: &mut TrackModel) -> Option<Weighed> {
        let z = self.evidence.residual(&h.plant(self.base));
        if z.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let (l, sigma) = self.fit_sizes(h, &z);
        let whitening = Whitening::new(&sigma)?;
        Some(Weighed { z, whitening, log_likelihood: l + h.log_prior() })
    }

    /// One Gauss-Newton step of the free numbers within their ranges, halved until the likelihood rises: the best numbers of runs that differ
    /// much may lie where a straight line from here leads out of what can be flown. Free numbers of `fit` and their covariance are those of the step.
    fn iterate(&self, h: &mut TrackModel, free: &[Free], at: &Weighed, fit: &mut TrackFit) -> Result<Moved, Undetermined> {
        let columns = self.columns(h, free, &at.z);
        let dead = |f: &Free, a: &Residual| matches!(f, Free::Effect(..)) && a.iter().all(|x| *x == 0.0);
        let unseen: Vec<Free> = free.iter().zip(&columns).filter(|(f, a)| dead(f, a)).map(|(f, _)| *f).collect();
        if !unseen.is_empty() {
            return Ok(Moved::Unseen(unseen));
        }
        let white: Vec<Residual> = columns.iter().map(|a| at.whitening.whiten(a)).collect();
        let mut normal = NormalEquations::new(&at.whitening.whiten(&at.z), &white);
        normal.add_prior(h, free);
        let bounds: Vec<[f64; 2]> = free.iter().map(|f| h.range(*f).map(|x| x - h.get(*f))).collect();
        let step = match normal.solve_within(&bounds, |i| matches!(free[i], Free::Effect(..))) {
            Ok(step) => step,
            Err(Some(i)) => return Err(Undetermined(free[i])),
            Err(None) => return Ok(Moved::NotExcited),
        };
        let open: Vec<usize> = (0..free.len()).filter(|i| !step.held.contains(i)).collect();
        fit.free = open.iter().map(|&i| free[i]).collect();
        fit.covariance = &step.covariance * self.evidence.inflation();
        let squares = |h: &TrackModel, z: &[f64]| at.whitening.whiten(z).iter().map(|x| x * x).sum::<f64>() - 2.0 * h.log_prior();
        let before = squares(h, &at.z);
        for halving in 0..=HALVINGS {
            let mut there = h.clone();
            let moved = apply(&mut there, free, &(&step.delta * 0.5_f64.powi(halving as i32)));
            let size = |(k, i): (usize, &usize)| moved[*i].abs() / step.covariance[(k, k)].max(f64::MIN_POSITIVE).sqrt();
            let held_moves = step.held.iter().any(|i| moved[*i] != 0.0);
            let small = !held_moves && open.iter().enumerate().map(size).fold(0.0, f64::max) < 0.01;
            if small && halving > 0 {
                break;
            }
            let Some(new) = self.weighed(&mut there) else { continue };
            // Squares by the same weights that fall raise the likelihood, where sizes are the likeliest.
            if squares(&there, &new.z) < before || new.log_likelihood > at.log_likelihood || small {
                *h = there;
                return Ok(if small { Moved::Settled } else { Moved::Further(new) });
            }
        }
        Ok(Moved::Settled)
    }

    /// Fits sizes of the unmodelled residual to `z`; returns log-likelihood and covariance.
    fn fit_sizes(&self, h: &mut TrackModel, z: &[f64]) -> (f64, Vec<Cov>) {
        if let Some(numbers) = self.evidence.slow_numbers() {
            let between = Between::of(z, numbers);
            let sigma = between.with_noise(self.evidence.noise());
            h.scatter = Some(Box::new(between));
            return (Whitening::new(&sigma).map_or(f64::NEG_INFINITY, |w| w.log_likelihood(z)), sigma);
        }
        let parts = self.parts();
        let start: Vec<f64> = h.generic.iter().map(|v| v.max(GENERIC_START)).collect();
        let (sizes, l) = components(self.evidence.noise(), &parts, z, &start, Effort::FULL);
        let sigma = total(self.evidence.noise(), &parts, &sizes);
        h.generic = sizes;
        (l, sigma)
    }

    fn parts(&self) -> Vec<&[Cov]> {
        self.evidence.generic().iter().map(Vec::as_slice).collect()
    }

    /// Log predictive density of this evidence: its likelihood averaged over what a fit to other runs leaves of its free numbers. Sizes of the
    /// unmodelled residual are as fitted.
    #[must_use]
    pub fn predictive(&self, fit: &TrackFit) -> f64 {
        self.top_near(fit).map_or(f64::NEG_INFINITY, |top| top.log_mean)
    }

    /// Residual of this evidence where the free numbers of a fit to other runs move within what it leaves of them, and the probability that
    /// they are asked to move as far. `None` where the fit's model cannot be flown.
    pub(crate) fn of_others(&self, fit: &TrackFit) -> Option<(Residual, f64)> {
        let top = self.top_near(fit)?;
        let mut h = fit.hypothesis.clone();
        fit.free.iter().zip(top.off.iter()).for_each(|(f, by)| h.set(*f, h.get(*f) + by));
        let z = self.evidence.residual(&h.plant(self.base));
        z.iter().all(|x| x.is_finite()).then_some((z, top.p_value))
    }

    fn top_near(&self, fit: &TrackFit) -> Option<Top> {
        let at = |off: &DVector<f64>| {
            let mut h = fit.hypothesis.clone();
            fit.free.iter().zip(off.iter()).for_each(|(f, by)| h.set(*f, h.get(*f) + by));
            let z = self.evidence.residual(&h.plant(self.base));
            if z.iter().any(|x| !x.is_finite()) {
                return None;
            }
            let columns = self.columns(&h, &fit.free, &z);
            if let (Some(between), Some(numbers)) = (&h.scatter, self.evidence.slow_numbers()) {
                let of_others = between.of_others(self.evidence.noise(), &z, &columns, numbers)?;
                return Some(NearFit { off: off.clone(), ..of_others });
            }
            let whitening = Whitening::new(&total(self.evidence.noise(), &self.parts(), &h.generic))?;
            let white: Vec<Residual> = columns.iter().map(|a| whitening.whiten(a)).collect();
            let (score, information) = NormalEquations::new(&whitening.whiten(&z), &white).parts();
            Some(NearFit { off: off.clone(), log_likelihood: whitening.log_likelihood(&z), slopes: -score, information })
        };
        top(&fit.covariance, at)
    }
}

/// Moves the free numbers by delta, strengths and shapes within their plausible range; returns what was moved.
fn apply(h: &mut TrackModel, free: &[Free], delta: &DVector<f64>) -> Vec<f64> {
    free.iter()
        .zip(delta.iter())
        .map(|(f, d)| {
            let old = h.get(*f);
            let mut new = old + d;
            if let Free::Effect(e, i) = *f {
                let p = &h.effects[e].parameters[i];
                if matches!(p.role, Role::Shape(_)) {
                    let trust = 0.4 * old.abs();
                    new = new.clamp(old - trust, old + trust).clamp(p.low, p.high);
                }
            }
            // Rounding of sums.
            let [low, high] = h.range(*f);
            new = new.clamp(low, high);
            h.set(*f, new);
            new - old
        })
        .collect()
}

#[cfg(test)]
mod tests;
