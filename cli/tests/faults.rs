//! cli: a machine that fails. In: full disks, folders that may not be written, readers that go away, records full of holes, clocks that jump.
//! Out: the fault by its name, and nothing lost.

mod common;

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, SystemTime};

const PROGRAM: &str = env!("CARGO_BIN_EXE_windfall");

struct Bench(tempfile::TempDir);

impl Bench {
    /// A short scenario, and its campaign in `made`.
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a temporary folder"));
        fs::write(bench.0.path().join("short.toml"), common::short_scenario()).expect("writable");
        bench.done(&["simulate", "short.toml", "--out", "made", "--quiet"]);
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
}

fn said(ran: &Output) -> String {
    String::from_utf8_lossy(&ran.stderr).into_owned()
}

/// Runs commands in a shell whose folder `disk` is a file system of its own, of this size; none where that may not be made.
#[cfg(target_os = "linux")]
fn on_a_disk(b: &Bench, options: &str, script: &str) -> Option<String> {
    fs::create_dir_all(b.path("disk")).expect("writable");
    let whole = format!("mount -t tmpfs -o {options} tmpfs disk || exit 77\n{script}");
    let ran = Command::new("unshare")
        .args(["-m", "sh", "-c", &whole, "sh", PROGRAM])
        .current_dir(b.0.path())
        .output()
        .ok()
        .filter(|r| r.status.success());
    if ran.is_none() {
        eprintln!("skipped: a file system of its own needs root and `unshare`");
    }
    ran.map(|r| String::from_utf8_lossy(&r.stdout).into_owned())
}

/// A disk of 16 kB: the fault is named, what was there stands, nothing half written is left.
#[cfg(target_os = "linux")]
#[test]
fn law_a_full_disk_is_named_and_leaves_what_was_there() {
    let b = Bench::new();
    b.done(&["identify", "made/campaign.toml", "--method", "equation-error", "--out", "made", "--quiet"]);
    let verbs = [
        "simulate short.toml --out disk --force",
        "resimulate made/campaign.toml --model made/identification.json --out disk --force",
        "report made --out disk --force",
        "report made --figures disk --force",
        "many identify made --method equation-error --out disk --force",
    ];
    for verb in verbs {
        let script = format!(
            "printf old > disk/run.csv\n\"$1\" {verb} --quiet 2>&1 >/dev/null\necho \"exit $?\"\nls -A disk\ncat disk/run.csv"
        );
        let Some(text) = on_a_disk(&b, "size=16k", &script) else { return };
        let (message, left) = text.split_once("exit ").expect("the shell says so");
        assert!(message.contains("No space left on device") && message.contains("disk"), "{verb}: {text}");
        let left: Vec<&str> = left.lines().collect();
        assert!(left[0] == "2" && left.last() == Some(&"old"), "{verb}: {text}");
        // A folder of many campaigns may be begun: its order is kept, and no result is in it.
        let results = ["many.json", "truth.csv", "report.html", "resimulation.json", ".windfall"];
        assert!(!left.iter().any(|l| results.iter().any(|r| l.starts_with(r))), "{verb}: {text}");
    }
}

/// A folder that may not be written: said before any work.
#[cfg(target_os = "linux")]
#[test]
fn law_a_read_only_folder_is_named() {
    let b = Bench::new();
    b.done(&["identify", "made/campaign.toml", "--method", "equation-error", "--out", "made", "--quiet"]);
    fs::write(b.path("study.toml"), "[study]\nname = \"s\"\nscenario = \"short.toml\"\nseed = 1\ndraws = 1\n").expect("writable");
    let verbs = [
        "simulate short.toml --out disk",
        "identify made/campaign.toml --method equation-error --out disk",
        "report made --out disk",
        "study study.toml --out disk",
        "init disk made/run.csv",
    ];
    let each: String = verbs.iter().map(|v| format!("\"$1\" {v} --quiet 2>&1 >/dev/null\necho \"exit $?\"\n")).collect();
    let Some(text) = on_a_disk(&b, "ro", &each) else { return };
    let answers: Vec<&str> = text.split_inclusive("exit 2\n").collect();
    assert_eq!(answers.len(), verbs.len(), "{text}");
    for (verb, answer) in verbs.iter().zip(answers) {
        assert!(answer.contains("Read-only file system") && answer.contains("disk"), "{verb}: {answer}");
    }
}

