//! discover: the result of closing, in the words of the contract's close.json. In: numbers. Out: serialisable rows.

use super::fitted::{FittedInstead, FlownCoefficient, ParameterLine};
use super::judged::{CheckLine, Finding, NotNamed};
use crate::DiscoverError;
use crate::residual::ChannelResidual;
use serde::{Deserialize, Serialize};
use windfall_model::{Measured, Pivot};
use windfall_pid::bandwidth::BandwidthLine;
use windfall_replay::{HoldOut, Statistic, TrajectoryError};

/// What closing concludes.
///
/// ```
/// use windfall_discover::close::Verdict;
/// assert_eq!(serde_json::to_string(&Verdict::Unexplained).expect("a word"), "\"unexplained\"");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Nothing beyond noise.
    Consistent,
    /// An effect of the catalogue was found, its form holds and every check passes.
    Effect,
    /// Something is left, or held-out runs contradict what was identified; effects that come near are listed all the same.
    Unexplained,
}

impl Verdict {
    /// Of what was named and what is left: an effect only where nothing is left.
    pub(crate) fn of(effects: &[EffectLine], unexplained: &[Unexplained]) -> Self {
        match (effects.is_empty(), unexplained.is_empty()) {
            (_, false) => Self::Unexplained,
            (false, true) => Self::Effect,
            (true, true) => Self::Consistent,
        }
    }

    /// As in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Effect => "effect",
            Self::Unexplained => "unexplained",
        }
    }
}

/// Residuals of all channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Rows.
    pub per_channel: Vec<ChannelResidual>,
}

/// An effect that was added.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectLine {
    /// Family.
    pub family: String,
    /// Its numbers.
    pub parameters: Vec<ParameterLine>,
    /// Coefficients of it that follow settings of the runs, at the settings flown; `parameters` has them at settings of zero, with slopes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub flown: Vec<FlownCoefficient>,
    /// Of what differs from run to run: what it is in each run identified on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_run: Vec<RunValue>,
    /// Chance of such a find anywhere in the catalogue from noise alone.
    pub p_value: f64,
    /// Probability that it is part of the set, given the data and the catalogue.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// Families that these data cannot tell from it.
    pub rivals: Vec<String>,
    /// Whether its form holds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<Form>,
    /// Gain of log-likelihood on runs not used; none for an effect that lives in one run.
    pub held_out_gain: Option<f64>,
    /// Of gusts that come in bursts: sizes over their mean that a twentieth and nineteen twentieths of the time are below. They are flown
    /// steady.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bursts: Option<[f64; 2]>,
    /// Of gusts of a band: whether it ends steeply at its edges (Chebyshev's third order) and not gently (Butterworth's second). They are
    /// flown gently.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub steep_edges: bool,
    /// What happens.
    pub physics: String,
    /// Where that is from.
    pub source: String,
    /// Additional run that would separate it from its rivals.
    pub separate_by: String,
}

/// What a number that differs from run to run is in one run, less what it is in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunValue {
    /// Name of the run.
    pub run: String,
    /// Name of the number.
    pub name: String,
    /// Its unit: `-` of a share of the number itself, else `m`.
    pub unit: String,
    /// Its departure.
    pub value: f64,
    /// Standard error of that.
    pub std_error: f64,
}

impl EffectLine {
    /// The run in which a number differs most from the common one, in standard errors.
    #[must_use]
    pub fn most_different(&self) -> Option<&RunValue> {
        let sure = |r: &RunValue| r.value.abs() / r.std_error;
        self.by_run.iter().max_by(|a, b| sure(a).total_cmp(&sure(b)))
    }

    /// Its numbers but coefficients at settings of zero, which are shown at the settings flown.
    pub fn shown_parameters(&self) -> impl Iterator<Item = &ParameterLine> {
        let at_zero = |p: &&ParameterLine| self.flown.iter().any(|f| f.name == p.name.trim_end_matches("_constant"));
        self.parameters.iter().filter(move |p| !at_zero(p))
    }
}

/// Whether the form of a named effect holds against generic alternatives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Form {
    /// False where something generic gains beside it.
    pub ok: bool,
    /// What was held against it.
    pub checks: Vec<FormCheck>,
}

