//! verify: random inputs and the unmodelled residual in a fit. In: a hypothesis and a residual. Out: their most likely sizes and
//! shapes, and the covariance that they and noise give.

use super::super::evidence::Cov;
use super::super::hypothesis::{Free, Hypothesis};
use super::super::likelihood::{Effort, NEGLIGIBLE, components, total};
use super::Problem;
use rayon::prelude::*;

/// Starting variance of the unmodelled residual, in units of its component (a hundredth of the noise floor).
const GENERIC_START: f64 = 1e-2;

impl Problem<'_> {
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

    /// Covariance per bin with all sizes as they are, and the parts of random inputs.
    pub(super) fn sigma(&self, h: &Hypothesis) -> (Vec<(Free, Vec<Cov>)>, Vec<Cov>) {
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

    /// Line search of each shape of purely random effects, on the likelihood with sizes refitted, from steps of `width` in the
    /// logarithm down to a thirtieth of that.
    pub(super) fn refine_random_shapes(&self, h: &mut Hypothesis, z: &[f64], width: f64) {
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
