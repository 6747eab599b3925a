//! cli: the requests as Python and the documentation say them. In: the requests' fields and the flags made of them. Out:
//! `python/py/windfall/_requests.py` and `docs/reference/flags.md`, held against what is stored; `just references` writes them anew.

use crate::args::Cli;
use clap::{ArgAction, CommandFactory as _};
use serde::Serialize;
use serde_json::Value;
use std::any::TypeId;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A type of a field: its annotation in Python, and where Python writes `{first: rest}`, the names of an entry in JSON. Without an
/// annotation the function's own words stand for the field.
struct Kind {
    id: TypeId,
    annotation: Option<&'static str>,
    entry: &'static [&'static str],
}

fn kinds() -> [Kind; 16] {
    fn kind<T: 'static>(annotation: &'static str, entry: &'static [&'static str]) -> Kind {
        Kind { id: TypeId::of::<T>(), annotation: Some(annotation), entry }
    }
    [
        kind::<bool>("bool", &[]),
        kind::<u16>("int", &[]),
        kind::<u32>("int", &[]),
        kind::<u64>("int", &[]),
        kind::<usize>("int", &[]),
        kind::<f64>("float", &[]),
        kind::<String>("str", &[]),
        kind::<windfall::Method>("str", &[]),
        kind::<windfall::Criterion>("str", &[]),
        kind::<windfall::DraftKind>("str", &[]),
        kind::<windfall::Shard>("Sequence[int]", &[]),
        kind::<windfall::Held>("Mapping[str, float]", &["name", "value"]),
        kind::<windfall::Tie>("Mapping[str, str]", &["name", "to"]),
        kind::<windfall::Cutoff>("Mapping[str, float]", &["channel", "hz"]),
        kind::<windfall::Prior>("Mapping[str, tuple[float, float]]", &["name", "mean", "std"]),
        // `percent` and `absolute` of `windfall.plan`.
        Kind { annotation: None, ..kind::<windfall::Target>("", &[]) },
    ]
}

/// A request: its name, the verb that takes it, its fields by name with their defaults.
struct Request {
    name: &'static str,
    verb: &'static [&'static str],
    defaults: Vec<(String, Value)>,
}

fn request<R: Serialize + Default>(name: &'static str, verb: &'static [&'static str]) -> Request {
    let Ok(Value::Object(fields)) = serde_json::to_value(R::default()) else { panic!("{name} is a table of fields") };
    Request { name, verb, defaults: fields.into_iter().collect() }
}

/// Every request that a verb of Python takes by keyword.
fn requests() -> [Request; 10] {
    [
        request::<windfall::Fly>("Fly", &["simulate"]),
        request::<windfall::Identify>("Identify", &["identify"]),
        request::<windfall::Structure>("Structure", &["structure"]),
        request::<windfall::Plan>("Plan", &["plan"]),
        request::<windfall::Resimulate>("Resimulate", &["resimulate"]),
        request::<windfall::Descend>("Descend", &["descend"]),
        request::<windfall::Close>("Close", &["close"]),
        request::<windfall::Study>("Study", &["study"]),
        request::<windfall::Init>("Init", &["init"]),
        request::<windfall::Many>("Many", &["many", "close"]),
    ]
}

fn command(verb: &[&str]) -> clap::Command {
    verb.iter().fold(Cli::command(), |c, word| c.find_subcommand(word).unwrap_or_else(|| panic!("{word} is a verb")).clone())
}

/// The flag of a field: a field without one is a field that the program cannot be given.
fn flag<'c>(command: &'c clap::Command, field: &str) -> &'c clap::Arg {
    let found = command.get_arguments().find(|a| a.get_id() == field);
    found.unwrap_or_else(|| panic!("{} has no flag of the field {field}", command.get_name()))
}

fn kind(arg: &clap::Arg) -> Kind {
    let id = arg.get_value_parser().type_id();
    let found = kinds().into_iter().find(|k| id == k.id);
    found.unwrap_or_else(|| panic!("{}: say in `kinds` what its type is in Python", arg.get_id()))
}

/// The help of a flag as one line, with the words that it may be.
fn help(arg: &clap::Arg) -> String {
    let words: Vec<String> = arg.get_possible_values().iter().map(|v| v.get_name().to_owned()).collect();
    let listed = if words.is_empty() || matches!(arg.get_action(), ArgAction::SetTrue) {
        String::new()
    } else {
        format!("; one of {}", words.join(", "))
    };
    arg.get_help().map(ToString::to_string).unwrap_or_default() + &listed
}

/// A text in lines of up to 130 characters, all but the first indented.
fn wrapped(text: &str, indent: &str) -> String {
    let (mut out, mut length) = (String::new(), 0);
    for word in text.split_whitespace() {
        if length > 0 && indent.len() + length + 1 + word.chars().count() > 130 {
            out += &format!("\n{indent}");
            length = 0;
        } else if length > 0 {
            out.push(' ');
            length += 1;
        }
        out += word;
        length += word.chars().count();
    }
    out
}

