//! likelihood: runs that go on where another ended, as one. In: runs. Out: the runs joined, and which of them are left.
//!
//! The start of a run is twelve numbers that nothing else tells. A flight whose record was cut in two, by a gap or by hand, has one start:
//! its second part begins in the state in which the first ended. A gap is samples that were not measured.

use crate::run::whole;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use windfall_model::{Data, POSE, PerChannel, Record, Run};

/// Longest gap, s: the tunnel speed is interpolated across it, which changes over seconds.
const LONGEST_GAP_S: f64 = 0.5;
/// Samples of each side that one cubic must fit, and the most that they may leave, in variances of their noise: with 2 SIDE - 4 degrees of
/// freedom noise alone leaves more in one of 7000 (χ²).
const SIDE: usize = 6;
const MOST_LEFT: f64 = 31.0;
/// Farthest that a body may be accelerated within a gap, m/s² and rad/s².
const ACCELERATION: f64 = 20.0;
const TURNING: f64 = 150.0;
/// Tolerance of sample times, in intervals: what rounding to a millisecond does at 150 Hz.
const JITTER: f64 = 0.2;

/// Runs of `indices` whose record another one goes on with take it over, in their place; the others are left as they are.
pub(crate) fn joined(runs: &mut [Run], indices: &[usize]) -> Vec<usize> {
    let variances: BTreeMap<usize, PerChannel<f64>> = indices.iter().filter_map(|&i| Some((i, variances(&runs[i])?))).collect();
    let mut left = indices.to_vec();
    while let Some((first, second, missing)) = pair(runs, &left, &variances) {
        let (name, next) = (runs[second].name.clone(), runs[second].data.clone());
        let run = &mut runs[first];
        if let (Data::Tunnel(record), Data::Tunnel(next)) = (&mut run.data, &next) {
            append(record, next, missing);
        }
        run.name = format!("{} and {name}", run.name);
        left.retain(|i| *i != second);
    }
    left
}

/// A run, the one that goes on where it ended, and how many samples are missing between them: of all pairs the one that meets best.
fn pair(runs: &[Run], left: &[usize], variances: &BTreeMap<usize, PerChannel<f64>>) -> Option<(usize, usize, usize)> {
    let all = left.iter().flat_map(|&a| left.iter().map(move |&b| (a, b))).filter(|(a, b)| a != b);
    let pairs = all.filter_map(|(a, b)| {
        let (x, y) = (variances.get(&a)?, variances.get(&b)?);
        let mean = std::array::from_fn(|c| 0.5 * (x[c] + y[c]));
        let (missing, apart) = between(&runs[a], &runs[b], &mean)?;
        Some((a, b, missing, apart))
    });
    let (a, b, missing, _) = pairs.min_by(|x, y| x.3.total_cmp(&y.3))?;
    Some((a, b, missing))
}

/// Samples missing between two runs of which the second goes on where the first ended, and how far apart they are, as a share of the farthest.
fn between(a: &Run, b: &Run, variances: &PerChannel<f64>) -> Option<(usize, f64)> {
    let (Data::Tunnel(first), Data::Tunnel(second)) = (&a.data, &b.data) else { return None };
    let (dt, same) = (first.interval_s(), a.kind == b.kind && a.used == b.used && a.inputs == b.inputs);
    if !same
        || (second.interval_s() / dt - 1.0).abs() > 0.01
        || first.slow().map(|x| x.is_some()) != second.slow().map(|x| x.is_some())
    {
        return None;
    }
    let steps = (second.t_s.first()? - first.t_s.last()?) / dt;
    let on_one_clock = steps > 0.5 && steps * dt < LONGEST_GAP_S && (steps - steps.round()).abs() < JITTER;
    // On another clock nothing is known to be missing.
    let steps = if on_one_clock { whole(steps) } else { 1 };
    let apart = if steps == 1 {
        if goes_on(first, second, variances) { 0.0 } else { 1.0 }
    } else if first.piece_of == second.piece_of {
        bent(first, second, steps as f64 * dt)
    } else {
        // Every clock may start at zero: after a gap a piece of one file goes on at a time at which another's does.
        1.0
    };
    (apart < 1.0).then_some((steps - 1, apart))
}

/// How much a body's path must bend to go on with a second record, a gap after the first's end, over the most that it may.
fn bent(first: &Record, second: &Record, gap_s: f64) -> f64 {
    let of = |c: usize| {
        let [from, to] = ends(first, second, c);
        let bend = (if c < 3 { ACCELERATION } else { TURNING }) * gap_s;
        let aside = (to[0] - from[0] - 0.5 * gap_s * (from[1] + to[1])).abs() / (0.25 * bend * gap_s);
        aside.max((to[1] - from[1]).abs() / bend)
    };
    (0..POSE).map(of).fold(0.0, f64::max)
}

