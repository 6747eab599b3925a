//! tests: what the check of a record says of slips of the laboratory, and what the verbs then do. In: a flown campaign with a slip in its files. Out:
//! exit codes, names and numbers.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Samples a second of the bundled flights.
const RATE_HZ: f64 = 150.0;
/// Columns of the tunnel's recorder.
const TUNNEL: [usize; 4] = [7, 8, 9, 10];

/// `sage-perturbed` flown, its rows changed by a rule.
fn with_slip(dir: &Path, name: &str, slip: impl Fn(Vec<Vec<f64>>) -> Vec<Vec<f64>>) -> PathBuf {
    let to = dir.join(name);
    done(&["simulate", "sage-perturbed", "--out", &text(&to)]);
    let csv = std::fs::read_to_string(to.join("run.csv")).expect("written");
    let (head, rows) = csv.split_once('\n').expect("a header");
    let numbers = |line: &str| line.split(',').map(|c| c.parse::<f64>().expect("a number")).collect::<Vec<f64>>();
    let changed = slip(rows.lines().map(numbers).collect());
    let lines = changed.iter().map(|r| r.iter().map(ToString::to_string).collect::<Vec<_>>().join(","));
    std::fs::write(to.join("run.csv"), std::iter::once(head.to_owned()).chain(lines).collect::<Vec<_>>().join("\n"))
        .expect("writable");
    to.join("campaign.toml")
}

/// The tunnel's recorder late by whole samples; the ends that only one recorder has are gone.
fn late(rows: &[Vec<f64>], samples: isize) -> Vec<Vec<f64>> {
    let last = rows.len() as isize;
    let both = (0..last).filter(|i| (0..last).contains(&(i - samples)));
    let one = |i: isize| {
        let mut row = rows[i as usize].clone();
        TUNNEL.iter().for_each(|&c| row[c] = rows[(i - samples) as usize][c]);
        row
    };
    both.map(one).collect()
}

/// Clocks apart by seconds, either sign: `check` says so with the offset and the mend, `identify` says the same and finds the parameters that
/// were flown, and `close` names the effect with the offset in its interval of 95 % (four standard errors here, and half a sample's time).
#[test]
fn recover_clocks_that_differ_by_check_identify_and_close() {
    let dir = folder();
    for (name, samples, family) in [("late", 270, "wind-delay"), ("early", -150, "pose-delay")] {
        let campaign = text(&with_slip(dir.path(), name, |rows| late(&rows, samples)));
        let offset_s = samples as f64 / RATE_HZ;
        let checked = done(&["check", &campaign]);
        let said = checked.out + &checked.err;
        assert!(said.contains("the clocks of pose and V_W differ") && said.contains(&format!("[effects.{family}]")), "{said}");
        assert!(said.contains(&format!("{:.1}", offset_s.abs())) && said.contains(name), "{said}");

        let identified = done(&["identify", &campaign, "--method", "output-error", "--combined", "--json"]);
        let json: Value = serde_json::from_str(&identified.out).expect("JSON and nothing else");
        assert!(json["warnings"].to_string().contains("the clocks of pose and V_W differ"), "{}", json["warnings"]);
        let drag = &json["data_sets"][0]["parameters"][0];
        // The true C_A; an offset that is known to 0.01 s moves it by a thousandth.
        assert!((drag["estimate"].as_f64().expect("a number") - 6.662).abs() < 0.01, "{drag}");

        let closed = done(&["close", &campaign, "--json"]);
        let json: Value = serde_json::from_str(&closed.out).expect("JSON and nothing else");
        assert_eq!(json["verdict"], "effect");
        assert_eq!(json["effects"].as_array().map(Vec::len), Some(1), "{}", json["effects"]);
        assert_eq!(json["effects"][0]["family"], family);
        let delay = &json["effects"][0]["parameters"][0];
        let [found, std] = ["estimate", "std_error"].map(|k| delay[k].as_f64().expect("a number"));
        assert!((found - offset_s.abs()).abs() < 4.0 * std + 0.5 / RATE_HZ && std < 0.02, "{delay}");
    }
}

/// A refusal names the way past it; those who take it read in the result what the check had to say.
#[test]
fn law_a_record_that_is_refused_is_accepted_on_request() {
    let dir = folder();
    let mirrored = |mut rows: Vec<Vec<f64>>| {
        rows.iter_mut().for_each(|r| r[2] = -r[2]);
        rows
    };
    let campaign = text(&with_slip(dir.path(), "mirrored", mirrored));
    let refused = windfall(&["identify", &campaign, "--method", "equation-error"]);
    assert!(
        refused.code == 2 && refused.err.contains("Y is mirrored") && refused.err.contains("--accept-record"),
        "{}",
        refused.err
    );
    let accepted = done(&["identify", &campaign, "--method", "equation-error", "--accept-record", "--json"]);
    let json: Value = serde_json::from_str(&accepted.out).expect("JSON and nothing else");
    let warnings = json["warnings"].to_string();
    assert!(
        warnings.contains("accepted against the check") && warnings.contains("with Y = -Y the record makes sense"),
        "{warnings}"
    );
}
