//! replay: what can go wrong. Out: one enum with the place, the value and what to try.

use thiserror::Error;
use windfall_pid::PidError;
use windfall_sim::SimError;

/// Errors of this room.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
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
    /// No run to work on.
    #[error("the campaign has no run with use = \"{what}\"; mark at least one")]
    NoRuns {
        /// The use that is missing.
        what: &'static str,
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
}
