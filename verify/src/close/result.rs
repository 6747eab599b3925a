//! verify: the result of closing, in the words of the contract's close.json. In: numbers. Out: serialisable rows.

use crate::resimulate::{HoldOut, Statistic, TrajectoryError};
use crate::trace::Candidate;
use serde::{Deserialize, Serialize};

/// What closing concludes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing beyond noise.
    Consistent,
    /// An effect of the catalogue was found and added.
    Effect,
    /// A residual beyond noise that no effect of the catalogue accounts for.
    Unexplained,
}

/// Residual of one channel against noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelResidual {
    /// Coefficient, or axis for a point mass.
    pub channel: String,
    /// rms of the residual in the band used.
    pub rms: f64,
    /// rms that sensor noise alone would leave.
    pub expected_rms: f64,
    /// Probability of as much or more from noise alone.
    pub p_value: f64,
}

/// Residuals of all channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Rows.
    pub per_channel: Vec<ChannelResidual>,
}

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
}

impl ParameterLine {
    pub(crate) fn new(coefficient: &str, name: &str, estimate: f64, std_error: f64, unit: &str) -> Self {
        let std_error = std_error.is_finite().then_some(std_error);
        Self {
            coefficient: coefficient.to_owned(),
            name: name.to_owned(),
            estimate,
            std_error,
            ci95: std_error.map(|s| [estimate - 1.96 * s, estimate + 1.96 * s]),
            rse_percent: std_error.map(|s| 100.0 * s / estimate.abs()),
            unit: unit.to_owned(),
        }
    }
}

/// An effect that was added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectLine {
    /// Family.
    pub family: String,
    /// Its numbers.
    pub parameters: Vec<ParameterLine>,
    /// Chance of such a find anywhere in the catalogue from noise alone.
    pub p_value: f64,
    /// Families that these data cannot tell from it.
    pub rivals: Vec<String>,
    /// Gain of log-likelihood on runs not used; none for an effect that lives in one run.
    pub held_out_gain: Option<f64>,
    /// What happens.
    pub physics: String,
    /// Where that is from.
    pub source: String,
    /// Additional run that would separate it from its rivals.
    pub separate_by: String,
}

/// A family as weighed in the first round.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateLine {
    /// Family.
    pub family: String,
    /// Twice the gain of log-likelihood by one step.
    pub score: f64,
    /// Chance of it, corrected for the forms tried.
    pub p_value: f64,
}

impl CandidateLine {
    pub(crate) fn of(c: &Candidate) -> Self {
        Self { family: c.instance.effect.family.to_owned(), score: c.statistic, p_value: c.p_value }
    }
}

/// How large a family that was not found could still be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    /// Family.
    pub family: String,
    /// Parameter.
    pub parameter: String,
    /// Size that it stays under with 95 % confidence.
    pub upper95: f64,
    /// Unit.
    pub unit: String,
}

/// A residual that no family accounts for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unexplained {
    /// Channel.
    pub channel: String,
    /// What it varies with, how much, at which frequency.
    pub description: String,
}

/// Declared parameter before and after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shift {
    /// Name.
    pub name: String,
    /// With the declared model.
    pub before: f64,
    /// With the effects added.
    pub after: f64,
    /// Standard error after.
    pub std_error_after: f64,
}

/// Errors on runs that were not used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Force residual over mass, body axes, m/s².
    pub specific_force_rms: Option<[f64; 3]>,
    /// Moment residual over inertia, body axes, rad/s².
    pub specific_moment_rms: Option<[f64; 3]>,
    /// Re-simulated trajectory against the measured one.
    pub trajectory: Option<TrajectoryError>,
    /// Position error of point masses, m.
    pub position_rms_m: Option<f64>,
    /// Table 5.6's statistics.
    pub statistics: Vec<Statistic>,
    /// Log-likelihood of the runs, up to a constant of the data.
    pub log_likelihood: Option<f64>,
}

impl HeldOut {
    pub(crate) fn of_tunnel(h: HoldOut, log_likelihood: Option<f64>) -> Self {
        Self {
            specific_force_rms: Some(h.specific_force_rms),
            specific_moment_rms: Some(h.specific_moment_rms),
            position_rms_m: Some(h.trajectory.position_rms_m),
            trajectory: Some(h.trajectory),
            statistics: h.statistics,
            log_likelihood,
        }
    }
    pub(crate) fn of_points(rms_m: Option<f64>, log_likelihood: Option<f64>) -> Self {
        Self {
            specific_force_rms: None,
            specific_moment_rms: None,
            trajectory: None,
            position_rms_m: rms_m,
            statistics: Vec::new(),
            log_likelihood,
        }
    }
}

/// One side of before and after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct After {
    /// Declared parameters.
    pub parameters: Vec<ParameterLine>,
    /// On runs not used; none when the campaign has none.
    pub hold_out: Option<HeldOut>,
}

/// The closed loop: `close.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Closing {
    /// Campaign.
    pub campaign: String,
    /// Conclusion.
    pub verdict: Verdict,
    /// Residual of the declared model.
    pub residual: Residuals,
    /// Residual with the effects added.
    pub residual_after: Residuals,
    /// Effects in the order added.
    pub effects: Vec<EffectLine>,
    /// Every family as weighed against the declared model.
    pub candidates: Vec<CandidateLine>,
    /// How large what was not found could be.
    pub bounds: Vec<Bound>,
    /// What no family accounts for.
    pub unexplained: Vec<Unexplained>,
    /// How declared parameters moved.
    pub shifts: Vec<Shift>,
    /// With the declared model.
    pub before: After,
    /// With the effects added.
    pub after: After,
    /// Stated chance of naming an effect in a campaign without one, per round.
    pub false_alarm_rate: f64,
}
