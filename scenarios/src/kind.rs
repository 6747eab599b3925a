//! scenarios: what a file is. In: a path. Out: campaign, scenario, structure, run, study.

use crate::columns::fault;
use crate::error::ReadError;
use crate::formats;
use crate::free_scenario;
use crate::open::text_of;
use crate::planet;
use std::path::Path;

/// What a file of this program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A campaign.
    Campaign,
    /// A scenario.
    Scenario,
    /// A scenario of a rigid body in free flight.
    FreeFlight,
    /// A planet scenario.
    Planet,
    /// An aerodynamic structure.
    Structure,
    /// A run.
    Run,
    /// A study.
    Study,
}

/// What a file looks like, by its ending and by the tables that only one kind of TOML file has; TOML that fits none is taken for a
/// scenario, whose reader then says what is missing.
///
/// # Errors
/// [`ReadError`] when the file cannot be read or has another ending.
pub fn kind_of(path: &Path) -> Result<FileKind, ReadError> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => {}
        _ if formats::is_run(path) => return Ok(FileKind::Run),
        _ => {
            let what = format!("is not a file of this program; read: .toml, {}", formats::endings());
            return Err(ReadError::Faults(vec![fault(path, None, "", "", &what, "a path with one of these endings")]));
        }
    }
    let text = text_of(path)?;
    let has = |head: &str| text.lines().any(|l| l.trim_start().starts_with(head));
    Ok(if has("[campaign]") || has("[[run]]") {
        FileKind::Campaign
    } else if has("[study]") {
        FileKind::Study
    } else if has("[[term]]") {
        FileKind::Structure
    } else if free_scenario::is_free(&text) {
        FileKind::FreeFlight
    } else if planet::is_planet(&text) {
        FileKind::Planet
    } else {
        FileKind::Scenario
    })
}
