//! windfall: many campaigns with one verb. In: folders, campaign files, the verb's request. Out: a result of each, a table of all, parameters
//! pooled over campaigns, a page.

use crate::{Campaign, Close, Error, ErrorKind, Identify, Result};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use windfall_report::{campaign_page, many_page};
use windfall_scenarios::{
    CampaignStore, FoundCampaign, FoundCampaigns, ManyIdentity, Opening, ResultFile, Shard, StoreError, campaign_hash,
    find_campaigns, json_text, table_bytes,
};
use windfall_study::each;
use windfall_study::many::{CampaignOutcome, ManySummary, campaign_table};

/// Name of the table of all campaigns.
const TABLE: &str = "campaigns.parquet";

/// Most campaigns that get a page each: one takes about 150 kB.
const PAGES: usize = 1000;

/// How to do many campaigns into a folder.
///
/// ```
/// use windfall::Many;
/// let rest: Many = serde_json::from_str(r#"{"resume": true}"#).expect("a request");
/// assert_eq!(rest, Many { resume: true, ..Many::default() });
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
#[serde(default, deny_unknown_fields)]
pub struct Many {
    /// Go on with what another run left in the folder: campaigns that are done and whose files say the same are not done again
    #[cfg_attr(feature = "cli", arg(long, conflicts_with = "force"))]
    pub resume: bool,
    /// Do share i of n only, i from 1 to n: every n-th campaign; when all shares are there, --resume without --shard joins them
    #[cfg_attr(feature = "cli", arg(long, value_name = "i/n", value_parser = clap::value_parser!(Shard), conflicts_with = "force"))]
    pub shard: Option<Shard>,
    /// Overwrite results that exist.
    #[cfg_attr(feature = "cli", arg(skip))]
    pub force: bool,
}

impl Many {
    fn order(&self) -> Result<(Opening, Shard)> {
        crate::Study { resume: self.resume, shard: self.shard, force: self.force }.order()
    }
}

/// What is done to each campaign.
///
/// ```
/// use windfall::Each;
/// let each: Each = serde_json::from_str(r#"{"identify": {"method": "equation-error"}}"#).expect("a verb and its request");
/// assert_eq!(each.file(), "identification.json");
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Each {
    /// The loop is closed.
    Close(Close),
    /// Parameters are identified.
    Identify(Identify),
}

impl Each {
    /// The file that holds a campaign's result.
    #[must_use]
    pub fn file(&self) -> &'static str {
        match self {
            Self::Close(_) => "close.json",
            Self::Identify(_) => "identification.json",
        }
    }
}

/// What one campaign gave, as it is kept.
///
/// ```no_run
/// use windfall::{Campaigns, Close, Each};
/// let campaigns = Campaigns::find(&["measured".into()], Each::Close(Close::default()))?;
/// let done = campaigns.one(0)?;
/// println!("{}: {}", done.outcome.path, done.outcome.exit_code);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct CampaignDone {
    /// Hash of what the campaign says; empty where it could not be read.
    pub input: String,
    /// Its row.
    pub outcome: CampaignOutcome,
    /// Its result; none where it has none.
    pub result: Option<ResultFile>,
}

/// Campaigns that were found, and what is to be done to each.
///
/// ```no_run
/// use windfall::{Campaigns, Close, Each};
/// let campaigns = Campaigns::find(&["measured".into()], Each::Close(Close::default()))?;
/// campaigns.names().for_each(|name| println!("{name}"));
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Campaigns {
    found: FoundCampaigns,
    each: Each,
}

