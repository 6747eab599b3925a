//! tests: files that use each other. In: the rooms' sources. Out: no circle of files of one room, however long, but of a folder's own file
//! with what is in the folder.
//!
//! Read are the paths that begin with `crate`, `super` or `self`, in `use` and elsewhere; comments and unit tests are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A file as a module: its names from the root of its room.
type Module = Vec<String>;

/// Modules of a room with their text.
fn modules(folder: &Path, at: &[String], out: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources").flatten() {
        let path = entry.path();
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let own: Module = at.iter().cloned().chain([stem.clone()]).collect();
        if path.is_dir() {
            modules(&path, &own, out);
        } else if path.extension().is_some_and(|e| e == "rs") && !["main", "tests"].contains(&stem.as_str()) {
            let module = if ["lib", "mod"].contains(&stem.as_str()) { at.to_vec() } else { own };
            out.insert(module, plain(&std::fs::read_to_string(&path).expect("text")));
        }
    }
}

/// Code without comments and unit tests.
fn plain(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    code.lines().map(|l| l.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Every path in code that begins with one of these words, lists in braces taken apart.
fn paths(code: &str) -> Vec<String> {
    let mut all = Vec::new();
    for word in ["crate::", "super::", "self::"] {
        let begins = code.match_indices(word).map(|(i, _)| i);
        let apart = begins.filter(|&i| !code[..i].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':'));
        apart.for_each(|i| {
            taken_apart("", &code[i..], &mut all);
        });
    }
    all
}

/// Reads one path, its braces included, and says where it ends.
fn taken_apart(head: &str, code: &str, all: &mut Vec<String>) -> usize {
    let end = code.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(code.len());
    let path = format!("{head}{}", &code[..end]);
    if !(path.ends_with("::") && code[end..].starts_with('{')) {
        all.push(path);
        return end;
    }
    let mut at = end + 1;
    while at < code.len() && !code[at..].starts_with('}') {
        let rest = &code[at..];
        let skip = rest.find(|c: char| c.is_alphanumeric() || c == '_' || c == '}').unwrap_or(rest.len());
        at += skip;
        if !code[at..].starts_with('}') {
            at += taken_apart(&path, &code[at..], all);
        }
    }
    at + 1
}

/// The file that a path of `module` leads to.
fn file_of(path: &str, module: &Module, known: &BTreeMap<Module, String>) -> Option<Module> {
    let mut names: Vec<&str> = path.split("::").filter(|n| !n.is_empty()).collect();
    let mut at = if names.first() == Some(&"crate") { Vec::new() } else { module.clone() };
    while let Some(word) = names.first().copied().filter(|w| ["crate", "super", "self"].contains(w)) {
        if word == "super" {
            at.pop();
        }
        names.remove(0);
    }
    at.extend(names.into_iter().map(str::to_owned));
    (0..=at.len()).rev().map(|n| at[..n].to_vec()).find(|m| known.contains_key(m))
}

/// Files of a room that each module uses, but those above and below it.
fn uses(known: &BTreeMap<Module, String>) -> BTreeMap<&Module, BTreeSet<Module>> {
    let above = |a: &Module, b: &Module| a.starts_with(b) || b.starts_with(a);
    let of = |module: &Module, code: &str| {
        let all = paths(code);
        let files = all.iter().filter_map(|p| file_of(p, module, known));
        files.filter(|f| !above(f, module)).collect()
    };
    known.iter().map(|(module, code)| (module, of(module, code))).collect()
}

/// Modules that come back to themselves.
fn circles(uses: &BTreeMap<&Module, BTreeSet<Module>>) -> Vec<Module> {
    let comes_back = |from: &Module| {
        let mut seen: BTreeSet<&Module> = BTreeSet::new();
        let mut open: Vec<&Module> = uses[from].iter().collect();
        while let Some(m) = open.pop() {
            if m == from {
                return true;
            }
            if seen.insert(m) {
                open.extend(&uses[m]);
            }
        }
        false
    };
    uses.keys().filter(|m| comes_back(m)).map(|m| (*m).clone()).collect()
}

#[test]
fn law_no_circle_of_files() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut rooms = 0;
    for entry in std::fs::read_dir(&root).expect("the workspace").flatten() {
        let sources = entry.path().join("src");
        if !entry.path().join("Cargo.toml").is_file() || !sources.is_dir() {
            continue;
        }
        let mut known = BTreeMap::new();
        modules(&sources, &[], &mut known);
        let found = circles(&uses(&known));
        let names: Vec<String> = found.iter().map(|m| m.join("::")).collect();
        assert!(found.is_empty(), "{}: in a circle: {}", entry.path().display(), names.join(", "));
        rooms += 1;
    }
    assert!(rooms >= 13, "{rooms} rooms read");
}

/// The reader sees what it is meant to see.
#[test]
fn law_a_circle_is_seen() {
    let file = |names: &[&str], text: &str| (names.iter().map(|n| (*n).to_owned()).collect::<Module>(), plain(text));
    let known = BTreeMap::from([
        file(&[], "mod a; mod b;"),
        file(&["a"], "use crate::b::{B, c::{D, E}};\n// use crate::e;"),
        file(&["b"], "mod c;"),
        file(&["b", "c"], "fn f() { super::super::d::g() }"),
        file(&["d"], "fn g() -> crate::a::A {}\n#[cfg(test)]\nmod tests { use crate::e::E; }"),
        file(&["e"], "use super::d::g;"),
    ]);
    let names: Vec<String> = circles(&uses(&known)).iter().map(|m| m.join("::")).collect();
    assert_eq!(names, ["a", "b::c", "d"]);
}
