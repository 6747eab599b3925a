//! scenarios: what one file may order. In: counts as written. Out: the largest that are flown, and faults that name them.
//!
//! Every count that a file sets has a limit, so that no file takes all memory or runs without end.

use crate::table::{Source, Table};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

/// Samples of one flight: two hours at 150 Hz, a quarter of a gigabyte in memory.
pub(crate) const FLIGHT_SAMPLES: f64 = 1e6;
/// Samples of all flights of a file, which are in memory together: a gigabyte.
pub(crate) const FILE_SAMPLES: f64 = 4e6;
/// Flights or runs of a file.
pub(crate) const RUNS: usize = 10_000;
/// Inputs of all runs of a file: every run has a value of each.
pub(crate) const INPUTS: usize = 100;
/// Draws of a study, and the parts in which they are kept: each part is a file.
pub(crate) const DRAWS: f64 = 1e8;
pub(crate) const PARTS: u64 = 100_000;
/// Draws in a part, whose rows are in memory together.
pub(crate) const PART_DRAWS: f64 = 1e5;
/// Points of a grid on which an input is drawn beforehand.
pub(crate) const GRID_POINTS: f64 = 2e7;
/// Campaigns done together: a row of each is in memory.
pub(crate) const CAMPAIGNS: usize = 10_000;
/// Folders below the one that is searched for campaigns, and all that is looked at on the way.
pub(crate) const SEARCH_DEPTH: usize = 8;
pub(crate) const SEARCHED: usize = 1_000_000;

/// Samples of a flight; too many are a fault.
pub(crate) fn samples(t: &Table<'_>, duration_s: f64, rate_hz: f64) -> f64 {
    let samples = duration_s * rate_hz;
    if samples > FLIGHT_SAMPLES {
        let what = format!("gives {samples:.3e} samples with duration_s = {duration_s}; at most {FLIGHT_SAMPLES:.0e} are flown");
        t.source.fault(t.at("rate_hz"), t.full("rate_hz"), rate_hz.to_string(), what, "a lower rate or a shorter flight");
    }
    samples
}

/// Samples of all flights together, and the number of these tables.
pub(crate) fn of_file(source: &Source<'_>, table: &str, count: usize, samples: f64) {
    if count > RUNS {
        let what = format!("at most {RUNS} are read from one file");
        source.fault(None, format!("[[{table}]]"), count.to_string(), what, "several files");
    }
    if samples > FILE_SAMPLES {
        let what = format!("give {samples:.3e} samples together; at most {FILE_SAMPLES:.0e} are flown from one file");
        source.fault(
            None,
            format!("[[{table}]] duration_s, rate_hz"),
            "",
            what,
            "lower rates, shorter flights, or several files",
        );
    }
}

/// A grid that is too fine for a duration.
pub(crate) fn grid(t: &Table<'_>, key: &str, value: f64, interval_s: f64, duration_s: f64) {
    let points = duration_s / interval_s;
    if points > GRID_POINTS {
        let what = format!("needs {points:.3e} points over {duration_s} s; at most {GRID_POINTS:.0e} are drawn");
        t.source.fault(t.at(key), t.full(key), value.to_string(), what, "a longer time, or a shorter flight");
    }
}

/// Draws over draws in a part: at most so many parts.
pub(crate) fn parts(t: &Table<'_>, draws: u64, part_draws: u64) {
    let parts = draws.div_ceil(part_draws.max(1));
    if parts > PARTS {
        let what = format!("gives {parts} parts of {part_draws} draws; at most {PARTS} are kept");
        let remedy = format!("part_draws = {}, or fewer draws", draws.div_ceil(PARTS));
        t.source.fault(t.at("draws"), t.full("draws"), draws.to_string(), what, remedy);
    }
}

/// The path that a file's word stands for: beside that file, or absolute. One that climbs out of the folder is a fault: a campaign of
/// somebody else's reads what came with it, and nothing that only lies near.
pub(crate) fn beside(source: &Source<'_>, at: Option<Range<usize>>, key: &str, word: &str) -> PathBuf {
    if climbs(word) {
        let what = "leaves the folder of this file by `..`";
        let remedy = "put the file into this folder or below, or give its absolute path";
        source.fault(at, key, format!("{word:?}"), what, remedy);
    }
    source.path().parent().unwrap_or(Path::new("")).join(word)
}

/// Whether a path leaves the folder that it begins in.
pub(crate) fn climbs(word: &str) -> bool {
    Path::new(word).components().any(|c| c == Component::ParentDir)
}

/// Files that flights of these names make; two that are one are a fault, also where only capitals differ.
pub(crate) fn unique_files(source: &Source<'_>, names: &[&str], endings: &[&str]) {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    let mut named: BTreeSet<&str> = BTreeSet::new();
    for name in names {
        if !named.insert(name) {
            source.fault(None, "[[flight]] name", *name, "appears twice", "give each flight its own name");
            continue;
        }
        for ending in endings {
            let file = format!("{name}{ending}").to_lowercase();
            if let Some(other) = seen.get(&file) {
                let what = format!("makes the file {file}, which flight {other} makes too");
                source.fault(None, "[[flight]] name", *name, what, "a name that differs in more than capitals or `-truth`");
            } else {
                seen.insert(file, name);
            }
        }
    }
}
