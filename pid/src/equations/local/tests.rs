//! pid tests: the equations of motion with everything that a plant can have, against the model's vectors and against differences.

use super::*;
use crate::equations::tests::plant;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{AirState, ApparentMass, Coefficient, Contact, Factor, LooseMass, MeanFlow, Motion, Plant, Variable};

/// Two states of c.m., Euler angles, velocity, body rates and loose mass: the line lengthens in the first, is slack in the second.
const AT: [[f64; MOTION]; 2] = [
    [0.1, -0.2, 0.3, 0.8, 0.15, -0.2, 0.4, 0.4, -0.3, 0.5, 0.9, -1.1, 0.004, -0.006, 0.05, 0.08],
    [-0.3, 0.15, -0.1, -2.1, -0.2, 0.3, -0.5, -0.3, 0.2, -0.7, -1.2, 0.6, -0.005, 0.003, -0.07, 0.04],
];
const AIR: TunnelAir = TunnelAir { t_s: 0.12, density_kg_m3: 1.18, vw_m_s: 7.4, vw_rate_m_s2: 0.6 };
/// Gust, its rate, and increments of the coefficients.
const ADD: [f64; ADDED] = [0.1, -0.2, 0.3, 1.0, -2.0, 0.5, 0.3, -0.2, 0.1, 0.02, -0.03, 0.01];

/// With a force that grows with α̇ and a term of each kind besides, a swivel, a contact, apparent and loose mass.
fn full() -> Plant {
    let mut plant = plant();
    plant.vehicle.apparent =
        ApparentMass { axial_kg: 0.05, radial_kg: 0.08, transverse_kg_m2: 0.0008, unturned: 0.3, in_gusts: 0.6 };
    if let Some(tether) = &mut plant.tether {
        tether.line_rate_n_s_m = 0.4;
        tether.ring_shift_m = [0.15, -0.1];
        (tether.swivel_n_m, tether.swivel_rate_rad_s) = (0.02, 0.7);
    }
    plant.contacts = vec![Contact {
        run: 0,
        start_s: 0.02,
        duration_s: 0.3,
        impulse: Vec3::new(0.02, -0.03, 0.01),
        angular_impulse: Vec3::new(0.001, 0.002, -0.003),
    }];
    plant.vehicle.loose = Some(LooseMass { mass_kg: 0.01, frequency_hz: 2.0, damping_ratio: 0.1, x_cm_m: 0.12, in_full: 0.7 });
    let power = |v, n| Factor::Power(v, n);
    for (coefficient, value, scale, factors) in [
        (Coefficient::CN, 2.0, 1.5, vec![power(Variable::PitchDamping, 1)]),
        (Coefficient::CY, -1.7, 1.0, vec![power(Variable::YawDamping, 1), power(Variable::CosAlphaT, 4)]),
        (Coefficient::CA, 0.3, 1.0, vec![]),
        (Coefficient::CA, 0.2, 1.0, vec![Factor::Bump(Variable::AlphaT, 0.4), power(Variable::Speed, 1)]),
        (Coefficient::Cl, 0.03, 1.0, vec![Factor::CosClock(3), power(Variable::Alpha, 1)]),
        (Coefficient::Cl, 0.02, 1.0, vec![Factor::SinClock(2), power(Variable::Beta, 3)]),
        (Coefficient::Cm, 0.6, 1.0, vec![power(Variable::YawRate, 1)]),
        (Coefficient::Cn, 0.4, 1.0, vec![power(Variable::PitchRate, 2), power(Variable::SinPhi, 1)]),
        (Coefficient::Cl, -0.5, 1.0, vec![power(Variable::RollRateAbs, 1), power(Variable::CosPhi, 1)]),
    ] {
        plant.aero.add(coefficient, value, scale, &factors);
    }
    plant
}

