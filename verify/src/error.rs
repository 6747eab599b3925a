//! verify: what can go wrong. Out: one enum with the place, the value and what to try.

use thiserror::Error;
use windfall_pid::PidError;
use windfall_sim::SimError;

/// Errors of this room.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The identifier failed.
    #[error(transparent)]
    Identify(#[from] PidError),
    /// The simulator failed.
    #[error(transparent)]
    Simulate(#[from] SimError),
    /// A point-mass run where a tunnel run is needed.
    #[error("run `{run}` has no attitude; this needs tunnel runs with R_x, R_y, R_z")]
    NotTunnel {
        /// Name of the run.
        run: String,
    },
    /// A tunnel run where a flight of a point mass is needed.
    #[error("run `{run}` has attitude; this needs flights of a point mass, with t_s and positions only")]
    NotPoint {
        /// Name of the run.
        run: String,
    },
    /// A track with too few samples.
    #[error("run {run} has a track of {samples} samples; its initial state takes two per axis: give at least {needed}")]
    ShortTrack {
        /// Index of the run.
        run: usize,
        /// Samples.
        samples: usize,
        /// Needed.
        needed: usize,
    },
    /// A track that the declared model cannot follow.
    #[error("run {run} cannot be flown by the declared model (mass, diameter, density, CD); check their units")]
    NotFlown {
        /// Index of the run.
        run: usize,
    },
    /// A run with too few samples.
    #[error("run {run} has {samples} samples, fewer than the {needed} that its smoothing windows need; use a longer window_s")]
    TooShort {
        /// Index of the run.
        run: usize,
        /// Samples.
        samples: usize,
        /// Needed.
        needed: usize,
    },
    /// No run to work on.
    #[error("the campaign has no run with use = \"{what}\"; mark at least one")]
    NoRuns {
        /// The use that is missing.
        what: &'static str,
    },
    /// A fit that has no answer.
    #[error("the declared model cannot be fitted to `{campaign}`: {reason}; check units, or declare fewer parameters")]
    Fit {
        /// Name of the campaign.
        campaign: String,
        /// Why.
        reason: &'static str,
    },
    /// A method that does not exist.
    #[error("there is no method `{name}`; try: {allowed}")]
    UnknownMethod {
        /// Its name.
        name: String,
        /// Methods that there are.
        allowed: String,
    },
    /// Copies of a campaign that all failed.
    #[error("no two copies of the campaign could be identified: {reason}; try another method, or windfall close")]
    NoCopies {
        /// What the first said.
        reason: String,
    },
    /// An identification that cannot be drawn from.
    #[error("the identification has no covariance to draw parameters from; identify the campaign again with this version")]
    NoCovariance,
    /// An identification without result.
    #[error("the identification has no data set; identify the campaign again")]
    NoDataSet,
    /// An estimate that the campaign's structure does not know.
    #[error(
        "the identification has parameter `{name}`, which is not one of the campaign's structure: {allowed}; give the identification of this campaign"
    )]
    UnknownParameter {
        /// The parameter.
        name: String,
        /// Parameters of the structure.
        allowed: String,
    },
}
