//! verify: joint fit of a hypothesis. In: evidence and starting values. Out: estimates, covariance, likelihood.
//!
//! Mean parameters by Gauss-Newton on the whitened residual with the score corrected for noise in the regressors (Fuller 1987,
//! ch. 3; the correction is measured on copies of the data with noise added again); sizes of random inputs and of the
//! unmodelled residual by maximum likelihood; shapes of random inputs by line search.

use super::evidence::{Cov, Evidence, Residual};
use super::hypothesis::{Free, Hypothesis};
use super::likelihood::{Effort, Whitening};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use windfall_model::Plant;

mod errors;
mod normal;
mod sizes;

pub(crate) use normal::{Normal, Whitened};

/// What stays the same over all hypotheses.
pub struct Problem<'a> {
    /// Residuals.
    pub evidence: &'a dyn Evidence,
    /// Declared plant.
    pub base: &'a Plant,
    /// Which parameters of its structure are declared.
    pub declared: &'a [bool],
    /// Names of run inputs.
    pub inputs: &'a [String],
}

/// Why a fit stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// Steps fell below a hundredth of a standard error.
    Converged,
    /// Iterations used up.
    IterationLimit,
    /// The normal equations have no solution: a parameter is not excited beyond noise.
    NotExcited,
    /// A residual was not a number.
    NotFinite,
}

impl StopReason {
    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "the iterations did not settle",
            Self::NotExcited => "a declared parameter is not excited beyond noise in these runs",
            Self::NotFinite => "a state or residual is not a number under the declared model",
        }
    }
}

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Values.
    pub hypothesis: Hypothesis,
    /// The free numbers of the mean, in order.
    pub free: Vec<Free>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Inverse of their information: what the score is multiplied by in a step.
    pub inverse: DMatrix<f64>,
    /// Log-likelihood, up to a constant of the evidence.
    pub log_likelihood: f64,
    /// Residual of the data.
    pub residual: Residual,
    /// Covariance per bin at the fit.
    pub sigma: Vec<Cov>,
    /// Standard errors of numbers that are not in the mean: sizes and shapes of random inputs.
    pub random_errors: Vec<(Free, f64)>,
    /// Why it stopped.
    pub stop: StopReason,
}

impl Fit {
    /// True for a random strength that is not at zero.
    fn is_sized(&self, f: Free) -> bool {
        let there = matches!(f, Free::Effect(k, _) if k < self.hypothesis.effects.len());
        there && self.hypothesis.get(f) > 0.0
    }
    /// Standard error of any number of the hypothesis; infinite when the data do not give one.
    #[must_use]
    pub fn error_of(&self, f: Free) -> f64 {
        self.random_errors.iter().find(|(g, _)| *g == f).map_or_else(|| self.std_error(f), |(_, s)| *s)
    }
    /// Standard error of a free number of the mean; infinite when it was not free.
    #[must_use]
    pub fn std_error(&self, f: Free) -> f64 {
        self.free.iter().position(|g| *g == f).map_or(f64::INFINITY, |i| self.covariance[(i, i)].max(0.0).sqrt())
    }
}

/// A number that the data do not determine beside the others.
struct Undetermined(Free);

/// Residuals at a point: of the data, and what each noisy copy adds.
pub(crate) struct Point {
    pub(crate) z: Residual,
    pub(crate) dz: Vec<Residual>,
}

/// Columns of a linearisation: of the data and of what each copy adds.
pub(crate) struct Columns {
    pub(crate) a: Vec<Residual>,
    pub(crate) da: Vec<Vec<Residual>>,
    /// What the closed loop gives each score at the truth.
    pub(crate) looped: Vec<f64>,
}

fn minus(a: &[f64], b: &[f64], scale: f64) -> Residual {
    a.iter().zip(b).map(|(x, y)| (x - y) * scale).collect()
}

/// What noise alone adds to the sum of squared whitened residuals under a plant, from the copies. A plant that lets more noise
/// through (an arm that carries a noisy force into the moment) leaves a larger residual for that reason alone, which the
/// likelihood with one measured noise would hold against it, as the score would without its correction.
fn noise_energy(at: &Point, sigma: &[Cov]) -> f64 {
    let Some(w) = Whitening::new(sigma) else { return 0.0 };
    let square = |d: &Residual| w.whiten(d).iter().map(|x| x * x).sum::<f64>();
    at.dz.iter().map(square).sum::<f64>() / at.dz.len().max(1) as f64
}

