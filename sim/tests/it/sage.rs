//! sim tests and benches: the lander that they fly. In: nothing. Out: a plant.

use windfall_model::frames::Vec3;
use windfall_model::{
    Aero, ApparentMass, Environment, Inertia, MeanFlow, Plant, PointMass, Sensors, Structure, Tether, Turbulence, Vehicle,
    WakeShedding,
};

/// Table 5.5, C_n1 = C_m1 and C_n2 = C_m2.
const TABLE_5_5: [f64; 11] = [6.6620, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];

/// The 25 % SAGE model (Tables 2.2, 5.5, B.1) in declared form.
pub(crate) fn lander() -> Plant {
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.7873,
            inertia: Inertia { xx: 0.02113, yy: 0.0138, zz: 0.01379, ..Inertia::default() },
            p_origin_cm: Vec3::zero(),
            diameter_m: 0.2125,
            apparent: ApparentMass::default(),
            loose: None,
        },
        aero: Aero::new(Structure::axisymmetric(), TABLE_5_5.to_vec()),
        tether: Some(Tether::declared(Vec3::new(-0.25, 0.0, 0.0), Vec3::new(-3.0, 0.0, 0.0), 0.001_300_642_6, 0.016_458_42)),
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: vec![],
        environment: Environment { gravity_m_s2: 9.80665, gas_constant_j_kg_k: 287.05287 },
        sensors: Sensors::default(),
        point: PointMass::default(),
        free_flight: None,
    }
}
