//! verify: joint fit of a hypothesis. In: evidence and starting values. Out: estimates, covariance, likelihood.
//!
//! Mean parameters by Gauss-Newton on the whitened residual with the score corrected for noise in the regressors (Fuller 1987,
//! ch. 3; the correction is measured on copies of the data with noise added again); sizes of random inputs and of the
//! unmodelled residual by maximum likelihood; shapes of random inputs by line search.

use super::evidence::{BIN, Cov, Evidence, Residual};
use super::hypothesis::{Free, Hypothesis, Instance};
use super::likelihood::{Effort, NEGLIGIBLE, Whitening, components, one_step, total};
use nalgebra::{DMatrix, DVector, SVector};
use rayon::prelude::*;
use windfall_model::Plant;

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

impl Point {
    pub(crate) fn whitened(&self, w: &Whitening) -> Whitened {
        Whitened { a: vec![w.whiten(&self.z)], da: self.dz.iter().map(|d| vec![w.whiten(d)]).collect(), looped: vec![0.0] }
    }
}

/// Columns of a linearisation: of the data and of what each copy adds.
pub(crate) struct Columns {
    pub(crate) a: Vec<Residual>,
    pub(crate) da: Vec<Vec<Residual>>,
    /// What the closed loop gives each score at the truth.
    pub(crate) looped: Vec<f64>,
}

