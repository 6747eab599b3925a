//! cli: `windfall study`. In: a study file. Out: `runs.parquet` and `summary.json`; parts of them that survive a kill.

use crate::args::StudyArgs;
use crate::session::{Failure, Session};
use indicatif::ProgressBar;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use windfall_model::study::{Cell, Column, Kind, Row};
use windfall_pid::Identification;
use windfall_scenarios::{
    Identity, Opening, Part, ReadError, Shard, Store, StoreError, part_bytes, read_json, read_study, write_json_atomically,
};
use windfall_verify::VerifyError;
use windfall_verify::study::{Moments, Prepared, Progress, Summary, run as draw_all, summarise};

/// Name of the summary.
const SUMMARY: &str = "summary.json";

/// Why a study gave no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A file is wrong.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A run cannot be flown again, or a method does not exist.
    #[error(transparent)]
    Verify(#[from] VerifyError),
    /// The folder is in the way.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The stopping rule asks for what is not there.
    #[error("[stop] column = \"{column}\": is no column of numbers or flags of this study; columns: {columns}")]
    NoColumn {
        /// What was asked for.
        column: String,
        /// What there is.
        columns: String,
    },
    /// Somebody asked for an end.
    #[error("interrupted; draws that were finished are kept; try: --resume to go on")]
    Interrupted,
    /// Part of a number that the study does not have.
    #[error("part {part} is not one of the study's {parts}")]
    NoPart {
        /// What was asked for.
        part: u64,
        /// How many there are.
        parts: u64,
    },
}

/// A study ready to be drawn, in whole or in parts.
#[derive(Debug)]
pub struct Drawing {
    prepared: Prepared,
    identity: Identity,
}

/// `summary.json`.
#[derive(Serialize)]
struct Report<'a> {
    windfall: &'a str,
    inputs: &'a [(String, String)],
    runs: &'static str,
    runs_hash: String,
    #[serde(flatten)]
    summary: Summary,
}

