//! tests: who may see whom, the table of rooms. In: the workspace's manifests by `cargo metadata`. Out: no arrow that the table lacks.

use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Command;

/// Room and what it may see. `tests` may see all.
const ARROWS: [(&str, &[&str]); 13] = [
    ("windfall-model", &[]),
    ("windfall-sim", &["windfall-model"]),
    ("windfall-pid", &["windfall-model"]),
    ("windfall-likelihood", &["windfall-model", "windfall-pid"]),
    ("windfall-replay", &["windfall-model", "windfall-sim", "windfall-pid"]),
    ("windfall-discover", &["windfall-model", "windfall-sim", "windfall-pid", "windfall-likelihood", "windfall-replay"]),
    ("windfall-study", &["windfall-model", "windfall-sim", "windfall-pid", "windfall-replay", "windfall-discover"]),
    ("windfall-verify", &["windfall-model", "windfall-sim", "windfall-pid", "windfall-replay"]),
    ("windfall-scenarios", &["windfall-model"]),
    ("windfall-report", &["windfall-model", "windfall-replay", "windfall-discover", "windfall-study"]),
    (
        "windfall",
        &[
            "windfall-model",
            "windfall-sim",
            "windfall-pid",
            "windfall-replay",
            "windfall-discover",
            "windfall-study",
            "windfall-verify",
            "windfall-scenarios",
            "windfall-report",
        ],
    ),
    ("windfall-cli", &["windfall"]),
    // The package brings the program too.
    ("windfall-python", &["windfall", "windfall-cli"]),
];

/// Rooms that a room's manifest names, for use or (`dev`) for its tests.
fn seen(dev: bool) -> BTreeMap<String, Vec<String>> {
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/../Cargo.toml");
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1", "--manifest-path", manifest])
        .output()
        .expect("cargo runs where its tests run");
    let metadata: Value = serde_json::from_slice(&output.stdout).expect("cargo metadata prints JSON");
    let packages = metadata["packages"].as_array().expect("a list of packages");
    let name = |v: &Value| v["name"].as_str().unwrap_or("").to_owned();
    packages
        .iter()
        .map(|p| {
            let all = p["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
            let rooms = all.iter().filter(|d| name(d).starts_with("windfall") && (d["kind"] == "dev") == dev);
            (name(p), rooms.map(name).collect())
        })
        .collect()
}

#[test]
fn law_no_arrow_that_the_table_lacks() {
    let seen = seen(false);
    for (room, may) in ARROWS {
        let sees = seen.get(room).unwrap_or_else(|| panic!("{room} is in the workspace"));
        for other in sees {
            assert!(may.contains(&other.as_str()), "{room} sees {other}; allowed: {may:?}");
        }
    }
    // Without the facade the program and Python would have nothing to say.
    assert_eq!(seen["windfall-cli"], ["windfall"]);
    assert_eq!(seen["windfall-python"], ["windfall", "windfall-cli"]);
}

/// One integrates quaternions and vectors, the other differentiates Euler angles by components; not even their tests may mix them.
#[test]
fn law_simulator_and_identifier_never_meet() {
    for dev in [false, true] {
        let seen = seen(dev);
        assert!(!seen["windfall-sim"].contains(&"windfall-pid".to_owned()));
        assert!(!seen["windfall-pid"].contains(&"windfall-sim".to_owned()));
    }
}
