//! sim tests: how flights end, and what is refused. In: closed forms and bad numbers. Out: events and errors by name.

use crate::common::*;
use windfall_model::{Flight, Inertia, Plant, Release, TestSection, TunnelSpeed};
use windfall_sim::{End, Seed, SimError, fly, fly_point, fly_truth};

fn free() -> Plant {
    torque_free(Inertia { xx: 0.02, yy: 0.02, zz: 0.02, ..Inertia::default() })
}

fn within(release: Release) -> Flight {
    let mut order = flight(20.0, 150.0, 0.0, release);
    order.section = Some(TestSection::default());
    order
}

fn ended(plant: &Plant, order: &Flight) -> (usize, End) {
    let flown = fly(plant, order, Seed::default()).expect("flies");
    assert_eq!(flown.truth.len(), flown.record.len());
    (flown.truth.len(), flown.end)
}

/// Fall to the lower net: `t = √(2·3.81/g)`; sideways to the wall at 2 m/s: 3.048/2; upward with 5 m/s to the upper net.
#[test]
fn exact_times_of_wall_and_nets() {
    let mut plant = free();
    plant.environment.gravity_m_s2 = 9.8;
    let t = (2.0 * 3.81 / 9.8_f64).sqrt();
    let (n, end) = ended(&plant, &within(REST));
    assert!(matches!(end, End::LowerNet { t_s } if (t_s - t).abs() < 1e-9), "{end:?}");
    assert_eq!(n, 133, "samples at k/150 before {t} s");
    let v = std::f64::consts::SQRT_2;
    let (n, end) = ended(&free(), &within(Release { velocity_m_s: [0.0, v, -v], ..REST }));
    assert!(matches!(end, End::Wall { t_s } if (t_s - 1.524).abs() < 1e-9), "{end:?}");
    assert_eq!(n, 229);
    let (_, end) = ended(&free(), &within(Release { velocity_m_s: [-5.0, 0.0, 0.0], ..REST }));
    assert!(matches!(end, End::UpperNet { t_s } if (t_s - 0.762).abs() < 1e-9), "{end:?}");
}

/// A flight inside goes to its end, the duration's sample included.
#[test]
fn exact_number_of_samples() {
    for (duration_s, rate_hz, n) in [(15.0, 150.0, 2251), (0.1, 30.0, 4), (1.0, 7.0, 8), (0.99, 10.0, 10)] {
        let order = flight(duration_s, rate_hz, 0.0, REST);
        let truth = flown(&free(), &order);
        assert_eq!(truth.len(), n);
        assert!((truth.t_s[n - 1] - (n - 1) as f64 / rate_hz).abs() < 1e-13);
    }
}

fn refused(plant: &Plant, order: &Flight, words: &str) {
    let e = fly_truth(plant, order, Seed::default()).expect_err("must be refused");
    assert!(e.to_string().contains(words), "{e}");
}

#[test]
fn law_bad_numbers_are_named() {
    let good = flight(1.0, 100.0, 7.0, REST);
    refused(&lander(), &Flight { duration_s: -1.0, ..good.clone() }, "duration_s is -1");
    refused(&lander(), &Flight { rate_hz: f64::NAN, ..good.clone() }, "rate_hz is NaN");
    refused(&lander(), &Flight { ps_pa: 0.0, ..good.clone() }, "static pressure");
    refused(&lander(), &Flight { speed: TunnelSpeed::Constant(f64::INFINITY), ..good.clone() }, "tunnel speed");
    let empty = TunnelSpeed::History { interval_s: 0.1, vw_m_s: vec![] };
    refused(&lander(), &Flight { speed: empty, ..good.clone() }, "history");
    let release = Release { position_m: [0.0, 5.0, 0.0], ..REST };
    refused(&lander(), &Flight { release, section: Some(TestSection::default()), ..good.clone() }, "inside wall and nets");
    let mut plant = lander();
    plant.vehicle.inertia.yy = 0.2;
    refused(&plant, &good, "inertia_kg_m2");
    plant = lander();
    plant.aero.values[2] = f64::NAN;
    refused(&plant, &good, "aerodynamic parameter");
}

/// What becomes NaN on the way is named: here the flow, by an environment no check foresees.
#[test]
fn law_what_became_nan_is_named() {
    let mut plant = lander();
    plant.flow.swirl_rad_per_m = f64::NAN;
    let e = fly_truth(&plant, &flight(1.0, 100.0, 7.0, REST), Seed::default()).expect_err("NaN");
    assert!(matches!(e, SimError::NotFinite { what: "air velocity", .. }), "{e:?}");
}

