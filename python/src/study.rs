//! python: studies in whole and in parts. In: a study file. Out: bytes of parts, the folder's results, the summary as JSON.

use crate::campaign::Told;
use crate::errors::Raised;
use crate::threads::{Stop, on_threads, on_threads_until};
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use windfall::files::{Store, read_runs as read};
use windfall::model::study::{Cell, CellKind, Row};
use windfall::{Drawing, PartRule};

/// A study made ready; with a folder once `open` was called.
#[pyclass(frozen, name = "Study", module = "windfall._windfall")]
pub(crate) struct PyStudy {
    inner: Arc<Inner>,
}

struct Inner {
    drawing: Drawing,
    open: Mutex<Option<(Store, PartRule, PathBuf)>>,
}

impl Inner {
    fn with_open<T>(
        &self,
        work: impl FnOnce(&Drawing, &Store, &mut PartRule, &PathBuf) -> Result<T, Raised>,
    ) -> Result<T, Raised> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let (store, rule, folder) = open.as_mut().ok_or_else(|| Raised::Argument("open a folder first".to_owned()))?;
        work(&self.drawing, store, rule, folder)
    }
}

#[pymethods]
impl PyStudy {
    /// Reads a study file.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let drawing = py.detach(|| Drawing::read(&path)).map_err(Raised::from)?;
        Ok(Self { inner: Arc::new(Inner { drawing, open: Mutex::new(None) }) })
    }
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.inner.drawing.warnings().to_vec()
    }
    /// Number of parts.
    #[getter]
    fn parts(&self) -> u64 {
        self.inner.drawing.parts()
    }
    /// Names of the columns after `draw`.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.inner.drawing.prepared().columns().iter().map(|c| c.name.clone()).collect()
    }
    /// Draws a part; its bytes are a function of the study and the part alone.
    #[pyo3(signature = (part, threads=1))]
    fn part<'py>(&self, py: Python<'py>, part: u64, threads: usize) -> PyResult<Bound<'py, PyBytes>> {
        let inner = Arc::clone(&self.inner);
        let bytes = on_threads(py, threads, move || Ok(inner.drawing.part(part)?))?;
        Ok(PyBytes::new(py, &bytes))
    }
    /// Opens a folder for results.
    #[pyo3(signature = (folder, request="{}"))]
    fn open(&self, py: Python<'_>, folder: PathBuf, request: &str) -> PyResult<()> {
        let request = serde_json::from_str(request).map_err(Raised::from)?;
        let opened = py.detach(|| -> Result<_, Raised> {
            let store = self.inner.drawing.open(&folder, &request)?;
            let rule = self.inner.drawing.rule(&store)?;
            Ok((store, rule, folder))
        })?;
        *self.inner.open.lock().unwrap_or_else(PoisonError::into_inner) = Some(opened);
        Ok(())
    }
    /// Parts that the folder lacks; none when the stopping rule is content.
    fn missing(&self, py: Python<'_>) -> PyResult<Vec<u64>> {
        let all = |_: &Drawing, store: &Store, rule: &mut PartRule, _: &PathBuf| {
            if rule.enough() { Ok(Vec::new()) } else { Ok(store.missing()?) }
        };
        Ok(py.detach(|| self.inner.with_open(all))?)
    }
    /// Adds a part drawn elsewhere; true when the stopping rule is content.
    fn put(&self, py: Python<'_>, part: u64, bytes: Vec<u8>) -> PyResult<bool> {
        Ok(py.detach(|| {
            self.inner.with_open(|_, store, rule, _| {
                rule.add(&store.put(part, bytes)?);
                Ok(rule.enough())
            })
        })?)
    }
    /// Draws here what the folder lacks of its share. Ctrl-C ends it after the draws in flight, all of which are kept; a second
    /// one at once.
    #[pyo3(signature = (threads=0))]
    fn draw(&self, py: Python<'_>, threads: usize) -> PyResult<()> {
        let (inner, stop) = (Arc::clone(&self.inner), Arc::new(AtomicBool::new(false)));
        let asked = Arc::clone(&stop);
        let go_on = move |_: &Row| !asked.load(Ordering::Relaxed);
        on_threads_until(py, threads, Some(Stop { flag: &stop, patience: Duration::MAX }), move || {
            inner.with_open(|drawing, store, _, _| Ok(drawing.draw(store, &go_on)?))
        })
    }
    /// Joins the parts; the summary as JSON, and what the terminal prints of it.
    fn finish(&self, py: Python<'_>) -> PyResult<Told> {
        Ok(py.detach(|| {
            self.inner.with_open(|drawing, store, _, folder| {
                let summary = drawing.finish(store, folder)?;
                Ok((serde_json::to_string(&summary)?, windfall_cli::printed::study(&summary)))
            })
        })?)
    }
}

/// Columns of a `runs.parquet`: float64 arrays (NaN where there is nothing; flags 0 and 1), words as lists.
#[pyfunction]
pub(crate) fn read_runs(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let (draws, columns) = py.detach(|| read(&path)).map_err(Raised::from)?;
    let d = PyDict::new(py);
    d.set_item("draw", draws.into_pyarray(py))?;
    for (column, cells) in columns {
        if column.kind == CellKind::Word {
            let words = cells.into_iter().map(|c| if let Cell::Word(w) = c { w } else { String::new() });
            d.set_item(column.name, words.collect::<Vec<String>>())?;
        } else {
            let numbers: Vec<f64> = cells.iter().map(|c| c.number().unwrap_or(f64::NAN)).collect();
            d.set_item(column.name, numbers.into_pyarray(py))?;
        }
    }
    Ok(d)
}
