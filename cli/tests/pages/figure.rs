//! cli tests: a figure of a page. In: `FILE#PLACE`, with arithmetic from left to right; results of the page's commands. Out: the number.

use serde_json::Value;
use std::path::Path;

/// The number that an expression stands for: numbers and places in JSON files, with `+ - * /` between them, from left to right. A place without its file is
/// in the file before it.
pub(crate) fn value(folder: &Path, expression: &str) -> Result<f64, String> {
    let mut file = String::new();
    let mut so_far: Option<f64> = None;
    let mut operator = "+";
    for word in expression.split(' ') {
        if ["+", "-", "*", "/"].contains(&word) {
            operator = word;
            continue;
        }
        let now = match word.split_once('#') {
            Some((named, place)) => {
                if !named.is_empty() {
                    named.clone_into(&mut file);
                }
                let text = std::fs::read_to_string(folder.join(&file)).map_err(|e| format!("{file}: {e}"))?;
                let json: Value = serde_json::from_str(&text).map_err(|e| format!("{file}: {e}"))?;
                at(&json, place)?.as_f64().ok_or_else(|| format!("{file}#{place} is no number"))?
            }
            None => word.parse().map_err(|_| format!("{word}: a number, or FILE#PLACE"))?,
        };
        so_far = Some(match (so_far, operator) {
            (None, _) => now,
            (Some(a), "+") => a + now,
            (Some(a), "-") => a - now,
            (Some(a), "*") => a * now,
            (Some(a), _) => a / now,
        });
    }
    so_far.ok_or_else(|| "no expression".to_owned())
}

/// A place in JSON, `data_sets/combined/parameters/CA:CA_T0/ci95/1`: keys, indices, or words that an entry of a list has among its texts.
fn at<'j>(json: &'j Value, place: &str) -> Result<&'j Value, String> {
    let mut here = json;
    for step in place.split('/') {
        let next = match here {
            Value::Object(map) => map.get(step),
            Value::Array(list) => match step.parse::<usize>() {
                Ok(i) => list.get(i),
                Err(_) => list.iter().find(|e| step.split(':').all(|w| has(e, w))),
            },
            _ => None,
        };
        here = next.ok_or_else(|| format!("no {step} of {place}"))?;
    }
    Ok(here)
}

fn has(entry: &Value, word: &str) -> bool {
    entry.as_object().is_some_and(|o| o.values().any(|v| v.as_str() == Some(word)))
}

#[test]
fn law_places_and_arithmetic() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let json = r#"{"sets": [{"name": "all", "ps": [{"c": "Cm", "name": "a", "x": 2.0}, {"c": "Cn", "name": "a", "x": 5.0}]}]}"#;
    std::fs::write(folder.path().join("r.json"), json).expect("writable");
    let of = |e: &str| value(folder.path(), e);
    assert_eq!(of("r.json#sets/all/ps/Cn:a/x"), Ok(5.0));
    assert_eq!(of("r.json#sets/0/ps/Cn:a/x - #sets/0/ps/0/x * 10"), Ok(30.0));
    assert!(of("r.json#sets/none/ps").is_err() && of("s.json#x").is_err() && of("").is_err());
}