impl Problem<'_> {
    pub(crate) fn point(&self, plant: &Plant) -> Point {
        self.points(plant, self.evidence.copies())
    }

    fn points(&self, plant: &Plant, copies: usize) -> Point {
        if copies == 0 {
            return Point { z: self.evidence.residual(plant, 0), dz: Vec::new() };
        }
        let (clean, mut all) = rayon::join(
            || self.evidence.clean(plant),
            || (0..=copies).into_par_iter().map(|c| self.evidence.residual(plant, c)).collect::<Vec<_>>(),
        );
        let z = all.remove(0);
        let dz = all.iter().map(|c| minus(c, &clean, 1.0)).collect();
        Point { z, dz }
    }

    /// Linearisation in `free` around a hypothesis whose residuals are `at`, for covariance `sigma`.
    pub(crate) fn columns(&self, h: &Hypothesis, free: &[Free], at: &Point, sigma: &[Cov]) -> Columns {
        let moved: Vec<(Plant, f64)> = free
            .iter()
            .map(|f| {
                let step = h.step(*f);
                let mut moved = h.clone();
                moved.set(*f, h.get(*f) + step);
                (moved.plant(self.base), step)
            })
            .collect();
        let all: Vec<Point> = moved
            .par_iter()
            .map(|(plant, step)| {
                let p = self.point(plant);
                Point {
                    z: minus(&p.z, &at.z, 1.0 / step),
                    dz: p.dz.iter().zip(&at.dz).map(|(q, r)| minus(q, r, 1.0 / step)).collect(),
                }
            })
            .collect();
        let looped = self.evidence.closed_loop(sigma, &h.plant(self.base), &moved);
        let mut columns = Columns { a: Vec::new(), da: vec![Vec::new(); self.evidence.copies()], looped };
        for p in all {
            columns.a.push(p.z);
            for (c, d) in p.dz.into_iter().enumerate() {
                columns.da[c].push(d);
            }
        }
        columns
    }

    /// Gain of log-likelihood of one fit over another, with the determinant of the map from motion to residual and less what
    /// noise does differently under the two.
    #[must_use]
    pub fn gain(&self, over: &Fit, fit: &Fit) -> f64 {
        let (p0, p1) = (over.hypothesis.plant(self.base), fit.hypothesis.plant(self.base));
        let way = |sigma: &[Cov], from: &Plant, to: &Plant| -> f64 {
            self.evidence.closed_loop(sigma, from, &[(to.clone(), 1.0)]).iter().sum()
        };
        let there = way(&fit.sigma, &p0, &p1);
        let back = way(&fit.sigma, &p1, &p0);
        let energy = |p: &Plant| if self.evidence.copies() == 0 { 0.0 } else { noise_energy(&self.point(p), &fit.sigma) };
        let noise = energy(&p1) - energy(&p0);
        fit.log_likelihood - over.log_likelihood + 0.5 * (there - back + noise)
    }

    /// Fits everything together from the hypothesis' values; `shapes` says whether shapes move too. Strengths that would leave
    /// their plausible range are held at its edge, those that the data cannot tell from the rest at null.
    #[must_use]
    pub fn fit(&self, start: &Hypothesis, shapes: bool) -> Fit {
        let mut start = start.clone();
        let mut pinned = Vec::new();
        loop {
            let fit = match self.fit_with(&start, shapes, &pinned) {
                Ok(fit) => fit,
                Err(Undetermined(f)) => {
                    if let Free::Effect(e, i) = f
                        && start.effects[e].parameters[i].role == windfall_model::Role::Strength
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
                Some(worst) => pinned.push(*worst),
                None => return fit,
            }
        }
    }

    /// One fit with some strengths held at the edge of their range.
    fn fit_with(&self, start: &Hypothesis, shapes: bool, pinned: &[Free]) -> Result<Fit, Undetermined> {
        let mut h = start.clone();
        for f in pinned {
            if let Free::Effect(e, i) = *f {
                let p = &h.effects[e].parameters[i];
                let edge = h.effects[e].values[i].clamp(p.low, p.high);
                h.set(*f, edge);
            }
        }
        let mut free = h.free(self.declared, shapes);
        free.retain(|f| !pinned.contains(f));
        let mut fit = Fit {
            hypothesis: h.clone(),
            free: free.clone(),
            covariance: DMatrix::zeros(free.len(), free.len()),
            inverse: DMatrix::zeros(free.len(), free.len()),
            log_likelihood: f64::NEG_INFINITY,
            residual: Vec::new(),
            sigma: Vec::new(),
            random_errors: Vec::new(),
            stop: StopReason::IterationLimit,
        };
        for iteration in 0..ITERATIONS {
            self.evidence.focus(&h.plant(self.base));
            let at = self.point(&h.plant(self.base));
            if at.z.iter().any(|x| !x.is_finite()) {
                fit.stop = StopReason::NotFinite;
                return Ok(fit);
            }
            if shapes && iteration < 2 {
                self.refine_random_shapes(&mut h, &at.z, if iteration == 0 { 0.6 } else { 0.15 });
            }
            let (_, sigma) = self.fit_sizes(&mut h, &at.z, Effort::FULL);
            let columns = self.columns(&h, &free, &at, &sigma);
            let dead = |f: &Free, a: &Residual| matches!(f, Free::Effect(..)) && a.iter().all(|x| *x == 0.0);
            let unseen: Vec<Free> = free.iter().zip(&columns.a).filter(|(f, a)| dead(f, a)).map(|(f, _)| *f).collect();
            if !unseen.is_empty() {
                return self.fit_with(start, shapes, &[pinned, &unseen].concat());
            }
            let mut normal = Whitening::new(&sigma).map(|w| Normal::new(&at.whitened(&w), &Whitened::new(&w, &columns)));
            if let Some(n) = normal.as_mut() {
                n.add_prior(&h, &free);
            }
            let Some(step) = normal.as_ref().and_then(Normal::solve) else {
                let may = |i: usize| matches!(free[i], Free::Effect(..));
                if let Some(i) = normal.and_then(|n| n.undetermined(may)) {
                    return Err(Undetermined(free[i]));
                }
                fit.stop = StopReason::NotExcited;
                return Ok(fit);
            };
            fit.covariance.clone_from(&step.covariance);
            fit.inverse.clone_from(&step.inverse);
            let moved = apply(&mut h, &free, &step.delta);
            let worst = (0..free.len())
                .map(|i| moved[i].abs() / step.covariance[(i, i)].max(f64::MIN_POSITIVE).sqrt())
                .fold(0.0, f64::max);
            if worst < 0.01 {
                fit.stop = StopReason::Converged;
                break;
            }
        }
        fit.residual = self.evidence.residual(&h.plant(self.base), 0);
        let (l, sigma) = self.fit_sizes(&mut h, &fit.residual, Effort::FULL);
        fit.log_likelihood = if l.is_finite() { l + h.log_prior() } else { f64::NEG_INFINITY };
        fit.sigma = sigma;
        fit.random_errors = self.random_errors(&h, &fit.residual);
        fit.hypothesis = h;
        Ok(fit)
    }

    /// Log-likelihood of a residual with all sizes as they are.
    fn likelihood(&self, h: &Hypothesis, z: &[f64]) -> f64 {
        if !z.iter().all(|x| x.is_finite()) {
            return f64::NEG_INFINITY;
        }
        let (_, sigma) = self.sigma(h);
        Whitening::new(&sigma).map_or(f64::NEG_INFINITY, |w| w.log_likelihood(z))
    }

    /// Log-likelihood of this evidence with every number as it stands.
    #[must_use]
    pub fn predict(&self, h: &Hypothesis) -> f64 {
        self.likelihood(h, &self.evidence.residual(&h.plant(self.base), 0))
    }
}

/// Iterations of the joint fit.
const ITERATIONS: usize = 8;

/// Moves the free numbers by −delta within their plausible range; returns what was moved.
fn apply(h: &mut Hypothesis, free: &[Free], delta: &DVector<f64>) -> Vec<f64> {
    free.iter()
        .zip(delta.iter())
        .map(|(f, d)| {
            let old = h.get(*f);
            let mut new = old + d;
            if let Free::Effect(e, i) = *f {
                let p = &h.effects[e].parameters[i];
                if matches!(p.role, windfall_model::Role::Shape(_)) {
                    let trust = 0.4 * old.abs();
                    new = new.clamp(old - trust, old + trust).clamp(p.low, p.high);
                }
            }
            h.set(*f, new);
            new - old
        })
        .collect()
}