/// The same without what other plants lack: apparent mass, loose mass, tether, mean flow; a flow across that is steady; a heavy line.
fn variants() -> Vec<Plant> {
    let with = |change: &dyn Fn(&mut Plant)| {
        let mut plant = full();
        change(&mut plant);
        plant
    };
    vec![
        full(),
        with(&|p| p.vehicle.apparent = ApparentMass::default()),
        with(&|p| {
            p.vehicle.loose = None;
            p.flow.steady_at_m_s = 6.0;
        }),
        with(&|p| {
            p.vehicle.apparent = ApparentMass::default();
            p.flow.steady_at_m_s = 6.0;
            p.tether = None;
        }),
        with(&|p| {
            p.flow = MeanFlow::default();
            p.vehicle.apparent = ApparentMass::default();
            p.tether.as_mut().expect("it has one").weight_n = 0.2;
        }),
    ]
}

fn three(from: usize, x: &[f64; MOTION]) -> [f64; 3] {
    [x[from], x[from + 1], x[from + 2]]
}

fn rates(craft: &Craft<'_>, x: &[f64; MOTION], air: TunnelAir, added: &[f64; ADDED]) -> [f64; MOTION] {
    craft.rates(x, air, added, &mut Vec::new()).expect("there is flow, and the nose points down")
}

/// Newton and Euler as residuals: the forces of the model, worked out from vectors at the accelerations that these equations by components
/// give, must be what the motion needs, and the loose mass' acceleration that of its spring.
#[test]
fn law_all_loads_of_the_model_balance_the_rates() {
    for (n, plant) in variants().iter().enumerate() {
        let craft = Craft::complete(plant).expect("an inertia that has an inverse");
        for x in &AT {
            let rate = rates(&craft, x, AIR, &ADD);
            let [rx_rad, ry_rad, rz_rad] = three(3, x);
            let r = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body();
            let motion = Motion {
                t_s: AIR.t_s,
                p_tunnel_cm: Vec3::from_array(three(0, x)),
                v_tunnel_cm: Vec3::from_array(three(6, x)),
                r_tunnel_body: r,
                w_tunnel_body: Vec3::from_array(three(9, x)),
                a_tunnel_cm: Vec3::from_array(three(6, &rate)),
                w_tunnel_body_rate: Vec3::from_array(three(9, &rate)),
            };
            let air = AirState {
                vw_m_s: AIR.vw_m_s,
                vw_rate_m_s2: AIR.vw_rate_m_s2,
                density_kg_m3: AIR.density_kg_m3,
                gust: Vec3::new(ADD[0], ADD[1], ADD[2]),
                gust_rate: Vec3::new(ADD[3], ADD[4], ADD[5]),
                coefficient_noise: std::array::from_fn(|k| ADD[6 + k]),
            };
            let mut wrench = plant.wrench(&motion, &air);
            let (v, w, w_rate) = (&plant.vehicle, motion.w_tunnel_body, motion.w_tunnel_body_rate);
            let felt = r.inverse() * (motion.a_tunnel_cm - Vec3::new(plant.environment.gravity_m_s2, 0.0, 0.0));
            if let Some(part) = v.loose {
                let at = Vec3::new(part.x_cm_m, 0.0, 0.0);
                let mount = felt + w_rate.cross(at) + w.cross(w.cross(at));
                let state = [x[12], x[13], x[14], x[15]];
                let carried = part.carried(state, w, w_rate);
                let acceleration = part.acceleration(state, mount, carried);
                wrench += part.wrench(state, acceleration, mount, carried);
                for k in 0..2 {
                    assert!((rate[14 + k] - acceleration[k]).abs() < 1e-8, "{n} part {k}: {} {}", rate[14 + k], acceleration[k]);
                    assert!((rate[12 + k] - x[14 + k]).abs() < 1e-15);
                }
            }
            let inertia = v.inertia.matrix();
            let moment = inertia * w_rate.xyz + w.xyz.cross(&(inertia * w.xyz));
            // Eight rounds, each of which leaves at most 0.03 of what the loose mass and the damping forces add (1 N): 0.03^7.
            let (off, turned) = ((felt * v.mass_kg - wrench.f).norm(), (moment - wrench.m.xyz).norm());
            assert!(off < 1e-9 && turned < 1e-9, "plant {n}: off by {off} N and {turned} N m");
        }
    }
}

