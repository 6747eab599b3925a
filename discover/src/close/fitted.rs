//! discover: rows of `close.json` on numbers that were fitted: estimates, coefficients at the settings flown, and what would do in place of a declared
//! parameter. In: numbers. Out: serialisable rows.

use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Parameter};
use windfall_pid::{ci95, relative_percent};

/// One estimated number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterLine {
    /// Coefficient; empty for effects.
    pub coefficient: String,
    /// Name.
    pub name: String,
    /// Estimate.
    pub estimate: f64,
    /// Standard error; none when the data do not give one.
    pub std_error: Option<f64>,
    /// 95 % interval.
    pub ci95: Option<[f64; 2]>,
    /// Relative standard error, %.
    pub rse_percent: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Whether the estimate lies at an end of what is possible or plausible: the runs may ask for more.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub at_end: bool,
    /// Of a declared parameter: the value in the campaign file, from which it was fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub declared: Option<f64>,
    /// Standard uncertainty of that value, where the campaign states one; without, nothing is believed of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub declared_std: Option<f64>,
}

impl ParameterLine {
    pub(crate) fn new(coefficient: &str, name: &str, estimate: f64, std_error: f64, unit: &str) -> Self {
        let std_error = std_error.is_finite().then_some(std_error);
        Self {
            coefficient: coefficient.to_owned(),
            name: name.to_owned(),
            estimate,
            std_error,
            ci95: std_error.map(|s| ci95(estimate, s)),
            rse_percent: std_error.and_then(|s| relative_percent(s, estimate)),
            unit: unit.to_owned(),
            at_end: false,
            declared: None,
            declared_std: None,
        }
    }
    /// Of parameter `i` of a campaign's structure.
    pub(crate) fn of_declared(campaign: &Campaign, i: usize, estimate: f64, std_error: f64) -> Self {
        let structure = &campaign.plant.aero.structure;
        let coefficient = structure.contributions.iter().find(|c| c.parameter == i).map_or("", |c| c.coefficient.name());
        let prior = campaign.knowledge.priors.iter().find(|(k, _)| *k == i).map(|(_, std)| *std);
        let line = Self::new(coefficient, &structure.parameters[i], estimate, std_error, "-");
        Self { declared: Some(campaign.plant.aero.values[i]), declared_std: prior, ..line }
    }
    /// The same of a parameter of an effect, with whether it lies at an end of its range.
    pub(crate) fn of_effect(p: &Parameter, estimate: f64, std_error: f64, at_end: bool) -> Self {
        Self { at_end, ..Self::new("", &p.name, estimate, std_error, p.unit) }
    }
    /// How far a declared parameter was moved from its value in the file, in standard errors of that difference: of its estimate, and of
    /// the value where it has an uncertainty.
    #[must_use]
    pub fn moved(&self) -> Option<f64> {
        let (declared, std) = (self.declared?, self.std_error?);
        Some((self.estimate - declared) / std.hypot(self.declared_std.unwrap_or(0.0))).filter(|x| x.is_finite())
    }
}

/// A coefficient that follows settings of the runs, at settings that were flown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlownCoefficient {
    /// Name: that of the effect's parameter.
    pub name: String,
    /// Whether the declared part is in it; else it is what the effect adds.
    pub in_all: bool,
    /// Where it is least.
    pub least: FlownValue,
    /// Where it is most.
    pub most: FlownValue,
}

/// A coefficient at the settings of one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlownValue {
    /// The run.
    pub run: String,
    /// Estimate.
    pub estimate: f64,
    /// Standard error.
    pub std_error: f64,
}

/// A declared parameter that the runs moved, and other numbers that would do as well in its place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FittedInstead {
    /// The parameter.
    pub parameter: String,
    /// What would do as well, the likeliest first.
    pub instead: Vec<Instead>,
}

/// A number that would do as well as a declared parameter that was moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instead {
    /// Key of the campaign file, or family and parameter of an effect.
    pub key: String,
    /// What it is.
    pub meaning: String,
    /// Value in the campaign file; zero of an effect.
    pub declared: f64,
    /// Value that the runs ask for.
    pub estimate: f64,
    /// Unit.
    pub unit: String,
    /// By how much the log-likelihood is less than with the parameter fitted.
    pub lost: f64,
}

impl FlownCoefficient {
    /// What it is, in words.
    #[must_use]
    pub fn words(&self) -> String {
        format!("{} at the settings flown{}", self.name, if self.in_all { ", with the declared part" } else { "" })
    }
}
