//! discover tests: bodies and campaigns for the tests of closing.

use windfall_model::frames::Vec3;
use windfall_model::{
    Aero, ApparentMass, Campaign, Data, Environment, Flight, Inertia, Knowledge, MeanFlow, Plant, PointMass, PointRecord, Run,
    Sensors, Structure, Turbulence, Use, Vehicle, WakeShedding,
};
use windfall_sim::Seed;

/// A body without attitude of 0.1 kg and 0.1 m in a vacuum.
pub(super) fn body() -> Plant {
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.1,
            inertia: Inertia::default(),
            p_origin_cm: Vec3::zero(),
            diameter_m: 0.1,
            apparent: ApparentMass::default(),
            loose: None,
        },
        aero: Aero::new(Structure::point_mass(), vec![0.4]),
        tether: None,
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 },
        sensors: Sensors { position_std_m: 0.002, angle_std_rad: 0.01, ..Sensors::default() },
        point: PointMass::default(),
        free_flight: None,
    }
}

/// Runs to identify on, with their settings.
pub(super) fn campaign(plant: Plant, inputs: &[&str], runs: Vec<(Vec<f64>, PointRecord)>) -> Campaign {
    let run = |(k, (inputs, record)): (usize, (Vec<f64>, PointRecord))| Run {
        name: format!("run-{k}"),
        kind: "drop".to_owned(),
        used: Use::Identify,
        inputs,
        data: Data::Point(record),
        notes: Vec::new(),
    };
    Campaign {
        name: "made".to_owned(),
        plant,
        declared: vec![true],
        inputs: inputs.iter().map(|n| (*n).to_owned()).collect(),
        runs: runs.into_iter().enumerate().map(run).collect(),
        knowledge: Knowledge::default(),
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
