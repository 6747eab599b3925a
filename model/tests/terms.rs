//! model tests: every force and moment term by another road. In: one crowded instant. Out: whether each sign is right.
//!
//! Rates are checked by central differences along the motion (step 1e-5: truncation 1e-10 and round-off 1e-10 of quantities
//! near 10, bound 1e-7), everything else by components written out here (round-off, bound 1e-12).

use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{
    Aero, AirState, ApparentMass, Coefficient as C, CoefficientTable, Contact, Environment, Factor, FlowState, Inertia,
    LooseMass, MeanFlow, Motion, Pivot, Plant, PointAir, PointMass, Sensors, Structure, Tether, Turbulence, Variable as V,
    Vehicle, WakeShedding, Wrench, dynamic_pressure_pa, wrench_at_cm,
};

const H: f64 = 1e-5;
const VALUES: [f64; 11] = [6.6, 3.5, -2.0, 0.0125, -5.7, -2.1, 2.5, -3.3, -205.0, -3.1, -190.0];
const P: [f64; 3] = [0.3, -0.2, 0.15];
const VEL: [f64; 3] = [0.4, 1.1, -0.7];
const ACC: [f64; 3] = [-0.8, 1.3, 2.1];
const W: [f64; 3] = [0.6, -1.4, 0.9];
const W_RATE: [f64; 3] = [1.2, -0.7, 2.3];

#[track_caller]
fn close(a: f64, b: f64, bound: f64) {
    assert!((a - b).abs() <= bound * (1.0 + b.abs()), "{a} {b}");
}
#[track_caller]
fn same(a: [f64; 3], b: [f64; 3], bound: f64) {
    for (a, b) in a.iter().zip(b) {
        close(*a, b, bound);
    }
}
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn combine(a: [f64; 3], k: f64, b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + k * b[i])
}
fn vec<A: windfall_model::frames::Axes>(a: [f64; 3]) -> Vec3<A> {
    Vec3::new(a[0], a[1], a[2])
}
fn difference(f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let (a, b) = (f(H), f(-H));
    std::array::from_fn(|i| (a[i] - b[i]) / (2.0 * H))
}

/// The motion at a time near zero: attitude turned by the mean body rate, which is exact to the third order.
fn motion(t: f64) -> Motion {
    let w = combine(W, t, W_RATE);
    let turn = combine(W, 0.5 * t, W_RATE).map(|x| x * t);
    let half = 0.5 * (turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]).sqrt();
    let s = if half > 0.0 { 0.5 * half.sin() / half } else { 0.5 };
    let by = Rotation::<Body, Body>::from_quaternion([half.cos(), s * turn[0], s * turn[1], s * turn[2]]);
    let r0 = EulerXyz { rx_rad: 0.7, ry_rad: 0.3, rz_rad: -0.4 }.r_tunnel_body();
    Motion {
        t_s: 2.0 + t,
        p_tunnel_cm: vec(combine(combine(P, t, VEL), 0.5 * t * t, ACC)),
        v_tunnel_cm: vec(combine(VEL, t, ACC)),
        r_tunnel_body: r0 * by,
        w_tunnel_body: vec(w),
        a_tunnel_cm: vec(ACC),
        w_tunnel_body_rate: vec(W_RATE),
    }
}

const GUST: [f64; 3] = [0.3, -0.5, 0.2];
const GUST_RATE: [f64; 3] = [1.1, 0.4, -0.9];

fn air(t: f64) -> AirState {
    AirState {
        vw_m_s: 7.0 + 0.8 * t,
        vw_rate_m_s2: 0.8,
        density_kg_m3: 1.2,
        gust: vec(combine(GUST, t, GUST_RATE)),
        gust_rate: vec(GUST_RATE),
        coefficient_noise: [0.1, -0.2, 0.3, -0.05, 0.07, 0.02],
    }
}

fn tether() -> Tether {
    Tether {
        line_rate_n_s_m: 0.05,
        length_per_m: 0.3,
        ring_shift_m: [0.04, -0.06],
        swivel_n_m: 0.03,
        swivel_rate_rad_s: 0.4,
        ..Tether::declared(Vec3::new(-0.25, 0.02, -0.03), Vec3::new(-3.0, 0.1, -0.2), 0.0013, 0.0165)
    }
}

