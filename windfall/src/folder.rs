//! windfall: a folder of results. In: the `--out` folder of other commands. Out: its page.

use crate::{Error, Result};
use serde::de::IgnoredAny;
use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use windfall_discover::close::{Closing, Figure, SignalTracks, SmoothingTracks};
use windfall_replay::descent::DescentSummary;
use windfall_report::{FolderResults, PaperFigure, folder_figures, folder_page};
use windfall_scenarios::{FileSet, WriteError, read_json};
use windfall_study::Summary;
use windfall_study::many::ManySummary;

/// Results beside a closing, with their titles and the keys that each has.
const OTHERS: [(&str, &str, &[&str]); 3] = [
    ("identification.json", "Identification", &["method", "data_sets"]),
    ("resimulation.json", "Re-simulation", &["method", "parameters", "trajectory", "statistics", "runs"]),
    ("verify.json", "Checks of the program's own truth", &["verdict", "checks"]),
];
/// Signals over time: of a closing, of an identification, of a re-simulation.
const TRACKS: [&str; 3] = ["tracks.json", "coefficients.json", "flights.json"];
/// Raw and smoothed records: of a closing, of an identification.
const SMOOTHING: [&str; 2] = ["smoothing.json", "records.json"];
/// Keys of a closing against published statistics.
const STATISTICS: &[&str] = &["verdict", "name", "source", "options", "seed"];

/// Files of descents: statistics, a row a draw, the page.
pub const DESCENT_FILES: [&str; 3] = ["descent.json", "descents.parquet", "report.html"];

/// What each figure is written as.
pub const FIGURE_ENDINGS: [&str; 3] = ["svg", "pdf", "csv"];
/// Narrowest and widest figure, mm: labels need the one, no sheet holds more than the other.
pub const FIGURE_WIDTHS_MM: [f64; 2] = [60.0, 400.0];

/// What a folder holds.
///
/// ```no_run
/// use windfall::ResultsFolder;
/// let page = ResultsFolder::read("closed".as_ref())?.page();
/// std::fs::write("closed/report.html", page).expect("written");
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Debug)]
pub struct ResultsFolder {
    title: String,
    closing: Option<Closing>,
    figures: Vec<Figure>,
    tracks: [Option<SignalTracks>; 3],
    smoothing: Option<SmoothingTracks>,
    study: Option<Summary>,
    many: Option<ManySummary>,
    descents: Option<DescentSummary>,
    others: Vec<(String, Value)>,
}

