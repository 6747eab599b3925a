//! cli tests: one page, run. In: its text. Out: what is wrong with it, each with its line; the page with what came out.

use crate::page::{Item, What, commands, is_mention, items, line};
use crate::text::{Token, agrees, pairs, tokens, written_like};
use crate::{figure, named, root};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};

const PROGRAM: &str = env!("CARGO_BIN_EXE_windfall");

/// What a command left.
#[derive(Clone)]
struct Ran {
    command: String,
    code: i32,
    out: String,
    err: String,
}

/// Commands on bundled scenarios, which say the same on every page: what they left, and the folder that they made.
#[derive(Default)]
pub(crate) struct Memory(Mutex<BTreeMap<String, (Ran, Option<tempfile::TempDir>)>>);

/// What marks say of the next command or block.
#[derive(Default)]
struct Pending {
    /// The next block is a file, which is written already.
    file: bool,
    exit: i32,
    left_out: bool,
    /// Output, or else errors, are recorded in the next block.
    recorded: Option<bool>,
}

/// A page on its way.
pub(crate) struct Runner<'p> {
    name: &'p str,
    text: &'p str,
    nightly: bool,
    memory: &'p Memory,
    folder: tempfile::TempDir,
    pending: Pending,
    /// Whether what follows waits for the night.
    late: bool,
    /// Level of the heading below which figures are of a run that is named.
    made_by: Option<usize>,
    level: usize,
    last: Option<Ran>,
    ran: BTreeMap<String, Ran>,
    faults: Vec<String>,
    /// Parts of the page with what stands there instead.
    renewed: Vec<(Range<usize>, String)>,
}

impl<'p> Runner<'p> {
    pub(crate) fn new(name: &'p str, text: &'p str, nightly: bool, memory: &'p Memory) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        // What a reader of the page has beside it.
        for there in ["scenarios", "benchmarks"] {
            std::os::unix::fs::symlink(root().join(there), folder.path().join(there)).expect("a link");
        }
        let (pending, ran) = (Pending::default(), BTreeMap::new());
        let (faults, renewed) = (Vec::new(), Vec::new());
        Self {
            name,
            text,
            nightly,
            memory,
            folder,
            pending,
            late: false,
            made_by: None,
            level: 0,
            last: None,
            ran,
            faults,
            renewed,
        }
    }

    /// What is wrong, and the page renewed.
    pub(crate) fn walk(mut self) -> (Vec<String>, String) {
        let all = items(self.text);
        self.files(&all);
        for item in all {
            match &item.what {
                What::Mark(words) => self.mark(words, &item),
                What::Block(language, body) => self.block(language, body, &item),
                What::Code(code) => self.code(code, &item),
                What::Heading(level) => {
                    self.level = *level;
                    self.made_by = self.made_by.filter(|by| by < level);
                }
                What::Table(numbers) => self.table(*numbers, &item),
            }
        }
        let mut text = self.text.to_owned();
        self.renewed.sort_by_key(|(at, _)| at.start);
        for (at, now) in self.renewed.iter().rev() {
            text.replace_range(at.clone(), now);
        }
        (self.faults, text)
    }

    /// Writes the files of the page, which a reader has saved before the first command.
    fn files(&self, all: &[Item]) {
        let mut name = None;
        for item in all {
            match &item.what {
                What::Mark(m) => name = m.strip_prefix("file: ").or(name),
                What::Block(_, body) => {
                    if let Some(name) = name.take() {
                        std::fs::write(self.folder.path().join(name), body).expect("writable");
                    }
                }
                _ => {}
            }
        }
    }

    fn fault(&mut self, at: usize, what: &str) {
        self.faults.push(format!("{}:{}: {what}", self.name, line(self.text, at)));
    }

    /// Whether commands are run here.
    fn runs(&self) -> bool {
        self.nightly || !self.late
    }

    fn mark(&mut self, words: &str, item: &Item) {
        let at = item.at.start;
        let (word, rest) = words.split_once(": ").unwrap_or((words, ""));
        match (word, rest) {
            ("file", name) if !name.is_empty() => self.pending.file = true,
            ("exit", code) => match code.parse() {
                Ok(code) => self.pending.exit = code,
                Err(_) => self.fault(at, "exit: a number"),
            },
            ("output" | "errors", "") => self.pending.recorded = Some(word == "output"),
            ("not run", reason) if !reason.is_empty() => self.pending.left_out = true,
            ("nightly", minutes) if !minutes.is_empty() => self.late = true,
            ("made by", by) => {
                self.made_by = Some(self.level);
                by.split(" && ").filter_map(named::missing).for_each(|what| self.fault(at, &what));
            }
            ("run", command) => self.command(command, at),
            ("edit", _) => {
                if let Err(what) = self.edit(rest).map_err(|e| format!("edit: {rest}: {e}"))
                    && self.runs()
                {
                    self.fault(at, &what);
                }
            }
            _ if words.starts_with("= ") => self.figure(words, at),
            _ => self.fault(at, &format!("no such mark: {words}")),
        }
    }

