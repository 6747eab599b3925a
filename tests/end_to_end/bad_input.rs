//! tests: the table of bad inputs. In: sound files of every kind, each key of them changed. Out: exit code and message of each change,
//! held against `docs/reference/bad-input.md`; `WINDFALL_WRITE_REFERENCE=1` writes that file anew.

use crate::program::{done, folder, text, windfall};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What is done to a value.
const CHANGES: [(&str, Option<&str>); 7] = [
    ("missing", None),
    ("NaN", Some("nan")),
    ("negative", Some("-1.0")),
    ("zero", Some("0.0")),
    ("1e30", Some("1e30")),
    ("true", Some("true")),
    ("text", Some("\"x\"")),
];
/// Longest that one of these inputs may take, on a busy machine; most take milliseconds.
const LONGEST: Duration = Duration::from_secs(60);

const STUDY: &str = r#"[study]
name = "test"
scenario = "scenario.toml"
draws = 4
seed = 3
part_draws = 2

[do]
identify = ["equation-error"]
resimulate = true
close = false

[keep]
flights = true
estimates = true
intervals = true
resimulation = true
closing = true

[[vary]]
quantity = "aero.Cm_2"
known = false
normal = { mean = -205.4, std = 20.0, low = -300.0, high = -100.0 }

[[vary]]
quantity = "vehicle.mass_kg"
uniform = { low = 0.7, high = 0.9 }

[[correlation]]
between = ["aero.Cm_2", "vehicle.mass_kg"]
coefficient = 0.5

[stop]
column = "flight.run.flown_s"
half_width = 0.1
least_draws = 2
"#;

/// One row of the table.
struct Row {
    file: &'static str,
    key: String,
    change: String,
    code: u8,
    message: String,
}

/// Places of values in a TOML text: path of the key, range of `key = value` without its end of line, range of the value.
fn places(text: &str) -> Vec<(String, std::ops::Range<usize>, std::ops::Range<usize>)> {
    let (mut all, mut table, mut at) = (Vec::new(), String::new(), 0);
    for line in text.split_inclusive('\n') {
        let bare = line.split(" #").next().unwrap_or("").trim_end();
        if bare.starts_with('[') {
            table = bare.trim_matches(['[', ']']).to_owned() + ".";
        } else if let Some((key, value)) = bare.split_once(" = ").filter(|_| !bare.starts_with('#')) {
            let from = at + key.len() + 3;
            all.push((format!("{table}{key}"), at..at + bare.len(), from..from + value.len()));
            if value.starts_with('{') {
                let mut inside = from + 2;
                for pair in value.trim_matches(['{', '}', ' ']).split(", ") {
                    if let Some((inner, number)) = pair.split_once(" = ") {
                        let start = inside + inner.len() + 3;
                        all.push((format!("{table}{key}.{inner}"), inside..inside + pair.len(), start..start + number.len()));
                    }
                    inside += pair.len() + 2;
                }
            }
        }
        at += line.len();
    }
    all
}

/// Every change of every value: path of the key, word of the change, text.
fn changed(text: &str) -> Vec<(String, String, String)> {
    let mut all = Vec::new();
    for (key, whole, value) in places(text) {
        let list = text[value.clone()].starts_with('[') && !text[value.clone()].contains('"');
        for (word, new) in CHANGES {
            let (range, new) = match new {
                // A pair within braces goes with the comma after or before it.
                None if key.ends_with(|c: char| c.is_ascii()) && text[..whole.start].ends_with("{ ") => {
                    let end = if text[whole.end..].starts_with(", ") { whole.end + 2 } else { whole.end };
                    (whole.start..end, String::new())
                }
                None if text[..whole.start].ends_with(", ") => (whole.start - 2..whole.end, String::new()),
                None => (whole.clone(), String::new()),
                Some(number) if list && !number.starts_with(['t', '"']) => {
                    let count = text[value.clone()].split(',').count();
                    (value.clone(), format!("[{}]", vec![number; count].join(", ")))
                }
                Some(other) => (value.clone(), other.to_owned()),
            };
            let mut made = text.to_owned();
            made.replace_range(range, &new);
            all.push((key.clone(), word.to_owned(), made));
        }
    }
    all
}

