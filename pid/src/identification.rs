//! pid: the result of an identification. In: fits. Out: the contract's `identification.json` as data.

use crate::compatibility::Compatibility;
use crate::envelope::{Envelope, RunEnvelope};
use crate::information::Identifiability;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use windfall_model::{Aero, Coefficient, Structure};

/// Name of the data set of all runs together.
pub(crate) const ALL_RUNS: &str = "combined";

/// Result of one method on one campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identification {
    /// Name of the method, as on the command line.
    pub method: String,
    /// Why this method was taken, where it was not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// How records were smoothed, where the method leaves a choice: cut-off frequencies of the thesis' Fourier series, or none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<String>,
    /// What all runs together can tell at all, seen before fitting; none where they cannot be integrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub identifiability: Option<Identifiability>,
    /// Whether the instruments agree with each other; where it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compatibility: Option<Compatibility>,
    /// One result per kind of run, and `combined`.
    pub data_sets: Vec<DataSet>,
    /// What every run reached, those held out too (thesis Table 5.1); empty until it is asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub envelopes: Vec<RunEnvelope>,
    /// What a user should know: a cause and a next step each.
    #[serde(default)]
    pub warnings: Vec<String>,
}

/// Parameters from one set of runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DataSet {
    /// A kind of run, or `combined`.
    pub name: String,
    /// Names of the runs in it.
    pub runs: Vec<String>,
    /// Estimates, in the order of the coefficients.
    pub parameters: Vec<Estimate>,
    /// Quality of each fit.
    pub fits: Vec<CoefficientFit>,
    /// Largest condition number among the fits (columns scaled).
    pub condition_number: f64,
    /// Samples in the set.
    pub n_samples: usize,
    /// What its runs reached together: the range in which its parameters are valid. None until it is asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub envelope: Option<Envelope>,
    /// Covariance of the estimates, rows and columns in the order of `parameters`. Regression knows none between coefficients: zeros.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<Vec<f64>>,
    /// Coefficients over the angle, with bands; empty until they are asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<Curve>,
    /// Parameters that were not estimated but held, and where.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub held: Vec<Held>,
    /// Uncertain constants as estimated beside the parameters; empty where the method takes constants as exact.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constants: Vec<FoundNumber>,
    /// Effects of the model: estimated with the parameters, gusts that were found among them, or held as the campaign declares them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effects: Vec<FoundEffect>,
    /// Parameters that were not estimated because no interval of theirs would hold, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refused: Vec<Refused>,
}

/// A number of the model beside its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundNumber {
    /// Key with component of a constant, name of an effect's parameter.
    pub name: String,
    /// Value that the model has.
    pub estimate: f64,
    /// Standard error; none of a number that was held.
    pub std_error: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// An effect as the identified model has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundEffect {
    /// Family.
    pub family: String,
    /// Its numbers, in the order of the catalogue.
    pub parameters: Vec<FoundNumber>,
}

/// A parameter without an estimate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    /// Coefficient from whose data it would be.
    pub coefficient: String,
    /// Parameter name.
    pub name: String,
    /// Why, and what to do.
    pub reason: String,
}

/// One coefficient, or its damping, over an angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// `C_A`, `C_N,T`, `C_m`, and the damping of C_m and C_n by (q + α̇)/2·d/2V and (r − β̇)/2·d/2V.
    pub quantity: String,
    /// The angle: `alpha_T` or, for the damping, `alpha` or `beta`; the other is zero.
    pub over: String,
    /// Angle, degrees, from 0 to the largest that the runs reached.
    pub angle_deg: Vec<f64>,
    /// Value, dimensionless.
    pub value: Vec<f64>,
    /// Ends of the 95 % interval.
    pub low: Vec<f64>,
    /// Upper ends.
    pub high: Vec<f64>,
}

/// A parameter held at a value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Held {
    /// Parameter name.
    pub name: String,
    /// Its value.
    pub value: f64,
}

/// One parameter's estimate. Dimensionless.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Coefficient from whose data it is: `CA`, `CN` (with C_Y), `Cl`, `Cm`, `Cn`.
    pub coefficient: String,
    /// Parameter name.
    pub name: String,
    /// Estimate.
    pub estimate: f64,
    /// Standard error: for coloured residuals, but that of eq. 4.20 for the thesis' method.
    pub std_error: f64,
    /// Standard error over estimate, percent (eq. 4.21); none for an estimate of zero, which has no relative error.
    pub rse_percent: Option<f64>,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Standard error for white residuals (eq. 4.20).
    pub std_error_white: f64,
}

