//! model: the list of effects, made from the files of their folder. In: `src/effects/`. Out: a module of each, and `CATALOGUE`.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src/effects");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/effects");
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
        let _ = writeln!(text, "#[path = {:?}]\nmod {name};", folder.join(format!("{name}.rs")));
    }
    let all: Vec<String> = names.iter().map(|n| format!("&{n}::EFFECT")).collect();
    let _ = writeln!(
        text,
        "/// All effects, alphabetical by file.\npub static CATALOGUE: [&Effect; {}] = [{}];",
        all.len(),
        all.join(", ")
    );
    let out = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("cargo names a folder"))?;
    fs::write(Path::new(&out).join("catalogue.rs"), text)
}
