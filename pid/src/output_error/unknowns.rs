//! pid: what is free in a search. In: a campaign, what is held, tied or known beforehand. Out: unknowns by column, with
//! their values.

use super::CHANNELS;
use super::instruments::{ERRORS, Errors, KINDS};
use super::run::FreeColumns;
use crate::PidError;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Structure};

/// What is done with a parameter; those not named are free.
#[derive(Clone, Debug, PartialEq)]
pub enum Handling {
    /// Kept at its declared value.
    Held,
    /// Equal to another parameter, which is free.
    Tied {
        /// Name of that parameter.
        to: String,
    },
}

/// What is known of a parameter beforehand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Prior {
    /// Parameter.
    pub name: String,
    /// Value.
    pub mean: f64,
    /// Standard deviation, positive.
    pub std: f64,
}

/// What to estimate, and how long.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateOptions {
    /// Parameters that are not simply free.
    pub handling: Vec<(String, Handling)>,
    /// Knowledge from elsewhere.
    pub priors: Vec<Prior>,
    /// Also estimate constant errors of R_y and R_z, equal in all runs (rad). Off: free flight tells them only through small
    /// lateral forces.
    pub angle_biases: bool,
    /// Most iterations.
    pub iterations: usize,
    /// Only all runs together, without each kind of run alone.
    pub combined_only: bool,
    /// Also examine whether the instruments agree (output error, all runs together).
    pub compatibility: bool,
}

impl Default for EstimateOptions {
    fn default() -> Self {
        Self {
            handling: Vec::new(),
            priors: Vec::new(),
            angle_biases: false,
            iterations: 30,
            combined_only: false,
            compatibility: false,
        }
    }
}

/// The free unknowns: parameters of the structure, then biases.
#[derive(Clone, Debug)]
pub(crate) struct Unknowns {
    /// Values of all the structure's parameters.
    pub(crate) parameters: Vec<f64>,
    /// Column of each; none where held.
    pub(crate) columns: Vec<Option<usize>>,
    pub(crate) biases: [f64; CHANNELS],
    pub(crate) bias_columns: [Option<usize>; CHANNELS],
    /// Other errors of the instruments, when they are examined.
    pub(crate) errors: Option<Errors>,
    pub(crate) names: Vec<String>,
    /// Mean and standard deviation, by column.
    pub(super) priors: Vec<(usize, f64, f64)>,
}

impl Unknowns {
    /// # Errors
    /// [`PidError::Unknown`] for a name the structure does not have, a tie of or to a parameter that is not free, what is
    /// held or tied twice, or a prior without width.
    pub(crate) fn new(campaign: &Campaign, options: &EstimateOptions) -> Result<Self, PidError> {
        let structure = &campaign.plant.aero.structure;
        let count = structure.parameters.len();
        let (mut held, mut tied) = (vec![false; count], vec![None; count]);
        for (name, handling) in &options.handling {
            let i = index(structure, name)?;
            let fault = |what| Err(PidError::Unknown { what, name: name.clone() });
            if held[i] || tied[i].is_some() {
                return fault("held or tied more than once");
            }
            if !campaign.declared[i] && matches!(handling, Handling::Tied { .. }) {
                return fault("tie of a parameter that is not declared or is held");
            }
            match handling {
                Handling::Held => held[i] = true,
                Handling::Tied { to } => tied[i] = Some(index(structure, to)?),
            }
        }
        let (mut columns, mut names) = (vec![None; count], Vec::new());
        for i in (0..count).filter(|i| campaign.declared[*i] && !held[*i] && tied[*i].is_none()) {
            columns[i] = Some(names.len());
            names.push(structure.parameters[i].clone());
        }
        let mut parameters = campaign.plant.aero.values.clone();
        for (i, to) in tied.iter().enumerate().filter_map(|(i, t)| t.map(|t| (i, t))) {
            columns[i] = Some(columns[to].filter(|_| tied[to].is_none()).ok_or_else(|| PidError::Unknown {
                what: "tie to a parameter that is not free",
                name: structure.parameters[to].clone(),
            })?);
            parameters[i] = parameters[to];
        }
        let mut bias_columns = [None; CHANNELS];
        if options.angle_biases {
            for (channel, name) in [(4, "Ry_bias_rad"), (5, "Rz_bias_rad")] {
                bias_columns[channel] = Some(names.len());
                names.push(name.to_owned());
            }
        }
        let prior = |p: &Prior| {
            let column = names.iter().position(|n| *n == p.name);
            let fault = |what| PidError::Unknown { what, name: p.name.clone() };
            let wide = p.std > 0.0 && p.std.is_finite() && p.mean.is_finite();
            Ok((
                column.ok_or_else(|| fault("prior of a parameter that is not free"))?,
                p.mean,
                if wide {
                    p.std
                } else {
                    return Err(fault("prior without a positive standard deviation"));
                },
            ))
        };
        let priors = options.priors.iter().map(prior).collect::<Result<_, _>>()?;
        Ok(Self { parameters, columns, biases: [0.0; CHANNELS], bias_columns, errors: None, names, priors })
    }

