//! model tests: the table of the plant's numbers. In: the table. Out: whether each is its own place, and scales as its unit says.

use windfall_model::frames::Vec3;
use windfall_model::{
    Acts, Aero, ApparentMass, CATALOGUE, Coefficient, Contact, Environment, Factor, Flight, FlowState, FreeFlight, FroudeScale,
    Given, Inertia, LooseMass, MeanFlow, Numerics, Operator, PLANT_NUMBERS, Pivot, Plant, PlantNumber, PointMass, PointRecord,
    Record, Release, RunNumber, Sensors, Structure, Term, TestSection, Tether, TunnelSpeed, Turbulence, Use, Variable, Vehicle,
    WakeShedding, effects, trim_speed,
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
        drift: Default::default(),
        scatter: Default::default(),
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
        let mut values: Vec<f64> = (effect.parameters)(&[]).iter().map(|p| p.null).collect();
        values[0] = value;
        (effect.apply)(&mut plant, &values);
        plant
    };
    assert!((apply("length-scale", 0.01).sensors.length_scale - 0.011).abs() < 1e-15);
    assert!((apply("time-base", -0.01).sensors.time_base + 0.008).abs() < 1e-15);
    let heavier = apply("mass", 0.05).vehicle;
    assert!((heavier.mass_kg - 0.85).abs() < 1e-15);
    assert_eq!(heavier.inertia, plant().vehicle.inertia);
    assert_eq!(apply("swivel-friction", 0.02).tether.map(|t| (t.swivel_n_m, t.swivel_rate_rad_s)), Some((0.02, 0.05)));
}

/// One strength of an effect after the other: what it does to the numbers of a plant that has them all. Most are added; some multiply what is
/// there, or a displaced mass. Sizes of gusts, of drift and of scatter add as squares and are left out.
#[test]
fn exact_strengths_add_to_the_numbers_of_the_plant() {
    const STRENGTH: f64 = 0.25;
    let mut base = plant();
    for (i, n) in PLANT_NUMBERS.iter().enumerate() {
        *(n.lens)(&mut base).expect("the plant has every part") = 1.0 + i as f64;
    }
    let displaced_kg = base.free_flight.as_ref().map_or(0.0, |f| f.buoyancy_kg);
    let (mut added, mut multiplied) = (std::collections::BTreeSet::new(), Vec::new());
    for e in CATALOGUE {
        let parameters = (e.parameters)(&["spin".to_owned()]);
        let with = |strong: Option<usize>| {
            let null = |p: &effects::Parameter| if p.role == effects::Role::Strength { 0.0 } else { p.null };
            let mut values: Vec<f64> = parameters.iter().map(null).collect();
            strong.into_iter().for_each(|k| values[k] = STRENGTH);
            let mut plant = base.clone();
            (e.apply)(&mut plant, &values);
            plant
        };
        for k in (0..parameters.len()).filter(|&k| parameters[k].role == effects::Role::Strength) {
            let (mut without, mut strong) = (with(None), with(Some(k)));
            assert!(strong != without, "{} {}: a strength that changes nothing", e.family, parameters[k].name);
            let is_size = |key: &str| ["turbulence.", "drift.", "scatter."].iter().any(|part| key.starts_with(part));
            for n in PLANT_NUMBERS.iter().filter(|n| !is_size(n.key)) {
                let before = (n.lens)(&mut without).map_or(0.0, |x| *x);
                let change = (n.lens)(&mut strong).map_or(0.0, |x| *x) - before;
                let is = |expected: f64| (change - expected).abs() < 1e-12;
                if is(STRENGTH) {
                    added.insert(n.name());
                } else if !is(0.0) {
                    let of_another = is(STRENGTH * before) || is(STRENGTH * displaced_kg);
                    assert!(of_another, "{} {}: {} changes by {change}", e.family, parameters[k].name, n.name());
                    multiplied.push(n.name());
                }
            }
        }
    }
    let why = "numbers to which strengths are added; an effect on one that none was added to before raises their count here";
    assert_eq!(added.len(), 56, "{why}: {added:?}");
    let apparent = ["x", "y", "z"].map(|axis| format!("free_flight.apparent_kg.{axis}"));
    let others = ["free_flight.buoyancy_kg", "tether.drag_area_m2", "tether.effective_weight_n"].map(str::to_owned);
    assert_eq!(multiplied, [&apparent[..], &others[..]].concat());
}