/// One check of a form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FormCheck {
    /// What was tried.
    pub what: String,
    /// Odds of it against nothing, turned over; at most one.
    pub p_value: f64,
}

/// Noise of a channel, learnt beside declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseLine {
    /// Channel.
    pub channel: String,
    /// Declared standard deviation, in the channel's unit.
    pub declared_std: f64,
    /// Learnt standard deviation.
    pub learnt_std: f64,
    /// Correlation of the coloured part from one sample to the next; zero for white noise.
    pub colour: f64,
    /// Share of the coloured part in the variance.
    pub coloured_share: f64,
    /// Frequencies of lines that no load on the model makes, Hz.
    pub lines_hz: Vec<f64>,
    /// Samples that were missing, all runs.
    pub missing: usize,
    /// Innovations beyond five standard deviations.
    pub outliers: usize,
}

/// A declared constant with an uncertainty, found beside declared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstantLine {
    /// Key with component.
    pub key: String,
    /// Declared value.
    pub declared: f64,
    /// Its standard uncertainty.
    pub uncertainty: f64,
    /// Estimate.
    pub estimate: f64,
    /// Standard error; at most the uncertainty.
    pub std_error: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// A set of effects with its probability.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetLine {
    /// Families; none for the declared model. `something-else` is what no effect of the catalogue is: in every set where something is unexplained.
    pub families: Vec<String>,
    /// Given the data and the catalogue.
    pub probability: f64,
}

/// A family as weighed in the first round.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateLine {
    /// Family.
    pub family: String,
    /// Twice the gain of log-likelihood by one step.
    pub score: f64,
    /// Chance of it from noise alone, corrected for the number of families (Šidák 1967).
    pub p_value: f64,
}

/// How large a family that was not found could still be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectBound {
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

impl Shift {
    /// Of every declared parameter, in their order.
    pub(crate) fn between(before: Vec<ParameterLine>, after: Vec<ParameterLine>) -> Vec<Self> {
        let one = |(b, a): (ParameterLine, ParameterLine)| Self {
            name: b.name,
            before: b.estimate,
            after: a.estimate,
            std_error_after: a.std_error.unwrap_or(f64::NAN),
        };
        before.into_iter().zip(after).map(one).collect()
    }
}

/// rms differences of simulation and measurement over runs that were not used. A body without attitude has none of it and of rates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOutTrajectory {
    /// Angle of the rotation between measured and simulated attitude, deg.
    pub attitude_rms_deg: Option<f64>,
    /// Distance of the geometric origins, m; along the measured axes for a point mass.
    pub position_rms_m: f64,
    /// Length of the difference of body rates, both smoothed alike, deg/s.
    pub rate_rms_deg_s: Option<f64>,
}

impl HeldOutTrajectory {
    fn of_tunnel(t: &TrajectoryError) -> Self {
        Self {
            attitude_rms_deg: Some(t.attitude_rms_deg),
            position_rms_m: t.position_rms_m,
            rate_rms_deg_s: Some(t.rate_rms_deg_s),
        }
    }
}

/// Errors on runs that were not used.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Force residual over mass, body axes, m/s². Of a body without attitude whose specific force was measured the rms over all samples and
    /// axes, in the first place.
    pub specific_force_rms: Option<[f64; 3]>,
    /// Moment residual over inertia, body axes, rad/s².
    pub specific_moment_rms: Option<[f64; 3]>,
    /// Re-simulated trajectory against the measured one; none where a run cannot be flown.
    pub trajectory: Option<HeldOutTrajectory>,
    /// What sensors' noise alone makes of `trajectory`, where a run is flown from its first samples: their noise grows along the flight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trajectory_of_noise: Option<HeldOutTrajectory>,
    /// Position error of point masses, m.
    pub position_rms_m: Option<f64>,
    /// Table 5.6's statistics.
    pub statistics: Vec<Statistic>,
    /// Log-likelihood of the runs, averaged over what identification leaves of the parameters, up to a constant of the data.
    pub log_likelihood: Option<f64>,
}