impl Campaigns {
    /// Finds every `campaign.toml` in folders and below, and takes campaign files as they are given.
    ///
    /// ```no_run
    /// use std::path::Path;
    /// use windfall::{Campaigns, Close, Each, Many};
    /// let campaigns = Campaigns::find(&["measured".into()], Each::Close(Close::default()))?;
    /// if let Some(all) = campaigns.run(Path::new("closed"), &Many::default())? {
    ///     assert_eq!(all.ok + all.failed, campaigns.names().count());
    /// }
    /// # Ok::<(), windfall::Error>(())
    /// ```
    ///
    /// # Errors
    /// No campaign, or too many; a path that is not there; a request that cannot be.
    pub fn find(paths: &[PathBuf], each: Each) -> Result<Self> {
        if let Each::Identify(request) = &each {
            request.order()?;
        }
        Ok(Self { found: find_campaigns(paths)?, each })
    }
    /// Campaigns whose files are known, by their paths below a folder, with `/`: as another process found them.
    #[must_use]
    pub fn at(root: &Path, paths: &[String], each: Each) -> Self {
        Self { found: FoundCampaigns::at(root, paths), each }
    }
    /// Campaign files relative to [`Campaigns::root`], in the order of the rows.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.found.campaigns.iter().map(|c| c.path.as_str())
    }
    /// Folder to which the names are relative.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.found.root
    }
    /// What was not searched, and why.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.found.notes
    }
    /// Opens a folder for the results.
    ///
    /// # Errors
    /// Results that would be overwritten or are of another order; a request that contradicts itself.
    pub fn open(&self, folder: &Path, request: &Many) -> Result<CampaignStore> {
        let (opening, shard) = request.order()?;
        let each = serde_json::to_value(&self.each).map_err(|e| Error::Request(e.to_string()))?;
        let identity = ManyIdentity { windfall: env!("CARGO_PKG_VERSION").to_owned(), each };
        let results: Vec<&str> = self.found.campaigns.iter().map(|c| c.result.as_str()).collect();
        Ok(CampaignStore::open(folder, &identity, &results, shard, opening)?)
    }
    /// Numbers of the campaigns of the folder's share that have no result, or one of other content.
    #[must_use]
    pub fn missing(&self, store: &CampaignStore) -> Vec<usize> {
        let all = self.found.campaigns.par_iter().enumerate();
        let wanted = all.filter(|(k, c)| store.has(*k as u64) && !self.is_kept(store, c));
        wanted.map(|(k, _)| k).collect()
    }
    fn is_kept(&self, store: &CampaignStore, c: &FoundCampaign) -> bool {
        let kept = store.kept::<CampaignOutcome>(&c.result);
        // What could not be read has no content to hold it against: it is read again.
        kept.is_some_and(|(input, outcome)| {
            let now = guarded(|| Ok(self.read(c)?.1));
            !input.is_empty() && outcome.path == c.path && now.is_ok_and(|now| now == input)
        })
    }
    /// A campaign and the hash of what it says, in words that do not depend on where it lies.
    fn read(&self, c: &FoundCampaign) -> Result<(Campaign, String)> {
        let mut campaign = Campaign::read(&c.file)?;
        campaign.warnings.iter_mut().for_each(|w| *w = self.plain(w));
        let hash = campaign_hash(&campaign.data, &campaign.warnings);
        Ok((campaign, hash))
    }
    /// Words without the path of the folder searched.
    fn plain(&self, words: &str) -> String {
        words.replace(&format!("{}{}", self.found.root.display(), std::path::MAIN_SEPARATOR), "")
    }
    /// Does the campaign of this number, on the threads of the current pool. What fails says so in its row.
    ///
    /// # Errors
    /// A number that no campaign has.
    pub fn one(&self, number: usize) -> Result<CampaignDone> {
        let all = &self.found.campaigns;
        let no = || Error::Request(format!("campaign {number} is not one of the {} that were found", all.len()));
        Ok(self.done(all.get(number).ok_or_else(no)?))
    }
    fn done(&self, c: &FoundCampaign) -> CampaignDone {
        let (mut input, mut name) = (String::new(), String::new());
        let made = guarded(|| {
            let (campaign, hash) = self.read(c)?;
            (input, name) = (hash, campaign.data.name.clone());
            let of_json = |e: serde_json::Error| Error::Request(format!("result as JSON: {e}"));
            let (outcome, text) = match &self.each {
                Each::Close(request) => {
                    let closing = campaign.close(request)?;
                    (CampaignOutcome::of_closing(&c.path, &closing), json_text(&closing).map_err(of_json)?)
                }
                Each::Identify(request) => {
                    let found = campaign.identify(request)?;
                    (CampaignOutcome::of_identified(&c.path, &name, &found), json_text(&found).map_err(of_json)?)
                }
            };
            Ok((outcome, text))
        });
        match made {
            Ok((outcome, text)) => CampaignDone { input, outcome, result: Some((self.each.file().to_owned(), text)) },
            Err((code, reason)) => {
                CampaignDone { input, outcome: CampaignOutcome::failed(&c.path, &name, code, self.plain(&reason)), result: None }
            }
        }
    }
    /// Keeps what a campaign gave, here or elsewhere.
    ///
    /// # Errors
    /// A full disk and the like; a row of another campaign, a result of another verb.
    pub fn put(&self, store: &CampaignStore, number: usize, done: &CampaignDone) -> Result<()> {
        let c = self.found.campaigns.get(number).filter(|c| c.path == done.outcome.path);
        let own = done.result.as_ref().is_none_or(|(file, _)| file == self.each.file());
        let wrong = || Error::Request(format!("campaign {number}: {} is not its result", done.outcome.path));
        let c = c.filter(|_| own).ok_or_else(wrong)?;
        Ok(store.put(&c.result, &done.input, &done.outcome, done.result.as_ref())?)
    }
    /// Does these campaigns on the threads of the current pool. `see` is called with each and says whether to go on; those that were begun are
    /// kept.
    ///
    /// # Errors
    /// A full disk and the like; [`Error::Interrupted`] when `see` wants no more.
    pub fn work(&self, store: &CampaignStore, numbers: Vec<usize>, see: impl Fn(&CampaignOutcome) -> bool + Sync) -> Result<()> {
        each(
            numbers.into_iter(),
            |k| (k, self.one(k)),
            |(k, done)| {
                let done = done?;
                self.put(store, k, &done)?;
                if see(&done.outcome) { Ok(true) } else { Err(Error::Interrupted) }
            },
        )
    }
    /// Joins the results of all campaigns: writes `campaigns.parquet`, `many.json` and `report.html`.
    ///
    /// # Errors
    /// Campaigns without a result, a full disk.
    pub fn finish(&self, store: &CampaignStore) -> Result<ManySummary> {
        // As they are kept, not as they were in memory: the same after a kill.
        let kept: Vec<Option<CampaignOutcome>> = self
            .found
            .campaigns
            .iter()
            .map(|c| Some(store.kept::<CampaignOutcome>(&c.result)?.1).filter(|o| o.path == c.path))
            .collect();
        if let Some(first) = kept.iter().position(Option::is_none) {
            let missing = kept.iter().filter(|k| k.is_none()).count();
            let (folder, parts, first) = (store.folder().to_owned(), kept.len() as u64, first as u64);
            return Err(StoreError::Incomplete { folder, missing, parts, first }.into());
        }
        let mut outcomes: Vec<CampaignOutcome> = kept.into_iter().flatten().collect();
        self.pages(store, &mut outcomes)?;
        let (columns, rows) = campaign_table(&outcomes);
        let (table, hash) = table_bytes(&columns, &rows)?;
        let each = serde_json::to_value(&self.each).map_err(|e| Error::Request(e.to_string()))?;
        let summary = ManySummary::new(env!("CARGO_PKG_VERSION"), each, [TABLE.to_owned(), hash], outcomes);
        store.join(&table, &summary, &many_page(&summary))?;
        Ok(summary)
    }
    /// Writes each campaign's own page, unless there are too many for a disk's sake.
    fn pages(&self, store: &CampaignStore, outcomes: &mut [CampaignOutcome]) -> Result<()> {
        if outcomes.len() > PAGES {
            return Ok(());
        }
        let made = |(o, c): (&mut CampaignOutcome, &FoundCampaign)| -> Result<()> {
            o.page = store.put_page(&c.result, |file, text| campaign_page(&c.path, file, text))?;
            Ok(())
        };
        outcomes.par_iter_mut().zip(&self.found.campaigns).try_for_each(made)
    }
    /// Does what a folder lacks, and joins it unless only a share was asked for.
    ///
    /// # Errors
    /// As [`Campaigns::open`], [`Campaigns::work`] and [`Campaigns::finish`].
    pub fn run(&self, folder: &Path, request: &Many) -> Result<Option<ManySummary>> {
        let store = self.open(folder, request)?;
        self.work(&store, self.missing(&store), |_| true)?;
        if store.is_share() { Ok(None) } else { self.finish(&store).map(Some) }
    }
}

