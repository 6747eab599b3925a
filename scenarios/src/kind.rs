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

/// Refuses a file that is plainly of another kind than is needed, before its keys are looked at one by one. What cannot be told is left to its reader.
///
/// # Errors
/// [`ReadError`] that says what the file is, what is needed, and which command makes the one from the other.
pub fn must_be(path: &Path, wanted: FileKind) -> Result<(), ReadError> {
    let Some(found) = plainly(path)?.filter(|f| *f != wanted) else { return Ok(()) };
    let what = format!("is {}; needed here: {}", found.words(), wanted.words());
    Err(ReadError::Faults(vec![fault(path, None, "", "", &what, &found.way(wanted, path))]))
}

/// What a file is by its ending or by a table that only one kind has; none where neither tells.
fn plainly(path: &Path) -> Result<Option<FileKind>, ReadError> {
    if !path.is_file() {
        return Ok(None);
    }
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
        return Ok(formats::is_run(path).then_some(FileKind::Run));
    }
    let kind = kind_of(path)?;
    let text = text_of(path)?;
    let own = ["[scenario]", "[[flight]]"];
    let is_known = kind != FileKind::Scenario || text.lines().any(|l| own.iter().any(|head| l.trim_start().starts_with(head)));
    Ok(is_known.then_some(kind))
}

impl FileKind {
    /// What such a file is, in words.
    fn words(self) -> &'static str {
        match self {
            Self::Campaign => "a campaign file (.toml), which declares a vehicle and names its runs",
            Self::Scenario => "a scenario (.toml), which describes flights to simulate",
            Self::FreeFlight => "a scenario in free flight (.toml), which describes flights to simulate",
            Self::Planet => "a planet scenario (.toml), which describes flights to simulate",
            Self::Structure => "a structure file (.toml), which lists aerodynamic terms",
            Self::Run => "a run file, which holds the samples of one run",
            Self::Study => "a study file (.toml), which says what to draw many times",
        }
    }
    /// The command that makes what is wanted of such a file, or takes it as it is.
    fn way(self, wanted: Self, path: &Path) -> String {
        let path = path.display();
        match (self, wanted) {
            (Self::Run, _) => format!("windfall init DIR {path} writes a campaign file for it, DIR/campaign.toml"),
            (Self::Scenario | Self::FreeFlight, Self::Campaign) => {
                format!("windfall simulate {path} --out DIR writes its runs and a campaign file, DIR/campaign.toml")
            }
            (Self::Campaign, _) => format!("windfall close {path}, or another verb that takes a campaign"),
            (Self::Scenario | Self::FreeFlight | Self::Planet, _) => format!("windfall simulate {path} --out DIR"),
            (Self::Study, _) => format!("windfall study {path} --out DIR"),
            (Self::Structure, _) => "name it in a campaign or scenario: [aero.NAME] structure = \"FILE\"".to_owned(),
        }
    }
}
