//! tests: every command and flag once. In: arguments. Out: exit codes, streams and files as the contract says.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;

#[test]
fn law_help_and_version_end_well_and_no_command_does_not() {
    assert!(done(&["--help"]).out.contains("simulate"));
    assert!(done(&["--version"]).out.starts_with("windfall "));
    let ran = windfall(&[]);
    assert!(ran.code == 2 && ran.err.contains("Usage"), "{}", ran.err);
    assert_eq!(windfall(&["simulate", "appendix-c", "--sead", "1"]).code, 2);
}

#[test]
fn law_simulate_writes_record_truth_and_resolved_scenario() {
    let dir = folder();
    let out = text(&dir.path().join("made"));
    let ran = done(&["simulate", "appendix-c", "--out", &out]);
    assert!(ran.out.is_empty() && ran.err.contains("run.csv"), "{}", ran.err);
    for file in ["run.csv", "truth.csv", "scenario.toml", "campaign.toml"] {
        assert!(dir.path().join("made").join(file).is_file(), "{file}");
    }
    let run = std::fs::read_to_string(dir.path().join("made/run.csv")).expect("written");
    assert_eq!(run.lines().next(), Some("t_s,X_m,Y_m,Z_m,Rx_deg,Ry_deg,Rz_deg,qW_Pa,ps_Pa,VW_m_s,Ts_K"));
    assert_eq!(run.lines().count(), 2252);
    let left: Vec<_> = std::fs::read_dir(dir.path().join("made")).expect("there").flatten().collect();
    assert_eq!(left.len(), 4, "no temporary file is left: {left:?}");
}

#[test]
fn law_nothing_is_overwritten_without_force() {
    let dir = folder();
    let out = text(dir.path());
    std::fs::write(dir.path().join("truth.csv"), "mine").expect("writable");
    let ran = windfall(&["simulate", "appendix-c", "--out", &out]);
    assert!(ran.code == 2 && ran.err.contains("truth.csv") && ran.err.contains("--force"), "{}", ran.err);
    assert_eq!(std::fs::read_to_string(dir.path().join("truth.csv")).expect("there"), "mine");
    assert!(!dir.path().join("run.csv").exists(), "outputs are checked before the work");
    done(&["simulate", "appendix-c", "--out", &out, "--force"]);
    assert_ne!(std::fs::read_to_string(dir.path().join("truth.csv")).expect("there"), "mine");
}

#[test]
fn law_json_goes_to_standard_output_and_writes_nothing_by_itself() {
    let ran = done(&["simulate", "appendix-c", "--json"]);
    let json: Value = serde_json::from_str(&ran.out).expect("JSON and nothing else");
    assert_eq!(json["flights"][0]["samples"], 2251);
    assert_eq!(json["flights"][0]["end"], "completed");
    assert_eq!(json["flights"][0]["record"], Value::Null);
}

#[test]
fn law_quiet_says_nothing() {
    let dir = folder();
    let ran = done(&["simulate", "appendix-c", "--quiet", "--out", &text(dir.path())]);
    assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", ""));
}

/// Same seed, same bytes whatever the number of threads; another seed, other bytes; and the resolved scenario flies the same again.
#[test]
fn law_seed_and_threads() {
    let dir = folder();
    let run = |scenario: &str, name: &str, more: &[&str]| {
        let out = text(&dir.path().join(name));
        done(&[&["simulate", scenario, "--out", &out], more].concat());
        std::fs::read(dir.path().join(name).join("perturbed-2.csv")).expect("written")
    };
    let one = run("sage-combined", "one", &["--threads", "1", "--seed", "7"]);
    assert_eq!(one, run("sage-combined", "two", &["--threads", "2", "--seed", "7"]));
    assert_ne!(one, run("sage-combined", "other", &["--seed", "8"]));
    assert_eq!(one, run(&text(&dir.path().join("one/scenario.toml")), "again", &[]));
    assert_eq!(windfall(&["simulate", "sage-combined", "--threads", "0"]).code, 2);
}

#[test]
fn law_flights_are_named_when_there_are_several() {
    let dir = folder();
    done(&["simulate", "sage-combined", "--out", &text(dir.path())]);
    for file in ["perturbed-1.csv", "perturbed-1-truth.csv", "unperturbed-2.csv", "campaign.toml", "scenario.toml"] {
        assert!(dir.path().join(file).is_file(), "{file}");
    }
    let checked = done(&["check", &text(&dir.path().join("campaign.toml"))]).out;
    assert!(checked.contains("run perturbed-3: perturbed, hold-out"), "{checked}");
}

#[test]
fn law_bad_input_ends_with_two_and_a_message() {
    let dir = folder();
    let path = dir.path().join("s.toml");
    let scenario = windfall_scenarios::bundled("appendix-c").expect("bundled");
    std::fs::write(&path, scenario.replace("mass_kg = 0.7873", "mass_kg = nan")).expect("writable");
    for command in ["simulate", "check"] {
        let ran = windfall(&[command, &text(&path)]);
        assert!(ran.code == 2 && ran.err.contains("mass_kg = nan") && ran.out.is_empty(), "{}", ran.err);
    }
    let ran = windfall(&["simulate", "apendix-c"]);
    assert!(ran.code == 2 && ran.err.contains("appendix-c"), "{}", ran.err);
    let ran = windfall(&["identify", &text(&dir.path().join("nowhere.toml"))]);
    assert!(ran.code == 2 && ran.err.contains("nowhere.toml"), "{}", ran.err);
    let file = dir.path().join("file");
    std::fs::write(&file, "").expect("writable");
    assert_eq!(windfall(&["simulate", "appendix-c", "--out", &text(&file.join("below"))]).code, 2);
}

