//! scenarios: the key reference. In: the tables of keys that the reader checks by, lists of columns and effects. Out: Markdown.

use crate::keys::{ALL, Key, Kind, TableSpec};
use crate::table::allowed_range;
use std::fmt::Write as _;

/// Every key of every file as Markdown: kind, unit, what is allowed, whether it is needed, meaning; then columns of runs, axes, variables
/// of structures and effects.
#[must_use]
pub fn key_reference() -> String {
    let mut text = String::from("# Keys of the files\n\nMade from the tables that the reader checks by; do not edit.\n");
    for (title, tables) in ALL {
        let _ = write!(text, "\n## {title}\n");
        tables.iter().for_each(|t| table_text(&mut text, t));
    }
    crate::reference_lists::lists(&mut text);
    text
}

/// What one key of the files means.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyMeaning {
    /// Kind of file.
    pub file: &'static str,
    /// Its table, empty at the top.
    pub table: &'static str,
    /// Name.
    pub name: &'static str,
    /// Unit, `-` for none.
    pub unit: &'static str,
    /// What is allowed, in words.
    pub allowed: String,
    /// Whether it has to be there.
    pub needed: bool,
    /// Meaning.
    pub meaning: &'static str,
}

/// Every key of that name, in whichever file and table; `vehicle.mass_kg` is the one of a table.
#[must_use]
pub fn meanings(word: &str) -> Vec<KeyMeaning> {
    let (table, name) = word.rsplit_once('.').map_or((None, word), |(t, n)| (Some(t), n));
    let mut all = Vec::new();
    for (file, tables) in ALL {
        for t in tables.iter().filter(|t| table.is_none_or(|wanted| t.path == wanted)) {
            all.extend(t.keys.iter().filter(|k| k.name == name).map(|k| KeyMeaning {
                file,
                table: t.path,
                name: k.name,
                unit: k.unit,
                allowed: allowed(k),
                needed: k.needed,
                meaning: k.meaning,
            }));
        }
    }
    all
}

fn table_text(text: &mut String, t: &TableSpec) {
    let place = if t.path.is_empty() { "top level".to_owned() } else { format!("`[{}]`", t.path) };
    let _ = write!(text, "\n### {place}\n\n{}\n", t.meaning);
    if !t.keys.is_empty() {
        text.push_str("\n| key | unit | needed | allowed | meaning |\n|---|---|---|---|---|\n");
    }
    for k in t.keys {
        let needed = if k.needed { "yes" } else { "no" };
        let _ = writeln!(text, "| `{}` | {} | {needed} | {} | {} |", k.name, k.unit, allowed(k), k.meaning.replace('|', "\\|"));
    }
}

fn allowed(k: &Key) -> String {
    let range = || allowed_range(k.range, "-").replace("must be a finite number", "finite");
    match k.kind {
        Kind::Number => range(),
        Kind::Integer => format!("whole, {}", range()),
        Kind::Numbers(n) => format!("{n} numbers, each {}", range()),
        Kind::Series => format!("two numbers or more, each {}", range()),
        Kind::Text => "text".to_owned(),
        Kind::Choice(words) => words.join(", "),
        Kind::WordOrTable(words) => format!("{}, table", words.join(", ")),
        Kind::Bool => "true, false".to_owned(),
        Kind::Words => "list of names".to_owned(),
        Kind::Setting => "number, name of a run input".to_owned(),
        Kind::Settings => "three numbers or names of run inputs".to_owned(),
        Kind::Column => "name, number, table".to_owned(),
        Kind::Table => "table".to_owned(),
        Kind::Tables => "one table or more".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    /// What a file may hold is in the reference: columns that are read, effects, variables of structures.
    #[test]
    fn law_the_reference_has_columns_effects_and_variables() {
        let text = super::key_reference();
        let columns = crate::run_columns::RUN_COLUMNS.iter().map(|c| c.name.to_owned());
        let effects = windfall_model::CATALOGUE.iter().map(|e| e.family.to_owned());
        let variables = windfall_model::Variable::ALL.iter().map(|v| v.name().to_owned());
        let all: Vec<String> = columns.chain(effects).chain(variables).collect();
        let lacking: Vec<&String> = all.iter().filter(|n| !text.contains(&format!("`{n}`"))).collect();
        assert!(lacking.is_empty(), "{lacking:?}");
    }

    #[test]
    fn frozen_reference_file_is_current() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/keys.md");
        if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() {
            crate::text_atomically(&path, &super::key_reference()).expect("the folder of the reference is writable");
        }
        let stored = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(stored == super::key_reference(), "docs/reference/keys.md is old: run `just references`");
    }
}