/// The module of Python's keywords.
fn python() -> String {
    let mut text = String::from(
        "\"\"\"What each verb takes by keyword. Written by `just references` from windfall/src/requests.rs; do not edit.\"\"\"\n\n\
         from __future__ import annotations\n\nfrom collections.abc import Mapping, Sequence\nfrom typing import TypedDict\n\n\
         __all__ = [\"CHOICES\", \"ENTRIES\", \"Close\", \"Descend\", \"Fly\", \"Identify\", \"Init\", \"Many\", \"Plan\", \"Resimulate\", \"Structure\", \"Study\"]\n",
    );
    let (mut entries, mut choices) = (String::new(), BTreeMap::new());
    for r in requests() {
        let command = command(r.verb);
        let (mut docs, mut fields) = (String::new(), String::new());
        for (field, default) in &r.defaults {
            let arg = flag(&command, field);
            let Kind { annotation: Some(annotation), entry, .. } = kind(arg) else { continue };
            let _ = writeln!(fields, "    {field}: {annotation} | None");
            let said = match default {
                Value::Null | Value::Bool(false) => String::new(),
                Value::Array(list) if list.is_empty() => String::new(),
                value => format!(" [default: {}]", value.as_str().map_or_else(|| value.to_string(), str::to_owned)),
            };
            let line = format!("{field}: {}{said}", help(arg)).replace('\\', "\\\\");
            let _ = writeln!(docs, "    {}", wrapped(&line, "        "));
            let words: Vec<String> = arg.get_possible_values().iter().map(|v| format!("\"{}\"", v.get_name())).collect();
            if !words.is_empty() && arg.get_action().takes_values() {
                choices.insert(field.clone(), words.join(", "));
            }
            if !entry.is_empty() {
                let names: Vec<String> = entry.iter().map(|n| format!("\"{n}\"")).collect();
                let _ = writeln!(entries, "    \"{field}\": ({}),", names.join(", "));
            }
        }
        let nothing = "    \"\"\"Nothing.\"\"\"\n".to_owned();
        let docs = if docs.is_empty() { nothing } else { format!("    \"\"\"\n{docs}    \"\"\"\n\n") };
        let _ = write!(text, "\n\nclass {}(TypedDict, total=False):\n{docs}{fields}", r.name);
    }
    let choices: String = choices.iter().map(|(field, words)| format!("    \"{field}\": ({words}),\n")).collect();
    let _ = write!(text, "\n\n#: Words that a keyword may be.\nCHOICES = {{\n{choices}}}\n");
    let _ = write!(text, "\n#: Names of what a mapping of the first to the rest holds.\nENTRIES = {{\n{entries}}}\n");
    text
}

/// Every flag of every verb as Markdown.
fn flags() -> String {
    let mut text = String::from(
        "# Flags\n\nMade from what the program reads; do not edit. Below the table of a verb stands what each of its flags means.\n",
    );
    let mut all: Vec<(String, clap::Command)> = Vec::new();
    for c in Cli::command().get_subcommands() {
        let below: Vec<(String, clap::Command)> =
            c.get_subcommands().map(|s| (format!("{} {}", c.get_name(), s.get_name()), s.clone())).collect();
        if below.is_empty() { all.push((c.get_name().to_owned(), c.clone())) } else { all.extend(below) }
    }
    for (name, c) in all {
        let _ = write!(text, "\n## `windfall {name}`\n\n{}\n\n", c.get_about().map(ToString::to_string).unwrap_or_default());
        for a in c.get_arguments().filter(|a| !a.is_hide_set() && a.get_id() != "help" && !COMMON.contains(&a.get_id().as_str()))
        {
            let value = a.get_value_names().and_then(|v| v.first()).filter(|_| a.get_action().takes_values());
            let name = match (a.get_long(), value) {
                (Some(long), Some(value)) => format!("--{long} {value}"),
                (Some(long), None) => format!("--{long}"),
                (None, value) => value.map_or_else(|| a.get_id().to_string(), ToString::to_string),
            };
            let default: Vec<String> = a.get_default_values().iter().map(|v| v.to_string_lossy().into_owned()).collect();
            let default = if default.is_empty() || !a.get_action().takes_values() {
                String::new()
            } else {
                format!(" [default: {}]", default.join(", "))
            };
            let _ = writeln!(text, "- `{name}`: {}{default}", help(a));
        }
    }
    let common = command(&["identify"]);
    text += "\n## Every verb\n\n";
    for id in COMMON {
        let a = flag(&common, id);
        let _ = writeln!(text, "- `--{id}`: {}", help(a));
    }
    text
}

/// Flags that every verb has.
const COMMON: [&str; 5] = ["out", "force", "json", "quiet", "threads"];

#[test]
fn law_python_and_the_documentation_say_what_the_requests_say() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (path, now) in [("python/py/windfall/_requests.py", python()), ("docs/reference/flags.md", flags())] {
        let path = root.join(path);
        if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() {
            std::fs::write(&path, &now).expect("a file of the workspace");
        }
        let stored = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(stored == now, "{} is old: run `just references`", path.display());
    }
}
