//! scenarios: run files as text. In: bytes of a CSV or of one of its relatives. Out: columns with line numbers, or the faults by line.
//!
//! Separators are commas, semicolons or tabs, as the header has them; with the latter two a comma may be the decimal point. Lines that
//! start with `#` are comments; the last of them is the header where no other line is. A row of words below the header holds the units.

use super::cell::number;
use crate::columns::{Columns, fault};
use crate::error::{Fault, ReadError};
use std::collections::HashSet;
use std::path::Path;

/// Faults of single cells that are listed one by one.
const LISTED: usize = 20;

/// How the text is laid out.
struct Layout {
    separator: u8,
    /// Header that stands in a comment, and its line.
    header: Option<(Vec<String>, usize)>,
}

pub(super) fn read(path: &Path, bytes: Vec<u8>) -> Result<Columns, ReadError> {
    let (text, notes) = super::encoding::text(bytes)
        .map_err(|reason| ReadError::Faults(vec![fault(path, None, "file", "", &reason, "save it as CSV in UTF-8")]))?;
    let mut columns = super::motion_capture::read(path, &text).unwrap_or_else(|| parse(path, &text))?;
    columns.notes.splice(0..0, notes);
    Ok(columns)
}

impl Layout {
    fn of(text: &str) -> Self {
        let mut comment = None;
        for (i, line) in text.lines().enumerate() {
            if let Some(words) = line.strip_prefix('#') {
                comment = Some((words, i + 1));
            } else if !line.trim().is_empty() {
                let separator = separator(line);
                let cells = |l: &str| l.split(char::from(separator)).map(|c| c.trim().to_owned()).collect::<Vec<_>>();
                let numbers = cells(line).iter().all(|c| number(c, separator).is_some());
                let header = comment
                    .filter(|_| numbers)
                    .map(|(words, line)| (cells(words), line))
                    .filter(|(names, _)| names.len() == cells(line).len());
                return Self { separator, header };
            }
        }
        Self { separator: b',', header: None }
    }
}

/// The separator that a line has most of; commas when in doubt.
fn separator(line: &str) -> u8 {
    let count = |c: &u8| line.bytes().filter(|b| b == c).count();
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}

fn parse(path: &Path, text: &str) -> Result<Columns, ReadError> {
    let layout = Layout::of(text);
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .has_headers(false)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .delimiter(layout.separator)
        .from_reader(text.as_bytes());
    let broken =
        |e: &csv::Error| ReadError::Faults(vec![fault(path, None, "", "", &format!("is not CSV: {e}"), "UTF-8, header, commas")]);
    let mut row = csv::StringRecord::new();
    let (names, header_line) = match layout.header {
        Some(header) => header,
        None => {
            reader.read_record(&mut row).map_err(|e| broken(&e))?;
            (row.iter().map(str::to_owned).collect(), line_of(&row).max(1))
        }
    };
    let mut rows = Rows {
        path,
        separator: layout.separator,
        data: vec![Vec::new(); names.len()],
        cells: vec![Vec::new(); names.len()],
        names,
        lines: Vec::new(),
        header: header_line,
        faults: Vec::new(),
        bad_rows: 0,
        headers: 0,
    };
    let mut units = None;
    while reader.read_record(&mut row).map_err(|e| broken(&e))? {
        if rows.lines.is_empty() && units.is_none() && rows.are_units(&row) {
            units = Some(row.iter().map(str::to_owned).collect::<Vec<_>>());
        } else if row.iter().eq(rows.names.iter().map(String::as_str)) {
            rows.headers += 1;
        } else {
            rows.push(&row);
        }
    }
    rows.finish(units)
}

fn line_of(row: &csv::StringRecord) -> usize {
    row.position().map_or(0, |p| usize::try_from(p.line()).unwrap_or(usize::MAX))
}

/// Rows that were read, and what was wrong with them.
struct Rows<'p> {
    path: &'p Path,
    separator: u8,
    names: Vec<String>,
    data: Vec<Vec<f64>>,
    /// Cells of each column that are no numbers: line and text of the first ones, and a count of all.
    cells: Vec<Vec<(usize, String)>>,
    lines: Vec<usize>,
    header: usize,
    faults: Vec<Fault>,
    bad_rows: usize,
    /// Rows that repeat the header, as files that were joined have.
    headers: usize,
}

const REMEDY: &str = "a number, or leave the cell empty where nothing was measured";

