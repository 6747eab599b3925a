//! discover: joint fit of a model to tracks. In: evidence and starting values. Out: estimates, covariance, likelihood.
//!
//! Parameters by Gauss-Newton on the whitened residual; sizes of the unmodelled residual by maximum likelihood.

use super::bins::{Cov, Residual};
use super::evidence::TrackEvidence;
use super::likelihood::{Effort, Whitening, components, total};
use super::model::{Free, TrackModel};
use super::normal::NormalEquations;
use super::scatter;
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

/// Where one iteration has taken the free numbers.
enum Moved {
    /// The residual there.
    Further(Residual),
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

    /// Fits everything together from the model's values; `shapes` says whether shapes move too, for which sizes are first found roughly.
    /// Strengths that would leave their plausible range are held at its edge, those that the data cannot tell from the rest at null.
    #[must_use]
    pub fn fit(&self, start: &TrackModel, shapes: bool) -> TrackFit {
        let mut start = start.clone();
        let mut pinned = Vec::new();
        loop {
            let fit = match self.fit_with(&start, shapes, &pinned) {
                Ok(fit) => fit,
                Err(Undetermined(f)) => {
                    if let Free::Effect(e, i) = f
                        && start.effects[e].parameters[i].role == Role::Strength
                    {
                        start.effects[e].values[i] = start.effects[e].parameters[i].null;
                    }
                    pinned.push(f);
                    continue;
                }
            };
            let h = &fit.hypothesis;
            let out = |f: &Free| match *f {
                Free::Effect(e, i) => h.effects[e].parameters[i].beyond(h.effects[e].values[i]),
                Free::Declared(_) | Free::Constant(_) => 0.0,
            };
            match fit.free.iter().filter(|f| out(f) > 1e-9).max_by(|a, b| out(a).total_cmp(&out(b))) {
                Some(worst) => {
                    // At the edge that the fit went beyond, wherever it started.
                    if let Free::Effect(e, i) = *worst {
                        start.effects[e].values[i] = h.effects[e].values[i];
                    }
                    pinned.push(*worst);
                }
                None => return fit,
            }
        }
    }

