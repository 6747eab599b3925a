//! sim: the equations of motion against Newton and Euler. In: a crowded plant at one instant. Out: whether the balances close.
//!
//! `Plant::wrench` gives all forces once accelerations are known; the accelerations that the kernel finds must satisfy
//! `m (a − g) = f` and the momentum equation with them. Bound: round-off of forces near 10 N, 1e-11 where a linear system is solved.

use super::*;
use crate::seed::Seed;
use crate::smooth::Smooth;
use windfall_model::{
    Aero, AirState, ApparentMass, Coefficient, Contact, Environment, Factor, Flight, Inertia, LooseMass, MeanFlow, Motion,
    Numerics, Operator, Plant, PointMass, Release, Sensors, Structure, Tether, TunnelSpeed, Turbulence, Variable, Vehicle,
    WakeShedding,
};

const T: f64 = 0.4;
const VW: f64 = 7.3;

fn plant(apparent: bool, loose: bool) -> Plant {
    let values = vec![6.6, 3.5, -2.0, 0.0125, -5.7, -2.1, 2.5, -3.3, -205.0, -3.1, -190.0];
    let mut tether = Tether::declared(Vec3::new(-0.25, 0.02, -0.03), Vec3::new(-3.0, 0.0, 0.0), 0.0013, 0.0165);
    tether.line_rate_n_s_m = 0.05;
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.8,
            inertia: Inertia { xx: 0.021, yy: 0.014, zz: 0.013, xy: 0.001, xz: -0.002, yz: 0.0015 },
            p_origin_cm: Vec3::new(0.01, -0.02, 0.015),
            diameter_m: 0.2125,
            apparent: if apparent {
                ApparentMass { axial_kg: 0.05, radial_kg: 0.08, transverse_kg_m2: 0.002, unturned: 0.0, in_gusts: 0.0 }
            } else {
                ApparentMass::default()
            },
            loose: loose.then_some(LooseMass {
                mass_kg: 0.05,
                frequency_hz: 3.0,
                damping_ratio: 0.2,
                x_cm_m: 0.07,
                in_full: 1.0,
            }),
        },
        aero: Aero::new(Structure::axisymmetric(), values),
        tether: Some(tether),
        flow: MeanFlow {
            profile_per_m2: -0.3,
            gradient_per_m: [0.2, -0.1],
            swirl_rad_per_m: 0.25,
            angularity_rad: [0.03, -0.02],
            steady_at_m_s: 0.0,
        },
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: vec![Contact {
            run: 0,
            start_s: 0.3,
            duration_s: 0.3,
            impulse: Vec3::new(0.1, -0.2, 0.3),
            angular_impulse: Vec3::new(-0.01, 0.02, 0.03),
        }],
        environment: Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 },
        sensors: Sensors::default(),
        point: PointMass::default(),
        free_flight: None,
    }
}

fn flight(speed: TunnelSpeed) -> Flight {
    Flight {
        name: "test".into(),
        kind: "perturbed".into(),
        used: windfall_model::Use::Identify,
        duration_s: 1.0,
        rate_hz: 150.0,
        release: Release { position_m: [0.0; 3], velocity_m_s: [0.0; 3], attitude_rad: [0.0; 3], rates_rad_s: [0.0; 3] },
        speed,
        ps_pa: 101_000.0,
        ts_k: 295.0,
        section: None,
        numerics: Numerics::default(),
        sensor_noise: false,
        pushes: Vec::new(),
        window_s: None,
    }
}

fn history() -> TunnelSpeed {
    TunnelSpeed::History { interval_s: 0.1, vw_m_s: (0..11).map(|i| 7.0 + 0.07 * f64::from(i)).collect() }
}

/// Position, velocity, attitude, rates, time, then what is appended.
fn state<const N: usize>(appended: &[f64]) -> SVector<f64, N> {
    let mut q = [0.9, 0.2, -0.3, 0.25];
    let norm = q.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
    q = q.map(|x| x / norm);
    let base = [0.3, -0.2, 0.15, 0.4, 1.1, -0.7, q[0], q[1], q[2], q[3], 0.6, -1.4, 0.9, T];
    SVector::from_iterator(base.iter().chain(appended).copied())
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[track_caller]
fn same(a: [f64; 3], b: [f64; 3], bound: f64) {
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= bound, "{a} {b}");
    }
}

