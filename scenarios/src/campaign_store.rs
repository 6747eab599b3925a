//! scenarios: the folder of many campaigns' results. In: each campaign's result as it comes, from one process or several, killed or not.
//! Out: `results/<name>/`, each put in place whole, and the table and page of all.
//!
//! `order.json` says what was done to each campaign. `results/<name>/outcome.json` says of which content a result is, and the hash of the
//! result's file: what does not agree with it is done again.

use crate::error::WriteError;
use crate::file_set::{FileSet, lock, settle, sweep};
use crate::hash::fnv1a;
use crate::parquet_rows;
use crate::store::{Opening, Shard};
use crate::store_error::StoreError;
use crate::write::{text_atomically, write_json_atomically};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use windfall_model::study::{Column, Row};

const ORDER: &str = "order.json";
const RESULTS: &str = "results";
const OUTCOME: &str = "outcome.json";
/// Names that a campaign's result may have.
const RESULT_FILES: [&str; 2] = ["close.json", "identification.json"];
/// A campaign's own page.
const PAGE: &str = "report.html";
/// What is written when all campaigns are there.
const JOINED: [&str; 3] = ["campaigns.parquet", "many.json", "report.html"];

/// What a folder's results are of, all that decides on their bits but the campaigns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ManyIdentity {
    /// Version of the program.
    pub windfall: String,
    /// Verb and request.
    pub each: Value,
}

/// A result under its file's name.
pub type ResultFile = (String, String);

#[derive(Serialize, Deserialize)]
struct Kept<T> {
    /// Hash of what the campaign says.
    input: String,
    /// The result's file and the hash of its bytes.
    result: Option<(String, String)>,
    outcome: T,
}

/// A folder of many campaigns' results, open for one share.
#[derive(Debug)]
pub struct CampaignStore {
    folder: PathBuf,
    shard: Shard,
}