/// A number that only effects change is changed by one.
#[test]
fn law_every_number_of_an_effect_has_its_effect() {
    let mut base = plant();
    for (i, n) in PLANT_NUMBERS.iter().enumerate() {
        *(n.lens)(&mut base).expect("the plant has every part") = 2.0 + i as f64;
    }
    let mut all = std::collections::BTreeSet::new();
    for e in CATALOGUE {
        let parameters = (e.parameters)(&["spin".to_owned()]);
        let mut moved = base.clone();
        // Switches are on; no number of the plant is a fourth.
        let value = |p: &effects::Parameter| if p.role == effects::Role::Strength { 0.25 } else { 1.0 };
        (e.apply)(&mut moved, &parameters.iter().map(value).collect::<Vec<_>>());
        let changed = PLANT_NUMBERS.iter().filter(|n| (n.lens)(&mut moved).copied() != (n.lens)(&mut base.clone()).copied());
        all.extend(changed.map(PlantNumber::name));
    }
    let orphans: Vec<String> = PLANT_NUMBERS.iter().filter(|n| n.given == Given::Effect).map(PlantNumber::name).collect();
    let orphans: Vec<&String> = orphans.iter().filter(|n| !all.contains(*n)).collect();
    assert!(orphans.is_empty(), "no effect of the catalogue changes {orphans:?}");
}

