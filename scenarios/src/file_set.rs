//! scenarios: files that belong together, put in place together. In: a folder, files written to a stage. Out: all of them under their
//! names, or none.
//!
//! Files are written into a hidden folder beside their place. One rename makes that folder the whole set: from then on it counts as
//! written, and who comes next, this process or after a kill any later one that reads or writes there, moves its files to their names.
//! So a folder shows the complete old set or the complete new one, whenever a process ends.

use crate::error::WriteError;
use crate::write::TEMPORARY;
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Begin of the name of a stage, which nobody reads.
const STAGE: &str = ".windfall-stage-";
/// File in a stage that is locked as long as its process lives.
const HELD: &str = ".held";
/// Name of a set that is complete and not yet moved.
const WHOLE: &str = ".windfall-whole";

/// Files on their way into a folder.
#[derive(Debug)]
pub struct FileSet {
    folder: PathBuf,
    stage: tempfile::TempDir,
    /// Locked while this process lives, so that a stage left by a kill is known by being free. A file of its own: the stage itself may be
    /// locked as the folder of a set within this one.
    _alive: Option<File>,
}

impl FileSet {
    /// Makes a stage in a folder that exists; stages that killed processes left are removed.
    ///
    /// # Errors
    /// A folder in which nothing can be made.
    pub fn new(folder: &Path) -> Result<Self, WriteError> {
        let _turn = lock(folder);
        sweep(folder);
        let stage = tempfile::Builder::new().prefix(STAGE).tempdir_in(folder).map_err(|e| failed(folder, e))?;
        let alive = File::create_new(stage.path().join(HELD)).ok().filter(|f| f.try_lock().is_ok());
        Ok(Self { folder: folder.to_owned(), stage, _alive: alive })
    }
    /// Where the files are to be written under their own names.
    #[must_use]
    pub fn stage(&self) -> &Path {
        self.stage.path()
    }
    /// Puts all files in place. Without `overwrite` nothing is touched when one of them is there already, also one that another process
    /// wrote meanwhile.
    ///
    /// # Errors
    /// [`WriteError::Exists`]; a system that refuses, in which case the old files stand.
    pub fn commit(self, overwrite: bool) -> Result<(), WriteError> {
        let Self { folder, stage, _alive } = self;
        let _turn = lock(&folder);
        settle_now(&folder)?;
        fs::remove_file(stage.path().join(HELD)).map_err(|e| failed(stage.path(), e))?;
        let names = names(stage.path())?;
        let there: Vec<&PathBuf> = names.iter().filter(|n| folder.join(n).symlink_metadata().is_ok()).collect();
        let blocked = |n: &&&PathBuf| !overwrite || folder.join(n).is_dir();
        if there.iter().any(|n| blocked(&n)) {
            let files = there.iter().map(|n| n.display().to_string()).collect::<Vec<_>>().join(", ");
            return Err(WriteError::Exists { folder, files });
        }
        let whole = folder.join(WHOLE);
        fs::rename(stage.path(), &whole).map_err(|e| failed(&whole, e))?;
        // The stage has another name now; there is nothing left to remove.
        let _ = stage.keep();
        settle_now(&folder)
    }
}

/// Moves the files of a set that was complete when its process ended. Nothing to do in any other folder.
///
/// # Errors
/// A file that cannot be moved.
pub fn settle(folder: &Path) -> Result<(), WriteError> {
    if !is_whole(folder) {
        return Ok(());
    }
    let _turn = lock(folder);
    settle_now(folder)
}

/// A folder of its own, not a link to one elsewhere.
fn is_whole(folder: &Path) -> bool {
    folder.join(WHOLE).symlink_metadata().is_ok_and(|m| m.is_dir())
}

fn settle_now(folder: &Path) -> Result<(), WriteError> {
    if !is_whole(folder) {
        return Ok(());
    }
    let whole = folder.join(WHOLE);
    for name in names(&whole)? {
        match fs::rename(whole.join(&name), folder.join(&name)) {
            // Where the file system has no locks, another process may be at it.
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            other => other.map_err(|e| failed(&folder.join(&name), e))?,
        }
    }
    match fs::remove_dir(&whole) {
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(()),
        other => other.map_err(|e| failed(&whole, e)),
    }
}

/// Names in a folder, sorted.
fn names(folder: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let entries = fs::read_dir(folder).map_err(|e| failed(folder, e))?;
    let mut all: Vec<PathBuf> = entries.flatten().map(|e| PathBuf::from(e.file_name())).collect();
    all.sort();
    Ok(all)
}

