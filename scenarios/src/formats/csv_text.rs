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
    let mut faults = Vec::new();
    let mut seen = HashSet::new();
    for name in names.iter().filter(|n| !seen.insert(n.as_str())).take(LISTED) {
        faults.push(fault(path, Some(header_line), "column", name, "appears twice", "remove or rename one"));
    }
    let mut rows = Rows {
        path,
        separator: layout.separator,
        data: vec![Vec::new(); names.len()],
        names,
        lines: Vec::new(),
        header: header_line,
        bad: 0,
        faults,
    };
    let mut units = None;
    while reader.read_record(&mut row).map_err(|e| broken(&e))? {
        if rows.lines.is_empty() && units.is_none() && rows.are_units(&row) {
            units = Some(row.iter().map(str::to_owned).collect::<Vec<_>>());
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
    lines: Vec<usize>,
    header: usize,
    bad: usize,
    faults: Vec<Fault>,
}

impl Rows<'_> {
    /// A row of words, as many as the header has, and not one number among them.
    fn are_units(&self, row: &csv::StringRecord) -> bool {
        let words = row.iter().filter(|c| !c.is_empty() && *c != "-").count();
        let numbers = row.iter().filter(|c| number(c, self.separator).is_some_and(f64::is_finite)).count();
        row.len() == self.names.len() && numbers == 0 && words > 1 && 2 * words >= row.len()
    }
    fn say(&mut self, line: usize, key: &str, value: &str, what: &str) {
        self.bad += 1;
        if self.faults.len() < LISTED {
            let remedy = "a number, or leave the cell empty where nothing was measured";
            self.faults.push(fault(self.path, Some(line), key, value, what, remedy));
        }
    }
    fn push(&mut self, row: &csv::StringRecord) {
        let line = line_of(row);
        if row.len() != self.names.len() {
            let what = format!("must have {} cells as the header has", self.names.len());
            self.say(line, "row", &format!("{} cells", row.len()), &what);
        }
        for i in 0..self.data.len() {
            let cell = row.get(i).unwrap_or("");
            let value = number(cell, self.separator).unwrap_or_else(|| {
                let name = self.names[i].clone();
                self.say(line, &name, cell, "is not a number");
                f64::NAN
            });
            self.data[i].push(value);
        }
        self.lines.push(line);
    }
    fn finish(mut self, units: Option<Vec<String>>) -> Result<Columns, ReadError> {
        if self.bad > LISTED {
            let what = format!("{} more cells or rows of this kind", self.bad - LISTED);
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
        let mut columns = Columns::new(self.names, self.data, self.lines);
        columns.header = Some(self.header);
        if self.separator != b',' {
            let word = if self.separator == b'\t' { "tabs" } else { "semicolons" };
            columns.notes.push(format!("columns are separated by {word}; a comma in a number is its decimal point"));
        }
        if let Some(units) = units {
            columns.notes.push(format!("row of units below the header: {}", crate::columns::some_of(&units)));
            columns.units = units;
        }
        Ok(columns)
    }
}
