//! tests: `windfall structure`. In: a flown scenario. Out: words, a result, and a structure file that other commands read.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;

#[test]
fn law_chosen_terms_can_be_declared_and_identified() {
    let dir = folder();
    let out = text(dir.path());
    done(&["simulate", "sage-combined", "--out", &out]);
    let campaign = text(&dir.path().join("campaign.toml"));
    let ran = done(&["structure", &campaign, "--criterion", "subset", "--out", &out]);
    let found = std::fs::read_to_string(dir.path().join("structure.json")).expect("written");
    let found: Value = serde_json::from_str(&found).expect("JSON");
    let of = |i: usize, key: &str| -> Vec<String> {
        let list = found["coefficients"][i][key].as_array().expect("a list");
        list.iter().map(|t| t["name"].as_str().expect("a name").to_owned()).collect()
    };
    assert_eq!(of(0, "chosen"), ["CA_T0"]);
    assert!(of(3, "candidates").len() > 10 && of(3, "chosen").iter().any(|n| n == "Cm_2"), "{}", ran.out);

    // What is printed is pasted in place of the declared model: the same terms are read, and identified.
    let start = ran.out.find("[aero.chosen]").expect("printed");
    let pasted = &ran.out[start..];
    let file = std::fs::read_to_string(&campaign).expect("written");
    let (before, rest) = file.split_once("[aero.axisymmetric]").expect("declared");
    let after = &rest[rest.find("\n[").expect("tables follow")..];
    let declared = dir.path().join("declared.toml");
    std::fs::write(&declared, format!("{before}{pasted}{after}")).expect("written");
    let ran = done(&["identify", &text(&declared), "--method", "equation-error", "--json"]);
    let identified: Value = serde_json::from_str(&ran.out).expect("JSON");
    let set = identified["data_sets"].as_array().expect("a list").last().expect("combined");
    for (coefficient, i) in [("CA", 0), ("CN", 1), ("Cl", 2), ("Cn", 3)] {
        let parameters = set["parameters"].as_array().expect("a list");
        let mut names: Vec<_> =
            parameters.iter().filter(|p| p["coefficient"] == coefficient).map(|p| p["name"].clone()).collect();
        let mut chosen = of(i, "chosen");
        names.sort_by_key(ToString::to_string);
        chosen.sort();
        assert_eq!(names, chosen, "{coefficient}");
    }

    let again = windfall(&["structure", &campaign, "--criterion", "subset", "--out", &out]);
    assert!(again.code == 2 && again.err.contains("--force"), "{}", again.err);
    let unknown = windfall(&["structure", &campaign, "--criterion", "aic", "--json"]);
    assert!(unknown.code == 2 && unknown.err.contains("likelihood"), "{}", unknown.err);
}
