//! pid: how a search ended. One enum for every search of parameters, states and effects, with its words and what to try next.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Why a search ended. Which column a direct least-squares solution lacks is no stop of a search: see
/// [`crate::regress::RegressionOutcome`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum StopReason {
    /// What is left to go is below the search's own share of a standard error, or a further step would gain next to nothing.
    Converged,
    /// Iterations used up, the last step below a tenth of a standard error.
    Nearly,
    /// Iterations used up; what is reported, if anything, is the best found.
    Iterations,
    /// No step, however short, lowers the misfit (raises the likelihood).
    NoDescent,
    /// The model cannot fly through the record: airspeed vanishes, the nose is horizontal, or numbers overflow.
    FlightFails,
    /// The information has no inverse: a parameter is not excited beyond noise.
    NotExcited,
    /// The scale of a gust left its range.
    ScaleAway,
    /// A residual is not a number.
    NotFinite,
    /// With the numbers reached the model departs from its run.
    Departs {
        /// Index of the run.
        run: usize,
        /// Time in it, s.
        t_s: f64,
    },
}

/// Which search ended: each has something else to try next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SearchKind {
    /// No search: what the runs can tell at the start.
    Identifiability,
    /// No search: information of planned runs.
    Plan,
    /// Output error.
    OutputError,
    /// Filter error.
    FilterError,
    /// Joint fit of tracks.
    Tracks,
    /// Likelihood of tunnel runs under a model with effects.
    Likelihood,
}

impl SearchKind {
    /// Name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Identifiability => "identifiability",
            Self::Plan => "plan",
            Self::OutputError => crate::Method::OutputError.name(),
            Self::FilterError => crate::Method::FilterError.name(),
            Self::Tracks => "tracks",
            Self::Likelihood => "likelihood",
        }
    }
}

impl StopReason {
    /// In words, with what to try after that search.
    #[must_use]
    pub fn words(self, search: SearchKind) -> Cow<'static, str> {
        use SearchKind::{FilterError, Likelihood, Tracks};
        Cow::Borrowed(match (self, search) {
            (Self::Departs { run, t_s }, _) => return Cow::Owned(format!("with these parameters {}", departure(run, t_s))),
            (Self::Converged, _) => "converged",
            (Self::Nearly, _) => "converged to a tenth of a standard error",
            (Self::Iterations, Likelihood) => "the number of steps allowed is used up",
            (Self::Iterations, Tracks) => "the iterations did not settle",
            (Self::Iterations, FilterError) => {
                "iterations used up while parameters still moved: declare fewer parameters, hold some, or try windfall close"
            }
            (Self::Iterations, _) => {
                "iterations used up while parameters still moved: declare fewer parameters, hold some, or give priors; where the \
                 declared model's flights drift away from the record, take --method filter-error"
            }
            (Self::NoDescent, Likelihood) => "no shorter step raises the likelihood",
            (Self::NoDescent, FilterError) => {
                "no step makes these runs more likely, gusts and random moments allowed for: the declared model lacks more than that; \
                 try windfall close"
            }
            (Self::NoDescent, _) => {
                "no step lowers the misfit: flights of the declared model drift away from these runs; take --method filter-error, \
                 which lets them, and windfall close"
            }
            (Self::FlightFails, _) => {
                "the declared model cannot fly through the record (no airspeed or nose horizontal): check units, cut the window"
            }
            (Self::NotExcited, Tracks) => "a declared parameter is not excited beyond noise in these runs",
            (Self::NotExcited, _) => {
                "a parameter is not excited by these runs: add a run with larger angles or rates, or do not declare it"
            }
            (Self::ScaleAway, _) => "the scale of the gusts has no likeliest value",
            (Self::NotFinite, _) => "a state or residual is not a number under the declared model",
        })
    }
}

/// Where a model departs, in words: run by index, time in it.
fn departure(run: usize, t_s: f64) -> String {
    format!("the model departs at {t_s:.2} s of run {}", run + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results name the stop of an initial state's estimation so (`resimulation.json`).
    #[test]
    fn exact_names_of_results() {
        let names = [
            (StopReason::Converged, "\"converged\""),
            (StopReason::NoDescent, "\"no-descent\""),
            (StopReason::Iterations, "\"iterations\""),
            (StopReason::FlightFails, "\"flight-fails\""),
        ];
        for (stop, name) in names {
            assert_eq!(serde_json::to_string(&stop).expect("a name"), name);
            assert_eq!(serde_json::from_str::<StopReason>(name).expect("a stop"), stop);
        }
    }

    #[test]
    fn exact_runs_are_counted_from_one() {
        assert_eq!(departure(2, 3.456), "the model departs at 3.46 s of run 3");
    }

    /// What to try next is that search's own: filter error does not advise filter error.
    #[test]
    fn law_no_search_advises_itself() {
        for stop in [StopReason::Iterations, StopReason::NoDescent] {
            assert!(stop.words(SearchKind::OutputError).contains("--method filter-error"));
            assert!(!stop.words(SearchKind::FilterError).contains("--method"));
        }
    }
}