impl Drawing {
    /// Reads a study file and makes it ready; with warnings of the runs it draws from.
    ///
    /// # Errors
    /// Every fault of the file and what it names.
    pub fn read(path: &Path) -> Result<(Self, Vec<String>), StudyError> {
        let file = read_study(path)?;
        let mut study = file.study;
        if let (Some(model), Some(campaign)) = (&file.model, &file.campaign) {
            let found: Identification = read_json(model)?;
            let set = found.combined().ok_or(VerifyError::NoDataSet)?;
            study.plant = set.plant(&campaign.plant).map_err(VerifyError::from)?;
        }
        let prepared = Prepared::new(study, file.campaign.as_ref())?;
        let identity = Identity {
            windfall: env!("CARGO_PKG_VERSION").to_owned(),
            inputs: file.inputs,
            draws: prepared.study().draws,
            part_draws: prepared.study().part_draws,
            columns: prepared.columns().iter().map(|c| c.name.clone()).collect(),
        };
        let drawing = Self { prepared, identity };
        drawing.progress()?;
        Ok((drawing, file.warnings))
    }
    /// The study made ready.
    #[must_use]
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }
    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> u64 {
        self.identity.draws.div_ceil(self.identity.part_draws)
    }
    /// Opens a folder for its results.
    ///
    /// # Errors
    /// Results that would be overwritten, of another study, or corrupt.
    pub fn open(&self, folder: &Path, shard: Shard, opening: Opening) -> Result<Store, StudyError> {
        Ok(Store::open(folder, self.identity.clone(), self.prepared.columns(), shard, opening)?)
    }
    /// Draws a part on the threads of the current pool; its bytes.
    ///
    /// # Errors
    /// A part that the study does not have.
    pub fn part(&self, part: u64) -> Result<Vec<u8>, StudyError> {
        if part >= self.parts() {
            return Err(StudyError::NoPart { part, parts: self.parts() });
        }
        let first = part * self.identity.part_draws;
        let rows: Mutex<BTreeMap<u64, Row>> = Mutex::default();
        let keep = |row: Row| {
            rows.lock().unwrap_or_else(std::sync::PoisonError::into_inner).insert(row.draw, row);
            Ok::<bool, StudyError>(true)
        };
        draw_all(&self.prepared, first..(first + self.identity.part_draws).min(self.identity.draws), keep)?;
        let rows: Vec<Row> = rows.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_values().collect();
        Ok(part_bytes(self.prepared.columns(), &rows)?)
    }
    /// The stopping rule before any part, when there is one.
    ///
    /// # Errors
    /// A rule that asks for a column that is not there.
    pub fn progress(&self) -> Result<Option<Progress>, StudyError> {
        let Some(stop) = self.prepared.study().stop.clone() else { return Ok(None) };
        let place = self.prepared.place(&stop.column);
        match place.map(|i| (i, self.prepared.columns()[i].kind)) {
            Some((i, kind @ (Kind::Number | Kind::Flag))) => Ok(Some(Progress::new(stop, i, kind))),
            _ => Err(StudyError::NoColumn { column: stop.column, columns: self.countable() }),
        }
    }
    fn countable(&self) -> String {
        let columns = self.prepared.columns().iter().filter(|c| c.kind != Kind::Word);
        columns.map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ")
    }
    /// Joins the parts of a folder into `runs.parquet` and writes `summary.json`, unless both are there; then checks them.
    ///
    /// # Errors
    /// Parts that are missing or corrupt, a full disk.
    pub fn finish(&self, store: &Store, folder: &Path) -> Result<Summary, StudyError> {
        if !store.is_merged() {
            let mut rule = self.progress()?;
            store.merge(|part: &Part| rule.as_mut().is_some_and(|r| r.add(&r.of_part(&part.rows), part.rows.len() as u64)))?;
        }
        let summary = self.summary(store)?;
        let runs_hash = store.runs_hash()?;
        let (path, was) = (folder.join(SUMMARY), store.runs());
        if path.is_file() {
            let written: serde_json::Value = read_json(&path)?;
            if written["runs_hash"] != runs_hash.as_str() {
                let what = "its bytes do not have the hash that summary.json says".to_owned();
                return Err(StoreError::Corrupt { path: was, what }.into());
            }
        } else {
            let inputs = &self.identity.inputs;
            let report =
                Report { windfall: &self.identity.windfall, inputs, runs: "runs.parquet", runs_hash, summary: summary.clone() };
            write_json_atomically(&path, &report).map_err(StoreError::from)?;
        }
        store.clean()?;
        Ok(summary)
    }
    fn summary(&self, store: &Store) -> Result<Summary, StoreError> {
        let merged = store.merged()?;
        summarise(&self.prepared, merged.draws(), |c: &Column, see: &mut dyn FnMut(Cell)| merged.each(c, see))
    }
    /// The stopping rule after the parts that a folder has.
    ///
    /// # Errors
    /// A part that is corrupt.
    pub fn rule(&self, store: &Store) -> Result<PartRule, StudyError> {
        let mut rule = PartRule { progress: self.progress()?, next: 0, waiting: BTreeMap::new(), enough: false };
        if rule.progress.is_some() && !store.is_merged() {
            store.each_part(|part| {
                rule.add(&part);
                !rule.enough
            })?;
        }
        Ok(rule)
    }
    /// Draws what a folder lacks of its share. `see` is told of each draw and says whether to go on; draws that were begun are kept.
    ///
    /// # Errors
    /// A full disk and the like; [`StudyError::Interrupted`] when `see` wants no more.
    pub fn draw(&self, store: &Store, see: impl Fn(&Row) -> bool + Sync) -> Result<(), StudyError> {
        store.settle()?;
        let rule = Mutex::new(self.rule(store)?);
        let over = |part: Option<Part>| {
            let mut rule = rule.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            if let Some(part) = part {
                rule.add(&part);
            }
            rule.enough
        };
        if over(None) {
            return Ok(());
        }
        let wanted = store.wanted()?.into_iter().flatten();
        draw_all(&self.prepared, wanted, |row| {
            let go_on = see(&row);
            let enough = over(store.push(row)?);
            if go_on || enough { Ok(!enough) } else { Err(StudyError::Interrupted) }
        })
    }
}

/// The stopping rule fed with parts in any order; it looks at them in the order of their index.
#[derive(Debug)]
pub struct PartRule {
    progress: Option<Progress>,
    next: u64,
    waiting: BTreeMap<u64, (Moments, u64)>,
    enough: bool,
}

impl PartRule {
    /// Whether the study may end.
    #[must_use]
    pub fn enough(&self) -> bool {
        self.enough
    }
    /// Takes a part into account.
    pub fn add(&mut self, part: &Part) {
        let Some(progress) = &mut self.progress else { return };
        self.waiting.insert(part.index, (progress.of_part(&part.rows), part.rows.len() as u64));
        while let Some((moments, draws)) = self.waiting.remove(&self.next) {
            self.next += 1;
            self.enough |= progress.add(&moments, draws);
        }
    }
}

pub(crate) fn run(args: &StudyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let (drawing, warnings) = Drawing::read(&args.study).map_err(of_study)?;
    warnings.iter().for_each(|w| session.warn(w));
    let temporary;
    let folder = match &session.common.out {
        Some(folder) => folder.clone(),
        None if session.common.json && !args.resume => {
            temporary = tempfile::tempdir()?;
            temporary.path().to_owned()
        }
        None => PathBuf::from("."),
    };
    let shard = args.shard.unwrap_or(Shard::ALL);
    let opening = match (args.resume, session.common.force) {
        (true, _) => Opening::Resume,
        (_, true) => Opening::Force,
        _ => Opening::New,
    };
    let store = drawing.open(&folder, shard, opening).map_err(of_study)?;
    crate::interrupt::listen();
    let live = Live::new(&drawing, &store, session)?;
    let drawn = session.pool()?.install(|| {
        drawing.draw(&store, |row| {
            live.see(row);
            !crate::interrupt::asked()
        })
    });
    live.bar.finish_and_clear();
    drawn.map_err(of_study)?;
    if shard != Shard::ALL {
        let missing = store.missing().map_err(StudyError::from).map_err(of_study)?.len();
        session.say(&format!(
            "shard {}/{} done; {missing} of {} parts missing in {}{}",
            shard.index + 1,
            shard.of,
            store.parts(),
            folder.display(),
            if missing == 0 { "; join them with --resume" } else { "" }
        ));
        return Ok(true);
    }
    let summary = drawing.finish(&store, &folder).map_err(of_study)?;
    if summary.failures.any.count > 0 {
        session.warn(&failures(&summary));
    }
    if session.common.json {
        session.print_json(&summary)?
    } else {
        session.print(&table(&summary))?
    }
    if session.common.out.is_some() || !session.common.json {
        session.say(&format!("written to {}: runs.parquet, {SUMMARY}", folder.display()));
    }
    if summary.failures.any.count == summary.draws {
        return Err(Failure::Numerical(anyhow::anyhow!("every draw failed; see failures in {SUMMARY}")));
    }
    Ok(true)
}

