//! python: simulate, identify, re-simulate, close, choose terms, plan. In: scenarios, campaigns, arrays, requests as JSON. Out: arrays
//! and results as JSON.

use crate::errors::Raised;
use crate::threads::on_threads;
use numpy::{IntoPyArray as _, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;
use std::sync::Arc;
use windfall::files::{json_text, record_columns};
use windfall::model::Use;
use windfall::results::Truth;
use windfall::{RunColumns, Scenario, identification_of};
use windfall_cli::printed;

/// A result as JSON, and as the terminal prints it.
pub(crate) type Told = (String, String);

fn read<T: DeserializeOwned>(json: &str) -> Result<T, Raised> {
    Ok(serde_json::from_str(json)?)
}

/// Flights of a scenario: for each its name, kind, use, record and truth (dictionaries of arrays) and how it ended.
#[pyfunction]
#[pyo3(signature = (word, request="{}", threads=0))]
pub(crate) fn simulate<'py>(py: Python<'py>, word: PathBuf, request: &str, threads: usize) -> PyResult<Bound<'py, PyList>> {
    let request = read(request)?;
    let flights = on_threads(py, threads, move || Ok(Scenario::find(&word)?.fly(&request)?))?;
    let summaries = flights.summary(false).flights;
    let all = PyList::empty(py);
    for ((flight, flown), summary) in flights.scenario.file.scenario.flights.iter().zip(flights.flown).zip(summaries) {
        let d = PyDict::new(py);
        d.set_item("name", &flight.name)?;
        d.set_item("kind", &flight.kind)?;
        d.set_item("use", flight.used.name())?;
        d.set_item("end", summary.end)?;
        d.set_item("end_t_s", summary.end_t_s)?;
        let record = PyDict::new(py);
        record_columns(&flown.record).into_iter().try_for_each(|(name, series)| give(&record, name, series.into_owned()))?;
        d.set_item("record", record)?;
        d.set_item("truth", truth_columns(py, flown.truth)?)?;
        all.append(d)?;
    }
    Ok(all)
}

/// Hands a series over to NumPy without a copy.
fn give(d: &Bound<'_, PyDict>, name: &str, x: Vec<f64>) -> PyResult<()> {
    d.set_item(name, x.into_pyarray(d.py()))
}

fn truth_columns(py: Python<'_>, t: Truth) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    give(&d, "t_s", t.t_s)?;
    d.set_item("p_tunnel_cm_m", numpy::PyArray2::from_owned_array(py, matrix(t.p_tunnel_cm)))?;
    d.set_item("v_tunnel_cm_m_s", numpy::PyArray2::from_owned_array(py, matrix(t.v_tunnel_cm)))?;
    d.set_item("w_tunnel_body_rad_s", numpy::PyArray2::from_owned_array(py, matrix(t.w_tunnel_body)))?;
    d.set_item("attitude_rad", numpy::PyArray2::from_owned_array(py, matrix(t.attitude_rad)))?;
    d.set_item("quaternion", numpy::PyArray2::from_owned_array(py, matrix(t.quaternion)))?;
    give(&d, "vw_m_s", t.vw_m_s)?;
    give(&d, "alpha_t_rad", t.alpha_t_rad)?;
    give(&d, "airspeed_m_s", t.airspeed_m_s)?;
    give(&d, "tether_n", t.tether_n)?;
    Ok(d)
}

/// Rows of N numbers as a matrix over the same memory.
fn matrix<const N: usize>(rows: Vec<[f64; N]>) -> numpy::ndarray::Array2<f64> {
    numpy::ndarray::Array2::from(rows)
}

/// A campaign: declared model and runs.
#[pyclass(frozen, name = "Campaign", module = "windfall._windfall")]
pub(crate) struct PyCampaign {
    inner: Arc<windfall::Campaign>,
}

