//! study: what can go wrong. Out: one enum with the value and what to try.

use thiserror::Error;
use windfall_discover::DiscoverError;
use windfall_pid::PidError;
use windfall_replay::ReplayError;
use windfall_sim::SimError;

/// Errors of this room.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The identifier failed.
    #[error(transparent)]
    Identify(#[from] PidError),
    /// The simulator failed.
    #[error(transparent)]
    Simulate(#[from] SimError),
    /// A run cannot be flown again.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A draw cannot be closed.
    #[error(transparent)]
    Discover(#[from] DiscoverError),
    /// A method that does not exist.
    #[error("there is no method `{name}`; try: {allowed}")]
    UnknownMethod {
        /// Its name.
        name: String,
        /// Methods that there are.
        allowed: String,
    },
}
