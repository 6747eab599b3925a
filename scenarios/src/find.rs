//! scenarios: campaigns in a folder. In: folders and campaign files. Out: every campaign below them under a name of its own.

use crate::limits;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the files that are looked for.
const FILE: &str = "campaign.toml";

/// Why a search gave no campaigns.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FindError {
    /// A path that was given is not there, or may not be read.
    #[error("{}: cannot be searched ({reason}); allowed: a folder, or a campaign file (.toml)", path.display())]
    Path {
        /// The path.
        path: PathBuf,
        /// The system's words.
        reason: std::io::Error,
    },
    /// No campaign.
    #[error(
        "{paths}: no {FILE} in it, nor in its subfolders down to {} below; links and hidden folders are not followed; try: the folder that \
             holds the campaigns' folders, or the campaign files themselves",
        limits::SEARCH_DEPTH
    )]
    None {
        /// What was searched.
        paths: String,
    },
    /// More than are done at a time.
    #[error("{}: more than {allowed} {what}; try: its subfolders one by one, each with an --out of its own", path.display())]
    TooMany {
        /// Where it was too much.
        path: PathBuf,
        /// Of what.
        what: &'static str,
        /// Most that there may be.
        allowed: usize,
    },
    /// Two campaigns whose results would have one name.
    #[error("{first} and {second}: results of both would be in results/{result}; try: rename one of them")]
    Twins {
        /// One campaign file.
        first: String,
        /// The other.
        second: String,
        /// Their name.
        result: String,
    },
}

/// A campaign that was found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FoundCampaign {
    /// Its file relative to the folder searched, with `/`.
    pub path: String,
    /// Where its file is.
    pub file: PathBuf,
    /// Name of its results: the path without `/campaign.toml`, or without `.toml`.
    pub result: String,
}

/// Campaigns in the order of their paths.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundCampaigns {
    /// Folder to which the paths are relative: the one searched, or the one that holds all that was given.
    pub root: PathBuf,
    /// The campaigns, at least one.
    pub campaigns: Vec<FoundCampaign>,
    /// What was not searched, and why.
    pub notes: Vec<String>,
}

impl FoundCampaigns {
    /// Campaigns whose files are known: their paths below a folder, with `/`. Nothing is searched.
    #[must_use]
    pub fn at(root: &Path, paths: &[String]) -> Self {
        let mut campaigns: Vec<FoundCampaign> = paths.iter().map(|p| found(root, &root.join(p))).collect();
        campaigns.sort();
        Self { root: root.to_owned(), campaigns, notes: Vec::new() }
    }
}

