//! windfall: first minutes. In: a run file; a word. Out: a commented campaign; what the word means and where that is from.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::Path;
use windfall_model::CATALOGUE;
use windfall_scenarios::{campaign_of_run, meanings};

/// What is explained.
///
/// ```
/// use windfall::{Explain, explain};
/// let said = explain(&Explain { words: vec!["center-of-mass".to_owned()] })?;
/// assert!(said.starts_with("center-of-mass: a family of effects"));
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Explain {
    /// Family of effects (center-of-mass), key of a file (mass_kg, vehicle.mass_kg), or a warning: families and keys that it names
    #[cfg_attr(feature = "cli", arg(required = true, value_name = "FAMILY|WARNING|KEY"))]
    pub words: Vec<String>,
}

/// A commented campaign for a run file; what was guessed is marked as a guess, and what no record tells is left to be filled in.
///
/// # Errors
/// A file that is no run file, or without time and position.
pub fn init(run: &Path) -> Result<String> {
    Ok(campaign_of_run(run)?)
}

/// What a family, a key or a warning means: meaning, physics, source, from the catalogue and the table of keys.
///
/// # Errors
/// Words of which none is a family or a key.
pub fn explain(request: &Explain) -> Result<String> {
    let said = request.words.join(" ");
    let mut words: Vec<&str> = said
        .split(|c: char| !(c.is_alphanumeric() || "-_.".contains(c)))
        .map(|w| w.trim_matches('.'))
        .filter(|w| !w.is_empty())
        .collect();
    words.sort_unstable();
    words.dedup();
    let text: String = words.iter().map(|w| family(w) + &keys(w)).collect();
    if text.is_empty() {
        let families: Vec<&str> = CATALOGUE.iter().map(|e| e.family).collect();
        let what =
            format!("{said}: no family of effects and no key; families: {}; keys: windfall check --keys", families.join(", "));
        return Err(Error::Request(what));
    }
    Ok(text)
}

fn family(word: &str) -> String {
    let mut out = String::new();
    for e in CATALOGUE.iter().filter(|e| e.family == word) {
        let _ = write!(
            out,
            "{}: a family of effects\n  {}\n  source: {}\n  told apart by: {}\n",
            e.family, e.physics, e.source, e.separate_by
        );
        for p in (e.parameters)(&[]) {
            let _ = writeln!(out, "  {} ({}), null {}", p.name, if p.unit == "-" { "no unit" } else { p.unit }, p.null);
        }
    }
    out
}

fn keys(word: &str) -> String {
    let mut out = String::new();
    for k in meanings(word) {
        let table = if k.table.is_empty() { "top level".to_owned() } else { format!("[{}]", k.table) };
        let needed = if k.needed { "needed" } else { "optional" };
        let unit = if k.unit == "-" { String::new() } else { format!(", unit {}", k.unit) };
        let _ = write!(
            out,
            "{}: a key of {table} ({}), {needed}{unit}\n  {}\n  allowed: {}\n",
            k.name,
            k.file.to_lowercase(),
            k.meaning,
            k.allowed
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_every_family_and_keys_are_explained() {
        for e in CATALOGUE {
            let text = explain(&Explain { words: vec![e.family.to_owned()] }).expect("of the catalogue");
            assert!(text.contains(e.physics) && text.contains(e.source), "{text}");
        }
        let text = explain(&Explain { words: vec!["vehicle.mass_kg".to_owned()] }).expect("a key");
        assert!(text.contains("[vehicle]") && text.contains("kg"), "{text}");
        let warning = "the record says center-of-mass; see drag_area_m2".to_owned();
        let text = explain(&Explain { words: vec![warning] }).expect("a family and a key");
        assert!(text.contains("family of effects") && text.contains("[tether]"), "{text}");
        assert!(explain(&Explain { words: vec!["nothing-of-ours".to_owned()] }).is_err());
    }
}
