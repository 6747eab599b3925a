//! pid: a pose that jumps and stays. In: a record. Out: a fault with the instant and the size.
//!
//! A body has no step in its place or attitude; a tracker that takes one marker for another has. A push changes the rates and leaves
//! both, so what is extrapolated from both sides to the instant between them still meets.

use super::{GrossFault, pose};
use windfall_model::Record;

/// Samples on each side through which a line is laid.
const SIDE: usize = 12;
/// Smallest step that counts, in m and in rad (3°), and over the scatter about the lines.
const LEAST: [f64; 2] = [0.02, 0.052];
const OVER_SCATTER: f64 = 12.0;

/// Names and units of the pose.
const NAMES: [&str; 6] = ["X", "Y", "Z", "Rx", "Ry", "Rz"];

/// The largest step of a run.
pub(super) fn fault(name: &str, r: &Record) -> Option<GrossFault> {
    let largest = pose(r)
        .iter()
        .enumerate()
        .filter_map(|(c, x)| step(r, x, LEAST[usize::from(c > 2)]).map(|s| (c, s)))
        .max_by(|a, b| (a.1.1.abs() / LEAST[usize::from(a.0 > 2)]).total_cmp(&(b.1.1.abs() / LEAST[usize::from(b.0 > 2)])))?;
    let (c, (i, size, scatter)) = largest;
    let (size, scatter, unit) =
        if c > 2 { (size.to_degrees(), scatter.to_degrees(), "deg") } else { (size * 1e3, scatter * 1e3, "mm") };
    Some(GrossFault {
        place: format!("run {name}"),
        cause: "the pose jumps and stays (markers swapped or moved)".to_owned(),
        evidence: format!(
            "at {:.3} s {} steps by {size:.1} {unit} from one sample to the next, {scatter:.2} {unit} being the scatter on both sides",
            r.t_s[i], NAMES[c]
        ),
        change: "solve the markers again, or cut the run there by window_s".to_owned(),
    })
}

/// Index after the largest step, its size and the scatter beside it.
fn step(r: &Record, x: &[f64], least: f64) -> Option<(usize, f64, f64)> {
    let mut best: Option<(usize, f64, f64)> = None;
    for i in SIDE..x.len() - SIDE {
        let now = (x[i] - x[i - 1]).abs();
        if now < 0.7 * least || (i - SIDE..i + SIDE).any(|k| !r.is_measured(k)) || uneven(&r.t_s[i - 3..i + 3]) {
            continue;
        }
        let ((before, slope_before, s0), (after, slope_after, s1)) = (line(&x[i - SIDE..i], true), line(&x[i..i + SIDE], false));
        let (size, scatter) = (after - before, s0.max(s1));
        // What a change of slope within the step could make.
        let bent = 1.5 * slope_before.abs().max(slope_after.abs());
        // A turn that is not unwrapped is none.
        let whole = (size / std::f64::consts::TAU).round();
        let turn = least > LEAST[0] && whole.abs() > 0.5 && (size - whole * std::f64::consts::TAU).abs() < LEAST[1];
        let clear = !turn && size.abs() > least + bent && size.abs() > OVER_SCATTER * scatter && now > 0.6 * size.abs();
        if clear && best.is_none_or(|b| size.abs() > b.1.abs()) {
            best = Some((i, size, scatter));
        }
    }
    best
}

/// Whether samples lie farther apart than usual here.
fn uneven(t: &[f64]) -> bool {
    let step = |k: usize| t[k + 1] - t[k];
    let usual = step(0).max(step(1)).max(step(3)).max(step(4));
    step(2) > 1.5 * usual
}

/// Value half a sample beyond the end (or before the start) of a straight line through samples, its slope per sample, and the median
/// distance of samples from it.
fn line(x: &[f64], beyond: bool) -> (f64, f64, f64) {
    let n = x.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = x.iter().sum::<f64>() / n;
    let (mut along, mut size) = (0.0, 0.0);
    for (k, v) in x.iter().enumerate() {
        let d = k as f64 - middle;
        along += d * (v - mean);
        size += d * d;
    }
    let slope = along / size;
    let apart: Vec<f64> = x.iter().enumerate().map(|(k, v)| (v - mean - slope * (k as f64 - middle)).abs()).collect();
    let at = if beyond { n - 0.5 } else { -0.5 };
    (mean + slope * (at - middle), slope, super::median(&apart).max(1e-12))
}

#[cfg(test)]
mod tests;
