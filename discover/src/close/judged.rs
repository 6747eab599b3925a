//! discover: what a closing's verdict rests on, as data. In: numbers. Out: rows of `close.json`: checks, what is not named, the finding in words.

use serde::{Deserialize, Serialize};

/// What runs are used for, as checks have it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckedRuns {
    /// Identified on.
    Identify,
    /// Held out.
    HoldOut,
}

/// One absolute check: is what the model of `after` leaves noise?
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckLine {
    /// Run; empty for all runs of that use together.
    pub run: String,
    /// What its runs are used for.
    pub used: CheckedRuns,
    /// Channel; `parameters`: whether held-out runs ask for other values than those identified; `log-likelihood`: whether held-out runs are
    /// likelier with the effects than without.
    pub what: String,
    /// Mean square of what is left over that of noise; none where the model departs or nothing is squared.
    pub mean_square: Option<f64>,
    /// Probability of as much from noise alone; of `log-likelihood` odds.
    pub p_value: f64,
    /// Whether it passes, all checks together at 1 % (Holm 1979).
    pub ok: bool,
}

/// A family of the likeliest set, or of the fit, that the verdict does not name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NotNamed {
    /// Family.
    pub family: String,
    /// Probability of the sets that it is in.
    pub probability: f64,
    /// Why it is not named.
    pub reason: String,
}

/// How good the news is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Every check passes.
    Good,
    /// Something is left that nothing named accounts for.
    #[default]
    Open,
    /// Held-out runs contradict what was identified.
    Contradicted,
}

impl Level {
    /// As in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Open => "open",
            Self::Contradicted => "contradicted",
        }
    }
}

/// A closing's conclusion for people: terminal, page, JSON and Python show this and nothing else.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// How good the news is.
    pub level: Level,
    /// In a few sentences.
    pub sentence: String,
}
