//! model tests: the table of the plant's numbers. In: the table. Out: whether each is its own place, and scales as its unit says.

use windfall_model::frames::Vec3;
use windfall_model::{
    Acts, Aero, ApparentMass, CATALOGUE, Environment, FreeFlight, FroudeScale, Given, Inertia, LooseMass, MeanFlow,
    PLANT_NUMBERS, Pivot, Plant, PlantNumber, PointMass, Sensors, Structure, Tether, Turbulence, Vehicle, WakeShedding, effects,
};

/// A plant that has every part.
fn plant() -> Plant {
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.8,
            inertia: Inertia { xx: 0.021, yy: 0.014, zz: 0.013, ..Inertia::default() },
            p_origin_cm: Vec3::zero(),
            diameter_m: 0.2,
            apparent: ApparentMass::default(),
            loose: Some(LooseMass { mass_kg: 0.1, frequency_hz: 2.0, damping_ratio: 0.1, x_cm_m: 0.05, in_full: 1.0 }),
        },
        aero: Aero::new(Structure::axisymmetric(), vec![0.0; 11]),
        tether: Some(Tether::declared(Vec3::new(-0.25, 0.0, 0.0), Vec3::new(-3.0, 0.0, 0.0), 0.0013, 0.0165)),
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 },
        sensors: Sensors::default(),
        point: PointMass { pivot: Some(Pivot::default()), ..PointMass::default() },
        free_flight: Some(FreeFlight::default()),
    }
}

/// Each number set to one of its own and read back after all others were set: no place is in the table twice, no name either.
#[test]
fn law_every_number_has_its_own_place_and_name() {
    let mut plant = plant();
    for (i, n) in PLANT_NUMBERS.iter().enumerate() {
        *(n.lens)(&mut plant).expect("the plant has every part") = 1.0 + i as f64;
    }
    let read: Vec<f64> = PLANT_NUMBERS.iter().filter_map(|n| (n.lens)(&mut plant).map(|x| *x)).collect();
    assert_eq!(read, (0..PLANT_NUMBERS.len()).map(|i| 1.0 + i as f64).collect::<Vec<_>>());
    let mut names: Vec<String> = PLANT_NUMBERS.iter().map(PlantNumber::name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), PLANT_NUMBERS.len());
    let mut free = plant.clone();
    (free.tether, free.vehicle.loose, free.point.pivot, free.free_flight) = (None, None, None, None);
    assert!(PLANT_NUMBERS.iter().all(|n| (n.lens)(&mut free).is_none()
        == ["tether", "loose", "pivot", "free_flight"].iter().any(|part| n.name().contains(part))));
}

/// The dimension that a unit says: its letters against the exponents. Angles, hertz and the gas constant apart.
#[test]
fn law_units_and_dimensions_agree() {
    let of_unit = |unit: &str| match unit {
        "-" | "rad" | "J/(kg K)" => [0, 0, 0],
        "kg" => [1, 0, 0],
        "m" => [0, 1, 0],
        "s" => [0, 0, 1],
        "m2" => [0, 2, 0],
        "1/m" | "rad/m" => [0, -1, 0],
        "1/m2" => [0, -2, 0],
        "Hz" | "rad/s" => [0, 0, -1],
        "m/s" => [0, 1, -1],
        "m/s2" => [0, 1, -2],
        "kg m2" => [1, 2, 0],
        "kg/m3" => [1, -3, 0],
        "N" => [1, 1, -2],
        "N m" => [1, 2, -2],
        "N m s" => [1, 2, -1],
        "N s/m" => [1, 0, -1],
        other => panic!("{other}: a new unit; add its dimension"),
    };
    for n in PLANT_NUMBERS {
        assert_eq!([n.dimension.mass, n.dimension.length, n.dimension.time], of_unit(n.unit), "{}", n.name());
        assert_eq!(n.angle, n.unit == "rad", "{}", n.name());
        assert!(n.range[0] < n.range[1] && (n.given == Given::Effect) == n.range[1].is_infinite(), "{}", n.name());
    }
    // Ratios by hand: L = 2, density 3, g = 1/2 give mass 24, time 2, force m g = 12.
    let scale = FroudeScale { length: 2.0, density: 3.0, gravity: 0.5 };
    let of = |key: &str| scale.of(PLANT_NUMBERS.iter().find(|n| n.key == key).expect("in the table").dimension);
    for (key, ratio) in [("vehicle.mass_kg", 24.0), ("tether.effective_weight_n", 12.0), ("tether.swivel_n_m", 24.0)] {
        assert!((of(key) / ratio - 1.0).abs() < 1e-15, "{key}: {}", of(key));
    }
}

/// An effect's nulls leave the plant alone (but for a loose part, which is there without mass), and so its files say.
#[test]
fn law_null_effects_change_nothing() {
    let names = ["spin".to_owned()];
    for e in CATALOGUE.iter().filter(|e| !["loose-mass", "contact"].contains(&e.family)) {
        let mut changed = plant();
        let parameters = (e.parameters)(&names);
        let strengths = |p: &effects::Parameter| if p.role == effects::Role::Strength { 0.0 } else { p.null };
        (e.apply)(&mut changed, &parameters.iter().map(strengths).collect::<Vec<_>>());
        let same = PLANT_NUMBERS.iter().filter(|n| !n.key.starts_with("turbulence.") && !n.key.starts_with("shedding."));
        for n in same {
            assert_eq!((n.lens)(&mut changed), (n.lens)(&mut plant()), "{}: {}", e.family, n.name());
        }
    }
}

#[test]
fn exact_instrument_mass_and_swivel_effects_add_to_what_is_there() {
    let apply = |family: &str, value: f64| {
        let mut plant = plant();
        plant.sensors.length_scale = 0.001;
        plant.sensors.time_base = 0.002;
        let effect = effects::find(family, Acts::Lander).expect("of the catalogue");
        assert_eq!((effect.parameters)(&[]).len(), 1);
        (effect.apply)(&mut plant, &[value]);
        plant
    };
    assert!((apply("length-scale", 0.01).sensors.length_scale - 0.011).abs() < 1e-15);
    assert!((apply("time-base", -0.01).sensors.time_base + 0.008).abs() < 1e-15);
    let heavier = apply("mass", 0.05).vehicle;
    assert!((heavier.mass_kg - 0.85).abs() < 1e-15);
    assert_eq!(heavier.inertia, plant().vehicle.inertia);
    assert_eq!(apply("swivel-friction", 0.02).tether.map(|t| t.swivel_n_m), Some(0.02));
}
