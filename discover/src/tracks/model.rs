//! discover: a declared model with effects added. In: values. Out: the plant that they make, and which numbers are free.

use super::scatter::Between;
use windfall_model::{Constant, Effect, Parameter, Plant, Role};

/// An effect with values for all its parameters.
#[derive(Clone, Debug)]
pub struct EffectInstance {
    /// The effect.
    pub effect: &'static Effect,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Their values.
    pub values: Vec<f64>,
}

impl EffectInstance {
    /// Instance at null.
    #[must_use]
    pub fn null(effect: &'static Effect, inputs: &[String]) -> Self {
        let parameters = (effect.parameters)(inputs);
        let values: Vec<f64> = parameters.iter().map(|p| p.null).collect();
        Self { effect, parameters, values }
    }
    fn strengths(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&i| self.parameters[i].role == Role::Strength)
    }
    fn shapes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&i| matches!(self.parameters[i].role, Role::Shape(_)))
    }
}

/// One number that a fit may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Free {
    /// Declared aerodynamic parameter by index.
    Declared(usize),
    /// Uncertain constant by index.
    Constant(usize),
    /// Effect by position, parameter by index.
    Effect(usize, usize),
}

/// Declared values and added effects.
#[derive(Clone, Debug)]
pub struct TrackModel {
    /// Values of the structure's parameters.
    pub declared: Vec<f64>,
    /// Priors of parameters: index, value before the runs, standard uncertainty.
    pub priors: Vec<(usize, f64, f64)>,
    /// Uncertain constants with their departures from what is declared: nuisance parameters with a normal prior.
    pub constants: Vec<(Constant, f64)>,
    /// Added effects, in the order they were added.
    pub effects: Vec<EffectInstance>,
    /// Sizes (variances) of the unmodelled residual, per generic component.
    pub generic: Vec<f64>,
    /// Scatter between runs, of poses, once it was fitted.
    pub scatter: Option<Box<Between>>,
}

impl TrackModel {
    /// The plant that these values make of a base plant.
    #[must_use]
    pub fn plant(&self, base: &Plant) -> Plant {
        let mut plant = base.clone();
        plant.aero.values.clone_from(&self.declared);
        for (constant, departure) in &self.constants {
            if let Some(x) = (constant.lens)(&mut plant) {
                *x += departure;
            }
        }
        for e in &self.effects {
            (e.effect.apply)(&mut plant, &e.values);
        }
        plant
    }
    /// Value of a free number.
    #[must_use]
    pub fn get(&self, f: Free) -> f64 {
        match f {
            Free::Declared(i) => self.declared[i],
            Free::Constant(i) => self.constants[i].1,
            Free::Effect(e, i) => self.effects[e].values[i],
        }
    }
    /// Changes a free number.
    pub(super) fn set(&mut self, f: Free, value: f64) {
        match f {
            Free::Declared(i) => self.declared[i] = value,
            Free::Constant(i) => self.constants[i].1 = value,
            Free::Effect(e, i) => self.effects[e].values[i] = value,
        }
    }
    /// Least and most that a fit's step may lead to: of a strength its plausible range.
    pub(super) fn range(&self, f: Free) -> [f64; 2] {
        match f {
            Free::Effect(e, i) if self.effects[e].parameters[i].role == Role::Strength => {
                let p = &self.effects[e].parameters[i];
                [p.low, p.high]
            }
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
    /// The same with one free number moved by a step for differences, and the step.
    pub(crate) fn moved(&self, f: Free) -> (Self, f64) {
        let step = self.step(f);
        let mut moved = self.clone();
        moved.set(f, self.get(f) + step);
        (moved, step)
    }
    /// Numbers that enter the mean: declared parameters, strengths, and shapes when asked for.
    pub(super) fn free(&self, declared: &[bool], shapes: bool) -> Vec<Free> {
        let mut free: Vec<Free> = (0..self.declared.len()).filter(|&i| declared[i]).map(Free::Declared).collect();
        free.extend((0..self.constants.len()).map(Free::Constant));
        for (k, e) in self.effects.iter().enumerate() {
            free.extend(e.strengths().map(|i| Free::Effect(k, i)));
            if shapes {
                free.extend(e.shapes().map(|i| Free::Effect(k, i)));
            }
        }
        free
    }
    /// What is known of a free number without the data: how far it is from that, and with which standard uncertainty.
    pub fn prior(&self, f: Free) -> Option<(f64, f64)> {
        match f {
            Free::Constant(i) => Some((self.constants[i].1, self.constants[i].0.std)),
            Free::Declared(i) => self.priors.iter().find(|p| p.0 == i).map(|(_, value, std)| (self.declared[i] - value, *std)),
            Free::Effect(..) => None,
        }
    }
    /// Log-density of the priors at these values, up to a constant.
    pub(super) fn log_prior(&self) -> f64 {
        let constants = (0..self.constants.len()).map(Free::Constant);
        let parameters = self.priors.iter().map(|p| Free::Declared(p.0));
        constants.chain(parameters).filter_map(|f| self.prior(f)).map(|(departure, std)| -0.5 * (departure / std).powi(2)).sum()
    }
    /// Sensible step for a difference in a free number.
    pub(super) fn step(&self, f: Free) -> f64 {
        match f {
            Free::Declared(i) => 1e-3 * self.declared[i].abs().max(1e-2),
            Free::Constant(i) => 0.1 * self.constants[i].0.std,
            Free::Effect(e, i) => {
                let p = &self.effects[e].parameters[i];
                match p.role {
                    Role::Strength => p.step,
                    Role::Instant => 0.01,
                    Role::Shape(_) | Role::Run | Role::AeroPlace | Role::Reference => {
                        0.02 * self.effects[e].values[i].abs().max(1e-6)
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
