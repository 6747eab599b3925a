//! verify: settings of runs in standard units. In: a campaign with run inputs. Out: the same with inputs about their mean, uncorrelated,
//! with unit scatter, and the way back.
//!
//! A coefficient that follows a setting is a constant and a slope. At settings of zero, which may be far from any launch, the constant is
//! any number; what a body can have is the coefficient at the settings that were flown. About their mean, along the
//! principal axes of their scatter, all are independent, and one range and one prior hold for each.

use crate::trace::{Fit, Free, Instance};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Campaign, Effect, Parameter, Role};

/// Means of the inputs of the runs to identify on, and what makes them uncorrelated with unit scatter.
pub(super) struct Settings {
    names: Vec<String>,
    mean: DVector<f64>,
    /// Standard settings are this times inputs about their mean; directions in which no run differs are left out (zero).
    to_standard: DMatrix<f64>,
}

/// Share of the inputs' scatter in a direction below which no run differs in it.
const SAME: f64 = 1e-6;

impl Settings {
    /// Of these runs: principal axes of the inputs' correlation.
    pub(super) fn of(campaign: &Campaign, runs: &[usize]) -> Self {
        let (k, n) = (campaign.inputs.len(), runs.len());
        let inputs = DMatrix::from_fn(k, n, |i, r| campaign.runs[runs[r]].inputs.get(i).copied().unwrap_or(0.0));
        let mean = inputs.column_mean();
        let about = DMatrix::from_fn(k, n, |i, r| inputs[(i, r)] - mean[i]);
        let covariance = &about * about.transpose() / n.max(1) as f64;
        let scatter: Vec<f64> = (0..k)
            .map(|i| {
                let s = covariance[(i, i)].sqrt();
                if s > SAME * mean[i].abs() && s > 0.0 { 1.0 / s } else { 0.0 }
            })
            .collect();
        let correlation = DMatrix::from_fn(k, k, |i, j| covariance[(i, j)] * scatter[i] * scatter[j]);
        let eigen = correlation.symmetric_eigen();
        let length = |i: usize| if eigen.eigenvalues[i] > SAME { eigen.eigenvalues[i].powf(-0.5) } else { 0.0 };
        let to_standard = DMatrix::from_fn(k, k, |i, j| length(i) * eigen.eigenvectors[(j, i)] * scatter[j]);
        Self { names: campaign.inputs.clone(), mean, to_standard }
    }

    /// The campaign with its runs' inputs in standard units.
    pub(super) fn standardised(&self, campaign: &Campaign) -> Campaign {
        let mut own = campaign.clone();
        for run in own.runs.iter_mut().filter(|r| r.inputs.len() == self.mean.len()) {
            let about = DVector::from_column_slice(&run.inputs) - &self.mean;
            run.inputs = (&self.to_standard * about).as_slice().to_vec();
        }
        own
    }

    /// Place of the constant and of the input that a slope belongs to.
    fn partner(&self, parameters: &[Parameter], i: usize) -> Option<(usize, usize)> {
        let (name, input) = parameters[i].name.split_once("_per_")?;
        let input = self.names.iter().position(|n| n == input)?;
        let constant = parameters.iter().position(|p| p.name == name || p.name == format!("{name}_constant"))?;
        Some((constant, input))
    }

    /// An effect at null, every strength within what a body can have at the settings flown.
    pub(super) fn null(&self, effect: &'static Effect, campaign: &Campaign) -> Instance {
        let mut instance = Instance::null(effect, &campaign.plant, &campaign.inputs);
        let plain = (effect.parameters)(&[]);
        let range = |name: &str| plain.iter().find(|p| p.name == name).map(|p| (p.low, p.high));
        let ranges: Vec<Option<(f64, f64)>> = (0..instance.parameters.len())
            .map(|i| match self.partner(&instance.parameters, i) {
                Some((constant, _)) => range(&instance.parameters[constant].name).map(|(_, high)| (-high, high)),
                None => range(&instance.parameters[i].name),
            })
            .collect();
        for (p, range) in instance.parameters.iter_mut().zip(ranges) {
            if let (Role::Strength, Some((low, high))) = (p.role, range) {
                (p.low, p.high, p.step) = (low, high, 1e-3 * high);
            }
        }
        instance
    }

    /// An effect with values in the campaign's own units.
    pub(super) fn inward(&self, mut instance: Instance, values: &[f64]) -> Instance {
        let to = self.outward_map(&instance.parameters);
        let standard = to.svd(true, true).solve(&DVector::from_column_slice(values), 1e-12);
        instance.values = standard.map_or_else(|_| values.to_vec(), |v| v.as_slice().to_vec());
        instance
    }

    /// From standard values of an effect's parameters to those in the campaign's own units.
    fn outward_map(&self, parameters: &[Parameter]) -> DMatrix<f64> {
        let n = parameters.len();
        let partners: Vec<Option<(usize, usize)>> = (0..n).map(|i| self.partner(parameters, i)).collect();
        let mut to = DMatrix::<f64>::identity(n, n);
        for (i, a) in partners.iter().enumerate() {
            let Some((constant, input)) = a else { continue };
            to[(i, i)] = 0.0;
            for (j, b) in partners.iter().enumerate() {
                if let Some((_, standard)) = b.filter(|b| b.0 == *constant) {
                    let slope = self.to_standard[(standard, *input)];
                    to[(i, j)] += slope;
                    to[(*constant, j)] -= slope * self.mean[*input];
                }
            }
        }
        to
    }

    /// Values and standard errors of a fit's effect in the campaign's own units; an error is infinite where a number was not free.
    pub(super) fn outward(&self, fit: &Fit, k: usize) -> Vec<(f64, f64)> {
        let instance = &fit.hypothesis.effects[k];
        let n = instance.values.len();
        let to = self.outward_map(&instance.parameters);
        let place = |i: usize| fit.free.iter().position(|f| *f == Free::Effect(k, i));
        let covariance = DMatrix::from_fn(n, n, |i, j| match (place(i), place(j)) {
            (Some(a), Some(b)) => fit.covariance[(a, b)],
            _ => 0.0,
        });
        let turned = &to * covariance * to.transpose();
        let values = &to * DVector::from_column_slice(&instance.values);
        (0..n)
            .map(|i| {
                let any = (0..n).any(|j| to[(i, j)] != 0.0 && place(j).is_some());
                (values[i], if any { turned[(i, i)].max(0.0).sqrt() } else { f64::INFINITY })
            })
            .collect()
    }
}
