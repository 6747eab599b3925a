//! pid: is a record what its campaign says it is? In: a campaign as declared. Out: nothing, or the fault with the change under which
//! the record makes sense.
//!
//! Looked at before anything is fitted, by what the samples themselves show and by the equations of motion: axes, signs, units, clock,
//! constants. Undeclared effects, noise of any kind and aerodynamics half to twice the declared ones are no faults; what is in doubt
//! passes. Runs without attitude are not looked at.
//!
//! Clocks of two recorders that differ are no fault either: the offset is named, and taken out of the record for all that follows.
//!
//! One file per kind of check: `clocks` and `aligned` on the recorders' clocks, `frozen` and `jump` on samples, `twice` on pairs of runs, `line` on the tether's geometry, `frames` on axes,
//! `contest` and `constants` on the balance of forces and moments, `size` on the declared body.

mod aligned;
mod balance;
mod change;
mod clocks;
mod closure;
mod constants;
mod contest;
mod frames;
mod frozen;
mod jump;
mod line;
mod motion;
mod size;
mod twice;

pub use closure::{Closure, closure};

use crate::PidError;
use clocks::Clocks;
pub use clocks::Lag;
use std::fmt;
use windfall_model::{Campaign, Data, Effect, Record};

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
/// forces and moments, then of one run alone.
pub fn plausible(campaign: &Campaign) -> Result<(), PidError> {
    looked(campaign, false).map(|_| ())
}

/// What the check of a record leaves to those that go on with it.
#[derive(Clone, Debug)]
pub struct Looked {
    /// The campaign with both recorders on one clock, where theirs differ; as it was otherwise.
    pub campaign: Campaign,
    /// The fault that was accepted, where there is one.
    pub accepted: Option<GrossFault>,
    /// How much later V_W was recorded than the pose, where that is not as declared.
    pub lag: Option<Lag>,
    /// The effect that makes the difference, with its strength.
    effect: Option<(&'static Effect, Vec<f64>)>,
    /// Lag that was taken out of the records, s.
    taken_s: f64,
}

impl Looked {
    /// The campaign on one clock whose plant has the difference of the clocks still: the declared model sees V_W as it was recorded, and the
    /// effect that makes up for it is where a search begins.
    #[must_use]
    pub fn with_difference(&self) -> Campaign {
        let mut campaign = self.campaign.clone();
        campaign.plant.sensors.wind_delay_s -= self.taken_s;
        campaign.knowledge.seen.extend(self.effect.clone());
        campaign
    }
    /// Lag of V_W that was taken out of the records, s; zero where the clocks agree.
    #[must_use]
    pub fn taken_s(&self) -> f64 {
        self.taken_s
    }
    /// What is to be said of the record, in sentences.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let accepted = self.accepted.iter().map(|f| format!("the record was accepted against the check of the record: {f}"));
        let lag = self.lag.iter().map(|lag| {
            let mend = self.effect.as_ref().map_or_else(String::new, |(e, v)| {
                let name = (e.parameters)(&[]).first().map_or_else(String::new, |p| p.name.clone());
                format!("declare [effects.{}] {name} = {:.3}, or ", e.family, v[0])
            });
            format!(
                "the clocks of pose and V_W differ: V_W is {}: {}; {mend}pair each pose with the VW_m_s that was recorded {:.3} s {side}",
                lag.words(),
                lag.evidence(),
                lag.lag_s.abs(),
                side = lag.side()
            )
        });
        accepted.chain(lag).collect()
    }
}

/// Looks at a campaign before anything is fitted: gross faults are refused or, where `accept` says so, accepted; clocks that differ are set
/// to one.
///
/// # Errors
/// As [`plausible`], but for a fault that is accepted.
pub fn looked(campaign: &Campaign, accept: bool) -> Result<Looked, PidError> {
    let runs = tunnel_runs(campaign);
    let records: Vec<&Record> = runs.iter().map(|r| r.1).collect();
    let declared_s = aligned::declared_lag_s(campaign);
    let lag = Clocks::new(&records, campaign.plant.environment.gravity_m_s2).offset(declared_s);
    let total_s = lag.map_or(declared_s, |l| l.lag_s);
    // A small declared delay stays as it is.
    let is_moved = lag.is_some() || clocks::is_far(declared_s);
    let moved = if is_moved { aligned::moved(campaign, total_s) } else { None };
    let as_recorded = fault(campaign);
    let gravity = campaign.plant.environment.gravity_m_s2;
    let found = match (&moved, as_recorded) {
        // What is wrong with the record on one clock, or nothing but the clock.
        (Some((on_one_clock, _)), found) => fault(on_one_clock).map(|other| found.unwrap_or(other)),
        (None, found) => found,
    };
    let found = found.or_else(|| clocks::apart(&runs, gravity, total_s));
    if let Some(fault) = found.clone().filter(|_| !accept) {
        return Err(PidError::Implausible { campaign: campaign.name.clone(), fault: Box::new(fault) });
    }
    // Beside a fault nothing is said of clocks.
    let (lag, moved) = if found.is_some() { (None, None) } else { (lag, moved) };
    let effect = lag.and_then(|l| aligned::effect_of(&campaign.plant, l.lag_s - declared_s));
    let (campaign, taken_s) = moved.unwrap_or_else(|| (campaign.clone(), 0.0));
    Ok(Looked { campaign, accepted: found, lag, effect, taken_s })
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
    let on_balance = || contest::fault(campaign, &instants, || frames::readings(&runs));
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
        .or_else(|| line::above(campaign, &runs))
        .or_else(|| in_one_run(campaign, &runs))
}

/// A reading that one run alone asks for: the others are what they say they are.
fn in_one_run(campaign: &Campaign, runs: &[(&str, &Record)]) -> Option<GrossFault> {
    if runs.len() < 2 {
        return None;
    }
    let stride = motion::stride(runs);
    runs.iter().find_map(|run| {
        let found = contest::fault(campaign, &motion::of_run(run.1, stride), || frames::readings(std::slice::from_ref(run)))?;
        Some(GrossFault { place: format!("run {}", run.0), ..found })
    })
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