/// Every bin of `z` times its covariance.
fn times(all: &[Cov], z: &[f64]) -> Residual {
    all.iter().zip(z.chunks_exact(BIN)).flat_map(|(m, z)| (m * SVector::<f64, BIN>::from_column_slice(z)).data.0[0]).collect()
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

    /// Gain of log-likelihood of this evidence, every number as it stands, of one hypothesis over another.
    #[must_use]
    pub fn predicted_gain(&self, over: &Hypothesis, h: &Hypothesis) -> f64 {
        let (_, sigma) = self.sigma(h);
        let [(new, noise), (old, noise_before)] = [h, over].map(|h| {
            let at = self.point(&h.plant(self.base));
            (self.likelihood(h, &at.z), noise_energy(&at, &sigma))
        });
        new - old + 0.5 * (noise - noise_before)
    }

    /// Covariance parts of the random inputs of a hypothesis, in order of effect and strength.
    fn random_parts(&self, h: &Hypothesis) -> Vec<(Free, Vec<Cov>)> {
        let mut parts = Vec::new();
        for (k, e) in h.effects.iter().enumerate() {
            for i in e.random_strengths() {
                let mut one = e.clone();
                for j in e.random_strengths() {
                    one.values[j] = if i == j { 1.0 } else { 0.0 };
                }
                let mut plant = self.base.clone();
                plant.aero.values.clone_from(&h.declared);
                (e.effect.apply)(&mut plant, &one.values);
                parts.push((Free::Effect(k, i), self.evidence.random(&plant)));
            }
        }
        parts
    }

    /// Fits sizes of random inputs and of the unmodelled residual to `z`; returns log-likelihood and covariance.
    pub(crate) fn fit_sizes(&self, h: &mut Hypothesis, z: &[f64], effort: Effort) -> (f64, Vec<Cov>) {
        let random = self.random_parts(h);
        let generic = self.evidence.generic();
        let parts: Vec<&[Cov]> = random.iter().map(|(_, m)| m.as_slice()).chain(generic.iter().map(Vec::as_slice)).collect();
        let start: Vec<f64> = random
            .iter()
            .map(|(f, _)| h.get(*f).powi(2).max(1e-8))
            .chain(h.generic.iter().map(|v| v.max(GENERIC_START)))
            .collect();
        let from = |start: &[f64]| {
            components(self.evidence.noise(), &parts, random.len() + self.evidence.known_causes(), z, start, effort)
        };
        let (mut sizes, mut l) = from(&start);
        if let Some(other) = self.instead(&parts, random.len(), &h.generic) {
            let (s, better) = from(&other);
            if better > l {
                (sizes, l) = (s, better);
            }
        }
        for ((f, _), v) in random.iter().zip(&sizes) {
            h.set(*f, v.sqrt());
        }
        h.generic = sizes[random.len()..].to_vec();
        (l, total(self.evidence.noise(), &parts, &sizes))
    }

    /// Sizes with which the random inputs leave as much as the unmodelled residual does now, and that next to nothing: two causes
    /// of one residual give the likelihood two maxima. `None` when nothing is unmodelled or nothing random.
    fn instead(&self, parts: &[&[Cov]], physical: usize, unmodelled: &[f64]) -> Option<Vec<f64>> {
        if physical == 0 || unmodelled.iter().all(|v| *v < NEGLIGIBLE) {
            return None;
        }
        let energy = |part: &[Cov]| -> f64 {
            let one = |(m, n): (&Cov, &Cov)| m.diagonal().component_div(&n.diagonal()).sum();
            part.iter().zip(self.evidence.noise()).map(one).sum()
        };
        let all: f64 = parts[physical..].iter().zip(unmodelled).map(|(p, v)| v * energy(p)).sum();
        let own = parts[..physical].iter().map(|p| all / (physical as f64 * energy(p)).max(f64::MIN_POSITIVE));
        Some(own.chain(unmodelled.iter().map(|v| (1e-2 * v).max(NEGLIGIBLE))).collect())
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
                Free::Declared(_) => 0.0,
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
            let normal = Whitening::new(&sigma).map(|w| Normal::new(&at.whitened(&w), &Whitened::new(&w, &columns)));
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
        fit.log_likelihood = if l.is_finite() { l } else { f64::NEG_INFINITY };
        fit.sigma = sigma;
        fit.random_errors = self.random_errors(&h, &fit.residual);
        fit.hypothesis = h;
        Ok(fit)
    }

    /// Replaces the share of noise and of random inputs in each variance by what they do to the estimates in copies of this
    /// evidence (a parametric bootstrap of one step, Efron and Tibshirani 1993, ch. 6). The likelihood takes frequencies for
    /// independent; noise or gusts whose effect differs along a run make them depend, and numbers that are known from a moment of
    /// it (a release) scatter more.
    pub fn calibrate(&self, fit: &mut Fit) {
        let copies = self.evidence.noisy();
        let Some(w) = Whitening::new(&fit.sigma).filter(|_| copies > 0 && !fit.free.is_empty()) else { return };
        self.evidence.focus(&fit.hypothesis.plant(self.base));
        self.with_held(fit, &w);
        let n = fit.free.len();
        let h = &fit.hypothesis;
        let plant = h.plant(self.base);
        let at = self.points(&plant, copies);
        let weights: Vec<Residual> = fit
            .free
            .par_iter()
            .map(|f| {
                let step = h.step(*f);
                let mut moved = h.clone();
                moved.set(*f, h.get(*f) + step);
                w.solve(&minus(&self.evidence.residual(&moved.plant(self.base), 0), &at.z, 1.0 / step))
            })
            .collect();
        let explained = self.explained(h);
        let carried: Vec<Residual> = weights.iter().map(|x| times(&explained, x)).collect();
        let noise = DMatrix::from_fn(n, n, |i, k| dot(&weights[i], &carried[k]));
        let formal = &fit.inverse * noise * fit.inverse.transpose();
        let mut seen = DVector::<f64>::zeros(n);
        for (dz, gusts) in at.dz.iter().zip(self.evidence.random_draws(&plant, copies)) {
            let score = DVector::from_fn(n, |i, _| dot(&weights[i], dz) + dot(&weights[i], &gusts));
            let moved = &fit.inverse * score;
            seen += moved.component_mul(&moved) / copies as f64;
        }
        let scale = DVector::from_fn(n, |i, _| {
            let c = fit.covariance[(i, i)];
            let ratio = (c + seen[i] - formal[(i, i)]) / c;
            if ratio.is_finite() { ratio.max(0.25).sqrt() } else { 1.0 }
        });
        fit.covariance = scaled_back(&fit.covariance, &scale);
    }

    /// Numbers of effects that the fit holds (strengths at the edge of their range, shapes that would not settle) are not known for
    /// that: the errors of all others count what is not known of these, of which the range is all that is known beforehand.
    fn with_held(&self, fit: &mut Fit, w: &Whitening) {
        let h = &fit.hypothesis;
        let mut free = fit.free.clone();
        for (k, e) in h.effects.iter().enumerate().filter(|(_, e)| e.mean_strengths().next().is_some() && !e.is_local()) {
            let own = e.mean_strengths().chain(e.shapes()).map(|i| Free::Effect(k, i));
            free.extend(own.filter(|f| !fit.free.contains(f)).collect::<Vec<_>>());
        }
        if free.len() == fit.free.len() {
            return;
        }
        let at = self.point(&h.plant(self.base));
        let mut columns = self.columns(h, &free, &at, &fit.sigma);
        // A whole number (of a harmonic) is known when it is held.
        let live: Vec<bool> = columns.a.iter().map(|a| a.iter().any(|x| *x != 0.0)).collect();
        free = kept(free, &live);
        columns = Columns {
            a: kept(columns.a, &live),
            da: columns.da.into_iter().map(|d| kept(d, &live)).collect(),
            looped: kept(columns.looped, &live),
        };
        let mut normal = Normal::new(&at.whitened(w), &Whitened::new(w, &columns));
        for (i, f) in free.iter().enumerate().skip(fit.free.len()) {
            let Free::Effect(e, k) = *f else { continue };
            let p = &h.effects[e].parameters[k];
            let prior = 12.0 / (p.high - p.low).powi(2);
            normal.j[(i, i)] += prior;
            normal.v[(i, i)] += prior;
        }
        if let Some(step) = normal.solve() {
            (fit.free, fit.covariance, fit.inverse) = (free, step.covariance, step.inverse);
        }
    }

    /// Standard errors of sizes and shapes of random inputs from the curvature of the likelihood in their logarithms, all
    /// together; a size at zero has none.
    fn random_errors(&self, h: &Hypothesis, z: &[f64]) -> Vec<(Free, f64)> {
        let mut free = Vec::new();
        for (k, e) in h.effects.iter().enumerate() {
            if e.random_strengths().next().is_some() {
                free.extend(e.random_strengths().chain(e.shapes()).map(|i| Free::Effect(k, i)));
            }
        }
        free.retain(|f| h.get(*f) > 0.0);
        let likelihood = |change: &[(usize, f64)]| -> f64 {
            let mut moved = h.clone();
            for (i, c) in change {
                moved.set(free[*i], moved.get(free[*i]) * c.exp());
            }
            self.likelihood(&moved, z)
        };
        let step = 0.05;
        let curvature = DMatrix::from_fn(free.len(), free.len(), |i, k| {
            let at = |a: f64, b: f64| likelihood(&[(i, a), (k, b)]);
            -(at(step, step) - at(step, -step) - at(-step, step) + at(-step, -step)) / (4.0 * step * step)
        });
        // A shape that the data do not determine is known from its range, with which size it trades.
        let known = |i: usize| match free[i] {
            Free::Effect(k, p) if h.effects[k].parameters[p].role != windfall_model::Role::Strength => {
                let p = &h.effects[k].parameters[p];
                12.0 / (p.high / p.low).ln().powi(2)
            }
            _ => 0.0,
        };
        let within = || &curvature + DMatrix::from_diagonal(&DVector::from_fn(free.len(), |i, _| known(i)));
        let Some(inverse) = curvature.clone().cholesky().or_else(|| within().cholesky()).map(|c| c.inverse()) else {
            return Vec::new();
        };
        free.iter().enumerate().map(|(i, f)| (*f, h.get(*f) * inverse[(i, i)].sqrt())).collect()
    }

    /// Log-likelihood of a residual with all sizes as they are.
    fn likelihood(&self, h: &Hypothesis, z: &[f64]) -> f64 {
        if !z.iter().all(|x| x.is_finite()) {
            return f64::NEG_INFINITY;
        }
        let (_, sigma) = self.sigma(h);
        Whitening::new(&sigma).map_or(f64::NEG_INFINITY, |w| w.log_likelihood(z))
    }

    /// Covariance per bin with all sizes as they are, and the parts of random inputs.
    fn sigma(&self, h: &Hypothesis) -> (Vec<(Free, Vec<Cov>)>, Vec<Cov>) {
        let random = self.random_parts(h);
        let generic = self.evidence.generic();
        let parts: Vec<&[Cov]> = random.iter().map(|(_, m)| m.as_slice()).chain(generic.iter().map(Vec::as_slice)).collect();
        let sizes: Vec<f64> = random.iter().map(|(f, _)| h.get(*f).powi(2)).chain(h.generic.iter().copied()).collect();
        let sigma = total(self.evidence.noise(), &parts, &sizes);
        (random, sigma)
    }

    /// Covariance per bin that noise and the random inputs of a hypothesis explain, without the unmodelled residual.
    #[must_use]
    pub fn explained(&self, h: &Hypothesis) -> Vec<Cov> {
        let mut known = h.clone();
        known.generic.fill(0.0);
        self.sigma(&known).1
    }

    /// Log-likelihood of this evidence with every number as it stands.
    #[must_use]
    pub fn predict(&self, h: &Hypothesis) -> f64 {
        self.likelihood(h, &self.evidence.residual(&h.plant(self.base), 0))
    }

    /// Size that a random strength of an effect stays under with 95 % confidence: its estimated variance (not below zero, so that
    /// a lull in the noise does not make the bound shorter) and 1.645 standard errors, those from the information at the bound
    /// itself, with the sizes of the fit and of the unmodelled residual, in which the effect may hide, free beside it.
    #[must_use]
    pub fn random_bound(&self, fit: &Fit, instance: &Instance, i: usize) -> f64 {
        let mut h = fit.hypothesis.clone();
        h.effects.push(instance.clone());
        let own = Free::Effect(h.effects.len() - 1, i);
        let (random, _) = self.sigma(&h);
        let generic = self.evidence.generic();
        let live = random.iter().filter(|(f, _)| *f != own && fit.is_sized(*f)).map(|(_, m)| m.as_slice());
        let Some((_, part)) = random.iter().find(|(f, _)| *f == own) else { return f64::INFINITY };
        let parts: Vec<&[Cov]> = std::iter::once(part.as_slice()).chain(live).chain(generic.iter().map(Vec::as_slice)).collect();
        let Some((estimate, mut error)) = one_step(&fit.sigma, &parts, &fit.residual) else { return f64::INFINITY };
        let mut upper = 0.0;
        for _ in 0..BOUND_ROUNDS {
            upper = estimate.max(0.0) + 1.645 * error;
            let Some((_, e)) = one_step(&total(&fit.sigma, &parts[..1], &[upper]), &parts, &fit.residual) else { break };
            error = e;
        }
        upper.sqrt().min(instance.parameters[i].high)
    }

    /// Line search of each shape of purely random effects, on the likelihood with sizes refitted, from steps of `width` in the
    /// logarithm down to a thirtieth of that.
    fn refine_random_shapes(&self, h: &mut Hypothesis, z: &[f64], width: f64) {
        self.fit_sizes(h, z, Effort::QUICK);
        for k in 0..h.effects.len() {
            if h.effects[k].mean_strengths().next().is_some() {
                continue;
            }
            for i in h.effects[k].shapes().collect::<Vec<_>>() {
                let p = h.effects[k].parameters[i].clone();
                let likelihood = |value: f64| {
                    let mut trial = h.clone();
                    trial.effects[k].values[i] = value;
                    self.fit_sizes(&mut trial, z, Effort::QUICK).0
                };
                let mut best = (likelihood(h.effects[k].values[i]), h.effects[k].values[i]);
                let mut step = width;
                while step > width / 30.0 {
                    let better = [-step, step]
                        .map(|s| (best.1 * s.exp()).clamp(p.low, p.high))
                        .into_par_iter()
                        .map(|v| (likelihood(v), v))
                        .max_by(|a, b| a.0.total_cmp(&b.0));
                    match better {
                        Some(b) if b.0 > best.0 => best = b,
                        _ => step *= 0.4,
                    }
                }
                h.effects[k].values[i] = best.1;
            }
        }
    }
}

