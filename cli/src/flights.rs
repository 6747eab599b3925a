//! cli: a scenario's flights. In: a scenario. Out: what was flown, and the campaign that it makes without files.

use crate::session::{Failure, Session};
use rayon::prelude::*;
use windfall_model::{Campaign, Flight};
use windfall_scenarios::ScenarioFile;
use windfall_sim::{End, Flown, Seed, fly};
use windfall_verify::campaign_of;

/// Flies every flight of a scenario, effects included.
pub(crate) fn fly_all(file: &ScenarioFile, session: &Session<'_>) -> Result<Vec<Flown>, Failure> {
    let s = &file.scenario;
    let bar = session.bar("flying", s.flights.len());
    let one = |(i, flight): (usize, &Flight)| {
        let flown = fly(&s.plant.for_run(i, &[]), flight, Seed { campaign: s.seed, run: i as u64 });
        bar.inc(1);
        flown.map_err(|e| Failure::of_flight(&flight.name, e))
    };
    let all: Vec<Result<Flown, Failure>> = session.pool()?.install(|| s.flights.par_iter().enumerate().map(one).collect());
    bar.finish_and_clear();
    all.into_iter().collect()
}

/// Warns of a flight that ended early.
pub(crate) fn warn_of_end(flight: &Flight, flown: &Flown, session: &mut Session<'_>) {
    let (end, t_s) = end_words(flown);
    if end != "completed" {
        session.warn(&format!(
            "{}: the model reached the {end} after {t_s:.3} of {} s; try: another release, operator or [section]",
            flight.name, flight.duration_s
        ));
    }
}

/// The campaign that a scenario's flights make: its declared plant, without the scenario's effects, and the records.
pub(crate) fn campaign(file: &ScenarioFile, session: &mut Session<'_>) -> Result<Campaign, Failure> {
    let flown = fly_all(file, session)?;
    for (flight, flown) in file.scenario.flights.iter().zip(&flown) {
        warn_of_end(flight, flown, session);
    }
    let records: Vec<_> = file.scenario.flights.iter().zip(flown.into_iter().map(|f| f.record)).collect();
    let mut campaign = campaign_of(&file.declared_plant, &records);
    campaign.name.clone_from(&file.scenario.name);
    campaign.plant.clone_from(&file.declared_plant);
    campaign.declared.clone_from(&file.declared);
    Ok(campaign)
}

/// How a flight ended, and when, s.
pub(crate) fn end_words(flown: &Flown) -> (&'static str, f64) {
    match flown.end {
        End::Completed => ("completed", flown.truth.t_s.last().copied().unwrap_or(0.0)),
        End::Wall { t_s } => ("wall", t_s),
        End::UpperNet { t_s } => ("upper net", t_s),
        End::LowerNet { t_s } => ("lower net", t_s),
    }
}