#[pymethods]
impl PyCampaign {
    /// Reads a campaign file; or flies a scenario (file or bundled), whose effects its campaign does not declare.
    #[new]
    /// Where files stand for what was in memory, warnings do not name their `folder`.
    #[pyo3(signature = (word, request="{}", folder=None))]
    fn new(py: Python<'_>, word: PathBuf, request: &str, folder: Option<&str>) -> PyResult<Self> {
        let request = read(request)?;
        let mut inner = on_threads(py, 0, move || Ok(windfall::Campaign::find(&word, &request)?))?;
        if let Some(folder) = folder {
            inner.warnings.iter_mut().for_each(|w| *w = w.replace(folder, ""));
        }
        Ok(Self { inner: Arc::new(inner) })
    }
    /// The same declared model with these runs: (name, kind, use, columns of the run file, names of columns without numbers).
    fn with_runs(&self, py: Python<'_>, runs: Vec<GivenRun<'_>>) -> PyResult<Self> {
        let runs = runs.into_iter().map(run_of).collect::<PyResult<Vec<_>>>()?;
        let inner = py.detach(|| self.inner.with_runs(runs)).map_err(Raised::from)?;
        Ok(Self { inner: Arc::new(inner) })
    }
    #[getter]
    fn name(&self) -> &str {
        &self.inner.data.name
    }
    #[getter]
    fn runs(&self) -> Vec<&str> {
        self.inner.data.runs.iter().map(|r| r.name.as_str()).collect()
    }
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.warnings.clone()
    }
    fn __repr__(&self) -> String {
        format!("Campaign({:?}, runs={:?})", self.name(), self.runs())
    }
    /// `identification.json`, to the byte.
    #[pyo3(signature = (request="{}", threads=0))]
    fn identify(&self, py: Python<'_>, request: &str, threads: usize) -> PyResult<Told> {
        self.ask(py, threads, read(request)?, windfall::Campaign::identify, printed::identification)
    }
    /// `resimulation.json` of an identification.
    #[pyo3(signature = (identification, request="{}", threads=0))]
    fn resimulate(&self, py: Python<'_>, identification: &str, request: &str, threads: usize) -> PyResult<Told> {
        let found = identification_of("identification", identification).map_err(Raised::from)?;
        self.ask(
            py,
            threads,
            read(request)?,
            move |campaign, request| campaign.resimulate(&found, request),
            printed::resimulation,
        )
    }
    /// `close.json`.
    #[pyo3(signature = (request="{}", threads=0))]
    fn close(&self, py: Python<'_>, request: &str, threads: usize) -> PyResult<Told> {
        self.ask(py, threads, read(request)?, windfall::Campaign::close, |_, closing| printed::closing(closing))
    }
    /// `structure.json`.
    #[pyo3(signature = (request="{}", threads=0))]
    fn structure(&self, py: Python<'_>, request: &str, threads: usize) -> PyResult<Told> {
        self.ask(py, threads, read(request)?, windfall::Campaign::structure, printed::structure)
    }
    /// `plan.json`.
    #[pyo3(signature = (request="{}", threads=0))]
    fn plan(&self, py: Python<'_>, request: &str, threads: usize) -> PyResult<Told> {
        self.ask(py, threads, read(request)?, windfall::Campaign::plan, printed::plan)
    }
}

impl PyCampaign {
    /// A verb: its request in, its result out, as JSON and as the terminal prints it.
    fn ask<R: Send + 'static, T: Serialize>(
        &self,
        py: Python<'_>,
        threads: usize,
        request: R,
        verb: impl FnOnce(&windfall::Campaign, &R) -> windfall::Result<T> + Send + 'static,
        words: impl FnOnce(&str, &T) -> String + Send + 'static,
    ) -> PyResult<Told> {
        let campaign = Arc::clone(&self.inner);
        on_threads(py, threads, move || {
            let result = verb(&campaign, &request)?;
            Ok((json_text(&result)?, words(&campaign.data.name, &result)))
        })
    }
}

/// Name, kind, use, columns, and the names of columns that hold no numbers.
type GivenRun<'py> = (String, String, String, Bound<'py, PyDict>, Vec<String>);

fn run_of((name, kind, used, columns, left_out): GivenRun<'_>) -> PyResult<RunColumns> {
    let wrong = |what: String| PyErr::from(Raised::Argument(format!("run {name}: {what}")));
    let used = Use::of_name(&used)
        .ok_or_else(|| wrong(format!("use {used:?} must be one of {}", Use::ALL.map(Use::name).join(", "))))?;
    let series = |(key, at): (Bound<'_, PyAny>, Bound<'_, PyAny>)| -> PyResult<(String, Vec<f64>)> {
        let key: String = key.extract()?;
        let array: PyReadonlyArray1<'_, f64> =
            at.extract().map_err(|_| wrong(format!("column {key} must be a one-dimensional array of float64")))?;
        Ok((key, array.as_array().to_vec()))
    };
    let columns = columns.iter().map(series).collect::<PyResult<_>>()?;
    Ok(RunColumns { name, kind, used, columns, left_out })
}