/// Those marked.
fn kept<T>(all: Vec<T>, marked: &[bool]) -> Vec<T> {
    all.into_iter().zip(marked).filter(|(_, m)| **m).map(|(x, _)| x).collect()
}

/// Rounds of a bound's fixed point.
const BOUND_ROUNDS: usize = 4;
/// Iterations of the joint fit.
const ITERATIONS: usize = 8;
/// Part of a column that no other has, over its length, below which normal equations count as singular: columns are one-sided
/// differences over steps of a thousandth, and agree no better than that when they are the same.
const SINGULAR: f64 = 1e-3;
/// Starting variance of the unmodelled residual, in units of its component (a hundredth of the noise floor).
const GENERIC_START: f64 = 1e-2;

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

/// One corrected Gauss-Newton step.
pub(crate) struct Step {
    pub(crate) delta: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
    pub(crate) inverse: DMatrix<f64>,
}

/// Whitened residuals and columns.
pub(crate) struct Whitened {
    a: Vec<Residual>,
    da: Vec<Vec<Residual>>,
    looped: Vec<f64>,
}

impl Whitened {
    pub(crate) fn new(w: &Whitening, columns: &Columns) -> Self {
        let all = |c: &Vec<Residual>| c.iter().map(|x| w.whiten(x)).collect::<Vec<_>>();
        Self { a: all(&columns.a), da: columns.da.iter().map(all).collect(), looped: columns.looped.clone() }
    }
}

