//! windfall: descents of an identified model. In: a planet scenario, an identification. Out: statistics, a row a draw, their files.

use crate::folder::{DESCENT_FILES, ResultsFolder};
use crate::planet::find;
use crate::{Descend, Error, Result};
use std::path::Path;
use windfall_model::planet::PlanetFlight;
use windfall_pid::Identification;
use windfall_replay::descent::{Descended, descend};
use windfall_scenarios::{
    BUNDLED_PLANETS, FileSet, PlanetFile, bytes_atomically, part_bytes, text_atomically, write_json_atomically,
};

/// Seed where neither the request nor the scenario has one.
const SEED: u64 = 1;

/// A planet scenario whose flight is flown down many times.
///
/// ```no_run
/// use windfall::{Descend, DescentScenario};
/// let scenario = DescentScenario::read("scenarios/planet/venus-dispersions.toml".as_ref())?;
/// let flown = scenario.descend(None, &Descend { draws: 100, ..Descend::default() }, || {})?;
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DescentScenario {
    /// The scenario.
    pub file: PlanetFile,
}

impl DescentScenario {
    /// Reads a planet scenario by path, or a bundled one by name.
    ///
    /// # Errors
    /// Every fault of the file; a file that is none.
    pub fn read(path: &Path) -> Result<Self> {
        let file = find(path)?.ok_or_else(|| {
            if !path.is_file() {
                let what = format!("is neither a file nor a bundled planet scenario; bundled: {}", BUNDLED_PLANETS.join(", "));
                return Error::Request(format!("{}: {what}", path.display()));
            }
            let what = "is no planet scenario: descents need [environment] gravity and a flight with [flight.initial]";
            Error::Request(format!("{}: {what}; try: windfall check on it", path.display()))
        })?;
        Ok(Self { file })
    }
    /// Flies it down. `see` is called after each descent.
    ///
    /// # Errors
    /// A request for what cannot be, an identification of another structure or without covariance, a nominal model that cannot be flown.
    pub fn descend(&self, found: Option<&Identification>, request: &Descend, see: impl Fn() + Sync) -> Result<Descended> {
        let order = request.order(self.file.seed.unwrap_or(SEED))?;
        Ok(descend(&self.file.scenario, self.flight(request)?, found, order, see)?)
    }
    fn flight(&self, request: &Descend) -> Result<&PlanetFlight> {
        let flights = &self.file.scenario.flights;
        let Some(name) = &request.flight else {
            return flights.first().ok_or_else(|| Error::Request("the scenario has no flight; add [[flight]]".to_owned()));
        };
        flights.iter().find(|f| f.name == *name).ok_or_else(|| {
            let names: Vec<&str> = flights.iter().map(|f| f.name.as_str()).collect();
            Error::Request(format!("flight {name}: the scenario has none of that name; allowed: {}", names.join(", ")))
        })
    }
}

/// Writes [`DESCENT_FILES`] into a folder.
///
/// # Errors
/// A file that cannot be written.
pub fn write_descents(folder: &Path, descended: &Descended) -> Result<()> {
    write_json_atomically(&folder.join(DESCENT_FILES[0]), &descended.summary)?;
    let bytes = part_bytes(&descended.columns, &descended.rows)?;
    bytes_atomically(&folder.join(DESCENT_FILES[1]), &bytes)?;
    // Of what was written, so that `windfall report` makes the same page of it.
    Ok(text_atomically(&folder.join(DESCENT_FILES[2]), &ResultsFolder::read(folder)?.page())?)
}

/// Puts [`DESCENT_FILES`] into a folder, made if missing: all of them, or none. Without `force` nothing is overwritten.
///
/// # Errors
/// Results that would be overwritten, a file that cannot be written.
pub fn put_descents(folder: &Path, descended: &Descended, force: bool) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::Request(format!("{}: cannot be made a folder: {e}", folder.display())))?;
    let set = FileSet::new(folder)?;
    write_descents(set.stage(), descended)?;
    Ok(set.commit(force)?)
}
