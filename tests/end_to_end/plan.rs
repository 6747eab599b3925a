//! tests: `windfall plan` and what `windfall identify` says before it fits. In: a flown scenario. Out: words, files, exit codes.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;

#[test]
fn law_plan_answers_in_minutes_and_release_angle() {
    let dir = folder();
    let out = text(dir.path());
    done(&["simulate", "sage-combined", "--out", &out]);
    let campaign = text(&dir.path().join("campaign.toml"));
    let ran = done(&["plan", &campaign, "--target", "Cm_2=0.1%", "--target", "CA_T0=5%", "--between", "30", "--out", &out]);
    assert!(ran.out.contains("min of tunnel time") && ran.out.contains("release deg"), "{}", ran.out);
    assert!(ran.out.contains("reached already"), "{}", ran.out);
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(dir.path().join("plan.json")).expect("written")).expect("JSON");
    let best = &json["targets"][0]["options"][0];
    let number = |key: &str| best[key].as_f64().expect("a number");
    assert!((number("minutes") - number("runs") * (number("run_s") + 30.0) / 60.0).abs() < 1e-9, "{best}");
    assert!(number("std_error") <= json["targets"][0]["std_error_wanted"].as_f64().expect("a number"));
    for bad in [&["--target", "Cm_9=5%"][..], &["--target", "Cm_2"], &["--target", "Cm_2=1%", "--between", "-1"], &[]] {
        let ran = windfall(&[&["plan", &campaign], bad].concat());
        assert_eq!(ran.code, 2, "{bad:?}: {}", ran.err);
    }
}

#[test]
fn law_identify_first_says_what_the_runs_can_tell() {
    let dir = folder();
    done(&["simulate", "sage-combined", "--out", &text(dir.path())]);
    let campaign = text(&dir.path().join("campaign.toml"));
    let ran = done(&["identify", &campaign, "--combined", "--json"]);
    let json: Value = serde_json::from_str(&ran.out).expect("JSON and nothing else");
    assert_eq!(json["data_sets"].as_array().map(Vec::len), Some(1), "all runs together alone");
    assert_eq!(json["identifiability"]["rank"], 11);
    let pairs = json["identifiability"]["correlations"].as_array().expect("a list");
    let roll = pairs.iter().any(|p| p["first"] == "Cl_0" && p["second"] == "Cl_p");
    assert!(roll, "a steady roll tells only the ratio of the two: {pairs:?}");
    assert!(ran.err.contains("method output-error: "), "{}", ran.err);
}
