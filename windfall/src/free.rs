//! windfall: scenarios of rigid bodies in free flight. In: a scenario by path or name. Out: records and truths, the campaign that they make.

use crate::scenario::is_bundled;
use crate::{Error, FlightSummary, Fly, Result, Simulation};
use rayon::prelude::*;
use std::path::Path;
use windfall_model::PointRecord;
use windfall_scenarios::{
    FileKind, FileSet, FreeOrder, RunLine, kind_of, read_bundled_free, read_free, write_columns_csv, write_free_campaign,
    write_resolved_free,
};
use windfall_sim::{FreeFlown, Seed, record_free};

pub use windfall_scenarios::FreeFile;

const CAMPAIGN: &str = "campaign.toml";
const RESOLVED: &str = "scenario.toml";

/// Such a scenario by path or bundled name; none when the word is something else.
///
/// # Errors
/// Every fault of the file.
pub fn find(word: &Path) -> Result<Option<FreeFile>> {
    if let Some(name) = word.to_str().filter(|_| is_bundled(word)) {
        return Ok(read_bundled_free(name)?);
    }
    let is_free = word.is_file() && matches!(kind_of(word), Ok(FileKind::FreeFlight));
    Ok(if is_free { Some(read_free(word)?) } else { None })
}

/// Names of record and truth of a flight.
fn names(file: &FreeFile, f: &FreeOrder) -> [String; 2] {
    if file.flights.len() == 1 {
        return ["run.csv".to_owned(), "truth.csv".to_owned()];
    }
    [format!("{}.csv", f.name), format!("{}-truth.csv", f.name)]
}

/// Names of the files that [`write`] makes.
#[must_use]
pub fn files(file: &FreeFile) -> Vec<String> {
    let all = file.flights.iter().flat_map(|f| names(file, f));
    all.chain([CAMPAIGN.to_owned(), RESOLVED.to_owned()]).collect()
}

/// Flies every flight, effects included, on the threads of the current rayon pool; the scenario then has the seed that was asked for.
///
/// # Errors
/// [`Error::Flight`]: a body that cannot be flown, or a flight that failed.
pub fn fly(file: &mut FreeFile, request: &Fly) -> Result<Vec<FreeFlown>> {
    // Every field is named, so that a new one is asked for here.
    let Fly { seed } = request;
    file.seed = seed.unwrap_or(file.seed);
    let one = |(i, f): (usize, &FreeOrder)| {
        let noise = f.sensor_noise.then_some(Seed { campaign: file.seed, run: i as u64 });
        let flown = record_free(&file.plant.for_run(i, &f.inputs), f.duration_s, f.rate_hz, &f.start, noise);
        flown.map_err(|error| Error::Flight { name: f.name.clone(), error })
    };
    // All are flown before the first error is taken: which one that is does not depend on threads.
    let all: Vec<Result<FreeFlown>> = file.flights.par_iter().enumerate().map(one).collect();
    all.into_iter().collect()
}

/// Writes records, truths, the campaign and the resolved scenario into a folder: all of them or, if the process ends before, none.
///
/// # Errors
/// A file that cannot be written.
pub fn write(folder: &Path, file: &FreeFile, flown: &[FreeFlown]) -> Result<()> {
    let set = FileSet::new(folder)?;
    let mut lines = Vec::new();
    for (f, flown) in file.flights.iter().zip(flown) {
        let [record, truth] = names(file, f);
        write_record(&set.stage().join(&record), &flown.record)?;
        write_truth(&set.stage().join(truth), flown)?;
        lines.push(RunLine { file: record, kind: f.kind.clone(), used: f.used, window_s: None });
    }
    write_free_campaign(&set.stage().join(CAMPAIGN), file, &lines)?;
    write_resolved_free(&set.stage().join(RESOLVED), file)?;
    Ok(set.commit(true)?)
}

/// The flights in short; `written` says whether there are files to name.
#[must_use]
pub fn summary(file: &FreeFile, flown: &[FreeFlown], written: bool) -> Simulation {
    let one = |(f, flown): (&FreeOrder, &FreeFlown)| {
        let [record, truth] = names(file, f);
        FlightSummary {
            name: f.name.clone(),
            samples: flown.record.t_s.len(),
            end: "completed",
            end_t_s: flown.record.t_s.last().copied().unwrap_or(0.0),
            steps: flown.steps,
            record: written.then_some(record),
            truth: written.then_some(truth),
            warning: None,
        }
    };
    Simulation {
        scenario: file.name.clone(),
        seed: file.seed,
        flights: file.flights.iter().zip(flown).map(one).collect(),
        campaign: written.then_some(CAMPAIGN),
    }
}

/// Time and pose, tunnel axes.
fn pose(t_s: &[f64], position: [Vec<f64>; 3], attitude: &[[f64; 4]]) -> Vec<(&'static str, Vec<f64>)> {
    let mut columns = vec![("t_s", t_s.to_vec())];
    columns.extend(["X_m", "Y_m", "Z_m"].into_iter().zip(position));
    let quaternion = ["q_w", "q_x", "q_y", "q_z"].into_iter().enumerate();
    columns.extend(quaternion.map(|(k, name)| (name, attitude.iter().map(|q| q[k]).collect())));
    columns
}

fn put(path: &Path, columns: &[(&str, Vec<f64>)]) -> Result<()> {
    let views: Vec<(&str, &[f64])> = columns.iter().map(|(n, c)| (*n, c.as_slice())).collect();
    Ok(write_columns_csv(path, &views)?)
}

fn write_record(path: &Path, record: &PointRecord) -> Result<()> {
    let position = record.position_m.clone().map(Option::unwrap_or_default);
    put(path, &pose(&record.t_s, position, &record.attitude))
}

fn write_truth(path: &Path, flown: &FreeFlown) -> Result<()> {
    let of = |value: &dyn Fn(&windfall_model::FreeState) -> f64| flown.states.iter().map(value).collect::<Vec<f64>>();
    let position = [0, 1, 2].map(|k| of(&|s| s.p_tunnel_origin.to_array()[k]));
    let attitude: Vec<[f64; 4]> = flown.states.iter().map(|s| s.attitude).collect();
    let mut columns = pose(&flown.record.t_s, position, &attitude);
    for (k, (v, w)) in [("u_m_s", "p_rad_s"), ("v_m_s", "q_rad_s"), ("w_m_s", "r_rad_s")].into_iter().enumerate() {
        columns.push((v, of(&|s| s.v_tunnel_origin.to_array()[k])));
        columns.push((w, of(&|s| s.w_tunnel_body.to_array()[k])));
    }
    put(path, &columns)
}