/// A number of a channel (SI, rad) in the unit that the channel's name says.
pub(crate) fn in_unit_of(channel: &str, si: f64) -> f64 {
    if channel.ends_with("_deg") { si.to_degrees() } else { si }
}

/// How well one coefficient is explained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoefficientFit {
    /// Coefficient, as in [`Estimate`].
    pub coefficient: String,
    /// Coefficient of determination R² (eq. 4.18).
    pub r2: f64,
    /// Standard deviation of the residual, s of eq. 4.17; of a channel in the unit of its name: deg for `Rx_deg`.
    pub residual_std: f64,
    /// Probability that white noise looks as coloured as the residual.
    pub residual_whiteness_p: f64,
}

impl AsRef<Self> for Identification {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl Identification {
    /// The data set of all runs together, or the last there is.
    #[must_use]
    pub fn combined(&self) -> Option<&DataSet> {
        self.of_all_runs().or(self.data_sets.last())
    }
    /// The data set of all runs together; none where that was not made.
    #[must_use]
    pub fn of_all_runs(&self) -> Option<&DataSet> {
        self.data_sets.iter().find(|d| d.is_of_all_runs())
    }
    /// The data set of that name.
    #[must_use]
    pub fn data_set(&self, name: &str) -> Option<&DataSet> {
        self.data_sets.iter().find(|d| d.name == name)
    }
}

impl DataSet {
    /// Whether it is of all runs together, not of one kind.
    #[must_use]
    pub fn is_of_all_runs(&self) -> bool {
        self.name == ALL_RUNS
    }
    /// The estimate of a parameter from a coefficient's data.
    #[must_use]
    pub fn get(&self, coefficient: &str, name: &str) -> Option<&Estimate> {
        self.parameters.iter().find(|p| p.coefficient == coefficient && p.name == name)
    }
    /// Covariance of [`DataSet::values`], in the structure's order; zero where there is no estimate. `None` where the set has none.
    #[must_use]
    pub fn covariance_of(&self, structure: &Structure) -> Option<DMatrix<f64>> {
        let n = self.parameters.len();
        if self.covariance.len() != n || self.covariance.iter().any(|r| r.len() != n) {
            return None;
        }
        let own = DMatrix::from_fn(n, n, |i, j| self.covariance[i][j]);
        let share = DMatrix::from_fn(structure.parameters.len(), n, |i, j| {
            let (name, all) = (&structure.parameters[i], || self.parameters.iter().filter(|p| p.name == structure.parameters[i]));
            let total: f64 = all().map(weight).sum();
            if self.parameters[j].name == *name { weight(&self.parameters[j]) / total } else { 0.0 }
        });
        Some(&share * own * share.transpose())
    }
    /// Values for a structure's parameters: where two coefficients give one parameter (the static moment, from C_m and C_n), the
    /// mean weighted by inverse variance; where it was held, that value; else `otherwise`.
    ///
    /// # Panics
    /// When `otherwise` does not have one value per parameter of the structure.
    #[must_use]
    pub fn values(&self, structure: &Structure, otherwise: &[f64]) -> Vec<f64> {
        assert_eq!(otherwise.len(), structure.parameters.len(), "one value per parameter");
        let held = |name: &str| self.held.iter().find(|h| h.name == name).map(|h| h.value);
        structure
            .parameters
            .iter()
            .zip(otherwise)
            .map(|(name, &o)| self.value(name).or_else(|| held(name)).unwrap_or(o))
            .collect()
    }
    /// Values of a plant with all that was found ([`DataSet::plant_in`]), but those of a coefficient's own data where it has such.
    #[must_use]
    pub fn values_of(&self, coefficient: Coefficient, aero: &Aero) -> Vec<f64> {
        // Side and normal force have their parameters together, under the latter.
        let label = if coefficient == Coefficient::CY { Coefficient::CN } else { coefficient }.name();
        let own = |(name, value): (&String, &f64)| self.get(label, name).map_or(*value, |p| p.estimate);
        aero.structure.parameters.iter().zip(&aero.values).map(own).collect()
    }
    /// Value of one parameter, over all coefficients that give it.
    #[must_use]
    pub fn value(&self, name: &str) -> Option<f64> {
        let all = || self.parameters.iter().filter(|p| p.name == name);
        let total: f64 = all().map(weight).sum();
        (total > 0.0).then(|| all().map(|p| weight(p) / total * p.estimate).sum())
    }
}

/// Weight of an estimate in a mean. Exact data may have a zero standard error; it then counts like rounding.
fn weight(p: &Estimate) -> f64 {
    1.0 / p.std_error.max(1.0e-12 * p.estimate.abs()).max(f64::MIN_POSITIVE.sqrt()).powi(2)
}

#[cfg(test)]
mod tests;
