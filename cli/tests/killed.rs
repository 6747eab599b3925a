//! cli: processes that are killed, and two at once. In: verbs that overwrite. Out: the complete old files or the complete new ones.

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Every visible file of a folder with its bytes, after a set that was complete is in place.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    windfall_scenarios::settle(folder).expect("a folder of its own");
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.starts_with('.') {
            all.push((name, fs::read(entry.path()).unwrap_or_default()));
        }
    }
    all.sort();
    all
}

struct Bench {
    dir: tempfile::TempDir,
}

impl Bench {
    /// Two campaigns of the same flights of 2 s at 100 Hz, `a` and `b`, by different seeds; an identification of each.
    fn new() -> Self {
        let bench = Self { dir: tempfile::tempdir().expect("a temporary folder") };
        fs::write(bench.path("short.toml"), common::short_scenario()).expect("writable");
        for (name, seed) in [("a", "1"), ("b", "2")] {
            bench.run(&bench.words("simulate", "short.toml", name, &["--seed", seed]));
            bench.run(&bench.words("identify", &format!("{name}/campaign.toml"), name, &["--method", "equation-error"]));
        }
        bench
    }
    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }
    fn words(&self, verb: &str, input: &str, out: &str, more: &[&str]) -> Vec<String> {
        let path = |name: &str| self.path(name).display().to_string();
        let mut all = vec![verb.to_owned(), path(input), "--out".to_owned(), path(out), "--quiet".to_owned()];
        all.extend(more.iter().map(|w| if w.ends_with(".json") { path(w) } else { (*w).to_owned() }));
        all
    }
    fn command(words: &[String]) -> Command {
        let mut c = Command::new(env!("CARGO_BIN_EXE_windfall"));
        c.args(words).stdout(Stdio::null()).stderr(Stdio::null());
        c
    }
    fn run(&self, words: &[String]) -> Duration {
        let start = Instant::now();
        let ran = Command::new(env!("CARGO_BIN_EXE_windfall")).args(words).output().expect("the program starts");
        // An unexplained residual of so short a run is a verdict, no failure.
        assert!(matches!(ran.status.code(), Some(0 | 1)), "{words:?}: {}", String::from_utf8_lossy(&ran.stderr));
        start.elapsed()
    }
    fn fill(&self, out: &str, old: &[(String, Vec<u8>)]) {
        // What is not there yet cannot be removed.
        let _ = fs::remove_dir_all(self.path(out));
        fs::create_dir(self.path(out)).expect("writable");
        old.iter().for_each(|(name, bytes)| fs::write(self.path(out).join(name), bytes).expect("writable"));
    }
}

/// Parts of the time that a verb takes at which it is killed: from the start, and close together where it writes.
fn instants(n: u32) -> impl Iterator<Item = f64> {
    let mut state = 12_345_u64;
    (0..n).map(move |i| {
        state = state * 48_271 % 2_147_483_647;
        let chance = f64::from(u32::try_from(state % 1000).unwrap_or(0)) / 1000.0;
        if i % 3 == 0 { chance } else { 0.75 + 0.35 * chance }
    })
}

#[test]
fn law_a_kill_leaves_the_old_files_or_the_new_ones() {
    let bench = Bench::new();
    // Verb, how its input and flags are named for each of the two, kills.
    let verbs: [(&str, &str, &[&str], u32); 5] = [
        ("simulate", "short.toml", &["--seed", "#"], 30),
        ("identify", "@/campaign.toml", &["--method", "equation-error"], 12),
        ("resimulate", "@/campaign.toml", &["--model", "@/identification.json"], 9),
        ("structure", "@/campaign.toml", &["--criterion", "bic"], 9),
        ("plan", "@/campaign.toml", &["--target", "Cm_2=5%"], 6),
    ];
    for (verb, input, flags, kills) in verbs {
        let order = |who: &str, out: &str| {
            let fill = |w: &str| w.replace('@', who).replace('#', if who == "a" { "1" } else { "2" });
            let more: Vec<String> = flags.iter().map(|w| fill(w)).chain(["--force".to_owned()]).collect();
            bench.words(verb, &fill(input), out, &more.iter().map(String::as_str).collect::<Vec<_>>())
        };
        bench.fill("old", &[]);
        bench.fill("new", &[]);
        bench.run(&order("a", "old"));
        let takes = bench.run(&order("b", "new"));
        let (old, new) = (files(&bench.path("old")), files(&bench.path("new")));
        assert_ne!(old, new, "{verb}");
        for part in instants(kills) {
            bench.fill("out", &old);
            let mut child = Bench::command(&order("b", "out")).spawn().expect("the program starts");
            std::thread::sleep(takes.mul_f64(part));
            // It may have ended by itself.
            let _ = child.kill();
            child.wait().expect("was started");
            let left = files(&bench.path("out"));
            assert!(left == old || left == new, "{verb} killed after {part} of its time: {:?}", names(&left));
        }
        // What killed processes left behind goes with the next result.
        bench.run(&order("b", "out"));
        let hidden = fs::read_dir(bench.path("out"))
            .expect("there")
            .flatten()
            .filter(|e| e.file_name().to_string_lossy().starts_with('.'));
        assert_eq!(hidden.count(), 0, "{verb} leaves stages of killed processes");
    }
}

fn names(files: &[(String, Vec<u8>)]) -> Vec<String> {
    files.iter().map(|(n, b)| format!("{n}: {} bytes", b.len())).collect()
}

#[test]
fn law_two_processes_on_one_folder_do_not_mix() {
    let bench = Bench::new();
    let order = |seed: &str, force: bool| {
        let all = ["--seed", seed, "--force"];
        bench.words("simulate", "short.toml", "out", if force { &all } else { &all[..2] })
    };
    let made: Vec<_> = ["1", "2"]
        .map(|seed| {
            bench.fill("out", &[]);
            bench.run(&order(seed, false));
            files(&bench.path("out"))
        })
        .into();
    for round in 0..10 {
        let force = round % 2 == 0;
        bench.fill("out", &[]);
        let children = ["1", "2"].map(|seed| Bench::command(&order(seed, force)).spawn().expect("the program starts"));
        let codes = children.map(|mut c| c.wait().expect("was started").code());
        let left = files(&bench.path("out"));
        let winner = made.iter().position(|m| *m == left);
        assert!(winner.is_some(), "round {round}: a mix: {:?}", names(&left));
        if force {
            assert_eq!(codes, [Some(0); 2]);
        } else {
            let mut expected = [Some(2); 2];
            expected[winner.unwrap_or(0)] = Some(0);
            assert_eq!(codes, expected, "round {round}: one wrote, the other one said that it may not");
        }
    }
}
