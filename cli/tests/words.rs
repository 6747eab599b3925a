//! cli: words on the screen. In: what verbs print. Out: an explanation of each heading and of each technical word.

use std::fs;
use std::path::Path;
use std::process::Command;

const PROGRAM: &str = env!("CARGO_BIN_EXE_windfall");

fn printed(folder: &Path, words: &[&str]) -> String {
    let ran = Command::new(PROGRAM).args(words).arg("--quiet").current_dir(folder).output().expect("the program starts");
    let said = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.code().is_some_and(|c| c <= 1), "{words:?}: {said}");
    String::from_utf8_lossy(&ran.stdout).into_owned()
}

/// Headings of tables: cells, two spaces or more apart, of lines that have no number and stand above a line with as many cells or more.
fn headings(text: &str) -> Vec<String> {
    let cells = |line: &str| -> Vec<String> {
        line.trim().split("  ").map(str::trim).filter(|c| !c.is_empty()).map(str::to_owned).collect()
    };
    let is_number = |c: &String| c.trim_start_matches(['-', '[', '<', ' ']).starts_with(|c: char| c.is_ascii_digit());
    let lines: Vec<&str> = text.lines().collect();
    let mut all = Vec::new();
    for pair in lines.windows(2) {
        let (above, below) = (cells(pair[0]), cells(pair[1]));
        let numbers = below.iter().filter(|c| is_number(c)).count();
        if above.len() >= 3 && numbers >= 2 && !above.iter().any(|c| c.parse::<f64>().is_ok() || c.contains(" = ")) {
            all.extend(above.into_iter().filter(|c| !is_number(c) || c.contains(" %")));
        }
    }
    all
}

/// Words that stand in sentences and lines rather than above columns.
const WORDS: [&str; 22] = [
    "p(white)",
    "R²",
    "residual std",
    "residual",
    "condition number",
    "RSE",
    "95 % interval",
    "white s.e.",
    "rivals",
    "chance from noise alone",
    "held out",
    "innovation",
    "log-likelihood",
    "misfit",
    "posterior",
    "prior",
    "consistent",
    "unexplained",
    "output-error",
    "filter-error",
    "equation-error",
    "thesis",
];

#[test]
fn law_every_heading_and_word_on_the_screen_is_explained() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = folder.path();
    let scenario = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
    fs::write(at.join("short.toml"), scenario.replace("duration_s = 18.3", "duration_s = 2.0")).expect("writable");
    let study =
        "[study]\nname = \"few\"\nscenario = \"short.toml\"\ndraws = 4\nseed = 1\n\n[do]\nidentify = [\"equation-error\"]\n";
    fs::write(at.join("study.toml"), study).expect("writable");
    printed(at, &["simulate", "short.toml", "--out", "all/one"]);
    printed(at, &["simulate", "short.toml", "--seed", "9", "--out", "all/two"]);
    let campaign = "all/one/campaign.toml";
    let mut found: Vec<String> = WORDS.iter().map(|w| (*w).to_owned()).collect();
    let mut tables = 0;
    for words in [
        &["identify", campaign, "--method", "output-error", "--combined", "--bootstrap", "2", "--out", "found"][..],
        &["resimulate", campaign, "--model", "found/identification.json", "--draws", "2"],
        &["structure", campaign, "--criterion", "bic"],
        &["plan", campaign, "--target", "Cm_2=1%"],
        &["close", campaign],
        &["descend", "venus-dispersions", "--draws", "2"],
        &["study", "study.toml", "--out", "drawn"],
        &["many", "identify", "all", "--method", "equation-error", "--combined", "--out", "pooled"],
    ] {
        let own = headings(&printed(at, words));
        tables += usize::from(!own.is_empty());
        found.extend(own);
    }
    assert!(tables >= 7 && found.len() > 60, "{tables} verbs with a table, {} words", found.len());
    found.sort();
    found.dedup();
    let mut lacking = Vec::new();
    for word in &found {
        let ran = Command::new(PROGRAM).args(["explain", word]).output().expect("the program starts");
        if !ran.status.success() || !String::from_utf8_lossy(&ran.stdout).contains("a word on the screen") {
            lacking.push(word);
        }
    }
    assert!(lacking.is_empty(), "printed and not explained: {lacking:?}; write entries in windfall/src/glossary.rs");
}
