//! tests: what the program is made of. In: `cargo metadata` of what is built here. Out: no licence, source, second version or direct dependency
//! but those that are known, and no `unsafe` in the workspace.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Licences that go with MIT or Apache-2.0.
const LICENCES: [&str; 11] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "MIT",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];
/// Crates of which two versions are linked.
const SEVERAL: [&str; 3] = ["getrandom", "hashbrown", "syn"];
const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn output(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(root()).output().expect("cargo runs where its tests run");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Packages that are built on this system.
fn packages() -> Vec<Value> {
    let cargo = env!("CARGO");
    let version = output(cargo, &["-vV"]);
    let host = version.lines().find_map(|l| l.strip_prefix("host: ")).expect("cargo names its host");
    let text = output(cargo, &["metadata", "--locked", "--offline", "--format-version", "1", "--filter-platform", host]);
    let metadata: Value = serde_json::from_str(&text).expect("JSON");
    metadata["packages"].as_array().expect("a list").clone()
}

fn word<'v>(v: &'v Value, key: &str) -> &'v str {
    v[key].as_str().unwrap_or("")
}

/// Whether every part of a licence expression leaves a choice that is allowed.
fn allowed(expression: &str) -> bool {
    let one = |part: &str| part.replace('/', " OR ").split(" OR ").any(|l| LICENCES.contains(&l.trim_matches([' ', '(', ')'])));
    expression.split(" AND ").all(one)
}

/// Names in the table of the documents.
fn table() -> BTreeSet<String> {
    let text = std::fs::read_to_string(root().join("docs/reference/dependencies.md")).expect("the table");
    let rows = text.lines().filter_map(|l| l.strip_prefix("| ")?.split_once(" |")).map(|(name, _)| name.to_owned());
    rows.filter(|n| n != "crate").collect()
}

#[test]
fn law_every_direct_dependency_has_a_purpose() {
    let own: Vec<Value> = packages().into_iter().filter(|p| p["source"].is_null()).collect();
    let named = |p: &Value| p["dependencies"].as_array().expect("a list").clone();
    let direct: BTreeSet<String> =
        own.iter().flat_map(named).map(|d| word(&d, "name").to_owned()).filter(|n| !n.starts_with("windfall")).collect();
    assert_eq!(direct, table(), "docs/reference/dependencies.md is not what the manifests say");
}

#[test]
fn law_licences_sources_and_versions_are_known() {
    let all = packages();
    assert!(all.len() > 100, "{} packages seen", all.len());
    for p in all.iter().filter(|p| !p["source"].is_null()) {
        let (name, licence) = (word(p, "name"), word(p, "license"));
        assert!(allowed(licence), "{name}: licence {licence}");
        assert_eq!(word(p, "source"), REGISTRY, "{name}");
    }
    let twice = [
        "tree",
        "--workspace",
        "--locked",
        "--offline",
        "-e",
        "normal,build",
        "--duplicates",
        "--depth",
        "0",
        "--prefix",
        "none",
    ];
    let text = output(env!("CARGO"), &twice);
    // One version stands twice where a build script takes it as well.
    let lines: BTreeSet<(&str, &str)> = text.lines().filter_map(|l| l.split_once(' ')).collect();
    let named = |name: &str| lines.iter().filter(|(n, _)| *n == name).count();
    let several: BTreeSet<&str> = lines.iter().map(|(n, _)| *n).filter(|n| named(n) > 1).collect();
    assert_eq!(several, BTreeSet::from(SEVERAL), "crates of which two versions are linked");
}

#[test]
fn law_licences_are_read_as_they_are_written() {
    for good in
        ["MIT", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0", "LGPL-2.1-or-later OR MIT", "BSD-3-Clause AND MIT"]
    {
        assert!(allowed(good), "{good}");
    }
    for bad in ["", "GPL-3.0-only", "MIT AND GPL-3.0-only", "LGPL-2.1-or-later"] {
        assert!(!allowed(bad), "{bad}");
    }
}

/// Each crate takes the workspace's lints, which forbid it; the words of the one build script hold no network.
#[test]
fn law_no_unsafe_and_one_build_script() {
    let manifest = |p: &Value| std::fs::read_to_string(word(p, "manifest_path")).expect("a manifest");
    assert!(std::fs::read_to_string(root().join("Cargo.toml")).expect("there").contains("unsafe_code = \"forbid\""));
    let mut scripts = Vec::new();
    for p in packages().iter().filter(|p| p["source"].is_null()) {
        assert!(manifest(p).contains("[lints]\nworkspace = true"), "{}", word(p, "name"));
        let targets = p["targets"].as_array().expect("a list").clone();
        scripts.extend(targets.iter().filter(|t| t["kind"][0] == "custom-build").map(|t| word(t, "src_path").to_owned()));
    }
    assert!(scripts.len() == 1 && scripts[0].ends_with("model/build.rs"), "{scripts:?}");
    let script = std::fs::read_to_string(&scripts[0]).expect("the build script");
    for word in ["std::net", "Command", "http"] {
        assert!(!script.contains(word), "{word} in a build script");
    }
}
