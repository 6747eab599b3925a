//! pid: how well the equations of motion close on the records of a campaign as it stands. In: a campaign. Out: what part of each group of
//! accelerations is left.

use super::balance::{GROUPS, balance};
use super::change::Act;
use super::{motion, tunnel_runs};
use windfall_model::Campaign;

/// One group of accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closure {
    /// Its name: vertical, lateral, roll, pitch and yaw.
    pub group: &'static str,
    /// Root mean square that the declared structure leaves, fitted to all runs.
    pub left: f64,
    /// Root mean square of the accelerations themselves.
    pub signal: f64,
    /// Unit of both: m/s2 or rad/s2.
    pub unit: &'static str,
}

/// What the declared structure, fitted to all runs, leaves of each group; empty where no run has an attitude or nothing can be fitted.
#[must_use]
pub fn closure(campaign: &Campaign) -> Vec<Closure> {
    let runs = tunnel_runs(campaign);
    let instants = motion::instants(&runs);
    let points: Vec<_> = instants.iter().map(|i| Act::Late(0).apply(i)).collect();
    let seconds: f64 = instants.iter().map(|i| i.span_s).sum();
    if points.is_empty() {
        return Vec::new();
    }
    let Some(found) = balance(&points, &campaign.plant, &campaign.declared, seconds, false) else { return Vec::new() };
    let one = |(g, group): (usize, &'static str)| Closure {
        group,
        left: found.left[g],
        signal: found.signal[g],
        unit: if g < 2 { "m/s2" } else { "rad/s2" },
    };
    GROUPS.into_iter().enumerate().map(one).collect()
}
