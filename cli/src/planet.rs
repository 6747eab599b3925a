//! cli: planet scenarios. In: a planet scenario. Out: its truths and the resolved scenario; what `windfall check` says of it.

use crate::session::{Failure, Session};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use windfall_model::planet::{Atmosphere, Gravity, PlanetFlight, PlanetScenario, Winds};
use windfall_scenarios::{PlanetFile, write_columns_csv, write_resolved_planet};
use windfall_sim::{PlanetEnd, PlanetFlown, PlanetTruth, fly_planet};

/// What is printed with `--json`.
#[derive(Serialize)]
struct Report<'a> {
    scenario: &'a str,
    flights: Vec<FlightReport<'a>>,
}

/// One flight of it.
#[derive(Serialize)]
struct FlightReport<'a> {
    name: &'a str,
    samples: usize,
    end: &'static str,
    end_t_s: f64,
    steps: u64,
    truth: Option<String>,
    /// Velocity over the ground at its end, toward north, east, down.
    end_velocity_ned_m_s: [f64; 3],
}

pub(crate) fn simulate(file: &PlanetFile, session: &mut Session<'_>) -> Result<bool, Failure> {
    let s = &file.scenario;
    let truths: Vec<String> = s
        .flights
        .iter()
        .map(|f| if s.flights.len() == 1 { "truth.csv".to_owned() } else { format!("{}-truth.csv", f.name) })
        .collect();
    let mut outputs = truths.clone();
    outputs.extend(file.tables());
    outputs.push("scenario.toml".to_owned());
    let folder = session.outputs(&outputs)?;
    let flown = fly_all(s, session)?;
    if let Some(folder) = &folder {
        for (flown, name) in flown.iter().zip(&truths) {
            write_truth(&folder.join(name), &flown.truth)?;
        }
        write_resolved_planet(&folder.join("scenario.toml"), file)?;
    }
    let all = s.flights.iter().zip(&flown).zip(&truths);
    let reports: Vec<FlightReport<'_>> = all.map(|((f, flown), t)| report(f, flown, folder.is_some().then_some(t))).collect();
    for (r, f) in reports.iter().zip(&s.flights) {
        session.say(&format!("{}: {} samples, {} at {:.3} s, {} steps", r.name, r.samples, r.end, r.end_t_s, r.steps));
        if r.end == "ground" {
            let [north, east, down] = r.end_velocity_ned_m_s;
            let across = north.hypot(east);
            session.say(&format!(
                "{}: reached the ground after {:.3} of {} s at {down:.3} m/s down and {across:.3} m/s along it",
                r.name, r.end_t_s, f.duration_s
            ));
        }
    }
    if let Some(folder) = &folder {
        session.say(&format!("written to {}: {}", folder.display(), outputs.join(", ")));
    }
    if session.common.json {
        session.print_json(&Report { scenario: &s.name, flights: reports })?;
    }
    Ok(true)
}

fn fly_all(s: &PlanetScenario, session: &Session<'_>) -> Result<Vec<PlanetFlown>, Failure> {
    let one = |f: &PlanetFlight| fly_planet(s, f).map_err(|e| Failure::of_flight(&f.name, e));
    let all: Vec<Result<PlanetFlown, Failure>> = session.pool()?.install(|| s.flights.par_iter().map(one).collect());
    all.into_iter().collect()
}

fn report<'a>(flight: &'a PlanetFlight, flown: &PlanetFlown, truth: Option<&String>) -> FlightReport<'a> {
    let last = |x: &[f64]| x.last().copied().unwrap_or(0.0);
    let (end, end_t_s, end_velocity_ned_m_s) = match flown.end {
        PlanetEnd::Completed => {
            ("completed", last(&flown.truth.t_s), flown.truth.v_ground_ned.last().copied().unwrap_or_default())
        }
        PlanetEnd::Ground { t_s, v_ground_ned, .. } => ("ground", t_s, v_ground_ned),
    };
    let (name, samples, steps) = (flight.name.as_str(), flown.truth.len(), flown.steps);
    FlightReport { name, samples, end, end_t_s, steps, truth: truth.cloned(), end_velocity_ned_m_s }
}

fn write_truth(path: &Path, truth: &PlanetTruth) -> Result<(), Failure> {
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

/// What `windfall check` understood.
pub(crate) fn summary(s: &PlanetScenario) -> Vec<String> {
    let (p, r) = (&s.planet, &s.body.reference);
    let kind = if s.body.point { "point mass" } else { "rigid body" };
    let gravity = match p.gravity {
        Gravity::Uniform { gravity_m_s2 } => format!("uniform, {gravity_m_s2} m/s2"),
        Gravity::Central { mu_m3_s2 } => format!("central, mu = {mu_m3_s2} m3/s2"),
        Gravity::J2 { mu_m3_s2, j2 } => format!("central with J2, mu = {mu_m3_s2} m3/s2, J2 = {j2}"),
    };
    let air = match &p.atmosphere {
        None => "none: a vacuum".to_owned(),
        Some(Atmosphere::Us1976) => "U.S. Standard Atmosphere 1976".to_owned(),
        Some(Atmosphere::Venus) => "Venus, Seiff and others 1985".to_owned(),
        Some(a @ Atmosphere::Table(_)) => format!("from a file, {} to {} m", a.range_m()[0], a.range_m()[1]),
    };
    let wind = match &p.wind {
        Winds::Steady { north_m_s, east_m_s } => format!("{north_m_s} m/s toward north, {east_m_s} m/s toward east"),
        Winds::Table(t) => format!("{} rows over height", t.rows().len()),
    };
    let lengths = if s.body.point { String::new() } else { format!(", b = {} m, c = {} m", r.span_m, r.chord_m) };
    let mut all = vec![
        format!("{kind}: {} kg, S = {:.6} m2{lengths}", s.body.vehicle.mass_kg, r.area_m2),
        format!(
            "planet: radius {} m, flattening {}, turning at {} rad/s",
            p.figure.equatorial_radius_m, p.figure.flattening, p.rotation_rad_s
        ),
        format!("gravity: {gravity}"),
        format!("air: {air}"),
        format!("wind: {wind}"),
    ];
    all.extend(s.flights.iter().map(|f| {
        let g = f.start.place;
        let (lat, lon) = (g.latitude_rad.to_degrees(), g.longitude_rad.to_degrees());
        format!(
            "flight {}: {} s at {} Hz from {} m at {lat} deg north, {lon} deg east",
            f.name, f.duration_s, f.rate_hz, g.height_m
        )
    }));
    all
}