    /// With all errors of the instruments free beside what is free already, from zero.
    pub(crate) fn with_errors(mut self) -> Self {
        let first = self.free();
        self.errors = Some(Errors { values: [0.0; ERRORS], columns: std::array::from_fn(|k| Some(first + k)) });
        self.names.extend(KINDS.iter().map(|k| k.0.to_owned()));
        self
    }

    /// Holds one more unknown at its value.
    pub(crate) fn hold(&mut self, column: usize) {
        let lower = |c: &mut Option<usize>| {
            *c = match *c {
                Some(k) if k == column => None,
                Some(k) if k > column => Some(k - 1),
                other => other,
            }
        };
        self.columns.iter_mut().for_each(lower);
        self.bias_columns.iter_mut().for_each(lower);
        self.errors.iter_mut().flat_map(|e| &mut e.columns).for_each(lower);
        self.names.remove(column);
        self.priors.retain(|p| p.0 != column);
        self.priors.iter_mut().filter(|p| p.0 > column).for_each(|p| p.0 -= 1);
    }

    pub(crate) fn free(&self) -> usize {
        self.names.len()
    }
    pub(crate) fn columns(&self) -> FreeColumns<'_> {
        FreeColumns {
            parameters: &self.parameters,
            columns: &self.columns,
            biases: self.biases,
            bias_columns: self.bias_columns,
            errors: self.errors,
            free: self.free(),
        }
    }
    /// Values by column.
    pub(crate) fn values(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.free()];
        let errors = self.errors.iter().flat_map(|e| e.columns.iter().zip(&e.values));
        let all = self.columns.iter().zip(&self.parameters).chain(self.bias_columns.iter().zip(&self.biases)).chain(errors);
        all.filter_map(|(c, v)| c.map(|c| (c, *v))).for_each(|(c, v)| values[c] = v);
        values
    }
    /// Free parameters start from these values; tied ones from that of the first of them.
    pub(crate) fn start(&mut self, values: &[f64]) {
        for column in 0..self.free() {
            let mine = |c: &Option<usize>| *c == Some(column);
            let first = self.columns.iter().position(mine).map(|i| values[i]).filter(|v| v.is_finite());
            if let Some(value) = first {
                self.parameters.iter_mut().zip(&self.columns).filter(|(_, c)| mine(c)).for_each(|(p, _)| *p = value);
            }
        }
    }
    pub(crate) fn moved(&self, step: &DVector<f64>, fraction: f64) -> Self {
        let mut moved = self.clone();
        let own = moved.parameters.iter_mut().zip(&self.columns).chain(moved.biases.iter_mut().zip(&self.bias_columns));
        let errors = moved.errors.iter_mut().flat_map(|e| e.values.iter_mut().zip(&e.columns));
        own.chain(errors).for_each(|(v, c)| *v += c.map_or(0.0, |c| fraction * step[c]));
        moved
    }
    /// Column of each prior, distance of its mean from here, and standard deviation.
    pub(crate) fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let values = self.values();
        self.priors.iter().map(move |(c, mean, std)| (*c, mean - values[*c], *std))
    }
    /// Twice the priors' part of the negative log-likelihood.
    pub(crate) fn prior_misfit(&self) -> f64 {
        self.priors().map(|(_, off, std)| (off / std).powi(2)).sum()
    }
}

fn index(structure: &Structure, name: &str) -> Result<usize, PidError> {
    structure
        .index(name)
        .ok_or_else(|| PidError::Unknown { what: "name that is no parameter of the structure", name: name.to_owned() })
}
