//! scenarios: run files as named columns of numbers. In: a path. Out: columns with line numbers, or the faults by line.

use crate::error::{Fault, ReadError, WriteError};
use std::fmt::Write as _;
use std::path::Path;

/// Faults of single cells that are listed one by one.
const LISTED: usize = 20;

/// Columns of a run file; a cell that is empty or not finite is NaN.
pub(crate) struct Columns {
    names: Vec<String>,
    data: Vec<Vec<f64>>,
    /// Line of each row in the file.
    pub(crate) lines: Vec<usize>,
}

impl Columns {
    pub(crate) fn new(names: Vec<String>, data: Vec<Vec<f64>>, lines: Vec<usize>) -> Self {
        Self { names, data, lines }
    }
    pub(crate) fn get(&self, name: &str) -> Option<&[f64]> {
        self.names.iter().position(|n| n == name).map(|i| self.data[i].as_slice())
    }
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }
    pub(crate) fn rows(&self) -> usize {
        self.lines.len()
    }
    /// Keeps the rows of which `keep` is true.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        let filter = |column: &mut Vec<f64>| {
            let mut i = 0;
            column.retain(|_| {
                i += 1;
                keep[i - 1]
            });
        };
        self.data.iter_mut().for_each(filter);
        let mut i = 0;
        self.lines.retain(|_| {
            i += 1;
            keep[i - 1]
        });
    }
}

/// A fault of a run file.
pub(crate) fn fault(path: &Path, line: Option<usize>, key: &str, value: &str, allowed: &str, remedy: &str) -> Fault {
    Fault {
        file: path.to_owned(),
        line,
        key: key.to_owned(),
        value: value.to_owned(),
        allowed: allowed.to_owned(),
        remedy: remedy.to_owned(),
    }
}

/// Reads a run file by its extension.
pub(crate) fn read_columns(path: &Path) -> Result<Columns, ReadError> {
    crate::error::regular(path)?;
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("csv") => parse(path, &crate::error::text_of(path)?),
        Some("parquet") => crate::parquet_columns::read(path),
        other => {
            let what = "is not a kind of run file that this version reads; read: .csv, .parquet";
            let value = other.map_or_else(String::new, |e| format!(".{e}"));
            Err(ReadError::Faults(vec![fault(
                path,
                None,
                "file",
                &value,
                what,
                "export the table as CSV with the same column names",
            )]))
        }
    }
}

fn parse(path: &Path, text: &str) -> Result<Columns, ReadError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let broken =
        |e: &csv::Error| ReadError::Faults(vec![fault(path, None, "", "", &format!("is not CSV: {e}"), "UTF-8, header, commas")]);
    let names: Vec<String> = reader.headers().map_err(|e| broken(&e))?.iter().map(str::to_owned).collect();
    let mut faults = Vec::new();
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            faults.push(fault(path, Some(1), "column", name, "appears twice", "remove or rename one"));
        }
    }
    let mut columns = Columns { data: vec![Vec::new(); names.len()], names, lines: Vec::new() };
    let mut bad = 0_usize;
    for row in reader.records() {
        let row = row.map_err(|e| broken(&e))?;
        let line = row.position().map_or(0, |p| usize::try_from(p.line()).unwrap_or(usize::MAX));
        bad += push_row(path, &mut columns, &row, line, &mut faults);
    }
    if bad > LISTED {
        faults.push(fault(
            path,
            None,
            "",
            "",
            &format!("{} more cells or rows of this kind", bad - LISTED),
            "correct the export",
        ));
    }
    if faults.is_empty() && columns.rows() == 0 {
        faults.push(fault(path, None, "", "", "has a header and no rows", "one row per sample"));
    }
    if faults.is_empty() { Ok(columns) } else { Err(ReadError::Faults(faults)) }
}

/// Adds one row; returns how many of its cells are wrong.
fn push_row(path: &Path, columns: &mut Columns, row: &csv::StringRecord, line: usize, faults: &mut Vec<Fault>) -> usize {
    let mut bad = 0;
    let mut say = |key: &str, value: &str, what: &str| {
        bad += 1;
        if faults.len() < LISTED {
            faults.push(fault(
                path,
                Some(line),
                key,
                value,
                what,
                "a number, or leave the cell empty where nothing was measured",
            ));
        }
    };
    if row.len() != columns.names.len() {
        say("row", &format!("{} cells", row.len()), &format!("must have {} cells as the header has", columns.names.len()));
    }
    for (i, column) in columns.data.iter_mut().enumerate() {
        let cell = row.get(i).unwrap_or("");
        let value = match cell.to_ascii_lowercase().as_str() {
            "" | "na" | "n/a" | "null" | "-" => f64::NAN,
            text => text.parse().unwrap_or_else(|_| {
                say(&columns.names[i], cell, "is not a number");
                f64::NAN
            }),
        };
        column.push(if value.is_finite() { value } else { f64::NAN });
    }
    columns.lines.push(line);
    bad
}

/// Writes columns of one length as CSV, each number with the digits that give it back exactly; a new file replaces an old one
/// whole or not at all.
///
/// # Errors
/// [`WriteError`] when columns differ in length or the file cannot be written.
pub fn write_columns_csv(path: &Path, columns: &[(&str, &[f64])]) -> Result<(), WriteError> {
    let rows = columns.first().map_or(0, |(_, c)| c.len());
    if let Some((name, c)) = columns.iter().find(|(_, c)| c.len() != rows) {
        return Err(WriteError::Length { path: path.to_owned(), column: (*name).to_owned(), found: c.len(), expected: rows });
    }
    let mut text = columns.iter().map(|(n, _)| *n).collect::<Vec<_>>().join(",");
    text.push('\n');
    for i in 0..rows {
        for (k, (_, column)) in columns.iter().enumerate() {
            let separator = if k == 0 { "" } else { "," };
            let _ = write!(text, "{separator}{}", Cell(column[i]));
        }
        text.push('\n');
    }
    crate::write::text_atomically(path, &text)
}

struct Cell(f64);
impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let size = self.0.abs();
        if !self.0.is_finite() {
            Ok(())
        } else if size != 0.0 && !(1e-5..1e16).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}
