//! cli: the `windfall` program. In: arguments. Out: an exit code.

use std::io::{stderr, stdout};
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(windfall_cli::run(std::env::args_os(), &mut stdout().lock(), &mut stderr()))
}