const FLOW: MeanFlow = MeanFlow {
    profile_per_m2: -0.3,
    gradient_per_m: [0.2, -0.1],
    swirl_rad_per_m: 0.25,
    angularity_rad: [0.03, -0.02],
    steady_at_m_s: 0.0,
};

fn plant() -> Plant {
    let mut aero = Aero::new(Structure::axisymmetric(), VALUES.to_vec());
    aero.add(C::CN, 2.5, -1.0, &[Factor::Power(V::AlphaT, 4), Factor::CosClock(3)]);
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.8,
            inertia: Inertia { xx: 0.021, yy: 0.014, zz: 0.013, xy: 0.001, xz: -0.002, yz: 0.0015 },
            p_origin_cm: Vec3::new(0.01, -0.02, 0.015),
            diameter_m: 0.2125,
            apparent: ApparentMass { axial_kg: 0.05, radial_kg: 0.08, transverse_kg_m2: 0.002, unturned: 0.0, in_gusts: 0.0 },
            loose: None,
        },
        aero,
        tether: Some(tether()),
        flow: FLOW,
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: vec![contact()],
        environment: Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 },
        sensors: Sensors::default(),
        point: PointMass::default(),
        free_flight: None,
    }
}

fn contact() -> Contact {
    Contact {
        run: 0,
        start_s: 1.9,
        duration_s: 0.4,
        impulse: Vec3::new(0.1, -0.2, 0.3),
        angular_impulse: Vec3::new(-0.01, 0.02, 0.03),
    }
}

#[test]
fn exact_wind_and_its_rate_along_the_path() {
    let at = |t: f64| {
        let (m, a) = (motion(t), air(t));
        FLOW.wind(m.p_tunnel_cm, m.v_tunnel_cm, a.vw_m_s, a.vw_rate_m_s2)
    };
    let [_, y, z] = P;
    let shape = 1.0 - 0.3 * (y * y + z * z) + 0.2 * y - 0.1 * z;
    same(at(0.0).v_tunnel_air.to_array(), [-7.0 * shape, 7.0 * (0.03 - 0.25 * z), 7.0 * (-0.02 + 0.25 * y)], 1e-12);
    same(at(0.0).a_tunnel_air.to_array(), difference(|t| at(t).v_tunnel_air.to_array()), 1e-7);
}

#[test]
fn exact_flow_variables_and_wind_angle_rates() {
    let (vd, w, d) = ([-0.4, 3.1, -2.2], [0.3, -1.4, 0.9], 0.2125);
    for v0 in [[7.0, -1.2, 2.1], [-3.0, 2.0, 1.5]] {
        let f = FlowState::new(vec(v0), vec(vd), vec(w), d);
        let angles = |t: f64| {
            let [u, v, w] = combine(v0, t, vd);
            [w.atan2(u), (v / (u * u + v * v + w * w).sqrt()).asin(), v.hypot(w).atan2(u)]
        };
        let ([u, v, ww], [alpha_dot, beta_dot, _], [alpha, beta, alpha_t]) = (v0, difference(angles), angles(0.0));
        let speed = (u * u + v * v + ww * ww).sqrt();
        let hat = d / (2.0 * speed);
        let clock = v.atan2(ww);
        let expected = [
            alpha_t.sin(),
            alpha_t.cos(),
            clock.sin(),
            clock.cos(),
            alpha,
            beta,
            alpha_t,
            w[0] * hat,
            w[1] * hat,
            w[2] * hat,
            0.5 * (w[1] + alpha_dot) * hat,
            0.5 * (w[2] - beta_dot) * hat,
            speed,
            (w[0] * hat).abs(),
        ];
        for (variable, value) in V::ALL.into_iter().zip(expected) {
            // Differences enter the two damping variables alone.
            let bound = if matches!(variable, V::PitchDamping | V::YawDamping) { 1e-9 } else { 1e-12 };
            close(f.get(variable), value, bound);
        }
    }
}

