//! discover: what can go wrong. Out: one enum with the place, the value and what to try.

use thiserror::Error;
use windfall_pid::{PidError, SearchKind, StopReason};
use windfall_replay::ReplayError;
use windfall_sim::SimError;

/// Errors of this room.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DiscoverError {
    /// The identifier failed.
    #[error(transparent)]
    Identify(#[from] PidError),
    /// The simulator failed.
    #[error(transparent)]
    Simulate(#[from] SimError),
    /// A run cannot be flown again, or there is none.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A tunnel run where a flight of a point mass is needed.
    #[error("run `{run}` has attitude; this needs flights of a point mass, with t_s and positions only")]
    NotPoint {
        /// Name of the run.
        run: String,
    },
    /// A track with too few samples.
    #[error("run `{run}` has a track of {samples} samples; its initial state takes two per axis: give at least {needed}")]
    ShortTrack {
        /// Name of the run.
        run: String,
        /// Samples.
        samples: usize,
        /// Needed.
        needed: usize,
    },
    /// A track that the declared model cannot follow.
    #[error("run `{run}` cannot be flown by the declared model; check the units of its {numbers}")]
    NotFlown {
        /// Name of the run.
        run: String,
        /// Declared numbers that its flight depends on.
        numbers: &'static str,
    },
    /// The search for what a campaign lacks found no model that can be followed.
    #[error(
        "{campaign}: no model that can be followed was found: {words}; try starting values nearer to the truth, or leave out the run"
    )]
    NoEnd {
        /// Campaign.
        campaign: String,
        /// Why, in words.
        words: String,
    },
    /// A fit that has no answer.
    #[error("the declared model cannot be fitted to `{campaign}`: {}; check units, or declare fewer parameters", .stop.words(SearchKind::Tracks))]
    Fit {
        /// Name of the campaign.
        campaign: String,
        /// Why.
        stop: StopReason,
    },
    /// A closing without the plants that it found.
    #[error(
        "{campaign}: this closing was read from a file, which does not hold the plants that it found; close the campaign again to have its \
         figures and tracks"
    )]
    NoSides {
        /// Campaign.
        campaign: String,
    },
    /// Knowledge of a parameter that the structure does not have.
    #[error("{what} {name}: no parameter of this structure; parameters: {allowed}")]
    UnknownParameter {
        /// What was asked for: `hold`, `tie` or `prior`.
        what: &'static str,
        /// The parameter.
        name: String,
        /// Parameters of the structure.
        allowed: String,
    },
    /// A parameter held at two values.
    #[error("hold {name}: given twice; give one value")]
    HeldTwice {
        /// The parameter.
        name: String,
    },
}
