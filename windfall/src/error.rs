//! windfall: what can go wrong, whichever room it is from. Out: one enum, and of which kind an error is.

use windfall_discover::DiscoverError;
use windfall_discover::statistics::StatisticsError;
use windfall_pid::PidError;
use windfall_replay::ReplayError;
use windfall_scenarios::{FindError, ReadError, StoreError, WriteError};
use windfall_sim::SimError;
use windfall_study::StudyError;
use windfall_verify::VerifyError;

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Whose fault an error is.
///
/// ```
/// use windfall::ErrorKind;
/// assert_eq!(windfall::hold("Cl_0").expect_err("no value").kind(), ErrorKind::Input);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// Bad input: a file, a request, a number that cannot be flown.
    Input,
    /// The numbers failed: a flight departed, a search has no answer.
    Numerical,
    /// Somebody asked for an end.
    Interrupted,
}

/// Why a verb gave no result. Messages say where, what, the value, what is allowed and what to try.
///
/// ```
/// use windfall::prelude::*;
/// let no = Scenario::bundled("sage-pertubed").expect_err("misspelt").to_string();
/// assert!(no.contains("sage-perturbed"), "{no}");
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file is wrong.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// No campaigns where they were looked for.
    #[error(transparent)]
    Find(#[from] FindError),
    /// The folder of a study, or of many campaigns, is in the way.
    #[error(transparent)]
    Store(StoreError),
    /// A flight of a scenario cannot be flown, or failed.
    #[error("flight {name}: {error}")]
    Flight {
        /// Which.
        name: String,
        /// Why.
        error: SimError,
    },
    /// A run cannot be flown again.
    #[error(transparent)]
    Simulate(#[from] SimError),
    /// A campaign cannot be identified.
    #[error(transparent)]
    Identify(#[from] PidError),
    /// A run cannot be flown again, or there is none.
    #[error(transparent)]
    Replay(ReplayError),
    /// A campaign cannot be closed, or not be identified as it is ordered.
    #[error(transparent)]
    Discover(DiscoverError),
    /// A study cannot be drawn.
    #[error(transparent)]
    Study(StudyError),
    /// The program cannot be checked.
    #[error(transparent)]
    Verify(VerifyError),
    /// Published statistics cannot be closed against.
    #[error(transparent)]
    Statistics(StatisticsError),
    /// A request asks for what cannot be.
    #[error("{0}")]
    Request(String),
    /// A folder without any result.
    #[error("{folder}: holds no result; looked for {known}; try: the --out folder of another command")]
    NoResult {
        /// The folder.
        folder: String,
        /// What was looked for.
        known: String,
    },
    /// A file that has the name of a result and is none.
    #[error("{path}: is not the result of its name: it lacks {lacking}; try: the file that the command wrote, unchanged")]
    NotAResult {
        /// The file.
        path: String,
        /// Keys that it lacks.
        lacking: String,
    },
    /// The stopping rule of a study asks for what is not there.
    #[error("[stop] column = \"{column}\": is no column of numbers or flags of this study; try: one of {columns}")]
    NoColumn {
        /// What was asked for.
        column: String,
        /// What there is.
        columns: String,
    },
    /// Part of a number that the study does not have.
    #[error("part {part} is not one of the study's {parts}")]
    NoPart {
        /// What was asked for.
        part: u64,
        /// How many there are.
        parts: u64,
    },
    /// Somebody asked for an end of a study, or of many campaigns.
    #[error("interrupted; what was finished is kept; try: --resume to go on")]
    Interrupted,
}

impl Error {
    /// Whose fault it is.
    #[must_use]
    pub fn kind(&self) -> ErrorKind {
        match self {
            // A number that cannot be flown, or an atmosphere that ends too soon, is bad input, the rest is numerical.
            Self::Flight { error, .. } | Self::Simulate(error)
                if !matches!(error, SimError::Setup { .. } | SimError::OutsideAtmosphere { .. }) =>
            {
                ErrorKind::Numerical
            }
            Self::Identify(PidError::NoAnswer { .. }) => ErrorKind::Numerical,
            Self::Interrupted => ErrorKind::Interrupted,
            _ => ErrorKind::Input,
        }
    }
}

impl From<ReplayError> for Error {
    fn from(error: ReplayError) -> Self {
        match error {
            ReplayError::Identify(e) => Self::Identify(e),
            ReplayError::Simulate(e) => Self::Simulate(e),
            other => Self::Replay(other),
        }
    }
}

impl From<DiscoverError> for Error {
    fn from(error: DiscoverError) -> Self {
        match error {
            DiscoverError::Identify(e) => Self::Identify(e),
            DiscoverError::Simulate(e) => Self::Simulate(e),
            DiscoverError::Replay(e) => e.into(),
            other => Self::Discover(other),
        }
    }
}

impl From<StudyError> for Error {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Identify(e) => Self::Identify(e),
            StudyError::Simulate(e) => Self::Simulate(e),
            StudyError::Replay(e) => e.into(),
            StudyError::Discover(e) => e.into(),
            other => Self::Study(other),
        }
    }
}

impl From<VerifyError> for Error {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Identify(e) => Self::Identify(e),
            VerifyError::Simulate(e) => Self::Simulate(e),
            VerifyError::Replay(e) => e.into(),
            other => Self::Verify(other),
        }
    }
}

impl From<StoreError> for Error {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Write(e) => Self::Write(e),
            other => Self::Store(other),
        }
    }
}

impl From<StatisticsError> for Error {
    fn from(error: StatisticsError) -> Self {
        match error {
            StatisticsError::Simulate(error) => Self::Flight { name: "of the declared model".to_owned(), error },
            other => Self::Statistics(other),
        }
    }
}
