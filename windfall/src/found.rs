//! windfall: results that verbs take in turn. In: a JSON file, or its text. Out: an identification, or what the file is instead.

use crate::{Error, Result};
use serde_json::Value;
use std::path::Path;
use windfall_pid::Identification;
use windfall_scenarios::read_json;

/// Keys that the result of one verb alone has, and the verb. An identification is not among them.
const RESULTS: [(&[&str], &str); 9] = [
    (&["verdict", "effects"], "windfall close"),
    (&["runs", "trajectory"], "windfall resimulate"),
    (&["criterion", "coefficients"], "windfall structure"),
    (&["targets", "method"], "windfall plan"),
    (&["pairs", "bounds"], "windfall plan --separate"),
    (&["touch_down", "draws"], "windfall descend"),
    (&["checks", "verdict"], "windfall verify"),
    (&["outcomes", "campaigns"], "windfall many"),
    (&["study", "draws"], "windfall study"),
];

/// Reads the result of `windfall identify`.
///
/// ```
/// let no = windfall::read_identification("nowhere.json".as_ref()).expect_err("is not there").to_string();
/// assert!(no.contains("nowhere.json"), "{no}");
/// ```
///
/// # Errors
/// A file that cannot be read, or is something else: the message says what, and which command writes what is needed.
pub fn read_identification(path: &Path) -> Result<Identification> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json")) {
        let value: Value = read_json(path)?;
        is_of_no_other_verb(&path.display().to_string(), &value)?;
    } else if path.is_file() {
        return Err(other(&path.display().to_string(), "is no JSON file"));
    }
    Ok(read_json(path)?)
}

/// The same of a text; `name` is what a message calls it.
///
/// # Errors
/// As [`read_identification`].
pub fn identification_of(name: &str, json: &str) -> Result<Identification> {
    let value: Value = serde_json::from_str(json).map_err(|e| other(name, &format!("is no JSON: {e}")))?;
    is_of_no_other_verb(name, &value)?;
    serde_json::from_value(value).map_err(|e| other(name, &format!("is no identification as windfall identify writes it: {e}")))
}

/// Refuses the result of another verb. What is none of these is left to the reader, which says line and field.
fn is_of_no_other_verb(name: &str, value: &Value) -> Result<()> {
    if value.get("data_sets").is_some() {
        return Ok(());
    }
    match RESULTS.iter().find(|(keys, _)| keys.iter().all(|k| value.get(k).is_some())) {
        Some((_, verb)) => Err(other(name, &format!("is the result of {verb}"))),
        None => Ok(()),
    }
}

fn other(name: &str, what: &str) -> Error {
    let needed = "needed here: the result of windfall identify, identification.json";
    Error::Request(format!(
        "{name}: {what}; {needed}; try: windfall identify CAMPAIGN --out DIR writes it, DIR/identification.json"
    ))
}
