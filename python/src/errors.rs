//! python: exceptions. In: errors of the facade. Out: one exception class for each room that they come from.

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use windfall::ReadError as Read;

create_exception!(windfall, WindfallError, PyException, "Any error of Windfall.");
create_exception!(
    windfall,
    ReadError,
    WindfallError,
    "A file is wrong; `faults` has file, line, key, value, allowed, remedy of each."
);
create_exception!(windfall, WriteError, WindfallError, "A file cannot be written.");
create_exception!(windfall, SimulateError, WindfallError, "A flight cannot be flown, or failed.");
create_exception!(windfall, IdentifyError, WindfallError, "A campaign cannot be identified.");
create_exception!(windfall, LoopError, WindfallError, "The loop cannot be closed on this campaign.");
create_exception!(windfall, StudyError, WindfallError, "A folder of results is in the way: changed, corrupt, busy, incomplete.");

/// An error on its way to Python.
pub(crate) enum Raised {
    Windfall(windfall::Error),
    Study(String),
    Argument(String),
}

macro_rules! from {
    ($($source:ty),+) => {
        $(impl From<$source> for Raised {
            fn from(e: $source) -> Self {
                Self::Windfall(e.into())
            }
        })+
    };
}
from!(windfall::Error, windfall::StoreError, Read);

impl From<rayon::ThreadPoolBuildError> for Raised {
    fn from(e: rayon::ThreadPoolBuildError) -> Self {
        Self::Study(format!("threads cannot be started ({e})"))
    }
}
impl From<serde_json::Error> for Raised {
    fn from(e: serde_json::Error) -> Self {
        // Where in the text it is says nothing to those who gave words and numbers.
        let text = e.to_string();
        let what = text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what);
        Self::Argument(format!("is not such a request or result: {what}"))
    }
}

impl From<Raised> for PyErr {
    fn from(e: Raised) -> Self {
        use windfall::Error as Of;
        let e = match e {
            Raised::Windfall(e) => e,
            Raised::Study(text) => return StudyError::new_err(text),
            Raised::Argument(text) => return pyo3::exceptions::PyValueError::new_err(text),
        };
        let text = e.to_string();
        match e {
            Of::Read(e) => read_error(&e),
            Of::Write(_) => WriteError::new_err(text),
            Of::Flight { .. } | Of::Simulate(_) => SimulateError::new_err(text),
            Of::Identify(_) => IdentifyError::new_err(text),
            Of::Replay(_) | Of::Discover(_) | Of::Study(_) | Of::Verify(_) => LoopError::new_err(text),
            Of::Request(_) | Of::Find(_) => pyo3::exceptions::PyValueError::new_err(text),
            Of::Store(_) | Of::NoColumn { .. } | Of::NoPart { .. } | Of::Interrupted => StudyError::new_err(text),
            _ => WindfallError::new_err(text),
        }
    }
}

fn read_error(e: &Read) -> PyErr {
    let error = ReadError::new_err(e.to_string());
    // Without its list the exception still says all in words.
    let listed = Python::attach(|py| -> PyResult<()> {
        let faults = PyList::empty(py);
        for f in e.faults() {
            let d = PyDict::new(py);
            d.set_item("file", f.file.display().to_string())?;
            d.set_item("line", f.line)?;
            d.set_item("key", &f.key)?;
            d.set_item("value", &f.value)?;
            d.set_item("allowed", &f.allowed)?;
            d.set_item("remedy", &f.remedy)?;
            faults.append(d)?;
        }
        error.value(py).setattr("faults", faults)
    });
    listed.err().unwrap_or(error)
}

pub(crate) fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = m.py();
    m.add("WindfallError", py.get_type::<WindfallError>())?;
    m.add("ReadError", py.get_type::<ReadError>())?;
    m.add("WriteError", py.get_type::<WriteError>())?;
    m.add("SimulateError", py.get_type::<SimulateError>())?;
    m.add("IdentifyError", py.get_type::<IdentifyError>())?;
    m.add("LoopError", py.get_type::<LoopError>())?;
    m.add("StudyError", py.get_type::<StudyError>())
}
