//! discover: settings of runs in standard units. In: a campaign with run inputs. Out: the same with inputs about their mean, uncorrelated,
//! with unit scatter, and the way back.
//!
//! A coefficient that follows a setting is a constant and a slope. At settings of zero, which may be far from any launch, the constant is
//! any number; what a body can have is the coefficient at the settings that were flown. About their mean, along the
//! principal axes of their scatter, all are independent, and one range and one prior hold for each.

use crate::tracks::{EffectInstance, Free, TrackFit};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Campaign, Data, Effect, Measured, Parameter, Role, Run};

/// Means of the inputs of the runs to identify on, and what makes them uncorrelated with unit scatter.
pub(super) struct Settings {
    runs: Vec<usize>,
    names: Vec<String>,
    mean: DVector<f64>,
    /// Standard settings are this times inputs about their mean; directions in which no run differs are left out (zero).
    to_standard: DMatrix<f64>,
}

/// Share of the inputs' scatter in a direction below which no run differs in it.
const SAME: f64 = 1e-6;
/// Rows of a run, evenly taken, by which recorded inputs are judged.
const ROWS: usize = 64;

/// Inputs of a run that were recorded row by row.
fn recorded(run: &Run) -> &[(usize, Vec<f64>)] {
    match &run.data {
        Data::Point(record) => &record.recorded_inputs,
        Data::Tunnel(_) => &[],
    }
}

impl Settings {
    /// Of these runs: principal axes of the inputs' correlation.
    pub(super) fn of(campaign: &Campaign, runs: &[usize]) -> Self {
        // Inputs that drive the declared model itself stay as they are.
        let k = if campaign.measured() == Measured::Pose { 0 } else { campaign.inputs.len() };
        if k == 0 {
            return Self { runs: runs.to_vec(), names: Vec::new(), mean: DVector::zeros(0), to_standard: DMatrix::zeros(0, 0) };
        }
        // A run whose inputs were recorded row by row counts as much as one whose inputs are constant.
        let rows = if runs.iter().any(|&r| !recorded(&campaign.runs[r]).is_empty()) { ROWS } else { 1 };
        let n = rows * runs.len();
        let inputs = DMatrix::from_fn(k, n, |i, column| {
            let run = &campaign.runs[runs[column / rows]];
            match recorded(run).iter().find(|(place, _)| *place == i) {
                Some((_, series)) => series[(column % rows) * (series.len() - 1) / (ROWS - 1)],
                None => run.inputs.get(i).copied().unwrap_or(0.0),
            }
        });
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
        Self { runs: runs.to_vec(), names: campaign.inputs.clone(), mean, to_standard }
    }

    /// The runs that they are of.
    pub(super) fn runs(&self) -> &[usize] {
        &self.runs
    }

    /// The campaign with its runs' inputs in standard units.
    pub(super) fn standardised(&self, campaign: &Campaign) -> Campaign {
        let mut own = campaign.clone();
        for run in own.runs.iter_mut().filter(|r| r.inputs.len() == self.mean.len()) {
            let about = DVector::from_column_slice(&run.inputs) - &self.mean;
            let before = std::mem::replace(&mut run.inputs, (&self.to_standard * about).as_slice().to_vec());
            if let Data::Point(record) = &mut run.data
                && !record.recorded_inputs.is_empty()
            {
                record.recorded_inputs = self.recorded(&before, &record.recorded_inputs);
            }
        }
        own
    }

    /// Every input of a run with recorded ones, row by row, in standard units.
    fn recorded(&self, constant: &[f64], recorded: &[(usize, Vec<f64>)]) -> Vec<(usize, Vec<f64>)> {
        let rows = recorded.first().map_or(0, |(_, series)| series.len());
        let mut all: Vec<(usize, Vec<f64>)> = (0..constant.len()).map(|i| (i, Vec::with_capacity(rows))).collect();
        for row in 0..rows {
            let mut inputs = DVector::from_column_slice(constant);
            recorded.iter().for_each(|(place, series)| inputs[*place] = series[row]);
            let standard = &self.to_standard * (inputs - &self.mean);
            all.iter_mut().zip(standard.iter()).for_each(|((_, series), u)| series.push(*u));
        }
        all
    }

    /// Place of the constant and of the input that a slope belongs to.
    fn partner(&self, parameters: &[Parameter], i: usize) -> Option<(usize, usize)> {
        let (name, input) = parameters[i].name.split_once("_per_")?;
        let input = self.names.iter().position(|n| n == input)?;
        let constant = parameters.iter().position(|p| p.name == name || p.name == format!("{name}_constant"))?;
        Some((constant, input))
    }

    /// A parameter beside what the runs have of its amount at the mean of their settings: it takes away no more than any of them has.
    fn beside_runs(&self, p: &Parameter, campaign: &Campaign) -> Parameter {
        let low = |run: &usize| match &campaign.runs[*run].data {
            Data::Point(record) => p.clone().beside(&record.plant(&campaign.plant, *run, &[])).low,
            Data::Tunnel(_) => p.low,
        };
        let low = self.runs.iter().map(low).max_by(f64::total_cmp).unwrap_or(p.low);
        Parameter { low, ..p.clone() }
    }

    /// An effect at null, every strength within what a body can have at the settings flown.
    pub(super) fn null(&self, effect: &'static Effect, campaign: &Campaign) -> EffectInstance {
        let mut instance = EffectInstance::null(effect, &campaign.inputs);
        let plain: Vec<Parameter> = (effect.parameters)(&[]).iter().map(|p| self.beside_runs(p, campaign)).collect();
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
    pub(super) fn inward(&self, mut instance: EffectInstance, values: &[f64]) -> EffectInstance {
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

    /// Coefficients of an effect that follow settings: the place of the part that does not, and of each slope with its input.
    pub(super) fn followers(&self, parameters: &[Parameter]) -> Vec<(usize, Vec<(usize, usize)>)> {
        let mut all: Vec<(usize, Vec<(usize, usize)>)> = Vec::new();
        for i in 0..parameters.len() {
            let Some((constant, input)) = self.partner(parameters, i) else { continue };
            match all.iter_mut().find(|(c, _)| *c == constant) {
                Some((_, slopes)) => slopes.push((i, input)),
                None => all.push((constant, vec![(i, input)])),
            }
        }
        all
    }

    /// Values and standard errors of a fit's effect in the campaign's own units; an error is infinite where a number was not free.
    pub(super) fn outward(&self, fit: &TrackFit, k: usize) -> Vec<(f64, f64)> {
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

#[cfg(test)]
mod tests;
