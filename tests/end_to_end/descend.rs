//! tests: `windfall descend` from outside. In: a planet scenario, an identification. Out: files, table, exit codes.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The bundled descent, from 1 km, in a folder with its wind.
fn scenario(dir: &Path) -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/planet");
    let toml = std::fs::read_to_string(from.join("venus-dispersions.toml")).expect("bundled");
    let short = toml
        .replace("height_m = 20000.0", "height_m = 1000.0")
        .replace("velocity_ned_m_s = [0.0, -25.0, 14.0]", "velocity_ned_m_s = [0.0, -1.4, 8.1]");
    assert_ne!(short, toml);
    std::fs::copy(from.join("venus-wind.csv"), dir.join("venus-wind.csv")).expect("bundled");
    let path = dir.join("s.toml");
    std::fs::write(&path, short).expect("writable");
    path
}

/// An identification of C_A,T0 = 6.5 ± 0.1 alone.
fn model(dir: &Path) -> PathBuf {
    let found = serde_json::json!({"method": "made", "data_sets": [{"name": "combined", "runs": [], "fits": [], "condition_number": 1.0,
        "n_samples": 9, "covariance": [[0.01]], "parameters": [{"coefficient": "CA", "name": "CA_T0", "estimate": 6.5, "std_error": 0.1,
        "rse_percent": 1.5, "ci95": [6.3, 6.7], "std_error_white": 0.1}]}]});
    let path = dir.join("identification.json");
    std::fs::write(&path, found.to_string()).expect("writable");
    path
}

#[test]
fn law_descend_writes_its_files_the_same_on_any_threads() {
    let dir = folder();
    let (s, m) = (text(&scenario(dir.path())), text(&model(dir.path())));
    let into = |name: &str, threads: &str| {
        let out = text(&dir.path().join(name));
        let ran = done(&["descend", &s, "--model", &m, "--draws", "30", "--threads", threads, "--out", &out]);
        assert!(ran.out.contains("30 landed, 0 tumbled") && ran.out.contains("CA_T0 -"), "{}", ran.out);
        assert!(ran.err.contains("Cl_p"), "what is not identified is said: {}", ran.err);
        ["descent.json", "descents.parquet", "report.html"]
            .map(|f| std::fs::read(dir.path().join(name).join(f)).expect("written"))
    };
    let (one, three) = (into("a", "1"), into("b", "3"));
    assert!(one == three, "files depend on threads");
    let summary: Value = serde_json::from_slice(&one[0]).expect("JSON");
    assert_eq!((summary["draws"].as_u64(), summary["seed"].as_u64()), (Some(30), Some(1)));
    let speed = &summary["touch_down"][0];
    assert_eq!(speed["quantity"], "descent_speed_m_s");
    // √(2mg/(ρSC_A)) of 840.4 kg at 8.87 m/s², 64.79 kg/m³, 0.5675 m², 6.5: 7.9 m/s.
    assert!(speed["nominal"].as_f64().is_some_and(|v| (v - 7.9).abs() < 0.1), "{speed}");
    let rows = windfall_scenarios::read_runs(&dir.path().join("a/descents.parquet")).expect("a table");
    assert_eq!(rows.0.len(), 30);
    assert!(rows.1.iter().any(|(c, _)| c.name == "parameter.CA_T0") && rows.1.iter().any(|(c, _)| c.name == "touch_down.time_s"));
    // The page can be made again, and figures of it.
    let figures = text(&dir.path().join("figures"));
    done(&["report", &text(&dir.path().join("a")), "--figures", &figures]);
    assert!(std::fs::read_dir(&figures).expect("made").count() >= 3 * 7);
    assert!(std::fs::read(dir.path().join("a/report.html")).expect("there") == one[2], "another page");
    // Nothing is overwritten unasked.
    let ran = windfall(&["descend", &s, "--draws", "2", "--out", &text(&dir.path().join("a"))]);
    assert!(ran.code == 2 && ran.err.contains("--force"), "{}", ran.err);
    // Without an identification the scenario's own coefficients fly; a seed is another result.
    let json = |seed: &str| done(&["descend", &s, "--draws", "4", "--seed", seed, "--json"]).out;
    assert!(json("7") == json("7") && json("7") != json("8"));
    assert!(serde_json::from_str::<Value>(&json("7")).expect("JSON")["model"].is_null());
}

#[test]
fn law_descend_says_what_is_wrong() {
    let dir = folder();
    let s = text(&scenario(dir.path()));
    for (words, message) in [
        (
            vec!["descend", "nowhere.toml"],
            "nowhere.toml: is neither a file nor a bundled planet scenario; bundled: venus-descent, venus-dispersions",
        ),
        (vec!["descend", &s, "--draws", "0"], "--draws"),
        (vec!["descend", &s, "--flight", "up"], "flight up: the scenario has none of that name; allowed: descent"),
        (vec!["descend", &s, "--model", &s], "s.toml"),
    ] {
        let ran = windfall(&words);
        assert!(ran.code == 2 && ran.err.contains(message), "{words:?}: {} {}", ran.code, ran.err);
    }
    let toml = std::fs::read_to_string(&s).expect("there");
    let tunnel = dir.path().join("tunnel.toml");
    std::fs::write(&tunnel, toml.split("[environment]").next().unwrap_or_default()).expect("writable");
    let ran = windfall(&["descend", &text(&tunnel)]);
    assert!(ran.code == 2 && !ran.err.is_empty(), "{}", ran.err);
    // A flight that is too short leaves all aloft: an answer.
    let short = dir.path().join("short.toml");
    std::fs::write(&short, toml.replace("duration_s = 4000.0", "duration_s = 10.0")).expect("writable");
    let ran = done(&["descend", &text(&short), "--draws", "3", "--json"]);
    let ends: Value = serde_json::from_str(&ran.out).expect("JSON");
    assert_eq!((ends["ends"]["aloft"].as_u64(), ends["ends"]["landed"].as_u64()), (Some(3), Some(0)));
    assert_eq!(ends["touch_down"].as_array().map(Vec::len), Some(0));
}
