//! verify: errors of what a fit gives. In: a fit. Out: covariance that counts dependence along a run and held numbers, errors and
//! bounds of random inputs.

use super::super::evidence::{BIN, Cov, Residual};
use super::super::hypothesis::{Free, Hypothesis, Instance};
use super::super::likelihood::{Whitening, one_step, total};
use super::normal::{Normal, Whitened, dot, scaled_back};
use super::{Fit, Problem, minus};
use nalgebra::{DMatrix, DVector, SVector};
use rayon::prelude::*;

/// Rounds of a bound's fixed point.
const BOUND_ROUNDS: usize = 4;

impl Problem<'_> {
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
        let columns = self.columns(h, &free, &at, &fit.sigma);
        // A whole number (of a harmonic) is known when it is held.
        let live: Vec<usize> = (0..free.len()).filter(|&i| columns.a[i].iter().any(|x| *x != 0.0)).collect();
        let mut normal = Normal::new(&at.whitened(w), &Whitened::new(w, &columns)).some(&live);
        free = live.into_iter().map(|i| free[i]).collect();
        for (i, f) in free.iter().enumerate().filter(|(_, f)| !fit.free.contains(f)) {
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
    pub(super) fn random_errors(&self, h: &Hypothesis, z: &[f64]) -> Vec<(Free, f64)> {
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
}

/// Every bin of `z` times its covariance.
fn times(all: &[Cov], z: &[f64]) -> Residual {
    all.iter().zip(z.chunks_exact(BIN)).flat_map(|(m, z)| (m * SVector::<f64, BIN>::from_column_slice(z)).data.0[0]).collect()
}
