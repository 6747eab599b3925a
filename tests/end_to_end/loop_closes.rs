//! tests: simulate, identify, compare. In: bundled scenarios and shared campaigns. Out: parameters that were put in.

use crate::program::{TABLE_5_5, done, estimate, folder, shared, text, windfall};
use serde_json::Value;

fn identified(campaign: &str, method: &str) -> Value {
    serde_json::from_str(&done(&["identify", campaign, "--method", method, "--json"]).out).expect("JSON and nothing else")
}

/// Appendix C of the thesis recovers its own parameters within 6.84 %; 0.001 % is asked here, of noise-free data.
#[test]
fn recover_appendix_c_from_its_own_flight() {
    let dir = folder();
    done(&["simulate", "appendix-c", "--out", &text(dir.path())]);
    let json = identified(&text(&dir.path().join("campaign.toml")), "equation-error");
    for (coefficient, name, truth) in TABLE_5_5 {
        let (found, _) = estimate(&json, "combined", coefficient, name);
        assert!((found / truth - 1.0).abs() < 1e-5, "{coefficient} {name}: {found} for {truth}");
    }
}

/// The same on the independent simulator's data.
#[test]
fn recover_table_5_5_from_the_independent_simulator() {
    let Some(file) = shared("recover_table_5_5_from_the_independent_simulator", "data/campaigns/exact/campaign.toml") else {
        return;
    };
    let json = identified(&text(&file), "equation-error");
    for (coefficient, name, truth) in TABLE_5_5 {
        let (found, _) = estimate(&json, "combined", coefficient, name);
        assert!((found / truth - 1.0).abs() < 1e-5, "{coefficient} {name}: {found} for {truth}");
    }
}

/// Thirteen 95 % intervals: eleven or more hold the truth with probability 0.975 (binomial).
#[test]
fn recover_noisy_parameters_within_their_intervals() {
    let dir = folder();
    done(&["simulate", "sage-combined", "--out", &text(dir.path())]);
    let json = identified(&text(&dir.path().join("campaign.toml")), "equation-error");
    let inside = |&&(coefficient, name, truth): &&(&str, &str, f64)| {
        let (_, [low, high]) = estimate(&json, "combined", coefficient, name);
        low <= truth && truth <= high
    };
    let count = TABLE_5_5.iter().filter(inside).count();
    assert!(count >= 11, "{count} of 13");
}

/// The thesis' method on the same exact data: its end effects are hundreds of percent in C_N,sin³. A result, not a failure.
#[test]
fn pub_thesis_method_shows_its_own_errors() {
    let dir = folder();
    done(&["simulate", "appendix-c", "--out", &text(dir.path())]);
    let json = identified(&text(&dir.path().join("campaign.toml")), "thesis");
    let (found, _) = estimate(&json, "combined", "CN", "CN_sin3");
    assert!((found / -2.0035 - 1.0).abs() > 1.0, "C_N,sin³ = {found}");
    let (axial, _) = estimate(&json, "combined", "CA", "CA_T0");
    assert!((axial / 6.6620 - 1.0).abs() < 0.0684, "C_A,T0 = {axial}: within the thesis' own 6.84 %");
}

#[test]
fn law_identification_json_is_as_the_contract_says() {
    let dir = folder();
    let out = text(dir.path());
    done(&["simulate", "sage-combined", "--out", &out]);
    let ran = done(&["identify", &text(&dir.path().join("campaign.toml")), "--out", &out]);
    assert!(ran.out.contains("CA_T0") && ran.out.contains("R²"), "{}", ran.out);
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(dir.path().join("identification.json")).expect("written")).expect("JSON");
    assert_eq!(json["method"], "output-error");
    assert!(json["reason"].as_str().is_some_and(|r| r.contains("noise")), "why it was taken");
    let names: Vec<&str> = json["data_sets"].as_array().expect("a list").iter().filter_map(|d| d["name"].as_str()).collect();
    for name in ["perturbed", "unperturbed", "combined"] {
        assert!(names.contains(&name), "{names:?}");
    }
    let set = &json["data_sets"][0];
    for key in ["coefficient", "name", "estimate", "std_error", "rse_percent", "ci95", "std_error_white"] {
        assert!(set["parameters"][0].get(key).is_some(), "{key}");
    }
    for key in ["coefficient", "r2", "residual_std", "residual_whiteness_p"] {
        assert!(set["fits"][0].get(key).is_some(), "{key}");
    }
    assert!(set["condition_number"].is_number() && set["n_samples"].is_number());
}

/// Simulate, identify, fly the identified model: attitude and position part by little more than the instruments' noise, which alone gives
/// √(2·0.110² + 0.0623²) = 0.168° and √3·0.75 mm = 1.3 mm; the errors of thirteen well-determined parameters may add half as much again.
#[test]
fn law_the_loop_closes_on_its_own_flights() {
    let dir = folder();
    let out = text(dir.path());
    let campaign = text(&dir.path().join("campaign.toml"));
    let model = text(&dir.path().join("identification.json"));
    done(&["simulate", "sage-combined", "--out", &out]);
    done(&["identify", &campaign, "--out", &out]);
    let ran = done(&["resimulate", &campaign, "--model", &model, "--out", &out, "--seeds", "2"]);
    assert!(ran.out.contains("theta_deg") && ran.out.contains("perturbed-3"), "{}", ran.out);
    let json: Value =
        serde_json::from_str(&std::fs::read_to_string(dir.path().join("resimulation.json")).expect("written")).expect("JSON");
    assert_eq!(json["seeds"], 2);
    let held: Vec<&Value> = json["runs"].as_array().expect("a list").iter().filter(|r| r["used"] == "hold-out").collect();
    assert_eq!(held.len(), 2);
    for run in held {
        let error = |key: &str| run["trajectory"][key].as_f64().expect("a number");
        assert!(error("attitude_rms_deg") < 1.5 * 0.168, "{run}");
        assert!(error("position_rms_m") < 1.5 * 0.0013, "{run}");
    }
}

#[test]
fn law_resimulate_refuses_what_is_no_identification() {
    let dir = folder();
    let out = text(dir.path());
    done(&["simulate", "appendix-c", "--out", &out]);
    let campaign = text(&dir.path().join("campaign.toml"));
    let model = dir.path().join("model.json");
    std::fs::write(&model, "{ \"method\": 3 }").expect("writable");
    let ran = windfall(&["resimulate", &campaign, "--model", &text(&model)]);
    assert!(ran.code == 2 && ran.err.contains("model.json:1"), "{}", ran.err);
    assert_eq!(windfall(&["resimulate", &campaign]).code, 2, "--model is needed");
    assert_eq!(windfall(&["resimulate", &campaign, "--model", &text(&model), "--seeds", "0"]).code, 2);
}