#[test]
fn exact_factors_and_structure_of_4_1_2() {
    let f = FlowState::new(vec([7.0, -1.2, 2.1]), vec([-0.4, 3.1, -2.2]), vec([0.3, -1.4, 0.9]), 0.2125);
    let (x, clock) = (f.get(V::Beta), (-1.2_f64).atan2(2.1));
    for (n, product) in [(0, 1.0), (1, x), (2, x * x), (3, x * x * x), (4, x * x * x * x)] {
        close(Factor::Power(V::Beta, n).value(&f), product, 1e-12);
    }
    close(Factor::CosClock(3).value(&f), (3.0 * clock).cos(), 1e-12);
    close(Factor::SinClock(2).value(&f), (2.0 * clock).sin(), 1e-12);
    let e = (x / 0.2).exp();
    close(Factor::Bump(V::Beta, 0.2).value(&f), 4.0 / ((e + 1.0 / e) * (e + 1.0 / e)), 1e-12);
    let mut aero = Aero::new(Structure::axisymmetric(), VALUES.to_vec());
    aero.add(C::CN, 2.5, -1.0, &[Factor::Power(V::Alpha, 1), Factor::Power(V::Beta, 1)]);
    let (s, [_, cn1, cn2, cl0, clp, cm1, cm2, c1, c2, n1, n2]) = (f.get(V::SinAlphaT), VALUES);
    let (force, moment) = (cn1 * s + cn2 * s * s * s, cm1 * s + cm2 * s * s * s);
    let alpha = f.get(V::Alpha);
    let expected = [
        VALUES[0] * f.get(V::CosAlphaT),
        -force * clock.sin(),
        force * clock.cos() - 2.5 * alpha * x,
        cl0 + clp * f.get(V::RollRate),
        moment * clock.cos() + (c1 + c2 * alpha * alpha) * f.get(V::PitchDamping),
        -moment * clock.sin() + (n1 + n2 * x * x) * f.get(V::YawDamping),
    ];
    for (c, e) in aero.coefficients(&f).iter().zip(expected) {
        close(*c, e, 1e-12);
    }
}

#[test]
fn exact_air_and_coefficients_to_wrench_b_64_to_b_66() {
    let air = Environment { gravity_m_s2: 9.8, gas_constant_j_kg_k: 287.0 };
    close(air.density_kg_m3(101_000.0, 295.0), 101_000.0 / 287.0 / 295.0, 1e-12);
    close(dynamic_pressure_pa(1.2, 7.0), 29.4, 1e-12);
    let (c, p, qs) = ([6.0, -0.4, 0.7, 0.02, -0.3, 0.5], [0.01, -0.02, 0.015], 30.0 * 0.035);
    let w = wrench_at_cm(&c, 30.0, 0.035, 0.2, vec(p));
    let f = [-qs * 6.0, qs * -0.4, -qs * 0.7];
    let about_origin = [qs * 0.2 * 0.02, qs * 0.2 * -0.3, qs * 0.2 * 0.5];
    same(w.f.to_array(), f, 1e-12);
    same(w.m.to_array(), combine(about_origin, -1.0, cross(p, f)), 1e-12);
    close(plant().vehicle.area_m2(), 0.106_25 * 0.106_25 * std::f64::consts::PI, 1e-12);
}

#[test]
fn exact_tether_line_pull_and_moment_b_27_to_b_36() {
    let (k, p_cm) = (tether(), plant().vehicle.p_origin_cm);
    let hook = |t: f64| (motion(t).p_tunnel_cm + motion(t).r_tunnel_body * (k.p_origin_hook - p_cm)).to_array();
    let ring = [-3.0, 0.1 + 0.04, -0.2 - 0.06];
    let to_ring = |t: f64| combine(ring, -1.0, hook(t));
    let length = |t: f64| to_ring(t).iter().map(|x| x * x).sum::<f64>().sqrt();
    let m = motion(0.0);
    let line = k.line(m.p_tunnel_cm, m.v_tunnel_cm, m.r_tunnel_body, m.w_tunnel_body, p_cm);
    close(line.length_m, length(0.0), 1e-12);
    close(line.length_rate_m_s, difference(|t| [length(t); 3])[0], 1e-7);
    same((m.r_tunnel_body * line.direction).to_array(), to_ring(0.0).map(|x| x / length(0.0)), 1e-12);
    let nominal = (9.0_f64 + 0.01 + 0.04).sqrt() - (0.0625_f64 + 0.0004 + 0.0009).sqrt();
    let pull = (30.0 * 0.0013 - 0.0165) * (1.0 + 0.3 * (line.length_m - nominal)) + 0.05 * line.length_rate_m_s;
    close(k.pull_n(30.0, line.length_m, line.length_rate_m_s), pull, 1e-12);
    let w = k.wrench(&line, 30.0, p_cm);
    same(w.f.to_array(), line.direction.to_array().map(|x| x * pull), 1e-12);
    let moment = cross((k.p_origin_hook - p_cm).to_array(), w.f.to_array());
    // The swivel against a roll of 0.6 rad/s, 1.5 times the rate over which it grows.
    let swivel = -0.03 * (1.5_f64.exp() - (-1.5_f64).exp()) / (1.5_f64.exp() + (-1.5_f64).exp());
    same(w.m.to_array(), combine(moment, 1.0, [swivel, 0.0, 0.0]), 1e-12);
}

