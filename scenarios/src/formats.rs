//! scenarios: the kinds of run files. In: a path. Out: named columns of numbers, or the fault that says what the file is instead.

mod arrow;
mod cell;
mod csv_text;
mod encoding;
mod flatbuffer;
mod hdf5;
mod mat5;
mod motion_capture;
mod parquet;
mod variables;

use crate::columns::{Columns, fault};
use crate::error::ReadError;
use std::path::Path;

/// A kind of run file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    Parquet,
    Arrow,
    /// v5 or v7.3, as its first bytes say.
    Mat,
    Hdf5,
}

/// Endings and what they stand for.
const ENDINGS: [(&str, Format); 11] = [
    ("csv", Format::Csv),
    ("csv.gz", Format::Csv),
    ("tsv", Format::Csv),
    ("txt", Format::Csv),
    ("parquet", Format::Parquet),
    ("arrow", Format::Arrow),
    ("feather", Format::Arrow),
    ("ipc", Format::Arrow),
    ("mat", Format::Mat),
    ("h5", Format::Hdf5),
    ("hdf5", Format::Hdf5),
];

/// Why the bytes of a file could not be read, in words that a fault ends with.
type Reason = String;

/// The endings of run files, for messages.
pub(crate) fn endings() -> String {
    ENDINGS.iter().map(|(e, _)| format!(".{e}")).collect::<Vec<_>>().join(", ")
}

fn split(path: &Path) -> Option<(String, Format)> {
    let name = path.file_name()?.to_str()?;
    let lower = name.to_ascii_lowercase();
    let (ending, format) = ENDINGS.iter().find(|(e, _)| lower.strip_suffix(e).is_some_and(|head| head.ends_with('.')))?;
    Some((name.get(..name.len() - ending.len() - 1)?.to_owned(), *format))
}

/// Whether a file is a run by its ending.
pub(crate) fn is_run(path: &Path) -> bool {
    split(path).is_some()
}

/// The file's name without the ending of its kind; `run` for `run.csv.gz`.
pub(crate) fn stem(path: &Path) -> Option<String> {
    split(path).map(|(stem, _)| stem).or_else(|| path.file_stem().map(|s| s.to_string_lossy().into_owned()))
}

/// Columns of a table's text, that of a CSV file at `path`.
pub(crate) fn columns_of_text(path: &Path, text: &str) -> Result<Columns, ReadError> {
    csv_text::read(path, text.as_bytes().to_vec())
}

/// Reads a run file by its ending.
pub(crate) fn read_columns(path: &Path) -> Result<Columns, ReadError> {
    let one =
        |value: &str, what: &str, remedy: &str| Err(ReadError::Faults(vec![fault(path, None, "file", value, what, remedy)]));
    let Some((_, format)) = split(path) else {
        let ending = path.extension().map_or_else(String::new, |e| format!(".{}", e.to_string_lossy()));
        let what = format!("is not a kind of run file that this version reads; read: {}", endings());
        return one(&ending, &what, "export the table as CSV with the same column names");
    };
    let bytes = bytes_of(path)?;
    if bytes.is_empty() {
        return one("0 bytes", "is empty", "export the run again; the disk may have been full");
    }
    if let Some((is, remedy)) = mistaken(format, &bytes) {
        return one("", &format!("is {is}, whatever its name says"), remedy);
    }
    match format {
        Format::Csv => csv_text::read(path, bytes),
        Format::Parquet => parquet::read(path, bytes),
        Format::Arrow => arrow::read(&bytes).map_or_else(
            |reason| {
                let what = format!("cannot be read as Arrow IPC (Feather version 2): {reason}");
                one("", &what, "numbers in flat columns, without compression or with lz4 or zstd; or export as Parquet or CSV")
            },
            |table| Ok(table.columns()),
        ),
        Format::Mat if hdf5::is_hdf5(&bytes) => hdf5_columns(path, bytes, "MATLAB v7.3"),
        Format::Mat => variables::columns(path, mat5::read(&bytes), "MATLAB v5", MAT_REMEDY),
        Format::Hdf5 => hdf5_columns(path, bytes, "HDF5"),
    }
}

const MAT_REMEDY: &str = "save('run.mat', '-struct', 'run') in MATLAB with one vector a column, or writetable to CSV";

fn hdf5_columns(path: &Path, bytes: Vec<u8>, kind: &str) -> Result<Columns, ReadError> {
    let remedy = if kind == "HDF5" { "one data set of numbers a column, all in one group" } else { MAT_REMEDY };
    variables::columns(path, guarded(|| hdf5::read(bytes)), kind, remedy)
}

/// What a decoder made of damaged bytes: those of Parquet and HDF5 answer some damage with a panic, which ends here as a reason.
pub(crate) fn guarded<T>(decode: impl FnOnce() -> Result<T, Reason>) -> Result<T, Reason> {
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(decode));
    caught.unwrap_or_else(|_| Err("its bytes contradict each other; the file is damaged".to_owned()))
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    crate::open::regular(path)?;
    std::fs::read(path).map_err(|reason| {
        let (path, folder) = (path.to_owned(), path.is_dir());
        if folder { ReadError::Folder { path } } else { ReadError::Open { path, reason } }
    })
}

/// What a file is by its first bytes when that is not what its ending says, and what to do.
fn mistaken(format: Format, bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    const RENAME: &str = "give it the ending of what it is";
    let starts = |magic: &[u8]| bytes.starts_with(magic);
    let found = if starts(b"PAR1") {
        ("Parquet", RENAME, &[Format::Parquet][..])
    } else if starts(b"ARROW1") {
        ("Arrow IPC (Feather version 2)", RENAME, &[Format::Arrow][..])
    } else if starts(b"FEA1") {
        ("Feather version 1", "write it again as version 2, or as Parquet or CSV", &[][..])
    } else if starts(b"MATLAB 5.0 MAT-file") {
        ("MATLAB v5", RENAME, &[Format::Mat][..])
    } else if hdf5::is_hdf5(bytes) {
        ("HDF5 (or MATLAB v7.3)", RENAME, &[Format::Mat, Format::Hdf5][..])
    } else if starts(b"PK\x03\x04") {
        ("a ZIP archive or an Excel workbook", "unpack it, or export the sheet as CSV", &[][..])
    } else if starts(b"\xD0\xCF\x11\xE0") {
        ("an old Excel workbook", "export the sheet as CSV", &[][..])
    } else if starts(b"\x1F\x8B") {
        ("packed with gzip", "unpack it: only CSV is read packed", &[Format::Csv][..])
    } else {
        return None;
    };
    (!found.2.contains(&format)).then_some((found.0, found.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_endings_and_stems() {
        assert_eq!(stem(Path::new("a/run.CSV.gz")).as_deref(), Some("run"));
        assert_eq!(stem(Path::new("a/run.1.mat")).as_deref(), Some("run.1"));
        assert_eq!(stem(Path::new("a/run.xyz")).as_deref(), Some("run"));
        assert!(is_run(Path::new("x.Parquet")) && !is_run(Path::new("csv")) && !is_run(Path::new("x.toml")));
    }
}
