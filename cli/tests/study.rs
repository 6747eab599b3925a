//! cli: studies as a user runs them, in processes of their own. In: study files. Out: the same bytes however they came about.

mod common;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

/// A folder with a short scenario: 2 s of a perturbed flight at 100 Hz.
struct Bench {
    dir: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let dir = tempfile::tempdir().expect("a temporary folder");
        fs::write(dir.path().join("short.toml"), common::short_scenario()).expect("writable");
        Self { dir }
    }
    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }
    /// Writes `study.toml`.
    fn study(&self, draws: u64, part: u64, more: &str) {
        let head =
            format!("[study]\nname = \"test\"\nscenario = \"short.toml\"\ndraws = {draws}\nseed = 3\npart_draws = {part}\n");
        fs::write(self.path("study.toml"), head + more).expect("writable");
    }
    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut c = Command::new(env!("CARGO_BIN_EXE_windfall"));
        c.arg("study").arg(self.path("study.toml")).arg("--out").arg(self.path(out)).args(more);
        c
    }
    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.command(out, more).output().expect("the program starts")
    }
    fn done(&self, out: &str, more: &[&str]) -> Output {
        let ran = self.run(out, more);
        assert!(ran.status.success(), "{out} {more:?}: {}", errors(&ran));
        ran
    }
    /// Fails with 2 and words, and leaves every file of the folder as it was.
    fn refused(&self, out: &str, more: &[&str], words: &[&str]) {
        let before = files(&self.path(out));
        let ran = self.run(out, more);
        let said = errors(&ran);
        assert_eq!(ran.status.code(), Some(2), "{said}");
        assert!(words.iter().all(|w| said.contains(w)), "{words:?} in: {said}");
        assert!(before == files(&self.path(out)), "{more:?} touched what was there");
    }
    fn bytes(&self, out: &str) -> [Vec<u8>; 2] {
        ["runs.parquet", "summary.json"].map(|f| fs::read(self.path(out).join(f)).expect("written"))
    }
    fn summary(&self, out: &str) -> Value {
        serde_json::from_slice(&self.bytes(out)[1]).expect("JSON")
    }
}

fn errors(ran: &Output) -> String {
    String::from_utf8_lossy(&ran.stderr).into_owned()
}

/// Every file below a folder with its bytes.
fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            all.extend(files(&path));
        } else if path.is_file() {
            all.push((path.clone(), fs::read(&path).unwrap_or_default()));
        }
    }
    all.sort();
    all
}

const IDENTIFY: &str = "[do]\nidentify = [\"equation-error\"]\n";
const VARIED: &str = r#"
[[vary]]
quantity = "aero.Cm_2"
normal = { mean = -205.4, std = 20.0 }
[[vary]]
quantity = "flight.release.attitude_deg.Ry"
uniform = { low = 20.0, high = 30.0 }
[[correlation]]
between = ["aero.Cm_2", "flight.release.attitude_deg.Ry"]
coefficient = 0.8
[[vary]]
quantity = "effects.turbulence.axial_rms_m_s"
choice = { values = [0.0, 0.1] }
[effects.turbulence]
axial_rms_m_s = 0.0
axial_scale_m = 0.6
lateral_scale_m = 0.6
"#;

/// One thread, two, seven; four shards in another order, each on other threads; the same two files byte for byte.
#[test]
fn law_same_bytes_on_any_threads_and_in_any_shards() {
    let b = Bench::new();
    b.study(83, 8, &format!("{IDENTIFY}{VARIED}"));
    b.done("one", &["--threads", "1"]);
    let one = b.bytes("one");
    for threads in ["2", "7"] {
        b.done(threads, &["--threads", threads]);
        assert!(b.bytes(threads) == one, "{threads} threads");
    }
    for (shard, threads) in [("3/4", "2"), ("1/4", "7"), ("4/4", "1"), ("2/4", "3")] {
        b.done("shards", &["--shard", shard, "--threads", threads]);
    }
    b.done("shards", &["--resume"]);
    assert!(b.bytes("shards") == one, "shards");
    assert!(!b.path("shards/parts").exists(), "parts are joined");
}

