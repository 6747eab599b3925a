//! cli: what every command shares. In: common flags and streams. Out: messages, opened outputs, failures with their exit code.

use crate::args::Common;
use anyhow::{Context as _, anyhow};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::{IsTerminal as _, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use windfall::files::{FileSet, json_text, settle, text_atomically, write_json_atomically};
use windfall::{Campaign, ErrorKind, Flights, Fly, Scenario};

/// Why a command gave no result, and whose fault that is.
#[derive(Debug)]
pub(crate) struct Failure {
    kind: ErrorKind,
    error: anyhow::Error,
}

impl Failure {
    pub(crate) fn numerical(error: anyhow::Error) -> Self {
        Self { kind: ErrorKind::Numerical, error }
    }
    pub(crate) fn exit_code(&self) -> u8 {
        match self.kind {
            ErrorKind::Input => 2,
            ErrorKind::Numerical => 3,
            ErrorKind::Interrupted => crate::interrupt::EXIT_CODE,
        }
    }
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        let error = error.into();
        // What is no error of the program's own is of the paths and streams that it was given.
        let kind = error.downcast_ref::<windfall::Error>().map_or(ErrorKind::Input, windfall::Error::kind);
        Self { kind, error }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
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
    /// Several of them.
    pub(crate) fn warn_all(&mut self, lines: &[String]) {
        lines.iter().for_each(|l| self.warn(l));
    }
    pub(crate) fn complain(&mut self, failure: &Failure) {
        let _ = writeln!(self.err, "error: {:#}", failure.error);
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
    pub(crate) fn print_json(&mut self, value: &impl Serialize) -> Result<(), Failure> {
        let text = json_text(value).context("result as JSON")?;
        self.print(&text)
    }
    /// Hands over the one result of a command: into its file where a folder is open, as JSON or words on standard output.
    pub(crate) fn deliver(
        &mut self,
        folder: Option<&Path>,
        file: &str,
        result: &impl Serialize,
        words: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        self.write(folder, |stage| Ok(write_json_atomically(&stage.join(file), result)?))?;
        self.show(result, words)?;
        self.written(folder, &[file]);
        Ok(())
    }
    /// [`Session::deliver`] with series over time beside the result: the first file is the result's, the others have these texts.
    pub(crate) fn deliver_with(
        &mut self,
        folder: Option<&Path>,
        files: &[&str],
        (result, beside): (&impl Serialize, &[String]),
        words: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        self.write(folder, |stage| {
            write_json_atomically(&stage.join(files[0]), result)?;
            let texts = files[1..].iter().zip(beside).map(|(file, text)| text_atomically(&stage.join(file), text));
            Ok(texts.collect::<Result<(), _>>()?)
        })?;
        self.show(result, words)?;
        self.written(folder, files);
        Ok(())
    }
    /// Writes the files of a command: all of them, or none. Without `--force` nothing is overwritten, also nothing that another process
    /// wrote while this one worked.
    pub(crate) fn write(&self, folder: Option<&Path>, write: impl FnOnce(&Path) -> windfall::Result<()>) -> Result<(), Failure> {
        let Some(folder) = folder else { return Ok(()) };
        let set = FileSet::new(folder)?;
        write(set.stage())?;
        Ok(set.commit(self.common.force)?)
    }
    /// A result on standard output, as JSON or words.
    pub(crate) fn show(&mut self, result: &impl Serialize, words: impl FnOnce() -> String) -> Result<(), Failure> {
        if self.common.json { self.print_json(result) } else { self.print(&words()) }
    }
    /// Says which files are in the folder now, or that there are none and how to have them.
    pub(crate) fn written(&mut self, folder: Option<&Path>, files: &[&str]) {
        match folder {
            Some(folder) => self.say(&format!("written to {}: {}", folder.display(), files.join(", "))),
            None if self.common.json => {}
            None => self.say(&format!("nothing is written; --out DIR writes {}", listed(files))),
        }
    }
    /// Reads a campaign and says what its reader had to say.
    pub(crate) fn campaign(&mut self, path: &Path) -> Result<Campaign, Failure> {
        let campaign = Campaign::read(path)?;
        self.warn_all(&campaign.warnings);
        Ok(campaign)
    }
    /// Flies a scenario with a bar over its flights.
    pub(crate) fn fly(&self, scenario: &Scenario, request: &Fly) -> Result<Flights, Failure> {
        let bar = self.bar("flying", scenario.file.scenario.flights.len());
        let flown = self.pool()?.install(|| scenario.fly_seen(request, || bar.inc(1)));
        bar.finish_and_clear();
        Ok(flown?)
    }
    /// Works on as many threads as were asked for, with a spinner.
    pub(crate) fn work<T: Send>(&self, what: &str, work: impl FnOnce() -> windfall::Result<T> + Send) -> Result<T, Failure> {
        let spinner = self.spinner(what);
        let done = self.pool()?.install(work);
        spinner.finish_and_clear();
        Ok(done?)
    }
    /// Opens the outputs before the work: makes the folder, refuses to overwrite. `None` without `--out`: then nothing is written.
    pub(crate) fn outputs(&mut self, files: &[&str]) -> Result<Option<PathBuf>, Failure> {
        let Some(folder) = self.common.out.clone() else { return Ok(None) };
        std::fs::create_dir_all(&folder).with_context(|| format!("--out {}: cannot be made a folder", folder.display()))?;
        settle(&folder)?;
        let taken: Vec<&str> = files.iter().copied().filter(|f| folder.join(f).symlink_metadata().is_ok()).collect();
        if !taken.is_empty() && !self.common.force {
            let list = taken.join(", ");
            return Err(anyhow!("{}: {list} exists and is not overwritten; try: --out DIR or --force", folder.display()).into());
        }
        Ok(Some(folder))
    }
    /// A spinner on a terminal; nothing elsewhere.
    fn spinner(&self, what: &str) -> ProgressBar {
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
        ProgressBar::new(n as u64).with_style(style("{prefix} {bar:30} {pos}/{len} {eta}")).with_prefix(what)
    }
    /// The same with a message beside it.
    pub(crate) fn telling_bar(&self, what: &'static str, n: usize) -> ProgressBar {
        self.bar(what, n).with_style(style("{prefix} {bar:30} {pos}/{len}, {eta} left  {msg}"))
    }
    /// Folder of results that another run may go on with: `--out`, or for JSON alone a temporary one, which lives as long as the second.
    ///
    /// # Errors
    /// No `--out` where the work is kept as it goes on: what is made in hours is not to be lost for a flag.
    pub(crate) fn resumable(&self, is_part: bool) -> Result<(PathBuf, Option<tempfile::TempDir>), Failure> {
        match &self.common.out {
            Some(folder) => Ok((folder.clone(), None)),
            None if self.common.json && !is_part => {
                let temporary = tempfile::tempdir()?;
                Ok((temporary.path().to_owned(), Some(temporary)))
            }
            None => Err(anyhow!("needs a folder, where results are kept as they are made; try: --out DIR").into()),
        }
    }
    /// Threads as many as were asked for.
    pub(crate) fn pool(&self) -> Result<rayon::ThreadPool, Failure> {
        let threads = usize::from(self.common.threads.unwrap_or(0));
        Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build().context("threads")?)
    }
}

/// Files in a line; of very many the first.
fn listed(files: &[&str]) -> String {
    match files {
        [first, second, .., last] if files.len() > 6 => format!("{} files, {first}, {second} to {last}", files.len()),
        files => files.join(", "),
    }
}
