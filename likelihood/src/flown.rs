//! likelihood, for its tests: a flight of the bundled SAGE.

use crate::engine::Engine;
use crate::model::{Member, Model};
use windfall_model::{Campaign, Flight, Knowledge, Run, Use};
use windfall_sim::Seed;

/// SAGE flown with an effect that its declared model lacks: the run made ready, and the declared model with that effect.
pub(crate) fn flown(duration_s: f64, family: &str, values: &[f64]) -> (Engine, Model) {
    flown_by(family, &[(Use::Identify, duration_s, values)])
}

/// The same of several runs, each used for something, so long and with the effect so strong; the model has it as the first run.
pub(crate) fn flown_by(family: &str, flights: &[(Use, f64, &[f64])]) -> (Engine, Model) {
    let file = windfall_scenarios::read_bundled("sage-perturbed").expect("a bundled scenario");
    let effect = windfall_model::CATALOGUE.iter().find(|e| e.family == family).expect("an effect of the catalogue");
    let run = |(k, (used, duration_s, values)): (usize, &(Use, f64, &[f64]))| {
        let mut plant = file.declared_plant.clone();
        (effect.apply)(&mut plant, values);
        let flight = Flight { duration_s: *duration_s, ..file.scenario.flights[0].clone() };
        let record = windfall_sim::fly(&plant, &flight, Seed { campaign: 8, run: k as u64 }).expect("a flight").record;
        let mut run = Run::of_flight(&flight, record);
        run.used = *used;
        run
    };
    let runs = flights.iter().enumerate().map(run).collect();
    let declared = vec![true; file.declared_plant.aero.values.len()];
    let campaign = Campaign::of_flights("flown", &file.declared_plant, &declared, &Knowledge::default(), runs);
    let engine = Engine::new(&campaign, &[0]).expect("a tunnel run");
    let mut model = Model::declared(&engine.campaign);
    model.members.push(Member { values: flights[0].2.to_vec(), ..Member::null(effect, &engine.campaign) });
    (engine, model)
}
