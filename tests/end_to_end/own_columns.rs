//! tests: a campaign in another laboratory's columns. In: a flown campaign, its runs rewritten. Out: the same results from every verb.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;

const COLUMNS: &str = r#"[columns]
t_s = { name = "time", unit = "ms" }
X_m = { name = "x", unit = "mm" }
Y_m = { name = "y", unit = "mm" }
Z_m = { name = "z", unit = "mm" }
VW_m_s = { name = "fan", unit = "ft/s" }
ps_Pa = { name = "p", unit = "kPa" }
Ts_K = { name = "T", unit = "degC" }

[columns.axes]
tunnel = ["-z", "y", "x"]

[columns.attitude]
quaternion = ["q1", "q2", "q3", "q0"]
scalar = "last"
rotates = "body-to-world"

"#;

/// The run in millimetres with z up, a quaternion, and other names and units; without q_W.
fn rewritten(csv: &str) -> String {
    let mut out = String::from("time;x;y;z;fan;p;T;q0;q1;q2;q3\nms;mm;mm;mm;ft/s;kPa;degC;;;;\n");
    for line in csv.lines().skip(1) {
        let c: Vec<f64> = line.split(',').map(|x| x.parse().expect("a number")).collect();
        let [a, b, g] = [4, 5, 6].map(|k| (0.5 * c[k].to_radians()).sin_cos());
        // Rx Ry Rz as a product of quaternions, real part first; then x = Z, y = Y, z = -X, a quarter turn about y.
        let ours = product(product([a.1, a.0, 0.0, 0.0], [b.1, 0.0, b.0, 0.0]), [g.1, 0.0, 0.0, g.0]);
        let room = product([0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt(), 0.0], ours);
        let cells = [1e3 * c[0], 1e3 * c[3], 1e3 * c[2], -1e3 * c[1], c[9] / 0.3048, 1e-3 * c[8], c[10] - 273.15];
        let line = cells.iter().chain(&room).map(ToString::to_string).collect::<Vec<_>>().join(";");
        let _ = writeln!(out, "{line}");
    }
    out
}

fn product([a, b, c, d]: [f64; 4], [w, x, y, z]: [f64; 4]) -> [f64; 4] {
    [a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w]
}

fn estimates(dir: &Path) -> Vec<(f64, f64)> {
    let ran = done(&["identify", &text(&dir.join("campaign.toml")), "--method", "output-error", "--json"]);
    let json: Value = serde_json::from_str(&ran.out).expect("JSON and nothing else");
    let sets = json["data_sets"].as_array().expect("a list");
    let parameters = sets.iter().flat_map(|d| d["parameters"].as_array().expect("a list"));
    parameters.map(|p| (p["estimate"].as_f64().expect("a number"), p["std_error"].as_f64().expect("a number"))).collect()
}

#[test]
fn law_other_columns_are_the_same_campaign() {
    let dir = folder();
    let (ours, theirs) = (dir.path().join("ours"), dir.path().join("theirs"));
    done(&["simulate", "sage-perturbed", "--out", &text(&ours)]);
    std::fs::create_dir(&theirs).expect("a folder");
    let read = |name: &str| std::fs::read_to_string(ours.join(name)).expect("written");
    // Without q_W on both sides.
    let run = read("run.csv").replacen("qW_Pa", "q_other", 1);
    std::fs::write(ours.join("run.csv"), &run).expect("writable");
    std::fs::write(theirs.join("run.csv"), rewritten(&run)).expect("writable");
    let campaign = read("campaign.toml");
    std::fs::write(theirs.join("campaign.toml"), campaign.replacen("[[run]]", &format!("{COLUMNS}[[run]]"), 1))
        .expect("writable");

    let path = text(&theirs.join("campaign.toml"));
    let checked = done(&["check", &path]);
    assert!(checked.err.contains("semicolons") || checked.out.contains("semicolons"), "{} {}", checked.out, checked.err);
    for words in [
        "t_s from time in ms",
        "X_m from x in mm",
        "ps_Pa from p in kPa",
        "tunnel X (down), Y, Z are the room's -z, y, x",
        "quaternion with the real part q0 and the parts q1, q2, q3, body to world",
        "physics: looked at",
        "pitch and yaw",
    ] {
        assert!(checked.out.contains(words), "{words} in {}", checked.out);
    }
    let (a, b) = (estimates(&ours), estimates(&theirs));
    assert!(!a.is_empty() && a.len() == b.len());
    for (x, y) in a.iter().zip(&b) {
        // The search ends within a thousandth of a standard error.
        assert!((x.0 - y.0).abs() < 2e-3 * x.1, "{x:?} {y:?}");
    }
    let closed = windfall(&["close", &path, "--json"]);
    let json: Value = serde_json::from_str(&closed.out).unwrap_or_else(|e| panic!("{e}: {}", closed.err));
    let known = windfall(&["close", &text(&ours.join("campaign.toml")), "--json"]);
    let known: Value = serde_json::from_str(&known.out).expect("JSON and nothing else");
    assert_eq!(json["verdict"], known["verdict"]);
    assert_eq!(closed.code, 0, "{}", closed.err);

    // Without its table the file is refused, with the names that it has.
    std::fs::write(theirs.join("campaign.toml"), campaign).expect("writable");
    let refused = windfall(&["check", &path]);
    assert!(
        refused.code == 2 && refused.err.contains("time, x, y, z, fan") && refused.err.contains("[columns]"),
        "{}",
        refused.err
    );
}
