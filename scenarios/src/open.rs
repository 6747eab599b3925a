//! scenarios: what may be opened. In: a path. Out: its text, a result, or the fault that says what is there instead.

use crate::error::{Fault, ReadError, WriteError};
use crate::file_set::settle;
use std::path::Path;

/// Text of a file.
pub(crate) fn text_of(path: &Path) -> Result<String, ReadError> {
    regular(path)?;
    std::fs::read_to_string(path).map_err(|reason| ReadError::Open { path: path.to_owned(), reason })
}

/// Refuses what is there and no regular file, before it is opened: a pipe would be waited for, a device read without end. A set of files
/// that a killed process left complete is put in place first.
pub(crate) fn regular(path: &Path) -> Result<(), ReadError> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let unmoved = |e: WriteError| ReadError::Open { path: path.to_owned(), reason: std::io::Error::other(e) };
    settle(folder).map_err(unmoved)?;
    // What is not there, or may not be looked at, is said when it is opened.
    let Ok(found) = std::fs::metadata(path) else { return Ok(()) };
    let path = path.to_owned();
    if found.is_dir() {
        Err(ReadError::Folder { path })
    } else if found.is_file() {
        Ok(())
    } else {
        Err(ReadError::Special { path, what: special(found.file_type()) })
    }
}

#[cfg(unix)]
fn special(kind: std::fs::FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt as _;
    match kind {
        k if k.is_fifo() => "a pipe (FIFO)",
        k if k.is_socket() => "a socket",
        _ => "a device",
    }
}
#[cfg(not(unix))]
fn special(_: std::fs::FileType) -> &'static str {
    "no regular file"
}

/// Reads a result that this program wrote as JSON.
///
/// # Errors
/// [`ReadError`] when the file cannot be read or does not hold such a result; the fault names the line.
pub fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, ReadError> {
    let text = text_of(path)?;
    serde_json::from_str(&text).map_err(|e| {
        ReadError::Faults(vec![Fault {
            file: path.to_owned(),
            line: Some(e.line()),
            key: String::new(),
            value: String::new(),
            allowed: format!("is not the result that is needed here: {e}"),
            remedy: "the JSON file that the command before this one wrote, unchanged".to_owned(),
        }])
    })
}