/// Eight times as long, under twice the gravity, in air three times as dense: time doubles, speed is four times as high.
#[test]
fn exact_a_flight_scales_by_hand() {
    let scale = FroudeScale { length: 8.0, density: 3.0, gravity: 2.0 };
    let order = |speed: TunnelSpeed| Flight {
        name: "flight".into(),
        kind: "perturbed".into(),
        used: Use::Identify,
        duration_s: 10.0,
        rate_hz: 100.0,
        release: Release {
            position_m: [1.0, 2.0, 3.0],
            velocity_m_s: [4.0, 5.0, 6.0],
            attitude_rad: [0.1, 0.2, 0.3],
            rates_rad_s: [2.0, 4.0, 6.0],
        },
        speed,
        ps_pa: 100.0,
        ts_k: 300.0,
        section: Some(TestSection { radius_m: 1.5, top_x_m: -2.0, bottom_x_m: 3.0 }),
        numerics: Numerics::default(),
        sensor_noise: true,
        pushes: vec![Contact {
            run: 0,
            start_s: 3.0,
            duration_s: 0.5,
            impulse: Vec3::new(1.0, 0.0, 0.0),
            angular_impulse: Vec3::new(0.0, 1.0, 0.0),
        }],
        window_s: Some([3.5, 9.0]),
    };
    let large = scale.flight(&order(TunnelSpeed::Constant(7.0)));
    // Force ρL³g = 3072, impulse twice that, angular impulse eight times that again.
    let push = large.pushes[0];
    assert_eq!((push.start_s, push.duration_s, large.window_s), (6.0, 1.0, Some([7.0, 18.0])));
    assert_eq!((push.impulse.to_array()[0], push.angular_impulse.to_array()[1]), (6144.0, 49152.0));
    assert_eq!((large.duration_s, large.rate_hz, large.ps_pa, large.ts_k), (20.0, 50.0, 300.0, 300.0));
    assert_eq!((large.release.position_m, large.release.velocity_m_s), ([8.0, 16.0, 24.0], [16.0, 20.0, 24.0]));
    assert_eq!((large.release.attitude_rad, large.release.rates_rad_s), ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0]));
    assert_eq!(large.section.map(|s| [s.radius_m, s.top_x_m, s.bottom_x_m]), Some([12.0, -16.0, 24.0]));
    assert_eq!(large.speed, TunnelSpeed::Constant(28.0));
    let history = TunnelSpeed::History { interval_s: 0.1, vw_m_s: vec![7.0, 8.0] };
    assert_eq!(scale.flight(&order(history)).speed, TunnelSpeed::History { interval_s: 0.2, vw_m_s: vec![28.0, 32.0] });
    let hand = Operator {
        trim_m_s: Some(7.0),
        height_gain_per_s: 0.5,
        rate_gain: 0.4,
        integral_gain_per_s2: 0.08,
        lag_s: 0.4,
        unsteady_rms_m_s: 0.05,
        unsteady_time_s: 1.0,
        hold_x_m: 0.25,
    };
    let larger = Operator {
        trim_m_s: Some(28.0),
        height_gain_per_s: 0.25,
        rate_gain: 0.4,
        integral_gain_per_s2: 0.02,
        lag_s: 0.8,
        unsteady_rms_m_s: 0.2,
        unsteady_time_s: 2.0,
        hold_x_m: 2.0,
    };
    assert_eq!(scale.flight(&order(TunnelSpeed::Operator(hand))).speed, TunnelSpeed::Operator(larger));
    assert_eq!((scale.area(), scale.inertia()), (64.0, 3.0 * 32768.0));
    // Mass 3 · 8³ = 1536, force twice that, impulse for twice the time, about an arm of eight times the length.
    let mut touched = plant();
    touched.contacts = vec![Contact {
        run: 0,
        start_s: 1.0,
        duration_s: 0.5,
        impulse: Vec3::new(1.0, 2.0, 3.0),
        angular_impulse: Vec3::new(1.0, 0.0, -1.0),
    }];
    let larger = scale.plant(&touched);
    assert_eq!((larger.vehicle.mass_kg, larger.vehicle.diameter_m), (0.8 * 1536.0, 1.6));
    let contact = larger.contacts[0];
    assert_eq!((contact.start_s, contact.duration_s), (2.0, 1.0));
    assert_eq!(contact.impulse, Vec3::new(6144.0, 12288.0, 18432.0));
    assert_eq!(contact.angular_impulse, Vec3::new(49152.0, 0.0, -49152.0));
    // Terms in airspeed keep their value at four times the speed.
    let mut fast = plant();
    fast.aero.add(Coefficient::CA, 0.5, 0.125, &[Factor::Power(Variable::Speed, 2)]);
    fast.aero.add(Coefficient::CA, 0.3, 1.0, &[Factor::Bump(Variable::Speed, 6.0)]);
    let terms: Vec<Term> = scale.plant(&fast).aero.extra.into_iter().map(|(_, _, term)| term).collect();
    assert_eq!(terms[0], Term::new(0.125 / 16.0, &[Factor::Power(Variable::Speed, 2)]));
    assert_eq!(terms[1], Term::new(1.0, &[Factor::Bump(Variable::Speed, 24.0)]));
}

