//! scenarios: the folder of a study. In: rows in any order, from one process or several, killed or not. Out: `runs.parquet`, the same
//! bytes in the end.
//!
//! `study.json` says what the folder's draws are of. `parts/NNNNNN.rows` is the journal of a part under way, one checked line per
//! draw; a full part becomes `parts/NNNNNN-<hash of its bytes>.parquet` by one rename; all parts become `runs.parquet`.

use crate::file_set::{lock, sweep};
use crate::hash::fnv1a;
use crate::journal::Journal;
use crate::parquet_rows::{self, RowWriter};
use crate::store_error::StoreError;
use crate::write::write_json_atomically;
use parquet::errors::ParquetError;
use parquet::file::reader::SerializedFileReader;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::fs::{self, File};
use std::io::{BufReader, Read as _, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};
use windfall_model::study::{Cell, Column, Row};

/// Rows in each group of `runs.parquet`, rounded up to whole parts.
const GROUP_ROWS: usize = 4096;
const IDENTITY: &str = "study.json";
const RUNS: &str = "runs.parquet";
const PARTS: &str = "parts";

/// What a folder's draws are of: all that decides on their bits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program.
    pub windfall: String,
    /// Inputs with the hash of what they say; the study file first.
    pub inputs: Vec<(String, String)>,
    /// Number of draws ordered.
    pub draws: u64,
    /// Draws in a part.
    pub part_draws: u64,
    /// Names of the columns.
    pub columns: Vec<String>,
}

impl Identity {
    /// What differs, in words. Paths may differ, what the files say may not.
    fn differs(&self, other: &Self) -> Option<String> {
        if self.windfall != other.windfall {
            return Some(format!("version of the program ({})", other.windfall));
        }
        let mine = self.inputs.iter().zip(&other.inputs).position(|(a, b)| a.1 != b.1);
        match mine {
            Some(0) => Some("study file".to_owned()),
            Some(i) => Some(format!("input: {}", self.inputs[i].0)),
            None if self.inputs.len() != other.inputs.len() => Some("list of inputs".to_owned()),
            None if (self.draws, self.part_draws) != (other.draws, other.part_draws) => Some("number of draws".to_owned()),
            None if self.columns != other.columns => Some("list of columns".to_owned()),
            None => None,
        }
    }
}

/// How to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opening {
    /// In a folder without results.
    New,
    /// Where another run of the same study stopped.
    Resume,
    /// Over what is there.
    Force,
}

/// The share of a study that one process draws: every `of`-th part.
///
/// In words, and in files, `i/n` with i from 1 to n.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    /// From 0.
    pub index: u64,
    /// Number of shards.
    pub of: u64,
}

impl FromStr for Shard {
    type Err = &'static str;
    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let parts = word.split_once('/').and_then(|(i, n)| Some((i.parse::<u64>().ok()?, n.parse::<u64>().ok()?)));
        match parts {
            Some((i, of)) if i >= 1 && i <= of => Ok(Self { index: i - 1, of }),
            _ => Err("must be i/n with whole numbers and i from 1 to n, e.g. 1/8"),
        }
    }
}

impl TryFrom<String> for Shard {
    type Error = &'static str;
    fn try_from(word: String) -> Result<Self, Self::Error> {
        word.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.of)
    }
}

impl Shard {
    /// The whole study.
    pub const ALL: Self = Self { index: 0, of: 1 };
    /// Whether the part of this number is in this share.
    pub(crate) fn has(self, part: u64) -> bool {
        part % self.of == self.index
    }
}

/// A part that has become complete.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its index.
    pub index: u64,
    /// Its rows, sorted by draw.
    pub rows: Vec<Row>,
}

/// A part whose draws are all there, not yet written.
#[derive(Debug)]
pub struct FullPart {
    index: u64,
    journal: Journal,
}

/// Merged results, open for reading.
pub struct Merged {
    path: PathBuf,
    file: SerializedFileReader<File>,
    columns: Vec<Column>,
    draws: u64,
}

impl Merged {
    /// Number of draws.
    #[must_use]
    pub fn draws(&self) -> u64 {
        self.draws
    }
    /// Shows every cell of a column in order of the draws; what is in memory does not grow with their number.
    ///
    /// # Errors
    /// Results that are corrupt.
    pub fn each(&self, column: &Column, see: &mut dyn FnMut(Cell)) -> Result<(), StoreError> {
        let place = self.columns.iter().position(|c| c == column).map_or(0, |i| i + 1);
        parquet_rows::each_cell(&self.file, place, column.kind, see).map_err(|e| StoreError::corrupt(&self.path, e))
    }
}

