//! sim tests: the rigid body alone. In: exact torque-free solutions and published check cases. Out: whether ours meets them.

use crate::common::*;
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{
    Aero, Coefficient, Contribution, Factor, Flight, Inertia, Integrator, Numerics, Plant, Release, Structure, Term, Variable,
};
use windfall_sim::Truth;

const BRICK: Inertia = Inertia {
    xx: 0.002_568_217_474_088_241,
    yy: 0.008_421_011_037_627_137,
    zz: 0.009_754_655_939_231_492,
    xy: 0.0,
    xz: 0.0,
    yz: 0.0,
};
const EARTH_RATE_RAD_S: f64 = 7.292_115e-5;
const BRICK_RATES_DEG_S: [f64; 3] = [10.0, 20.0, 30.0];

/// Tight enough that what is left is round-off.
fn tight(mut f: Flight, method: Integrator) -> Flight {
    f.numerics = Numerics { method, relative_tolerance: 1e-13, absolute_tolerance: 1e-15 };
    f
}

fn spin(rates_rad_s: [f64; 3]) -> Release {
    Release { rates_rad_s, ..REST }
}

/// Largest differences of rates (rad/s) and attitude (rad) from a table with a row at every `every`-th sample.
fn differences(truth: &Truth, table: &Table, every: usize) -> (f64, f64) {
    let mut far = (0.0_f64, 0.0_f64);
    for k in 0..table.rows.len() {
        let i = k * every;
        far.0 = far.0.max(worst(&truth.w_tunnel_body[i], &table.row(k, ["p_radps", "q_radps", "r_radps"])));
        far.1 = far.1.max(angle_between(truth.quaternion[i], table.row(k, ["q0", "q1", "q2", "q3"])));
    }
    far
}

/// Quaternions that are reported have unit length however loosely a flight is integrated. Bound: round-off of a norm.
#[test]
fn law_reported_quaternions_have_unit_length() {
    let mut order = flight(5.0, 10.0, 0.0, spin([1.0, 2.0, 3.0]));
    order.numerics = Numerics { method: Integrator::Dopri5, relative_tolerance: 1e-4, absolute_tolerance: 1e-4 };
    for q in &flown(&torque_free(BRICK), &order).quaternion {
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((norm - 1.0).abs() < 1e-15, "{norm}");
    }
}

/// Gate of the check cases: 1e-9 deg/s.
#[test]
fn pub_tumbling_brick_closed_form() {
    let table = Table::parse(include_str!("../data/closed_form_brick.csv"));
    let order = flight(30.0, 10.0, 0.0, spin(BRICK_RATES_DEG_S.map(f64::to_radians)));
    for method in [Integrator::Dop853, Integrator::Dopri5] {
        let truth = flown(&torque_free(BRICK), &tight(order.clone(), method));
        let (rate, angle) = differences(&truth, &table, 5);
        assert!(rate.to_degrees() < 1e-9 && angle < 1e-10, "{method:?}: {} deg/s {angle} rad", rate.to_degrees());
    }
}

/// NASA's own solution (SIM 01) of case 2, twelve printed digits of 30 deg/s after its integrator's error.
#[test]
fn pub_tumbling_brick_nasa_case_2() {
    let table = Table::parse(include_str!("../data/case02_sim01_si.csv"));
    let order = flight(30.0, 10.0, 0.0, spin(BRICK_RATES_DEG_S.map(f64::to_radians)));
    let truth = flown(&torque_free(BRICK), &tight(order, Integrator::Dop853));
    for k in 0..table.rows.len() {
        let rates = truth.w_tunnel_body[5 * k].map(f64::to_degrees);
        let far = worst(&rates, &table.row(k, ["p_dps", "q_dps", "r_dps"]));
        assert!(far < 1e-6, "row {k}: {far} deg/s");
    }
}

