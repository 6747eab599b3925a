//! scenarios: what can go wrong with a study's folder. In: path, reason. Out: messages that say what to try.

use crate::error::WriteError;
use std::path::{Path, PathBuf};

/// What can go wrong with a study's folder. Nothing that was there is touched by any of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The folder has results.
    #[error("{}: holds results already; try: --resume to go on with them, --out for another folder, --force to begin anew", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// Nothing to go on with.
    #[error("{}: holds no study to resume, nor many campaigns; try: without --resume", folder.display())]
    Nothing {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder's draws are of something else.
    #[error("{}: these results were made with another {what}; try: the original, or another --out", folder.display())]
    Changed {
        /// The folder.
        folder: PathBuf,
        /// What differs.
        what: String,
    },
    /// A file is not what was written.
    #[error("{}: is corrupt ({what}); try: remove this file and --resume, which makes its part again", path.display())]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// How it shows.
        what: String,
    },
    /// Another process works on the same part.
    #[error("{}: another process works on this part; try: wait for it, or give each process its own --shard", path.display())]
    Busy {
        /// Its journal.
        path: PathBuf,
    },
    /// Parts are missing.
    #[error("{}: {missing} of {parts} parts are not there yet, the first is {first}; try: run the other shards, then --resume", folder.display())]
    Incomplete {
        /// The folder.
        folder: PathBuf,
        /// Parts missing.
        missing: usize,
        /// Parts needed.
        parts: u64,
        /// First of them.
        first: u64,
    },
    /// A link where a study keeps its files.
    #[error("{}: is a link; results are written into their own folder only; try: another --out, or remove the link", path.display())]
    Link {
        /// The link.
        path: PathBuf,
    },
    /// The system refused to write.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The system refused to read.
    #[error("{}: cannot be read ({reason}); try: check its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's words.
        reason: std::io::Error,
    },
}

impl StoreError {
    pub(crate) fn write(path: &Path, reason: std::io::Error) -> Self {
        Self::Write(WriteError::Write { path: path.to_owned(), reason })
    }
    pub(crate) fn corrupt(path: &Path, what: impl ToString) -> Self {
        Self::Corrupt { path: path.to_owned(), what: what.to_string() }
    }
}
