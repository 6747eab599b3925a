//! cli: inputs that never ended or took all memory, in processes of their own. In: such files. Out: an answer in time.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest that an answer may take, on a busy machine.
const LONGEST: Duration = Duration::from_secs(60);

struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn write(&self, name: &str, text: &str) -> String {
        fs::write(self.path(name), text).expect("writable");
        self.path(name).display().to_string()
    }
    /// Exit code and what was said; a process that does not end is a failure.
    fn run(&self, words: &[&str]) -> (Option<i32>, String) {
        let said = self.path("said");
        let log = fs::File::create(&said).expect("writable");
        let mut c = Command::new(env!("CARGO_BIN_EXE_windfall"));
        let mut child = c.args(words).current_dir(self.0.path()).stdout(Stdio::null()).stderr(log).spawn().expect("starts");
        let start = Instant::now();
        loop {
            if let Some(status) = child.try_wait().expect("was started") {
                return (status.code(), fs::read_to_string(&said).unwrap_or_default());
            }
            if start.elapsed() > LONGEST {
                let _ = child.kill();
                panic!("{words:?} does not end");
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    fn refused(&self, words: &[&str], code: i32, says: &[&str]) {
        let (found, said) = self.run(words);
        assert!(found == Some(code) && says.iter().all(|w| said.contains(w)), "{words:?}: {found:?} {said}");
    }
    /// A sound campaign of 3 s at 100 Hz in this folder.
    fn campaign(&self) {
        let whole = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
        let short = whole.replace("duration_s = 18.3", "duration_s = 3.0").replace("rate_hz = 150.0", "rate_hz = 100.0");
        let short = self.write("short.toml", &short);
        self.refused(&["simulate", &short, "--out", ".", "--quiet"], 0, &[]);
    }
    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("written")
    }
}

fn scenario(changes: &[(&str, &str)]) -> String {
    let mut text = windfall_scenarios::bundled("sage-perturbed").expect("bundled").to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text
}

/// Every count that a file or flag sets has a limit that the error names.
#[test]
fn law_counts_have_limits() {
    let b = Bench::new();
    let study = |more: &str| format!("[study]\nname = \"s\"\nscenario = \"sage-perturbed\"\nseed = 1\n{more}");
    for (more, says) in [
        ("draws = 1000000000000\n", &["study.toml:5", "draws", "from 1 to 100000000"][..]),
        ("draws = 100000000\n", &["study.toml:5", "draws", "at most 100000 are kept", "part_draws = 1000"]),
        ("draws = 9\npart_draws = 1000000\n", &["part_draws", "from 1 to 100000"]),
    ] {
        let file = b.write("study.toml", &study(more));
        b.refused(&["check", &file], 2, says);
        b.refused(&["study", &file, "--out", "drawn"], 2, says);
    }
    for (changes, says) in [
        (&[("duration_s = 18.3", "duration_s = 1e5")][..], &["duration_s", "1e4"][..]),
        (&[("duration_s = 18.3", "duration_s = 9e3")], &["rate_hz", "1.350e6 samples", "at most 1e6"]),
        (
            &[("unsteady_time_s = 1.0", "unsteady_time_s = 1e-3"), ("duration_s = 18.3", "duration_s = 6000.0")],
            &["unsteady_time_s", "at most 2e7"],
        ),
    ] {
        let file = b.write("long.toml", &scenario(changes));
        b.refused(&["simulate", &file, "--out", "flown"], 2, says);
    }
    b.campaign();
    for (flag, value) in [("--threads", "65535"), ("--threads", "0"), ("--bootstrap", "65535")] {
        b.refused(&["identify", "campaign.toml", flag, value, "--json"], 2, &[flag, value]);
    }
    b.refused(&["check", "campaign.toml", "--threads", "1e9"], 2, &["1 to 512", "one per processor"]);
    for (flag, value) in [("--seeds", "65535"), ("--draws", "65535")] {
        b.refused(&["resimulate", "campaign.toml", "--model", "x.json", flag, value], 2, &[flag, "10000"]);
    }
}

/// What departs ends with a reason, exit code 3.
#[test]
fn law_flights_that_depart_end() {
    let b = Bench::new();
    for (from, to) in [("Cm_1 = -3.3025", "Cm_1 = 1e9"), ("Cl_p = -5.6816", "Cl_p = 1e6")] {
        let file = b.write("stiff.toml", &scenario(&[(from, to)]));
        b.refused(&["simulate", &file, "--out", "flown"], 3, &["flight run", "t = ", "look for"]);
        assert!(!b.path("flown/run.csv").exists(), "a flight that failed leaves no record");
    }
    let point = scenario(&[("xx = 0.02113, yy = 0.0138, zz = 0.01379", "xx = 1e-9, yy = 1e-9, zz = 1e-9")]);
    b.refused(&["simulate", &b.write("point.toml", &point), "--out", "flown"], 2, &["inertia_kg_m2", "radius of gyration"]);
    b.campaign();
    b.refused(&["identify", "campaign.toml", "--out", ".", "--method", "equation-error"], 0, &[]);
    let model = b.text("identification.json");
    let mut json: serde_json::Value = serde_json::from_str(&model).expect("JSON");
    for p in json.pointer_mut("/data_sets/0/parameters").and_then(|p| p.as_array_mut()).into_iter().flatten() {
        p["estimate"] = serde_json::json!(1e6);
    }
    let sets = json["data_sets"].as_array().expect("a list").len();
    (1..sets).for_each(|i| json["data_sets"][i]["parameters"] = json["data_sets"][0]["parameters"].clone());
    b.write("wild.json", &json.to_string());
    let (code, said) = b.run(&["resimulate", "campaign.toml", "--model", "wild.json", "--json"]);
    assert!(matches!(code, Some(2 | 3)) && !said.is_empty(), "{code:?} {said}");
}

/// Pipes, devices and folders are named, not waited for.
#[cfg(unix)]
#[test]
fn law_only_regular_files_are_read() {
    let b = Bench::new();
    b.campaign();
    for name in ["pipe.csv", "pipe.toml", "pipe.json", "pipe.parquet"] {
        assert!(Command::new("mkfifo").arg(b.path(name)).status().is_ok_and(|s| s.success()), "mkfifo is there");
    }
    std::os::unix::fs::symlink("/dev/zero", b.path("zero.csv")).expect("links");
    fs::create_dir(b.path("folder.csv")).expect("writable");
    for (name, what) in
        [("pipe.csv", "a pipe (FIFO)"), ("pipe.parquet", "a pipe (FIFO)"), ("zero.csv", "a device"), ("folder.csv", "a folder")]
    {
        let campaign = b.text("campaign.toml").replace("run.csv", name);
        b.write("bad.toml", &campaign);
        b.refused(&["check", "bad.toml"], 2, &[name, what, "try: "]);
        b.refused(&["check", name], 2, &[name, what]);
    }
    b.refused(&["check", "./pipe.toml"], 2, &["pipe.toml: is a pipe (FIFO); allowed: a regular file"]);
    b.refused(&["simulate", "./pipe.toml"], 2, &["a pipe"]);
    b.refused(&["close", "./pipe.toml"], 2, &["a pipe"]);
    b.refused(&["study", "./pipe.toml"], 2, &["a pipe"]);
    b.refused(&["resimulate", "campaign.toml", "--model", "pipe.json"], 2, &["a pipe"]);
}

/// A campaign reads what came with it; an absolute path is its reader's own word.
#[test]
fn law_paths_do_not_climb() {
    let b = Bench::new();
    b.campaign();
    let text = b.text("campaign.toml");
    fs::create_dir(b.path("inner")).expect("writable");
    b.write("inner/campaign.toml", &text.replace("\"run.csv\"", "\"../run.csv\""));
    b.refused(&["check", "inner/campaign.toml"], 2, &["[[run]] file = \"../run.csv\"", "leaves the folder", "absolute path"]);
    let absolute = format!("\"{}\"", b.path("run.csv").display());
    b.write("inner/campaign.toml", &text.replace("\"run.csv\"", &absolute));
    b.refused(&["check", "inner/campaign.toml"], 0, &[]);
    b.write("inner/campaign.toml", &text.replace("[aero.axisymmetric]", "[aero.mine]\nstructure = \"../structure.toml\""));
    b.refused(&["check", "inner/campaign.toml"], 2, &["structure", "leaves the folder"]);
    b.write("inner/campaign.toml", &text.replace("[aero.axisymmetric]", "[aero.\"../mine\"]\nstructure = \"structure.toml\""));
    b.refused(&["check", "inner/campaign.toml"], 2, &["../mine", "must be of letters"]);
    // A study, and what it names.
    let study = |more: &str| format!("[study]\nname = \"s\"\ndraws = 1\nseed = 1\n{more}\n");
    for (key, more) in [
        ("scenario", "scenario = \"../short.toml\""),
        ("campaign", "campaign = \"../campaign.toml\""),
        ("model", "campaign = \"../campaign.toml\"\nmodel = \"../model.json\""),
        ("files", "scenario = \"sage-perturbed\"\n[histories]\nfiles = [\"../run.csv\"]"),
    ] {
        b.write("inner/study.toml", &study(more));
        b.refused(&["check", "inner/study.toml"], 2, &[key, "\"../", "leaves the folder", "absolute path"]);
    }
    let absolute = format!("scenario = \"{}\"", b.path("short.toml").display());
    b.write("inner/study.toml", &study(&absolute));
    b.refused(&["check", "inner/study.toml"], 0, &[]);
}

/// A study writes below its folder only: links there are refused.
#[cfg(unix)]
#[test]
fn law_a_study_follows_no_link() {
    let b = Bench::new();
    let file = b.write("study.toml", "[study]\nname = \"s\"\nscenario = \"sage-perturbed\"\nseed = 1\ndraws = 1\n");
    let (mine, out) = (b.path("mine"), b.path("out"));
    for name in ["runs.parquet", "study.json", "parts"] {
        let _ = fs::remove_dir_all(&out);
        fs::create_dir_all(&mine).expect("writable");
        fs::create_dir(&out).expect("writable");
        std::os::unix::fs::symlink(&mine, out.join(name)).expect("links");
        b.refused(&["study", &file, "--out", "out"], 2, &[name, "is a link"]);
        assert!(is_empty(&mine), "{name}");
    }
}

#[cfg(unix)]
fn is_empty(folder: &Path) -> bool {
    fs::read_dir(folder).is_ok_and(|mut d| d.next().is_none())
}

/// A page of something that is no result, names that would be code, a page that asks for anything outside.
#[test]
fn law_pages_are_of_results_and_run_nothing() {
    let b = Bench::new();
    for name in ["identification.json", "close.json", "resimulation.json", "verify.json", "summary.json"] {
        let folder = b.path(&name.replace('.', "-"));
        fs::create_dir(&folder).expect("writable");
        fs::write(folder.join(name), "{}").expect("writable");
        b.refused(&["report", &folder.display().to_string()], 2, &[name, "try: "]);
        assert!(!folder.join("report.html").exists(), "{name}");
    }
    b.campaign();
    let evil = "<script>alert(1)</script><img src=x onerror=alert(2)>\\\" onload=\\\"alert(3)";
    let text = b
        .text("campaign.toml")
        .replace("sage-perturbed\"", &format!("{evil}\""))
        .replace("kind = \"perturbed\"", "kind = \"<b>k</b>\"");
    b.write("evil.toml", &text);
    let (code, said) = b.run(&["close", "evil.toml", "--out", "closed", "--quiet"]);
    assert!(matches!(code, Some(0 | 1)), "{said}");
    b.refused(&["identify", "evil.toml", "--out", "closed", "--method", "equation-error", "--quiet"], 0, &[]);
    let made = b.text("closed/report.html");
    b.refused(&["report", "closed", "--quiet"], 0, &[]);
    for page in [made, b.text("closed/report.html")] {
        assert!(page.contains("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'"), "no policy");
        // Data of the page is text to a browser as long as no tag can begin in it.
        let (before, rest) = page.split_once("id=\"data\">").expect("data");
        let (data, after) = rest.split_once("</script>").expect("an end");
        assert!(!data.contains('<'), "a tag in the data");
        let marked = |w: &&str| before.contains(*w) || after.contains(*w);
        assert!(!["<script>", "<img", "<b>k", "\" onload"].iter().any(marked), "code of a name in the page");
        // The page's own scripts alone: each has the nonce that the policy names, or is data.
        let nonce = page.split("'nonce-").nth(1).and_then(|rest| rest.split('\'').next()).expect("a nonce");
        let (own, data) = (format!(" nonce=\"{nonce}\""), " type=\"application/json\"");
        let scripts: Vec<&str> = page.split("<script").skip(1).collect();
        assert!(
            !scripts.is_empty() && scripts.iter().all(|s| s.starts_with(&own) || s.starts_with(data)),
            "a script of another's"
        );
        // The plotting library's licence notice, a comment, names where it is from.
        let own_words = page.replace("https://github.com/leeoniya/uPlot", "");
        assert!(!own_words.contains("http://") && !own_words.contains("https://"), "an address outside");
    }
}

/// Units, still air, constant signals, names twice: each named for what it is.
#[test]
fn law_what_was_blamed_wrongly_or_not_at_all() {
    let b = Bench::new();
    b.campaign();
    let text = b.text("campaign.toml");
    let rows: Vec<Vec<String>> = b.text("run.csv").lines().map(|l| l.split(',').map(str::to_owned).collect()).collect();
    let place = |name: &str| rows[0].iter().position(|c| c == name).expect("a column");
    let with = |change: &dyn Fn(&mut Vec<Vec<String>>)| {
        let mut all = rows.clone();
        change(&mut all);
        all.iter().map(|r| r.join(",") + "\n").collect::<String>()
    };
    b.write("grams.toml", &text.replace("mass_kg = 0.7873", "mass_kg = 787.3"));
    b.refused(&["check", "grams.toml"], 2, &["mass_kg looks like g: multiply by 0.001"]);
    b.write("inertia.toml", &text.replace("xx = 0.02113, yy = 0.0138, zz = 0.01379", "xx = 211.3, yy = 138.0, zz = 137.9"));
    b.refused(&["check", "inertia.toml"], 2, &["inertia_kg_m2"]);
    for (file, words) in [
        ("still", &["VW_m_s", "air passes the model at", "m/s"][..]),
        ("frozen", &["the pose never changes", "no parameter is excited"]),
    ] {
        let run = with(&|all| {
            let first = all[1].clone();
            for row in &mut all[1..] {
                if file == "still" {
                    ["VW_m_s", "qW_Pa"].iter().for_each(|c| row[place(c)] = "0".to_owned());
                } else {
                    let t = row[0].clone();
                    row.clone_from(&first);
                    row[0] = t;
                }
            }
        });
        b.write(&format!("{file}.csv"), &run);
        b.write(&format!("{file}.toml"), &text.replace("run.csv", &format!("{file}.csv")));
        b.refused(&["check", &format!("{file}.toml")], 2, words);
        b.refused(&["identify", &format!("{file}.toml"), "--json"], 2, words);
    }
    b.write("big.csv", &with(&|all| all[150][place("Y_m")] = "1e308".to_owned()));
    b.write("big.toml", &text.replace("run.csv", "big.csv"));
    b.refused(&["check", "big.toml"], 0, &["Y_m: spike of 1", "t = 1.4900 s removed"]);
    b.refused(&["identify", "big.toml", "--json"], 0, &[]);
    b.write(
        "twice.toml",
        &text.replace("[aero.axisymmetric]", "[aero.axisymmetric]\ndeclared = [\"CA_T0\", \"CN_sin\", \"CA_T0\"]"),
    );
    b.refused(&["check", "twice.toml"], 2, &["declared", "\"CA_T0\"", "appears twice"]);
    b.write(
        "structure.toml",
        "parameters = [\"CA_0\", \"CA_1\"]\n[[term]]\ncoefficient = \"CA\"\nparameter = \"CA_0\"\nscale = 1.0\nfactors = []\n",
    );
    b.refused(&["check", "structure.toml"], 2, &["CA_1", "is in no [[term]]"]);
    let flight = scenario(&[]);
    let (head, body) = flight.split_once("[[flight]]").expect("a flight");
    for (one, other) in [("a", "a-truth"), ("Fast", "fast"), ("a", "a")] {
        let named = |name: &str| format!("[[flight]]{}", body.replace("name = \"run\"", &format!("name = \"{name}\"")));
        b.write("names.toml", &format!("{head}{}{}", named(one), named(other)));
        b.refused(&["check", "names.toml"], 2, &["[[flight]] name", other]);
    }
}

/// Each failure of the table has a test of that name in that file.
#[test]
fn law_every_failure_has_its_test() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let table = fs::read_to_string(root.join("docs/reference/failures.md")).expect("the table");
    let rows: Vec<&str> = table.lines().filter(|l| l.starts_with("| ")).skip(1).collect();
    assert!(rows.len() >= 20, "{} rows", rows.len());
    for row in rows {
        let words: Vec<&str> = row.split('`').rev().take(4).collect();
        let [_, name, _, file] = words[..] else { panic!("no test in: {row}") };
        let source = fs::read_to_string(root.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert!(source.contains(&format!("fn {name}() {{")), "{file} lacks {name}");
    }
}
