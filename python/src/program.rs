//! python: the program `windfall` for those who install the package. In: its arguments. Out: its exit code.

use pyo3::prelude::*;
use std::ffi::OsString;
use std::io::{stderr, stdout};

/// Runs the program with these arguments, the first of which is its own name, on the process's own streams. Ctrl-C is not listened for
/// here: verbs that have something to bring to an end listen themselves, the others are ended by the system.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| windfall_cli::run(arguments, &mut stdout().lock(), &mut stderr()))
}
