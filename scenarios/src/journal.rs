//! scenarios: draws of a part under way. In: rows as they come. Out: one checked line each, so that a killed process loses only the
//! draws it was at.

use crate::hash::fnv1a;
use crate::store_error::StoreError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use windfall_model::study::{Cell, CellKind, Column, Row};

/// A row with its numbers as bits, which text gives back exactly.
#[derive(Serialize, Deserialize)]
struct Stored {
    d: u64,
    c: Vec<StoredCell>,
}

#[derive(Serialize, Deserialize)]
enum StoredCell {
    N(Option<u64>),
    F(Option<bool>),
    W(String),
}

fn line_of(row: &Row) -> String {
    let cell = |c: &Cell| match c {
        Cell::Number(x) => StoredCell::N(x.map(f64::to_bits)),
        Cell::Flag(x) => StoredCell::F(*x),
        Cell::Word(w) => StoredCell::W(w.clone()),
    };
    let stored = Stored { d: row.draw, c: row.cells.iter().map(cell).collect() };
    let text = serde_json::to_string(&stored).expect("whole numbers, flags and text are always JSON");
    format!("{:016x} {text}\n", fnv1a(text.as_bytes()))
}

fn row_of(line: &str, columns: &[Column]) -> Option<Row> {
    let (sum, text) = line.split_once(' ')?;
    if u64::from_str_radix(sum, 16).ok()? != fnv1a(text.as_bytes()) {
        return None;
    }
    let stored: Stored = serde_json::from_str(text).ok()?;
    let cell = |(c, column): (StoredCell, &Column)| match (c, column.kind) {
        (StoredCell::N(x), CellKind::Number) => Some(Cell::Number(x.map(f64::from_bits))),
        (StoredCell::F(x), CellKind::Flag) => Some(Cell::Flag(x)),
        (StoredCell::W(w), CellKind::Word) => Some(Cell::Word(w)),
        _ => None,
    };
    let cells: Vec<Cell> = stored.c.into_iter().zip(columns).map(cell).collect::<Option<_>>()?;
    (cells.len() == columns.len()).then_some(Row { draw: stored.d, cells })
}

/// The open journal of a part; no other process can open it.
#[derive(Debug)]
pub(crate) struct Journal {
    pub(crate) path: PathBuf,
    file: File,
    pub(crate) rows: BTreeMap<u64, Row>,
}

impl Journal {
    /// Opens or makes the journal; a last line without its end, of a process that was killed, is cut off.
    pub(crate) fn open(path: &Path, columns: &[Column], draws: &std::ops::Range<u64>) -> Result<Self, StoreError> {
        let fail = |reason| StoreError::write(path, reason);
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(fail)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(StoreError::Busy { path: path.to_owned() }),
            // A file system without locks: nothing guards against a second process then.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let length = file.metadata().map_err(fail)?.len();
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(0)).map_err(fail)?;
        (&file).take(length).read_to_end(&mut bytes).map_err(fail)?;
        let whole = bytes.iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
        let mut rows = BTreeMap::new();
        for (i, line) in bytes[..whole].split_inclusive(|b| *b == b'\n').enumerate() {
            let row = std::str::from_utf8(line).ok().and_then(|l| row_of(l.trim_end_matches('\n'), columns));
            let row = row.filter(|r| draws.contains(&r.draw) && !rows.contains_key(&r.draw));
            let Some(row) = row else {
                return Err(StoreError::Corrupt {
                    path: path.to_owned(),
                    what: format!("line {} fails its checksum, is of another part or counts a draw twice", i + 1),
                });
            };
            rows.insert(row.draw, row);
        }
        // Only of a journal that is otherwise whole: what is refused stays as it was.
        if whole < bytes.len() {
            file.set_len(whole as u64).map_err(fail)?;
        }
        Ok(Self { path: path.to_owned(), file, rows })
    }
    /// Adds a row: on disk first.
    pub(crate) fn add(&mut self, row: Row) -> Result<(), StoreError> {
        self.file.write_all(line_of(&row).as_bytes()).map_err(|reason| StoreError::write(&self.path, reason))?;
        self.rows.insert(row.draw, row);
        Ok(())
    }
}