/// Kinematics, Newton and Euler for the rate that the kernel gives; `vw` is the tunnel speed and its rate.
#[track_caller]
fn balance<const N: usize>(setup: &Setup<'_>, y: &SVector<f64, N>, vw: [f64; 2]) -> SVector<f64, N> {
    assert_eq!(setup.states(), N);
    let mut dy = SVector::<f64, N>::zeros();
    setup.rate(y, &mut dy);
    let (plant, at) = (&setup.plant, |v: &SVector<f64, N>, k: usize| [v[k], v[k + 1], v[k + 2]]);
    let turn = |h: f64| Rotation::<Tunnel, Body>::from_quaternion(std::array::from_fn(|k| y[6 + k] + h * dy[6 + k]));
    let vector = |a: [f64; 3]| Vec3::<Body>::new(a[0], a[1], a[2]);
    let (r, w, w_rate) = (turn(0.0), at(y, 10), at(&dy, 10));
    same(at(&dy, 0), at(y, 3), 0.0);
    assert!((dy[TIME] - 1.0).abs() < 1e-15 && (0..4).map(|k| y[6 + k] * dy[6 + k]).sum::<f64>().abs() < 1e-15);
    for e in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        // Central difference with step 1e-5: 1e-10 of truncation, 1e-11 of round-off.
        let moved = (turn(1e-5) * vector(e) - turn(-1e-5) * vector(e)) * 5e4;
        same(moved.to_array(), (r * vector(cross(w, e))).to_array(), 1e-9);
    }
    let motion = Motion {
        t_s: y[TIME],
        p_tunnel_cm: Vec3::new(y[0], y[1], y[2]),
        v_tunnel_cm: Vec3::new(y[3], y[4], y[5]),
        r_tunnel_body: r,
        w_tunnel_body: vector(w),
        a_tunnel_cm: Vec3::new(dy[3], dy[4], dy[5]),
        w_tunnel_body_rate: vector(w_rate),
    };
    let mut air =
        AirState { vw_m_s: vw[0], vw_rate_m_s2: vw[1], density_kg_m3: 101_000.0 / (287.0 * 295.0), ..AirState::default() };
    for (axis, gust) in &setup.gusts {
        (air.gust.xyz[*axis], air.gust_rate.xyz[*axis]) = gust.at(T);
    }
    for (index, noise) in &setup.coefficient_noise {
        air.coefficient_noise[*index] = noise.at(T).0;
    }
    let mut total = plant.wrench(&motion, &air);
    let felt = (r.inverse() * Vec3::new(dy[3] - 9.8, dy[4], dy[5])).to_array();
    if let Some(part) = &plant.vehicle.loose {
        let x = [part.x_cm_m, 0.0, 0.0];
        let (turning, inward) = (cross(w_rate, x), cross(w, cross(w, x)));
        let mount = vector(std::array::from_fn(|k| felt[k] + turning[k] + inward[k]));
        let loose = [y[14], y[15], y[16], y[17]];
        let carried = part.carried(loose, vector(w), vector(w_rate));
        let a = part.acceleration(loose, mount, carried);
        same([dy[14], dy[15], 0.0], [y[16], y[17], 0.0], 0.0);
        same([dy[16], dy[17], 0.0], [a[0], a[1], 0.0], 1e-10);
        total += part.wrench(loose, a, mount, carried);
    }
    same(felt.map(|x| 0.8 * x), total.f.to_array(), 1e-11);
    let i = &plant.vehicle.inertia;
    let momentum = |w: [f64; 3]| {
        let [p, q, r] = w;
        [i.xx * p - i.xy * q - i.xz * r, i.yy * q - i.xy * p - i.yz * r, i.zz * r - i.xz * p - i.yz * q]
    };
    let (growing, turning) = (momentum(w_rate), cross(w, momentum(w)));
    same(std::array::from_fn(|k| growing[k] + turning[k]), total.m.to_array(), 1e-11);
    dy
}

fn history_at(setup: &Setup<'_>) -> [f64; 2] {
    let (vw, rate) = setup.history.at(T);
    assert!((vw - 7.28).abs() < 1e-12 && (rate - 0.7).abs() < 1e-12, "a straight history");
    [vw, rate]
}

#[test]
fn law_newton_and_euler_hold_without_algebraic_loop() {
    let plant = plant(false, false);
    let mut setup = Setup::new(&plant, &flight(history()), Seed::default()).expect("flies");
    assert!(!setup.coupled);
    let vw = history_at(&setup);
    balance(&setup, &state::<14>(&[]), vw);
    setup.gusts = vec![(0, Smooth::new(0.5, &[0.1, 0.7, 0.2])), (2, Smooth::new(0.5, &[-0.3, 0.4, 0.1]))];
    setup.coefficient_noise = vec![(1, Smooth::new(0.5, &[0.2, -0.1, 0.4])), (4, Smooth::new(0.5, &[0.02, 0.05, -0.01]))];
    balance(&setup, &state::<14>(&[]), vw);
}

#[test]
fn law_newton_and_euler_hold_with_apparent_mass_and_a_damping_force() {
    let mut plant = plant(true, false);
    plant.aero.add(Coefficient::CN, 4.0, 1.0, &[Factor::Power(Variable::PitchDamping, 1)]);
    plant.aero.add(Coefficient::CY, 90.0, 1.0, &[Factor::Power(Variable::YawDamping, 2)]);
    let mut setup = Setup::new(&plant, &flight(history()), Seed::default()).expect("flies");
    assert!(setup.coupled);
    setup.gusts = vec![(1, Smooth::new(0.5, &[0.1, 0.7, 0.2]))];
    let vw = history_at(&setup);
    balance(&setup, &state::<14>(&[]), vw);
}

