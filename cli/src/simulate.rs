//! cli: `windfall simulate`. In: a scenario. Out: records, truths, the campaign they make and the resolved scenario.

use crate::args::SimulateArgs;
use crate::flights::{end_words, fly_all, warn_of_end};
use crate::session::{Failure, Session, planet_scenario, scenario};
use serde::Serialize;
use std::path::Path;
use windfall_model::Flight;
use windfall_scenarios::{
    RunLine, ScenarioFile, write_campaign_toml, write_columns_csv, write_record_csv, write_resolved_scenario,
};
use windfall_sim::{Flown, Truth};

/// What is printed with `--json`.
#[derive(Serialize)]
struct Report<'a> {
    scenario: &'a str,
    seed: u64,
    flights: Vec<FlightReport<'a>>,
    campaign: Option<&'a str>,
}

/// One flight of it.
#[derive(Serialize)]
struct FlightReport<'a> {
    name: &'a str,
    samples: usize,
    end: &'static str,
    end_t_s: f64,
    steps: u64,
    record: Option<String>,
    truth: Option<String>,
}

pub(crate) fn run(args: &SimulateArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    if let Some(file) = planet_scenario(&args.scenario)? {
        return crate::planet::simulate(&file, session);
    }
    let mut file = scenario(&args.scenario)?;
    file.scenario.seed = args.seed.unwrap_or(file.scenario.seed);
    let names: Vec<(String, String)> = file.scenario.flights.iter().map(|f| names(f, file.scenario.flights.len())).collect();
    let mut outputs: Vec<String> = names.iter().flat_map(|(r, t)| [r.clone(), t.clone()]).collect();
    outputs.extend(["campaign.toml".to_owned(), "scenario.toml".to_owned()]);
    let folder = session.outputs(&outputs)?;
    let flown = fly_all(&file, session)?;
    if let Some(folder) = &folder {
        write_all(folder, &file, &names, &flown)?;
    }
    let reports: Vec<FlightReport<'_>> = file
        .scenario
        .flights
        .iter()
        .zip(&flown)
        .zip(&names)
        .map(|((flight, flown), (record, truth))| {
            let (end, end_t_s) = end_words(flown);
            let written = folder.is_some();
            FlightReport {
                name: &flight.name,
                samples: flown.record.len(),
                end,
                end_t_s,
                steps: flown.steps,
                record: written.then(|| record.clone()),
                truth: written.then(|| truth.clone()),
            }
        })
        .collect();
    for ((r, flight), flown) in reports.iter().zip(&file.scenario.flights).zip(&flown) {
        session.say(&format!("{}: {} samples, {} at {:.3} s, {} steps", r.name, r.samples, r.end, r.end_t_s, r.steps));
        warn_of_end(flight, flown, session);
    }
    if let Some(folder) = &folder {
        session.say(&format!("written to {}: {}", folder.display(), outputs.join(", ")));
    }
    if session.common.json {
        let campaign = folder.is_some().then_some("campaign.toml");
        session.print_json(&Report { scenario: &file.scenario.name, seed: file.scenario.seed, flights: reports, campaign })?;
    }
    Ok(true)
}

/// Names of record and truth.
fn names(flight: &Flight, flights: usize) -> (String, String) {
    if flights == 1 {
        ("run.csv".to_owned(), "truth.csv".to_owned())
    } else {
        (format!("{}.csv", flight.name), format!("{}-truth.csv", flight.name))
    }
}

fn write_all(folder: &Path, file: &ScenarioFile, names: &[(String, String)], flown: &[Flown]) -> Result<(), Failure> {
    let mut lines = Vec::new();
    for ((flight, flown), (record, truth)) in file.scenario.flights.iter().zip(flown).zip(names) {
        write_record_csv(&folder.join(record), &flown.record)?;
        write_truth(&folder.join(truth), &flown.truth)?;
        lines.push(RunLine { file: record.clone(), kind: flight.kind.clone(), used: flight.used });
    }
    write_campaign_toml(&folder.join("campaign.toml"), file, &lines)?;
    write_resolved_scenario(&folder.join("scenario.toml"), file)?;
    Ok(())
}

fn write_truth(path: &Path, truth: &Truth) -> Result<(), Failure> {
    let axis = |series: &[[f64; 3]], k: usize| series.iter().map(|v| v[k]).collect::<Vec<f64>>();
    let mut columns: Vec<(&str, Vec<f64>)> = vec![("t_s", truth.t_s.clone())];
    for (names, series) in [
        (["Xcm_m", "Ycm_m", "Zcm_m"], &truth.p_tunnel_cm),
        (["vX_m_s", "vY_m_s", "vZ_m_s"], &truth.v_tunnel_cm),
        (["p_rad_s", "q_rad_s", "r_rad_s"], &truth.w_tunnel_body),
        (["Rx_rad", "Ry_rad", "Rz_rad"], &truth.attitude_rad),
    ] {
        columns.extend(names.into_iter().enumerate().map(|(k, n)| (n, axis(series, k))));
    }
    for (k, name) in ["q_w", "q_x", "q_y", "q_z"].into_iter().enumerate() {
        columns.push((name, truth.quaternion.iter().map(|q| q[k]).collect()));
    }
    columns.extend([
        ("VW_m_s", truth.vw_m_s.clone()),
        ("alphaT_rad", truth.alpha_t_rad.clone()),
        ("Vinf_m_s", truth.airspeed_m_s.clone()),
        ("Ftr_N", truth.tether_n.clone()),
    ]);
    let views: Vec<(&str, &[f64])> = columns.iter().map(|(n, c)| (*n, c.as_slice())).collect();
    Ok(write_columns_csv(path, &views)?)
}
