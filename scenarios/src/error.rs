//! scenarios: what can be wrong with a file. In: place, key, value. Out: messages that say what is allowed and what to try.

use std::collections::HashMap;
use std::fmt;
use std::path::PathBuf;

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

/// One sentence for each fault, and one for a fault that several files have.
fn list(faults: &[Fault]) -> String {
    let mut all: Vec<(&Fault, Vec<String>)> = Vec::new();
    let mut first_of: HashMap<String, usize> = HashMap::new();
    for f in faults {
        let place = *first_of.entry(f.kind()).or_insert(all.len());
        match all.get_mut(place) {
            Some((first, others)) if first.file != f.file => {
                let other = f.file.file_name().map_or_else(|| f.file.display().to_string(), |n| n.to_string_lossy().into_owned());
                let value = if f.value == first.value { String::new() } else { format!(" ({})", f.value) };
                others.push(format!("{other}{value}"));
            }
            _ => all.push((f, Vec::new())),
        }
    }
    let one = |(f, others): &(&Fault, Vec<String>)| {
        if others.is_empty() { f.to_string() } else { format!("{f}; the same in {}", others.join(", ")) }
    };
    all.iter().map(one).collect::<Vec<_>>().join("\n")
}

impl Fault {
    /// Its words without numbers: those of another file's fault that is the same.
    fn kind(&self) -> String {
        format!("{}\n{}\n{}", self.key, self.allowed, self.remedy).chars().filter(|c| !c.is_ascii_digit()).collect()
    }
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