    /// `FILE: OLD => NEW`, `\n` in both for a new line.
    fn edit(&self, rest: &str) -> Result<(), String> {
        let (file, words) = rest.split_once(": ").ok_or("FILE: OLD => NEW")?;
        let (old, new) = words.split_once(" => ").ok_or("FILE: OLD => NEW")?;
        let (old, new) = (old.replace("\\n", "\n"), new.replace("\\n", "\n"));
        let path = self.folder.path().join(file);
        let text = std::fs::read_to_string(&path).map_err(|e| e.to_string())?;
        if !text.contains(&old) {
            return Err(format!("{old:?} does not occur"));
        }
        std::fs::write(&path, text.replacen(&old, &new, 1)).map_err(|e| e.to_string())
    }

    fn block(&mut self, language: &str, body: &str, item: &Item) {
        let pending = std::mem::take(&mut self.pending);
        let at = item.at.start;
        if pending.file {
            return;
        }
        if let Some(out) = pending.recorded {
            self.recorded(item.at.clone(), out);
            return;
        }
        let all = commands(language, body);
        for command in &all {
            let place = self.text[at..item.at.end].find(command.split("  ").next().unwrap_or("")).map_or(at, |i| at + i);
            let own = command.strip_prefix("cargo run --bin windfall -- ").map(|rest| format!("windfall {rest}"));
            let command = own.as_deref().unwrap_or(command);
            let is_ours = command.starts_with("windfall ");
            if pending.left_out {
                let gone = if is_ours { named::unknown(command) } else { named::missing(command) };
                gone.into_iter().for_each(|what| self.fault(place, &what));
            } else if is_ours {
                self.pending.exit = pending.exit;
                self.command(command, place);
            } else if command.contains("cargo test") || command.contains("cargo bench") || command.starts_with("scripts/") {
                named::missing(command).into_iter().for_each(|what| self.fault(place, &what));
            } else {
                self.fault(place, &format!("{command}: is no command of windfall; mark it <!-- not run: REASON -->"));
            }
        }
        if all.len() == 1 && body.starts_with("$ ") && !pending.left_out {
            let first = body.split_inclusive('\n').next().map_or(0, str::len);
            self.recorded(at + first..item.at.end, true);
        }
    }

    fn code(&mut self, code: &str, item: &Item) {
        let at = item.at.start;
        if !code.starts_with("windfall ") {
            named::missing(code).into_iter().for_each(|what| self.fault(at, &what));
        } else if is_mention(code) || self.pending.left_out {
            named::unknown(code).into_iter().for_each(|what| self.fault(at, &what));
            if !is_mention(code) {
                self.pending = Pending::default();
            }
        } else {
            self.command(code, at);
        }
    }

    fn table(&mut self, numbers: usize, item: &Item) {
        let marked = self.text[item.at.clone()].contains("<!-- = ");
        if numbers > 1 && !marked && self.made_by.is_none() && !self.pending.left_out {
            let what = "a table of figures: mark them <!-- = FILE#PLACE -->, or say <!-- made by: WHAT --> above it";
            self.fault(item.at.start, what);
        }
    }

    /// Runs a command, unless it is the night's or was run already.
    fn command(&mut self, command: &str, at: usize) {
        let exit = std::mem::take(&mut self.pending).exit;
        if !self.runs() {
            named::unknown(command).into_iter().for_each(|what| self.fault(at, &what));
            return;
        }
        if let Some(before) = self.ran.get(command) {
            self.last = Some(before.clone());
            return;
        }
        let ran = self.memory.or_run(command, self.folder.path());
        if ran.code != exit {
            let (code, err) = (ran.code, ran.err.trim());
            self.fault(at, &format!("{command}: exit code {code}, expected {exit}: {err}"));
        }
        self.ran.insert(command.to_owned(), ran.clone());
        self.last = Some(ran);
    }

