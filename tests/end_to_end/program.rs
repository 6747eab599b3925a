//! tests: runs the program in this process. In: arguments. Out: exit code and what it printed.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// What a run of the program left.
pub(crate) struct Ran {
    pub(crate) code: u8,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// Runs `windfall` with these arguments.
pub(crate) fn windfall(arguments: &[&str]) -> Ran {
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = windfall_cli::run(["windfall"].iter().chain(arguments), &mut out, &mut err);
    Ran { code, out: String::from_utf8_lossy(&out).into_owned(), err: String::from_utf8_lossy(&err).into_owned() }
}

/// The same, and it must end well.
pub(crate) fn done(arguments: &[&str]) -> Ran {
    let ran = windfall(arguments);
    assert_eq!(ran.code, 0, "{arguments:?}: {}", ran.err);
    ran
}

/// A temporary folder.
pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A path as an argument.
pub(crate) fn text(path: &Path) -> String {
    path.to_str().expect("temporary and shared folders are UTF-8").to_owned()
}

/// A file of the shared data, or a line that says it is skipped.
pub(crate) fn shared(test: &str, below: &str) -> Option<PathBuf> {
    let root = std::env::var_os("WINDFALL_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    let path = root.join(below);
    if !path.exists() {
        // Past the harness, which keeps to itself what a passing test prints.
        let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
        return None;
    }
    Some(path)
}

/// Table 5.5 of the thesis: parameters by coefficient, the yaw equation's static pair being the pitch equation's by symmetry.
pub(crate) const TABLE_5_5: [(&str, &str, f64); 13] = [
    ("CA", "CA_T0", 6.6620),
    ("CN", "CN_sin", 3.5129),
    ("CN", "CN_sin3", -2.0035),
    ("Cl", "Cl_0", 0.0125),
    ("Cl", "Cl_p", -5.6816),
    ("Cm", "Cm_sin", -2.0655),
    ("Cm", "Cm_sin3", 2.5278),
    ("Cm", "Cm_1", -3.3025),
    ("Cm", "Cm_2", -205.4289),
    ("Cn", "Cm_sin", -2.0655),
    ("Cn", "Cm_sin3", 2.5278),
    ("Cn", "Cn_1", -3.3025),
    ("Cn", "Cn_2", -205.4289),
];

/// Estimate, and interval, of a parameter in a data set of `identification.json`.
pub(crate) fn estimate(json: &serde_json::Value, set: &str, coefficient: &str, name: &str) -> (f64, [f64; 2]) {
    let sets = json["data_sets"].as_array().expect("data_sets is a list");
    let d = sets.iter().find(|d| d["name"] == set).expect("the data set is there");
    let p = d["parameters"]
        .as_array()
        .expect("parameters is a list")
        .iter()
        .find(|p| p["coefficient"] == coefficient && p["name"] == name)
        .unwrap_or_else(|| panic!("{coefficient} {name} is there"));
    let number = |v: &serde_json::Value| v.as_f64().expect("a number");
    (number(&p["estimate"]), [number(&p["ci95"][0]), number(&p["ci95"][1])])
}
