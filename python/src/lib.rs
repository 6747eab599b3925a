//! python: the facade for Python, and the program. In: paths, numbers, NumPy arrays, arguments. Out: NumPy arrays and JSON; every error
//! as an exception of its own; the program's exit code.
//!
//! Private: `python/py/windfall/__init__.py` is what users see. The interpreter's lock is released while the rooms work, and
//! Ctrl-C is listened for.

mod campaign;
mod errors;
mod files;
mod many;
mod program;
mod study;
mod threads;

use pyo3::prelude::*;

/// The private native module.
#[pymodule]
fn _windfall(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("__version__", env!("CARGO_PKG_VERSION"))?;
    m.add("MOST_THREADS", windfall::MOST_THREADS)?;
    errors::register(m)?;
    m.add_class::<campaign::PyCampaign>()?;
    m.add_class::<study::PyStudy>()?;
    m.add_class::<many::PyMany>()?;
    m.add_function(wrap_pyfunction!(campaign::simulate, m)?)?;
    m.add_function(wrap_pyfunction!(files::check, m)?)?;
    m.add_function(wrap_pyfunction!(files::verify, m)?)?;
    m.add_function(wrap_pyfunction!(files::close_statistics, m)?)?;
    m.add_function(wrap_pyfunction!(files::descend, m)?)?;
    m.add_function(wrap_pyfunction!(files::page, m)?)?;
    m.add_function(wrap_pyfunction!(files::keys, m)?)?;
    m.add_function(wrap_pyfunction!(files::write_columns, m)?)?;
    m.add_function(wrap_pyfunction!(files::init, m)?)?;
    m.add_function(wrap_pyfunction!(files::explain, m)?)?;
    m.add_function(wrap_pyfunction!(program::run_program, m)?)?;
    m.add_function(wrap_pyfunction!(study::read_runs, m)?)
}