impl CampaignStore {
    /// Opens a folder, made if missing, for a share of the campaigns, whose results have these names.
    ///
    /// # Errors
    /// Results that would be overwritten or are of another order; links where results are to be.
    pub fn open(
        folder: &Path,
        identity: &ManyIdentity,
        results: &[&str],
        shard: Shard,
        opening: Opening,
    ) -> Result<Self, StoreError> {
        if opening != Opening::Resume {
            fs::create_dir_all(folder).map_err(|e| StoreError::write(folder, e))?;
        }
        // Two processes that begin in one folder begin one after the other.
        let _turn = lock(folder);
        if let Some(link) = [ORDER, RESULTS].map(|n| folder.join(n)).into_iter().find(|p| p.is_symlink()) {
            return Err(StoreError::Link { path: link });
        }
        sweep(folder);
        let store = Self { folder: folder.to_owned(), shard };
        let there = store.identity()?;
        if opening == Opening::Force && there.is_some() {
            store.clear()?;
        }
        let there = there.filter(|_| opening != Opening::Force);
        let own = || (0..).zip(results).any(|(k, r)| shard.has(k) && store.of(r).join(OUTCOME).is_file());
        let joined = || JOINED.iter().find(|f| folder.join(f).symlink_metadata().is_ok());
        match (&there, opening) {
            (None, Opening::Resume) => return Err(StoreError::Nothing { folder: folder.to_owned() }),
            // Another share may have begun in the same folder.
            (Some(_), Opening::New) if shard == Shard::ALL || joined().is_some() || own() => {
                return Err(StoreError::Exists { folder: folder.to_owned() });
            }
            (None, Opening::New) => {
                if let Some(file) = joined() {
                    let (folder, files) = (folder.to_owned(), (*file).to_owned());
                    return Err(WriteError::Exists { folder, files }.into());
                }
            }
            _ => {}
        }
        if let Some(t) = there.as_ref().filter(|t| *t != identity) {
            let version = t.windfall != identity.windfall;
            let what = if version { format!("version of the program ({})", t.windfall) } else { "verb or flags".to_owned() };
            return Err(StoreError::Changed { folder: folder.to_owned(), what });
        }
        if there.is_none() {
            write_json_atomically(&folder.join(ORDER), identity)?;
        }
        Ok(store)
    }
    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }
    /// Whether the campaign of this number is of this share.
    #[must_use]
    pub fn has(&self, campaign: u64) -> bool {
        self.shard.has(campaign)
    }
    /// Whether this is one share of several.
    #[must_use]
    pub fn is_share(&self) -> bool {
        self.shard != Shard::ALL
    }
    fn identity(&self) -> Result<Option<ManyIdentity>, StoreError> {
        let path = self.folder.join(ORDER);
        match fs::read_to_string(&path) {
            Ok(text) => serde_json::from_str(&text).map(Some).map_err(|e| StoreError::corrupt(&path, e)),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(reason) => Err(StoreError::Read { path, reason }),
        }
    }
    /// Folder of a campaign's result.
    fn of(&self, result: &str) -> PathBuf {
        self.folder.join(RESULTS).join(result)
    }
    /// What is kept of a campaign and the hash of what it was; none where there is nothing, or its file is not the one that was written.
    #[must_use]
    pub fn kept<T: DeserializeOwned>(&self, result: &str) -> Option<(String, T)> {
        let folder = self.of(result);
        settle(&folder).ok()?;
        let kept: Kept<T> = serde_json::from_str(&fs::read_to_string(folder.join(OUTCOME)).ok()?).ok()?;
        let sound = |name: &str| match &kept.result {
            Some((file, hash)) if file == name => fs::read(folder.join(name)).is_ok_and(|b| hash_of(&b) == *hash),
            _ => folder.join(name).symlink_metadata().is_err(),
        };
        RESULT_FILES.into_iter().all(sound).then_some((kept.input, kept.outcome))
    }
    /// Puts a campaign's result in place: all of it, or nothing. What this program kept of the campaign before is replaced.
    ///
    /// # Errors
    /// A full disk and the like; files in the way that are no results of this order.
    pub fn put<T: Serialize>(&self, result: &str, input: &str, outcome: &T, file: Option<&ResultFile>) -> Result<(), StoreError> {
        let folder = self.of(result);
        fs::create_dir_all(&folder).map_err(|e| StoreError::write(&folder, e))?;
        let before = folder.join(OUTCOME).is_file();
        let stale = |name: &str| before && file.is_none_or(|(f, _)| f != name) && folder.join(name).is_file();
        for name in RESULT_FILES.into_iter().filter(|n| stale(n)) {
            fs::remove_file(folder.join(name)).map_err(|e| StoreError::write(&folder.join(name), e))?;
        }
        let set = FileSet::new(&folder)?;
        if let Some((name, text)) = file {
            text_atomically(&set.stage().join(name), text)?;
        }
        let result = file.map(|(name, text)| (name.clone(), hash_of(text.as_bytes())));
        write_json_atomically(&set.stage().join(OUTCOME), &Kept { input: input.to_owned(), result, outcome })?;
        Ok(set.commit(before)?)
    }
    /// Writes a campaign's page beside its result, made of the result's file as it is kept; where it lies from the folder. None without a result.
    ///
    /// # Errors
    /// A full disk and the like.
    pub fn put_page(&self, result: &str, make: impl Fn(&str, &str) -> Option<String>) -> Result<Option<String>, StoreError> {
        let folder = self.of(result);
        let read = |name: &'static str| Some((name, fs::read_to_string(folder.join(name)).ok()?));
        let made = RESULT_FILES.into_iter().find_map(read).and_then(|(name, text)| make(name, &text));
        let path = folder.join(PAGE);
        let Some(page) = made else {
            // The page of a result that is gone goes with it.
            return match fs::remove_file(&path) {
                Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(StoreError::write(&path, e)),
                _ => Ok(None),
            };
        };
        text_atomically(&path, &page)?;
        Ok(Some(format!("{RESULTS}/{result}/{PAGE}")))
    }
    /// Writes the table, the summary and the page of all campaigns, replacing those that are there.
    ///
    /// # Errors
    /// A full disk and the like.
    pub fn join(&self, table: &[u8], summary: &impl Serialize, page: &str) -> Result<(), StoreError> {
        let set = FileSet::new(&self.folder)?;
        let path = set.stage().join(JOINED[0]);
        fs::write(&path, table).map_err(|e| StoreError::write(&path, e))?;
        write_json_atomically(&set.stage().join(JOINED[1]), summary)?;
        text_atomically(&set.stage().join(JOINED[2]), page)?;
        Ok(set.commit(true)?)
    }
    /// Removes what such an order wrote, and nothing else.
    fn clear(&self) -> Result<(), StoreError> {
        let remove = |path: &Path| match fs::remove_file(path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(StoreError::write(path, e)),
            _ => Ok(()),
        };
        clear_results(&self.folder.join(RESULTS), &remove)?;
        [ORDER].iter().chain(&JOINED).try_for_each(|f| remove(&self.folder.join(f)))
    }
}

/// Removes results below a folder, and folders that are empty then; links are not followed.
fn clear_results(folder: &Path, remove: &dyn Fn(&Path) -> Result<(), StoreError>) -> Result<(), StoreError> {
    if folder.join(OUTCOME).is_file() {
        RESULT_FILES.iter().chain(&[OUTCOME, PAGE]).try_for_each(|f| remove(&folder.join(f)))?;
    }
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|k| k.is_dir()) {
            clear_results(&entry.path(), remove)?;
        }
    }
    // One that is not empty holds what is not ours.
    let _ = fs::remove_dir(folder);
    Ok(())
}

fn hash_of(bytes: &[u8]) -> String {
    format!("{:016x}", fnv1a(bytes))
}

/// Hash of what a campaign says: its file and its runs as they were read, and what reading them had to say.
#[must_use]
pub fn campaign_hash(campaign: &windfall_model::Campaign, warnings: &[String]) -> String {
    hash_of(format!("{campaign:?}{warnings:?}").as_bytes())
}

/// Bytes of a table of campaigns and their hash; the same for the same rows.
///
/// # Errors
/// Rows that do not fit the columns.
pub fn table_bytes(columns: &[Column], rows: &[Row]) -> Result<(Vec<u8>, String), StoreError> {
    let bytes = parquet_rows::encode_as(parquet_rows::CAMPAIGNS, columns, rows)
        .map_err(|e| StoreError::corrupt(Path::new(JOINED[0]), e))?;
    let hash = hash_of(&bytes);
    Ok((bytes, hash))
}