/// Draws on disk: lines of journals that have their end, and whole parts.
fn draws_on_disk(folder: &Path, part: usize) -> usize {
    let lines = |bytes: &[u8]| bytes.iter().filter(|b| **b == b'\n').count();
    let of = |(path, bytes): &(PathBuf, Vec<u8>)| match path.extension().and_then(|e| e.to_str()) {
        Some("rows") => lines(bytes),
        Some("parquet") => part,
        _ => 0,
    };
    files(&folder.join("parts")).iter().map(of).sum()
}

/// Killed twenty times at random moments, resumed each time: nothing is lost, nothing counted twice, the same bytes in the end.
#[test]
fn law_kill_and_resume_give_the_same_bytes() {
    let b = Bench::new();
    b.study(320, 16, &format!("{IDENTIFY}[keep]\nintervals = false\n"));
    b.done("whole", &["--threads", "2"]);
    let whole = b.bytes("whole");
    let (mut kills, mut folder, mut chance) = (0, 0, 0x2545_f491_4f6c_dd1d_u64);
    while kills < 20 {
        folder += 1;
        let out = format!("killed-{folder}");
        let mut seen = 0;
        loop {
            let resume: &[&str] = if b.path(&out).join("study.json").exists() { &["--resume"] } else { &[] };
            let mut command = b.command(&out, resume);
            command.args(["--threads", "2", "--quiet"]).stdout(Stdio::null()).stderr(Stdio::null());
            let mut child = command.spawn().expect("the program starts");
            chance = chance.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            std::thread::sleep(Duration::from_millis(5 + (chance >> 33) % 200));
            if let Some(status) = child.try_wait().expect("a child") {
                assert!(status.success(), "a resumed run ends well");
                break;
            }
            child.kill().expect("SIGKILL");
            child.wait().expect("a child");
            kills += 1;
            let now = draws_on_disk(&b.path(&out), 16);
            let merged = b.path(&out).join("runs.parquet").exists();
            // A kill between a part and the end of its journal leaves its draws in both: counted twice, one part a thread.
            assert!(now + 2 * 16 >= seen || merged, "{now} draws on disk after {seen}");
            seen = now;
        }
        assert!(b.bytes(&out) == whole, "after {kills} kills");
    }
    // A study that is complete is left as it is.
    b.done("killed-1", &["--resume"]);
    assert!(b.bytes("killed-1") == whole);
}

/// Ctrl-C: the draws in flight are finished and kept, the exit code says so, and `--resume` ends with the same bytes.
#[test]
#[cfg(unix)]
fn law_an_interrupted_study_ends_soon_and_resumes() {
    let b = Bench::new();
    b.study(2000, 16, IDENTIFY);
    b.done("whole", &["--threads", "2", "--quiet"]);
    let mut command = b.command("stopped", &["--threads", "2", "--quiet"]);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    while draws_on_disk(&b.path("stopped"), 16) < 20 {
        assert_eq!(child.try_wait().expect("a child"), None, "still drawing");
        std::thread::sleep(Duration::from_millis(2));
    }
    let signalled = std::time::Instant::now();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill starts");
    assert!(sent.success());
    let ended = child.wait_with_output().expect("a child");
    // A draw takes a few milliseconds; the rest is for a busy machine.
    assert!(signalled.elapsed() < Duration::from_secs(2), "{:?}", signalled.elapsed());
    assert_eq!(ended.status.code(), Some(130), "{}", errors(&ended));
    assert!(errors(&ended).contains("--resume"), "{}", errors(&ended));
    assert!(!b.path("stopped/runs.parquet").exists());
    b.done("stopped", &["--resume"]);
    assert!(b.bytes("stopped") == b.bytes("whole"));
}

/// Leaves a folder with a journal and a finished part, as a kill does.
fn interrupted(b: &Bench) {
    b.study(40, 8, IDENTIFY);
    b.done("half", &["--shard", "1/5"]);
    let parts = files(&b.path("half/parts"));
    assert_eq!(parts.len(), 1, "five parts, one of this shard");
    b.done("other", &["--shard", "2/5"]);
}

