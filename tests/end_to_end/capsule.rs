//! tests: another vehicle is another file. In: scenarios/capsule. Out: its parameters, flown and identified by the program as it is.

use crate::program::{done, estimate, folder, text};
use serde_json::Value;
use std::path::Path;

#[test]
fn recover_a_capsule_whose_damping_changes_sign() {
    let dir = folder();
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/capsule/scenario.toml");
    done(&["simulate", &text(&scenario), "--out", &text(dir.path())]);
    let json: Value =
        serde_json::from_str(&done(&["identify", &text(&dir.path().join("campaign.toml")), "--combined", "--json"]).out)
            .expect("JSON and nothing else");
    let truth = [
        ("CA", "CA_0", 1.4),
        ("CA", "CA_sin2", -1.0),
        ("CN", "CN_sin", 0.25),
        ("Cl", "Cl_p", -0.05),
        ("Cm", "Cm_sin", -0.15),
        ("Cm", "damping_far", -0.5),
        ("Cm", "damping_near", 0.8),
    ];
    for (coefficient, name, truth) in truth {
        let (found, [low, high]) = estimate(&json, "combined", coefficient, name);
        // The half interval is 1.96 standard errors; four of them are passed by chance in one of 2,000 such sets of seven.
        let z = 1.96 * (found - truth) / (0.5 * (high - low));
        assert!(z.abs() < 4.0, "{name}: {found} for {truth}, {z:.1} standard errors");
    }
    let (far, [_, far_high]) = estimate(&json, "combined", "Cm", "damping_far");
    let (near, [near_low, _]) = estimate(&json, "combined", "Cm", "damping_near");
    assert!(far_high < 0.0 && near_low > -far, "damps far out and drives near the stream: {far}, {near}");
}
