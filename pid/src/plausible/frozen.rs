//! pid: a pose that stands still or comes again. In: a record. Out: a fault with the place and its length.
//!
//! Two measured samples never agree in all six numbers while the model moves; a stretch that does was not measured.

use super::{GrossFault, pose, quantile};
use std::collections::HashMap;
use windfall_model::Record;

/// Shortest stretch that counts, s and samples: shorter ones are dropouts that a recorder filled with its last value.
const SHORTEST_S: f64 = 0.12;
const FEWEST: usize = 12;
/// A stretch stands still against the motion around it: how much the pose would have moved in it at the run's usual pace, over the
/// recorder's resolution.
const MOVED: f64 = 6.0;

/// A frozen pose, or a block of samples given again.
pub(super) fn fault(name: &str, r: &Record) -> Option<GrossFault> {
    still(name, r).or_else(|| frozen(name, r)).or_else(|| again(name, r))
}

/// A run whose pose is one number six times over from its first sample to its last.
fn still(name: &str, r: &Record) -> Option<GrossFault> {
    let moves = (1..r.len()).any(|i| key(r, i) != key(r, 0));
    (!moves && r.len() > 1).then(|| GrossFault {
        place: format!("run {name}"),
        cause: "the pose never changes".to_owned(),
        evidence: format!(
            "all {} samples have the same X, Y, Z, Rx, Ry, Rz, so that no parameter is excited: neither static moments nor damping nor \
             roll",
            r.len()
        ),
        change: "use a run in which the model swings, or leave this one out".to_owned(),
    })
}

/// Shortest stretch in samples.
fn fewest(r: &Record) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples")]
    let samples = (SHORTEST_S / r.interval_s().max(1e-6)).ceil().min(1e6) as usize;
    samples.max(FEWEST)
}

/// All six numbers of a sample, bit by bit.
fn key(r: &Record, i: usize) -> [u64; 6] {
    pose(r).map(|x| x[i].to_bits())
}

fn frozen(name: &str, r: &Record) -> Option<GrossFault> {
    let need = fewest(r);
    let mut start = 0;
    for i in 1..=r.len() {
        if i < r.len() && key(r, i) == key(r, start) {
            continue;
        }
        if i - start >= need && moving(r, i - start) {
            let (from, to) = (r.t_s[start], r.t_s[i - 1]);
            return Some(GrossFault {
                place: format!("run {name}"),
                cause: "frozen pose".to_owned(),
                evidence: format!(
                    "from {from:.3} to {to:.3} s all of X, Y, Z, Rx, Ry, Rz repeat one sample {} times while the run goes on",
                    i - start
                ),
                change: "leave these rows out of the file: a gap is bridged or splits the run".to_owned(),
            });
        }
        start = i;
    }
    None
}

/// Whether the pose moves far beyond its resolution in `samples` samples, at the median pace of the run.
fn moving(r: &Record, samples: usize) -> bool {
    let far = |x: &&[f64]| {
        let steps: Vec<f64> = x.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).collect();
        let resolution = steps.iter().copied().fold(f64::INFINITY, f64::min);
        let apart: Vec<f64> = x.windows(samples).map(|w| (w[samples - 1] - w[0]).abs()).collect();
        let noise = quantile(steps, 0.5);
        quantile(apart, 0.3) > MOVED * resolution.max(0.3 * noise)
    };
    samples < r.len() && pose(r).iter().filter(|x| far(x)).count() >= 2
}

/// A block of different samples that comes a second time in the same order.
fn again(name: &str, r: &Record) -> Option<GrossFault> {
    let need = fewest(r);
    let mut seen: HashMap<[u64; 6], usize> = HashMap::with_capacity(r.len());
    let (mut length, mut shift) = (0, 0);
    for i in 0..r.len() {
        let k = key(r, i);
        let new = i == 0 || k != key(r, i - 1);
        match seen.get(&k) {
            Some(&j) if i > j + 1 && (length == 0 || i - j == shift) => {
                shift = i - j;
                length += 1;
            }
            // A sample that only repeats the one before ends a block as well.
            _ => length = 0,
        }
        if length >= need {
            let (from, first) = (r.t_s[i + 1 - length], r.t_s[i + 1 - length - shift]);
            return Some(GrossFault {
                place: format!("run {name}"),
                cause: "repeated block of samples".to_owned(),
                evidence: format!("from {from:.3} s on the pose is, number by number, that from {first:.3} s on"),
                change: "leave the rows that are given again out of the file".to_owned(),
            });
        }
        if new {
            seen.insert(k, i);
        }
    }
    None
}

#[cfg(test)]
mod tests;