/// Work, or the exit code and the reason of its failure. The program's own slips are failures of that campaign too.
fn guarded<T>(work: impl FnOnce() -> Result<T>) -> std::result::Result<T, (u8, String)> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(made)) => Ok(made),
        Ok(Err(e)) => Err((if e.kind() == ErrorKind::Numerical { 3 } else { 2 }, e.to_string())),
        Err(_) => Err((3, "internal: the program's own checks failed in this campaign; report it with its files".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_a_slip_of_the_program_is_a_failure_of_one_campaign() {
        let slip = || -> Result<()> { panic!("on purpose") };
        assert!(guarded(slip).is_err_and(|(code, reason)| code == 3 && reason.starts_with("internal: ")));
        let input = || -> Result<()> { Err(Error::Request("what".to_owned())) };
        assert!(guarded(input).is_err_and(|(code, reason)| code == 2 && reason == "what"));
    }

    #[test]
    fn law_the_order_is_json() {
        let each = Each::Identify(Identify { combined: true, ..Identify::default() });
        let text = serde_json::to_string(&each).expect("JSON");
        assert_eq!(serde_json::from_str::<Each>(&text).expect("back"), each);
        assert_eq!(serde_json::from_str::<Each>(r#"{"close": {}}"#).expect("nothing said"), Each::Close(Close::default()));
        for (text, word) in [(r#"{"plan": {}}"#, "expected `close` or `identify`"), (r#"{"close": {"sed": 1}}"#, "unknown field")]
        {
            assert!(serde_json::from_str::<Each>(text).is_err_and(|e| e.to_string().contains(word)), "{text}");
        }
    }
}