#[test]
fn law_what_is_in_the_way_is_an_error_and_stays() {
    let b = Bench::new();
    interrupted(&b);
    b.refused("half", &[], &["holds results", "--resume", "--force"]);
    b.refused("half", &["--shard", "1/5"], &["holds results"]);
    b.refused("nothing", &["--resume"], &["no study to resume"]);
    b.refused("half", &["--shard", "6/5"], &["i/n"]);
    b.refused("half", &["--resume", "--force"], &["--force"]);
    let study = fs::read_to_string(b.path("study.toml")).expect("there");
    fs::write(b.path("study.toml"), study.replace("seed = 3", "seed = 4")).expect("writable");
    b.refused("half", &["--resume"], &["another study file"]);
    fs::write(b.path("study.toml"), &study).expect("writable");
    let scenario = fs::read_to_string(b.path("short.toml")).expect("there");
    fs::write(b.path("short.toml"), scenario.replace("CA_T0 = 6.6620", "CA_T0 = 6.6")).expect("writable");
    b.refused("half", &["--resume"], &["short.toml"]);
    fs::write(b.path("short.toml"), &scenario).expect("writable");
    b.done("half", &["--resume"]);
    b.done("fresh", &[]);
    assert!(b.bytes("half") == b.bytes("fresh"));
    b.done("half", &["--force"]);
    assert!(b.bytes("half") == b.bytes("fresh"));
}

/// Any byte of a part that is another is found, and so is a part under another's number.
#[test]
fn law_corrupt_parts_are_found() {
    let b = Bench::new();
    interrupted(&b);
    let (path, good) = files(&b.path("half/parts")).remove(0);
    for at in [0, good.len() / 2, good.len() - 1] {
        let mut bad = good.clone();
        bad[at] ^= 0x10;
        fs::write(&path, bad).expect("writable");
        let before = files(&b.path("half/parts"));
        let ran = b.run("half", &["--resume"]);
        assert!(ran.status.code() == Some(2) && errors(&ran).contains("is corrupt"), "byte {at}: {}", errors(&ran));
        assert!(files(&b.path("half/parts")).starts_with(&before[..1]), "the corrupt part stays for who wants to look");
    }
    fs::write(&path, &good).expect("writable");
    let wrong = path.with_file_name(path.file_name().expect("a file").to_string_lossy().replacen("000000", "000001", 1));
    let right = fs::read_dir(b.path("half/parts"))
        .expect("there")
        .flatten()
        .find(|e| e.file_name().to_string_lossy().starts_with("000001"));
    fs::remove_file(right.expect("drawn by --resume").path()).expect("removable");
    fs::copy(&path, wrong).expect("writable");
    b.refused("half", &["--resume"], &["its draws are not those of the part"]);
}

#[test]
fn law_corrupt_journals_are_found() {
    let b = Bench::new();
    b.study(40, 40, IDENTIFY);
    let mut child = b.command("killed", &["--threads", "1", "--quiet"]).spawn().expect("the program starts");
    let journal = b.path("killed/parts/000000.rows");
    while fs::read_to_string(&journal).unwrap_or_default().lines().count() < 3 {
        assert!(child.try_wait().expect("a child").is_none(), "it is slower than this");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().expect("SIGKILL");
    child.wait().expect("a child");
    let text = fs::read_to_string(&journal).expect("lines are text");
    let lines: Vec<&str> = text.lines().collect();
    let twice = format!("{}\n{}\n", lines[0], lines[0]);
    let flipped = text.replacen("\"N\":4", "\"N\":5", 1);
    // A line that was cut off stays too while another is corrupt.
    let cut_off = format!("{flipped}0123");
    for bad in [twice, flipped, cut_off] {
        assert_ne!(bad, text);
        fs::write(&journal, &bad).expect("writable");
        b.refused("killed", &["--resume"], &["000000.rows", "is corrupt"]);
    }
    fs::write(&journal, &text).expect("writable");
    b.done("killed", &["--resume"]);
    b.done("whole", &[]);
    assert!(b.bytes("killed") == b.bytes("whole"));
}

/// A disk on which files can grow no further.
#[cfg(target_os = "linux")]
#[test]
fn law_full_disk_is_an_error_and_loses_nothing() {
    let b = Bench::new();
    interrupted(&b);
    let before: Vec<_> = files(&b.path("half/parts"));
    // Files that may not grow beyond a block fail where those on a full disk do.
    let words = b.command("half", &["--resume", "--threads", "1"]);
    let all = std::iter::once(words.get_program()).chain(words.get_args());
    let ran =
        Command::new("sh").args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$@\"", "sh"]).args(all).output().expect("a shell");
    let said = errors(&ran);
    assert!(ran.status.code() == Some(2) && said.contains(".rows") && said.contains("free space"), "{said}");
    let after = files(&b.path("half/parts"));
    let kept = |f: &(PathBuf, Vec<u8>)| after.iter().any(|a| a.0 == f.0 && a.1.starts_with(&f.1));
    assert!(before.iter().all(kept), "what was there stays");
    b.done("half", &["--resume"]);
    b.done("fresh", &[]);
    assert!(b.bytes("half") == b.bytes("fresh"));
}

