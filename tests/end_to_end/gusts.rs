//! tests: gusts that filter error finds are flown again, by every command that flies. In: a flight in turbulence. Out: what is flown.

use crate::program::{done, folder, text};
use serde_json::Value;
use std::fs;
use std::path::Path;

const GUSTS: &str =
    "[effects.turbulence]\naxial_rms_m_s = 0.1\nlateral_rms_m_s = 0.1\naxial_scale_m = 0.6\nlateral_scale_m = 0.6\n";

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("written")).expect("JSON")
}

/// A scenario of six seconds in gusts of 0.1 m/s.
fn scenario(dir: &Path) -> String {
    let bundled = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
    let path = dir.join("scenario.toml");
    fs::write(&path, bundled.replace("duration_s = 18.3", "duration_s = 6.0") + GUSTS).expect("written");
    text(&path)
}

/// Issue 13: `resimulate` refused the program's own file, for `axial_rms_m_s` is no parameter of the structure.
#[test]
fn law_what_filter_error_found_is_flown_again() {
    let dir = folder();
    let at = |name: &str| text(&dir.path().join(name));
    done(&["simulate", &scenario(dir.path()), "--out", &at("flights")]);
    let campaign = at("flights/campaign.toml");
    done(&["identify", &campaign, "--method", "filter-error", "--combined", "--bootstrap", "2", "--out", &at("found")]);
    let found = read(&dir.path().join("found/identification.json"));
    let parameters = found["data_sets"][0]["parameters"].as_array().expect("a list");
    let rms = parameters.iter().find(|p| p["coefficient"] == "turbulence" && p["name"] == "lateral_rms_m_s").expect("gusts");
    // Half to twice what was put in: one run of six seconds.
    assert!(rms["estimate"].as_f64().is_some_and(|x| (0.05..0.2).contains(&x)), "{rms}");
    assert_eq!(found["bootstrap"]["failed"].as_array().map(Vec::len), Some(0), "{}", found["bootstrap"]);

    let flown = |model: &str| -> Value {
        let ran = done(&["resimulate", &campaign, "--model", model, "--seeds", "4", "--json"]);
        serde_json::from_str(&ran.out).expect("JSON and nothing else")
    };
    let with = flown(&at("found/identification.json"));
    let value = |name: &str| with["parameters"].as_array()?.iter().find(|p| p["name"] == name)?["value"].as_f64();
    assert_eq!(value("lateral_rms_m_s"), rms["estimate"].as_f64(), "{}", with["parameters"]);
    assert!(value("lateral_scale_m").is_some_and(|m| m > 0.0), "{}", with["parameters"]);

    // The same file without its gusts: seeds then differ by the sensors' noise alone.
    let mut calm = found.clone();
    calm["data_sets"][0]["parameters"] = parameters.iter().filter(|p| p["coefficient"] != "turbulence").cloned().collect();
    calm["data_sets"][0]["held"] = Value::Array(Vec::new());
    calm["data_sets"][0].as_object_mut().expect("a data set").remove("covariance");
    fs::write(dir.path().join("calm.json"), calm.to_string()).expect("written");
    let without = flown(&at("calm.json"));
    let spread = |r: &Value| r["statistics"][0]["simulation_std"].as_f64().expect("four seeds");
    assert!(spread(&with) > 5.0 * spread(&without), "{} {}", spread(&with), spread(&without));
    // Trajectories are those without chance, and alike.
    assert_eq!(with["trajectory"], without["trajectory"]);
}

/// Issue 13: every draw of such a study failed.
#[test]
fn law_a_study_flies_what_filter_error_found() {
    let dir = folder();
    scenario(dir.path());
    let study = dir.path().join("study.toml");
    let order = "[study]\nname = \"gusts\"\nscenario = \"scenario.toml\"\ndraws = 2\nseed = 5\npart_draws = 2\n\
                 [do]\nidentify = [\"filter-error\"]\nresimulate = true\n";
    fs::write(&study, order).expect("written");
    done(&["study", &text(&study), "--out", &text(&dir.path().join("out"))]);
    let summary = read(&dir.path().join("out/summary.json"));
    assert_eq!(summary["failures"]["any"]["count"], 0, "{}", summary["failures"]);
    let line = |n: &&Value| n["name"] == "filter-error.resimulate.attitude_rms_deg";
    let numbers = summary["numbers"].as_array().expect("a list");
    assert_eq!(numbers.iter().find(line).map(|n| n["n"].clone()), Some(2.into()));
}
