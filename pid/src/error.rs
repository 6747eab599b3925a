//! pid: what can go wrong. In: the fault. Out: where, what, value, what is allowed, what to try.

use crate::stop::{SearchKind, StopReason};
use thiserror::Error;

/// Why a record or campaign cannot be identified.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PidError {
    /// A sample is NaN or infinite.
    #[error(
        "channel {channel}, sample {index}: the value is {value}; every sample must be finite: bridge or split the gap first"
    )]
    NotFinite {
        /// Channel name, as in the run file.
        channel: &'static str,
        /// Sample index from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A channel is not as long as the time column.
    #[error("channel {channel} has {found} samples but time has {expected}: every column of a run must have one length")]
    Length {
        /// Channel name.
        channel: &'static str,
        /// Its length.
        found: usize,
        /// Length of time.
        expected: usize,
    },
    /// Samples are not uniform in time.
    #[error(
        "sample {index}: time is {offset_s:.2e} s from the uniform grid of {interval_s:.6e} s, more than the 1 % allowed: resample \
         the run or split it at the gap"
    )]
    NotUniform {
        /// Sample index from 0.
        index: usize,
        /// Distance from the uniform grid or excess of the step, s.
        offset_s: f64,
        /// Mean interval, s.
        interval_s: f64,
    },
    /// Not enough samples.
    #[error("{what}: {samples} samples, at least {needed} needed: use a longer run or window, or declare fewer parameters")]
    TooFewSamples {
        /// Where: a run's or data set's name and the step.
        what: String,
        /// Samples there are.
        samples: usize,
        /// Samples needed.
        needed: usize,
    },
    /// A smoother's setting is out of range.
    #[error("smoother: {setting} = {value}, allowed: {allowed}")]
    Setting {
        /// Name of the setting.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The flow variables do not exist at a sample.
    #[error(
        "t = {t_s:.4} s: airspeed {speed_m_s} m/s and R_y = {ry_rad} rad: airspeed must be positive and |R_y| below 90°: cut the window there"
    )]
    NoFlow {
        /// Time, s.
        t_s: f64,
        /// Airspeed, m/s.
        speed_m_s: f64,
        /// Pitch angle, rad.
        ry_rad: f64,
    },
    /// A record or constant that is not what the campaign says it is.
    #[error("campaign {campaign}: {fault}; if the record is right as it stands, --accept-record goes on all the same")]
    Implausible {
        /// Campaign name.
        campaign: String,
        /// Where, what and under which change it makes sense.
        fault: Box<crate::plausible::GrossFault>,
    },
    /// No run can be used.
    #[error("campaign {campaign}: no tunnel run with use = \"identify\": mark at least one")]
    NoRuns {
        /// Campaign name.
        campaign: String,
    },
    /// The campaign's runs are tracks of a body without attitude, or of a rigid one in free flight.
    #[error(
        "campaign {campaign}, run {run}: a track of a body without attitude, or of a rigid one in free flight, is not identified by itself; \
         try: windfall close, which fits the declared parameters too (`after` in close.json)"
    )]
    PointMass {
        /// Campaign name.
        campaign: String,
        /// Run name.
        run: String,
    },
    /// No parameter can be estimated.
    #[error("campaign {campaign}: no declared parameter can be estimated: declare one that the runs excite")]
    NothingToEstimate {
        /// Campaign name.
        campaign: String,
    },
    /// The plant has something that the integrated methods leave out.
    #[error("the plant has {what}, which cannot be integrated here: use --method equation-error")]
    NotIntegrable {
        /// What it has.
        what: &'static str,
    },
    /// Knowledge that binds parameters together, or one beforehand, given to a method that regresses each coefficient by itself.
    #[error(
        "method {method} regresses each coefficient by itself and has no place for ties and priors: use --method output-error or \
         filter-error (values can be held)"
    )]
    NoPlace {
        /// Method.
        method: &'static str,
    },
    /// A way of smoothing, given to a method that chooses its own.
    #[error("method {method} finds its smoothing from the record itself: cut-offs, and no smoothing, are for --method thesis")]
    OwnSmoothing {
        /// Method.
        method: &'static str,
    },
    /// A setting names something that is not there.
    #[error("{what}: {name}: name a declared parameter of the structure")]
    Unknown {
        /// What was asked for.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// An estimate that the plant to be flown has no place for.
    #[error(
        "the identification has parameter `{name}`, which is not one of the campaign's structure: {allowed}; give the identification of \
         this campaign"
    )]
    OtherStructure {
        /// The parameter.
        name: String,
        /// Parameters of the structure.
        allowed: String,
    },
    /// An effect of an identification that the catalogue does not have, or with other numbers.
    #[error(
        "the identification has effect `{family}` with {numbers} numbers, which the catalogue does not have for a tunnel model; identify \
         again with this version"
    )]
    OtherEffect {
        /// Its family.
        family: String,
        /// Numbers that the file gives for it.
        numbers: usize,
    },
    /// A constant of an identification that the plant to be flown has no place for.
    #[error(
        "the identification has constant `{key}`, which the campaign's vehicle does not have; give the identification of this campaign"
    )]
    OtherConstant {
        /// Its key.
        key: String,
    },
    /// A search ended without an answer.
    #[error("campaign {campaign}, data set {set}, method {}: {}", .search.name(), .stop.words(*.search))]
    NoAnswer {
        /// Campaign name.
        campaign: String,
        /// Data set.
        set: String,
        /// Which search.
        search: SearchKind,
        /// Why it ended.
        stop: StopReason,
    },
}
