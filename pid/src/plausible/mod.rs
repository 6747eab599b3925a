//! pid: is a record what its campaign says it is? In: a campaign as declared. Out: nothing, or the fault with the change under which
//! the record makes sense.
//!
//! Looked at before anything is fitted, by what the samples themselves show and by the equations of motion: axes, signs, units, clock,
//! constants. Undeclared effects, noise of any kind and aerodynamics half to twice the declared ones are no faults; what is in doubt
//! passes. Runs without attitude are not looked at.
//!
//! One file per kind of check: `frozen` and `jump` on samples, `twice` on pairs of runs, `line` on the tether's geometry, `frames` on axes,
//! `contest` and `constants` on the balance of forces and moments, `size` on the declared body.

mod balance;
mod change;
mod constants;
mod contest;
mod frames;
mod frozen;
mod jump;
mod line;
mod motion;
mod size;
mod twice;

use crate::PidError;
use std::fmt;
use windfall_model::{Campaign, Data, Record};

/// Why a record cannot be what its campaign says it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GrossFault {
    /// The run or runs, or the file's table, where it is.
    pub place: String,
    /// What is wrong, in a few words: `X points up`.
    pub cause: String,
    /// The change under which the record makes sense.
    pub change: String,
    /// What speaks for it, with numbers.
    pub evidence: String,
}

impl fmt::Display for GrossFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}; {}", self.place, self.cause, self.evidence, self.change)
    }
}

/// Looks for gross faults of a campaign's declared constants and of all its runs, whatever they are used for. Declared effects act with their
/// declared values.
///
/// # Errors
/// [`PidError::Implausible`] with the first fault found: on samples, then between runs, then in the geometry, then in the balance of
/// forces and moments.
pub fn plausible(campaign: &Campaign) -> Result<(), PidError> {
    match fault(campaign) {
        None => Ok(()),
        Some(fault) => Err(PidError::Implausible { campaign: campaign.name.clone(), fault: Box::new(fault) }),
    }
}

/// The first fault of a campaign, if it has one.
#[must_use]
pub fn fault(campaign: &Campaign) -> Option<GrossFault> {
    let campaign = &campaign.with_effects_in_plant();
    let runs = tunnel_runs(campaign);
    if runs.is_empty() {
        return None;
    }
    let instants = motion::instants(&runs);
    let on_balance = || contest::fault(campaign, &instants, frames::readings(&runs));
    // Angles about the wrong axes jump where they are not defined; the body does not.
    let singular = frames::is_singular(&runs);
    let first = if singular { on_balance() } else { None };
    first
        .or_else(|| runs.iter().find_map(|(name, r)| frozen::fault(name, r).or_else(|| jump::fault(name, r))))
        .or_else(|| twice::fault(&runs))
        .or_else(|| line::fault(campaign, &runs))
        .or_else(|| constants::celsius(&instants))
        .or_else(|| constants::gravity(campaign, &instants))
        .or_else(|| if singular { None } else { on_balance() })
        .or_else(|| constants::fault(campaign, &instants))
        .or_else(|| size::fault(campaign))
}

/// Names and records of the runs with attitude whose columns are complete; others are the reader's and the methods' to refuse.
fn tunnel_runs(campaign: &Campaign) -> Vec<(&str, &Record)> {
    let whole = |r: &Record| {
        let n = r.len();
        let full = |x: &[f64]| x.len() == n && x.iter().all(|v| v.is_finite());
        n >= FEWEST && full(&r.t_s) && r.channels().iter().all(|x| full(x)) && full(&r.ps_pa) && full(&r.ts_k)
    };
    let tunnel = campaign.runs.iter().filter_map(|run| match &run.data {
        Data::Tunnel(r) if whole(r) => Some((run.name.as_str(), r)),
        _ => None,
    });
    tunnel.collect()
}

/// Fewest samples of a run that is looked at.
const FEWEST: usize = 40;

/// Value at rank `share` (0 to 1) of the finite values; zero when there are none.
fn quantile(mut x: Vec<f64>, share: f64) -> f64 {
    x.retain(|v| v.is_finite());
    if x.is_empty() {
        return 0.0;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length")]
    let rank = ((x.len() - 1) as f64 * share).round() as usize;
    *x.select_nth_unstable_by(rank, f64::total_cmp).1
}

fn median(x: &[f64]) -> f64 {
    quantile(x.to_vec(), 0.5)
}

/// The six pose channels of a record: X, Y, Z in m, then R_x, R_y, R_z in rad.
fn pose(r: &Record) -> [&[f64]; 6] {
    let [x, y, z, a, b, c, _] = r.channels();
    [x, y, z, a, b, c]
}

/// A number with three digits, without trailing zeros.
fn short(x: f64) -> String {
    if x.is_finite() && x.abs() > 0.0 {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small count of digits")]
        let digits = (2 - x.abs().log10().floor() as i32).clamp(0, 9) as usize;
        let text = format!("{x:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{x}")
    }
}

#[cfg(test)]
mod tests;
