//! scenarios: files written whole or not at all. In: text or results. Out: a file under its final name.

use crate::error::WriteError;
use std::io::Write as _;
use std::path::Path;

/// Begin of the name of a file that is being written; it is locked as long as its process lives.
pub(crate) const TEMPORARY: &str = ".windfall-";

/// Writes text to a temporary file in the same folder and renames it.
///
/// # Errors
/// [`WriteError`] when the system refuses; the old file, if any, is then untouched.
pub fn text_atomically(path: &Path, text: &str) -> Result<(), WriteError> {
    bytes_atomically(path, text.as_bytes())
}

/// [`text_atomically`] for bytes.
///
/// # Errors
/// [`WriteError`] when the system refuses; the old file, if any, is then untouched.
pub fn bytes_atomically(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let fail = |reason: std::io::Error| WriteError::Write { path: path.to_owned(), reason };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(folder).map_err(fail)?;
    // Where a system knows no locks, what a kill leaves stays.
    let _ = file.as_file().try_lock();
    file.write_all(bytes).map_err(fail)?;
    make_readable(file.as_file()).map_err(fail)?;
    file.as_file().sync_all().map_err(fail)?;
    file.persist(path).map_err(|e| fail(e.error))?;
    Ok(())
}

/// Temporary files are private; results have the usual rights of a new file.
#[cfg(unix)]
fn make_readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}
#[cfg(not(unix))]
fn make_readable(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

/// Writes a result as indented JSON, whole or not at all.
///
/// # Errors
/// [`WriteError`] when the result is not representable or the system refuses.
pub fn write_json_atomically<T: serde::Serialize + ?Sized>(path: &Path, value: &T) -> Result<(), WriteError> {
    let text = json_text(value).map_err(|reason| WriteError::Json { path: path.to_owned(), reason })?;
    text_atomically(path, &text)
}

/// The text of a result: indented JSON with an end of line, the same in files, on standard output and in Python.
///
/// # Errors
/// A result that is not representable.
pub fn json_text<T: serde::Serialize + ?Sized>(value: &T) -> Result<String, serde_json::Error> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    Ok(text)
}

/// Long series as JSON on one line.
///
/// # Errors
/// A value that is no JSON.
pub fn series_text<T: serde::Serialize + ?Sized>(value: &T) -> Result<String, serde_json::Error> {
    serde_json::to_string(value).map(|text| text + "\n")
}