/// A study's folder, open for one share.
#[derive(Debug)]
pub struct Store {
    folder: PathBuf,
    columns: Vec<Column>,
    identity: Identity,
    shard: Shard,
    journals: Mutex<BTreeMap<u64, Journal>>,
}

impl Store {
    /// Opens a folder, made if missing, for a share of a study. Parts and journals that are there are checked.
    ///
    /// # Errors
    /// Results that would be overwritten, of another study, or corrupt; another process at the same share.
    pub fn open(
        folder: &Path,
        identity: Identity,
        columns: &[Column],
        shard: Shard,
        opening: Opening,
    ) -> Result<Self, StoreError> {
        let parts = folder.join(PARTS);
        // Two processes that begin in one folder begin one after the other.
        if opening != Opening::Resume {
            fs::create_dir_all(folder).map_err(|e| StoreError::write(folder, e))?;
        }
        let _turn = lock(folder);
        no_links(folder)?;
        sweep(folder);
        if opening == Opening::Force {
            clear(folder)?;
        }
        let there = read_identity(folder)?;
        let store =
            Self { folder: folder.to_owned(), columns: columns.to_vec(), identity, shard, journals: Mutex::new(BTreeMap::new()) };
        match (&there, opening) {
            // Another shard may have begun in the same folder.
            (Some(_), Opening::New) if shard == Shard::ALL || store.has_own()? => {
                return Err(StoreError::Exists { folder: folder.to_owned() });
            }
            (None, Opening::Resume) => return Err(StoreError::Nothing { folder: folder.to_owned() }),
            (None, _) if folder.join(RUNS).exists() => return Err(StoreError::Exists { folder: folder.to_owned() }),
            _ => {}
        }
        if let Some(what) = there.as_ref().and_then(|t| store.identity.differs(t)) {
            return Err(StoreError::Changed { folder: folder.to_owned(), what });
        }
        if store.is_merged() {
            return Ok(store);
        }
        fs::create_dir_all(&parts).map_err(|e| StoreError::write(&parts, e))?;
        if there.is_none() {
            write_json_atomically(&folder.join(IDENTITY), &store.identity)?;
        }
        store.open_journals()?;
        Ok(store)
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> u64 {
        self.identity.draws.div_ceil(self.identity.part_draws)
    }
    /// Draws of a part.
    #[must_use]
    pub fn draws_of(&self, part: u64) -> Range<u64> {
        let first = part * self.identity.part_draws;
        first..(first + self.identity.part_draws).min(self.identity.draws)
    }
    /// The merged results.
    #[must_use]
    pub fn runs(&self) -> PathBuf {
        self.folder.join(RUNS)
    }
    /// Whether the merged results are there.
    #[must_use]
    pub fn is_merged(&self) -> bool {
        self.runs().is_file()
    }
    fn parts_folder(&self) -> PathBuf {
        self.folder.join(PARTS)
    }
    fn journal_path(&self, part: u64) -> PathBuf {
        self.parts_folder().join(format!("{part:06}.rows"))
    }

    /// Finished parts by index.
    fn finished(&self) -> Result<BTreeMap<u64, PathBuf>, StoreError> {
        let mut all = BTreeMap::new();
        for path in list(&self.parts_folder())? {
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
            let Some(index) = name.strip_suffix(".parquet").and_then(|n| n.split_once('-')?.0.parse::<u64>().ok()) else {
                continue;
            };
            if index >= self.parts() {
                return Err(StoreError::corrupt(&path, "is not a part of this study"));
            }
            if let Some(twin) = all.insert(index, path.clone()) {
                return Err(StoreError::corrupt(&path, format!("the same part stands in {}", twin.display())));
            }
        }
        Ok(all)
    }
    fn has_own(&self) -> Result<bool, StoreError> {
        if self.is_merged() {
            return Ok(true);
        }
        let own = |path: &PathBuf| {
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
            name.split(['-', '.']).next().and_then(|n| n.parse().ok()).is_some_and(|part| self.shard.has(part))
        };
        Ok(list(&self.parts_folder())?.iter().any(own))
    }
    fn open_journals(&self) -> Result<(), StoreError> {
        let finished = self.finished()?;
        for path in list(&self.parts_folder())? {
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
            let Some(part) = name.strip_suffix(".rows").and_then(|n| n.parse::<u64>().ok()) else { continue };
            if !self.shard.has(part) {
                continue;
            }
            if finished.contains_key(&part) {
                // Killed between making the part and removing its journal.
                fs::remove_file(&path).map_err(|e| StoreError::write(&path, e))?;
            } else if part < self.parts() {
                let journal = Journal::open(&path, &self.columns, &self.draws_of(part))?;
                self.journals.lock().unwrap_or_else(PoisonError::into_inner).insert(part, journal);
            }
        }
        Ok(())
    }

    /// Rows of the parts of this share that are complete but not yet made, of a process killed in between.
    ///
    /// # Errors
    /// A part that cannot be written.
    pub fn settle(&self) -> Result<(), StoreError> {
        let full = |(part, j): (&u64, &Journal)| {
            let draws = self.draws_of(*part);
            (j.rows.len() as u64 == draws.end - draws.start).then_some(*part)
        };
        let ready: Vec<u64> = self.lock().iter().filter_map(full).collect();
        for part in ready {
            let journal = self.lock().remove(&part);
            journal.map_or(Ok(()), |journal| self.make(FullPart { index: part, journal }).map(|_| ()))?;
        }
        Ok(())
    }
    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<u64, Journal>> {
        self.journals.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draws of this share that are still to be made, in order.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn wanted(&self) -> Result<Vec<Range<u64>>, StoreError> {
        if self.is_merged() {
            return Ok(Vec::new());
        }
        let finished = self.finished()?;
        let journals = self.lock();
        let mut all = Vec::new();
        for part in (0..self.parts()).filter(|p| self.shard.has(*p) && !finished.contains_key(p)) {
            match journals.get(&part) {
                None => all.push(self.draws_of(part)),
                Some(j) => all.extend(self.draws_of(part).filter(|d| !j.rows.contains_key(d)).map(|d| d..d + 1)),
            }
        }
        Ok(all)
    }

    /// Adds a draw; when that completes its part, the part, for [`Store::make`].
    ///
    /// # Errors
    /// A full disk and the like: what was there stays.
    pub fn push(&self, row: Row) -> Result<Option<FullPart>, StoreError> {
        let part = row.draw / self.identity.part_draws;
        let draws = self.draws_of(part);
        let mut journals = self.lock();
        if let std::collections::btree_map::Entry::Vacant(free) = journals.entry(part) {
            free.insert(Journal::open(&self.journal_path(part), &self.columns, &draws)?);
        }
        let Some(journal) = journals.get_mut(&part) else { return Ok(None) };
        journal.add(row)?;
        if (journal.rows.len() as u64) < draws.end - draws.start {
            return Ok(None);
        }
        Ok(journals.remove(&part).map(|journal| FullPart { index: part, journal }))
    }

    /// Writes a part whose draws are all there; waits until the disk has it.
    ///
    /// # Errors
    /// A full disk and the like: its journal stays.
    pub fn make(&self, FullPart { index, journal }: FullPart) -> Result<Part, StoreError> {
        let rows: Vec<Row> = journal.rows.values().cloned().collect();
        let bytes = part_bytes(&self.columns, &rows).map_err(|e| StoreError::corrupt(&journal.path, e))?;
        self.write_part(index, &bytes)?;
        fs::remove_file(&journal.path).map_err(|e| StoreError::write(&journal.path, e))?;
        Ok(Part { index, rows })
    }
    fn write_part(&self, index: u64, bytes: &[u8]) -> Result<(), StoreError> {
        let temporary = self.parts_folder().join(format!("{index:06}.tmp"));
        let path = self.parts_folder().join(format!("{index:06}-{:016x}.parquet", fnv1a(bytes)));
        let fail = |e| StoreError::write(&path, e);
        let mut file = fresh(&temporary).map_err(fail)?;
        file.write_all(bytes).and_then(|()| file.sync_all()).map_err(fail)?;
        fs::rename(&temporary, &path).map_err(fail)
    }
    /// Adds a whole part, as [`part_bytes`] made it elsewhere; one that is there already must be the same.
    ///
    /// # Errors
    /// Bytes that are not this part.
    pub fn put(&self, index: u64, bytes: Vec<u8>) -> Result<Part, StoreError> {
        let path = self.parts_folder().join(format!("{index:06}.parquet"));
        let rows = self.rows_of(index, &path, bytes.clone())?;
        if !self.finished()?.contains_key(&index) {
            self.write_part(index, &bytes)?;
        }
        Ok(Part { index, rows })
    }
    /// Rows of a part's bytes: each of its draws once.
    fn rows_of(&self, index: u64, path: &Path, bytes: Vec<u8>) -> Result<Vec<Row>, StoreError> {
        let rows = parquet_rows::decode(&self.columns, bytes).map_err(|e| StoreError::corrupt(path, e))?;
        if rows.iter().map(|r| r.draw).eq(self.draws_of(index)) {
            return Ok(rows);
        }
        Err(StoreError::corrupt(path, "its draws are not those of the part"))
    }
    /// A finished part, checked against the hash in its name.
    ///
    /// # Errors
    /// A part that is corrupt.
    fn read_part(&self, index: u64, path: &Path) -> Result<Vec<Row>, StoreError> {
        let bytes = fs::read(path).map_err(|reason| StoreError::Read { path: path.to_owned(), reason })?;
        let sum = format!("{:016x}", fnv1a(&bytes));
        let named = path.file_stem().and_then(|s| s.to_str()).and_then(|s| s.split_once('-')).map(|(_, sum)| sum);
        if named != Some(sum.as_str()) {
            return Err(StoreError::corrupt(path, "its bytes do not have the hash that its name says"));
        }
        self.rows_of(index, path, bytes)
    }

    /// Finished parts in the order of their index, from the first on without gap.
    ///
    /// # Errors
    /// A part that is corrupt.
    pub fn each_part(&self, mut see: impl FnMut(Part) -> bool) -> Result<(), StoreError> {
        for (expected, (index, path)) in (0..).zip(self.finished()?) {
            if index != expected || !see(Part { index, rows: self.read_part(index, &path)? }) {
                break;
            }
        }
        Ok(())
    }

    /// Makes `runs.parquet` of all parts, or of those up to the one after which `enough` says so; returns the number of draws.
    ///
    /// # Errors
    /// A part that is missing or corrupt; a full disk.
    pub fn merge(&self, mut enough: impl FnMut(&Part) -> bool) -> Result<u64, StoreError> {
        let _turn = lock(&self.folder);
        if self.is_merged() {
            return Ok(self.merged()?.draws());
        }
        let finished = self.finished()?;
        let path = self.runs();
        let partial = self.folder.join(format!("{RUNS}.partial"));
        let fail = |e: ParquetError| StoreError::write(&path, std::io::Error::other(e));
        let io = |e| StoreError::write(&path, e);
        let sink = fresh(&partial).map_err(io)?;
        let mut writer = RowWriter::new(sink, &self.columns).map_err(fail)?;
        let (mut group, mut draws): (Vec<Row>, u64) = (Vec::new(), 0);
        for index in 0..self.parts() {
            let Some(part_path) = finished.get(&index) else {
                // A file half made under a temporary name is of no use to anyone.
                let _ = fs::remove_file(&partial);
                return Err(self.incomplete(&finished));
            };
            let part = Part { index, rows: self.read_part(index, part_path)? };
            draws += part.rows.len() as u64;
            let last = enough(&part) || index + 1 == self.parts();
            group.extend(part.rows);
            if group.len() >= GROUP_ROWS || last {
                writer.group(&group).map_err(fail)?;
                group.clear();
            }
            if last {
                break;
            }
        }
        writer.finish().map_err(fail)?.sync_all().map_err(io)?;
        fs::rename(&partial, &path).map_err(io)?;
        Ok(draws)
    }
    fn incomplete(&self, finished: &BTreeMap<u64, PathBuf>) -> StoreError {
        let missing: Vec<u64> = (0..self.parts()).filter(|p| !finished.contains_key(p)).collect();
        let first = missing.first().copied().unwrap_or(0);
        StoreError::Incomplete { folder: self.folder.clone(), missing: missing.len(), parts: self.parts(), first }
    }
    /// Parts of the whole study that are not finished.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn missing(&self) -> Result<Vec<u64>, StoreError> {
        if self.is_merged() {
            return Ok(Vec::new());
        }
        let finished = self.finished()?;
        Ok((0..self.parts()).filter(|p| !finished.contains_key(p)).collect())
    }

    /// Removes the parts; call it when `summary.json` is written too.
    ///
    /// # Errors
    /// A folder that cannot be removed.
    pub fn clean(&self) -> Result<(), StoreError> {
        let parts = self.parts_folder();
        match fs::remove_dir_all(&parts) {
            // Another process that joined the same parts may have been first.
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(()),
            other => other.map_err(|e| StoreError::write(&parts, e)),
        }
    }

    /// The merged results, checked: each draw from 0 on, once.
    ///
    /// # Errors
    /// Results that are corrupt or of another study.
    pub fn merged(&self) -> Result<Merged, StoreError> {
        let path = self.runs();
        let file = self.reader()?;
        parquet_rows::same_columns(&file, &self.columns).map_err(|e| StoreError::corrupt(&path, e))?;
        let (mut draws, mut in_order) = (0, true);
        let mut see = |draw| {
            in_order &= draw == draws;
            draws += 1;
        };
        parquet_rows::each_draw(&file, &mut see).map_err(|e| StoreError::corrupt(&path, e))?;
        if !in_order {
            return Err(StoreError::corrupt(&path, "its draws are not 0, 1, 2, ..."));
        }
        Ok(Merged { path, file, columns: self.columns.clone(), draws })
    }
    fn reader(&self) -> Result<SerializedFileReader<File>, StoreError> {
        let path = self.runs();
        let file = File::open(&path).map_err(|reason| StoreError::Read { path: path.clone(), reason })?;
        parquet_rows::open(file).map_err(|e| StoreError::corrupt(&path, e))
    }
    /// FNV-1a hash of the merged results' bytes.
    ///
    /// # Errors
    /// Results that cannot be read.
    pub fn runs_hash(&self) -> Result<String, StoreError> {
        let path = self.runs();
        let fail = |reason| StoreError::Read { path: path.clone(), reason };
        let mut file = BufReader::with_capacity(1 << 16, File::open(&path).map_err(fail)?);
        let mut hash = crate::hash::FNV_BASIS;
        let mut block = vec![0; 1 << 16];
        loop {
            match file.read(&mut block).map_err(fail)? {
                0 => return Ok(format!("{hash:016x}")),
                n => hash = crate::hash::fnv1a_from(hash, &block[..n]),
            }
        }
    }
}

/// Bytes of a part that holds these rows; the same for the same rows.
///
/// # Errors
/// Rows that do not fit the columns.
pub fn part_bytes(columns: &[Column], rows: &[Row]) -> Result<Vec<u8>, StoreError> {
    parquet_rows::encode(columns, rows).map_err(|e| StoreError::corrupt(Path::new(PARTS), e))
}

/// Numbers of the draws, and each column with its cells.
pub type Runs = (Vec<u64>, Vec<(Column, Vec<Cell>)>);

/// All of a `runs.parquet`.
///
/// # Errors
/// A file that cannot be read or was not made by a study.
pub fn read_runs(path: &Path) -> Result<Runs, StoreError> {
    let file = File::open(path).map_err(|reason| StoreError::Read { path: path.to_owned(), reason })?;
    let read = || -> parquet::errors::Result<_> {
        let file = parquet_rows::open(file)?;
        let one = |(i, c): (usize, Column)| Ok((parquet_rows::column(&file, i + 1, c.kind)?, c));
        let columns: Vec<(Vec<Cell>, Column)> =
            parquet_rows::columns_of(&file)?.into_iter().enumerate().map(one).collect::<parquet::errors::Result<_>>()?;
        Ok((parquet_rows::draws(&file)?, columns.into_iter().map(|(cells, c)| (c, cells)).collect()))
    };
    read().map_err(|e| StoreError::corrupt(path, e))
}

fn read_identity(folder: &Path) -> Result<Option<Identity>, StoreError> {
    let path = folder.join(IDENTITY);
    match fs::read_to_string(&path) {
        Ok(text) => serde_json::from_str(&text).map(Some).map_err(|e| StoreError::corrupt(&path, e)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(reason) => Err(StoreError::Read { path, reason }),
    }
}

fn list(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let fail = |reason| StoreError::Read { path: folder.to_owned(), reason };
    let entries = match fs::read_dir(folder) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(fail)?,
    };
    entries.map(|e| e.map(|e| e.path()).map_err(fail)).collect()
}

/// Names below which a study writes must be its own: a link would lead it elsewhere.
fn no_links(folder: &Path) -> Result<(), StoreError> {
    let names = [IDENTITY, RUNS, PARTS].map(|n| folder.join(n));
    let journals = list(&folder.join(PARTS)).unwrap_or_default();
    match names.iter().chain(&journals).find(|p| p.is_symlink()) {
        Some(link) => Err(StoreError::Link { path: link.clone() }),
        None => Ok(()),
    }
}

/// A new file, whatever stood under its name.
fn fresh(path: &Path) -> std::io::Result<File> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(e),
        _ => File::create_new(path),
    }
}

/// Removes a study's files, and nothing else.
fn clear(folder: &Path) -> Result<(), StoreError> {
    for name in [RUNS, "summary.json", IDENTITY] {
        let path = folder.join(name);
        if path.is_file() {
            fs::remove_file(&path).map_err(|e| StoreError::write(&path, e))?;
        }
    }
    let parts = folder.join(PARTS);
    if parts.is_dir() { fs::remove_dir_all(&parts).map_err(|e| StoreError::write(&parts, e)) } else { Ok(()) }
}