/// Kirchhoff: force and moment are minus the rates of impulse and angular impulse, which are differentiated in fixed axes.
#[test]
fn exact_apparent_mass_takes_the_impulse_of_the_air() {
    let plant = plant();
    let k = plant.vehicle.apparent;
    let relative = |t: f64| {
        let (m, a) = (motion(t), air(t));
        let wind = plant.flow.wind(m.p_tunnel_cm, m.v_tunnel_cm, a.vw_m_s, a.vw_rate_m_s2);
        m.r_tunnel_body.inverse() * (m.v_tunnel_cm - wind.v_tunnel_air)
    };
    let linear = |t: f64| {
        let u = relative(t);
        (motion(t).r_tunnel_body * Vec3::new(k.axial_kg * u.x(), k.radial_kg * u.y(), k.radial_kg * u.z())).to_array()
    };
    let angular = |t: f64| {
        let w = motion(t).w_tunnel_body;
        (motion(t).r_tunnel_body * Vec3::new(0.0, k.transverse_kg_m2 * w.y(), k.transverse_kg_m2 * w.z())).to_array()
    };
    let m = motion(0.0);
    let got = plant.apparent_wrench(&m, &air(0.0));
    same((m.r_tunnel_body * got.f).to_array(), difference(linear).map(|x| -x), 1e-7);
    let carried = cross((m.r_tunnel_body * relative(0.0)).to_array(), linear(0.0));
    same((m.r_tunnel_body * got.m).to_array(), combine(carried.map(|x| -x), -1.0, difference(angular)), 1e-7);
}

/// As far as gusts are told, they are air like the wind; as far as it is told, momentum of turning is not turned.
#[test]
fn exact_apparent_mass_in_gusts_and_unturned() {
    let mut plant = plant();
    let m = motion(0.0);
    let whole = plant.apparent_wrench(&m, &air(0.0));
    plant.vehicle.apparent.unturned = 0.25;
    let part = plant.apparent_wrench(&m, &air(0.0));
    let [_, q, r] = W.map(|w| 0.002 * w);
    same(part.f.to_array(), whole.f.to_array(), 0.0);
    same(part.m.to_array(), combine(whole.m.to_array(), 0.25, cross(W, [0.0, q, r])), 1e-12);
    let k = ApparentMass { unturned: 0.0, in_gusts: 0.5, ..plant.vehicle.apparent };
    plant.vehicle.apparent = k;
    let relative = |t: f64| {
        let (m, a) = (motion(t), air(t));
        let wind = plant.flow.wind(m.p_tunnel_cm, m.v_tunnel_cm, a.vw_m_s, a.vw_rate_m_s2).v_tunnel_air + a.gust * 0.5;
        m.r_tunnel_body.inverse() * (m.v_tunnel_cm - wind)
    };
    let linear = |t: f64| {
        let u = relative(t);
        (motion(t).r_tunnel_body * Vec3::new(k.axial_kg * u.x(), k.radial_kg * u.y(), k.radial_kg * u.z())).to_array()
    };
    let found = plant.apparent_wrench(&m, &air(0.0)).f;
    same((m.r_tunnel_body * found).to_array(), difference(linear).map(|x| -x), 1e-7);
}

