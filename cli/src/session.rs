//! cli: what every command shares. In: common flags and streams. Out: messages, opened outputs, failures with their exit code.

use crate::args::Common;
use anyhow::{Context as _, anyhow};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal as _, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use windfall_pid::PidError;
use windfall_scenarios::{FileKind, PlanetFile, ScenarioFile, json_text, kind_of, read_planet, write_json_atomically};
use windfall_sim::SimError;
use windfall_verify::VerifyError;

/// Why a command gave no result.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad input or usage.
    Input(anyhow::Error),
    /// The numbers failed.
    Numerical(anyhow::Error),
    /// Somebody pressed Ctrl-C.
    Interrupted(anyhow::Error),
}

impl Failure {
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Numerical(_) => 3,
            Self::Interrupted(_) => crate::interrupt::EXIT_CODE,
        }
    }
    /// A simulator's error: a number that cannot be flown, or an atmosphere that ends too soon, is bad input, the rest is numerical.
    pub(crate) fn of_flight(name: &str, error: SimError) -> Self {
        let numerical = is_numerical(&error);
        Self::of(numerical, anyhow::Error::new(error).context(format!("flight {name}")))
    }
    /// An error of the loop: numerical when a flight failed or a search has no answer, bad input otherwise.
    pub(crate) fn of_verification(error: VerifyError) -> Self {
        match error {
            VerifyError::Identify(e) => Self::of_identification(e),
            other => Self::of(matches!(&other, VerifyError::Simulate(e) if is_numerical(e)), other.into()),
        }
    }
    /// An identifier's error: a search without an answer is numerical, the rest is bad input.
    pub(crate) fn of_identification(error: PidError) -> Self {
        Self::of(matches!(error, PidError::NoAnswer { .. }), error.into())
    }
    fn of(numerical: bool, error: anyhow::Error) -> Self {
        if numerical { Self::Numerical(error) } else { Self::Input(error) }
    }
}

fn is_numerical(error: &SimError) -> bool {
    !matches!(error, SimError::Setup { .. } | SimError::OutsideAtmosphere { .. })
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Input(error.into())
    }
}

/// Flags and streams of one command.
pub(crate) struct Session<'w> {
    pub(crate) common: Common,
    pub(crate) out: &'w mut dyn Write,
    pub(crate) err: &'w mut dyn Write,
}

impl Session<'_> {
    /// One line of talk.
    pub(crate) fn say(&mut self, line: &str) {
        if !self.common.quiet {
            // A closed standard error leaves nowhere to say so.
            let _ = writeln!(self.err, "{line}");
        }
    }
    /// A cause and a next step; printed even when quiet.
    pub(crate) fn warn(&mut self, line: &str) {
        let _ = writeln!(self.err, "warning: {line}");
    }
    pub(crate) fn complain(&mut self, failure: &Failure) {
        let (Failure::Input(error) | Failure::Numerical(error) | Failure::Interrupted(error)) = failure;
        let _ = writeln!(self.err, "error: {error:#}");
    }
    /// Text on standard output.
    pub(crate) fn print(&mut self, text: &str) -> Result<(), Failure> {
        match self.out.write_all(text.as_bytes()).and_then(|()| self.out.flush()) {
            // A reader that has seen enough (`| head`) is no failure.
            Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
            other => Ok(other.context("standard output")?),
        }
    }
    /// A result as JSON on standard output.
    pub(crate) fn print_json(&mut self, value: &impl serde::Serialize) -> Result<(), Failure> {
        let text = json_text(value).context("result as JSON")?;
        self.print(&text)
    }
    /// Hands over the one result of a command: into its file where a folder is open, as JSON or words on standard output.
    pub(crate) fn deliver(
        &mut self,
        folder: Option<&Path>,
        file: &str,
        result: &impl serde::Serialize,
        words: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        if let Some(folder) = folder {
            write_json_atomically(&folder.join(file), result)?;
        }
        if self.common.json {
            self.print_json(result)?;
        } else {
            self.print(&words())?;
        }
        if let Some(folder) = folder {
            self.say(&format!("written: {}", folder.join(file).display()));
        }
        Ok(())
    }
    /// Opens the outputs before the work: makes the folder, refuses to overwrite. `None` when nothing is to be written.
    pub(crate) fn outputs(&mut self, files: &[String]) -> Result<Option<PathBuf>, Failure> {
        if self.common.out.is_none() && self.common.json {
            return Ok(None);
        }
        let folder = self.common.out.clone().unwrap_or_else(|| PathBuf::from("."));
        std::fs::create_dir_all(&folder).with_context(|| format!("--out {}: cannot be made a folder", folder.display()))?;
        let taken: Vec<&str> = files.iter().filter(|f| folder.join(f).exists()).map(String::as_str).collect();
        if !taken.is_empty() && !self.common.force {
            let list = taken.join(", ");
            return Err(anyhow!("{}: {list} exists and is not overwritten; try: --out DIR or --force", folder.display()).into());
        }
        Ok(Some(folder))
    }
    /// A spinner on a terminal; nothing elsewhere.
    pub(crate) fn spinner(&self, what: &str) -> ProgressBar {
        if self.common.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new_spinner().with_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }
    /// A bar over `n` pieces of work on a terminal; nothing elsewhere.
    pub(crate) fn bar(&self, what: &'static str, n: usize) -> ProgressBar {
        if self.common.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let style =
            ProgressStyle::with_template("{prefix} {bar:30} {pos}/{len} {eta}").unwrap_or_else(|_| ProgressStyle::default_bar());
        ProgressBar::new(n as u64).with_style(style).with_prefix(what)
    }
    /// Threads as many as were asked for.
    pub(crate) fn pool(&self) -> Result<rayon::ThreadPool, Failure> {
        let threads = usize::from(self.common.threads.unwrap_or(0));
        Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("threads")?)
    }
}

/// True for a word that is no file and looks like none: then it is a bundled scenario's name, right or wrong.
pub(crate) fn is_bundled(word: &Path) -> bool {
    !word.is_file() && word.to_str().is_some_and(|w| !w.contains(['/', '\\', '.']))
}

/// A scenario by path or bundled name.
pub(crate) fn scenario(word: &Path) -> Result<ScenarioFile, Failure> {
    let name = word.to_str().filter(|_| is_bundled(word));
    Ok(match name {
        Some(name) => windfall_scenarios::read_bundled(name)?,
        None => windfall_scenarios::read_scenario_file(word)?,
    })
}

/// A planet scenario by path; none when the word is something else.
pub(crate) fn planet_scenario(word: &Path) -> Result<Option<PlanetFile>, Failure> {
    let is_planet = word.is_file() && matches!(kind_of(word), Ok(FileKind::Planet));
    Ok(if is_planet { Some(read_planet(word)?) } else { None })
}
