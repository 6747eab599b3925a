//! python: verbs on files alone: check, verify, closing against statistics, descents, the page of a folder, a first campaign file,
//! what a word means. In: paths, words. Out: JSON, HTML, text.

use crate::errors::Raised;
use crate::threads::on_threads;
use pyo3::prelude::*;
use std::path::PathBuf;
use windfall::files::json_text;
use windfall::results::Identification;

/// Kind of a file and what a reader wants said of it; every fault is an exception.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, word: PathBuf) -> PyResult<(&'static str, Vec<String>)> {
    on_threads(py, 1, move || {
        let checked = windfall::check(&word)?;
        Ok((checked.kind(), checked.warnings()))
    })
}

/// `verify.json`.
#[pyfunction]
#[pyo3(signature = (threads=0))]
pub(crate) fn verify(py: Python<'_>, threads: usize) -> PyResult<String> {
    on_threads(py, threads, || Ok(json_text(&windfall::verify()?)?))
}

/// `close.json` of published statistics.
#[pyfunction]
#[pyo3(signature = (word, request="{}", threads=0))]
pub(crate) fn close_statistics(py: Python<'_>, word: PathBuf, request: &str, threads: usize) -> PyResult<String> {
    let request = serde_json::from_str(request).map_err(Raised::from)?;
    on_threads(py, threads, move || Ok(json_text(&windfall::Published::find(&word)?.close(&request)?)?))
}

/// `descent.json`; with a folder also its files in there.
#[pyfunction]
#[pyo3(signature = (scenario, identification=None, request="{}", out=None, force=false, threads=0))]
pub(crate) fn descend(
    py: Python<'_>,
    scenario: PathBuf,
    identification: Option<&str>,
    request: &str,
    out: Option<PathBuf>,
    force: bool,
    threads: usize,
) -> PyResult<String> {
    let request: windfall::Descend = serde_json::from_str(request).map_err(Raised::from)?;
    let found: Option<Identification> = identification.map(serde_json::from_str).transpose().map_err(Raised::from)?;
    on_threads(py, threads, move || {
        let descended = windfall::DescentScenario::read(&scenario)?.descend(found.as_ref(), &request, || {})?;
        if let Some(folder) = out {
            windfall::put_descents(&folder, &descended, force)?;
        }
        Ok(json_text(&descended.summary)?)
    })
}

/// Page of a folder of results, as HTML in one piece.
#[pyfunction]
pub(crate) fn page(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    on_threads(py, 1, move || Ok(windfall::ResultsFolder::read(&folder)?.page()))
}

/// A commented campaign for a run file, as TOML.
#[pyfunction]
pub(crate) fn init(py: Python<'_>, run: PathBuf) -> PyResult<String> {
    on_threads(py, 1, move || Ok(windfall::init(&run)?))
}

/// What a family of effects, a key or a warning means.
#[pyfunction]
pub(crate) fn explain(words: Vec<String>) -> PyResult<String> {
    Ok(windfall::explain(&windfall::Explain { words }).map_err(Raised::from)?)
}
