//! sim tests: flights side by side against flights alone. In: plants with every part that the batch carries. Out: agreement to
//! the method's error, equal bits whatever the grouping, and clear refusals.
//!
//! The batch's equations are written apart from the single flight's, so agreement verifies both.

use crate::common::{REST, flight, lander};
use windfall_model::frames::Vec3;
use windfall_model::{
    ApparentMass, Coefficient, Contact, Factor, Flight, Integrator, LooseMass, MeanFlow, Numerics, Operator, Plant, Release,
    TestSection, TunnelSpeed, Turbulence, Variable, WakeShedding,
};
use windfall_sim::{
    Order, Seed, SimError, Stepping, Truth, fly, fly_batch, fly_truth, fly_truth_batch, for_each_states, for_each_truth,
};

const TILTED: Release = Release {
    position_m: [0.1, 0.2, -0.1],
    velocity_m_s: [0.1, -0.2, 0.3],
    attitude_rad: [0.4, 0.314, 0.305],
    rates_rad_s: [0.2, 0.4, -0.3],
};

const CONTACT: Contact = Contact { run: 0, start_s: 1.03, duration_s: 0.4, impulse: Vec3::zero(), angular_impulse: Vec3::zero() };

fn rk4(steps_per_sample: u32) -> Stepping {
    Stepping::Rk4 { steps_per_sample }
}

fn wandering(duration_s: f64, rate_hz: f64) -> Flight {
    let speed = |t: f64| 7.43 + 0.12 * (0.9 * t).sin() + 0.05 * (2.3 * t + 1.0).sin();
    let vw_m_s = (0..=60).map(|k| speed(0.1 * f64::from(k))).collect();
    let mut order = flight(duration_s, rate_hz, 0.0, TILTED);
    order.speed = TunnelSpeed::History { interval_s: 0.1, vw_m_s };
    order.numerics = Numerics { method: Integrator::Dop853, relative_tolerance: 1e-13, absolute_tolerance: 1e-14 };
    order
}

/// The lander with everything that is smooth: all kinds of factor, tether, flow and apparent mass with every number set.
fn crowded() -> Plant {
    let mut plant = lander();
    plant.vehicle.p_origin_cm = Vec3::new(0.01, 0.004, -0.003);
    plant.vehicle.inertia.xy = 1e-4;
    plant.vehicle.inertia.xz = -2e-4;
    plant.vehicle.inertia.yz = 3e-4;
    plant.vehicle.apparent =
        ApparentMass { axial_kg: 0.12, radial_kg: 0.07, transverse_kg_m2: 0.0011, unturned: 0.0, in_gusts: 0.0 };
    let tether = plant.tether.as_mut().expect("a tether");
    tether.line_rate_n_s_m = 0.02;
    tether.length_per_m = 0.1;
    tether.ring_shift_m = [0.05, -0.1];
    tether.swivel_n_m = 0.002;
    tether.swivel_rate_rad_s = 0.3;
    plant.flow = MeanFlow {
        profile_per_m2: -0.01,
        gradient_per_m: [0.01, -0.02],
        swirl_rad_per_m: 0.01,
        angularity_rad: [0.005, -0.004],
        steady_at_m_s: 0.0,
    };
    let terms: [(Coefficient, f64, &[Factor]); 9] = [
        (Coefficient::CA, 0.3, &[Factor::Power(Variable::AlphaT, 2)]),
        (Coefficient::CA, 0.01, &[Factor::Power(Variable::Speed, 1)]),
        (Coefficient::Cm, 5.0, &[Factor::Bump(Variable::AlphaT, 0.2), Factor::Power(Variable::PitchDamping, 1)]),
        (Coefficient::Cn, 5.0, &[Factor::Bump(Variable::Beta, 0.3), Factor::Power(Variable::YawDamping, 1)]),
        (Coefficient::Cm, 0.02, &[Factor::Power(Variable::SinAlphaT, 1), Factor::CosClock(3)]),
        (Coefficient::Cn, 0.02, &[Factor::Power(Variable::SinAlphaT, 2), Factor::SinClock(2)]),
        (
            Coefficient::CY,
            0.5,
            &[Factor::Power(Variable::RollRate, 1), Factor::Power(Variable::SinAlphaT, 1), Factor::Power(Variable::CosPhi, 1)],
        ),
        (Coefficient::Cl, -1.0, &[Factor::Power(Variable::RollRateAbs, 1), Factor::Power(Variable::RollRate, 1)]),
        (Coefficient::Cn, 0.7, &[Factor::Power(Variable::YawRate, 1), Factor::Power(Variable::PitchRate, 2)]),
    ];
    for (coefficient, value, factors) in terms {
        plant.aero.add(coefficient, value / 0.8, 0.8, factors);
    }
    plant
}

