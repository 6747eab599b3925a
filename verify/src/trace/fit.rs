//! verify: joint fit of a hypothesis. In: evidence and starting values. Out: estimates, covariance, likelihood.
//!
//! Mean parameters by Gauss-Newton on the whitened residual with the score corrected for noise in the regressors (Fuller 1987,
//! ch. 3; the correction is measured on copies of the data with noise added again); sizes of random inputs and of the
//! unmodelled residual by maximum likelihood; shapes of random inputs by line search.

use super::evidence::{Cov, Evidence, Residual};
use super::hypothesis::{Free, Hypothesis};
use super::likelihood::{Whitening, components, total};
use nalgebra::{DMatrix, DVector};
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

/// A fitted hypothesis.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Values.
    pub hypothesis: Hypothesis,
    /// The free numbers of the mean, in order.
    pub free: Vec<Free>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Log-likelihood, up to a constant of the evidence.
    pub log_likelihood: f64,
    /// Residual of the data.
    pub residual: Residual,
    /// Covariance per bin at the fit.
    pub sigma: Vec<Cov>,
    /// Why it stopped.
    pub stop: StopReason,
}

impl Fit {
    /// Standard error of a free number; infinite when it was not free.
    #[must_use]
    pub fn std_error(&self, f: Free) -> f64 {
        self.free.iter().position(|g| *g == f).map_or(f64::INFINITY, |i| self.covariance[(i, i)].max(0.0).sqrt())
    }
}

/// Residuals at a point: of the data, and what each noisy copy adds.
pub(crate) struct Point {
    pub(crate) z: Residual,
    pub(crate) dz: Vec<Residual>,
}

impl Point {
    pub(crate) fn whitened(&self, w: &Whitening) -> Whitened {
        Whitened { a: vec![w.whiten(&self.z)], da: self.dz.iter().map(|d| vec![w.whiten(d)]).collect() }
    }
}

/// Columns of a linearisation: of the data and of what each copy adds.
pub(crate) struct Columns {
    pub(crate) a: Vec<Residual>,
    pub(crate) da: Vec<Vec<Residual>>,
}

fn minus(a: &[f64], b: &[f64], scale: f64) -> Residual {
    a.iter().zip(b).map(|(x, y)| (x - y) * scale).collect()
}

impl Problem<'_> {
    pub(crate) fn point(&self, plant: &Plant) -> Point {
        let mut all: Vec<Residual> =
            (0..=self.evidence.copies()).into_par_iter().map(|c| self.evidence.residual(plant, c)).collect();
        let z = all.remove(0);
        let dz = all.iter().map(|c| minus(c, &z, 1.0)).collect();
        Point { z, dz }
    }

    /// Linearisation in `free` around a hypothesis whose residuals are `at`.
    pub(crate) fn columns(&self, h: &Hypothesis, free: &[Free], at: &Point) -> Columns {
        let all: Vec<Point> = free
            .par_iter()
            .map(|f| {
                let step = h.step(*f);
                let mut moved = h.clone();
                moved.set(*f, h.get(*f) + step);
                let p = self.point(&moved.plant(self.base));
                Point {
                    z: minus(&p.z, &at.z, 1.0 / step),
                    dz: p.dz.iter().zip(&at.dz).map(|(q, r)| minus(q, r, 1.0 / step)).collect(),
                }
            })
            .collect();
        let mut columns = Columns { a: Vec::new(), da: vec![Vec::new(); self.evidence.copies()] };
        for p in all {
            columns.a.push(p.z);
            for (c, d) in p.dz.into_iter().enumerate() {
                columns.da[c].push(d);
            }
        }
        columns
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
    pub(crate) fn fit_sizes(&self, h: &mut Hypothesis, z: &[f64]) -> (f64, Vec<Cov>) {
        let random = self.random_parts(h);
        let generic = self.evidence.generic();
        let parts: Vec<&[Cov]> = random.iter().map(|(_, m)| m.as_slice()).chain(generic.iter().map(Vec::as_slice)).collect();
        let start: Vec<f64> = random
            .iter()
            .map(|(f, _)| h.get(*f).powi(2).max(1e-8))
            .chain(h.generic.iter().map(|v| v.max(GENERIC_START)))
            .collect();
        let (sizes, l) = components(self.evidence.noise(), &parts, z, &start, 0.02);
        for ((f, _), v) in random.iter().zip(&sizes) {
            h.set(*f, v.sqrt());
        }
        h.generic = sizes[random.len()..].to_vec();
        (l, total(self.evidence.noise(), &parts, &sizes))
    }

    /// Fits everything together from the hypothesis' values; `shapes` says whether shapes of mean effects move too.
    #[must_use]
    pub fn fit(&self, start: &Hypothesis, shapes: bool) -> Fit {
        let mut h = start.clone();
        let free = h.free(self.declared, shapes);
        let mut fit = Fit {
            hypothesis: h.clone(),
            free: free.clone(),
            covariance: DMatrix::zeros(free.len(), free.len()),
            log_likelihood: f64::NEG_INFINITY,
            residual: Vec::new(),
            sigma: Vec::new(),
            stop: StopReason::IterationLimit,
        };
        for _ in 0..ITERATIONS {
            self.evidence.focus(&h.plant(self.base));
            let at = self.point(&h.plant(self.base));
            if at.z.iter().any(|x| !x.is_finite()) {
                fit.stop = StopReason::NotFinite;
                return fit;
            }
            self.refine_random_shapes(&mut h, &at.z, shapes);
            let (_, sigma) = self.fit_sizes(&mut h, &at.z);
            let columns = self.columns(&h, &free, &at);
            let Some(step) = Step::solve(&sigma, &at, &columns) else {
                fit.stop = StopReason::NotExcited;
                return fit;
            };
            fit.covariance = step.covariance.clone();
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
        let (l, sigma) = self.fit_sizes(&mut h, &fit.residual);
        fit.log_likelihood = if l.is_finite() { l } else { f64::NEG_INFINITY };
        fit.sigma = sigma;
        fit.hypothesis = h;
        fit
    }

    /// Line search of each shape of purely random effects, on the likelihood with sizes refitted.
    fn refine_random_shapes(&self, h: &mut Hypothesis, z: &[f64], shapes: bool) {
        if !shapes {
            return;
        }
        for k in 0..h.effects.len() {
            if h.effects[k].mean_strengths().next().is_some() {
                continue;
            }
            for i in h.effects[k].shapes().collect::<Vec<_>>() {
                let p = h.effects[k].parameters[i].clone();
                let centre = h.effects[k].values[i];
                let mut width = 0.5_f64;
                let mut best = (self.fit_sizes(&mut h.clone(), z).0, centre);
                for _ in 0..6 {
                    for sign in [-1.0, 1.0] {
                        let mut trial = h.clone();
                        trial.effects[k].values[i] = (best.1 * (sign * width).exp()).clamp(p.low, p.high);
                        let l = self.fit_sizes(&mut trial, z).0;
                        if l > best.0 {
                            best = (l, trial.effects[k].values[i]);
                            break;
                        }
                    }
                    width *= 0.55;
                }
                h.effects[k].values[i] = best.1;
            }
        }
    }
}

/// Iterations of the joint fit.
const ITERATIONS: usize = 8;
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
}

