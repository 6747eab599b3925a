//! windfall: studies, drawn in whole or in parts. In: a study file. Out: bytes of parts, a folder's `runs.parquet` and `summary.json`.

use crate::{Error, Result, Study, read_identification};
use serde::Serialize;
use std::collections::BTreeMap;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread;
use windfall_model::study::{Cell, CellKind, Column, Row};
use windfall_replay::ReplayError;
use windfall_scenarios::{
    FileKind, FullPart, Identity, Part, Shard, Store, StoreError, must_be, part_bytes, read_json, read_study,
    write_json_atomically,
};
use windfall_study::{Moments, PreparedStudy, Progress, Summary, run as draw_all, summarise};

/// Name of the summary.
pub const SUMMARY: &str = "summary.json";
/// Full parts that wait for the disk before draws do.
const PARTS_WAITING: usize = 4;

/// A study ready to be drawn, in whole or in parts.
///
/// ```no_run
/// use windfall::{Drawing, Study};
/// let study = Drawing::read("study.toml".as_ref())?;
/// let summary = study.run("drawn".as_ref(), &Study::default())?;
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Debug)]
pub struct Drawing {
    prepared: PreparedStudy,
    identity: Identity,
    warnings: Vec<String>,
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
    /// Reads a study file and makes it ready.
    ///
    /// # Errors
    /// Every fault of the file and what it names.
    pub fn read(path: &Path) -> Result<Self> {
        must_be(path, FileKind::Study)?;
        let file = read_study(path)?;
        let mut study = file.study;
        if let (Some(model), Some(campaign)) = (&file.model, &file.campaign) {
            let found = read_identification(model)?;
            let set = found.combined().ok_or(ReplayError::NoDataSet)?;
            study.plant = set.plant_in(campaign).map_err(ReplayError::from)?;
        }
        let prepared = PreparedStudy::new(study, file.campaign.as_ref())?;
        let identity = Identity {
            windfall: env!("CARGO_PKG_VERSION").to_owned(),
            inputs: file.inputs,
            draws: prepared.study().draws,
            part_draws: prepared.study().part_draws,
            columns: prepared.columns().iter().map(|c| c.name.clone()).collect(),
        };
        let drawing = Self { prepared, identity, warnings: file.warnings };
        drawing.progress()?;
        Ok(drawing)
    }
    /// What reading the runs that it draws from had to say.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
    /// The study made ready.
    #[must_use]
    pub fn prepared(&self) -> &PreparedStudy {
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
    /// Results that would be overwritten, of another study, or corrupt; a request that contradicts itself.
    pub fn open(&self, folder: &Path, request: &Study) -> Result<Store> {
        let (opening, shard) = request.order()?;
        Ok(Store::open(folder, self.identity.clone(), self.prepared.columns(), shard, opening)?)
    }
    /// Draws what a folder lacks, and joins it unless only a share was asked for.
    ///
    /// # Errors
    /// As [`Drawing::open`], [`Drawing::draw`] and [`Drawing::finish`].
    pub fn run(&self, folder: &Path, request: &Study) -> Result<Option<Summary>> {
        let store = self.open(folder, request)?;
        self.draw(&store, |_| true)?;
        if request.shard.is_some_and(|s| s != Shard::ALL) { Ok(None) } else { self.finish(&store, folder).map(Some) }
    }
    /// Draws a part on the threads of the current pool; its bytes.
    ///
    /// # Errors
    /// A part that the study does not have.
    pub fn part(&self, part: u64) -> Result<Vec<u8>> {
        if part >= self.parts() {
            return Err(Error::NoPart { part, parts: self.parts() });
        }
        let first = part * self.identity.part_draws;
        let rows: Mutex<BTreeMap<u64, Row>> = Mutex::default();
        let keep = |row: Row| {
            rows.lock().unwrap_or_else(std::sync::PoisonError::into_inner).insert(row.draw, row);
            Ok::<bool, Error>(true)
        };
        let draws = first..(first + self.identity.part_draws).min(self.identity.draws);
        draw_all(&self.prepared, Vec::from([draws]), keep)?;
        let rows: Vec<Row> = rows.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_values().collect();
        Ok(part_bytes(self.prepared.columns(), &rows)?)
    }
    /// The stopping rule before any part, when there is one.
    ///
    /// # Errors
    /// A rule that asks for a column that is not there.
    pub fn progress(&self) -> Result<Option<Progress>> {
        let Some(stop) = self.prepared.study().stop.clone() else { return Ok(None) };
        let place = self.prepared.place(&stop.column);
        match place.map(|i| (i, self.prepared.columns()[i].kind)) {
            Some((i, kind @ (CellKind::Number | CellKind::Flag))) => Ok(Some(Progress::new(stop, i, kind))),
            _ => Err(Error::NoColumn { column: stop.column, columns: self.countable() }),
        }
    }
    fn countable(&self) -> String {
        let columns = self.prepared.columns().iter().filter(|c| c.kind != CellKind::Word);
        columns.map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ")
    }
    /// Joins the parts of a folder into `runs.parquet` and writes `summary.json`, unless both are there; then checks them.
    ///
    /// # Errors
    /// Parts that are missing or corrupt, a full disk.
    pub fn finish(&self, store: &Store, folder: &Path) -> Result<Summary> {
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
    fn summary(&self, store: &Store) -> std::result::Result<Summary, StoreError> {
        let merged = store.merged()?;
        summarise(&self.prepared, merged.draws(), |c: &Column, see: &mut dyn FnMut(Cell)| merged.each(c, see))
    }
    /// The stopping rule after the parts that a folder has.
    ///
    /// # Errors
    /// A part that is corrupt.
    pub fn rule(&self, store: &Store) -> Result<PartRule> {
        let mut rule = PartRule { progress: self.progress()?, next: 0, waiting: BTreeMap::new(), enough: false };
        if rule.progress.is_some() && !store.is_merged() {
            store.each_part(|part| {
                rule.add(&part);
                !rule.enough
            })?;
        }
        Ok(rule)
    }
    /// Draws what a folder lacks of its share. `see` is called with each draw and says whether to go on; draws that were begun are kept.
    ///
    /// # Errors
    /// A full disk and the like; [`Error::Interrupted`] when `see` wants no more.
    pub fn draw(&self, store: &Store, see: impl Fn(&Row) -> bool + Sync) -> Result<()> {
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
        let wanted = store.wanted()?;
        let failed = AtomicBool::new(false);
        // Draws do not wait until the disk has a part: a thread of its own does.
        let (full, waiting) = sync_channel::<FullPart>(PARTS_WAITING);
        let make = || {
            let made = waiting.into_iter().try_for_each(|part| {
                over(Some(store.make(part)?));
                Ok::<_, StoreError>(())
            });
            failed.store(made.is_err(), Ordering::Relaxed);
            made
        };
        thread::scope(|scope| {
            let making = scope.spawn(make);
            let drawn = draw_all(&self.prepared, wanted, |row| {
                let go_on = see(&row);
                let lost = store.push(row)?.is_some_and(|part| full.send(part).is_err());
                let enough = lost || failed.load(Ordering::Relaxed) || over(None);
                if go_on || enough { Ok(!enough) } else { Err(Error::Interrupted) }
            });
            drop(full);
            match making.join() {
                Ok(made) => made.map_err(Error::from).and(drawn),
                Err(panic) => resume_unwind(panic),
            }
        })
    }
}

/// The stopping rule fed with parts in any order; it looks at them in the order of their index.
///
/// ```no_run
/// use windfall::{Drawing, Study};
/// let study = Drawing::read("study.toml".as_ref())?;
/// let store = study.open("drawn".as_ref(), &Study::default())?;
/// println!("over: {}", study.rule(&store)?.enough());
/// # Ok::<(), windfall::Error>(())
/// ```
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
