//! windfall: files and the program itself, checked. In: any file of the program. Out: what it is; every check of the program's truth.

use crate::free::FreeFile;
use crate::planet::{PlanetFile, read_planet};
use crate::scenario::is_bundled;
use crate::{Campaign, Drawing, Result, Scenario};
use serde::Serialize;
use std::path::Path;
use windfall_pid::bandwidth::recognised;
use windfall_pid::plausible::{closure, looked};
use windfall_pid::{Envelope, PidError, TestTable, test_table};
use windfall_scenarios::{
    FileKind, Piece, columns_of_campaign, columns_of_run, kind_of, read_bundled, read_free, read_record_pieces, read_structure,
    sensors_of_table_a3,
};
use windfall_verify::{Check, Setups, all_pass, checks};

/// What a file is, checked.
///
/// ```
/// assert_eq!(windfall::check("appendix-c".as_ref())?.kind(), "scenario");
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Debug)]
pub enum Checked {
    /// A run file, in pieces where it has gaps.
    Run(Vec<Piece>),
    /// A campaign whose records make sense.
    Campaign(Box<Campaign>),
    /// An aerodynamic structure.
    Structure(windfall_model::Structure),
    /// A study made ready.
    Study(Box<Drawing>),
    /// A scenario.
    Scenario(Box<Scenario>),
    /// A scenario of a rigid body in free flight.
    FreeFlight(Box<FreeFile>),
    /// A scenario over a planet.
    Planet(Box<PlanetFile>),
}

impl Checked {
    /// Kind of the file, in words.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Run(_) => "run",
            Self::Campaign(_) => "campaign",
            Self::Structure(_) => "structure",
            Self::Study(_) => "study",
            Self::Scenario(_) => "scenario",
            Self::FreeFlight(_) => "scenario in free flight",
            Self::Planet(_) => "planet scenario",
        }
    }
    /// What its reader wants said.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        match self {
            Self::Run(pieces) => pieces.iter().flat_map(|p| p.notes.clone()).collect(),
            Self::Campaign(campaign) => campaign.warnings.clone(),
            Self::Study(drawing) => drawing.warnings().to_vec(),
            Self::Structure(_) | Self::Scenario(_) | Self::FreeFlight(_) | Self::Planet(_) => Vec::new(),
        }
    }
}

/// Reads and checks a file of any kind, or a bundled scenario. A campaign's records are held against physics.
///
/// # Errors
/// Every fault of the file; a record that is not what its campaign says it is.
pub fn check(word: &Path) -> Result<Checked> {
    if is_bundled(word) {
        if let Some(file) = crate::planet::find(word)? {
            return Ok(Checked::Planet(Box::new(file)));
        }
        if let Some(file) = crate::free::find(word)? {
            return Ok(Checked::FreeFlight(Box::new(file)));
        }
        return Ok(Checked::Scenario(Box::new(Scenario::find(word)?)));
    }
    Ok(match kind_of(word)? {
        FileKind::Run => {
            let mut pieces = read_record_pieces(word, &sensors_of_table_a3(), None)?;
            pieces.iter_mut().for_each(|p| p.notes.extend(recognised(&p.record, &sensors_of_table_a3())));
            Checked::Run(pieces)
        }
        FileKind::Campaign => {
            let mut campaign = Campaign::read(word)?;
            let notes = looked(&campaign.data, false)?.notes();
            campaign.warnings.extend(notes);
            Checked::Campaign(Box::new(campaign))
        }
        FileKind::Structure => Checked::Structure(read_structure(word)?),
        FileKind::Study => Checked::Study(Box::new(Drawing::read(word)?)),
        FileKind::Scenario => Checked::Scenario(Box::new(Scenario::read(word)?)),
        FileKind::FreeFlight => Checked::FreeFlight(Box::new(read_free(word)?)),
        FileKind::Planet => Checked::Planet(Box::new(read_planet(word)?)),
    })
}

