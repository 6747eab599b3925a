//! cli: words, paths and exit codes. In: arguments. Out: results on standard output and in files, talk on standard error.
//!
//! Nothing is decided here: commands read their input, open their outputs, call `windfall` and print what it returns.
//! Exit codes: 0 done; 1 done, and the verdict is no; 2 bad input or usage; 3 numerical failure; 130 interrupted.

mod args;
mod check;
mod close;
mod descend;
mod first;
mod fitted;
mod free;
mod identify;
mod interrupt;
mod lines;
mod many;
mod plan;
mod planet;
mod report;
mod resimulate;
mod session;
mod simulate;
mod structure;
#[cfg(test)]
mod stubs;
mod study;
mod verify;
mod wind_tunnel;

/// What verbs print of their results on standard output.
pub mod printed {
    pub use crate::close::words as closing;
    pub use crate::descend::words as descent;
    pub use crate::identify::words as identification;
    pub use crate::many::words as many;
    pub use crate::plan::words as plan;
    pub use crate::resimulate::words as resimulation;
    pub use crate::structure::words as structure;
    pub use crate::study::words as study;
    pub use crate::verify::words as verification;
    pub use windfall::results::statistics_table as closing_against_statistics;
}

use anyhow::Context as _;
use args::{Cli, Command};
use clap::{CommandFactory as _, Parser as _};
use session::{Failure, Session};
use std::ffi::OsString;
use std::io::Write;

/// Runs the program with these arguments (the first is its own name); returns the exit code.
///
/// ```
/// let (mut out, mut err) = (Vec::new(), Vec::new());
/// assert_eq!(windfall_cli::run(["windfall", "check", "appendix-c"], &mut out, &mut err), 0);
/// assert!(String::from_utf8_lossy(&out).contains("CA_T0"));
/// ```
pub fn run<I, T>(args: I, out: &mut dyn Write, err: &mut dyn Write) -> u8
where
    I: IntoIterator<Item = T>,
    T: Into<OsString> + Clone,
{
    let cli = match Cli::try_parse_from(args) {
        Ok(cli) => cli,
        Err(e) => {
            let code = u8::try_from(e.exit_code()).unwrap_or(2);
            let text = e.render();
            // Nowhere is left to report a closed pipe to.
            let _ = if code == 0 { write!(out, "{text}") } else { write!(err, "{text}") };
            return code;
        }
    };
    let common = cli.command.common().cloned().unwrap_or_default();
    let mut session = Session { common, out, err };
    match dispatch(&cli.command, &mut session) {
        Ok(true) => 0,
        Ok(false) => 1,
        Err(failure) => {
            session.complain(&failure);
            failure.exit_code()
        }
    }
}

/// True when the verdict is yes.
fn dispatch(command: &Command, session: &mut Session<'_>) -> Result<bool, Failure> {
    match command {
        Command::Simulate(a) => simulate::run(a, session),
        Command::Identify(a) => identify::run(a, session),
        Command::Structure(a) => structure::run(a, session),
        Command::Plan(a) => plan::run(a, session),
        Command::Resimulate(a) => resimulate::run(a, session),
        Command::Descend(a) => descend::run(a, session),
        Command::Close(a) => close::run(a, session),
        Command::Study(a) => study::run(a, session),
        Command::Many(a) => many::run(a, session),
        Command::Report(a) => report::run(a, session),
        Command::Verify(a) => verify::run(a, session),
        Command::Check(a) => check::run(a, session),
        Command::Init(a) => first::init(a, session),
        Command::Explain(a) => first::explain(a, session),
        Command::Manual { folder } => {
            std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot be made a folder", folder.display()))?;
            clap_mangen::generate_to(Cli::command(), folder)
                .with_context(|| format!("{}: cannot be written", folder.display()))?;
            Ok(true)
        }
        Command::Completions { shell } => {
            // Into memory first: the generator panics where a reader goes away.
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "windfall", &mut script);
            session.print(&String::from_utf8_lossy(&script))?;
            Ok(true)
        }
    }
}
