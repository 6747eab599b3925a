//! cli: many campaigns as a user does them, in processes of their own. In: folders of campaigns. Out: the same bytes however they came about.

mod common;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Sound campaigns: flights of 2 s at 100 Hz by different seeds.
const SOUND: [&str; 5] = ["a", "b", "deep/er/c", "d", "e"];

/// A folder `all` with sound campaigns, one that cannot be read and one that is too short to be identified.
struct Bench {
    dir: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self { dir: tempfile::tempdir().expect("a temporary folder") };
        fs::write(bench.path("short.toml"), common::short_scenario()).expect("writable");
        for (seed, name) in (1..).zip(SOUND) {
            bench.fly(&format!("all/{name}"), seed);
        }
        bench.fly("all/misspelt", 1);
        bench.edit("all/misspelt/campaign.toml", "mass_kg", "mas_kg");
        bench
    }
    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }
    fn fly(&self, out: &str, seed: u32) {
        let mut c = Command::new(env!("CARGO_BIN_EXE_windfall"));
        c.arg("simulate").arg(self.path("short.toml")).args(["--seed", &seed.to_string(), "--quiet", "--force", "--out"]);
        assert!(c.arg(self.path(out)).output().expect("the program starts").status.success());
    }
    fn edit(&self, file: &str, from: &str, to: &str) {
        let text = fs::read_to_string(self.path(file)).expect("there");
        assert!(text.contains(from), "{from}");
        fs::write(self.path(file), text.replace(from, to)).expect("writable");
    }
    fn command(&self, folder: &str, out: &str, more: &[&str]) -> Command {
        let mut c = Command::new(env!("CARGO_BIN_EXE_windfall"));
        c.args(["many", "identify"]).arg(self.path(folder)).args(["--method", "equation-error", "--out"]);
        c.arg(self.path(out)).args(more);
        c
    }
    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.command("all", out, more).output().expect("the program starts")
    }
    fn done(&self, out: &str, more: &[&str]) -> Output {
        let ran = self.run(out, more);
        assert!(ran.status.success(), "{out} {more:?}: {}", errors(&ran));
        ran
    }
    fn refused(&self, mut command: Command, words: &[&str]) {
        let before = files(self.dir.path());
        let ran = command.output().expect("the program starts");
        let said = errors(&ran);
        assert_eq!(ran.status.code(), Some(2), "{said}");
        assert!(words.iter().all(|w| said.contains(w)), "{words:?} in: {said}");
        assert!(before == files(self.dir.path()), "{words:?}: touched what was there");
    }
    /// Every file of a folder by its name within it.
    fn tree(&self, out: &str) -> Vec<(PathBuf, Vec<u8>)> {
        let root = self.path(out);
        let within = |p: PathBuf| p.strip_prefix(&root).expect("below").to_owned();
        files(&root).into_iter().map(|(p, b)| (within(p), b)).collect()
    }
    fn summary(&self, out: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(out).join("many.json")).expect("written")).expect("JSON")
    }
    /// When each campaign's outcome was written; those that are there.
    fn written(&self, out: &str) -> Vec<(PathBuf, std::time::SystemTime)> {
        let outcomes = files(&self.path(out).join("results")).into_iter().map(|(p, _)| p).filter(|p| p.ends_with("outcome.json"));
        outcomes.map(|p| (p.clone(), fs::metadata(&p).and_then(|m| m.modified()).expect("a time"))).collect()
    }
}

fn errors(ran: &Output) -> String {
    String::from_utf8_lossy(&ran.stderr).into_owned()
}

/// Every file below a folder with its bytes; what a killed process left under a hidden name is nobody's result.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if path.is_dir() {
            all.extend(files(&path));
        } else if path.is_file() {
            all.push((path.clone(), fs::read(&path).unwrap_or_default()));
        }
    }
    all.sort();
    all
}

