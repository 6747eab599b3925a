//! likelihood, for its tests: a flight of the bundled SAGE.

use crate::engine::Engine;
use crate::model::{Member, Model};
use windfall_model::{Campaign, Flight, Knowledge, Run};
use windfall_sim::Seed;

/// SAGE flown with an effect that its declared model lacks: the run made ready, and the declared model with that effect.
pub(crate) fn flown(duration_s: f64, family: &str, values: &[f64]) -> (Engine, Model) {
    let file = windfall_scenarios::read_bundled("sage-perturbed").expect("a bundled scenario");
    let effect = windfall_model::CATALOGUE.iter().find(|e| e.family == family).expect("an effect of the catalogue");
    let mut plant = file.declared_plant.clone();
    (effect.apply)(&mut plant, values);
    let flight = Flight { duration_s, ..file.scenario.flights[0].clone() };
    let record = windfall_sim::fly(&plant, &flight, Seed { campaign: 8, run: 0 }).expect("a flight").record;
    let mut run = Run::of_flight(&flight, record);
    run.used = windfall_model::Use::Identify;
    let declared = vec![true; file.declared_plant.aero.values.len()];
    let campaign = Campaign::of_flights("flown", &file.declared_plant, &declared, &Knowledge::default(), vec![run]);
    let engine = Engine::new(&campaign, &[0]).expect("a tunnel run");
    let mut model = Model::declared(&engine.campaign);
    model.members.push(Member { values: values.to_vec(), ..Member::null(effect, &engine.campaign) });
    (engine, model)
}
