//! python: verbs on files alone: check, verify, closing against statistics, descents, the page of a folder, a first campaign file,
//! what a word or key means, a table as a file. In: paths, words, columns. Out: JSON, HTML, text.

use crate::campaign::Told;
use crate::errors::Raised;
use crate::threads::on_threads;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use windfall::files::{json_text, write_columns_csv};
use windfall::identification_of;
use windfall_cli::printed;

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
pub(crate) fn verify(py: Python<'_>, threads: usize) -> PyResult<Told> {
    on_threads(py, threads, || {
        let all = windfall::verify()?;
        Ok((json_text(&all)?, printed::verification(&all)))
    })
}

/// `close.json` of published statistics.
#[pyfunction]
#[pyo3(signature = (word, request="{}", threads=0))]
pub(crate) fn close_statistics(py: Python<'_>, word: PathBuf, request: &str, threads: usize) -> PyResult<Told> {
    let request = serde_json::from_str(request).map_err(Raised::from)?;
    on_threads(py, threads, move || {
        let closing = windfall::Published::find(&word)?.close(&request)?;
        Ok((json_text(&closing)?, printed::closing_against_statistics(&closing)))
    })
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
) -> PyResult<Told> {
    let request: windfall::Descend = serde_json::from_str(request).map_err(Raised::from)?;
    let found = identification.map(|text| identification_of("identification", text)).transpose().map_err(Raised::from)?;
    on_threads(py, threads, move || {
        let descended = windfall::DescentScenario::read(&scenario)?.descend(found.as_ref(), &request, || {})?;
        if let Some(folder) = out {
            windfall::put_descents(&folder, &descended, force)?;
        }
        Ok((json_text(&descended.summary)?, printed::descent(&descended.summary)))
    })
}

/// Page of a folder of results, as HTML in one piece; with a second folder its figures there.
#[pyfunction]
#[pyo3(signature = (folder, figures=None, width=None, force=false))]
pub(crate) fn page(
    py: Python<'_>,
    folder: PathBuf,
    figures: Option<PathBuf>,
    width: Option<f64>,
    force: bool,
) -> PyResult<String> {
    on_threads(py, 1, move || {
        let results = windfall::ResultsFolder::read(&folder)?;
        if let Some(figures) = figures {
            results.write_figures(&figures, width.unwrap_or(windfall::report::WIDTH_MM), force)?;
        }
        Ok(results.page())
    })
}

/// Every key of the files.
#[pyfunction]
pub(crate) fn keys() -> String {
    windfall::files::key_reference()
}

/// Columns of one length as a run file (CSV), for tables that stand where a file does.
#[pyfunction]
pub(crate) fn write_columns(py: Python<'_>, path: PathBuf, columns: &Bound<'_, PyDict>) -> PyResult<()> {
    let of = |(name, values): (Bound<'_, PyAny>, Bound<'_, PyAny>)| -> PyResult<(String, Vec<f64>)> {
        let values: PyReadonlyArray1<'_, f64> = values.extract()?;
        Ok((name.extract()?, values.as_array().to_vec()))
    };
    let columns = columns.iter().map(of).collect::<PyResult<Vec<_>>>()?;
    let all: Vec<(&str, &[f64])> = columns.iter().map(|(n, c)| (n.as_str(), c.as_slice())).collect();
    Ok(py.detach(|| write_columns_csv(&path, &all)).map_err(windfall::Error::from).map_err(Raised::from)?)
}

/// A commented campaign for run files, as TOML.
#[pyfunction]
pub(crate) fn init(py: Python<'_>, runs: Vec<PathBuf>, request: &str) -> PyResult<String> {
    let request: windfall::Init = serde_json::from_str(request).map_err(Raised::from)?;
    on_threads(py, 1, move || Ok(windfall::init(&runs, &request)?.campaign))
}

/// What a family of effects, a key or a warning means.
#[pyfunction]
pub(crate) fn explain(words: Vec<String>) -> PyResult<String> {
    Ok(windfall::explain(&windfall::Explain { words }).map_err(Raised::from)?)
}