/// A row a campaign, failures with their reason; pooled figures are those of the rows; the page is that of `windfall report`.
#[test]
fn law_every_campaign_is_a_row_and_a_failure_ends_nothing() {
    let b = Bench::new();
    let ran = b.done("out", &[]);
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(said.starts_with("6 campaigns: 5 with a result, 1 failed\n"), "{said}");
    assert!(said.contains("failed: misspelt/campaign.toml (exit code 2): misspelt/campaign.toml:"), "{said}");
    let s = b.summary("out");
    let rows = s["outcomes"].as_array().expect("a list");
    let paths: Vec<&str> = rows.iter().filter_map(|r| r["path"].as_str()).collect();
    let expected: Vec<String> =
        ["a", "b", "d", "deep/er/c", "e", "misspelt"].iter().map(|n| format!("{n}/campaign.toml")).collect();
    assert_eq!(paths, expected);
    assert!(rows[5]["status"] == "failed" && rows[5]["reason"].as_str().is_some_and(|r| r.contains("mas_kg")), "{}", rows[5]);
    assert!(!rows[5].to_string().contains(&b.dir.path().display().to_string()), "no place of this machine: {}", rows[5]);
    for (row, name) in rows.iter().zip(["a", "b", "d", "deep/er/c", "e"]) {
        let own: Value =
            serde_json::from_slice(&fs::read(b.path(&format!("out/results/{name}/identification.json"))).expect("kept"))
                .expect("JSON");
        let sets = own["data_sets"].as_array().expect("a list");
        let combined = sets.iter().find(|d| d["name"] == "combined").or(sets.last()).expect("a data set");
        let (mine, theirs) = (&row["parameters"][0], &combined["parameters"][0]);
        assert_eq!((&mine["name"], &mine["estimate"]), (&theirs["name"], &theirs["estimate"]), "bit for bit");
    }
    let ca = s["pooled"].as_array().expect("a list").iter().find(|p| p["name"] == "CA_T0").expect("pooled");
    let all: Vec<f64> = rows[..5].iter().filter_map(|r| r["parameters"][0]["estimate"].as_f64()).collect();
    let mean = ca["mean"].as_f64().expect("a number");
    assert!(ca["n"] == 5 && all.iter().any(|x| *x < mean) && all.iter().any(|x| *x > mean), "{ca} of {all:?}");
    // The table: a row each, and of the failed one no numbers.
    let (numbers, columns) = windfall_scenarios::read_runs(&b.path("out/campaigns.parquet")).expect("a table");
    assert_eq!(numbers, [0, 1, 2, 3, 4, 5]);
    let column = columns.iter().find(|(c, _)| c.name == "CA.CA_T0.estimate").expect("a column");
    let cells: Vec<Option<f64>> = column.1.iter().map(windfall::model::study::Cell::number).collect();
    assert_eq!(cells, all.iter().map(|x| Some(*x)).chain([None]).collect::<Vec<_>>());
    let page = fs::read(b.path("out/report.html")).expect("written");
    let drawn = Command::new(env!("CARGO_BIN_EXE_windfall")).arg("report").arg(b.path("out")).output().expect("starts");
    assert!(drawn.status.success(), "{}", errors(&drawn));
    assert!(fs::read(b.path("out/report.html")).expect("written") == page && page.windows(6).any(|w| w == b"mas_kg"));
}

/// One thread, two, seven; shares in another order; another place; killed at random moments and resumed. All files byte for byte, and what
/// was done before a kill is not done again.
#[test]
fn law_same_bytes_whatever_came_between() {
    let b = Bench::new();
    let start = Instant::now();
    b.done("one", &["--threads", "1"]);
    let takes = start.elapsed();
    let one = b.tree("one");
    assert!(one.len() == 4 + 6 + 5 + 5, "table, summary, page, order; outcomes; results, their pages: {}", one.len());
    for threads in ["2", "7"] {
        b.done(threads, &["--threads", threads]);
        assert!(b.tree(threads) == one, "{threads} threads");
    }
    for (shard, threads) in [("3/4", "2"), ("1/4", "1"), ("4/4", "1"), ("2/4", "3")] {
        b.done("shards", &["--shard", shard, "--threads", threads]);
    }
    assert!(!b.path("shards/many.json").exists());
    b.done("shards", &["--resume"]);
    assert!(b.tree("shards") == one, "shards");
    fs::create_dir(b.path("other")).expect("writable");
    fs::rename(b.path("all"), b.path("other/place")).expect("movable");
    assert!(b.command("other/place", "moved", &[]).output().expect("starts").status.success());
    assert!(b.tree("moved") == one, "another place");
    fs::rename(b.path("other/place"), b.path("all")).expect("movable");
    let (mut kills, mut chance) = (0, 0x2545_f491_4f6c_dd1d_u64);
    for folder in 0..40 {
        let out = format!("killed-{folder}");
        loop {
            let resume: &[&str] = if b.path(&out).join("order.json").exists() { &["--resume"] } else { &[] };
            let before = b.written(&out);
            let mut command = b.command("all", &out, resume);
            command.args(["--threads", "1", "--quiet"]).stdout(Stdio::null()).stderr(Stdio::null());
            let mut child = command.spawn().expect("the program starts");
            chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            std::thread::sleep(takes.mul_f64((chance >> 33) as f64 / (1_u64 << 31) as f64));
            let ended = child.try_wait().expect("a child");
            if ended.is_none() {
                child.kill().expect("SIGKILL");
                child.wait().expect("a child");
                kills += 1;
            }
            // What could not be read is tried again; what was done stays as it is.
            let after = b.written(&out);
            let sound = before.iter().filter(|(p, _)| !p.to_string_lossy().contains("misspelt"));
            assert!(sound.into_iter().all(|w| after.contains(w)), "done again");
            if let Some(status) = ended {
                assert!(status.success(), "a resumed run ends well");
                break;
            }
        }
        assert!(b.tree(&out) == one, "after {kills} kills");
        if kills >= 12 {
            return;
        }
    }
    panic!("only {kills} kills");
}

