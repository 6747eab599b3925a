//! discover tests: bodies and campaigns for the tests of closing.

pub(super) use crate::tracks::tests::campaign;

use crate::tracks::tests::ball;
use windfall_model::{Campaign, Environment, Flight, Inertia, Knowledge, Plant, PointMass, Run, Sensors, Use, Vehicle};
use windfall_sim::Seed;

/// A body without attitude of 0.1 kg and 0.1 m in a vacuum.
pub(super) fn body() -> Plant {
    let like = ball(0.4);
    Plant {
        vehicle: Vehicle { mass_kg: 0.1, inertia: Inertia::default(), diameter_m: 0.1, ..like.vehicle },
        environment: Environment { gravity_m_s2: 9.8, ..like.environment },
        sensors: Sensors { position_std_m: 0.002, angle_std_rad: 0.01, ..Sensors::default() },
        point: PointMass::default(),
        ..like
    }
}

/// The bundled SAGE flown for so long, with noise of its sensors.
pub(super) fn sage(duration_s: f64) -> Campaign {
    let file = windfall_scenarios::read_bundled("sage-perturbed").expect("a bundled scenario");
    let plant = file.declared_plant;
    let flight = Flight { duration_s, used: Use::Identify, ..file.scenario.flights[0].clone() };
    let record = windfall_sim::fly(&plant, &flight, Seed { campaign: 8, run: 0 }).expect("a flight").record;
    let declared = vec![true; plant.aero.values.len()];
    Campaign::of_flights("flown", &plant, &declared, &Knowledge::default(), vec![Run::of_flight(&flight, record)])
}