#[test]
fn law_newton_and_euler_hold_with_a_loose_part() {
    let plant = plant(true, true);
    let setup = Setup::new(&plant, &flight(history()), Seed::default()).expect("flies");
    let vw = history_at(&setup);
    balance(&setup, &state::<18>(&[0.01, -0.02, 0.3, 0.4]), vw);
}

fn operator() -> Operator {
    Operator {
        trim_m_s: Some(7.0),
        height_gain_per_s: 1.5,
        rate_gain: 0.8,
        integral_gain_per_s2: 0.3,
        hold_x_m: 0.1,
        lag_s: 0.6,
        unsteady_rms_m_s: 0.0,
        unsteady_time_s: 1.0,
    }
}

/// The operator's law written out: error 0.2 m below, sinking at 0.4 m/s, integral 0.05 m s.
#[test]
fn law_newton_and_euler_hold_while_the_operator_throttles() {
    let wanted = 7.0 + 1.5 * 0.2 + 0.8 * 0.4 + 0.3 * 0.05;
    let rate = (wanted - VW) / 0.6;
    for loose in [false, true] {
        let plant = plant(false, loose);
        let setup = Setup::new(&plant, &flight(TunnelSpeed::Operator(operator())), Seed::default()).expect("flies");
        let hand = if loose {
            let dy = balance(&setup, &state::<20>(&[0.01, -0.02, 0.3, 0.4, VW, 0.05]), [VW, rate]);
            [dy[18], dy[19]]
        } else {
            let dy = balance(&setup, &state::<16>(&[VW, 0.05]), [VW, rate]);
            [dy[14], dy[15]]
        };
        same([hand[0], hand[1], 0.0], [rate, 0.2, 0.0], 1e-12);
    }
}

#[test]
fn law_reported_pull_is_the_one_that_acts() {
    let mut plant = plant(false, false);
    plant.contacts.clear();
    let setup = Setup::new(&plant, &flight(history()), Seed::default()).expect("flies");
    let y = state::<14>(&[]);
    let pull = setup.tether_n(&setup.sight(&y), Vec3::new(y[10], y[11], y[12]));
    assert!((pull.abs() - setup.instant(&y).other.f.norm()).abs() < 1e-14 && pull > 0.0);
}

/// A body carried along by the air: no aerodynamic force, no NaN.
#[test]
fn exact_still_air_leaves_gravity() {
    let mut plant = plant(false, false);
    (plant.tether, plant.flow) = (None, MeanFlow::default());
    plant.contacts.clear();
    let setup = Setup::new(&plant, &flight(TunnelSpeed::Constant(0.0)), Seed::default()).expect("flies");
    let mut y = state::<14>(&[]);
    y.fixed_rows_mut::<3>(3).fill(0.0);
    y.fixed_rows_mut::<3>(10).fill(0.0);
    let mut dy = SVector::<f64, 14>::zeros();
    setup.rate(&y, &mut dy);
    same([dy[3], dy[4], dy[5]], [9.8, 0.0, 0.0], 1e-14);
    same([dy[10], dy[11], dy[12]], [0.0; 3], 0.0);
}

/// A fan that follows in a microsecond: `∂V̇_W/∂V_W = −1/lag`, whatever the speed is. Bound: rounding of the speed over the step by which it
/// is moved, 1e-8 of itself and one.
#[test]
fn exact_what_changes_fastest_is_named_with_its_rate() {
    let plant = plant(false, false);
    let order = Operator { lag_s: 1e-6, ..operator() };
    let setup = Setup::new(&plant, &flight(TunnelSpeed::Operator(order)), Seed::default()).expect("flies");
    for speed in [1.0, 1000.0] {
        let (what, rate_per_s) = setup.fastest(&state::<16>(&[speed, 0.05]));
        assert!((rate_per_s * 1e-6 - 1.0).abs() < 1e-6, "{speed} m/s: {rate_per_s}");
        assert_eq!(what, "state of operator or loose part");
    }
}

/// Gusts over a long flight of a large body need few points; many times as many as fit into memory are refused before they are drawn.
#[test]
fn law_a_grid_of_gusts_is_refused_by_its_points() {
    let mut plant = plant(false, false);
    let gusts = |scale: f64| Turbulence {
        axial_rms_m_s: 0.4,
        lateral_rms_m_s: 0.0,
        axial_scale_m: scale,
        lateral_scale_m: scale,
        bandwidth: 0.0,
    };
    (plant.turbulence, plant.vehicle.diameter_m) = (gusts(1e6), 1e5);
    let mut order = flight(TunnelSpeed::Constant(7.0));
    order.duration_s = 2e4;
    assert_eq!(Setup::new(&plant, &order, Seed::default()).expect("twelve points").gusts.len(), 1);
    (plant.turbulence, plant.vehicle.diameter_m) = (gusts(1e-3), 0.2125);
    let e = Setup::new(&plant, &order, Seed::default()).expect_err("2e9 points");
    assert!(e.to_string().contains("points of a gust's grid"), "{e}");
}