/// A campaign whose runs changed, one that was added, one whose result was touched: these are done again, the others are not.
#[test]
fn law_only_what_changed_is_done_again() {
    let b = Bench::new();
    b.done("out", &[]);
    let before = b.written("out");
    b.fly("all/b", 77);
    b.fly("all/f", 78);
    fs::write(b.path("out/results/d/identification.json"), "{}").expect("writable");
    // A comment says nothing.
    b.edit("all/e/campaign.toml", "[vehicle]", "# a comment\n[vehicle]");
    // From now on it is a failure, whose old result goes.
    b.edit("all/a/campaign.toml", "mass_kg", "mas_kg");
    b.done("out", &["--resume"]);
    let after = b.written("out");
    let changed: Vec<String> = after
        .iter()
        .filter(|w| !before.contains(w))
        .filter_map(|(p, _)| Some(p.parent()?.strip_prefix(b.path("out/results")).ok()?.display().to_string()))
        .collect();
    assert_eq!(changed, ["a", "b", "d", "f", "misspelt"]);
    assert!(!b.path("out/results/a/identification.json").exists());
    b.done("fresh", &[]);
    assert!(b.tree("out") == b.tree("fresh"));
}

#[test]
fn law_what_is_in_the_way_is_an_error_and_stays() {
    let b = Bench::new();
    fs::create_dir(b.path("empty")).expect("writable");
    b.done("out", &["--shard", "1/2"]);
    b.refused(b.command("empty", "new", &[]), &["no campaign.toml", "try:"]);
    b.refused(b.command("nowhere", "new", &[]), &["nowhere: cannot be searched"]);
    b.refused(b.command("all", "nothing", &["--resume"]), &["nothing: holds no study to resume, nor many campaigns"]);
    b.refused(b.command("all", "out", &[]), &["holds results already", "--resume"]);
    b.refused(b.command("all", "out", &["--shard", "1/2"]), &["holds results already"]);
    b.refused(b.command("all", "out", &["--shard", "3/2"]), &["i/n"]);
    b.refused(b.command("all", "out", &["--resume", "--force"]), &["--force"]);
    b.refused(b.command("all", "out", &["--resume", "--hold", "Cl_0=0.0125"]), &["another verb or flags"]);
    let mut plan = Command::new(env!("CARGO_BIN_EXE_windfall"));
    plan.args(["many", "plan"]).arg(b.path("all"));
    b.refused(plan, &["unrecognized subcommand 'plan'"]);
    // Another's file where a result is to be is not overwritten.
    fs::create_dir_all(b.path("mine/results/b")).expect("writable");
    fs::write(b.path("mine/results/b/identification.json"), "mine").expect("writable");
    let ran = b.run("mine", &[]);
    assert!(ran.status.code() == Some(2) && errors(&ran).contains("is not overwritten"), "{}", errors(&ran));
    assert_eq!(fs::read_to_string(b.path("mine/results/b/identification.json")).expect("there"), "mine");
    // --force begins anew and removes nothing but results.
    fs::write(b.path("out/results/notes.txt"), "mine").expect("writable");
    b.done("out", &["--force"]);
    assert_eq!(fs::read_to_string(b.path("out/results/notes.txt")).expect("there"), "mine");
    fs::remove_file(b.path("out/results/notes.txt")).expect("mine");
    b.done("fresh", &[]);
    assert!(b.tree("out") == b.tree("fresh"));
}

/// Ctrl-C: what is in flight is finished and kept, the exit code says so, and `--resume` ends with the same bytes.
#[test]
#[cfg(unix)]
fn law_an_interrupt_keeps_what_is_done() {
    let b = Bench::new();
    (10..40).for_each(|k| b.fly(&format!("all/more-{k}"), k));
    b.done("whole", &["--threads", "1", "--quiet"]);
    let mut command = b.command("all", "stopped", &["--threads", "1", "--quiet"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    while b.written("stopped").len() < 2 {
        assert_eq!(child.try_wait().expect("a child"), None, "still at work");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill starts").success());
    let ended = child.wait_with_output().expect("a child");
    assert_eq!(ended.status.code(), Some(130), "{}", errors(&ended));
    assert!(errors(&ended).contains("--resume") && !b.path("stopped/many.json").exists(), "{}", errors(&ended));
    let kept = b.written("stopped");
    b.done("stopped", &["--resume"]);
    assert!(kept.iter().filter(|(p, _)| !p.to_string_lossy().contains("misspelt")).all(|w| b.written("stopped").contains(w)));
    assert!(b.tree("stopped") == b.tree("whole"));
}