/// What is linearised against central differences of the rates: rounding 1e-16 of rates of size 100 over 2e-5, third derivatives of order
/// 1e3 times h²/6.
#[test]
fn exact_slopes_of_the_rates_are_those_of_differences() {
    const H: f64 = 1e-5;
    for (n, plant) in variants().iter().enumerate() {
        let craft = Craft::complete(plant).expect("an inertia that has an inverse");
        for x in &AT {
            let local: Local = craft.local(x, AIR, &ADD, &mut Vec::new()).expect("there is flow");
            let close = |what: &str, column: usize, up: [f64; MOTION], down: [f64; MOTION], slope: &dyn Fn(usize) -> f64| {
                // What has no loose mass has no slopes by one, either.
                for row in 0..if plant.vehicle.loose.is_some() { MOTION } else { STATES } {
                    let difference = (up[row] - down[row]) / (2.0 * H);
                    let (slope, bound) = (slope(row), 1e-7 * (1.0 + difference.abs()));
                    assert!((slope - difference).abs() < bound, "plant {n}, {what} {column}, row {row}: {slope} {difference}");
                }
            };
            let here = rates(&craft, x, AIR, &ADD);
            (0..STATES).for_each(|i| assert!((local.rate[i] - here[i]).abs() < 1e-12 * (1.0 + here[i].abs()), "{n} {i}"));
            for column in 0..if plant.vehicle.loose.is_some() { MOTION } else { STATES } {
                let moved = |by: f64| {
                    let mut x = *x;
                    x[column] += by;
                    rates(&craft, &x, AIR, &ADD)
                };
                close("state", column, moved(H), moved(-H), &|row| local.by_state[row][column]);
            }
            for column in 0..ADDED {
                let moved = |by: f64| {
                    let mut added = ADD;
                    added[column] += by;
                    rates(&craft, x, AIR, &added)
                };
                close("added", column, moved(H), moved(-H), &|row| local.by_added[row][column]);
            }
            let speed = |by: f64| rates(&craft, x, TunnelAir { vw_m_s: AIR.vw_m_s + by, ..AIR }, &ADD);
            close("speed", 0, speed(H), speed(-H), &|row| local.by_speed[row][0]);
            let speeding = |by: f64| rates(&craft, x, TunnelAir { vw_rate_m_s2: AIR.vw_rate_m_s2 + by, ..AIR }, &ADD);
            close("speed's rate", 1, speeding(H), speeding(-H), &|row| local.by_speed[row][1]);
        }
    }
}

/// A force in body axes turns the velocity by `R diag(m + apparent)⁻¹`, a moment the body rates by the inverse of inertia with apparent
/// inertia: by vectors, to rounding.
#[test]
fn exact_accelerations_by_a_force_and_a_moment() {
    let plant = full();
    let craft = Craft::complete(&plant).expect("an inertia that has an inverse");
    let x: [f64; STATES] = std::array::from_fn(|i| AT[0][i]);
    let gain = craft.by_wrench(&x);
    let v = &plant.vehicle;
    let k = &v.apparent;
    let r = EulerXyz { rx_rad: x[3], ry_rad: x[4], rz_rad: x[5] }.r_tunnel_body().matrix;
    let mut inertia = v.inertia.matrix();
    (inertia[(1, 1)], inertia[(2, 2)]) = (inertia[(1, 1)] + k.transverse_kg_m2, inertia[(2, 2)] + k.transverse_kg_m2);
    let mass = [v.mass_kg + k.axial_kg, v.mass_kg + k.radial_kg, v.mass_kg + k.radial_kg];
    for column in 0..3 {
        let rate: [f64; 3] = std::array::from_fn(|i| gain[3 + i][3 + column]);
        let moment = inertia * nalgebra::Vector3::from(rate);
        for row in 0..3 {
            assert!((gain[row][column] - r[(row, column)] / mass[column]).abs() < 1e-14);
            assert!((moment[row] - f64::from(u8::from(row == column))).abs() < 1e-13, "{moment:?}");
            assert!(gain[row][3 + column] == 0.0 && gain[3 + row][column] == 0.0);
        }
    }
}