#[test]
fn exact_flow_state_sees_gusts_and_turning_axes() {
    let plant = plant();
    let relative = |t: f64| {
        let (m, a) = (motion(t), air(t));
        let wind = plant.flow.wind(m.p_tunnel_cm, m.v_tunnel_cm, a.vw_m_s, a.vw_rate_m_s2).v_tunnel_air.to_array();
        let v = combine(combine(m.v_tunnel_cm.to_array(), -1.0, wind), -1.0, a.gust.to_array());
        (m.r_tunnel_body.inverse() * vec(v)).to_array()
    };
    let (f, q_pa) = plant.flow_state(&motion(0.0), &air(0.0));
    let expected = FlowState::new(vec(relative(0.0)), vec(difference(relative)), vec(W), 0.2125);
    for v in V::ALL {
        close(f.get(v), expected.get(v), 1e-7);
    }
    close(q_pa, 0.6 * relative(0.0).iter().map(|x| x * x).sum::<f64>(), 1e-12);
}

#[test]
fn law_wrench_is_the_sum_of_its_parts() {
    let (plant, m, air) = (plant(), motion(0.0), air(0.0));
    let v = &plant.vehicle;
    let (f, q_pa) = plant.flow_state(&m, &air);
    let pure = plant.aero.coefficients(&f);
    let c: [f64; 6] = std::array::from_fn(|i| pure[i] + air.coefficient_noise[i]);
    let line = tether().line(m.p_tunnel_cm, m.v_tunnel_cm, m.r_tunnel_body, m.w_tunnel_body, v.p_origin_cm);
    let parts: [Wrench; 4] = [
        wrench_at_cm(&c, q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm),
        tether().wrench(&line, q_pa, v.p_origin_cm),
        plant.apparent_wrench(&m, &air),
        contact().wrench(m.t_s),
    ];
    let total = plant.wrench(&m, &air);
    let sum = |part: fn(&Wrench) -> [f64; 3]| parts.iter().map(part).fold([0.0; 3], |a, b| combine(a, 1.0, b));
    same(total.f.to_array(), sum(|w| w.f.to_array()), 1e-12);
    same(total.m.to_array(), sum(|w| w.m.to_array()), 1e-12);
}

/// The midpoint rule is exact for a squared sine over its period.
#[test]
fn exact_contact_gives_its_impulses_and_nothing_before_or_after() {
    let k = contact();
    let (mut f, mut m) = ([0.0; 3], [0.0; 3]);
    for i in 0..40 {
        let w = k.wrench(1.9 + 0.4 * (f64::from(i) + 0.5) / 40.0);
        (f, m) = (combine(f, 0.01, w.f.to_array()), combine(m, 0.01, w.m.to_array()));
    }
    same(f, k.impulse.to_array(), 1e-12);
    same(m, k.angular_impulse.to_array(), 1e-12);
    assert!(k.wrench(2.1).f.norm() > 1.9 * k.impulse.norm() / 0.4, "greatest in the middle");
    assert_eq!((k.wrench(1.899), k.wrench(2.301)), (Wrench::default(), Wrench::default()));
}

/// Four point masses: moments and products as sums.
#[test]
fn exact_inertia_matrix_of_point_masses() {
    let masses = [(0.3, [0.1, 0.2, -0.1]), (0.2, [-0.2, 0.1, 0.3]), (0.1, [0.3, -0.1, 0.2]), (0.4, [0.0, 0.15, 0.1])];
    let sum = |f: fn([f64; 3]) -> f64| masses.iter().map(|(m, r)| m * f(*r)).sum::<f64>();
    let inertia = Inertia {
        xx: sum(|[_, y, z]| y * y + z * z),
        yy: sum(|[x, _, z]| x * x + z * z),
        zz: sum(|[x, y, _]| x * x + y * y),
        xy: sum(|[x, y, _]| x * y),
        xz: sum(|[x, _, z]| x * z),
        yz: sum(|[_, y, z]| y * z),
    };
    assert!(inertia.is_physical());
    let momentum = masses.iter().fold([0.0; 3], |h, (m, r)| combine(h, *m, cross(*r, cross(W, *r))));
    same((inertia.matrix() * vec::<Body>(W).xyz).into(), momentum, 1e-12);
    for flat in [[3.0, 1.0, 1.0], [1.0, 3.0, 1.0], [1.0, 1.0, 3.0], [-1.0, 1.0, 1.0]] {
        let [xx, yy, zz] = flat;
        assert!(!Inertia { xx, yy, zz, ..Inertia::default() }.is_physical());
    }
}

