//! pid: what is free in a search. In: a campaign, what is held, tied or known beforehand. Out: the vector of unknowns.

use super::instruments::KINDS;
use crate::PidError;
use crate::smooth::Smoother;
use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Freedom, Structure, Unknown, UnknownId, Unknowns};

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
    /// How the thesis' method smooths; none: with the cutoffs of Table 3.1. The other methods choose for themselves.
    pub smoother: Option<Smoother>,
    /// Equation error as a start of something else: regressors taken as exact, nothing refused.
    pub starting: bool,
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
            smoother: None,
            starting: false,
        }
    }
}

/// Errors of R_y and R_z that [`EstimateOptions::angle_biases`] asks for, with their channels.
pub(super) const ANGLE_BIASES: [(usize, &str); 2] = [(4, "Ry_bias_rad"), (5, "Rz_bias_rad")];

/// What is free in a search: parameters of the structure, then errors of angles.
///
/// # Errors
/// [`PidError::Unknown`] for a name the structure does not have, a tie of or to a parameter that is not free, what is
/// held or tied twice, or a prior without width.
pub(crate) fn unknowns(campaign: &Campaign, options: &EstimateOptions) -> Result<Unknowns, PidError> {
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
    let values = &campaign.plant.aero.values;
    let number =
        |i: usize| Unknown::linear(UnknownId::Parameter(i), &structure.parameters[i], values[i], Freedom::Held(values[i]));
    let mut all: Vec<Unknown> = (0..count).map(number).collect();
    let mut columns = 0..;
    for i in (0..count).filter(|i| campaign.declared[*i] && !held[*i] && tied[*i].is_none()) {
        all[i].freedom = Freedom::Free(columns.next().unwrap_or_default());
    }
    for (i, to) in tied.iter().enumerate().filter_map(|(i, t)| t.map(|t| (i, t))) {
        let Freedom::Free(column) = all[to].freedom else {
            return Err(PidError::Unknown {
                what: "tie to a parameter that is not free",
                name: structure.parameters[to].clone(),
            });
        };
        (all[i].at, all[i].freedom) = (all[to].at, Freedom::Tied(column));
    }
    if options.angle_biases {
        for ((_, name), column) in ANGLE_BIASES.into_iter().zip(columns) {
            all.push(Unknown::linear(UnknownId::Nuisance(name), name, 0.0, Freedom::Free(column)));
        }
    }
    let mut all = Unknowns::from(all);
    for prior in &options.priors {
        let fault = |what| PidError::Unknown { what, name: prior.name.clone() };
        let free = all.all.iter().position(|u| u.name == prior.name && matches!(u.freedom, Freedom::Free(_)));
        let free = free.ok_or_else(|| fault("prior of a parameter that is not free"))?;
        if !(prior.std > 0.0 && prior.std.is_finite() && prior.mean.is_finite()) {
            return Err(fault("prior without a positive standard deviation"));
        }
        all.know(free, prior.mean, prior.std);
    }
    Ok(all)
}

/// With all errors of the instruments free beside what is free already, from zero.
pub(crate) fn with_errors(mut unknowns: Unknowns) -> Unknowns {
    for (kind, column) in KINDS.iter().zip(unknowns.free()..) {
        unknowns.all.push(Unknown::linear(UnknownId::Nuisance(kind.0), kind.0, 0.0, Freedom::Free(column)));
    }
    unknowns
}

fn index(structure: &Structure, name: &str) -> Result<usize, PidError> {
    structure
        .index(name)
        .ok_or_else(|| PidError::Unknown { what: "name that is no parameter of the structure", name: name.to_owned() })
}