/// The rule looks at whole parts in order, so that the end is the same however the draws were made; and it does what it says.
#[test]
fn law_stopping_rule_ends_at_the_same_draw() {
    let b = Bench::new();
    let rule = "[stop]\ncolumn = \"equation-error.CA.CA_T0.error\"\nhalf_width = 4e-4\nleast_draws = 16\n";
    b.study(400, 8, &format!("{IDENTIFY}{rule}"));
    b.done("one", &["--threads", "1"]);
    let one = b.bytes("one");
    b.done("seven", &["--threads", "7"]);
    assert!(b.bytes("seven") == one);
    let s = b.summary("one");
    let draws = s["draws"].as_u64().expect("a number");
    assert!(s["stopped_early"] == true && (16..400).contains(&draws) && draws.is_multiple_of(8), "{draws}");
    let width = |s: &Value| {
        let p = s["parameters"].as_array().expect("a list").iter().find(|p| p["name"] == "CA_T0").expect("it is there").clone();
        p["bias_ci95"][1].as_f64().expect("a number") - p["bias_ci95"][0].as_f64().expect("a number")
    };
    assert!(width(&s) <= 8e-4);
    for shard in ["2/2", "1/2"] {
        b.done("shards", &["--shard", shard]);
    }
    b.done("shards", &["--resume"]);
    assert!(b.bytes("shards") == one, "shards draw all, the rule is applied when they are joined");
    b.study(400, 8, &format!("{IDENTIFY}{}", rule.replace("CA_T0.error", "CA_T0.eror")));
    b.refused("bad", &[], &["CA_T0.eror", "is no column"]);
}

/// What varies has the moments that were ordered, within 4.5 standard errors of 400 draws (cut normals and copulas are tested
/// exactly where they are made).
#[test]
fn law_what_varies_has_its_moments() {
    let b = Bench::new();
    let plain = "[[vary]]\nquantity = \"vehicle.mass_kg\"\nnormal = { mean = 0.8, std = 0.01 }\nknown = true\n";
    b.study(400, 64, &format!("{plain}{VARIED}"));
    b.done("a", &[]);
    let s = b.summary("a");
    let number = |name: &str| s["numbers"].as_array().expect("a list").iter().find(|n| n["name"] == name).expect("kept").clone();
    let near = |name: &str, mean: f64, std: f64| {
        let n = number(name);
        let (m, sd) = (n["mean"].as_f64().expect("a number"), n["std"].as_f64().expect("a number"));
        assert!((m - mean).abs() < 4.5 * std / 20.0, "{name}: mean {m}");
        assert!((sd / std - 1.0).abs() < 4.5 / 28.0, "{name}: std {sd}");
    };
    near("vary.vehicle.mass_kg", 0.8, 0.01);
    near("vary.aero.Cm_2", -205.4, 20.0);
    near("vary.flight.release.attitude_deg.Ry", 25.0, 10.0 / 12.0_f64.sqrt());
    near("vary.effects.turbulence.axial_rms_m_s", 0.05, 0.05);
    assert_eq!(s["failures"]["any"]["count"], 0);
    assert_eq!(s["draws"], 400);
}