/// Free oscillation in closed form, and d'Alembert's forces of a particle beside its rest position.
#[test]
fn exact_loose_part_oscillates_and_pushes_back() {
    let part = LooseMass { mass_kg: 0.05, frequency_hz: 3.0, damping_ratio: 0.2, x_cm_m: 0.07, in_full: 1.0 };
    let natural = std::f64::consts::TAU * 3.0;
    let damped = natural * (1.0_f64 - 0.04).sqrt();
    let place = |t: f64, phase: f64| (-0.2 * natural * t).exp() * (damped * t + phase).cos();
    let rates = |t: f64| {
        let phases = [0.3, 1.1, 0.0];
        let d = 1e-6;
        phases.map(|f| (place(t + d, f) - place(t - d, f)) / (2.0 * d))
    };
    let (push, v) = ([0.4, -0.9, 1.7], rates(0.0));
    let a = part.acceleration([place(0.0, 0.3), place(0.0, 1.1), v[0], v[1]], vec(push), Vec3::zero());
    let free = difference(rates);
    // Second differences of quantities near 400 at steps of 1e-6 and 1e-5.
    close(a[0], free[0] + 0.9, 1e-5);
    close(a[1], free[1] - 1.7, 1e-5);
    // A particle at ρ = (0.07, 0.01, -0.02) of acceleration `felt + ω̇ × ρ' + ω × (ω × ρ') + 2 ω × v + ξ̈` beyond a fixed one's.
    let (off, v, w, w_rate) = ([0.0, 0.01, -0.02], [0.0, 0.3, 0.2], [1.0, -2.0, 0.5], [4.0, 3.0, -6.0]);
    let state = [off[1], off[2], v[1], v[2]];
    let carried = part.carried(state, vec(w), vec(w_rate));
    let turned = combine(cross(w_rate, off), 1.0, cross(w, cross(w, off)));
    let expected = combine(turned, 2.0, cross(w, v));
    same(carried.to_array(), expected, 1e-12);
    let found = part.wrench(state, [3.0, -2.0], vec(push), carried);
    let f = combine([0.0, 3.0, -2.0], 1.0, expected).map(|x| -0.05 * x);
    same(found.f.to_array(), f, 1e-12);
    let displaced = cross(off, push.map(|x| -0.05 * x));
    same(found.m.to_array(), combine(cross([0.07, 0.01, -0.02], f), 1.0, displaced), 1e-12);
    let first = LooseMass { in_full: 0.0, ..part };
    same(first.carried(state, vec(w), vec(w_rate)).to_array(), [0.0; 3], 0.0);
    let found = first.wrench(state, [3.0, -2.0], vec(push), Vec3::zero());
    same(found.f.to_array(), [0.0, -0.15, 0.1], 1e-12);
    same(found.m.to_array(), combine(cross([0.07, 0.0, 0.0], [0.0, -0.15, 0.1]), 1.0, displaced), 1e-12);
    // What carries it pushes it as the mount does.
    let both = part.acceleration(state, vec(push), vec([0.0, 0.25, -0.5]));
    let mount = part.acceleration(state, vec(push), Vec3::zero());
    same([both[0], both[1], 0.0], [mount[0] - 0.25, mount[1] + 0.5, 0.0], 1e-12);
}

/// A body on a pivot, turning either way, at a rate where dry friction has not yet its full size.
#[test]
fn exact_moments_about_a_pivot() {
    let mut plant = plant();
    let (m, g, arm, inertia, viscous, dry, density) = (0.8, 9.80665, 0.7, 0.02, 0.03, 0.004, 1.2);
    plant.vehicle.mass_kg = m;
    plant.environment.gravity_m_s2 = g;
    plant.aero = Aero::new(Structure::point_mass(), vec![0.45]);
    plant.aero.add(C::CA, 0.05, 1.0, &[]);
    plant.point = PointMass {
        pivot: Some(Pivot { arm_m: arm, inertia_kg_m2: inertia, viscous_n_m_s: viscous, dry_n_m: dry }),
        drag_per_input: vec![0.03, 0.04],
        inputs: vec![2.0, 3.0],
        air_density_kg_m3: density,
        ..PointMass::default()
    };
    let cd = 0.45 + 0.05 + 0.03 * 2.0 + 0.04 * 3.0;
    let area = std::f64::consts::PI * plant.vehicle.diameter_m * plant.vehicle.diameter_m / 4.0;
    for (angle, rate) in [(0.4, 0.9), (-0.3, -1.2), (0.2, 5e-4_f64)] {
        let weight = -m * g * arm * f64::sin(angle);
        let friction = -viscous * rate - dry * (rate / 1e-3).tanh();
        let air = -rate.signum() * 0.5 * density * (arm * rate).powi(2) * area * cd * arm;
        let expected = (weight + friction + air) / (inertia + m * arm * arm);
        close(plant.pivot_acceleration_rad_s2(angle, rate), expected, 1e-12);
    }
}

