//! windfall: first minutes. In: a run file; a word. Out: a commented campaign; what the word means and where that is from.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::path::PathBuf;
use windfall_model::CATALOGUE;
use windfall_scenarios::{Draft, DraftKind, draft_campaign, meanings};

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
    /// Family of effects (center-of-mass), key of a file (mass_kg, vehicle.mass_kg), word on the screen (p(white), "condition number"), or a
    /// warning: those that it names
    #[cfg_attr(feature = "cli", arg(required = true, value_name = "FAMILY|KEY|WORD|WARNING"))]
    pub words: Vec<String>,
}

/// What a first campaign is to be.
///
/// ```
/// use windfall::{DraftKind, Init};
/// let request: Init = serde_json::from_str(r#"{"kind": "free-flight"}"#).expect("a request");
/// assert_eq!(request.kind, Some(DraftKind::FreeFlight));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Init {
    /// Kind of campaign [default: guessed from the columns]
    #[cfg_attr(feature = "cli", arg(long, value_name = "KIND", value_parser = kind()))]
    pub kind: Option<DraftKind>,
}

/// Kinds by name, each with a line of help.
#[cfg(feature = "cli")]
fn kind() -> impl clap::builder::TypedValueParser<Value = DraftKind> {
    use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser as _};
    let named = PossibleValuesParser::new(DraftKind::ALL.map(|k| PossibleValue::new(k.name()).help(k.help())));
    named.try_map(|name| DraftKind::of_name(&name).ok_or_else(|| Error::Request(format!("no kind {name}"))))
}

/// A commented campaign for run files, the last of several held out. Guesses are marked, what no record tells is left to be filled in, and
/// columns that are left out are named.
///
/// # Errors
/// A file that is no run file, or without what its kind of campaign needs.
pub fn init(runs: &[PathBuf], request: &Init) -> Result<Draft> {
    let Init { kind } = request;
    Ok(draft_campaign(runs, *kind)?)
}

/// What a family, a key, a word on the screen or a warning means: from the catalogue, the table of keys and the glossary.
///
/// # Errors
/// Words of which none is a family, a key or a word that the program prints.
pub fn explain(request: &Explain) -> Result<String> {
    let said = request.words.join(" ");
    let mut words: Vec<&str> = said
        .split(|c: char| !(c.is_alphanumeric() || "-_.".contains(c)))
        .map(|w| w.trim_matches('.'))
        .filter(|w| !w.is_empty())
        .collect();
    words.sort_unstable();
    words.dedup();
    let text: String = words.iter().map(|w| family(w) + &keys(w)).collect::<String>() + &crate::glossary::explained(&said);
    if text.is_empty() {
        let families: Vec<&str> = CATALOGUE.iter().map(|e| e.family).collect();
        let what = format!(
            "{said}: no family of effects, no key and no word of the screen; families: {}; keys: windfall check --keys; words: {} and others",
            families.join(", "),
            crate::glossary::some()
        );
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
