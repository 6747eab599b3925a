//! scenarios: named columns of numbers. In: what a run file holds. Out: the columns, and CSV.

use crate::error::{Fault, ReadError, WriteError};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;

/// Columns of a run file; a cell that is empty or not finite is NaN.
#[derive(Clone)]
pub(crate) struct Columns {
    names: Vec<String>,
    data: Vec<Vec<f64>>,
    /// Line of each row in the file.
    pub(crate) lines: Vec<usize>,
    /// Line of the names in the file; none where a file has no lines.
    pub(crate) header: Option<usize>,
    /// What the file itself says of its columns' units, in their order; empty when it does not.
    pub(crate) units: Vec<String>,
    /// What a reader of the file should know of how it was read.
    pub(crate) notes: Vec<String>,
    /// The motion-capture program whose export it is.
    pub(crate) program: Option<&'static str>,
    /// Columns of the file that hold no numbers.
    left_out: Vec<String>,
    /// What is wrong with a column, by its name: a fault of whoever reads it.
    wrong: Vec<(String, Fault)>,
}

/// Names that a message lists before it only counts.
const NAMED: usize = 40;

/// Names one after the other; of many only the first ones.
pub(crate) fn some_of<S: AsRef<str>>(names: &[S]) -> String {
    let first = names.iter().take(NAMED).map(AsRef::as_ref).collect::<Vec<_>>().join(", ");
    if names.len() > NAMED { format!("{first} and {} more", names.len() - NAMED) } else { first }
}

impl Columns {
    /// Columns of one length each; numbers that are not finite become NaN.
    pub(crate) fn new(names: Vec<String>, mut data: Vec<Vec<f64>>, lines: Vec<usize>) -> Self {
        data.iter_mut().flatten().filter(|x| !x.is_finite()).for_each(|x| *x = f64::NAN);
        let (program, left_out, wrong) = (None, Vec::new(), Vec::new());
        Self { names, data, lines, header: None, units: Vec::new(), notes: Vec::new(), program, left_out, wrong }
    }
    /// Says which columns of the file hold no numbers.
    pub(crate) fn leave_out(&mut self, names: &[String]) {
        if !names.is_empty() {
            self.notes.push(format!("columns that hold no plain numbers: {}", some_of(names)));
            self.left_out.extend_from_slice(names);
        }
    }
    pub(crate) fn left_out(&self) -> &[String] {
        &self.left_out
    }
    /// Keeps what is wrong with columns, for whoever reads them.
    pub(crate) fn are_wrong(&mut self, wrong: Vec<(String, Fault)>) {
        self.wrong = wrong;
    }
    /// The faults of the columns that are read.
    ///
    /// # Errors
    /// Cells that are no numbers, names that stand twice.
    pub(crate) fn complain(&self, is_read: impl Fn(&str) -> bool) -> Result<(), ReadError> {
        let faults: Vec<Fault> = self.wrong.iter().filter(|(n, _)| is_read(n)).map(|(_, f)| f.clone()).collect();
        if faults.is_empty() { Ok(()) } else { Err(ReadError::Faults(faults)) }
    }
    pub(crate) fn get(&self, name: &str) -> Option<&[f64]> {
        self.names.iter().position(|n| n == name).map(|i| self.data[i].as_slice())
    }
    /// Puts a column in the place of the one of its name, or beside the others.
    pub(crate) fn put(&mut self, name: &str, column: Vec<f64>) {
        match self.names.iter().position(|n| n == name) {
            Some(i) => self.data[i] = column,
            None => {
                self.names.push(name.to_owned());
                self.data.push(column);
            }
        }
    }
    /// Names with their numbers, in the file's order.
    pub(crate) fn all(&self) -> impl Iterator<Item = (&String, &Vec<f64>)> {
        self.names.iter().zip(&self.data)
    }
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }
    pub(crate) fn rows(&self) -> usize {
        self.lines.len()
    }
    /// Drops rows that are the row before in every column; how many.
    pub(crate) fn drop_copies(&mut self) -> usize {
        let alike = |i: usize| i > 0 && self.data.iter().all(|c| c[i].to_bits() == c[i - 1].to_bits());
        let keep: Vec<bool> = (0..self.rows()).map(|i| !alike(i)).collect();
        let copies = keep.iter().filter(|k| !**k).count();
        if copies > 0 {
            self.retain(&keep);
        }
        copies
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

/// A name as a cell of CSV (RFC 4180).
fn head(name: &str) -> Cow<'_, str> {
    let plain = !name.contains([',', '"', '\n', '\r']);
    if plain { name.into() } else { format!("\"{}\"", name.replace('"', "\"\"")).into() }
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
    let mut text = columns.iter().map(|(n, _)| head(n)).collect::<Vec<_>>().join(",");
    text.push('\n');
    for i in 0..rows {
        for (k, (_, column)) in columns.iter().enumerate() {
            let separator = if k == 0 { "" } else { "," };
            let _ = write!(text, "{separator}{}", Written(column[i]));
        }
        text.push('\n');
    }
    crate::write::text_atomically(path, &text)
}

struct Written(f64);
impl std::fmt::Display for Written {
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
