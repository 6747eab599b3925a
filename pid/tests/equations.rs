//! pid tests: §3.3 and Appendix B against vector mechanics. In: a motion made of sines. Out: every printed equation pinned.
//!
//! The motion is known in closed form with its derivatives. What it implies is worked out here by another road: rotation
//! matrices and vectors of `model`, and eighth-order differences in time. A sign in any equation of `states` or `coefficients`
//! makes one of these fail.
mod common;

use common::lander;
use windfall_model::frames::{EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{
    AirState, ApparentMass, Coefficient, Contact, Factor, Inertia, LooseMass, MeanFlow, Motion, PLANT_NUMBERS, Plant, Tether,
    Variable, Wrench, wrench_at_cm,
};
use windfall_pid::coefficients::{CoefficientRow, coefficients};
use windfall_pid::smooth::{Signal, Smoothed};
use windfall_pid::states::{State, states};

type Body = windfall_model::frames::Body;

/// Amplitude, angular frequency, phase of two sines, and offset, for each channel.
const MOTION: [[f64; 7]; 7] = [
    [0.3, 1.1, 0.2, 0.05, 3.1, 1.0, 0.1],
    [0.4, 0.9, 1.2, 0.04, 2.7, 0.3, -0.2],
    [0.2, 1.3, 2.2, 0.06, 3.7, 2.0, 0.3],
    [0.7, 0.8, 0.1, 0.10, 4.1, 0.7, 1.9],
    [0.3, 2.1, 0.9, 0.05, 5.3, 1.7, 0.1],
    [0.25, 2.4, 1.9, 0.06, 4.9, 0.4, -0.15],
    [0.3, 0.7, 0.4, 0.05, 2.2, 1.1, 7.4],
];

/// Value and derivatives of channel c at time t.
fn channel(c: usize, t: f64) -> [f64; 3] {
    let [a, w, f, b, v, g, offset] = MOTION[c];
    [
        offset + a * (w * t + f).sin() + b * (v * t + g).sin(),
        a * w * (w * t + f).cos() + b * v * (v * t + g).cos(),
        -a * w * w * (w * t + f).sin() - b * v * v * (v * t + g).sin(),
    ]
}

const DT: f64 = 0.01;

/// The motion as a perfectly smoothed record of n samples; `shift(c)` is added to the time of channel c.
fn smoothed(n: usize, shift: impl Fn(usize) -> f64) -> Smoothed {
    let t_s: Vec<f64> = (0..n).map(|i| 3.0 + i as f64 * DT).collect();
    let signal = |c: usize| {
        let at = |k: usize| t_s.iter().map(|t| channel(c, t + shift(c))[k]).collect();
        Signal { value: at(0), rate: at(1), second: at(2) }
    };
    Smoothed {
        interval_s: DT,
        channels: std::array::from_fn(signal),
        ps_pa: vec![101_000.0; n],
        ts_k: vec![295.0; n],
        noise_std: [0.0; 7],
        weight: vec![1.0; n],
        bandwidth_hz: [1.0; 7],
        t_s,
    }
}

/// A lander with everything that the identifier must take off: products of inertia, offsets, flow, tether effects, loads.
fn crowded() -> Plant {
    let mut plant = lander();
    let v = &mut plant.vehicle;
    v.inertia = Inertia { xx: 0.021, yy: 0.014, zz: 0.017, xy: 0.0011, xz: -0.0007, yz: 0.0009 };
    v.p_origin_cm = Vec3::new(0.011, -0.007, 0.013);
    v.apparent = ApparentMass { axial_kg: 0.05, radial_kg: 0.08, transverse_kg_m2: 0.0008, unturned: 0.0, in_gusts: 0.6 };
    plant.flow = MeanFlow {
        profile_per_m2: 0.06,
        gradient_per_m: [0.03, -0.05],
        swirl_rad_per_m: 0.07,
        angularity_rad: [0.02, -0.03],
        steady_at_m_s: 0.0,
    };
    let tether = Tether::declared(Vec3::new(-0.25, 0.02, -0.01), Vec3::new(-3.0, 0.1, -0.2), 0.0013, 0.0165);
    plant.tether = Some(Tether {
        line_rate_n_s_m: 0.4,
        length_per_m: 3.0,
        ring_shift_m: [0.15, -0.1],
        swivel_n_m: 0.02,
        swivel_rate_rad_s: 0.7,
        ..tether
    });
    plant.contacts = vec![Contact {
        run: 0,
        start_s: 0.02,
        duration_s: 0.3,
        impulse: Vec3::new(0.02, -0.03, 0.01),
        angular_impulse: Vec3::new(0.001, 0.002, -0.003),
    }];
    plant.aero.add(Coefficient::Cm, 0.05, 1.0, &[Factor::Power(Variable::RollRate, 1)]);
    plant
}

fn attitude(t: f64) -> Rotation<Tunnel, Body> {
    EulerXyz { rx_rad: channel(3, t)[0], ry_rad: channel(4, t)[0], rz_rad: channel(5, t)[0] }.r_tunnel_body()
}

fn p_cm(t: f64, plant: &Plant) -> Vec3<Tunnel> {
    Vec3::new(channel(0, t)[0], channel(1, t)[0], channel(2, t)[0]) + attitude(t) * plant.vehicle.p_origin_cm
}

/// Central difference of eighth order: error of a 5 rad/s sine at this step below 1e-12 of its rate, rounding 1e-13/0.02.
fn rate<const N: usize>(f: impl Fn(f64) -> [f64; N], t: f64) -> [f64; N] {
    const H: f64 = 0.02;
    const W: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let mut d = [0.0; N];
    for (k, w) in W.iter().enumerate() {
        let step = (k + 1) as f64 * H;
        let (ahead, behind) = (f(t + step), f(t - step));
        for i in 0..N {
            d[i] += w * (ahead[i] - behind[i]) / H;
        }
    }
    d
}

/// Body rates from the rotation matrix: the vector of Rᵀ Ṙ.
fn body_rates(t: f64) -> [f64; 3] {
    let flat = |t: f64| -> [f64; 9] { std::array::from_fn(|k| attitude(t).matrix[(k / 3, k % 3)]) };
    let d = rate(flat, t);
    let r_dot = nalgebra::Matrix3::from_fn(|i, j| d[3 * i + j]);
    let w = attitude(t).matrix.transpose() * r_dot;
    [w[(2, 1)], w[(0, 2)], w[(1, 0)]]
}

fn motion(t: f64, plant: &Plant) -> Motion {
    let v = |t| rate(|t| p_cm(t, plant).to_array(), t);
    Motion {
        t_s: t - 3.0,
        p_tunnel_cm: p_cm(t, plant),
        v_tunnel_cm: Vec3::from_array(v(t)),
        r_tunnel_body: attitude(t),
        w_tunnel_body: Vec3::from_array(body_rates(t)),
        a_tunnel_cm: Vec3::from_array(rate(v, t)),
        w_tunnel_body_rate: Vec3::from_array(rate(body_rates, t)),
    }
}

fn air(t: f64, plant: &Plant) -> AirState {
    AirState {
        vw_m_s: channel(6, t)[0],
        vw_rate_m_s2: channel(6, t)[1],
        density_kg_m3: plant.environment.density_kg_m3(101_000.0, 295.0),
        ..AirState::default()
    }
}

const SAMPLES: usize = 40;
/// What nested eighth-order differences leave of 40 m/s² or rad/s²: measured 3e-10 at worst, set by rounding 1e-15/0.02².
const CLOSE: f64 = 1.0e-8;

fn run(plant: &Plant) -> Vec<State> {
    states(&smoothed(SAMPLES, |_| 0.0), plant).expect("airspeed and attitude are in range")
}

fn assert_close(what: &str, i: usize, a: f64, b: f64, bound: f64) {
    assert!((a - b).abs() < bound, "{what} at sample {i}: {a} against {b}");
}

fn assert_vectors(what: &str, i: usize, a: [f64; 3], b: [f64; 3]) {
    for k in 0..3 {
        assert_close(&format!("{what}[{k}]"), i, a[k], b[k], CLOSE);
    }
}

#[test]
fn exact_states_3_20_to_3_28_and_b_14_to_b_43_follow_from_rotation_matrices() {
    let plant = crowded();
    for (i, s) in run(&plant).iter().enumerate() {
        let m = motion(s.t_s, &plant);
        assert_vectors("pqr", i, s.pqr, m.w_tunnel_body.to_array());
        assert_vectors("pqr_rate", i, s.pqr_rate, m.w_tunnel_body_rate.to_array());
        assert_vectors("p_cm", i, s.p_tunnel_cm, m.p_tunnel_cm.to_array());
        assert_vectors("v_cm", i, s.v_tunnel_cm, m.v_tunnel_cm.to_array());
        let uvw = m.r_tunnel_body.inverse() * m.v_tunnel_cm;
        assert_vectors("uvw", i, s.uvw, uvw.to_array());
        let uvw_rate = m.r_tunnel_body.inverse() * m.a_tunnel_cm - m.w_tunnel_body.cross(uvw);
        assert_vectors("uvw_rate", i, s.uvw_rate, uvw_rate.to_array());
    }
}

/// Air velocity at the c.m., from the flow's own description and position alone.
fn v_air(t: f64, plant: &Plant) -> [f64; 3] {
    let (p, f, vw) = (p_cm(t, plant), &plant.flow, channel(6, t)[0]);
    let along =
        1.0 + f.profile_per_m2 * (p.y().powi(2) + p.z().powi(2)) + f.gradient_per_m[0] * p.y() + f.gradient_per_m[1] * p.z();
    let swirl = Vec3::<Tunnel>::new(f.swirl_rad_per_m, 0.0, 0.0).cross(p);
    [-vw * along, vw * (f.angularity_rad[0] + swirl.y()), vw * (f.angularity_rad[1] + swirl.z())]
}

/// c.m. velocity against the air, body axes.
fn uvw_air(t: f64, plant: &Plant) -> [f64; 3] {
    let v = rate(|t| p_cm(t, plant).to_array(), t);
    (attitude(t).inverse() * (Vec3::from_array(v) - Vec3::from_array(v_air(t, plant)))).to_array()
}

#[test]
fn exact_wind_b_37_to_b_41_with_mean_flow_is_the_derivative_along_the_path() {
    let plant = crowded();
    for (i, s) in run(&plant).iter().enumerate() {
        assert_vectors("uvw_air", i, s.uvw_air, uvw_air(s.t_s, &plant));
        assert_vectors("uvw_air_rate", i, s.uvw_air_rate, rate(|t| uvw_air(t, &plant), s.t_s));
    }
}

#[test]
fn exact_angles_b_44_to_b_56_are_consistent_and_their_rates_are_derivatives() {
    let plant = crowded();
    for (i, s) in run(&plant).iter().enumerate() {
        let [u, v, w] = uvw_air(s.t_s, &plant);
        let speed = (u * u + v * v + w * w).sqrt();
        assert_close("speed", i, s.speed, speed, CLOSE);
        assert_close("q", i, s.q_pa, 0.5 * 101_000.0 / (287.052_87 * 295.0) * speed * speed, 1.0e-6);
        let angles = |t: f64| {
            let [u, v, w] = uvw_air(t, &plant);
            [w.atan2(u), v.atan2(u.hypot(w))]
        };
        let ([alpha, beta], [alpha_dot, beta_dot]) = (angles(s.t_s), rate(angles, s.t_s));
        assert_close("alpha", i, s.alpha, alpha, CLOSE);
        assert_close("beta", i, s.beta, beta, CLOSE);
        assert_close("alpha_dot", i, s.alpha_dot, alpha_dot, CLOSE);
        assert_close("beta_dot", i, s.beta_dot, beta_dot, CLOSE);
        // B.53-B.56 the other way round.
        assert_close("B.53", i, (s.alpha_t.sin() * s.phi().cos()).atan2(s.alpha_t.cos()), s.alpha, 1.0e-12);
        assert_close("B.54", i, (s.alpha_t.sin() * s.phi().sin()).asin(), s.beta, 1.0e-12);
    }
}

#[test]
fn law_flow_variables_are_those_of_the_vector_model() {
    let plant = crowded();
    let rows = coefficients(&run(&plant), &plant);
    for (i, row) in rows.iter().enumerate() {
        let (flow, q_pa) = plant.flow_state(&motion(row.t_s, &plant), &air(row.t_s, &plant));
        assert_close("q", i, row.q_pa, q_pa, 1.0e-6);
        for v in Variable::ALL {
            assert_close(v.name(), i, row.flow.get(v), flow.get(v), CLOSE);
        }
    }
}

/// What the motion needs: m (a − g) and I ω̇ + ω × I ω, body axes.
fn needed(m: &Motion, plant: &Plant) -> Wrench {
    let g = Vec3::new(plant.environment.gravity_m_s2, 0.0, 0.0);
    let f = m.r_tunnel_body.inverse() * ((m.a_tunnel_cm - g) * plant.vehicle.mass_kg);
    let i = plant.vehicle.inertia.matrix();
    let (w, w_rate) = (m.w_tunnel_body.xyz, m.w_tunnel_body_rate.xyz);
    Wrench { f, m: (i * w_rate + w.cross(&(i * w))).into() }
}

/// Checks that the row's coefficients, together with every load of the model that is not aerodynamic, make up the motion.
fn assert_balance(i: usize, row: &CoefficientRow, plant: &Plant, extra: Wrench) {
    let (m, a) = (motion(row.t_s, plant), air(row.t_s, plant));
    let v = &plant.vehicle;
    let (flow, q_pa) = plant.flow_state(&m, &a);
    let modelled = wrench_at_cm(&plant.aero.coefficients(&flow), q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm);
    let all = plant.wrench(&m, &a);
    let found = wrench_at_cm(&row.exp_origin, row.q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm);
    let needed = needed(&m, plant);
    let force = all.f - modelled.f + found.f + extra.f;
    let moment = all.m - modelled.m + found.m + extra.m;
    assert_vectors("force", i, force.to_array(), needed.f.to_array());
    assert_vectors("moment", i, moment.to_array(), needed.m.to_array());
    // About the c.m. the same force and moment, without the shift (B.21-B.26).
    let qs = row.q_pa * v.area_m2();
    let [ca, cy, cn, cl, cm, c_n] = row.exp_cm;
    assert_vectors("force of exp_cm", i, [-qs * ca, qs * cy, -qs * cn], found.f.to_array());
    assert_vectors("moment of exp_cm", i, [cl, cm, c_n].map(|c| c * qs * v.diameter_m), found.m.to_array());
}

#[test]
fn law_coefficients_b_5_to_b_36_and_b_60_to_b_66_close_the_balance_of_any_plant() {
    let plant = crowded();
    let rows = coefficients(&run(&plant), &plant);
    assert_eq!(rows.len(), SAMPLES);
    for (i, row) in rows.iter().enumerate() {
        assert_balance(i, row, &plant, Wrench::default());
    }
}

/// A number of vehicle, tether or flow that the crowded lander lacks would be balanced by nothing, and a force that is taken off nowhere
/// not be missed. The loose mass has its own test; flow that is steady is a choice, flown by both rooms in `verify/tests/it/quantities.rs`.
#[test]
fn law_every_number_has_a_value() {
    let mut plant = crowded();
    for n in PLANT_NUMBERS.iter().filter(|n| ["vehicle.", "tether.", "flow."].iter().any(|t| n.key.starts_with(t))) {
        let apart = n.key.contains("loose") || n.key == "flow.steady_at_m_s";
        assert!(apart || (n.lens)(&mut plant).is_some_and(|x| x.abs() > 0.0), "{}: give `crowded` a value of it", n.name());
    }
}

#[test]
fn law_free_flight_has_no_tether_in_the_balance() {
    let plant = Plant { tether: None, contacts: Vec::new(), ..crowded() };
    for (i, row) in coefficients(&run(&plant), &plant).iter().enumerate() {
        assert_balance(i, row, &plant, Wrench::default());
    }
}

/// Specific force of the loose part's mount, body axes.
fn mount(t: f64, plant: &Plant, x: f64) -> Vec3<Body> {
    let m = motion(t, plant);
    let g = Vec3::new(plant.environment.gravity_m_s2, 0.0, 0.0);
    let r = Vec3::new(x, 0.0, 0.0);
    let w = m.w_tunnel_body;
    m.r_tunnel_body.inverse() * (m.a_tunnel_cm - g) + m.w_tunnel_body_rate.cross(r) + w.cross(w.cross(r))
}

#[test]
fn law_loose_mass_follows_its_oscillator_under_over_and_at_critical_damping() {
    for damping_ratio in [0.05, 1.0, 1.7] {
        let part = LooseMass { mass_kg: 0.1, frequency_hz: 2.0, damping_ratio, x_cm_m: 0.12, in_full: 0.0 };
        let mut plant = crowded();
        plant.vehicle.loose = Some(part);
        let rows = coefficients(&run(&plant), &plant);
        let mut x = [0.0; 4];
        for (i, row) in rows.iter().enumerate() {
            if i > 0 {
                x = runge_kutta(x, row.t_s - DT, DT, |t, x| {
                    let a = part.acceleration(x, mount(t, &plant, part.x_cm_m), Vec3::zero());
                    [x[2], x[3], a[0], a[1]]
                });
            }
            let force = mount(row.t_s, &plant, part.x_cm_m);
            // Force linear between samples: h² f''/12 on average, with f'' of some 80 m/s⁴ from 0.06 m at 5.3 rad/s, times 0.1 kg.
            assert_balance_within(
                i,
                row,
                &plant,
                part.wrench(x, part.acceleration(x, force, Vec3::zero()), force, Vec3::zero()),
                7.0e-5,
            );
        }
    }
}

fn assert_balance_within(i: usize, row: &CoefficientRow, plant: &Plant, extra: Wrench, bound: f64) {
    let (m, a) = (motion(row.t_s, plant), air(row.t_s, plant));
    let v = &plant.vehicle;
    let (flow, q_pa) = plant.flow_state(&m, &a);
    let modelled = wrench_at_cm(&plant.aero.coefficients(&flow), q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm);
    let all = plant.wrench(&m, &a);
    let found = wrench_at_cm(&row.exp_origin, row.q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm);
    let needed = needed(&m, plant);
    let (f, m) = (all.f - modelled.f + found.f + extra.f - needed.f, all.m - modelled.m + found.m + extra.m - needed.m);
    assert!(f.norm() < bound && m.norm() < bound, "sample {i}: balance is off by {} N and {} N m", f.norm(), m.norm());
}

fn runge_kutta(x: [f64; 4], t: f64, h: f64, f: impl Fn(f64, [f64; 4]) -> [f64; 4]) -> [f64; 4] {
    let go = |x: [f64; 4], k: [f64; 4], s: f64| -> [f64; 4] { std::array::from_fn(|i| x[i] + s * k[i]) };
    let k1 = f(t, x);
    let k2 = f(t + 0.5 * h, go(x, k1, 0.5 * h));
    let k3 = f(t + 0.5 * h, go(x, k2, 0.5 * h));
    let k4 = f(t + h, go(x, k3, h));
    std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// All numbers of a state.
fn flat(s: &State) -> Vec<f64> {
    let vectors = [s.p_tunnel_origin, s.euler_rad, s.euler_rate, s.pqr, s.pqr_rate, s.uvw, s.uvw_rate, s.uvw_air, s.uvw_air_rate];
    let mut all: Vec<f64> = vectors.into_iter().flatten().collect();
    all.extend([s.q_pa, s.alpha_dot, s.beta_dot, s.vw, s.vw_rate]);
    all
}

fn assert_same_states(a: &[State], b: &[State], skip: usize, bound: f64) {
    for i in skip..a.len() - skip {
        for (k, (x, y)) in flat(&a[i]).iter().zip(flat(&b[i])).enumerate() {
            assert_close(&format!("number {k} of state"), i, *x, y, bound);
        }
    }
}

#[test]
fn law_delays_and_wind_scale_are_undone() {
    let truth = run(&lander());
    let mut plant = lander();
    plant.sensors.pose_delay_s = 0.0234;
    plant.sensors.wind_delay_s = 0.0567;
    plant.sensors.wind_scale = 0.03;
    // The record holds what was true a delay ago, and V_W times 1.03.
    let mut late = smoothed(SAMPLES, |c| if c == 6 { -0.0567 } else { -0.0234 });
    for x in [&mut late.channels[6].value, &mut late.channels[6].rate, &mut late.channels[6].second] {
        x.iter_mut().for_each(|v| *v *= 1.03);
    }
    let found = states(&late, &plant).expect("in range");
    // Quintic Hermite over 0.01 s of 5 rad/s: second derivative right to (ωh)⁴/1920·ω² ≈ 1e-7; the last 6 samples extrapolate.
    assert_same_states(&found, &truth, 6, 1.0e-5);
    // Beyond the end a parabola: third derivative of 0.06 · 5.3³ over 0.057 s.
    assert_same_states(&found, &truth, 0, 2.0);
}

/// A clock that runs 2 % fast, positions 4 % long, and late at that: delays are in true seconds.
#[test]
fn law_time_base_and_length_scale_are_undone() {
    let truth = run(&lander());
    let mut plant = lander();
    (plant.sensors.time_base, plant.sensors.length_scale) = (0.02, 0.04);
    plant.sensors.pose_delay_s = 0.0234;
    let mut record = smoothed(SAMPLES, |c| if c == 6 { 0.0 } else { -0.0234 });
    record.interval_s *= 1.02;
    record.t_s.iter_mut().for_each(|t| *t *= 1.02);
    for (c, x) in record.channels.iter_mut().enumerate() {
        let long = if c < 3 { 1.04 } else { 1.0 };
        x.value.iter_mut().for_each(|v| *v *= long);
        x.rate.iter_mut().for_each(|v| *v *= long / 1.02);
        x.second.iter_mut().for_each(|v| *v *= long / (1.02 * 1.02));
    }
    let found = states(&record, &plant).expect("in range");
    assert_same_states(&found, &truth, 6, 1.0e-5);
    for (a, b) in found.iter().zip(&truth) {
        assert!((a.t_s - b.t_s).abs() < 1e-13, "{} {}", a.t_s, b.t_s);
    }
}

#[test]
fn law_misalignment_is_undone() {
    let angles = [0.03, -0.05, 0.07];
    let m = EulerXyz { rx_rad: angles[0], ry_rad: angles[1], rz_rad: angles[2] }.r_tunnel_body().matrix;
    let turned = |t: f64| -> [f64; 3] {
        let e = EulerXyz::from_rotation(Rotation::<Tunnel, Body>::from_matrix(attitude(t).matrix * m));
        [e.rx_rad, e.ry_rad, e.rz_rad]
    };
    let mut record = smoothed(SAMPLES, |_| 0.0);
    for i in 0..SAMPLES {
        let t = record.t_s[i];
        let (value, first, second) = (turned(t), rate(turned, t), rate(|t| rate(turned, t), t));
        for k in 0..3 {
            let c = &mut record.channels[3 + k];
            (c.value[i], c.rate[i], c.second[i]) = (value[k], first[k], second[k]);
        }
    }
    let mut plant = lander();
    plant.sensors.misalignment_rad = angles;
    assert_same_states(&states(&record, &plant).expect("in range"), &run(&lander()), 0, CLOSE);
}