fn ball() -> Plant {
    let mut plant = torque_free(Inertia { xx: 1.0, yy: 1.0, zz: 1.0, ..Inertia::default() });
    plant.aero = windfall_model::Aero::new(windfall_model::Structure::point_mass(), vec![0.0]);
    plant.environment.gravity_m_s2 = 9.81;
    plant.vehicle.mass_kg = 0.0027;
    plant.vehicle.diameter_m = 0.04;
    plant
}

/// Without air a parabola; with drag, straight down, `V_t tanh(g t/V_t)`; at uneven times.
#[test]
fn exact_point_mass_paths() {
    let times = [0.3, 0.3, 0.35, 0.5, 1.1, 1.13];
    let path = fly_point(&ball(), 1.2, &times, [1.0, 2.0, 3.0], [-4.0, 2.0, 1.0]).expect("flies");
    for (t, p) in times.iter().zip(&path) {
        let s = t - 0.3;
        assert!(worst(p, &[1.0 - 4.0 * s + 4.905 * s * s, 2.0 + 2.0 * s, 3.0 + s]) < 1e-12);
    }
    let mut plant = ball();
    plant.aero.values[0] = 0.5;
    let vt = (2.0 * 0.0027 * 9.81 / (1.2 * 0.5 * plant.vehicle.area_m2())).sqrt();
    let path = fly_point(&plant, 1.2, &times, [0.0; 3], [0.0; 3]).expect("flies");
    for (t, p) in times.iter().zip(&path) {
        let x = 9.81 * (t - 0.3) / vt;
        assert!((p[0] - vt * vt / 9.81 * x.cosh().ln()).abs() < 1e-10, "{t} {p:?}");
    }
}

/// Positive lift carries a level throw above the parabola, whatever its heading; times must not go back.
#[test]
fn law_point_mass_lift_is_upward_and_time_runs_forward() {
    let mut plant = ball();
    plant.point.lift_constant = 0.2;
    for v in [[0.0, 5.0, 0.0], [0.0, -3.0, 4.0]] {
        let up = fly_point(&plant, 1.2, &[0.0, 0.3], [0.0; 3], v).expect("flies")[1][0];
        assert!(up < 0.5 * 9.81 * 0.09 - 0.01, "{up}");
    }
    let e = fly_point(&plant, 1.2, &[0.0, 0.3, 0.2], [0.0; 3], [0.0; 3]).expect_err("backward");
    assert!(matches!(e, SimError::Setup { .. }));
    let e = fly_point(&plant, f64::NAN, &[0.0, 0.3], [0.0; 3], [1.0; 3]).expect_err("NaN");
    assert!(matches!(e, SimError::NotFinite { .. }), "{e:?}");
}

/// Body rates beyond 1000 rad/s end a flight, whichever axes they are about.
#[test]
fn law_a_rate_that_runs_away_is_named_about_any_axis() {
    for rates_rad_s in [[1001.0, 0.0, 0.0], [0.0, -1001.0, 0.0], [0.0, 0.0, 1001.0], [600.0, 600.0, 600.0]] {
        let order = flight(0.002, 1000.0, 0.0, Release { rates_rad_s, ..REST });
        let e = fly_truth(&free(), &order, Seed::default()).expect_err("runs away");
        assert!(
            matches!(e, SimError::Runaway { limit_rad_s, .. } if (limit_rad_s - 1000.0).abs() < 1e-9),
            "{rates_rad_s:?}: {e:?}"
        );
    }
    let order = flight(0.002, 1000.0, 0.0, Release { rates_rad_s: [570.0, 570.0, 570.0], ..REST });
    assert_eq!(flown(&free(), &order).len(), 3);
}

/// A flight is judged by its own samples: a body that is spun up passes the limit at one of them, and a flight that ends a sample before
/// is sound.
#[test]
fn law_a_flight_is_not_given_up_for_what_comes_after_it() {
    let mut plant = free();
    // A roll moment alone: 2000 rad/s² at 7 m/s.
    let s = plant.vehicle.area_m2();
    let i = plant.aero.structure.index("Cl_0").expect("a parameter");
    plant.aero.values[i] = 2000.0 * 0.02 / (0.5 * DENSITY * 49.0 * s * plant.vehicle.diameter_m);
    plant.vehicle.mass_kg = 1e6;
    let order = |samples: u32| {
        let release = Release { rates_rad_s: [990.5, 0.0, 0.0], ..REST };
        flight(f64::from(samples) / 1000.0, 1000.0, 7.0, release)
    };
    // 990.5 + 2 k at sample k: 998.5 at the fourth, 1000.5 at the fifth.
    assert_eq!(flown(&plant, &order(4)).len(), 5);
    let e = fly_truth(&plant, &order(5), Seed::default()).expect_err("runs away");
    // Looked at where the integrator stands, a thousandth of an interval beyond the sample.
    assert!(matches!(e, SimError::Runaway { t_s, .. } if (t_s - 0.005).abs() < 1.1e-6), "{e:?}");
}