/// Whitened residuals and columns.
pub(crate) struct Whitened {
    a: Vec<Residual>,
    da: Vec<Vec<Residual>>,
}

impl Whitened {
    pub(crate) fn new(w: &Whitening, columns: &Columns) -> Self {
        let all = |c: &Vec<Residual>| c.iter().map(|x| w.whiten(x)).collect::<Vec<_>>();
        Self { a: all(&columns.a), da: columns.da.iter().map(all).collect() }
    }
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

/// Whitened normal equations with the correction for noise in the regressors.
#[derive(Clone)]
pub(crate) struct Normal {
    /// Score `aᵀz` less what noise alone gives.
    pub(crate) g: DVector<f64>,
    /// Information `aᵀa` less what noise alone gives.
    pub(crate) j: DMatrix<f64>,
    /// Variance of the score, `aᵀa`.
    pub(crate) v: DMatrix<f64>,
}

impl Normal {
    /// Equations of some columns.
    pub(crate) fn new(at: &Whitened, columns: &Whitened) -> Self {
        let empty = Self { g: DVector::zeros(0), j: DMatrix::zeros(0, 0), v: DMatrix::zeros(0, 0) };
        empty.with(at, &Whitened { a: Vec::new(), da: vec![Vec::new(); at.da.len()] }, columns)
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
            all.g[n + i] = dot(&more.a[i], &at.a[0]) - weight * noise;
            for k in 0..=n + i {
                let (other, dother): (&Residual, Vec<&Residual>) = if k < n {
                    (&known.a[k], known.da.iter().map(|d| &d[k]).collect())
                } else {
                    (&more.a[k - n], more.da.iter().map(|d| &d[k - n]).collect())
                };
                let v = dot(&more.a[i], other);
                let noise: f64 = more.da.iter().zip(dother).map(|(d, o)| dot(&d[i], o)).sum();
                for (r, c) in [(n + i, k), (k, n + i)] {
                    all.v[(r, c)] = v;
                    all.j[(r, c)] = v - weight * noise;
                }
            }
        }
        all
    }
    /// Solution `−J⁻¹g` and its covariance `J⁻¹VJ⁻¹`; `None` when `J`, scaled, is not positive definite.
    pub(crate) fn solve(&self) -> Option<Step> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.v[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let scaled = |m: &DMatrix<f64>| DMatrix::from_fn(p, p, |i, k| m[(i, k)] * scale[i] * scale[k]);
        let inverse = scaled(&self.j).cholesky()?.inverse();
        let g = DVector::from_fn(p, |i, _| self.g[i] * scale[i]);
        let delta = -(&inverse * g);
        let covariance = &inverse * scaled(&self.v) * &inverse;
        Some(Step { delta: delta.component_mul(&scale), covariance: scaled_back(&covariance, &scale) })
    }
}

fn scaled_back(m: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, k| m[(i, k)] * scale[i] * scale[k])
}

impl Step {
    fn solve(sigma: &[Cov], at: &Point, columns: &Columns) -> Option<Self> {
        let w = Whitening::new(sigma)?;
        Normal::new(&at.whitened(&w), &Whitened::new(&w, columns)).solve()
    }
}