/// `| head -1`: the program ends, and says nothing of it.
#[cfg(unix)]
#[test]
fn law_a_reader_that_goes_away_is_no_failure() {
    let b = Bench::new();
    for words in [&["check", "--keys"][..], &["simulate", "short.toml", "--json"], &["completions", "bash"], &["--help"]] {
        let mut child = Command::new(PROGRAM)
            .args(words)
            .current_dir(b.0.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        let mut reader = BufReader::with_capacity(16, child.stdout.take().expect("piped"));
        reader.read_line(&mut line).expect("a line");
        drop(reader);
        let mut errors = String::new();
        child.stderr.take().expect("piped").read_to_string(&mut errors).expect("text");
        assert!(child.wait().expect("was started").success() && !line.is_empty(), "{words:?}: {errors}");
        assert!(!errors.contains("panicked") && !errors.contains("roken pipe"), "{words:?}: {errors}");
    }
}

/// Nearly a third of the samples are missing, or two of three are NaN: counted by channel; the estimates leave with more than nothing.
#[test]
fn law_holes_are_counted() {
    let b = Bench::new();
    let text = fs::read_to_string(b.path("made/run.csv")).expect("flown");
    let (header, rows) = text.split_once('\n').expect("a header");
    let place = header.split(',').position(|c| c == "Ry_deg").expect("a column");
    let mut chance = 12_345_u64;
    let mut run = |kind: &str, cell: &str| {
        let mut holes = 0;
        let mut all = format!("{header}\n");
        for (i, row) in rows.lines().enumerate() {
            chance = chance * 48_271 % 2_147_483_647;
            let bad = if kind == "dropouts" { chance % 10 < 3 } else { i % 3 != 0 } && i > 0 && i + 1 < rows.lines().count();
            holes += usize::from(bad);
            let cells: Vec<&str> = row.split(',').enumerate().map(|(k, c)| if bad && k == place { cell } else { c }).collect();
            all += &(cells.join(",") + "\n");
        }
        fs::write(b.path("made/run.csv"), all).expect("writable");
        holes
    };
    for (kind, cell) in [("dropouts", ""), ("storm", "nan")] {
        let holes = run(kind, cell);
        let ran = b.done(&["check", "made/campaign.toml"]);
        assert!(said(&ran).contains(&format!("Ry_deg: {holes} samples bridged")), "{kind}, {holes} holes: {}", said(&ran));
        let ran = b.done(&["identify", "made/campaign.toml", "--method", "equation-error", "--json"]);
        assert!(said(&ran).contains("samples bridged"), "{kind}: {}", said(&ran));
    }
}

/// Files that seem to be of the past or of the future, and a clock that is set between two runs: the same bytes, and nothing is done again.
#[test]
fn law_clocks_decide_nothing() {
    let b = Bench::new();
    fs::write(b.path("study.toml"), "[study]\nname = \"s\"\nscenario = \"short.toml\"\nseed = 1\ndraws = 4\npart_draws = 2\n")
        .expect("writable");
    let bytes = |out: &str| ["runs.parquet", "summary.json"].map(|f| fs::read(b.path(out).join(f)).expect("written"));
    b.done(&["study", "study.toml", "--out", "whole", "--quiet"]);
    b.done(&["study", "study.toml", "--out", "half", "--quiet", "--shard", "1/2"]);
    let many = ["many", "identify", "made", "--method", "equation-error", "--out", "many", "--quiet"];
    b.done(&many);
    let table = fs::read(b.path("many/campaigns.parquet")).expect("written");
    let ages = [SystemTime::UNIX_EPOCH, SystemTime::now() + Duration::from_secs(3_000_000_000)];
    let files = ["short.toml", "study.toml", "half/study.json", "made/campaign.toml", "made/run.csv"];
    for (age, file) in ages.into_iter().cycle().zip(files) {
        fs::File::options().append(true).open(b.path(file)).and_then(|f| f.set_modified(age)).expect("its own file");
    }
    b.done(&["study", "study.toml", "--out", "half", "--quiet", "--resume"]);
    assert!(bytes("half") == bytes("whole"));
    let outcome = || fs::metadata(b.path("many/results").join(first_result(&b))).and_then(|m| m.modified()).expect("a time");
    let before = outcome();
    b.done(&[&many[..], &["--resume"]].concat());
    assert!(outcome() == before, "what is done is not done again");
    assert!(fs::read(b.path("many/campaigns.parquet")).expect("written") == table);
}

/// The outcome of the only campaign, below `results`.
fn first_result(b: &Bench) -> PathBuf {
    let mut folders = vec![b.path("many/results")];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).expect("made").flatten().map(|e| e.path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.ends_with("outcome.json") {
                return path;
            }
        }
    }
    panic!("no outcome.json")
}