fn of_study(error: StudyError) -> Failure {
    match error {
        StudyError::Verify(e) => Failure::of_verification(e),
        StudyError::Interrupted => Failure::Interrupted(error.into()),
        other => Failure::Input(other.into()),
    }
}

/// What a terminal shows while draws are made: how many, time left, the asked-for quantity so far.
struct Live {
    bar: ProgressBar,
    asked: Option<(String, usize, Kind)>,
    seen: Mutex<Moments>,
}

impl Live {
    fn new(drawing: &Drawing, store: &Store, session: &Session<'_>) -> Result<Self, Failure> {
        let wanted: u64 = store.wanted()?.iter().map(|r| r.end - r.start).sum();
        let columns = drawing.prepared().columns();
        let stop = drawing.prepared().study().stop.as_ref().map(|s| s.column.as_str());
        let first = columns.iter().find(|c| c.name.ends_with(".error")).map(|c| c.name.as_str());
        let asked = stop.or(first).and_then(|name| {
            let place = drawing.prepared().place(name)?;
            Some((name.to_owned(), place, columns[place].kind))
        });
        let bar = session.bar("drawing", usize::try_from(wanted).unwrap_or(usize::MAX));
        if let Ok(style) = indicatif::ProgressStyle::with_template("{prefix} {bar:30} {pos}/{len}, {eta} left  {msg}") {
            bar.set_style(style);
        }
        Ok(Self { bar, asked, seen: Mutex::default() })
    }
    fn see(&self, row: &Row) {
        self.bar.inc(1);
        let Some((name, place, kind)) = self.asked.as_ref().filter(|_| !self.bar.is_hidden()) else { return };
        let Some(x) = row.cells[*place].number() else { return };
        let mut seen = self.seen.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        seen.push(x);
        if let Some([a, b]) = seen.ci95(*kind).filter(|_| seen.n.is_multiple_of(16)) {
            self.bar.set_message(format!("{name} {:.4e} ± {:.1e}", seen.mean, 0.5 * (b - a)));
        }
    }
}

fn failures(s: &Summary) -> String {
    let most = s.failures.messages.first().map_or("", |m| m.message.as_str());
    format!("{} of {} draws failed, most often: {most}; see failures in {SUMMARY}", s.failures.any.count, s.draws)
}

/// The result on a screenful.
fn table(s: &Summary) -> String {
    let early = if s.stopped_early { format!(", ended early of {}", s.draws_ordered) } else { String::new() };
    let mut text = format!("{}: {} draws{early}, seed {}\n", s.study, s.draws, s.seed);
    if !s.parameters.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<16}{:<24}{:>11}{:>11}{:>11}{:>9}{:>24}",
            "method", "parameter", "bias", "scatter", "stated", "ratio", "coverage (95 % CI)"
        );
    }
    for p in &s.parameters {
        let number = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.3e}"));
        let name = format!("{} {}", p.coefficient, p.name);
        let ratio = p.scatter_over_std_error.map_or_else(|| "-".to_owned(), |x| format!("{x:.3}"));
        let (bias, scatter, stated) = (number(Some(p.bias)), number(p.scatter), number(p.mean_std_error));
        let coverage = rate(p.coverage.rate, p.coverage.ci95);
        let _ = writeln!(text, "{:<16}{name:<24}{bias:>11}{scatter:>11}{stated:>11}{ratio:>9}{coverage:>24}", p.method);
    }
    let verdicts: Vec<_> = s.rates.iter().filter(|r| r.name.starts_with("close.") && r.name.matches('.').count() == 1).collect();
    if !verdicts.is_empty() {
        text.push('\n');
    }
    for r in verdicts {
        let _ = writeln!(text, "{:<28}{:>8} of {:<8}{:>24}", r.name, r.count, r.of, rate(r.rate, r.ci95));
    }
    text
}

fn rate(rate: Option<f64>, ci95: Option<[f64; 2]>) -> String {
    match (rate, ci95) {
        (Some(r), Some([a, b])) => format!("{r:.3} [{a:.3}, {b:.3}]"),
        _ => "-".to_owned(),
    }
}