/// The same of a result: each key of it, of its first data set and of that one's first parameter.
fn changed_json(whole: &Value) -> Vec<(String, String, String)> {
    let mut all = Vec::new();
    for at in ["", "/data_sets/0", "/data_sets/0/parameters/0"] {
        let keys: Vec<String> =
            whole.pointer(at).and_then(Value::as_object).map(|m| m.keys().cloned().collect()).unwrap_or_default();
        for key in keys {
            for (word, value) in [
                ("missing", None),
                ("null", Some(Value::Null)),
                ("negative", Some(serde_json::json!(-1.0))),
                ("1e6", Some(serde_json::json!(1e6))),
                ("text", Some(serde_json::json!("x"))),
            ] {
                let mut made = whole.clone();
                let Some(map) = made.pointer_mut(at).and_then(Value::as_object_mut) else { continue };
                match value {
                    None => drop(map.remove(&key)),
                    Some(v) => drop(map.insert(key.clone(), v)),
                }
                all.push((format!("{at}/{key}"), word.to_owned(), made.to_string()));
            }
        }
    }
    all
}

/// Sound files of every kind, 3 s of a flight at 100 Hz.
struct Bench {
    dir: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self { dir: folder() };
        let whole = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
        let short = whole.replace("duration_s = 18.3", "duration_s = 3.0").replace("rate_hz = 150.0", "rate_hz = 100.0");
        fs::write(bench.path("scenario.toml"), &short).expect("writable");
        fs::write(bench.path("study.toml"), STUDY).expect("writable");
        done(&["simulate", &text(&bench.path("scenario.toml")), "--out", &text(&bench.path("made")), "--quiet"]);
        fs::copy(bench.path("made/run.csv"), bench.path("run.csv")).expect("there");
        fs::copy(bench.path("made/campaign.toml"), bench.path("campaign.toml")).expect("there");
        done(&["identify", &text(&bench.path("campaign.toml")), "--out", &text(&bench.path("made")), "--combined", "--quiet"]);
        fs::copy(bench.path("made/identification.json"), bench.path("model.json")).expect("there");
        bench
    }
    fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }
    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("written above")
    }
    /// Runs commands on a changed file until one does not end well.
    fn row(&self, file: &'static str, (key, change, made): (String, String, String), commands: &[&[&str]]) -> Row {
        let bad = self.path("bad").join(file);
        fs::create_dir_all(self.path("bad")).expect("writable");
        fs::write(&bad, made).expect("writable");
        fs::copy(self.path("run.csv"), self.path("bad/run.csv")).expect("there");
        if file == "study.toml" {
            fs::copy(self.path("scenario.toml"), self.path("bad/scenario.toml")).expect("there");
        }
        let (bad, campaign) = (text(&bad), text(&self.path("campaign.toml")));
        let start = Instant::now();
        let (mut code, mut message) = (0, "accepted".to_owned());
        for command in commands {
            let words: Vec<&str> = command
                .iter()
                .map(|w| {
                    if *w == "FILE" {
                        bad.as_str()
                    } else if *w == "CAMPAIGN" {
                        campaign.as_str()
                    } else {
                        w
                    }
                })
                .collect();
            let ran = windfall(&words);
            code = ran.code;
            if code != 0 {
                let all: Vec<&str> = ran.err.lines().filter(|l| !l.starts_with("warning:")).collect();
                message = short(&all, self.dir.path());
                break;
            }
        }
        assert!(start.elapsed() < LONGEST, "{file} {key} {change}: {:?}", start.elapsed());
        Row { file, key, change, code, message }
    }
}

/// The first fault, and how many follow; without the folder of this run.
fn short(lines: &[&str], dir: &Path) -> String {
    let first = lines.first().copied().unwrap_or_default().trim_start_matches("error: ");
    let inside = format!("{}/", dir.join("bad").display());
    let outside = format!("{}/", dir.display());
    let more = if lines.len() > 1 { format!(" (and {} more)", lines.len() - 1) } else { String::new() };
    first.replace(&inside, "").replace(&outside, "") + &more
}

