//! verify: every check of the program's own truth, for `windfall verify`. In: checked bundled scenarios. Out: figure beside bound.
//!
//! Exact: closed forms and conservation laws. Published: printed numbers. Recovered: what was planted is found again. The thesis
//! method's own errors on the same run stand beside ours, without a bound: they are a result, not a failure.

mod descent;
mod error;
mod exact;
mod flown;
mod loops;
mod planet;
mod published;
mod recovered;

pub use error::VerifyError;

use serde::{Deserialize, Serialize};
use windfall_model::{Flight, Plant, Scenario};
use windfall_replay::ReplayError;

/// Scenarios that the checks fly.
#[derive(Clone, Copy, Debug)]
pub struct Setups<'a> {
    /// Thesis Appendix C: one exact run of the lander from α_T = 25°.
    pub appendix_c: &'a Scenario,
    /// An exact run in which a pole pushes the hovering lander over.
    pub pole_push: &'a Scenario,
    /// The same as Appendix C at full scale.
    pub full_scale: &'a Scenario,
    /// A campaign with sensor noise: runs to identify on and runs held out.
    pub combined: &'a Scenario,
}

/// What a check rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckKind {
    /// A closed form or a conservation law.
    Exact,
    /// A printed number.
    Published,
    /// Something planted.
    Recovered,
}

/// What came of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckVerdict {
    /// The figure is inside its bound.
    Pass,
    /// It is not.
    Fail,
    /// There is no bound: a result to look at.
    Shown,
}

/// Where a figure must be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    /// Lowest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// Highest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
}

impl Bound {
    fn at_most(high: f64) -> Self {
        Self { at_least: None, at_most: Some(high) }
    }
    /// Around a value, for a printed number half of its last digit either way.
    fn around(value: f64, half_digit: f64) -> Self {
        Self { at_least: Some(value - half_digit), at_most: Some(value + half_digit) }
    }
    fn contains(&self, figure: f64) -> bool {
        figure.is_finite() && self.at_least.is_none_or(|l| figure >= l) && self.at_most.is_none_or(|h| figure <= h)
    }
}

impl std::fmt::Display for Bound {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.at_least, self.at_most) {
            (Some(l), Some(h)) => write!(f, "{l:.6} to {h:.6}"),
            (Some(l), None) => write!(f, ">= {l:.3e}"),
            (None, Some(h)) => write!(f, "<= {h:.3e}"),
            (None, None) => f.write_str("none"),
        }
    }
}

/// One check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Short name, unique.
    pub id: String,
    /// What it rests on.
    pub kind: CheckKind,
    /// What is compared, in words.
    pub what: String,
    /// What was found.
    pub figure: f64,
    /// Its unit.
    pub unit: String,
    /// Where it must be.
    pub bound: Bound,
    /// Where the bound or the number comes from.
    pub source: String,
    /// The thesis' own figure, where it has one.
    pub thesis: Option<f64>,
    /// What came of it.
    pub verdict: CheckVerdict,
}

impl Check {
    fn new(
        kind: CheckKind,
        id: impl Into<String>,
        what: impl Into<String>,
        (figure, unit): (f64, &str),
        bound: Bound,
        source: &str,
    ) -> Self {
        let verdict = if bound == Bound::default() {
            CheckVerdict::Shown
        } else if bound.contains(figure) {
            CheckVerdict::Pass
        } else {
            CheckVerdict::Fail
        };
        Self {
            id: id.into(),
            kind,
            what: what.into(),
            figure,
            unit: unit.to_owned(),
            bound,
            source: source.to_owned(),
            thesis: None,
            verdict,
        }
    }
    fn beside(mut self, thesis: f64) -> Self {
        self.thesis = Some(thesis);
        self
    }
}

/// Runs every check, in a fixed order. The verdict of the program is no when any of them is [`CheckVerdict::Fail`].
///
/// # Errors
/// A flight or an identification that fails, or a scenario without flights.
pub fn checks(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let mut all = exact::rigid_body(setups)?;
    all.extend(exact::air(setups)?);
    all.extend(published::checks(setups)?);
    all.extend(planet::checks()?);
    all.extend(descent::checks()?);
    all.extend(recovered::checks(setups)?);
    all.extend(loops::checks(setups)?);
    Ok(all)
}

/// True when no check failed.
#[must_use]
pub fn all_pass(checks: &[Check]) -> bool {
    checks.iter().all(|c| c.verdict != CheckVerdict::Fail)
}

/// The first flight of a scenario.
fn first(scenario: &Scenario) -> Result<(&Plant, &Flight), VerifyError> {
    scenario.flights.first().map(|f| (&scenario.plant, f)).ok_or_else(|| ReplayError::NoRuns { what: "identify" }.into())
}

#[cfg(test)]
mod tests;
