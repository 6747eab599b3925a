//! pid: a run given twice. In: all runs of a campaign, whatever their use. Out: a fault with both names.
//!
//! A run under two names counts twice, and one that is also a hold-out says nothing of what was not fitted.

use super::{GrossFault, pose, quantile};
use std::collections::HashSet;
use windfall_model::Record;

/// Share of the shorter run's samples that are also the other's.
const SHARE: f64 = 0.5;
/// Fewest different samples that tell.
const FEWEST: usize = 20;
/// Two runs side by side are one when they differ by less than this share of their noise: two measurements of one motion would
/// differ by 1.41.
const OF_NOISE: f64 = 0.5;

/// The first pair of runs that are one.
pub(super) fn fault(runs: &[(&str, &Record)]) -> Option<GrossFault> {
    let sets: Vec<HashSet<[u64; 6]>> = runs.iter().map(|(_, r)| samples(r)).collect();
    for (i, a) in runs.iter().enumerate() {
        for (j, b) in runs.iter().enumerate().skip(i + 1) {
            let shared = shared(&sets[i], &sets[j]);
            let evidence = if shared >= SHARE {
                format!("{:.0} % of the poses of one are, number by number, in the other", 100.0 * shared)
            } else if alike(a.1, b.1) {
                "side by side they differ by less than their noise".to_owned()
            } else {
                continue;
            };
            return Some(GrossFault {
                place: format!("runs {} and {}", a.0, b.0),
                cause: "one run given twice".to_owned(),
                evidence,
                change: "name each run once, and hold out another than those that are identified on".to_owned(),
            });
        }
    }
    None
}

fn samples(r: &Record) -> HashSet<[u64; 6]> {
    (0..r.len()).map(|i| pose(r).map(|x| x[i].to_bits())).collect()
}

/// Share of the smaller set that is in the other.
fn shared(a: &HashSet<[u64; 6]>, b: &HashSet<[u64; 6]>) -> f64 {
    let (small, large) = if a.len() < b.len() { (a, b) } else { (b, a) };
    if small.len() < FEWEST {
        return 0.0;
    }
    small.iter().filter(|k| large.contains(*k)).count() as f64 / small.len() as f64
}

/// Whether two runs, laid side by side from their first samples, are one but for rounding.
fn alike(a: &Record, b: &Record) -> bool {
    let n = a.len().min(b.len());
    let step = a.interval_s();
    if n < 100 || (a.len().max(b.len()) > 2 * n) || (b.interval_s() - step).abs() > 1e-3 * step {
        return false;
    }
    pose(a).iter().zip(pose(b)).all(|(x, y)| {
        let apart: Vec<f64> = x.iter().zip(y).map(|(x, y)| (x - y).abs()).collect();
        // Second differences of white noise have a standard deviation of 2.45 of it; its median absolute value is 0.67 of that.
        let noise = quantile(x.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).collect(), 0.5) / (2.45 * 0.6745);
        quantile(apart, 0.9) < OF_NOISE * noise
    })
}

#[cfg(test)]
mod tests;