    /// One fit with some strengths held at the edge of their range.
    fn fit_with(&self, start: &TrackModel, shapes: bool, pinned: &[Free]) -> Result<TrackFit, Undetermined> {
        let mut h = held(start, pinned);
        let mut free = h.free(self.declared, shapes);
        free.retain(|f| !pinned.contains(f));
        let mut fit = TrackFit {
            hypothesis: h.clone(),
            free: free.clone(),
            covariance: DMatrix::zeros(free.len(), free.len()),
            log_likelihood: f64::NEG_INFINITY,
            residual: Vec::new(),
            stop: StopReason::Iterations,
        };
        let mut z = self.evidence.residual(&h.plant(self.base));
        if z.iter().any(|x| !x.is_finite()) {
            fit.stop = StopReason::NotFinite;
            return Ok(fit);
        }
        for iteration in 0..ITERATIONS {
            if shapes && iteration < 2 {
                self.fit_sizes(&mut h, &z, Effort::QUICK);
            }
            match self.iterate(&mut h, &free, &z, &mut fit.covariance)? {
                Moved::Further(there) => z = there,
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
        fit.residual = self.evidence.residual(&h.plant(self.base));
        let (l, _) = self.fit_sizes(&mut h, &fit.residual, Effort::FULL);
        fit.log_likelihood = if l.is_finite() { l + h.log_prior() } else { f64::NEG_INFINITY };
        fit.hypothesis = h;
        Ok(fit)
    }

    /// One Gauss-Newton step of the free numbers from a model whose residual is `z`, halved until the weighed squares fall: the best numbers of
    /// runs that differ much may lie where a straight line from here leads out of what can be flown.
    fn iterate(
        &self,
        h: &mut TrackModel,
        free: &[Free],
        z: &Residual,
        covariance: &mut DMatrix<f64>,
    ) -> Result<Moved, Undetermined> {
        let (_, sigma) = self.fit_sizes(h, z, Effort::FULL);
        let columns = self.columns(h, free, z);
        let dead = |f: &Free, a: &Residual| matches!(f, Free::Effect(..)) && a.iter().all(|x| *x == 0.0);
        let unseen: Vec<Free> = free.iter().zip(&columns).filter(|(f, a)| dead(f, a)).map(|(f, _)| *f).collect();
        if !unseen.is_empty() {
            return Ok(Moved::Unseen(unseen));
        }
        let whitening = Whitening::new(&sigma);
        let mut normal = whitening.as_ref().map(|w| {
            let white: Vec<Residual> = columns.iter().map(|a| w.whiten(a)).collect();
            NormalEquations::new(&w.whiten(z), &white)
        });
        if let Some(n) = normal.as_mut() {
            n.add_prior(h, free);
        }
        let Some(step) = normal.as_ref().and_then(NormalEquations::solve) else {
            let may = |i: usize| matches!(free[i], Free::Effect(..));
            return match normal.and_then(|n| n.undetermined(may)) {
                Some(i) => Err(Undetermined(free[i])),
                None => Ok(Moved::NotExcited),
            };
        };
        covariance.clone_from(&(&step.covariance * self.evidence.inflation()));
        let squares = |h: &TrackModel, z: &[f64]| {
            let of_data = whitening.as_ref().map_or(f64::NAN, |w| w.whiten(z).iter().map(|x| x * x).sum::<f64>());
            of_data - 2.0 * h.log_prior()
        };
        let before = squares(&*h, z);
        for halving in 0..=HALVINGS {
            let mut there = h.clone();
            let moved = apply(&mut there, free, &(&step.delta * 0.5_f64.powi(halving as i32)));
            let size = |i: usize| moved[i].abs() / step.covariance[(i, i)].max(f64::MIN_POSITIVE).sqrt();
            let settled = (0..free.len()).map(size).fold(0.0, f64::max) < 0.01;
            let at = self.evidence.residual(&there.plant(self.base));
            // NaN of a flight that fails is no fall.
            let falls = squares(&there, &at) < before;
            if falls || (settled && at.iter().all(|x| x.is_finite())) {
                *h = there;
                return Ok(if settled { Moved::Settled } else { Moved::Further(at) });
            }
        }
        Ok(Moved::Settled)
    }

    /// Fits sizes of the unmodelled residual to `z`; returns log-likelihood and covariance.
    fn fit_sizes(&self, h: &mut TrackModel, z: &[f64], effort: Effort) -> (f64, Vec<Cov>) {
        if self.evidence.slow_numbers().is_some() {
            let between = scatter::between_runs(z);
            let sigma = scatter::with_noise(self.evidence.noise(), &between);
            h.scatter = Some(Box::new(between));
            return (Whitening::new(&sigma).map_or(f64::NEG_INFINITY, |w| w.log_likelihood(z)), sigma);
        }
        let parts = self.parts();
        let start: Vec<f64> = h.generic.iter().map(|v| v.max(GENERIC_START)).collect();
        let (sizes, l) = components(self.evidence.noise(), &parts, z, &start, effort);
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
            let whitening = z.iter().all(|x| x.is_finite()).then(|| self.whitening(&h)).flatten()?;
            let white: Vec<Residual> = self.columns(&h, &fit.free, &z).iter().map(|a| whitening.whiten(a)).collect();
            let (score, information) = NormalEquations::new(&whitening.whiten(&z), &white).parts();
            Some(NearFit { off: off.clone(), log_likelihood: whitening.log_likelihood(&z), slopes: -score, information })
        };
        top(&fit.covariance, at)
    }

    /// What whitens this evidence with every size as it stands.
    fn whitening(&self, h: &TrackModel) -> Option<Whitening> {
        let sigma = match &h.scatter {
            Some(between) => scatter::with_noise(self.evidence.noise(), between),
            None => total(self.evidence.noise(), &self.parts(), &h.generic),
        };
        Whitening::new(&sigma)
    }
}

/// A model with some strengths put to the edge of their range.
fn held(start: &TrackModel, pinned: &[Free]) -> TrackModel {
    let mut h = start.clone();
    for f in pinned {
        if let Free::Effect(e, i) = *f {
            let p = &h.effects[e].parameters[i];
            let edge = h.effects[e].values[i].clamp(p.low, p.high);
            h.set(*f, edge);
        }
    }
    h
}

/// Moves the free numbers by delta, shapes within their plausible range; returns what was moved.
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
            h.set(*f, new);
            new - old
        })
        .collect()
}

#[cfg(test)]
mod tests;
