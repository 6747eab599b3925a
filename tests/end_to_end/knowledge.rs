//! tests: `windfall identify --hold --tie --prior`. In: a flown scenario. Out: what knowledge does to estimates and errors, and the
//! words for what cannot be.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;

/// Estimate and standard error of a parameter in all runs together.
fn of(json: &Value, coefficient: &str, name: &str) -> Option<(f64, f64)> {
    let set = json["data_sets"].as_array()?.iter().find(|d| d["name"] == "combined")?;
    let p = set["parameters"].as_array()?.iter().find(|p| p["coefficient"] == coefficient && p["name"] == name)?;
    Some((p["estimate"].as_f64()?, p["std_error"].as_f64()?))
}

fn identified(campaign: &str, more: &[&str]) -> Value {
    let arguments = [&["identify", campaign, "--combined", "--json", "--method", "output-error"], more].concat();
    serde_json::from_str(&done(&arguments).out).expect("JSON and nothing else")
}

#[test]
fn law_ties_priors_and_holds_do_what_they_say() {
    let dir = folder();
    done(&["simulate", "sage-combined", "--out", &text(dir.path())]);
    let campaign = text(&dir.path().join("campaign.toml"));
    let free = identified(&campaign, &[]);
    let get = |json: &Value, c: &str, n: &str| of(json, c, n).expect("estimated");

    // Two axes tell one number: information adds, and the standard error falls by about √2 where both tell as much.
    let tied = identified(&campaign, &["--tie", "Cn_1=Cm_1", "--tie", "Cn_2=Cm_2"]);
    for (m, n) in [("Cm_1", "Cn_1"), ("Cm_2", "Cn_2")] {
        let (one, other, both) = (get(&free, "Cm", m), get(&free, "Cn", n), get(&tied, "Cm", m));
        assert_eq!(both, get(&tied, "Cn", n), "one unknown");
        // Never better than independent halves together; the static moment, which both share, takes up to a fifth back.
        let independent = (one.1.powi(-2) + other.1.powi(-2)).sqrt().recip();
        assert!((0.99..1.25).contains(&(both.1 / independent)), "{m}: {} against {independent}", both.1);
        let fall = (one.1 * other.1).sqrt() / both.1;
        assert!((fall / 2.0_f64.sqrt() - 1.0).abs() < 0.25, "{m}: falls by {fall}");
    }

    let (mean, std) = get(&free, "CN", "CN_sin");
    let narrow = format!("CN_sin={}:{}", mean + 3.0 * std, 1e-4 * std);
    let wide = format!("CN_sin={}±{}", mean + 3.0 * std, 1e5 * std);
    let pinned = get(&identified(&campaign, &["--prior", &narrow]), "CN", "CN_sin");
    assert!((pinned.0 - mean - 3.0 * std).abs() < 1e-3 * std && pinned.1 <= 1.01e-4 * std, "{pinned:?}");
    let same = get(&identified(&campaign, &["--prior", &wide]), "CN", "CN_sin");
    // The search ends within a thousandth of a standard error.
    assert!((same.0 - mean).abs() < 2e-3 * std && (same.1 / std - 1.0).abs() < 1e-3, "{same:?} {mean} {std}");

    // A held parameter is where it was told to be, is not estimated, and is in the result for those who fly it.
    let held = identified(&campaign, &["--hold", "Cl_0=0.0125"]);
    assert_eq!(of(&held, "Cl", "Cl_0"), None);
    assert_eq!(held["data_sets"][0]["held"], serde_json::json!([{"name": "Cl_0", "value": 0.0125}]));
    assert!(get(&held, "Cl", "Cl_p").1 < 0.5 * get(&free, "Cl", "Cl_p").1, "the roll's two parameters are nearly one");

    // Held at zero is not declared.
    let file = std::fs::read_to_string(&campaign).expect("written");
    let names: Vec<&str> = ["CA_T0", "CN_sin", "Cl_0", "Cl_p", "Cm_sin", "Cm_sin3", "Cm_1", "Cm_2", "Cn_1", "Cn_2"].to_vec();
    let fewer = file.replace("[aero.axisymmetric]", &format!("[aero.axisymmetric]\ndeclared = {names:?}"));
    let other = text(&dir.path().join("fewer.toml"));
    std::fs::write(&other, fewer).expect("written");
    for method in ["output-error", "equation-error", "thesis"] {
        let run = |file: &str, more: &[&str]| -> Value {
            let arguments = [&["identify", file, "--combined", "--json", "--method", method], more].concat();
            serde_json::from_str(&done(&arguments).out).expect("JSON")
        };
        let (a, b) = (run(&campaign, &["--hold", "CN_sin3=0"]), run(&other, &[]));
        assert_eq!(get(&a, "CN", "CN_sin"), get(&b, "CN", "CN_sin"), "{method}");
    }

    for (bad, word) in [
        (&["--hold", "CX=1"][..], "parameters: CA_T0"),
        (&["--hold", "Cl_0"], "NAME=VALUE"),
        (&["--hold", "Cl_0=1", "--hold", "Cl_0=2"], "twice"),
        (&["--tie", "Cn_9=Cm_1"], "parameters: CA_T0"),
        (&["--tie", "Cn_1=Cm_9"], "parameters: CA_T0"),
        (&["--tie", "Cn_1=Cm_1", "--hold", "Cm_1=-3"], "not free"),
        (&["--tie", "Cn_1=Cm_1", "--hold", "Cn_1=-3"], "not declared or is held"),
        (&["--tie", "Cn_1=Cm_1", "--tie", "Cn_1=Cn_2"], "more than once"),
        (&["--tie", "Cn_1=Cm_1", "--prior", "Cn_1=-3±1"], "not free"),
        (&["--prior", "CA=1±1"], "parameters: CA_T0"),
        (&["--prior", "CA_T0=1±0"], "STD above 0"),
        (&["--tie", "Cn_1=Cm_1", "--method", "equation-error"], "output-error or filter-error"),
        (&["--prior", "CA_T0=6±1", "--method", "thesis"], "output-error or filter-error"),
    ] {
        let ran = windfall(&[&["identify", &campaign, "--json"], bad].concat());
        assert!(ran.code == 2 && ran.err.contains(word), "{bad:?}: {} {}", ran.code, ran.err);
    }
}