/// Numbers that were computed, by their last digits no longer the same on every machine.
fn without_numbers(message: &str) -> String {
    let mut all = String::new();
    for c in message.chars() {
        if c.is_ascii_digit() {
            if !all.ends_with('#') {
                all.push('#');
            }
        } else {
            all.push(c);
        }
    }
    all.replace("#.#", "#").replace("#e-#", "#").replace("#e#", "#").replace("-#", "#")
}

fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "# What a wrong input gives\n\nMade by `tests/end_to_end/bad_input.rs` from sound files, each key of them changed in turn: {} inputs. \
         Exit code 0: accepted; 2: bad input; 3: the numbers failed. `#` stands for a number that was computed.\n",
        rows.len()
    );
    let mut last = "";
    for r in rows {
        if r.file != last {
            last = r.file;
            let _ = write!(text, "\n## `{last}`\n\n| key | changed to | exit | message |\n|---|---|---|---|\n");
        }
        let _ = writeln!(text, "| `{}` | {} | {} | {} |", r.key, r.change, r.code, r.message.replace('|', "\\|"));
    }
    text
}

/// What an answer lacks: an exit code of the contract, a remedy, and of a fault in a file its line and key.
fn poor(r: &Row) -> Option<String> {
    let name = r.key.rsplit('.').next().unwrap_or("");
    let is_fault = r.code == 2 && r.message.starts_with(r.file);
    let numbered = |m: &str| m.starts_with(':') && m[1..].starts_with(|c: char| c.is_ascii_digit());
    // A fault between several flights is on none of their lines.
    let has_line = r.message.strip_prefix(r.file).is_some_and(numbered) || r.message.contains("[[");
    let has_key = r.message.contains(name) || r.key.split('.').any(|part| r.message.contains(part));
    let lacks = match r {
        r if !matches!(r.code, 0 | 2 | 3) => "an exit code of the contract",
        r if r.code != 0 && !["; try: ", "try ", "look for"].iter().any(|w| r.message.contains(w)) => "a remedy",
        _ if is_fault && !has_line => "a line",
        _ if is_fault && !has_key => "a key",
        _ => return None,
    };
    Some(format!("{} {} {}: {} lacks {lacks}: {}", r.file, r.key, r.change, r.code, r.message))
}

/// No panic, no hang, an exit code of the contract; a fault names file, line, key and remedy; the table in the documents is what the
/// program says.
#[test]
fn law_every_wrong_input_is_answered() {
    let bench = Bench::new();
    let mut rows = Vec::new();
    let check: &[&str] = &["check", "FILE"];
    let fly: &[&str] = &["simulate", "FILE", "--json", "--quiet"];
    for (file, commands) in [("scenario.toml", &[check, fly][..]), ("campaign.toml", &[check]), ("study.toml", &[check])] {
        rows.extend(changed(&bench.read(file)).into_iter().map(|c| bench.row(file, c, commands)));
    }
    let wrong: Vec<String> = rows.iter().filter_map(poor).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let model: Value = serde_json::from_str(&bench.read("model.json")).expect("JSON");
    let again: &[&str] = &["resimulate", "CAMPAIGN", "--model", "FILE", "--json", "--quiet"];
    rows.extend(changed_json(&model).into_iter().map(|c| bench.row("identification.json", c, &[again])));
    for r in rows.iter_mut().filter(|r| r.code == 3 || r.file == "identification.json" || !r.message.starts_with(r.file)) {
        r.message = without_numbers(&r.message);
    }
    assert!(rows.len() >= 300, "{}", rows.len());
    assert!(rows.iter().all(|r| matches!(r.code, 0 | 2 | 3)), "an exit code that is none of the contract");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference/bad-input.md");
    let now = table(&rows);
    if std::env::var_os("WINDFALL_WRITE_REFERENCE").is_some() {
        fs::write(&path, &now).expect("the folder of the documents is writable");
    }
    let stored = fs::read_to_string(&path).unwrap_or_default();
    let differs = now.lines().zip(stored.lines()).find(|(a, b)| a != b);
    assert!(now == stored, "bad-input.md is old, run `just references`; first: {differs:?}");
}