/// Gate: 1e-9 rad/s. Moments of inertia 1 : 2 : 2.6, 15 rad/s about the middle axis.
#[test]
fn pub_fast_top_closed_form() {
    let table = Table::parse(include_str!("../data/closed_form_vanzon_top.csv"));
    let plant = torque_free(Inertia { xx: 1.0, yy: 2.0, zz: 2.6, ..Inertia::default() });
    for method in [Integrator::Dop853, Integrator::Dopri5] {
        let truth = flown(&plant, &tight(flight(10.0, 20.0, 0.0, spin([1.0, 15.0, 1.0])), method));
        let (rate, angle) = differences(&truth, &table, 5);
        assert!(rate < 1e-9 && angle < 1e-9, "{method:?}: {rate} rad/s {angle} rad");
    }
}

fn momentum(i: &Inertia, r: Rotation<Tunnel, Body>, w: Vec3<Body>) -> Vec3<Tunnel> {
    r * Vec3::from(i.matrix() * w.xyz)
}

/// Drift over 30 s, some twenty turns, below 1e-11: round-off of a thousand steps is a tenth of that.
#[test]
fn law_energy_and_angular_momentum_of_a_free_body() {
    let with_products = Inertia { xy: 0.0004, xz: -0.0007, yz: 0.0009, ..BRICK };
    for inertia in [BRICK, with_products] {
        let order = flight(30.0, 50.0, 0.0, spin([1.0, 2.0, 3.0]));
        let truth = flown(&torque_free(inertia), &tight(order, Integrator::Dop853));
        let at = |k: usize| {
            let w = Vec3::<Body>::from_array(truth.w_tunnel_body[k]);
            let h = momentum(&inertia, Rotation::from_quaternion(truth.quaternion[k]), w);
            (0.5 * w.dot(Vec3::from(inertia.matrix() * w.xyz)), h)
        };
        let (e0, h0) = at(0);
        for k in 0..truth.len() {
            let (e, h) = at(k);
            let drift = ((e - e0) / e0).abs().max((h - h0).norm() / h0.norm());
            assert!(drift < 1e-11, "sample {k}: {drift}");
        }
    }
}

/// A brick described in axes turned against its principal ones (products of inertia) moves as the same brick does.
#[test]
fn law_products_of_inertia_describe_the_same_brick() {
    let turn = EulerXyz { rx_rad: 0.4, ry_rad: -0.7, rz_rad: 1.1 }.r_tunnel_body().matrix;
    let m = turn * BRICK.matrix() * turn.transpose();
    let turned = Inertia { xx: m[(0, 0)], yy: m[(1, 1)], zz: m[(2, 2)], xy: -m[(0, 1)], xz: -m[(0, 2)], yz: -m[(1, 2)] };
    let w = Vec3::<Body>::new(1.0, 2.0, 3.0);
    let order = |w: Vec3<Body>| tight(flight(10.0, 10.0, 0.0, spin(w.to_array())), Integrator::Dop853);
    let a = flown(&torque_free(BRICK), &order(w));
    let b = flown(&torque_free(turned), &order(Vec3::from(turn * w.xyz)));
    for k in 0..a.len() {
        let expected = turn * Vec3::<Body>::from_array(a.w_tunnel_body[k]).xyz;
        // Round-off of 10 s at 4 rad/s.
        assert!(worst(&b.w_tunnel_body[k], Vec3::<Body>::from(expected).to_array().as_slice()) < 1e-11);
    }
}

/// Error against the closed form falls with the fifth and eighth power of the step.
#[test]
fn order_of_convergence() {
    let table = Table::parse(include_str!("../data/closed_form_brick.csv"));
    let fast = |method, relative_tolerance| {
        let mut order = flight(30.0, 10.0, 0.0, spin(BRICK_RATES_DEG_S.map(f64::to_radians)));
        order.numerics = Numerics { method, relative_tolerance, absolute_tolerance: relative_tolerance };
        let flown = windfall_sim::fly(&torque_free(BRICK), &order, Default::default()).expect("flies");
        (differences(&flown.truth, &table, 5).0, flown.steps as f64)
    };
    for (method, order, tolerances) in [(Integrator::Dopri5, 5.0, [1e-8, 1e-12]), (Integrator::Dop853, 8.0, [1e-9, 1e-12])] {
        let [(e1, n1), (e2, n2)] = tolerances.map(|t| fast(method, t));
        let found = (e1 / e2).ln() / (n2 / n1).ln();
        assert!((found - order).abs() < 1.2, "{method:?}: {found} from {e1} {n1} {e2} {n2}");
    }
}