/// Drag that pushes makes the speed infinite in finite time.
#[test]
fn law_numerical_failure_ends_with_three() {
    let dir = folder();
    let path = dir.path().join("s.toml");
    let scenario = windfall_scenarios::bundled("drop-test").expect("bundled");
    std::fs::write(&path, scenario.replace("CA_T0 = 6.6620", "CA_T0 = -60.0")).expect("writable");
    let ran = windfall(&["simulate", &text(&path), "--json"]);
    assert!(ran.code == 3 && ran.err.contains("flight run"), "{} {}", ran.code, ran.err);
}

/// Largest total angle of attack in a file of truth, deg.
fn largest_angle_deg(truth: &std::path::Path) -> f64 {
    let all = std::fs::read_to_string(truth).expect("written");
    let mut lines = all.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let head = lines.next().expect("a head");
    let column = head.iter().position(|h| *h == "alphaT_rad").expect("a column");
    lines.map(|l| l[column].parse::<f64>().expect("a number").to_degrees()).fold(0.0, f64::max)
}

#[test]
fn law_check_prints_what_it_understood() {
    assert!(done(&["check", "full-scale-venus-20km"]).out.contains("d = 0.85 m"));
    assert!(done(&["check", "--keys"]).out.contains("| `mass_kg` | kg |"));
    let json: Value = serde_json::from_str(&done(&["check", "drop-test", "--json"]).out).expect("JSON");
    assert_eq!(json["kind"], "scenario");
    let dir = folder();
    done(&["simulate", "appendix-c", "--out", &text(dir.path())]);
    // Released at 25 deg (thesis Appendix C), without noise, and swinging on: the largest angle is the truth's. A run file says nothing of
    // its vehicle.
    let largest_deg = largest_angle_deg(&dir.path().join("truth.csv"));
    assert!(largest_deg > 25.0 && largest_deg < 26.0, "{largest_deg}");
    let run = done(&["check", &text(&dir.path().join("run.csv"))]).out;
    let reached = format!("reached: α_T {largest_deg:.1} deg");
    assert!(run.contains("2251 samples") && run.contains(&reached) && run.contains("per metre"), "{run}");
    let campaign = text(&dir.path().join("campaign.toml"));
    let said = done(&["check", &campaign]).out;
    assert!(said.contains("largest angle of attack and rates") && said.contains("all of combined"), "{said}");
    let is_it = |envelope: &Value| (envelope["max_alpha_t_deg"].as_f64().expect("a number") - largest_deg).abs() < 0.01;
    let json: Value = serde_json::from_str(&done(&["check", &campaign, "--json"]).out).expect("JSON");
    let all = &json["test_table"]["data_sets"][1];
    assert!(all["name"] == "combined" && is_it(all), "{all}");
    let found = done(&["identify", &campaign, "--method", "equation-error", "--json"]).out;
    let found: Value = serde_json::from_str(&found).expect("JSON");
    assert!(is_it(&found["data_sets"][0]["envelope"]) && found["envelopes"][0]["name"] == "run", "{}", found["envelopes"]);
}

/// A flight as a laboratory would write it becomes a campaign; the last of the files is held out, and nothing is dropped in silence.
#[test]
fn law_init_takes_the_files_of_a_laboratory() {
    let dir = folder();
    done(&["simulate", "sage-combined", "--out", &text(&dir.path().join("flown"))]);
    let mut files = Vec::new();
    for name in ["perturbed-1", "perturbed-2"] {
        let run = std::fs::read_to_string(dir.path().join(format!("flown/{name}.csv"))).expect("flown");
        let (head, rows) = run.split_once('\n').expect("a header");
        let head = head.replace("VW_m_s", "tunnel_speed_mps").replace("qW_Pa", "p_radps");
        let file = dir.path().join(format!("{name}.csv"));
        std::fs::write(&file, format!("{head}\n{rows}")).expect("writable");
        files.push(text(&file));
    }
    let mine = text(&dir.path().join("mine"));
    let drafted = done(&["init", &mine, &files[0], &files[1]]).out;
    for words in [
        "VW_m_s = { name = \"tunnel_speed_mps\", unit = \"m/s\" }",
        "p_radps: radps is no unit of a static pressure",
        "use = \"hold-out\"",
        "NOT TOLD",
    ] {
        assert!(drafted.contains(words), "{words} in {drafted}");
    }
    assert!(dir.path().join("mine/campaign.toml").is_file());
    let free = text(&dir.path().join("free"));
    done(&["init", &free, &files[0], "--kind", "free-flight"]);
    assert!(dir.path().join("free/body.toml").is_file());
    let refused = windfall(&["init", &text(&dir.path().join("no")), &files[0], "--kind", "pivot"]);
    assert!(refused.code == 2 && refused.err.contains("angle"), "{}", refused.err);
}

#[test]
fn law_completions_are_scripts() {
    for shell in ["bash", "zsh", "fish"] {
        assert!(done(&["completions", shell]).out.contains("simulate"), "{shell}");
    }
}

#[test]
fn law_verify_prints_figure_bound_source_and_the_thesis_own() {
    let ran = done(&["verify", "--threads", "2"]);
    for word in ["PASS", "bound <= ", "thesis", "CN_sin3", "[thesis Table 2.3"] {
        assert!(ran.out.contains(word), "{word}");
    }
    let dir = folder();
    let ran = done(&["verify", "--json", "--out", &text(dir.path()), "--quiet"]);
    let json: Value = serde_json::from_str(&ran.out).expect("JSON and nothing else");
    assert_eq!(json["verdict"], "pass");
    let written: Value =
        serde_json::from_str(&std::fs::read_to_string(dir.path().join("verify.json")).expect("written")).expect("JSON");
    assert_eq!(written, json);
    assert!(json["checks"].as_array().is_some_and(|c| c.len() > 40));
}
