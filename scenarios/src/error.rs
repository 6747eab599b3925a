//! scenarios: what can be wrong with a file. In: place, key, value. Out: messages that say what is allowed and what to try.

use std::fmt;
use std::path::{Path, PathBuf};

/// One thing wrong in one file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fault {
    /// The file.
    pub file: PathBuf,
    /// Line, counted from 1; none when the fault is not on one line.
    pub line: Option<usize>,
    /// Table and key, or column.
    pub key: String,
    /// What stands there, as text.
    pub value: String,
    /// What is wrong with it and what would be allowed.
    pub allowed: String,
    /// What to try.
    pub remedy: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": ")?;
        match (self.key.is_empty(), self.value.is_empty()) {
            (true, _) => {}
            (false, true) => write!(f, "{}: ", self.key)?,
            (false, false) => write!(f, "{} = {}: ", self.key, self.value)?,
        }
        write!(f, "{}", self.allowed)?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; try: {}", self.remedy) }
    }
}

fn list(faults: &[Fault]) -> String {
    faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or is not UTF-8.
    #[error("{}: cannot be read ({reason}); try: check the path and its permissions", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// The system's words.
        reason: std::io::Error,
    },
    /// A folder where a file is meant.
    #[error("{}: is a folder; allowed: a file; try: a .toml file in it, such as {}", path.display(), path.join("campaign.toml").display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// A pipe, a device or a socket where a file is meant: reading it may never end.
    #[error("{}: is {what}; allowed: a regular file; try: write what it holds into a file first", path.display())]
    Special {
        /// Its path.
        path: PathBuf,
        /// What it is.
        what: &'static str,
    },
    /// Read, and wrong: all faults found.
    #[error("{}", list(.0))]
    Faults(Vec<Fault>),
}

impl ReadError {
    /// The faults; none when the file could not be opened.
    #[must_use]
    pub fn faults(&self) -> &[Fault] {
        match self {
            Self::Faults(all) => all,
            Self::Open { .. } | Self::Folder { .. } | Self::Special { .. } => &[],
        }
    }
}

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refused.
    #[error("{}: cannot be written ({reason}); try: another --out, or free space", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's words.
        reason: std::io::Error,
    },
    /// Results that would be overwritten.
    #[error("{}: {files} exists and is not overwritten; try: --out DIR or --force", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
        /// Those that are there.
        files: String,
    },
    /// The result holds a number that JSON cannot carry, or a key that is not text.
    #[error("{}: result is not representable as JSON ({reason}); try: report this with the input file", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// The serialiser's words.
        reason: serde_json::Error,
    },
    /// Columns of one table differ in length.
    #[error("{}: column {column} has {found} rows where {expected} are needed", path.display())]
    Length {
        /// The file.
        path: PathBuf,
        /// Column name.
        column: String,
        /// Rows it has.
        found: usize,
        /// Rows it needs.
        expected: usize,
    },
}

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
    crate::file_set::settle(folder).map_err(unmoved)?;
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

/// What a file of this program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A campaign.
    Campaign,
    /// A scenario.
    Scenario,
    /// A planet scenario.
    Planet,
    /// An aerodynamic structure.
    Structure,
    /// A run.
    Run,
    /// A study.
    Study,
}

/// What a file looks like, by its ending and by the tables that only one kind of TOML file has; TOML that fits none is taken for a
/// scenario, whose reader then says what is missing.
///
/// # Errors
/// [`ReadError`] when the file cannot be read or has another ending.
pub fn kind_of(path: &Path) -> Result<FileKind, ReadError> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => {}
        _ if crate::formats::is_run(path) => return Ok(FileKind::Run),
        _ => {
            let what = format!("is not a file of this program; read: .toml, {}", crate::formats::endings());
            return Err(ReadError::Faults(vec![crate::columns::fault(
                path,
                None,
                "",
                "",
                &what,
                "a path with one of these endings",
            )]));
        }
    }
    let text = text_of(path)?;
    let has = |head: &str| text.lines().any(|l| l.trim_start().starts_with(head));
    Ok(if has("[campaign]") || has("[[run]]") {
        FileKind::Campaign
    } else if has("[study]") {
        FileKind::Study
    } else if has("[[term]]") {
        FileKind::Structure
    } else if crate::planet::is_planet(&text) {
        FileKind::Planet
    } else {
        FileKind::Scenario
    })
}
