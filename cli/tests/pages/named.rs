//! cli tests: commands that no test runs for their length. In: their words. Out: whether what they name is there: verbs, flags, scripts, tests.

use crate::root;
use std::path::Path;

/// What a command of another program names and is not there.
pub(crate) fn missing(command: &str) -> Option<String> {
    let words: Vec<&str> = command.split(' ').filter(|w| !w.contains('=') || w.starts_with('-')).collect();
    let gone = |what: &str| Some(format!("{command}: {what}: is not there"));
    match *words.first()? {
        script if script.starts_with("scripts/") => (!root().join(script).exists()).then(|| gone(script)).flatten(),
        "python" => {
            let file = words.iter().find(|w| w.ends_with(".py"))?;
            let there = root().join(file).exists() || root().join("python/benches").join(file).exists();
            if there { None } else { gone(file) }
        }
        "just" => {
            let recipes = std::fs::read_to_string(root().join("justfile")).expect("a file of the workspace");
            let recipe = words.get(1)?;
            if recipes.lines().any(|l| l.starts_with(&format!("{recipe}:"))) { None } else { gone(recipe) }
        }
        "cargo" if ["test", "bench"].contains(words.get(1)?) => tests(&words).and_then(|what| gone(&what)),
        _ => None,
    }
}

/// What an order of tests or benches names and is not there.
fn tests(words: &[&str]) -> Option<String> {
    let after = |flag: &str| words.iter().position(|w| *w == flag).and_then(|i| words.get(i + 1)).copied();
    let folder = match after("-p") {
        Some(package) => root().join(package.trim_start_matches("windfall-")),
        None => root(),
    };
    if !folder.is_dir() {
        return after("-p").map(str::to_owned);
    }
    let source = all_source(&folder);
    let values = |flags: &[&str]| -> Vec<&str> { words.windows(2).filter(|w| flags.contains(&w[0])).map(|w| w[1]).collect() };
    let (targets, of_flags) = (values(&["--test", "--bench"]), values(&["-p", "--test", "--bench"]));
    let filters = words[2..].iter().filter(|w| !w.starts_with('-') && !of_flags.contains(w));
    let parts =
        filters.flat_map(|f| f.split("::")).filter(|p| !p.is_empty() && p.chars().all(|c| c.is_alphanumeric() || c == '_'));
    let target = |t: &&&str| -> bool {
        let files = ["tests", "benches"].map(|d| [format!("{d}/{t}.rs"), format!("{d}/{t}/main.rs")]);
        !files.iter().flatten().any(|f| source.iter().any(|(path, _)| path.ends_with(f)))
            && !source.iter().any(|(path, text)| path.ends_with("Cargo.toml") && text.contains(&format!("name = \"{t}\"")))
    };
    let part = |p: &&str| {
        let is = |text: &str| ["fn ", "mod "].iter().any(|k| text.lines().any(|l| l.contains(k) && l.contains(p)));
        !source.iter().any(|(path, text)| path.contains(&format!("/{p}")) || is(text))
    };
    targets.iter().find(target).map(|t| (*t).to_owned()).or_else(|| parts.clone().find(part).map(str::to_owned))
}

/// Paths and texts of the sources of a folder.
fn all_source(folder: &Path) -> Vec<(String, String)> {
    let mut all = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
            if entry.file_type().is_ok_and(|t| t.is_dir()) {
                if name != "target" && !name.starts_with('.') {
                    folders.push(path);
                }
            } else if name.ends_with(".rs") || name == "Cargo.toml" {
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                all.push((path.to_string_lossy().into_owned(), text));
            }
        }
    }
    all
}

/// A verb or flag of windfall's that a command names and the program does not have.
pub(crate) fn unknown(command: &str) -> Option<String> {
    let flags = std::fs::read_to_string(root().join("docs/reference/flags.md")).expect("a page");
    let words: Vec<&str> = command.split(' ').collect();
    let verb = *words.get(1).filter(|v| !v.starts_with('-'))?;
    let heads = |title: &str| flags.split("\n## ").filter(|s| s.starts_with(title)).collect::<String>();
    let of_verb = heads(&format!("`windfall {verb}"));
    if of_verb.is_empty() {
        return Some(format!("{command}: no verb {verb}"));
    }
    let all = of_verb + &heads("Every verb");
    let has = |f: &str| [format!("`{f}`"), format!("`{f} ")].iter().any(|w| all.contains(w));
    let wrong = words.iter().filter(|w| w.starts_with("--")).find(|f| !has(f))?;
    Some(format!("{command}: no flag {wrong}"))
}

#[test]
fn law_what_a_long_command_names_is_there() {
    assert_eq!(missing("WINDFALL_DRAWS=24 cargo test -p windfall-cli --test pages -- --ignored frozen_commands"), None);
    for gone in
        ["cargo test -p windfall-nowhere", "cargo test -p windfall-cli --test nowhere", "just nothing", "scripts/nowhere a"]
    {
        assert!(missing(gone).is_some(), "{gone}");
    }
    let nowhere = ["no", "such", "test"].join("_");
    assert!(missing(&format!("cargo test -p windfall-cli --test pages {nowhere}")).is_some());
    assert_eq!(unknown("windfall plan FILE --separate --json"), None);
    assert!(unknown("windfall plan FILE --seperate").is_some() && unknown("windfall fly FILE").is_some());
}