/// Ranges of all effects' parameters, how far a value is beyond them, and the step by which a strength is tried.
#[test]
fn exact_ranges_and_steps_of_parameters() {
    for e in CATALOGUE {
        for p in (e.parameters)(&["spin".to_owned()]) {
            let (name, range) = (format!("{} {}", e.family, p.name), p.high - p.low);
            assert!(p.low < p.high && (p.low..=p.high).contains(&p.null), "{name}: {} in {} to {}", p.null, p.low, p.high);
            let beyond = [p.low, p.high, p.high + 0.5 * range, p.low - 2.0 * range].map(|x| p.beyond(x));
            assert!(beyond.iter().zip([0.0, 0.0, 0.5, 2.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{name}: {beyond:?}");
            // Coefficients per unit of an input are tried by steps that suit the largest inputs.
            let strong = p.role == effects::Role::Strength && !p.name.contains("_per_");
            assert!(!strong || (p.step / (1e-3 * p.usual.min(1e3)) - 1.0).abs() < 1e-12, "{name}: {}", p.step);
        }
    }
}

/// An effect may take away what a pivot has of friction and a ball of drag, and no more: the amount in all is then zero.
#[test]
fn law_an_amount_is_not_negative_in_all() {
    let mut plant = plant();
    plant.point.pivot = Some(windfall_model::Pivot { arm_m: 0.3, inertia_kg_m2: 0.01, viscous_n_m_s: 2e-4, dry_n_m: 3e-5 });
    for (family, there) in [("viscous-friction", 2e-4), ("pivot-friction", 3e-5)] {
        let effect = effects::find(family, Acts::Pivot).expect("of the catalogue");
        let p = (effect.parameters)(&[])[0].clone().beside(&plant);
        assert!((p.low + there).abs() < 1e-18 && p.is_at_end(p.low) && !p.is_at_end(0.0), "{p:?}");
        let with = |value: f64| {
            let mut moved = plant.clone();
            (effect.apply)(&mut moved, &[value]);
            effect.overdrawn(&[], &moved).is_some()
        };
        assert!(!with(p.low) && with(p.low - 1e-5), "{family}");
    }
}

/// A moment of each harmonic lies across the lateral wind, as that of a body of revolution does.
#[test]
fn exact_periodic_moments_lie_across_the_wind() {
    let (alpha, clock) = (0.3_f64, 0.7_f64);
    let u = Vec3::new(alpha.cos(), alpha.sin() * clock.sin(), alpha.sin() * clock.cos()) * 7.0;
    let flow = FlowState::new(u, Vec3::zero(), Vec3::zero(), 0.2);
    for (values, wave) in [([0.5, 0.0, 3.0], (3.0 * clock).cos()), ([0.0, 0.5, 3.0], (3.0 * clock).sin())] {
        let mut plant = plant();
        (effects::find("roll-periodic", Acts::Lander).expect("of the catalogue").apply)(&mut plant, &values);
        let c = plant.aero.coefficients(&flow);
        let size = 0.5 * alpha.sin() * wave;
        let (pitch, yaw) = (c[Coefficient::Cm as usize], c[Coefficient::Cn as usize]);
        assert!((pitch - size * clock.cos()).abs() < 1e-12 && (yaw + size * clock.sin()).abs() < 1e-12, "{pitch} {yaw}");
    }
}

/// Seven samples over 3 s that begin at 2 s; and what one run has otherwise is added to what the campaign says.
#[test]
fn exact_intervals_and_departures_of_records() {
    let series = || vec![0.0; 7];
    let record = Record {
        t_s: (0..7).map(|i| 2.0 + 0.5 * f64::from(i)).collect(),
        position_m: [series(), series(), series()],
        attitude_rad: [series(), series(), series()],
        vw_m_s: series(),
        ps_pa: series(),
        ts_k: series(),
        ..Record::default()
    };
    assert_eq!((record.interval_s(), record.duration_s()), (0.5, 3.0));
    let mass = PLANT_NUMBERS.iter().position(|n| n.key == "vehicle.mass_kg").expect("in the table");
    let run = PointRecord { own_departures: vec![(mass, 0.25)], ..PointRecord::default() };
    assert!((run.plant(&plant(), 0, &[]).vehicle.mass_kg - 1.05).abs() < 1e-15);
}

/// k (V/8 m/s − 1) cos α_T on top of C_A, and nothing else.
#[test]
fn exact_axial_speed_by_hand() {
    let mut plant = plant();
    (effects::find("axial-speed", Acts::Lander).expect("of the catalogue").apply)(&mut plant, &[0.5, 8.0]);
    for (speed, angle) in [(7.5, 0.2_f64), (9.0, 0.4), (3.0, 0.0)] {
        let u = Vec3::new(angle.cos(), angle.sin(), 0.0) * speed;
        let c = plant.aero.coefficients(&FlowState::new(u, Vec3::zero(), Vec3::zero(), 0.2));
        let expected = 0.5 * (speed / 8.0 - 1.0) * angle.cos();
        assert!((c[0] - expected).abs() < 1e-14 && c[1..].iter().all(|c| c.abs() < 1e-14), "{c:?} {expected}");
    }
}

/// Effects whose strengths are stated at no speed of their own are at the trim speed of the plant with all others, whatever their order: there
/// C_A is the declared one, and a steady stream across is what is declared of that speed.
#[test]
fn exact_effects_are_stated_at_the_trim_speed() {
    const DENSITY: f64 = 1.2;
    let mut declared = plant();
    declared.aero.values[0] = 6.0;
    let named = |family: &str| effects::find(family, Acts::Lander).expect("of the catalogue");
    let (mut slower, mut across, mut heavier) = ([0.5, 0.0], [0.01, 0.02, 1.0, 0.0], [0.1]);
    let all = [
        (named("axial-speed"), slower.as_mut_slice()),
        (named("cross-flow"), across.as_mut_slice()),
        (named("mass"), heavier.as_mut_slice()),
    ];
    let mut with = declared.clone();
    effects::act(&mut with, all.into_iter(), DENSITY);
    let mut heavy = declared.clone();
    heavy.vehicle.mass_kg += 0.1;
    let trim = trim_speed(&heavy, DENSITY);
    assert!(
        (with.flow.steady_at_m_s - trim).abs() < 1e-12
            && (slower[1], across[3]) == (with.flow.steady_at_m_s, with.flow.steady_at_m_s)
    );
    assert!((trim_speed(&with, DENSITY) / trim - 1.0).abs() < 1e-9, "C_A at the trim speed is the declared one");
    let mut ordered = declared;
    let mut at = [0.5, 9.0];
    effects::act(&mut ordered, std::iter::once((named("axial-speed"), at.as_mut_slice())), DENSITY);
    assert!((at[1] - 9.0).abs() < 1e-15, "a speed that is ordered stays");
}

/// Coefficients that follow inputs are added to those that are there, in lists just long enough.
#[test]
fn exact_lists_by_input_are_added() {
    let named = |family: &str, acts: Acts| effects::find(family, acts).expect("of the catalogue");
    for before in [vec![], vec![0.5, 0.25]] {
        let of = |k: usize, x: f64| before.get(k).copied().unwrap_or(0.0) + x;
        let mut ball = plant();
        ball.point.lift_per_input = before.clone();
        ball.point.side_per_input = before.clone();
        ball.point.pressure_per_input = before.clone();
        (named("spin-lift", Acts::PointMass).apply)(&mut ball, &[0.125, 2.0, 3.0, 4.0, 0.5, 6.0]);
        (named("static-pressure", Acts::Altimeter).apply)(&mut ball, &[1.0, 8.0, 16.0]);
        assert_eq!(ball.point.lift_per_input, [of(0, 0.125), of(1, 2.0)]);
        assert_eq!(ball.point.side_per_input, [of(0, 4.0), of(1, 0.5)]);
        assert_eq!(ball.point.pressure_per_input, [of(0, 8.0), of(1, 16.0)]);
        assert_eq!((ball.point.lift_constant, ball.point.side_constant, ball.point.pressure_coefficient), (3.0, 6.0, 1.0));
    }
}

/// What a ball's drag does with an input is added to what is there, and a longer list is made where there is none.
#[test]
fn exact_drag_by_input_is_added() {
    let drag = effects::find("drag", Acts::PointMass).expect("of the catalogue");
    for (before, after) in [(vec![], vec![0.25]), (vec![0.5], vec![0.75])] {
        let mut ball = plant();
        ball.point.drag_per_input = before;
        (drag.apply)(&mut ball, &[0.0, 0.25]);
        assert_eq!(ball.point.drag_per_input, after);
    }
}

/// A number that differs from run to run is changed by a share of itself, or by a length; a place beyond the structure changes nothing.
#[test]
fn exact_numbers_of_a_run() {
    let mut base = plant();
    base.aero.values[0] = 2.0;
    let changed = |number: RunNumber| {
        let mut plant = base.clone();
        plant.change(number, 0.25);
        plant
    };
    let heavier = changed(RunNumber::Mass);
    assert!((heavier.vehicle.mass_kg / base.vehicle.mass_kg - 1.25).abs() < 1e-15);
    assert_eq!(heavier.vehicle.inertia, base.vehicle.inertia);
    assert!((changed(RunNumber::Aero(0)).aero.values[0] / base.aero.values[0] - 1.25).abs() < 1e-15);
    assert!(changed(RunNumber::Aero(99)) == base);
    let hook = |plant: &Plant| plant.tether.as_ref().map(|t| t.p_origin_hook.to_array()).expect("on a tether");
    let (moved, before) = (hook(&changed(RunNumber::Attachment(2))), hook(&base));
    assert!(moved[..2] == before[..2] && (moved[2] - before[2] - 0.25).abs() < 1e-15);
}
