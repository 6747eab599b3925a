//! verify: what can go wrong. Out: one enum with the place, the value and what to try.

use thiserror::Error;
use windfall_pid::PidError;
use windfall_replay::ReplayError;
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
    /// A run cannot be flown again, or there is none.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A fall whose linear theory has no answer.
    #[error("{scenario}: no terminal speed; check mass, reference area and CA")]
    NoTerminalSpeed {
        /// The scenario.
        scenario: String,
    },
}