/// Removes stages and files half written that nobody holds. Who makes one has the folder's lock until it is held.
pub(crate) fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let begins = |with: &str| name.to_str().is_some_and(|n| n.starts_with(with));
        let Some(kind) = path.symlink_metadata().ok().filter(|_| begins(TEMPORARY)) else { continue };
        // What cannot be removed is in nobody's way.
        if kind.is_dir() && begins(STAGE) && File::open(path.join(HELD)).map_or(true, |f| f.try_lock().is_ok()) {
            let _ = fs::remove_dir_all(&path);
        } else if kind.is_file() && File::open(&path).is_ok_and(|f| f.try_lock().is_ok()) {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Waits until no other process puts files into this folder; held as long as the file lives. Where a system knows no locks on folders
/// there is none.
pub(crate) fn lock(folder: &Path) -> Option<File> {
    File::open(folder).ok().filter(|f| f.lock().is_ok())
}

fn failed(path: &Path, reason: std::io::Error) -> WriteError {
    WriteError::Write { path: path.to_owned(), reason }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(folder: &Path, files: &[(&str, &str)], overwrite: bool) -> Result<(), WriteError> {
        let set = FileSet::new(folder)?;
        files.iter().try_for_each(|(n, t)| crate::text_atomically(&set.stage().join(n), t))?;
        set.commit(overwrite)
    }
    fn read(folder: &Path) -> Vec<(String, String)> {
        let name = |p: &PathBuf| p.display().to_string();
        let all = names(folder).expect("a folder");
        all.iter().map(|n| (name(n), fs::read_to_string(folder.join(n)).unwrap_or_default())).collect()
    }
    fn pairs(files: &[(&str, &str)]) -> Vec<(String, String)> {
        files.iter().map(|(n, t)| ((*n).to_owned(), (*t).to_owned())).collect()
    }

    #[test]
    fn law_sets_go_within_sets() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let outer = FileSet::new(dir.path()).expect("writable");
        put(outer.stage(), &[("a", "1")], true).expect("a set within a stage");
        outer.commit(false).expect("an empty folder");
        assert_eq!(read(dir.path()), pairs(&[("a", "1")]));
    }

    #[test]
    fn law_a_set_is_there_whole_or_not_at_all() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let (old, new) = ([("a", "1"), ("b", "1")], [("a", "2"), ("b", "2"), ("c", "2")]);
        put(dir.path(), &old, false).expect("an empty folder");
        assert!(matches!(put(dir.path(), &new, false), Err(WriteError::Exists { .. })));
        assert_eq!(read(dir.path()), pairs(&old), "refused: nothing is touched and nothing left");
        // Killed before the set was whole: the old one stands.
        let set = FileSet::new(dir.path()).expect("writable");
        crate::text_atomically(&set.stage().join("a"), "2").expect("writable");
        assert_eq!(fs::read_to_string(dir.path().join("a")).expect("there"), "1");
        drop(set);
        // Killed after: who comes next finishes it, wherever the other one was.
        let whole = dir.path().join(WHOLE);
        fs::create_dir(&whole).expect("writable");
        [("b", "2"), ("c", "2")].iter().for_each(|(n, t)| fs::write(whole.join(n), t).expect("writable"));
        fs::write(dir.path().join("a"), "2").expect("writable");
        settle(dir.path()).expect("its own folder");
        assert_eq!(read(dir.path()), pairs(&new));
        // A stage that a killed process left goes with the next set; one that is held stays.
        fs::create_dir(dir.path().join(".windfall-stage-old")).expect("writable");
        let [left, writing] =
            [".windfall-left", ".windfall-writing"].map(|n| File::create(dir.path().join(n)).expect("writable"));
        drop(left);
        writing.try_lock().expect("nobody else's");
        let held = FileSet::new(dir.path()).expect("writable");
        put(dir.path(), &old, true).expect("overwritten");
        let is_there = |n: &str| dir.path().join(n).exists();
        assert!(held.stage().is_dir() && !is_there(".windfall-stage-old"));
        assert!(
            is_there(".windfall-writing") && !is_there(".windfall-left"),
            "a file half written stays while its process lives"
        );
    }

    /// A link in the place of a result is replaced, not followed.
    #[cfg(unix)]
    #[test]
    fn law_links_are_not_followed() {
        let (dir, other) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
        let mine = other.path().join("mine");
        fs::write(&mine, "mine").expect("writable");
        std::os::unix::fs::symlink(&mine, dir.path().join("a")).expect("links");
        std::os::unix::fs::symlink(other.path(), dir.path().join(WHOLE)).expect("links");
        settle(dir.path()).expect("nothing to do");
        fs::remove_file(dir.path().join(WHOLE)).expect("a link");
        assert!(put(dir.path(), &[("a", "2")], false).is_err(), "a link counts as being there");
        put(dir.path(), &[("a", "2")], true).expect("replaced");
        assert_eq!((read(dir.path()), read(other.path())), (pairs(&[("a", "2")]), pairs(&[("mine", "mine")])));
    }
}
