//! cli tests: the pages of the documentation. In: README, CONTRIBUTING and all pages below `docs/`. Out: every command run as it stands, in the order of its
//! page; recorded output and figures within their last digit.
//!
//! What marks a page may have: `page.rs`. `WINDFALL_WRITE_REFERENCE=1` writes what came out into the pages, which are then to be read;
//! `WINDFALL_PAGES=howto,many` runs some of them.

#![cfg(unix)]

mod figure;
mod named;
mod page;
mod runner;
mod text;

use page::{What, items};
use runner::{Memory, Runner};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// The workspace.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Pages that are written from the code.
const WRITTEN: [&str; 4] = ["flags.md", "keys.md", "bad-input.md", "parity.md"];

/// Every page, by its path from the workspace, with its text.
fn pages() -> Vec<(String, String)> {
    let mut all = vec!["README.md".to_owned(), "CONTRIBUTING.md".to_owned()];
    let mut folders = vec!["docs".to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a folder of the workspace").flatten() {
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                folders.push(path);
            } else if path.ends_with(".md") && !WRITTEN.iter().any(|w| path.ends_with(&format!("reference/{w}"))) {
                all.push(path);
            }
        }
    }
    all.sort();
    let read = |p: &String| std::fs::read_to_string(root().join(p)).expect("a page");
    all.iter().map(|p| (p.clone(), read(p))).collect()
}

/// Runs pages, two at a time; what is wrong with them.
fn run(pages: &[(String, String)], nightly: bool) -> Vec<String> {
    let (next, memory, faults) = (AtomicUsize::new(0), Memory::default(), Mutex::new(Vec::new()));
    let work = || {
        while let Some((name, text)) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (wrong, renewed) = Runner::new(name, text, nightly, &memory).walk();
            if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() && renewed != *text {
                std::fs::write(root().join(name), renewed).expect("a page of the workspace");
            }
            faults.lock().unwrap_or_else(PoisonError::into_inner).extend(wrong);
        }
    };
    std::thread::scope(|s| {
        s.spawn(work);
        s.spawn(work);
    });
    let mut all = faults.into_inner().unwrap_or_else(PoisonError::into_inner);
    all.sort();
    all
}

/// Pages that `WINDFALL_PAGES` names by parts of their paths (`howto,many`); all without it.
fn asked_for() -> Vec<(String, String)> {
    let asked = std::env::var("WINDFALL_PAGES").unwrap_or_default();
    let is = |(name, _): &(String, String)| asked.is_empty() || asked.split(',').any(|part| name.contains(part));
    pages().into_iter().filter(is).collect()
}

#[test]
fn frozen_commands_and_figures_of_every_page() {
    let wrong = run(&asked_for(), false);
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n\n"));
}

/// Pages with a mark `nightly`, all of them.
#[test]
#[ignore = "slow: about a quarter of an hour; nightly"]
fn frozen_commands_and_figures_of_minutes() {
    let long =
        |(_, text): &(String, String)| items(text).iter().any(|i| matches!(&i.what, What::Mark(m) if m.starts_with("nightly")));
    let wrong = run(&asked_for().into_iter().filter(long).collect::<Vec<_>>(), true);
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n\n"));
}

/// Marks of what no test of every day runs: page and reason. One more of them is to be written here as well.
const LEFT_OUT: &[(&str, &str)] = &[
    ("README.md", "not run: installs the program"),
    ("README.md", "not run: needs a run file of your own"),
    ("docs/descent.md", "nightly: 3 min"),
    ("docs/many.md", "not run: folders of your own"),
    ("docs/measured.md", "nightly: 10 min"),
    ("docs/measured.md", "not run: FOLDER is each set's"),
    ("docs/own-columns.md", "not run: after the blanks are filled in"),
    ("docs/start.md", "not run: needs a run file of your own"),
    ("docs/start.md", "not run: needs a run file of your own"),
    ("docs/start.md", "not run: needs a run file of your own"),
    ("docs/studies/cost.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/elsewhere.md", "not run: hours of processor time"),
    ("docs/studies/fuzz.md", "not run: an hour each"),
    ("docs/studies/structure.md", "not run: hours of processor time"),
];

#[test]
fn law_what_is_not_run_is_listed() {
    let mut found = Vec::new();
    for (name, text) in pages() {
        for item in items(&text) {
            if let What::Mark(m) = item.what
                && (m.starts_with("not run") || m.starts_with("nightly"))
            {
                found.push((name.clone(), m));
            }
        }
    }
    let listed: Vec<(String, String)> = LEFT_OUT.iter().map(|(p, m)| ((*p).to_owned(), (*m).to_owned())).collect();
    assert_eq!(found, listed, "marks of pages (left) and LEFT_OUT of cli/tests/pages/main.rs (right)");
}

/// A command that fails, output that differs, a figure that is off, a flag that is not there, a table without a source: each is seen, with its line.
#[test]
fn law_a_wrong_page_is_seen() {
    let memory = Memory::default();
    let ran = |text: &str| Runner::new("p.md", text, false, &memory).walk();
    let good = "<!-- file: s.toml -->\n```toml\na = 1\n```\n<!-- exit: 2 -->\n```\nwindfall check s.toml\n```\n";
    assert_eq!(ran(good), (Vec::new(), good.to_owned()));
    for (text, word) in [
        ("a\n\n```\nwindfall check nothing.toml\n```\n", "p.md:4: windfall check nothing.toml: exit code 2, expected 0"),
        ("`windfall simulate appendix-c --sead 1`\n", "p.md:1: windfall simulate appendix-c --sead 1: exit code 2"),
        ("`windfall plan FILE --taget X=1%`\n", "p.md:1: windfall plan FILE --taget X=1%: no flag --taget"),
        ("`windfall fly`\n", "no verb fly"),
        (
            "```\nwindfall check appendix-c\n```\n<!-- output -->\n```\nscenario appendix-d\n...\n```\n",
            "p.md:6: windfall check appendix-c: expected",
        ),
        (
            "```\nwindfall check appendix-c\n```\n<!-- output -->\n```\n...\n  vehicle: 0.7875 kg, ...\n```\n",
            "p.md:7: 0.7875 is printed, windfall check appendix-c gives 0.7873",
        ),
        ("```\nwindfall check appendix-c --json --out made\n```\n1.0<!-- = made/none.json#a -->\n", "p.md:4: = made/none.json#a"),
        ("```\ngit clone here\n```\n", "p.md:2: git clone here: is no command of windfall; mark it"),
        ("| a | 1.5 |\n|---|---|\n| b | 2.5 |\n", "p.md:1: a table of figures"),
        ("`scripts/nothing-of-ours`\n", "scripts/nothing-of-ours: is not there"),
        ("<!-- outptu -->\n", "p.md:1: no such mark"),
    ] {
        let (wrong, _) = ran(text);
        assert!(wrong.iter().any(|w| w.contains(word)), "{text}: {wrong:?} lacks {word}");
    }
}