/// U.S. Standard Atmosphere 1976 below 11 km: pressure (Pa) and temperature (K) at geometric altitude (m).
fn us76(altitude_m: f64) -> (f64, f64) {
    let r0 = 6_356_766.0;
    let h = r0 * altitude_m / (r0 + altitude_m);
    let t = 288.15 - 0.0065 * h;
    (101_325.0 * (t / 288.15).powf(9.80665 * 0.028_964_4 / (8.314_32 * 0.0065)), t)
}

/// Flies in pieces of 0.02 s with gravity and air of the altitude in the middle of each piece (an error of second order in the
/// piece: 1e-6 m after 30 s), and gives altitude, sinking speed, rates and quaternion every 0.5 s.
fn falling(mut plant: Plant, gravity: impl Fn(f64) -> f64) -> Vec<(f64, f64, [f64; 3], [f64; 4])> {
    let mut release = spin(BRICK_RATES_DEG_S.map(f64::to_radians));
    let mut altitude = 9144.0;
    let mut out = vec![];
    for piece in 0..=1500 {
        let v = release.velocity_m_s[0];
        let [rx_rad, ry_rad, rz_rad] = release.attitude_rad;
        if piece % 25 == 0 {
            let q = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().to_quaternion();
            out.push((altitude, v, release.rates_rad_s, q));
        }
        let middle = altitude - v * 0.01 - 0.5 * 9.8 * 0.01 * 0.01;
        plant.environment.gravity_m_s2 = gravity(middle);
        plant.environment.gas_constant_j_kg_k = 8.314_32 / 0.028_964_4;
        let mut order = tight(flight(0.02, 50.0, 0.0, release), Integrator::Dop853);
        (order.ps_pa, order.ts_k) = us76(middle);
        let truth = flown(&plant, &order);
        altitude -= truth.p_tunnel_cm[1][0];
        release = Release {
            position_m: [0.0; 3],
            velocity_m_s: truth.v_tunnel_cm[1],
            attitude_rad: truth.attitude_rad[1],
            rates_rad_s: truth.w_tunnel_body[1],
        };
    }
    out
}

/// Yaw, pitch and roll (sequence 3-2-1) from the axes of release, degrees. Which of them points down does not matter to a sphere
/// or to a brick whose damping depends on speed alone; the tunnel's own are taken.
/// `turned_rad`: how far the axes have turned since about their first (north at the equator: with the Earth).
fn yaw_pitch_roll_deg(q: [f64; 4], turned_rad: f64) -> [f64; 3] {
    let earth = EulerXyz { rx_rad: -turned_rad, ry_rad: 0.0, rz_rad: 0.0 }.r_tunnel_body().matrix;
    let m = earth * Rotation::<Tunnel, Body>::from_quaternion(q).matrix;
    [m[(1, 0)].atan2(m[(0, 0)]), -m[(2, 0)].asin(), m[(2, 1)].atan2(m[(2, 2)])].map(f64::to_degrees)
}