/// A draw that cannot be flown is a row with its reason, not the end of the study.
#[test]
fn law_a_failed_draw_is_counted() {
    let b = Bench::new();
    let half = "[[vary]]\nquantity = \"sensors.position_std_m\"\nnormal = { mean = 1e-4, std = 1e-3 }\n";
    b.study(64, 16, &format!("{IDENTIFY}{half}"));
    let ran = b.done("a", &[]);
    let s = b.summary("a");
    let failed = s["failures"]["any"]["count"].as_u64().expect("a number");
    // P(z < -0.1) = 0.46: 29 of 64, within five standard deviations of 4
    assert!((10..50).contains(&failed), "{failed}");
    assert!(errors(&ran).contains("sensors.position_std_m drawn outside its range"), "{}", errors(&ran));
    // In noise of millimetres the method refuses this coefficient of two draws: those are neither found nor failed.
    let found = s["parameters"][0]["n"].as_u64().expect("a number");
    assert_eq!(found + failed, 62);
}

/// A measured campaign is flown again: here one that the program made itself, whose known parameters must come back.
#[test]
fn recover_parameters_of_a_campaign_that_is_flown_again() {
    let b = Bench::new();
    let out = b.path("flown");
    let simulated = Command::new(env!("CARGO_BIN_EXE_windfall"))
        .args(["simulate", "sage-perturbed", "--out"])
        .arg(&out)
        .output()
        .expect("the program starts");
    assert!(simulated.status.success());
    let text = "[study]\nname = \"again\"\ncampaign = \"flown/campaign.toml\"\ndraws = 6\nseed = 1\n[do]\nidentify = \
                [\"equation-error\", \"output-error\"]\nresimulate = true\n";
    fs::write(b.path("study.toml"), text).expect("writable");
    b.done("a", &["--threads", "2"]);
    let s = b.summary("a");
    assert_eq!(s["failures"]["any"]["count"], 0);
    let parameters = s["parameters"].as_array().expect("a list");
    let by = |method: &str| parameters.iter().filter(|p| p["method"] == method).count();
    assert_eq!((by("equation-error"), by("output-error")), (13, 13));
    for p in parameters {
        let (bias, stated) = (p["bias"].as_f64().expect("a number"), p["mean_std_error"].as_f64().expect("a number"));
        // Mean of six: five of its standard errors, and half of one for the method's own bias.
        assert!(bias.abs() < (5.0 / 6.0_f64.sqrt() + 0.5) * stated, "{}: {bias} of {stated}", p["name"]);
    }
    let attitude =
        s["numbers"].as_array().expect("a list").iter().find(|n| n["name"] == "equation-error.resimulate.attitude_rms_deg");
    assert!(attitude.and_then(|n| n["mean"].as_f64()).is_some_and(|m| m < 0.5), "{attitude:?}");
}

#[test]
fn law_faults_of_a_study_file_are_all_named_with_their_line() {
    let b = Bench::new();
    b.study(
        8,
        4,
        "[do]\nidentfy = [\"thesis\"]\n[[vary]]\nquantity = \"vehicle.mas_kg\"\nuniform = { low = 2.0, high = 1.0 }\n[[vary]]\nquantity \
         = \"vehicle.mass_kg\"\nuniform = { low = -1.0, high = 1.0 }\n[[vary]]\nquantity = \"tether.ring_m.Y\"\nnormal = { mean = nan, \
         std = 1.0 }\n",
    );
    b.refused(
        "a",
        &[],
        &["study.toml:8", "identfy", "identify", "vehicle.mas_kg", "vehicle.mass_kg", "must be below high", "-1", "mean = nan"],
    );
    b.study(8, 4, "[do]\nidentify = [\"thesis\", \"magic\"]\n");
    b.refused("a", &[], &["magic", "equation-error"]);
    b.study(8, 4, "[[vary]]\nquantity = \"aero.Cm_2\"\nuniform = { low = 1.0, high = 2.0 }\n[[correlation]]\nbetween = [\"aero.Cm_2\", \"aero.Cm_1\"]\ncoefficient = 0.5\n");
    b.refused("a", &[], &["aero.Cm_1", "does not vary"]);
}
