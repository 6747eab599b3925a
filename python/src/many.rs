//! python: many campaigns, in whole and one by one. In: paths, verb and request as JSON. Out: what each gave, the folder's results.

use crate::campaign::Told;
use crate::errors::Raised;
use crate::threads::{Stop, on_threads, on_threads_until};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use windfall::files::{CampaignStore, json_text};
use windfall::results::CampaignOutcome;
use windfall::{CampaignDone, Campaigns};

/// What one campaign gave: hash of its content, row as JSON, name and text of its result.
type Done = (String, String, Option<(String, String)>);

/// Campaigns that were found; with a folder once `open` was called.
#[pyclass(frozen, name = "Many", module = "windfall._windfall")]
pub(crate) struct PyMany {
    inner: Arc<Inner>,
}

struct Inner {
    campaigns: Campaigns,
    open: Mutex<Option<CampaignStore>>,
}

impl Inner {
    fn with_open<T>(&self, work: impl FnOnce(&Campaigns, &CampaignStore) -> Result<T, Raised>) -> Result<T, Raised> {
        let open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let store = open.as_ref().ok_or_else(|| Raised::Argument("open a folder first".to_owned()))?;
        work(&self.campaigns, store)
    }
}

#[pymethods]
impl PyMany {
    /// Finds campaigns. `each`: verb with its request, `{"close": {}}`.
    #[new]
    fn new(py: Python<'_>, paths: Vec<PathBuf>, each: &str) -> PyResult<Self> {
        let each = serde_json::from_str(each).map_err(Raised::from)?;
        let campaigns = py.detach(|| Campaigns::find(&paths, each)).map_err(Raised::from)?;
        Ok(Self { inner: Arc::new(Inner { campaigns, open: Mutex::new(None) }) })
    }
    /// Campaigns whose files are known, by their paths below a folder.
    #[staticmethod]
    fn at(root: PathBuf, paths: Vec<String>, each: &str) -> PyResult<Self> {
        let each = serde_json::from_str(each).map_err(Raised::from)?;
        Ok(Self { inner: Arc::new(Inner { campaigns: Campaigns::at(&root, &paths, each), open: Mutex::new(None) }) })
    }
    /// What was not searched, and why.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.campaigns.notes().to_vec()
    }
    /// Folder to which the campaigns' paths are relative.
    #[getter]
    fn root(&self) -> PathBuf {
        self.inner.campaigns.root().to_owned()
    }
    /// Campaign files relative to it.
    #[getter]
    fn campaigns(&self) -> Vec<&str> {
        self.inner.campaigns.names().collect()
    }
    /// Does a campaign; what it gives is a function of its files and the request alone.
    #[pyo3(signature = (number, threads=1))]
    fn one(&self, py: Python<'_>, number: usize, threads: usize) -> PyResult<Done> {
        let inner = Arc::clone(&self.inner);
        on_threads(py, threads, move || {
            let done = inner.campaigns.one(number)?;
            Ok((done.input, json_text(&done.outcome)?, done.result))
        })
    }
    /// Opens a folder for results.
    #[pyo3(signature = (folder, request="{}"))]
    fn open(&self, py: Python<'_>, folder: PathBuf, request: &str) -> PyResult<()> {
        let request = serde_json::from_str(request).map_err(Raised::from)?;
        let opened = py.detach(|| self.inner.campaigns.open(&folder, &request)).map_err(Raised::from)?;
        *self.inner.open.lock().unwrap_or_else(PoisonError::into_inner) = Some(opened);
        Ok(())
    }
    /// Numbers of the campaigns of the folder's share that are to be done.
    #[pyo3(signature = (threads=0))]
    fn missing(&self, py: Python<'_>, threads: usize) -> PyResult<Vec<usize>> {
        let inner = Arc::clone(&self.inner);
        on_threads(py, threads, move || inner.with_open(|campaigns, store| Ok(campaigns.missing(store))))
    }
    /// Keeps what a campaign gave elsewhere.
    fn put(&self, py: Python<'_>, number: usize, input: String, outcome: &str, result: Option<(String, String)>) -> PyResult<()> {
        let outcome: CampaignOutcome = serde_json::from_str(outcome).map_err(Raised::from)?;
        let done = CampaignDone { input, outcome, result };
        Ok(py.detach(|| self.inner.with_open(|campaigns, store| Ok(campaigns.put(store, number, &done)?)))?)
    }
    /// Does here what the folder lacks of its share. Ctrl-C ends it: campaigns in flight may take minutes, so they are waited for no longer
    /// than is noticed. What they still put into the folder is what would be put there again.
    #[pyo3(signature = (threads=0))]
    fn work(&self, py: Python<'_>, threads: usize) -> PyResult<()> {
        let (inner, stop) = (Arc::clone(&self.inner), Arc::new(AtomicBool::new(false)));
        let asked = Arc::clone(&stop);
        on_threads_until(py, threads, Some(Stop { flag: &stop, patience: Duration::from_millis(700) }), move || {
            let go_on = |_: &CampaignOutcome| !asked.load(Ordering::Relaxed);
            inner.with_open(|campaigns, store| Ok(campaigns.work(store, campaigns.missing(store), go_on)?))
        })
    }
    /// Joins the results; the content of many.json, and what the terminal prints of it.
    fn finish(&self, py: Python<'_>) -> PyResult<Told> {
        Ok(py.detach(|| {
            self.inner.with_open(|campaigns, store| {
                let summary = campaigns.finish(store)?;
                Ok((json_text(&summary)?, windfall_cli::printed::many(&summary)))
            })
        })?)
    }
}