impl ResultsFolder {
    /// Reads `close.json`, `figures.json`, `identification.json`, `resimulation.json`, `verify.json`, `summary.json`, `many.json` and
    /// `descent.json`, those that are there.
    ///
    /// # Errors
    /// A file that is not such a result, a folder without any.
    pub fn read(folder: &Path) -> Result<Self> {
        let mut others = Vec::new();
        let mut closing: Option<Closing> = None;
        if let Some(path) = there(folder, "close.json") {
            // A closing against statistics names its source and no campaign.
            if read_json::<HashMap<String, IgnoredAny>>(&path)?.contains_key("campaign") {
                closing = Some(read_json(&path)?);
            } else {
                let value: Value = read_json(&path)?;
                has_keys(&path, &value, STATISTICS)?;
                others.push(("Closed against published statistics".to_owned(), value));
            }
        }
        let figures = there(folder, "figures.json").map(|p| read_json(&p)).transpose()?.unwrap_or_default();
        for (file, title, keys) in OTHERS {
            if let Some(path) = there(folder, file) {
                let value: Value = read_json(&path)?;
                has_keys(&path, &value, keys)?;
                others.push((title.to_owned(), value));
            }
        }
        let mut tracks = [None, None, None];
        for (place, file) in tracks.iter_mut().zip(TRACKS) {
            *place = there(folder, file).map(|p| read_json(&p)).transpose()?;
        }
        let smoothing = SMOOTHING.iter().find_map(|f| there(folder, f)).map(|p| read_json(&p)).transpose()?;
        let study = there(folder, "summary.json").map(|p| read_json(&p)).transpose()?;
        let many = there(folder, "many.json").map(|p| read_json(&p)).transpose()?;
        let descents = there(folder, DESCENT_FILES[0]).map(|p| read_json(&p)).transpose()?;
        if closing.is_none() && study.is_none() && many.is_none() && descents.is_none() && others.is_empty() {
            let own = ["close.json", "summary.json", "many.json", DESCENT_FILES[0]];
            let known: Vec<&str> = own.into_iter().chain(OTHERS.map(|(f, ..)| f)).collect();
            return Err(Error::NoResult { folder: folder.display().to_string(), known: known.join(", ") });
        }
        let title = folder.canonicalize().ok().and_then(|p| Some(p.file_name()?.to_string_lossy().into_owned()));
        let title = title.unwrap_or_else(|| folder.display().to_string());
        Ok(Self { title, closing, figures, tracks, smoothing, study, many, descents, others })
    }
    /// The page as HTML in one piece.
    #[must_use]
    pub fn page(&self) -> String {
        folder_page(&self.title, &self.results())
    }
    /// Every figure of the page as SVG, PDF and CSV, `width_mm` wide.
    #[must_use]
    pub fn paper_figures(&self, width_mm: f64) -> Vec<PaperFigure> {
        folder_figures(&self.title, &self.results(), width_mm)
    }
    /// Writes those figures into a folder, which is made if missing: all of them, or none. Without `force` nothing is overwritten. Returns
    /// their names without endings.
    ///
    /// # Errors
    /// A width outside [`FIGURE_WIDTHS_MM`], a folder that cannot be written, figures that are there.
    pub fn write_figures(&self, folder: &Path, width_mm: f64, force: bool) -> Result<Vec<String>> {
        let [least, most] = FIGURE_WIDTHS_MM;
        if !(least..=most).contains(&width_mm) {
            return Err(Error::Request(format!("width = {width_mm} mm: allowed: {least} to {most} mm")));
        }
        std::fs::create_dir_all(folder).map_err(|reason| WriteError::Write { path: folder.to_owned(), reason })?;
        let set = FileSet::new(folder)?;
        let figures = self.paper_figures(width_mm);
        for f in &figures {
            for (ending, bytes) in FIGURE_ENDINGS.into_iter().zip([f.svg.as_bytes(), &f.pdf, f.csv.as_bytes()]) {
                let path = set.stage().join(format!("{}.{ending}", f.name));
                std::fs::write(&path, bytes).map_err(|reason| WriteError::Write { path, reason })?;
            }
        }
        set.commit(force)?;
        Ok(figures.into_iter().map(|f| f.name).collect())
    }
    fn results(&self) -> FolderResults<'_> {
        let [tracks, coefficients, flights] = self.tracks.each_ref().map(Option::as_ref);
        FolderResults {
            closing: self.closing.as_ref(),
            figures: &self.figures,
            tracks,
            coefficients,
            flights,
            smoothing: self.smoothing.as_ref(),
            study: self.study.as_ref(),
            many: self.many.as_ref(),
            descents: self.descents.as_ref(),
            others: &self.others,
        }
    }
}

/// A result lacks none of its keys; a file that does was not written by the command of its name.
fn has_keys(path: &Path, value: &Value, keys: &[&str]) -> Result<()> {
    let lacking: Vec<&str> = keys.iter().copied().filter(|k| value.get(k).is_none()).collect();
    if lacking.is_empty() {
        return Ok(());
    }
    Err(Error::NotAResult { path: path.display().to_string(), lacking: lacking.join(", ") })
}

fn there(folder: &Path, file: &str) -> Option<PathBuf> {
    Some(folder.join(file)).filter(|p| p.is_file())
}