impl Rows<'_> {
    /// A row of words, as many as the header has, and not one number among them.
    fn are_units(&self, row: &csv::StringRecord) -> bool {
        let words = row.iter().filter(|c| !c.is_empty() && *c != "-").count();
        let numbers = row.iter().filter(|c| number(c, self.separator).is_some_and(f64::is_finite)).count();
        row.len() == self.names.len() && numbers == 0 && words > 1 && 2 * words >= row.len()
    }
    fn push(&mut self, row: &csv::StringRecord) {
        let line = line_of(row);
        let blank_rest = row.iter().skip(self.names.len()).all(str::is_empty);
        if row.len() < self.names.len() || !blank_rest {
            let what = format!("must have {} cells as the header has", self.names.len());
            self.bad_rows += 1;
            if self.faults.len() < LISTED {
                self.faults.push(fault(self.path, Some(line), "row", &format!("{} cells", row.len()), &what, REMEDY));
            }
        }
        for i in 0..self.data.len() {
            let cell = row.get(i).unwrap_or("");
            let value = number(cell, self.separator).unwrap_or_else(|| {
                self.cells[i].push((line, cell.to_owned()));
                f64::NAN
            });
            self.data[i].push(value);
        }
        self.lines.push(line);
    }
    /// Faults of each column, for whoever reads it: names that stand twice, cells that are no numbers.
    fn wrong(&self) -> Vec<(String, Fault)> {
        let mut seen = HashSet::new();
        let twice = self.names.iter().filter(|n| !n.is_empty() && !seen.insert(n.as_str()));
        let mut all: Vec<(String, Fault)> = twice
            .map(|n| (n.clone(), fault(self.path, Some(self.header), "column", n, "appears twice", "remove or rename one")))
            .collect();
        for (name, cells) in self.names.iter().zip(&self.cells) {
            let one = |(line, cell): &(usize, String)| fault(self.path, Some(*line), name, cell, "is not a number", REMEDY);
            all.extend(cells.iter().take(LISTED).map(|c| (name.clone(), one(c))));
            if cells.len() > LISTED {
                let what = format!("{} more cells of this kind", cells.len() - LISTED);
                all.push((name.clone(), fault(self.path, None, name, "", &what, "correct the export")));
            }
        }
        all
    }
    /// Which columns have nothing that could be read: those without a name, those of words, the second one of a name.
    fn is_read(&self) -> Vec<bool> {
        let mut seen = HashSet::new();
        let words = |i: usize| !self.cells[i].is_empty() && !self.data[i].iter().any(|x| x.is_finite());
        (0..self.names.len()).map(|i| !self.names[i].is_empty() && seen.insert(self.names[i].as_str()) && !words(i)).collect()
    }
    fn finish(mut self, units: Option<Vec<String>>) -> Result<Columns, ReadError> {
        if self.bad_rows > LISTED {
            let what = format!("{} more rows of this kind", self.bad_rows - LISTED);
            self.faults.push(fault(self.path, None, "", "", &what, "correct the export"));
        }
        if self.faults.is_empty() && self.lines.is_empty() {
            self.faults.push(fault(self.path, None, "", "", "has a header and no rows", "one row per sample"));
        }
        let blanks = self.names.len() == 1 && self.names[0].split_whitespace().count() > 1;
        if blanks {
            let what = "the columns of the header are separated by blanks";
            self.faults
                .insert(0, fault(self.path, Some(self.header), "column", &self.names[0], what, "commas, semicolons or tabs"));
        }
        if !self.faults.is_empty() {
            return Err(ReadError::Faults(self.faults));
        }
        Ok(self.columns(units))
    }
    fn columns(self, units: Option<Vec<String>>) -> Columns {
        let (wrong, keep, headers) = (self.wrong(), self.is_read(), self.headers);
        let kept = |i: &usize| keep[*i];
        let numbers = |i: usize| self.data[i].iter().any(|x| x.is_finite());
        let unnamed =
            (0..keep.len()).filter(|i| self.names[*i].is_empty() && (numbers(*i) || !self.cells[*i].is_empty())).count();
        let words: Vec<String> = (0..keep.len())
            .filter(|i| !keep[*i] && !self.names[*i].is_empty() && !self.cells[*i].is_empty() && !numbers(*i))
            .map(|i| self.names[i].clone())
            .collect();
        let mixed: Vec<String> = (0..keep.len())
            .filter(|i| keep[*i] && !self.cells[*i].is_empty())
            .map(|i| format!("{} ({} cells)", self.names[i], self.cells[i].len()))
            .collect();
        let pick = |all: Vec<String>| all.into_iter().enumerate().filter(|(i, _)| kept(i)).map(|(_, n)| n).collect::<Vec<_>>();
        let data = self.data.into_iter().enumerate().filter(|(i, _)| kept(i)).map(|(_, c)| c).collect();
        let mut columns = Columns::new(pick(self.names), data, self.lines);
        columns.header = Some(self.header);
        if self.separator != b',' {
            let word = if self.separator == b'\t' { "tabs" } else { "semicolons" };
            columns.notes.push(format!("columns are separated by {word}; a comma in a number is its decimal point"));
        }
        if let Some(units) = units {
            let units = pick(units);
            columns.notes.push(format!("row of units below the header: {}", crate::columns::some_of(&units)));
            columns.units = units;
        }
        if headers > 0 {
            columns.notes.push(format!("rows that repeat the header skipped: {headers}"));
        }
        if unnamed > 0 {
            columns.notes.push(format!("columns without a name left out: {unnamed}"));
        }
        if !mixed.is_empty() {
            columns.notes.push(format!("columns with cells that are no numbers: {}", crate::columns::some_of(&mixed)));
        }
        columns.leave_out(&words);
        columns.are_wrong(wrong);
        columns
    }
}
