//! verify: a declared model with effects added. In: values. Out: the plant that they make, and which numbers are free.

use windfall_model::{Acts, Constant, Effect, Parameter, Plant, Role};

/// An effect with values for all its parameters.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The effect.
    pub effect: &'static Effect,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Their values.
    pub values: Vec<f64>,
    /// Which strengths are sizes of random inputs.
    pub random: Vec<bool>,
}

impl Instance {
    /// Instance at null.
    #[must_use]
    pub fn null(effect: &'static Effect, base: &Plant, inputs: &[String]) -> Self {
        let parameters = (effect.parameters)(inputs);
        let values: Vec<f64> = parameters.iter().map(|p| p.null).collect();
        let random = (0..parameters.len())
            .map(|i| {
                let mut v = values.clone();
                v[i] = 1.0;
                let mut plant = base.clone();
                (effect.apply)(&mut plant, &v);
                parameters[i].role == Role::Strength && plant.disturbances(1.0) != base.disturbances(1.0)
            })
            .collect();
        Self { effect, parameters, values, random }
    }
    /// Indices of strengths that enter the mean.
    pub fn mean_strengths(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&i| self.parameters[i].role == Role::Strength && !self.random[i])
    }
    /// Indices of strengths of random inputs.
    pub fn random_strengths(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&i| self.random[i])
    }
    /// Indices of shapes that can be refined.
    pub fn shapes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&i| matches!(self.parameters[i].role, Role::Shape(_) | Role::Instant))
    }
    /// Shortest of its shapes that are times, s: how long a pulse lasts; infinite where it has none.
    pub(crate) fn shape_duration_s(&self) -> f64 {
        let is_time = |p: &Parameter| matches!(p.role, Role::Shape(_)) && p.unit == "s";
        self.parameters.iter().zip(&self.values).filter(|(p, _)| is_time(p)).map(|(_, v)| *v).fold(f64::INFINITY, f64::min)
    }
    /// True when the effect lives in one run only.
    #[must_use]
    pub fn is_local(&self) -> bool {
        self.parameters.iter().any(|p| p.role == Role::Run)
    }
    /// True when every value is inside its plausible range.
    #[must_use]
    pub fn is_plausible(&self) -> bool {
        self.values.iter().zip(&self.parameters).all(|(v, p)| v.is_finite() && p.beyond(*v) < 1e-9)
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
pub struct Hypothesis {
    /// Values of the structure's parameters.
    pub declared: Vec<f64>,
    /// Uncertain constants with their departures from what is declared: nuisance parameters with a normal prior.
    pub constants: Vec<(Constant, f64)>,
    /// Added effects, in the order they were added.
    pub effects: Vec<Instance>,
    /// Sizes (variances) of the unmodelled residual, per generic component.
    pub generic: Vec<f64>,
}

impl Hypothesis {
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
    pub fn set(&mut self, f: Free, value: f64) {
        match f {
            Free::Declared(i) => self.declared[i] = value,
            Free::Constant(i) => self.constants[i].1 = value,
            Free::Effect(e, i) => self.effects[e].values[i] = value,
        }
    }
    /// Numbers that enter the mean: declared parameters, strengths, and shapes when asked for.
    #[must_use]
    pub fn free(&self, declared: &[bool], shapes: bool) -> Vec<Free> {
        let mut free: Vec<Free> = (0..self.declared.len()).filter(|&i| declared[i]).map(Free::Declared).collect();
        free.extend((0..self.constants.len()).map(Free::Constant));
        for (k, e) in self.effects.iter().enumerate() {
            free.extend(e.mean_strengths().map(|i| Free::Effect(k, i)));
            if shapes && e.mean_strengths().next().is_some() && !e.is_local() {
                free.extend(e.shapes().map(|i| Free::Effect(k, i)));
            }
        }
        free
    }
    /// Log-density of the constants' prior at these values, up to a constant.
    #[must_use]
    pub fn log_prior(&self) -> f64 {
        self.constants.iter().map(|(c, departure)| -0.5 * (departure / c.std).powi(2)).sum()
    }
    /// Sensible step for a difference in a free number.
    #[must_use]
    pub fn step(&self, f: Free) -> f64 {
        match f {
            Free::Declared(i) => 1e-3 * self.declared[i].abs().max(1e-2),
            Free::Constant(i) => 0.1 * self.constants[i].0.std,
            Free::Effect(e, i) => {
                let p = &self.effects[e].parameters[i];
                match p.role {
                    Role::Strength => p.step,
                    Role::Instant => 0.01,
                    Role::Shape(_) | Role::Run => 0.02 * self.effects[e].values[i].abs().max(1e-6),
                }
            }
        }
    }
}

/// Bodies that a plant of a campaign is.
#[must_use]
pub fn acts(point_mass: bool) -> Acts {
    if point_mass { Acts::PointMass } else { Acts::Lander }
}