/// Inner product in eight partial sums, so that it uses vector units.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (x, y) = (x.chunks_exact(8), y.chunks_exact(8));
    let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in x.zip(y) {
        for ((s, a), b) in sums.iter_mut().zip(a).zip(b) {
            *s += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Whitened normal equations with the correction for noise in the regressors.
#[derive(Clone)]
pub(crate) struct Normal {
    /// Score `aᵀz` less what noise and the closed loop give at the truth.
    pub(crate) g: DVector<f64>,
    /// Information `aᵀa` less what noise alone gives.
    pub(crate) j: DMatrix<f64>,
    /// Variance of the score, `aᵀa`, and of the correction.
    pub(crate) v: DMatrix<f64>,
}

impl Normal {
    /// Equations of some columns.
    pub(crate) fn new(at: &Whitened, columns: &Whitened) -> Self {
        let empty = Self { g: DVector::zeros(0), j: DMatrix::zeros(0, 0), v: DMatrix::zeros(0, 0) };
        empty.with(at, &Whitened { a: Vec::new(), da: vec![Vec::new(); at.da.len()], looped: Vec::new() }, columns)
    }
    /// Equations of known columns (these) and more; `at` holds the residual and its copies as its only column.
    pub(crate) fn with(&self, at: &Whitened, known: &Whitened, more: &Whitened) -> Self {
        let (n, m) = (known.a.len(), more.a.len());
        let mut all = Self {
            g: self.g.clone().resize_vertically(n + m, 0.0),
            j: self.j.clone().resize(n + m, n + m, 0.0),
            v: self.v.clone().resize(n + m, n + m, 0.0),
        };
        let weight = 1.0 / at.da.len().max(1) as f64;
        for i in 0..m {
            let noise: f64 = more.da.iter().zip(&at.da).map(|(d, z)| dot(&d[i], &z[0])).sum();
            all.g[n + i] = dot(&more.a[i], &at.a[0]) - weight * noise - more.looped[i];
            for k in 0..=n + i {
                let (other, dother): (&Residual, Vec<&Residual>) = if k < n {
                    (&known.a[k], known.da.iter().map(|d| &d[k]).collect())
                } else {
                    (&more.a[k - n], more.da.iter().map(|d| &d[k - n]).collect())
                };
                let v = dot(&more.a[i], other);
                let noise: f64 = more.da.iter().zip(dother).map(|(d, o)| dot(&d[i], o)).sum();
                for (r, c) in [(n + i, k), (k, n + i)] {
                    // The correction is a mean over the copies and has their scatter.
                    all.v[(r, c)] = v + weight * weight * noise;
                    all.j[(r, c)] = v - weight * noise;
                }
            }
        }
        all
    }
    /// Equations of some of the numbers.
    pub(crate) fn some(&self, kept: &[usize]) -> Self {
        let part = |m: &DMatrix<f64>| DMatrix::from_fn(kept.len(), kept.len(), |i, k| m[(kept[i], kept[k])]);
        Self { g: DVector::from_fn(kept.len(), |i, _| self.g[kept[i]]), j: part(&self.j), v: part(&self.v) }
    }
    /// The number (of those that may be held) that weighs most in the direction of least information.
    pub(crate) fn undetermined(&self, may: impl Fn(usize) -> bool) -> Option<usize> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.v[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let eigen = scaled_back(&self.j, &scale).symmetric_eigen();
        let (least, _) = eigen.eigenvalues.argmin();
        (0..p)
            .filter(|&i| may(i))
            .max_by(|a, b| eigen.eigenvectors[(*a, least)].abs().total_cmp(&eigen.eigenvectors[(*b, least)].abs()))
    }
    /// Solution `−J⁻¹g` and its covariance `J⁻¹VJ⁻¹`; `None` when `J`, scaled, is not positive definite.
    pub(crate) fn solve(&self) -> Option<Step> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.v[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let scaled = |m: &DMatrix<f64>| scaled_back(m, &scale);
        let inverse = scaled(&self.j).cholesky().filter(|c| c.l_dirty().diagonal().iter().all(|d| *d > SINGULAR))?.inverse();
        let g = DVector::from_fn(p, |i, _| self.g[i] * scale[i]);
        let delta = -(&inverse * g);
        let covariance = &inverse * scaled(&self.v) * &inverse;
        Some(Step {
            delta: delta.component_mul(&scale),
            covariance: scaled_back(&covariance, &scale),
            inverse: scaled_back(&inverse, &scale),
        })
    }
}

fn scaled_back(m: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, k| m[(i, k)] * scale[i] * scale[k])
}
