//! model: the list of effects, made from the files of their folder. In: `src/effects/`. Out: a module of each, and `CATALOGUE`.

use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};
use std::{env, fs, io};

/// The way from one folder to another. A path of the whole machine in an attribute would make the program's bytes depend on the folder
/// that it is built in, which no `--remap-path-prefix` reaches.
fn way(from: &Path, to: &Path) -> PathBuf {
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return to.to_path_buf();
    }
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(to.components().skip(shared)).collect()
}

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src/effects");
    let named = |name| env::var_os(name).map(PathBuf::from).ok_or_else(|| io::Error::other("cargo names its folders"));
    // Links followed, or `..` would leave them for somewhere else.
    let (folder, out) =
        (fs::canonicalize(named("CARGO_MANIFEST_DIR")?.join("src/effects"))?, fs::canonicalize(named("OUT_DIR")?)?);
    let mut names = Vec::new();
    for entry in fs::read_dir(&folder)? {
        let path = entry?.path();
        let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        if path.extension().is_some_and(|e| e == "rs") && stem != "mod" {
            names.push(stem);
        }
    }
    names.sort();
    let mut text = String::new();
    for name in &names {
        let _ = writeln!(text, "#[path = {:?}]\nmod {name};", way(&out, &folder).join(format!("{name}.rs")));
    }
    let all: Vec<String> = names.iter().map(|n| format!("&{n}::EFFECT")).collect();
    let _ = writeln!(
        text,
        "/// All effects, alphabetical by file.\npub static CATALOGUE: [&Effect; {}] = [{}];",
        all.len(),
        all.join(", ")
    );
    fs::write(out.join("catalogue.rs"), text)
}