/// Height of a static pressure that is off by a share of the dynamic pressure: −C_p v²/2g with v = 7 m/s.
#[test]
fn exact_altimeter_reads_too_much() {
    let mut plant = plant();
    plant.environment.gravity_m_s2 = 9.8;
    let v = vec::<Tunnel>([-2.0, 6.0, 3.0]);
    assert!(plant.altimeter_error_m(v).abs() <= 0.0);
    plant.point =
        PointMass { pressure_coefficient: -0.2, pressure_per_input: vec![0.03], inputs: vec![2.0], ..PointMass::default() };
    close(plant.altimeter_error_m(v), 0.14 * 2.5, 1e-12);
}

/// A ball with everything that acts on balls; vectors and triple products instead of components.
#[test]
fn exact_point_mass_forces() {
    let mut plant = plant();
    plant.aero = Aero::new(Structure::point_mass(), vec![0.45]);
    plant.aero.add(C::CA, 0.05, 1.0, &[]);
    plant.point = PointMass {
        lift_per_input: vec![0.02, -0.01],
        drag_per_input: vec![0.03, 0.04],
        lift_constant: 0.1,
        acceleration: Vec3::new(0.01, 0.02, -0.03),
        apparent_fraction: 0.5,
        buoyancy_fraction: 0.9,
        inputs: vec![2.0, 3.0],
        air_density_kg_m3: 1.2,
        side_per_input: vec![0.05, 0.02],
        side_constant: -0.3,
        ..PointMass::default()
    };
    let (v, d): ([f64; 3], f64) = ([-2.0, 6.0, 3.0], 0.2125);
    let speed = 7.0;
    let displaced = 1.2 * 4.0 / 3.0 * std::f64::consts::PI * (0.5 * d).powi(3);
    let qs = 0.5 * 1.2 * speed * speed * std::f64::consts::PI * 0.25 * d * d;
    let cd = 0.45 + 0.05 + 0.03 * 2.0 + 0.04 * 3.0;
    let cl = 0.1 + 0.02 * 2.0 - 0.01 * 3.0;
    let cs = -0.3 + 0.05 * 2.0 + 0.02 * 3.0;
    // Unit vectors: along v; horizontal across the launch; and their product, upward.
    let along = v.map(|x| x / speed);
    let level = (36.0_f64 + 9.0).sqrt();
    let across = [0.0, -3.0 / level, 6.0 / level];
    let mut up = cross(across, along);
    if up[0] > 0.0 {
        up = up.map(|x| -x);
    }
    let weight = [(0.8 - 0.9 * displaced) * 9.8, 0.0, 0.0];
    let force = combine(combine(combine(weight, -qs * cd, along), qs * cl, up), qs * cs, across);
    let expected = combine([0.01, 0.02, -0.03], 1.0 / (0.8 + 0.5 * displaced), force);
    let air = PointAir { density_kg_m3: 1.2, sound_m_s: f64::INFINITY };
    same(plant.point_acceleration_in(vec::<Tunnel>(v), air).to_array(), expected, 1e-12);
    // A table over Mach number multiplies the structure's parameter, not what comes on top; half-way between 1 and 2 at Mach 0.7.
    let mut fast = plant.clone();
    fast.point.drag_over_mach = CoefficientTable::new(vec![0.6, 0.8], vec![1.0, 2.0]);
    plant.aero.values[0] *= 1.5;
    let thin = PointAir { density_kg_m3: 1.2, sound_m_s: 10.0 };
    let [a, b] = [&fast, &plant].map(|p| p.point_acceleration_in(vec::<Tunnel>(v), thin).to_array());
    same(a, b, 1e-12);
    let falls = plant.point_acceleration_in(Vec3::new(3.0, 0.0, 0.0), air);
    assert!((falls.y() - 0.02).abs() < 1e-15 && (falls.z() + 0.03).abs() < 1e-15, "no lift without a launch direction");
}