/// Whether the second record's pose and tunnel speed are where the first's lead to, an interval later.
fn goes_on(first: &Record, second: &Record, variances: &PerChannel<f64>) -> bool {
    let measured = |r: &Record, rows: std::ops::Range<usize>| rows.into_iter().all(|i| r.is_measured(i));
    measured(first, first.len() - SIDE..first.len())
        && measured(second, 0..SIDE)
        && (0..7).all(|c| {
            let (x, y) = (first.channels()[c], second.channels()[c]);
            let turns = if c == 3 { turns(x[x.len() - 1], y[0]) } else { 0.0 };
            let at = |k: usize| if k < SIDE { x[x.len() - SIDE + k] } else { y[k - SIDE] + turns };
            let cubic = DMatrix::from_fn(2 * SIDE, 4, |r, p| (r as f64 / SIDE as f64 - 1.0).powi(i32::try_from(p).unwrap_or(0)));
            let values = DVector::from_fn(2 * SIDE, |r, _| at(r));
            let Ok(fit) = cubic.clone().svd(true, true).solve(&values, 1e-12) else { return false };
            (values - cubic * fit).norm_squared() <= MOST_LEFT * variances[c]
        })
}

/// Variance of the noise of every channel by its fourth differences, which the motion hardly enters: their median square over that of a normal
/// variable. None of a track or of a few samples.
fn variances(run: &Run) -> Option<PerChannel<f64>> {
    match &run.data {
        Data::Tunnel(r) if r.len() >= 10 * SIDE => Some(r.channels().map(variance)),
        _ => None,
    }
}

fn variance(x: &[f64]) -> f64 {
    let mut fourth: Vec<f64> =
        x.windows(5).map(|s| (s[0] - 4.0 * s[1] + 6.0 * s[2] - 4.0 * s[3] + s[4]).powi(2) / 70.0).collect();
    let middle = fourth.len() / 2;
    *fourth.select_nth_unstable_by(middle, f64::total_cmp).1 / 0.455
}

/// Whole turns by which a second record's roll is to be shifted.
fn turns(last: f64, first: f64) -> f64 {
    std::f64::consts::TAU * ((last - first) / std::f64::consts::TAU).round()
}

/// Value and slope of a channel at the end of a record and at the start of the next: straight lines through a few samples.
fn ends(first: &Record, second: &Record, channel: usize) -> [[f64; 2]; 2] {
    let (x, y, dt) = (first.channels()[channel], second.channels()[channel], first.interval_s());
    let line = |of: &dyn Fn(usize) -> f64, last: bool| {
        let middle = 0.5 * (SIDE - 1) as f64;
        let mean = (0..SIDE).map(of).sum::<f64>() / SIDE as f64;
        let square: f64 = (0..SIDE).map(|k| (k as f64 - middle).powi(2)).sum();
        let slope = (0..SIDE).map(|k| (k as f64 - middle) * of(k)).sum::<f64>() / square;
        [mean + slope * if last { middle } else { -middle }, slope / dt]
    };
    let from = line(&|k| x[x.len() - SIDE + k], true);
    let mut to = line(&|k| y[k], false);
    to[0] += if channel == 3 { turns(from[0], to[0]) } else { 0.0 };
    [from, to]
}

/// Puts a record behind another, `missing` samples later; these are cubics that meet both with their slopes, and count as not measured.
fn append(record: &mut Record, next: &Record, missing: usize) {
    let dt = record.interval_s();
    let gap_s = (missing + 1) as f64 * dt;
    let ends: PerChannel<[[f64; 2]; 2]> = std::array::from_fn(|c| ends(record, next, c));
    let between = |c: usize, k: usize| {
        let s = (k + 1) as f64 / (missing + 1) as f64;
        let [[a, u], [b, v]] = ends[c];
        let (s2, s3) = (s * s, s * s * s);
        a * (2.0 * s3 - 3.0 * s2 + 1.0) + u * gap_s * (s3 - 2.0 * s2 + s) + b * (3.0 * s2 - 2.0 * s3) + v * gap_s * (s3 - s2)
    };
    let shift =
        turns(record.attitude_rad[0].last().copied().unwrap_or(0.0), next.attitude_rad[0].first().copied().unwrap_or(0.0));
    let measured = |r: &Record| (0..r.len()).map(|i| !r.is_measured(i)).collect::<Vec<bool>>();
    let bridged = [measured(record), vec![true; missing], measured(next)].concat();
    let first_of_next = record.len() + missing;
    let (start_s, rows) = (record.t_s.first().copied().unwrap_or(0.0), bridged.len());
    for (c, (series, more)) in record.channels_mut().into_iter().zip(next.channels()).enumerate() {
        series.extend((0..missing).map(|k| between(c, k)));
        series.extend(more.iter().map(|v| if c == 3 { v + shift } else { *v }));
    }
    for (series, more) in record.slow_mut().into_iter().flatten().zip(next.slow().into_iter().flatten()) {
        let last = series.last().copied().unwrap_or(0.0);
        series.extend(std::iter::repeat_n(last, missing).chain(more.iter().copied()));
    }
    // The second record's samples of the tunnel speed are where the first's go on, or all rows are taken for samples.
    record.wind_rows = record.wind_rows.filter(|w| {
        let of_next = next.wind_rows.filter(|n| n.every == w.every);
        of_next.is_some_and(|n| (first_of_next + n.first) % w.every == w.first)
    });
    record.t_s = (0..rows).map(|i| start_s + i as f64 * dt).collect();
    record.bridged = if bridged.iter().any(|b| *b) { bridged } else { Vec::new() };
}

#[cfg(test)]
mod tests;