fn rows(t: &Truth) -> Vec<Vec<f64>> {
    (0..t.len())
        .map(|k| {
            let vectors = [t.p_tunnel_cm[k], t.v_tunnel_cm[k], t.w_tunnel_body[k], t.attitude_rad[k]];
            let mut row: Vec<f64> = vectors.concat();
            row.extend(t.quaternion[k]);
            row.extend([t.t_s[k], t.vw_m_s[k], t.alpha_t_rad[k], t.airspeed_m_s[k], t.tether_n[k]]);
            row
        })
        .collect()
}

fn apart(a: &Truth, b: &Truth) -> f64 {
    assert_eq!(a.len(), b.len());
    rows(a).concat().iter().zip(rows(b).concat()).map(|(x, y)| (x - y).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

fn error(plant: &Plant, order: &Flight, steps_per_sample: u32) -> f64 {
    let orders = [Order { plant, flight: order, seed: Seed { campaign: 3, run: 1 } }];
    let (reference, end) = fly_truth(plant, order, orders[0].seed).expect("flies alone");
    let (truth, batch_end) = fly_truth_batch(&orders, rk4(steps_per_sample)).remove(0).expect("flies in a batch");
    assert_eq!(end, batch_end);
    apart(&truth, &reference)
}

/// Roll is counted on over whole turns, either way.
#[test]
fn law_turns_are_counted_as_in_the_single_flight() {
    for rate in [7.0, -7.0] {
        let mut order = wandering(3.0, 50.0);
        order.release.rates_rad_s[0] = rate;
        let (truth, _) = fly_truth(&crowded(), &order, Seed::default()).expect("flies");
        let roll = truth.attitude_rad[150][0];
        assert!(roll * rate.signum() > 4.0, "{roll} rad");
        let far = error(&crowded(), &order, 32);
        assert!(far < 1e-7, "{far}");
    }
}

/// Fourth order until the reference's own error (1e-11 or so, at a tolerance of 1e-13) shows.
#[test]
fn order_four_toward_the_single_flight() {
    for (name, plant) in [("declared", lander()), ("crowded", crowded())] {
        let order = wandering(5.0, 50.0);
        let (coarse, fine) = (error(&plant, &order, 2), error(&plant, &order, 4));
        let rate = (coarse / fine).log2();
        assert!((3.6..5.0).contains(&rate), "{name}: order {rate}, errors {coarse} {fine}");
        let last = error(&plant, &order, 128);
        assert!(last < 1e-9, "{name}: {last}");
    }
}

/// Random inputs, contacts and operator at 12,800 steps a second. Gusts on their fine grid have two derivatives only, which the
/// reference, too, feels: halving the batch's step again leaves 2e-7 between the two, hence the wider bound there.
#[test]
fn law_inputs_as_in_the_single_flight() {
    let gusty = Plant {
        turbulence: Turbulence {
            axial_rms_m_s: 0.1,
            lateral_rms_m_s: 0.1,
            axial_scale_m: 0.5,
            lateral_scale_m: 0.3,
            bandwidth: 0.0,
        },
        ..lander()
    };
    let shed = Plant { shedding: WakeShedding { moment_rms: 0.02, strouhal: 0.15, bandwidth: 0.2 }, ..lander() };
    let contact = Contact { impulse: Vec3::new(0.01, 0.02, -0.01), angular_impulse: Vec3::new(0.0, 0.002, 0.001), ..CONTACT };
    let touched = Plant { contacts: vec![contact], ..lander() };
    let mut all = gusty.clone();
    all.shedding = shed.shedding;
    all.contacts = vec![contact];
    let mut held = wandering(5.0, 50.0);
    held.speed = TunnelSpeed::Operator(Operator {
        trim_m_s: None,
        height_gain_per_s: 0.3,
        rate_gain: 0.4,
        integral_gain_per_s2: 0.05,
        lag_s: 0.3,
        unsteady_rms_m_s: 0.1,
        unsteady_time_s: 0.5,
        hold_x_m: 0.1,
    });
    let given = wandering(5.0, 50.0);
    for (name, plant, order, bound) in [
        ("gusts", &gusty, &given, 1e-6),
        ("shedding", &shed, &given, 1e-9),
        ("contact", &touched, &given, 1e-9),
        ("operator", &lander(), &held, 1e-9),
        ("all", &all, &held, 1e-6),
    ] {
        let (coarse, fine) = (error(plant, order, 8), error(plant, order, 256));
        assert!(fine < bound && fine < 0.1 * coarse, "{name}: {coarse} {fine}");
    }
}

/// A plant whose numbers, and whose structure at every third, depend on `k`.
fn varied(k: usize) -> (Plant, Flight) {
    let mut plant = if k % 3 == 2 { crowded() } else { lander() };
    let change = 1.0 + 0.01 * k as f64;
    plant.aero.values.iter_mut().for_each(|v| *v *= change);
    plant.vehicle.mass_kg *= change;
    let mut order = wandering(1.5 + 0.5 * (k % 2) as f64, 100.0);
    order.release.attitude_rad[1] *= change;
    order.section = k.is_multiple_of(4).then_some(TestSection { radius_m: 0.3, ..TestSection::default() });
    if k % 5 > 2 {
        plant.contacts =
            vec![Contact { start_s: 0.2 + 0.01 * k as f64, impulse: Vec3::new(0.01 * change, 0.02, -0.01), ..CONTACT }];
    }
    (plant, order)
}

#[test]
fn law_bits_do_not_depend_on_the_grouping() {
    let made: Vec<_> = (0..23).map(varied).collect();
    let orders: Vec<_> = made.iter().map(|(plant, flight)| Order { plant, flight, seed: Seed::default() }).collect();
    let bits = |t: &Truth| rows(t).concat().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let alone: Vec<_> = orders.iter().map(|o| fly_truth_batch(&[*o], rk4(1)).remove(0).expect("flies")).collect();
    for size in [2, 3, 5, 8, 23] {
        let grouped = orders.chunks(size).flat_map(|chunk| fly_truth_batch(chunk, rk4(1)));
        for (k, (together, (truth, end))) in grouped.zip(&alone).enumerate() {
            let (other, other_end) = together.expect("flies");
            assert_eq!(bits(&other), bits(truth), "flight {k} in groups of {size}");
            assert_eq!(other_end, *end);
        }
    }
    let turned: Vec<_> = orders.iter().rev().copied().collect();
    for (other, (truth, _)) in fly_truth_batch(&turned, rk4(1)).into_iter().zip(alone.iter().rev()) {
        assert_eq!(bits(&other.expect("flies").0), bits(truth));
    }
}

/// More orders than are made ready at a time, of several structures, with one that is refused.
#[test]
fn law_each_order_is_shown_once() {
    let made: Vec<_> = (0..150).map(|k| varied(k % 11)).collect();
    let mut broken = made[0].clone();
    broken.0.vehicle.mass_kg = f64::NAN;
    let pairs = made.iter().take(140).chain([&broken]).chain(made.iter().skip(140));
    let orders: Vec<_> = pairs.map(|(plant, flight)| Order { plant, flight, seed: Seed::default() }).collect();
    let kept = fly_truth_batch(&orders, rk4(1));
    let mut seen = vec![0; orders.len()];
    for_each_truth(&orders, rk4(1), |k, flown| {
        seen[k] += 1;
        match (&kept[k], flown) {
            (Ok((a, end)), Ok((b, other))) => assert!(a == b && *end == other, "flight {k}"),
            (Err(_), Err(_)) => assert_eq!(k, 140),
            _ => panic!("flight {k} in one and not in the other"),
        }
    });
    assert!(seen.iter().all(|&n| n == 1));
}

#[test]
fn law_states_and_records_are_those_of_the_truth() {
    let (plant, mut order) = varied(0);
    order.sensor_noise = true;
    order.numerics = Numerics::default();
    let orders = [Order { plant: &plant, flight: &order, seed: Seed { campaign: 1, run: 2 } }];
    let flown = fly_batch(&orders, rk4(2)).remove(0).expect("flies");
    let mut seen = 0;
    for_each_states(&orders, rk4(2), |_, states| {
        let (states, end) = states.expect("flies");
        assert_eq!(end, flown.end);
        assert_eq!(states.len(), flown.truth.len());
        assert_eq!(states[7][..3], flown.truth.p_tunnel_cm[7]);
        seen += 1;
    });
    assert_eq!(seen, 1);
    let alone = fly(&plant, &order, orders[0].seed).expect("flies");
    assert_eq!(alone.record.t_s, flown.record.t_s);
    // RK4 at 5 ms: errors far below a micrometre here (see the order's test).
    let far = flown
        .record
        .position_m
        .concat()
        .iter()
        .zip(alone.record.position_m.concat())
        .map(|(a, b)| (a - b).abs())
        .max_by(f64::total_cmp)
        .unwrap_or(f64::NAN);
    assert!(far < 1e-6, "{far} m");
}

/// The time of the end comes from the cubic between two samples, whose ends differ by the method's error.
#[test]
fn law_same_end_at_wall_and_nets() {
    let plant = lander();
    for position_m in [[3.7, 0.0, 0.0], [-3.7, 0.0, 0.0], [0.0, 2.9, 0.0]] {
        let mut order = wandering(5.0, 100.0);
        order.release = Release { position_m, velocity_m_s: [position_m[0], position_m[1], 0.0].map(|x| 0.3 * x), ..TILTED };
        order.section = Some(TestSection::default());
        let (truth, end) = fly_truth(&plant, &order, Seed::default()).expect("flies");
        let (other, other_end) =
            fly_truth_batch(&[Order { plant: &plant, flight: &order, seed: Seed::default() }], rk4(4)).remove(0).expect("flies");
        assert_eq!(truth.len(), other.len());
        assert_eq!(std::mem::discriminant(&end), std::mem::discriminant(&other_end));
        let time = |e| match e {
            windfall_sim::End::Wall { t_s } | windfall_sim::End::UpperNet { t_s } | windfall_sim::End::LowerNet { t_s } => t_s,
            windfall_sim::End::Completed => f64::NAN,
        };
        assert!((time(end) - time(other_end)).abs() < 1e-7, "{end:?} {other_end:?}");
    }
}

/// A release at a little more than 1000 rad/s, about one axis or two, is a runaway at once; one at a little less flies on.
#[test]
fn exact_spin_of_a_runaway() {
    for axis in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [0.0, 0.8, 0.6]] {
        for (rate, runs_away) in [(999.9, false), (1000.1, true)] {
            let rates_rad_s = axis.map(|a: f64| rate * a);
            let order = flight(1e-3, 1e4, 7.4, Release { rates_rad_s, ..TILTED });
            let orders = [Order { plant: &lander(), flight: &order, seed: Seed::default() }];
            for stepping in [rk4(1), Stepping::Adaptive] {
                let flown = fly_truth_batch(&orders, stepping).remove(0).map(|_| ());
                assert_eq!(matches!(flown, Err(SimError::Runaway { t_s: 0.0, .. })), runs_away, "{rates_rad_s:?}: {flown:?}");
                assert_eq!(flown.is_err(), runs_away, "{rates_rad_s:?}: {flown:?}");
            }
        }
    }
}

#[test]
fn law_one_fault_leaves_the_others() {
    let good = lander();
    let mut wild = lander();
    // Damping of the wrong sign.
    wild.aero.values[4] = 500.0;
    let mut broken = lander();
    broken.vehicle.mass_kg = -1.0;
    let mut loose = lander();
    loose.vehicle.loose = Some(LooseMass { mass_kg: 0.05, frequency_hz: 2.0, damping_ratio: 0.1, x_cm_m: 0.1, in_full: 1.0 });
    let mut coupled = lander();
    coupled.aero.add(Coefficient::CN, 1.0, 1.0, &[Factor::Power(Variable::PitchDamping, 1)]);
    let order = wandering(5.0, 100.0);
    let make = |plant| Order { plant, flight: &order, seed: Seed::default() };
    let all = fly_truth_batch(&[make(&good), make(&wild), make(&broken), make(&loose), make(&coupled), make(&good)], rk4(1));
    let alone = fly_truth_batch(&[make(&good)], rk4(1));
    assert_eq!(all[0], alone[0]);
    assert_eq!(all[5], alone[0]);
    assert!(matches!(all[1], Err(SimError::Runaway { .. })), "{:?}", all[1].as_ref().err());
    assert!(matches!(all[2], Err(SimError::Setup { what: "mass_kg", .. })));
    assert_eq!(
        all[3].as_ref().err().map(ToString::to_string).as_deref(),
        Some("a loose mass is not carried by the batch; fly it alone")
    );
    assert!(matches!(all[4], Err(SimError::NotInBatch { .. })));
    assert!(matches!(fly_truth_batch(&[make(&good)], rk4(0))[0], Err(SimError::Setup { what: "steps_per_sample", .. })));
    let contact = Contact { run: 0, start_s: 1.0, duration_s: 0.03, impulse: Vec3::zero(), angular_impulse: Vec3::zero() };
    let short = Plant { contacts: vec![contact], ..lander() };
    assert!(matches!(fly_truth_batch(&[make(&short)], rk4(1))[0], Err(SimError::Setup { what: "step of the batch, s", .. })));
}

/// How far round-off alone takes a single flight: the largest difference that changes of one body rate at release make, by 1e-15 to 1e-11 of
/// itself. Where steps are as long as the tolerance allows, a step's error is no power of its length, the next length follows from it, and
/// round-off grows from step to step: at a tolerance of 1e-6 to some 1e-6 in the crowded plant, a hundredth of the flight's own error.
fn by_round_off(plant: &Plant, flight: &Flight, alone: &Truth) -> f64 {
    let moved = |change: f64| {
        let mut flight = flight.clone();
        flight.release.rates_rad_s[0] *= 1.0 + change;
        apart(&fly(plant, &flight, Seed::default()).expect("flies").truth, alone)
    };
    [1e-15, -1e-14, 1e-13, -1e-12, 1e-11].map(moved).into_iter().max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// Adaptive steps are as many as in the single flight and end where it does, but for some ten times what round-off does to that flight; they
/// approach the solution as the tolerance is narrowed, and do not depend on the grouping.
#[test]
fn law_adaptive_steps_as_in_the_single_flight() {
    let made: Vec<_> = (0..11).map(varied).collect();
    let orders: Vec<_> = made.iter().map(|(plant, flight)| Order { plant, flight, seed: Seed::default() }).collect();
    let exact: Vec<_> = orders.iter().map(|o| fly_truth(o.plant, o.flight, o.seed).expect("flies")).collect();
    for method in [Integrator::Dopri5, Integrator::Dop853] {
        let mut before = f64::INFINITY;
        for relative_tolerance in [1e-6, 1e-8, 1e-10] {
            let numerics = Numerics { method, relative_tolerance, absolute_tolerance: 0.01 * relative_tolerance };
            let loose: Vec<_> = made.iter().map(|(plant, flight)| (plant, Flight { numerics, ..flight.clone() })).collect();
            let orders: Vec<_> = loose.iter().map(|(plant, flight)| Order { plant, flight, seed: Seed::default() }).collect();
            let mut worst = 0.0_f64;
            for (k, (flown, (truth, _))) in fly_batch(&orders, Stepping::Adaptive).into_iter().zip(&exact).enumerate() {
                let flown = flown.expect("flies");
                worst = worst.max(apart(&flown.truth, truth));
                let alone = fly(orders[k].plant, orders[k].flight, Seed::default()).expect("flies");
                let steps = (flown.steps, alone.steps);
                assert!(steps.0.abs_diff(steps.1) <= 1, "flight {k}, {method:?} at {relative_tolerance}: {steps:?} steps");
                let far = apart(&flown.truth, &alone.truth);
                let bound = 10.0 * by_round_off(orders[k].plant, orders[k].flight, &alone.truth);
                assert!(far < bound, "flight {k}, {method:?} at {relative_tolerance}: {far}, by round-off {bound}");
                let single = fly_truth_batch(&orders[k..=k], Stepping::Adaptive).remove(0).expect("flies");
                assert_eq!(single.0, flown.truth, "flight {k} alone and in a group");
            }
            assert!(worst < 0.1 * before, "{method:?} at {relative_tolerance}: {worst}");
            before = worst;
        }
    }
}

/// In a drop from rest the first instants have no airspeed, and the flow is along the body's axis: nothing may become NaN.
#[test]
fn law_still_air_and_axial_flow() {
    let mut plant = crowded();
    plant.flow = MeanFlow::default();
    let order = flight(1.0, 100.0, 0.0, REST);
    assert!(error(&plant, &order, 8) < 1e-6);
    let mut quiet = lander();
    quiet.aero.values[3] = 0.0;
    assert!(error(&quiet, &flight(1.0, 100.0, 7.4, REST), 8) < 1e-9);
}

/// Roll damping beyond anything a body has, either way: a flight that would take 10¹⁵ steps, or grows beyond numbers within the first,
/// ends after a bounded number of them, with the part of the state that departs.
#[test]
fn law_a_plant_that_cannot_be_followed_is_given_up() {
    let order = wandering(5.0, 150.0);
    for method in [Integrator::Dop853, Integrator::Dopri5] {
        let order = Flight { numerics: Numerics { method, ..Numerics::default() }, ..order.clone() };
        let fly_with = |damping: f64| {
            let mut plant = lander();
            plant.aero.values[4] = damping;
            let released = Flight { release: Release { rates_rad_s: [0.1, 0.0, 0.0], ..order.release }, ..order.clone() };
            let orders = [Order { plant: &plant, flight: &released, seed: Seed::default() }];
            let batch = fly_truth_batch(&orders, Stepping::Adaptive).remove(0).map(|_| ());
            (fly_truth(&plant, &released, Seed::default()).map(|_| ()), batch)
        };
        let (alone, batch) = fly_with(-1e16);
        let Err(SimError::TooManySteps { steps, t_s, what: "body rate", rate_per_s }) = alone else { panic!("{alone:?}") };
        // Ten thousand a second and a hundred thousand more; inputs ask for a few hundred.
        assert!((150_000..151_000).contains(&steps) && t_s < 1e-6 && rate_per_s > 1e12, "{steps} {t_s} {rate_per_s}");
        // The batch takes its longest rate from the step that was allowed last.
        assert!(matches!(batch, Err(SimError::TooManySteps { rate_per_s, .. }) if rate_per_s > 1e12), "{batch:?}");
        let (alone, batch) = fly_with(1e16);
        assert!(alone.is_err() && batch.is_err(), "{alone:?} {batch:?}");
        // What a lander takes is far inside.
        let flown = fly(&lander(), &order, Seed::default()).expect("flies");
        assert!(flown.steps < 5_000, "{}", flown.steps);
    }
}
