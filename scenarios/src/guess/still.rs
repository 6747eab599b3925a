//! scenarios: rows of a record in which nothing was measured although numbers stand there. In: the columns that are read. Out: how many rows
//! are zero or frozen, and the longest stretch that is neither.

use super::sheet::{Clock, Sheet, per_s};

/// Rows that repeat the one before from which on a body was not seen: a body that moves gives no two rows alike.
const FROZEN_ROWS: usize = 10;

/// Rows of a record that say nothing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Still {
    /// Rows whose every position is exactly zero.
    pub(crate) zero: usize,
    /// Rows that repeat the one before, in stretches of ten or more.
    pub(crate) frozen: usize,
    /// First and last time of the longest stretch that is neither, in the file's time, s.
    pub(crate) window_s: [f64; 2],
}

/// Rows of the columns `used`, of which the first is the time; none where all rows move.
pub(super) fn still(sheet: &Sheet<'_>, clock: &Clock, used: &[&str]) -> Option<Still> {
    let t = sheet.get(&clock.found.name)?;
    let moved: Vec<&[f64]> = used.iter().filter(|n| **n != clock.found.name).filter_map(|n| sheet.get(n)).collect();
    // The air may stand still; positions, angles and quaternions come first and are what moves.
    let rows = t.len();
    let is_zero = |i: usize| moved.iter().take(3).all(|c| c[i].abs() < f64::MIN_POSITIVE);
    let same = |i: usize| i > 0 && moved.iter().all(|c| c[i].to_bits() == c[i - 1].to_bits() && c[i].is_finite());
    let mut bad = vec![false; rows];
    let zero = (0..rows).filter(|i| is_zero(*i)).inspect(|i| bad[*i] = true).count();
    let (mut frozen, mut start) = (0, 0);
    for i in 1..=rows {
        if i == rows || !same(i) {
            if i - start > FROZEN_ROWS {
                frozen += (start + 1..i).filter(|k| !bad[*k]).count();
                bad[start + 1..i].fill(true);
            }
            start = i;
        }
    }
    if zero + frozen == 0 {
        return None;
    }
    let mut best = 0..0;
    let mut from = 0;
    for i in 0..=rows {
        if bad.get(i).is_none_or(|bad| *bad) {
            if i - from > best.len() {
                best = from..i;
            }
            from = i + 1;
        }
    }
    let last = best.end.checked_sub(1)?;
    let window_s = [best.start, last].map(|i| t[i] / per_s(&clock.found.unit));
    Some(Still { zero, frozen, window_s })
}
