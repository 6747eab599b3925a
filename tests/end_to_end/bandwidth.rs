//! tests: records that were smoothed or resampled before their export. In: a flown campaign, its runs rewritten. Out: consistent, and parameters
//! within their intervals.

use crate::program::{Ran, TABLE_5_5, done, folder, text, windfall};
use serde_json::Value;
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Runs of the bundled campaign that are kept, and how long: two to identify on, one held out.
const RUNS: [(&str, f64); 3] = [("perturbed-1", 12.0), ("unperturbed-1", 12.0), ("perturbed-3", 10.0)];

/// Columns of a run by name, times first.
type Table = (Vec<String>, Vec<Vec<f64>>);

fn read(path: &Path) -> Table {
    let csv = std::fs::read_to_string(path).expect("written");
    let mut lines = csv.lines();
    let names: Vec<String> = lines.next().expect("a header").split(',').map(str::to_owned).collect();
    let mut columns = vec![Vec::new(); names.len()];
    for line in lines {
        columns.iter_mut().zip(line.split(',')).for_each(|(c, x)| c.push(x.parse().expect("a number")));
    }
    (names, columns)
}

fn write(path: &Path, (names, columns): &Table) {
    let mut csv = names.join(",");
    for i in 0..columns[0].len() {
        let row: Vec<String> = columns.iter().map(|c| format!("{:.6}", c[i])).collect();
        let _ = write!(csv, "\n{}", row.join(","));
    }
    std::fs::write(path, csv + "\n").expect("writable");
}

/// The campaign flown at a rate, its runs rewritten.
fn campaign(dir: &Path, rate_hz: f64, rewrite: &dyn Fn(Table) -> Table) -> PathBuf {
    let flown = dir.join("flown");
    let scenario =
        include_str!("../../scenarios/bundled/sage-combined.toml").replace("rate_hz = 150.0", &format!("rate_hz = {rate_hz:?}"));
    let file = dir.join("scenario.toml");
    std::fs::write(&file, scenario).expect("writable");
    done(&["simulate", &text(&file), "--out", &text(&flown)]);
    let toml = std::fs::read_to_string(flown.join("campaign.toml")).expect("written");
    let mut parts = toml.split("[[run]]");
    let head = parts.next().expect("a head").to_owned();
    let kept = parts.filter(|p| RUNS.iter().any(|(name, _)| p.contains(&format!("\"{name}.csv\""))));
    let own = dir.join("own");
    std::fs::create_dir(&own).expect("a folder");
    std::fs::write(own.join("campaign.toml"), kept.fold(head, |all, run| all + "[[run]]" + run)).expect("writable");
    for (name, seconds) in RUNS {
        let (names, mut columns) = read(&flown.join(format!("{name}.csv")));
        let rows = columns[0].iter().filter(|t| **t <= seconds).count();
        columns.iter_mut().for_each(|c| c.truncate(rows));
        write(&own.join(format!("{name}.csv")), &rewrite((names, columns)));
    }
    own.join("campaign.toml")
}

/// Butterworth's second order forward and backward over every column but times, ends continued by half a turn about the last value.
fn smoothed((names, mut columns): Table, corner_hz: f64) -> Table {
    let k = (PI * corner_hz / 150.0).tan();
    let whole = 1.0 + 2.0 * FRAC_1_SQRT_2 * k + k * k;
    let (gain, a) = (k * k / whole, [2.0 * (k * k - 1.0) / whole, (1.0 - 2.0 * FRAC_1_SQRT_2 * k + k * k) / whole]);
    let pass = |x: &[f64]| -> Vec<f64> {
        let (mut z, mut w) = (0.0, 0.0);
        let step = |v: &f64| {
            let v = v - x[0];
            let out = gain * v + z;
            z = 2.0 * gain * v - a[0] * out + w;
            w = gain * v - a[1] * out;
            out + x[0]
        };
        x.iter().map(step).rev().collect()
    };
    for c in columns.iter_mut().skip(1) {
        let (first, last, n, more) = (c[0], c[c.len() - 1], c.len(), 100);
        let before = (1..=more).rev().map(|i| 2.0 * first - c[i]);
        let after = (1..=more).map(|i| 2.0 * last - c[n - 1 - i]);
        let padded: Vec<f64> = before.chain(c.iter().copied()).chain(after).collect();
        *c = pass(&pass(&padded))[more..more + n].to_vec();
    }
    (names, columns)
}