    /// Holds a recorded output against what the last command printed.
    fn recorded(&mut self, at: Range<usize>, out: bool) {
        if !self.runs() {
            return;
        }
        let Some(ran) = self.last.clone() else {
            self.fault(at.start, "output of no command");
            return;
        };
        let (text, now) = (self.text, if out { &ran.out } else { &ran.err });
        let (expected, got) = (tokens(&text[at.clone()]), tokens(now));
        let Some(all) = pairs(&expected, &got) else {
            let what = format!("{}: expected\n{}\ngot\n{now}", ran.command, &text[at.clone()]);
            self.fault(at.start, &what);
            self.renewed.push((at, now.clone()));
            return;
        };
        for (e, g) in all {
            let place = at.start + e.at.start..at.start + e.at.end;
            if !agrees(&e.token, &g.token) {
                let (was, is) = (&text[place.clone()], &now[g.at.clone()]);
                self.fault(place.start, &format!("{was} is printed, {} gives {is}", ran.command));
            }
            if matches!(e.token, Token::Number { .. }) && text[place.clone()] != now[g.at.clone()] {
                self.renewed.push((place, now[g.at.clone()].to_owned()));
            }
        }
    }

    /// Holds the number before a mark against a result.
    fn figure(&mut self, words: &str, at: usize) {
        if !self.runs() {
            return;
        }
        let before = &self.text[..at];
        let from = before.rfind(['\n', '|', '>']).map_or(0, |i| i + 1);
        let number = tokens(&before[from..]).into_iter().rev().find(|p| matches!(p.token, Token::Number { .. }));
        let Some((place, Token::Number { value, last })) = number.map(|p| (from + p.at.start..from + p.at.end, p.token)) else {
            self.fault(at, &format!("{words}: no number before it"));
            return;
        };
        match figure::value(self.folder.path(), &words[2..]) {
            Err(what) => self.fault(at, &format!("{words}: {what}")),
            Ok(now) => {
                let was = &self.text[place.clone()];
                // Of a figure in words a whole number is a rounded one.
                if (now - value).abs() > if last > 0.0 { last * (1.0 + 1e-9) } else { 1.0 } {
                    self.fault(at, &format!("{was} is printed, {} gives {now}", &words[2..]));
                    self.renewed.push((place, written_like(was, now)));
                }
            }
        }
    }
}

impl Memory {
    /// What a command left in a folder; a bundled scenario's is run once, and its files are copied.
    fn or_run(&self, command: &str, folder: &Path) -> Ran {
        let words = arguments(command);
        let out = words.iter().position(|w| w == "--out").and_then(|i| words.get(i + 1)).cloned();
        let own = |w: &String| w.contains(['/', '.']) || folder.join(w).exists();
        let is_bundled = words.len() > 2 && !words[2..].iter().filter(|w| Some(*w) != out.as_ref()).any(own);
        if !is_bundled || out.as_ref().is_some_and(|o| folder.join(o).exists()) {
            return run(command, &words, folder);
        }
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (ran, made) = known.entry(command.to_owned()).or_insert_with(|| {
            let own = tempfile::tempdir().expect("a temporary folder");
            (run(command, &words, own.path()), Some(own))
        });
        if let (Some(made), Some(out)) = (made, out) {
            copy(&made.path().join(&out), &folder.join(&out));
        }
        ran.clone()
    }
}

fn run(command: &str, words: &[String], folder: &Path) -> Ran {
    let words: Vec<String> = words[1..].iter().flat_map(|w| matching(w, folder)).collect();
    let ran = Command::new(PROGRAM).args(&words).current_dir(folder).stdin(Stdio::null()).output().expect("the program starts");
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    Ran { command: command.to_owned(), code: ran.status.code().unwrap_or(-1), out: said(&ran.stdout), err: said(&ran.stderr) }
}

/// What a shell makes of a word: of `lab/*.csv` the files of that kind, in order; any other word as it stands.
fn matching(word: &str, folder: &Path) -> Vec<String> {
    let Some((before, end)) = word.split_once('*') else { return vec![word.to_owned()] };
    let (inside, start) = before.rsplit_once('/').unwrap_or((".", before));
    let entries = std::fs::read_dir(folder.join(inside)).into_iter().flatten().flatten();
    let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
    let mut all: Vec<String> =
        names.filter(|n| n.starts_with(start) && n.ends_with(end)).map(|n| format!("{inside}/{n}")).collect();
    all.sort();
    if all.is_empty() { vec![word.to_owned()] } else { all }
}

/// Words of a command, those in quotes as one.
fn arguments(command: &str) -> Vec<String> {
    let (mut all, mut quote) = (vec![String::new()], None);
    for c in command.chars() {
        match (c, quote) {
            (c, Some(q)) if c == q => quote = None,
            ('"' | '\'', None) => quote = Some(c),
            (' ', None) => all.push(String::new()),
            (c, _) => all.last_mut().expect("one word at least").push(c),
        }
    }
    all.retain(|w| !w.is_empty());
    all
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("writable");
    for entry in std::fs::read_dir(from).into_iter().flatten().flatten() {
        let to = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &to);
        } else {
            std::fs::copy(entry.path(), to).expect("writable");
        }
    }
}