impl HeldOut {
    pub(crate) fn of_tunnel(h: HoldOut, log_likelihood: Option<f64>) -> Self {
        Self {
            specific_force_rms: Some(h.specific_force_rms),
            specific_moment_rms: Some(h.specific_moment_rms),
            position_rms_m: Some(h.trajectory.position_rms_m),
            trajectory: Some(HeldOutTrajectory::of_tunnel(&h.trajectory)),
            trajectory_of_noise: None,
            statistics: h.statistics,
            log_likelihood,
        }
    }
    /// Of poses of a rigid body: rms of the distance of positions, m, and of the angle of attitudes, rad.
    pub(crate) fn of_poses([position_m, attitude_rad]: [f64; 2], of_noise: [f64; 2], log_likelihood: Option<f64>) -> Self {
        let mut held = Self::of_points(Measured::Pose, position_m, None, log_likelihood);
        if let Some(t) = held.trajectory.as_mut() {
            t.attitude_rms_deg = Some(attitude_rad.to_degrees()).filter(|x| x.is_finite());
        }
        held.trajectory_of_noise = of_noise.iter().all(|x| x.is_finite()).then(|| HeldOutTrajectory {
            attitude_rms_deg: Some(of_noise[1].to_degrees()),
            position_rms_m: of_noise[0],
            rate_rms_deg_s: None,
        });
        held
    }
    /// Of a body without attitude: `rms` in the unit of what was measured. On a pivot the mass centre's error along its path is the
    /// angle's times the arm.
    pub(crate) fn of_points(measured: Measured, rms: f64, pivot: Option<Pivot>, log_likelihood: Option<f64>) -> Self {
        let rms = Some(rms).filter(|x| x.is_finite());
        let position_m = match measured {
            Measured::Position | Measured::Pose | Measured::PositionAndForce => rms,
            Measured::Angle => rms.map(|x| x * pivot.map_or(f64::NAN, |p| p.arm_m)),
            Measured::SpecificForce => None,
        };
        let attitude_rms_deg = rms.filter(|_| measured == Measured::Angle).map(f64::to_degrees);
        Self {
            specific_force_rms: rms.filter(|_| measured == Measured::SpecificForce).map(|x| [x, 0.0, 0.0]),
            specific_moment_rms: None,
            trajectory: position_m.map(|m| HeldOutTrajectory { attitude_rms_deg, position_rms_m: m, rate_rms_deg_s: None }),
            trajectory_of_noise: None,
            position_rms_m: position_m,
            statistics: Vec::new(),
            log_likelihood,
        }
    }
    /// The same with the rms of specific forces beside positions, m/s².
    pub(crate) fn with_specific_force(mut self, rms_m_s2: f64) -> Self {
        self.specific_force_rms = Some([rms_m_s2, 0.0, 0.0]).filter(|_| rms_m_s2.is_finite());
        self
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
    /// Conclusion: `effect` only where every form holds and every check passes.
    pub verdict: Verdict,
    /// The conclusion in words.
    #[serde(default)]
    pub finding: Finding,
    /// Absolute checks of runs identified on and held out.
    #[serde(default)]
    pub checks: Vec<CheckLine>,
    /// Why the declared model alone cannot be followed, where it cannot: `before` is then as `after`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub declared_departs: Option<String>,
    /// Whether noise is what runs scatter by, which may be more than the sensors': of poses, whose checks ask for what repeats.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub noise_is_scatter: bool,
    /// Runs that were taken as one flight, since one goes on where the other ended: their names, a text for each flight.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joined: Vec<String>,
    /// What the check of the record had to say: a fault that was accepted, clocks that differ. A sentence each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub record: Vec<String>,
    /// Runs and channels that were smoothed or resampled before their export, and the rate at which they are used.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bandwidth: Vec<BandwidthLine>,
    /// Where the search ended because all the work it may do was done: that, in passes over the runs. A likelier set may not have been tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unfinished_passes: Option<f64>,
    /// Whether the errors of `after` carry what is unexplained: how far it may have moved a parameter.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub errors_carry_unexplained: bool,
    /// Residual of the declared model.
    pub residual: Residuals,
    /// Residual with the effects added.
    pub residual_after: Residuals,
    /// Noise learnt beside noise declared.
    #[serde(default)]
    pub noise: Vec<NoiseLine>,
    /// Shape of the innovations, before and after; none for tracks of point bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub innovations: Vec<super::InnovationLine>,
    /// Constants found beside constants declared.
    #[serde(default)]
    pub constants: Vec<ConstantLine>,
    /// Sets of effects with all that is in them, most probable first.
    #[serde(default)]
    pub sets: Vec<SetLine>,
    /// Families of the most probable set that are not among `effects`, with the reason.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub not_named: Vec<NotNamed>,
    /// Effects in the order added.
    pub effects: Vec<EffectLine>,
    /// Every family as weighed against the declared model.
    pub candidates: Vec<CandidateLine>,
    /// How large what was not found could be.
    pub bounds: Vec<EffectBound>,
    /// What no family accounts for.
    pub unexplained: Vec<Unexplained>,
    /// How declared parameters moved.
    pub shifts: Vec<Shift>,
    /// Declared parameters that the runs moved beyond their error, with what would do as well.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instead: Vec<FittedInstead>,
    /// With the declared model.
    pub before: After,
    /// With the effects added.
    pub after: After,
    /// Static coefficients at the points of the campaign's wind-tunnel tests, `before` and `after`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wind_tunnel: Vec<crate::WindTunnelLine>,
    /// Level of the tests for lines in spectra and, of tracks, for what is left of the runs identified on.
    pub false_alarm_rate: f64,
    /// The plants that the figures of `before` and `after` are of; none of a closing that was read from a file.
    #[serde(skip)]
    pub sides: Option<super::Sides>,
}

impl Closing {
    /// The plants of both sides.
    ///
    /// # Errors
    /// A closing that was read from a file, which does not hold them.
    pub(super) fn plants(&self) -> Result<&super::Sides, DiscoverError> {
        self.sides.as_ref().ok_or_else(|| DiscoverError::NoSides { campaign: self.campaign.clone() })
    }
    /// Whether it is of tracks, and not of tunnel runs: these have innovations.
    #[must_use]
    pub fn is_of_tracks(&self) -> bool {
        self.innovations.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contract's `hold_out.trajectory` of a body without attitude: what there is of it, and back; nothing where it cannot be flown.
    #[test]
    fn law_a_point_mass_has_a_trajectory_too() {
        let held = HeldOut::of_points(Measured::Position, 0.012, None, Some(-3.0));
        let json = serde_json::to_value(&held).expect("serialises");
        let expected = serde_json::json!({"attitude_rms_deg": null, "position_rms_m": 0.012, "rate_rms_deg_s": null});
        assert_eq!(json["trajectory"], expected);
        assert_eq!(serde_json::from_value::<HeldOut>(json).expect("reads back"), held);
        assert_eq!(HeldOut::of_points(Measured::Position, f64::NAN, None, None).trajectory, None);
    }

    #[test]
    fn law_a_zero_has_no_relative_error() {
        let of = |estimate| ParameterLine::new("", "rms", estimate, 0.5, "m/s").rse_percent;
        assert_eq!((of(0.0), of(-2.0)), (None, Some(25.0)));
    }

    /// 1.959964 standard errors to either side; an angle on a pivot is the arm's times as far along the path.
    #[test]
    fn exact_interval_and_path_of_an_angle() {
        let [low, high] = ParameterLine::new("", "CD", 3.0, 0.5, "-").ci95.expect("an error");
        assert!((low - 2.020_018_007_5).abs() < 1e-12 && (high - 3.979_981_992_5).abs() < 1e-12, "{low} {high}");
        let pivot = Pivot { arm_m: 0.3, inertia_kg_m2: 1.0, viscous_n_m_s: 0.0, dry_n_m: 0.0 };
        let held = HeldOut::of_points(Measured::Angle, 0.02, Some(pivot), None);
        assert!((held.position_rms_m.expect("an arm") - 0.006).abs() < 1e-15);
        let angle_deg = held.trajectory.and_then(|t| t.attitude_rms_deg).expect("an angle");
        assert!((angle_deg - 3.6 / std::f64::consts::PI).abs() < 1e-12, "{angle_deg}");
    }
}