/// Case 4: a turning sphere falls through the standard atmosphere; drag along the velocity is C_A = C_D cos α_T with
/// C_N = C_D sin α_T. Gates: 2e-5 m, 1e-5 m/s, 2e-8 deg.
#[test]
fn pub_dropped_sphere_nasa_case_4() {
    let mut plant = lander();
    plant.tether = None;
    plant.vehicle.mass_kg = 14.593_902_937_206;
    plant.vehicle.inertia = Inertia { xx: 4.880_944_613_992_92, yy: 4.880_944_613_992_92, zz: 4.880_944_613_992_92, ..BRICK };
    plant.vehicle.diameter_m = (4.0 * 0.018_241_465_452_480_003 / std::f64::consts::PI).sqrt();
    plant.aero.values = vec![0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let rows = falling(plant, |h| 398_600_441_800_000.0 / (6_371_007.180_9 + h).powi(2));
    let table = Table::parse(include_str!("../data/case04_sim04_si.csv"));
    for (k, (altitude, sink, rates, q)) in rows.iter().enumerate() {
        let far = [
            worst(&[*altitude], &table.row(k, ["altitude_m"])),
            worst(&[*sink], &table.row(k, ["vD_mps"])),
            worst(&rates.map(f64::to_degrees), &table.row(k, ["p_dps", "q_dps", "r_dps"])),
            worst(&yaw_pitch_roll_deg(*q, 0.0), &table.row(k, ["yaw_deg", "pitch_deg", "roll_deg"])),
        ];
        assert!(far[0] < 2e-5 && far[1] < 1e-5 && far[2] < 1e-9 && far[3] < 2e-8, "row {k}: {far:?}");
    }
}

/// Damping of a brick in p b/2V, q c/2V, r b/2V as three terms, converted to this program's single length.
fn damped_brick(area_ft2: f64, b_ft: f64, c_ft: f64) -> Plant {
    let mut plant = torque_free(BRICK);
    let (s, b, c) = (area_ft2 * 0.092_903_04, b_ft * 0.3048, c_ft * 0.3048);
    let d = plant.vehicle.diameter_m;
    let unit = plant.vehicle.area_m2() * d * d;
    let term = |parameter, coefficient, variable| Contribution {
        coefficient,
        parameter,
        term: Term::new(1.0, &[Factor::Power(variable, 1)]),
    };
    let structure = Structure {
        name: "brick".into(),
        parameters: ["Clp", "Cmq", "Cnr"].map(String::from).to_vec(),
        contributions: vec![
            term(0, Coefficient::Cl, Variable::RollRate),
            term(1, Coefficient::Cm, Variable::PitchRate),
            term(2, Coefficient::Cn, Variable::YawRate),
        ],
    };
    plant.vehicle.mass_kg = 2.267_961_895_856_376;
    plant.aero = Aero::new(structure, [b, c, b].map(|length| -s * length * length / unit).to_vec());
    plant
}

/// Case 3: a brick with rate damping, against NASA's SIM 04 (S, b, c = 2/9, 1/3, 2/3 ft) and against the flat-Earth reference
/// (the same as printed decimals). Gates: 2e-5 deg/s and 2e-4 deg.
#[test]
fn pub_damped_brick_nasa_case_3() {
    let gravity = |h: f64| {
        let (r, a) = (6_378_137.0 + h, 6_378_137.0_f64);
        let attraction = 398_600_441_800_000.0 / (r * r) * (1.0 + 1.5 * 0.001_082_629_82 * (a / r).powi(2));
        attraction - EARTH_RATE_RAD_S.powi(2) * r
    };
    let nasa = Table::parse(include_str!("../data/case03_sim04_si.csv"));
    let reference = Table::parse(include_str!("../data/reference_case03_flat_earth.csv"));
    for (k, (_, _, rates, _)) in falling(damped_brick(2.0 / 9.0, 1.0 / 3.0, 2.0 / 3.0), gravity).iter().enumerate() {
        let far = worst(&rates.map(f64::to_degrees), &nasa.row(k, ["p_dps", "q_dps", "r_dps"]));
        assert!(far < 2e-5, "row {k}: {far} deg/s from SIM 04");
    }
    for (k, (altitude, _, rates, q)) in falling(damped_brick(0.22222, 0.33333, 0.66667), gravity).iter().enumerate() {
        let far = [
            worst(&rates.map(f64::to_degrees), &reference.row(k, ["p_dps", "q_dps", "r_dps"])),
            worst(
                &yaw_pitch_roll_deg(*q, EARTH_RATE_RAD_S * 0.5 * k as f64),
                &reference.row(k, ["yaw_deg", "pitch_deg", "roll_deg"]),
            ),
            worst(&[*altitude], &reference.row(k, ["altitude_m"])),
        ];
        assert!(far[0] < 2e-5 && far[1] < 2e-4 && far[2] < 1e-4, "row {k}: {far:?}");
    }
}
