//! windfall: flights over a planet. In: a planet scenario. Out: truths, their files, each flight in short.

use crate::scenario::is_bundled;
use crate::{Error, Fly, Result};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use windfall_model::planet::PlanetFlight;
use windfall_scenarios::{FileKind, FileSet, kind_of, read_bundled_planet, write_columns_csv, write_resolved_planet};
use windfall_sim::{PlanetEnd, PlanetTruth};

pub use windfall_model::planet::{Atmosphere, Dispersions, Gravity, PlanetScenario, Winds};
pub use windfall_scenarios::{PlanetFile, read_planet};
pub use windfall_sim::{PlanetFlown, fly_planet};

/// What `windfall simulate --json` prints of a planet scenario.
///
/// ```
/// use windfall::planet;
/// let file = planet::read_planet("../scenarios/planet/venus-dispersions.toml".as_ref())?;
/// let said = planet::summary(&file, &[], false);
/// assert!(said.flights.is_empty());
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanetSimulation {
    /// Name of the scenario.
    pub scenario: String,
    /// Each flight.
    pub flights: Vec<PlanetSummary>,
}

/// One flight in short.
///
/// ```no_run
/// use windfall::planet;
/// let file = planet::read_planet("scenarios/planet/venus-dispersions.toml".as_ref())?;
/// let said = planet::summary(&file, &planet::fly(&file, &windfall::Fly::default())?, false);
/// println!("{} after {} s", said.flights[0].end, said.flights[0].end_t_s);
/// # Ok::<(), windfall::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanetSummary {
    /// Its name.
    pub name: String,
    /// Samples of the truth.
    pub samples: usize,
    /// `completed` or `ground`.
    pub end: &'static str,
    /// When, s.
    pub end_t_s: f64,
    /// Steps of the integrator.
    pub steps: u64,
    /// The truth's file, where files were written.
    pub truth: Option<String>,
    /// Velocity over the ground at its end, toward north, east, down, m/s.
    pub end_velocity_ned_m_s: [f64; 3],
}

/// A planet scenario by path or bundled name; none when the word is something else.
///
/// # Errors
/// Every fault of the file.
pub fn find(word: &Path) -> Result<Option<PlanetFile>> {
    if let Some(name) = word.to_str().filter(|_| is_bundled(word)) {
        return Ok(read_bundled_planet(name)?);
    }
    let is_planet = word.is_file() && matches!(kind_of(word), Ok(FileKind::Planet));
    Ok(if is_planet { Some(read_planet(word)?) } else { None })
}

fn truths(s: &PlanetScenario) -> Vec<String> {
    let name = |f: &PlanetFlight| if s.flights.len() == 1 { "truth.csv".to_owned() } else { format!("{}-truth.csv", f.name) };
    s.flights.iter().map(name).collect()
}

/// Names of the files that [`write`] makes.
#[must_use]
pub fn files(file: &PlanetFile) -> Vec<String> {
    let mut all = truths(&file.scenario);
    all.extend(file.tables());
    all.push("scenario.toml".to_owned());
    all
}

/// Flies every flight, on the threads of the current rayon pool.
///
/// # Errors
/// [`Error::Flight`]: a body that cannot be flown, an atmosphere that ends too soon, a flight that failed. [`Error::Request`] for a seed: such
/// a flight has even air and an exact start.
pub fn fly(file: &PlanetFile, request: &Fly) -> Result<Vec<PlanetFlown>> {
    // Every field is named, so that a new one is asked for here.
    let Fly { seed } = request;
    if seed.is_some() {
        let what =
            "seed: a flight over a planet has even air and an exact start, no chance; many with chance are windfall descend's";
        return Err(Error::Request(what.to_owned()));
    }
    let s = &file.scenario;
    let one = |f: &PlanetFlight| fly_planet(s, f).map_err(|error| Error::Flight { name: f.name.clone(), error });
    // All are flown before the first error is taken: which one that is does not depend on threads.
    let all: Vec<Result<PlanetFlown>> = s.flights.par_iter().map(one).collect();
    all.into_iter().collect()
}

/// Writes truths, tables and the resolved scenario into a folder: all of them or, if the process ends before, none.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, file: &PlanetFile, flown: &[PlanetFlown]) -> Result<()> {
    let set = FileSet::new(folder)?;
    for (flown, name) in flown.iter().zip(truths(&file.scenario)) {
        write_truth(&set.stage().join(name), &flown.truth)?;
    }
    write_resolved_planet(&set.stage().join("scenario.toml"), file)?;
    Ok(set.commit(true)?)
}

/// Each flight in short; `written` says whether there are files to name.
#[must_use]
pub fn summary(file: &PlanetFile, flown: &[PlanetFlown], written: bool) -> PlanetSimulation {
    let s = &file.scenario;
    let last = |x: &[f64]| x.last().copied().unwrap_or(0.0);
    let one = |((f, flown), truth): ((&PlanetFlight, &PlanetFlown), String)| {
        let (end, end_t_s, end_velocity_ned_m_s) = match flown.end {
            PlanetEnd::Completed => {
                ("completed", last(&flown.truth.t_s), flown.truth.v_ground_ned.last().copied().unwrap_or_default())
            }
            PlanetEnd::Ground { t_s, v_ground_ned, .. } => ("ground", t_s, v_ground_ned),
        };
        let (name, samples, steps) = (f.name.clone(), flown.truth.len(), flown.steps);
        PlanetSummary { name, samples, end, end_t_s, steps, truth: written.then_some(truth), end_velocity_ned_m_s }
    };
    let flights = s.flights.iter().zip(flown).zip(truths(s)).map(one).collect();
    PlanetSimulation { scenario: s.name.clone(), flights }
}

fn write_truth(path: &Path, truth: &PlanetTruth) -> Result<()> {
    let mut columns: Vec<(&str, Vec<f64>)> = vec![
        ("t_s", truth.t_s.clone()),
        ("altitude_m", truth.place.iter().map(|g| g.height_m).collect()),
        ("latitude_deg", truth.place.iter().map(|g| g.latitude_rad.to_degrees()).collect()),
        ("longitude_deg", truth.place.iter().map(|g| g.longitude_rad.to_degrees()).collect()),
    ];
    for (names, series, angle) in [
        (["v_north_m_s", "v_east_m_s", "v_down_m_s"], &truth.v_ground_ned, false),
        (["roll_deg", "pitch_deg", "yaw_deg"], &truth.attitude_rad, true),
        (["p_deg_s", "q_deg_s", "r_deg_s"], &truth.w_inertial_body, true),
    ] {
        if !series.is_empty() {
            let of = |x: f64| if angle { x.to_degrees() } else { x };
            columns.extend(names.into_iter().enumerate().map(|(k, n)| (n, series.iter().map(|v| of(v[k])).collect())));
        }
    }
    let views: Vec<(&str, &[f64])> = columns.iter().map(|(n, c)| (*n, c.as_slice())).collect();
    Ok(write_columns_csv(path, &views)?)
}
