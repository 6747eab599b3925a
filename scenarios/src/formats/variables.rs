//! scenarios: named arrays of MATLAB and HDF5 files as columns. In: variables and structs of them. Out: the one set that is a run.

use super::Reason;
use crate::columns::{Columns, fault};
use crate::error::ReadError;
use std::path::Path;

/// Fewest rows of a variable that may be a column of a run.
const FEWEST: usize = 8;
/// Most columns that a matrix is split into.
const WIDEST: usize = 64;

/// How one number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stored {
    Int { bytes: usize, signed: bool },
    Float { bytes: usize },
}

impl Stored {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Int { bytes, .. } | Self::Float { bytes } => bytes,
        }
    }
    /// All numbers of `bytes`; a rest that is no whole number is left out. `None` for a width that numbers do not have.
    pub(super) fn decode(self, bytes: &[u8], big_endian: bool) -> Option<Vec<f64>> {
        fn all<const N: usize>(bytes: &[u8], big_endian: bool, number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
            let turned = |mut b: [u8; N]| {
                if big_endian {
                    b.reverse();
                }
                number(b)
            };
            bytes.as_chunks::<N>().0.iter().map(|b| turned(*b)).collect()
        }
        #[expect(clippy::cast_precision_loss, reason = "no sample needs more than 53 bits")]
        Some(match self {
            Self::Float { bytes: 8 } => all(bytes, big_endian, f64::from_le_bytes),
            Self::Float { bytes: 4 } => all(bytes, big_endian, |b| f64::from(f32::from_le_bytes(b))),
            Self::Int { bytes: 1, signed: true } => all(bytes, big_endian, |b| f64::from(i8::from_le_bytes(b))),
            Self::Int { bytes: 1, signed: false } => all(bytes, big_endian, |b| f64::from(u8::from_le_bytes(b))),
            Self::Int { bytes: 2, signed: true } => all(bytes, big_endian, |b| f64::from(i16::from_le_bytes(b))),
            Self::Int { bytes: 2, signed: false } => all(bytes, big_endian, |b| f64::from(u16::from_le_bytes(b))),
            Self::Int { bytes: 4, signed: true } => all(bytes, big_endian, |b| f64::from(i32::from_le_bytes(b))),
            Self::Int { bytes: 4, signed: false } => all(bytes, big_endian, |b| f64::from(u32::from_le_bytes(b))),
            Self::Int { bytes: 8, signed: true } => all(bytes, big_endian, |b| i64::from_le_bytes(b) as f64),
            Self::Int { bytes: 8, signed: false } => all(bytes, big_endian, |b| u64::from_le_bytes(b) as f64),
            _ => return None,
        })
    }
}

/// One variable.
pub(super) struct FileVariable {
    pub(super) name: String,
    pub(super) content: Content,
}

/// What a variable holds.
pub(super) enum Content {
    /// Column after column, `rows` in each.
    Numbers { rows: usize, values: Vec<f64> },
    /// Fields of a struct, members of a group.
    Fields(Vec<FileVariable>),
    /// Anything else, in words.
    Other(String),
}

impl Content {
    /// Numbers of an array of any shape, in column order; a vector lies along its only long side.
    pub(super) fn array(shape: &[usize], values: Vec<f64>) -> Self {
        let long: Vec<usize> = shape.iter().copied().filter(|n| *n != 1).collect();
        match long[..] {
            [] | [_] => Self::Numbers { rows: values.len(), values },
            [rows, _] => Self::Numbers { rows, values },
            _ => Self::Other(format!("numbers in {} dimensions", long.len())),
        }
    }
    fn words(&self) -> String {
        match self {
            Self::Numbers { rows: 0, .. } => "empty".to_owned(),
            Self::Numbers { rows, values } => format!("{rows} x {}", values.len() / rows),
            Self::Fields(all) => format!("struct of {}", all.iter().map(|v| v.name.as_str()).collect::<Vec<_>>().join(", ")),
            Self::Other(what) => what.clone(),
        }
    }
}

/// Variables that stand side by side, and where.
struct Set<'v> {
    place: String,
    all: &'v [FileVariable],
    /// The number of rows that most of its columns have.
    rows: usize,
}

/// The columns of the file: its variables, or the fields of its one struct that has vectors.
pub(super) fn columns(
    path: &Path,
    read: Result<Vec<FileVariable>, Reason>,
    kind: &str,
    remedy: &str,
) -> Result<Columns, ReadError> {
    let one = |value: &str, what: String| ReadError::Faults(vec![fault(path, None, "file", value, &what, remedy)]);
    let all = read.map_err(|reason| one("", format!("cannot be read as {kind}: {reason}")))?;
    let mut sets = Vec::new();
    sets_of("", &all, &mut sets);
    let set = match &sets[..] {
        [set] => set,
        [] => {
            let held: Vec<String> = all.iter().take(40).map(|v| format!("{} ({})", v.name, v.content.words())).collect();
            return Err(one("", format!("holds no vectors of {FEWEST} numbers or more; it holds {}", held.join(", "))));
        }
        many => {
            let places: Vec<&str> =
                many.iter().map(|s| if s.place.is_empty() { "top level" } else { s.place.as_str() }).collect();
            return Err(one(&places.join(", "), "each hold vectors: which is the run?".to_owned()));
        }
    };
    let (mut names, mut data, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for v in set.all {
        match &v.content {
            Content::Numbers { rows, values } if *rows == set.rows && values.len() <= WIDEST * rows => {
                let wide = values.len() > *rows;
                for (k, column) in values.chunks_exact(*rows).enumerate() {
                    names.push(if wide { format!("{}(:,{})", v.name, k + 1) } else { v.name.clone() });
                    data.push(column.iter().map(|x| if x.is_finite() { *x } else { f64::NAN }).collect());
                }
            }
            other => left.push(format!("{} ({})", v.name, other.words())),
        }
    }
    let mut columns = Columns::new(names, data, (1..=set.rows).collect());
    if !left.is_empty() {
        columns.notes.push(format!("variables that are no columns of {} rows: {}", set.rows, left.join(", ")));
    }
    Ok(columns)
}

fn sets_of<'v>(place: &str, all: &'v [FileVariable], sets: &mut Vec<Set<'v>>) {
    let mut lengths: Vec<usize> = all
        .iter()
        .filter_map(|v| match &v.content {
            Content::Numbers { rows, .. } if *rows >= FEWEST => Some(*rows),
            _ => None,
        })
        .collect();
    lengths.sort_unstable();
    let often = |rows: usize| lengths.iter().filter(|r| **r == rows).count();
    if let Some(rows) = lengths.chunk_by(|a, b| a == b).map(|c| c[0]).max_by_key(|r| (often(*r), *r)) {
        sets.push(Set { place: place.to_owned(), all, rows });
    }
    for v in all {
        if let Content::Fields(fields) = &v.content {
            let inner = if place.is_empty() { v.name.clone() } else { format!("{place}.{}", v.name) };
            sets_of(&inner, fields, sets);
        }
    }
}