/// What the runs of a tunnel campaign reached, as in the thesis' Table 5.1, and the same in lines; of a run file lines alone, since it has
/// no vehicle: its c.m. is taken at the tracked origin, its gas as dry air. Nothing of other files.
///
/// # Errors
/// The bundled vehicle cannot be read.
pub fn reached(checked: &Checked) -> Result<(Option<TestTable>, Vec<String>)> {
    match checked {
        Checked::Campaign(campaign) => {
            let table = test_table(&campaign.data);
            let lines = windfall_report::test_table(&table);
            Ok(((!table.runs.is_empty()).then_some(table), lines))
        }
        Checked::Run(pieces) => {
            let mut plant = read_bundled("appendix-c")?.declared_plant;
            plant.vehicle.diameter_m = 1.0;
            let one = |p: &Piece| piece_line(Envelope::of_record(&p.record, &plant));
            Ok((None, pieces.iter().map(one).collect()))
        }
        _ => Ok((None, Vec::new())),
    }
}

/// What a run file reached; its Reynolds number is that of a metre.
fn piece_line(reached: std::result::Result<Envelope, PidError>) -> String {
    match reached {
        Ok(e) => format!(
            "reached: α_T {:.1} deg, |p| {:.1}, |q| {:.1}, |r| {:.1} deg/s, V_∞ {:.2} to {:.2} m/s{} (c.m. taken at the tracked origin)",
            e.max_alpha_t_deg,
            e.max_p_deg_s,
            e.max_q_deg_s,
            e.max_r_deg_s,
            e.speed_m_s[0],
            e.speed_m_s[1],
            e.reynolds_number.map_or_else(String::new, |r| format!(", Reynolds number {r:.2e} per metre")),
        ),
        Err(e) => format!("angles and rates: not said: {e}"),
    }
}

/// What was done to every column of a run file or of a campaign's runs, and how well the equations of motion close on them.
///
/// # Errors
/// A run file that cannot be read.
pub fn looked_at(word: &Path, checked: &Checked) -> Result<Vec<String>> {
    match checked {
        Checked::Run(_) => Ok(columns_of_run(word)?),
        Checked::Campaign(campaign) => {
            let mut lines = columns_of_campaign(word)?;
            lines.push(physics(campaign));
            Ok(lines)
        }
        _ => Ok(Vec::new()),
    }
}

fn physics(campaign: &Campaign) -> String {
    let all = closure(&campaign.data);
    if all.is_empty() {
        return "physics: not looked at before a fit (bodies without attitude, in free flight or on a pivot)".to_owned();
    }
    let one = |c: &windfall_pid::plausible::Closure| {
        format!(
            "{:.0} % of the {} ({:.3} of {:.3} {})",
            100.0 * c.left / c.signal.max(f64::MIN_POSITIVE),
            c.group,
            c.left,
            c.signal,
            c.unit
        )
    };
    format!(
        "physics: looked at, no gross fault; the declared structure, fitted to all runs, leaves of the accelerations {}",
        all.iter().map(one).collect::<Vec<_>>().join(", ")
    )
}

/// The content of `verify.json`.
///
/// ```no_run
/// let all = windfall::verify()?;
/// assert!(all.passed());
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// `pass` or `fail`.
    pub verdict: &'static str,
    /// Figure beside bound.
    pub checks: Vec<Check>,
}

impl Verification {
    /// Whether every check passed.
    #[must_use]
    pub fn passed(&self) -> bool {
        all_pass(&self.checks)
    }
}

/// Every check of the program's own truth: exact, published, recovered.
///
/// # Errors
/// A bundled flight that cannot be flown or identified.
pub fn verify() -> Result<Verification> {
    let [appendix_c, pole_push, full_scale, combined] =
        ["appendix-c", "pole-push", "full-scale-venus-20km", "sage-combined"].map(read_bundled);
    let (appendix_c, pole_push) = (appendix_c?.scenario, pole_push?.scenario);
    let (full_scale, combined) = (full_scale?.scenario, combined?.scenario);
    let setups = Setups { appendix_c: &appendix_c, pole_push: &pole_push, full_scale: &full_scale, combined: &combined };
    let checks = checks(&setups)?;
    Ok(Verification { verdict: if all_pass(&checks) { "pass" } else { "fail" }, checks })
}
