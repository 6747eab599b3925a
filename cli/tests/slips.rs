//! cli: slips of those who type. In: a file of another kind, no `--out`. Out: one sentence that says what is there and what is needed; no file that nobody
//! asked for.

mod common;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_windfall");

struct Bench(tempfile::TempDir);

impl Bench {
    /// A short campaign in `made`, and what `identify` says of it in `found`.
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a temporary folder"));
        fs::write(bench.path("short.toml"), common::short_scenario()).expect("writable");
        bench.done(&["simulate", "short.toml", "--out", "made", "--quiet"]);
        bench.done(&["identify", "made/campaign.toml", "--method", "equation-error", "--out", "found", "--quiet"]);
        bench
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn run(&self, words: &[&str]) -> Output {
        Command::new(PROGRAM).args(words).current_dir(self.0.path()).output().expect("the program starts")
    }
    fn done(&self, words: &[&str]) -> Output {
        let ran = self.run(words);
        assert!(ran.status.success(), "{words:?}: {}", said(&ran));
        ran
    }
    /// Names of files and folders.
    fn there(&self) -> Vec<String> {
        let all = fs::read_dir(self.0.path()).expect("a folder").flatten();
        let mut names: Vec<String> = all.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

fn said(ran: &Output) -> String {
    String::from_utf8_lossy(&ran.stderr).into_owned()
}

#[test]
fn law_nothing_is_written_without_out() {
    let b = Bench::new();
    let before = b.there();
    let campaign = "made/campaign.toml";
    for (words, file) in [
        (&["simulate", "short.toml"][..], "run.csv"),
        (&["simulate", "glider-throws"], "throw-01.csv"),
        (&["simulate", "venus-descent"], "truth.csv"),
        (&["identify", campaign, "--method", "equation-error"], "identification.json"),
        (&["resimulate", campaign, "--model", "found/identification.json"], "resimulation.json"),
        (&["structure", campaign, "--criterion", "bic"], "structure.json"),
        (&["descend", "venus-dispersions", "--draws", "2"], "descent.json"),
    ] {
        let ran = b.done(words);
        let told = said(&ran);
        assert!(told.contains("nothing is written; --out DIR writes ") && told.contains(file), "{words:?}: {told}");
        assert_eq!(b.there(), before, "{words:?}");
    }
    let ran = b.done(&["simulate", "short.toml", "--json"]);
    assert!(!said(&ran).contains("nothing is written") && b.there() == before);
    // Work that is kept as it goes on needs a folder, which is said before any of it.
    fs::write(
        b.path("study.toml"),
        "[study]\nname = \"s\"\nscenario = \"short.toml\"\ndraws = 2\nseed = 1\n\n[do]\nidentify = [\"thesis\"]\n",
    )
    .expect("writable");
    let before = b.there();
    for words in [&["study", "study.toml"][..], &["many", "identify", "made"], &["study", "study.toml", "--json", "--resume"]] {
        let ran = b.run(words);
        assert!(ran.status.code() == Some(2) && said(&ran).contains("try: --out DIR"), "{words:?}: {}", said(&ran));
    }
    assert_eq!(b.there(), before);
}

#[test]
fn law_a_file_of_another_kind_is_named_in_one_sentence() {
    let b = Bench::new();
    fs::write(b.path("closed.json"), r#"{"verdict": "effect", "effects": [], "residual": {}}"#).expect("writable");
    fs::write(b.path("other.json"), r#"{"a": 1}"#).expect("writable");
    let (run, campaign) = ("made/run.csv", "made/campaign.toml");
    for (words, what) in [
        (
            &["close", run][..],
            "made/run.csv: is a run file, which holds the samples of one run; needed here: a campaign file (.toml)",
        ),
        (&["close", run], "try: windfall init DIR made/run.csv"),
        (&["identify", run], "is a run file"),
        (&["resimulate", run, "--model", "found/identification.json"], "is a run file"),
        (&["plan", run, "--separate"], "is a run file"),
        (&["structure", run], "is a run file"),
        (&["simulate", run], "needed here: a scenario"),
        (&["study", run, "--out", "o"], "needed here: a study file"),
        (&["identify", "short.toml"], "is a scenario (.toml), which describes flights to simulate; needed here: a campaign file"),
        (&["identify", "sage-combined"], "sage-combined: is a bundled scenario; needed here: a campaign file"),
        (&["simulate", campaign], "is a campaign file"),
        (&["study", campaign, "--out", "o"], "is a campaign file"),
        (
            &["descend", "venus-dispersions", "--model", "closed.json"],
            "closed.json: is the result of windfall close; needed here: the result of windfall identify",
        ),
        (&["descend", "venus-dispersions", "--model", "other.json"], "is not the result that is needed here"),
        (&["descend", "venus-dispersions", "--model", campaign], "is no JSON file; needed here: the result of windfall identify"),
        (&["resimulate", campaign, "--model", "closed.json"], "try: windfall identify CAMPAIGN --out DIR"),
    ] {
        let ran = b.run(words);
        let told = said(&ran);
        assert!(ran.status.code() == Some(2) && told.contains(what), "{words:?}: {told}");
        assert_eq!(told.lines().count(), 1, "{words:?}: {told}");
    }
}