/// Straight lines to 150 Hz.
fn resampled((names, columns): Table) -> Table {
    let t = columns[0].clone();
    let times: Vec<f64> = (0..).map(|i| f64::from(i) / 150.0).take_while(|x| *x <= t[t.len() - 1]).collect();
    let line = |c: &Vec<f64>, x: f64| {
        let j = t.partition_point(|own| *own <= x + 1e-9).clamp(1, t.len() - 1);
        c[j - 1] + (x - t[j - 1]) / (t[j] - t[j - 1]) * (c[j] - c[j - 1])
    };
    let columns = columns.iter().enumerate().map(|(k, c)| times.iter().map(|x| if k == 0 { *x } else { line(c, *x) }).collect());
    (names, columns.collect())
}

/// Farthest of the parameters from what it was flown with, in stated standard errors.
fn farthest(json: &Value) -> f64 {
    let sets = json["data_sets"].as_array().expect("a list");
    let all = sets.iter().find(|d| d["name"] == "combined").expect("all runs");
    let z = |p: &Value| {
        let truth = TABLE_5_5.iter().find(|(_, name, _)| p["name"] == *name).expect("a parameter of the structure").2;
        (p["estimate"].as_f64().expect("a number") - truth).abs() / p["std_error"].as_f64().expect("a number")
    };
    all["parameters"].as_array().expect("a list").iter().map(z).fold(0.0, f64::max)
}

fn json(ran: &Ran) -> Value {
    serde_json::from_str(&ran.out).unwrap_or_else(|e| panic!("{e}: {}", ran.err))
}

/// `check` says what was done, `close` ends consistent, and no parameter is beyond 3.5 standard errors: of eleven one is, by chance, in 200
/// campaigns.
fn is_sound(campaign: &Path, said: &str) {
    let path = text(campaign);
    let checked = done(&["check", &path]);
    assert!(checked.err.contains(said), "{}", checked.err);
    let found = json(&done(&["identify", &path, "--json"]));
    assert!(farthest(&found) < 3.5, "{} {}", farthest(&found), found["data_sets"]);
    assert!(found["bandwidth"].as_array().is_some_and(|b| b.len() >= 2 * RUNS.len()), "{}", found["bandwidth"]);
    let closed = windfall(&["close", &path, "--json"]);
    let closing = json(&closed);
    assert!(closing["verdict"] == "consistent", "{} {} {}", closing["verdict"], closing["effects"], closing["unexplained"]);
    assert_eq!(closing["bandwidth"], found["bandwidth"]);
}

#[test]
fn recover_a_campaign_smoothed_at_25_hz() {
    let dir = folder();
    is_sound(&campaign(dir.path(), 150.0, &|t| smoothed(t, 25.0)), "the pose and the tunnel speed were smoothed at 2");
}

#[test]
fn recover_a_campaign_smoothed_at_12_hz() {
    let dir = folder();
    is_sound(&campaign(dir.path(), 150.0, &|t| smoothed(t, 12.0)), "the pose and the tunnel speed were smoothed at 1");
}

#[test]
fn recover_a_campaign_resampled_by_straight_lines() {
    let dir = folder();
    is_sound(&campaign(dir.path(), 100.0, &resampled), "the pose was recorded at 100 Hz and resampled by straight lines");
}

/// A sound campaign is used as it was recorded.
#[test]
fn law_a_sound_campaign_is_not_thinned() {
    let dir = folder();
    let path = text(&campaign(dir.path(), 150.0, &|t| t));
    let found = json(&done(&["identify", &path, "--method", "equation-error", "--json"]));
    assert!(found.get("bandwidth").is_none(), "{}", found["bandwidth"]);
}