/// Finds every `campaign.toml` in folders and below them, and takes files as they are given. Links and hidden folders are not followed.
///
/// # Errors
/// [`FindError`].
pub fn find_campaigns(paths: &[PathBuf]) -> Result<FoundCampaigns, FindError> {
    let given: Vec<PathBuf> = paths
        .iter()
        .map(|p| p.canonicalize().map_err(|reason| FindError::Path { path: p.clone(), reason }))
        .collect::<Result<_, _>>()?;
    let mut search = Search::default();
    for path in &given {
        if path.is_dir() { search.folder(path, 0)? } else { search.files.push(path.clone()) }
    }
    let folder = |p: &PathBuf| if p.is_dir() { p.clone() } else { p.parent().unwrap_or(p).to_owned() };
    // Several folders are known by their names within the one that holds them.
    let within = |p: &PathBuf| if given.len() > 1 && p.is_dir() { p.parent().unwrap_or(p).to_owned() } else { folder(p) };
    let root = given.iter().map(within).reduce(|a, b| common(&a, &b)).unwrap_or_default();
    search.files.sort();
    search.files.dedup();
    let mut campaigns: Vec<FoundCampaign> = search.files.iter().map(|f| found(&root, f)).collect();
    campaigns.sort();
    if campaigns.is_empty() {
        return Err(FindError::None { paths: paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ") });
    }
    let mut named: Vec<&FoundCampaign> = campaigns.iter().collect();
    named.sort_by(|a, b| a.result.cmp(&b.result));
    if let Some(w) = named.windows(2).find(|w| w[0].result == w[1].result) {
        let [first, second] = [&w[0].path, &w[1].path].map(Clone::clone);
        return Err(FindError::Twins { first, second, result: w[0].result.clone() });
    }
    Ok(FoundCampaigns { root, campaigns, notes: search.notes })
}

fn found(root: &Path, file: &Path) -> FoundCampaign {
    let below = file.strip_prefix(root).unwrap_or(file);
    let names: Vec<String> = below.components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
    let path = names.join("/");
    let result = match &names[..] {
        [folder @ .., last] if last == FILE && !folder.is_empty() => folder.join("/"),
        _ => path.strip_suffix(".toml").unwrap_or(&path).to_owned(),
    };
    FoundCampaign { path, file: file.to_owned(), result }
}

/// Longest path that both begin with.
fn common(a: &Path, b: &Path) -> PathBuf {
    a.components().zip(b.components()).take_while(|(x, y)| x == y).map(|(x, _)| x.as_os_str()).collect()
}

#[derive(Default)]
struct Search {
    files: Vec<PathBuf>,
    notes: Vec<String>,
    looked_at: usize,
}

impl Search {
    fn folder(&mut self, folder: &Path, depth: usize) -> Result<(), FindError> {
        let entries = match fs::read_dir(folder) {
            Ok(entries) => entries,
            Err(reason) if depth == 0 => return Err(FindError::Path { path: folder.to_owned(), reason }),
            Err(reason) => {
                self.notes.push(format!("{}: not searched: cannot be read ({reason})", folder.display()));
                return Ok(());
            }
        };
        let mut below = Vec::new();
        for entry in entries.flatten() {
            self.looked_at += 1;
            let hidden = entry.file_name().to_string_lossy().starts_with('.');
            // The type of the entry itself: a link is neither.
            let Ok(kind) = entry.file_type() else { continue };
            if kind.is_dir() && !hidden {
                below.push(entry.path());
            } else if kind.is_file() && entry.file_name() == FILE {
                self.files.push(entry.path());
            }
        }
        let limits = [
            ("files and folders to search", self.looked_at, limits::SEARCHED),
            ("campaigns", self.files.len(), limits::CAMPAIGNS),
        ];
        if let Some((what, _, allowed)) = limits.into_iter().find(|(_, n, most)| n > most) {
            return Err(FindError::TooMany { path: folder.to_owned(), what, allowed });
        }
        if depth == limits::SEARCH_DEPTH {
            let note = |p: &PathBuf| {
                format!("{}: not searched: more than {} folders below; give it by itself", p.display(), limits::SEARCH_DEPTH)
            };
            self.notes.extend(below.first().map(note));
            return Ok(());
        }
        below.sort();
        below.iter().try_for_each(|f| self.folder(f, depth + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(root: &Path, files: &[&str]) {
        for f in files {
            let path = root.join(f);
            fs::create_dir_all(path.parent().expect("below")).expect("writable");
            fs::write(path, "").expect("writable");
        }
    }
    fn names(found: &FoundCampaigns) -> Vec<(&str, &str)> {
        found.campaigns.iter().map(|c| (c.path.as_str(), c.result.as_str())).collect()
    }

    #[test]
    fn law_every_campaign_below_is_found_once() {
        let dir = tempfile::tempdir().expect("a folder");
        let deep = "d/".repeat(limits::SEARCH_DEPTH + 1) + FILE;
        write(dir.path(), &["b/campaign.toml", "a/x/campaign.toml", "a/other.toml", ".hidden/campaign.toml", &deep]);
        #[cfg(unix)]
        std::os::unix::fs::symlink(dir.path().join("a"), dir.path().join("link")).expect("links");
        let found = find_campaigns(&[dir.path().to_owned()]).expect("two");
        assert_eq!(names(&found), [("a/x/campaign.toml", "a/x"), ("b/campaign.toml", "b")]);
        assert!(found.notes.len() == 1 && found.notes[0].contains("not searched"), "{:?}", found.notes);
        // Files and folders together, one of them twice; names begin below what holds all.
        let some = ["a/other.toml", "a", "b/campaign.toml", "b"].map(|p| dir.path().join(p));
        let found = find_campaigns(&some).expect("three");
        assert_eq!(names(&found), [("a/other.toml", "a/other"), ("a/x/campaign.toml", "a/x"), ("b/campaign.toml", "b")]);
        let one = find_campaigns(&[dir.path().join("b/campaign.toml")]).expect("one");
        assert_eq!(names(&one), [("campaign.toml", "campaign")]);
    }

    #[test]
    fn law_what_cannot_be_is_said() {
        let dir = tempfile::tempdir().expect("a folder");
        write(dir.path(), &["empty/note.txt", "twins/a/campaign.toml", "twins/a.toml"]);
        let refused = |paths: &[&str], words: &str| {
            let paths: Vec<PathBuf> = paths.iter().map(|p| dir.path().join(p)).collect();
            find_campaigns(&paths).is_err_and(|e| e.to_string().contains(words))
        };
        assert!(refused(&["empty"], "no campaign.toml in it"));
        assert!(refused(&["nowhere"], "cannot be searched"));
        assert!(refused(&["twins/a", "twins/a.toml"], "results of both would be in results/a"));
    }
}
