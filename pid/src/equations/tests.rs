use super::*;
use crate::euler::euler_rates;
use windfall_model::frames::{EulerXyz, Vec3};
use windfall_model::{
    Aero, AirState, Environment, Inertia, MeanFlow, Motion, PointMass, Sensors, Structure, Tether, Turbulence, Vehicle,
    WakeShedding,
};

const TABLE_5_5: [f64; 11] = [6.662, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.1, -190.0];

/// Samples from a run's first on, with these parameters held.
fn segment<'a>(craft: &'a Craft<'a>, drive: &'a Drive, interval_s: f64, density: &'a [f64]) -> Segment<'a> {
    Segment {
        craft,
        drive,
        parameters: &TABLE_5_5,
        columns: &[None; 11],
        free: 0,
        start_s: 0.0,
        interval_s,
        density,
        steps: density.len(),
        spread_m_s: [0.0; 3],
    }
}

/// A tunnel speed that stays.
fn steady(steps: usize) -> Drive {
    Drive { states: 1, splits: 1, at: vec![vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 2 * steps + 1] }
}

/// A lander with everything that these equations know, none of it null.
pub(crate) fn plant() -> Plant {
    let mut tether = Tether::declared(Vec3::new(-0.25, 0.01, 0.02), Vec3::new(-3.0, 0.1, 0.0), 0.0013, 0.0165);
    tether.line_rate_n_s_m = 0.05;
    tether.length_per_m = 0.1;
    Plant {
        vehicle: Vehicle {
            mass_kg: 0.7873,
            inertia: Inertia { xx: 0.02113, yy: 0.0138, zz: 0.01379, xy: 1e-4, xz: -2e-4, yz: 3e-4 },
            p_origin_cm: Vec3::new(0.01, -0.003, 0.002),
            diameter_m: 0.2125,
            apparent: windfall_model::ApparentMass::default(),
            loose: None,
        },
        aero: Aero::new(Structure::axisymmetric(), TABLE_5_5.to_vec()),
        tether: Some(tether),
        flow: MeanFlow {
            profile_per_m2: 0.1,
            gradient_per_m: [0.02, -0.03],
            swirl_rad_per_m: 0.05,
            angularity_rad: [0.01, 0.02],
            steady_at_m_s: 0.0,
        },
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: 9.80665, gas_constant_j_kg_k: 287.05287 },
        sensors: Sensors::default(),
        point: PointMass::default(),
        free_flight: None,
    }
}

const STATE: [f64; STATES] = [0.1, -0.2, 0.3, 0.8, 0.15, -0.2, 0.2, 0.4, -0.3, 0.2, 0.9, -1.1];
const AIR: TunnelAir = TunnelAir { t_s: 0.3, density_kg_m3: 1.18, vw_m_s: 7.4, vw_rate_m_s2: 0.2 };

/// The rate by Newton and Euler as residuals: the model's own forces at the accelerations that these equations give must balance.
#[test]
fn exact_forces_of_the_model_balance_the_motion() {
    let plant = plant();
    let craft = Craft::new(&plant).expect("integrable");
    let mut terms = vec![0.0; craft.terms.acts.len()];
    let extra = Extra { velocity: [0.1, -0.2, 0.3], acceleration: [1.0, -2.0, 0.5], coefficients: [0.0; 6] };
    let rate = craft.rate(&STATE, AIR, &extra, &plant.aero.values, &mut terms).expect("there is flow");
    let three = |from: usize, x: &[f64; STATES]| [x[from], x[from + 1], x[from + 2]];
    let [rx_rad, ry_rad, rz_rad] = three(3, &STATE);
    let r = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body();
    let motion = Motion {
        t_s: AIR.t_s,
        p_tunnel_cm: Vec3::from_array(three(0, &STATE)),
        v_tunnel_cm: Vec3::from_array(three(6, &STATE)),
        r_tunnel_body: r,
        w_tunnel_body: Vec3::from_array(three(9, &STATE)),
        a_tunnel_cm: Vec3::from_array(three(6, &rate)),
        w_tunnel_body_rate: Vec3::from_array(three(9, &rate)),
    };
    let air = AirState {
        vw_m_s: AIR.vw_m_s,
        vw_rate_m_s2: AIR.vw_rate_m_s2,
        density_kg_m3: AIR.density_kg_m3,
        gust: Vec3::from_array(extra.velocity),
        gust_rate: Vec3::from_array(extra.acceleration),
        coefficient_noise: [0.0; 6],
    };
    let wrench = plant.wrench(&motion, &air);
    let v = &plant.vehicle;
    let needed = (r.inverse() * (motion.a_tunnel_cm - Vec3::new(9.80665, 0.0, 0.0))) * v.mass_kg;
    let inertia = v.inertia.matrix();
    let w = motion.w_tunnel_body.xyz;
    let moment = inertia * motion.w_tunnel_body_rate.xyz + w.cross(&(inertia * w));
    // Forces of 8 N and moments of 1 N m: a few roundings.
    assert!((needed - wrench.f).norm() < 1e-13, "{needed:?} {:?}", wrench.f);
    assert!((moment - wrench.m.xyz).norm() < 1e-13, "{moment:?} {:?}", wrench.m);
    let (euler_rate, _) = euler_rates(three(3, &STATE), three(9, &STATE), [0.0; 3]);
    for k in 0..3 {
        assert!((rate[k] - STATE[6 + k]).abs() < 1e-15 && (rate[3 + k] - euler_rate[k]).abs() < 1e-14);
    }
}

fn drive() -> Drive {
    // Tunnel speed as a parabola, and one gust state that decays along Y.
    let row = |t: f64| {
        let mut m = vec![0.0; INPUTS * 4];
        m[0..3].copy_from_slice(&[1.0, t, 0.5 * t * t]);
        m[4..7].copy_from_slice(&[0.0, 1.0, t]);
        m[3 * 4 + 3] = (-2.0 * t).exp();
        m[6 * 4 + 3] = -2.0 * (-2.0 * t).exp();
        m
    };
    Drive { states: 4, splits: 1, at: (0..=40).map(|i| row(f64::from(i) / 300.0)).collect() }
}

/// Derivatives of the map against central differences of the map, to the order of the method (differences: rounding 1e-16 of states of
/// size 10, over 2e-5, and a third derivative of order 100 times h²/6; RK4: (λh)⁵/120 a step for the fastest motion, 5 rad/s).
/// Tied parameters share a column, held ones have none.
#[test]
fn exact_variational_equations_are_the_derivatives_of_the_map() {
    let plant = plant();
    let craft = Craft::new(&plant).expect("integrable");
    let drive = drive();
    let mut columns: Vec<Option<usize>> = (0..9).map(Some).collect();
    columns.extend([Some(7), Some(8)]);
    columns[3] = None;
    let base = Segment { columns: &columns, free: 9, ..segment(&craft, &drive, 1.0 / 150.0, &[1.18; 20]) };
    let inputs = [7.4, 0.2, -1.0, 0.3];
    let mut out = Transition::default();
    assert!(base.differentiate(STATE, &inputs, &mut out));
    let (states, slopes) = (out.states.clone(), out.slopes.clone());
    let width = STATES + 4 + 9;
    let mut fly = |x, s: &[f64; 4], p: &[f64]| {
        assert!(Segment { parameters: p, ..base }.fly(x, s, &mut out));
        out.states[19]
    };
    let bits = |x: [f64; STATES]| x.map(f64::to_bits);
    assert_eq!(bits(fly(STATE, &inputs, &plant.aero.values)), bits(states[19]), "the same map with and without derivatives");
    for column in 0..width {
        let h = 1e-5;
        let mut moved = |h: f64| {
            let (mut x, mut s, mut p) = (STATE, inputs, plant.aero.values.clone());
            match column {
                c if c < STATES => x[c] += h,
                c if c < STATES + 4 => s[c - STATES] += h,
                c => (0..11).filter(|i| columns[*i] == Some(c - STATES - 4)).for_each(|i| p[i] += h),
            }
            fly(x, &s, &p)
        };
        let (up, down) = (moved(h), moved(-h));
        for row in 0..STATES {
            let difference = (up[row] - down[row]) / (2.0 * h);
            let slope = slopes[19][row * width + column];
            assert!((difference - slope).abs() < 1e-7 * (1.0 + slope.abs()), "row {row} column {column}: {slope} {difference}");
        }
    }
}

/// A contact acts at the run's time, wherever a piece begins: against the classical method on the public rates, to rounding.
#[test]
fn exact_a_contact_acts_at_the_time_of_the_run() {
    let mut plant = plant();
    plant.contacts = vec![windfall_model::Contact {
        run: 0,
        start_s: 0.13,
        duration_s: 0.05,
        impulse: Vec3::new(0.02, -0.03, 0.01),
        angular_impulse: Vec3::new(0.001, 0.002, -0.003),
    }];
    let craft = Craft::new(&plant).expect("integrable");
    let (start_s, h, steps, vw_m_s) = (0.11, 0.013, 5, 7.4);
    let drive = steady(steps);
    let segment = Segment { start_s, ..segment(&craft, &drive, h, &[1.18; 5]) };
    let mut out = Transition::default();
    assert!(segment.fly(STATE, &[vw_m_s], &mut out));
    let mut x = [0.0; MOTION];
    x[..STATES].copy_from_slice(&STATE);
    let rate = |x: &[f64; MOTION], t_s: f64| {
        let air = TunnelAir { t_s, density_kg_m3: 1.18, vw_m_s, vw_rate_m_s2: 0.0 };
        craft.rates(x, air, &[0.0; ADDED], &mut Vec::new()).expect("there is flow")
    };
    let along = |x: &[f64; MOTION], k: &[f64; MOTION], h: f64| -> [f64; MOTION] { std::array::from_fn(|i| x[i] + h * k[i]) };
    for step in 0..steps {
        let t = start_s + h * step as f64;
        let a = rate(&x, t);
        let b = rate(&along(&x, &a, 0.5 * h), t + 0.5 * h);
        let c = rate(&along(&x, &b, 0.5 * h), t + 0.5 * h);
        let d = rate(&along(&x, &c, h), t + h);
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        assert!((0..STATES).all(|i| (x[i] - out.states[step][i]).abs() < 1e-12), "{step}: {x:?} {:?}", out.states[step]);
    }
}

/// Halving the step divides the error by sixteen.
#[test]
fn order_four_of_the_integrator() {
    let plant = plant();
    let craft = Craft::new(&plant).expect("integrable");
    let end = |steps: usize| {
        let h = 0.4 / steps as f64;
        let row = |t: f64| {
            let mut m = vec![0.0; INPUTS * 2];
            m[0..2].copy_from_slice(&[1.0, t]);
            m[3] = 1.0;
            m
        };
        let drive = Drive { states: 2, splits: 1, at: (0..=2 * steps).map(|i| row(0.5 * h * i as f64)).collect() };
        let density = vec![1.18; steps];
        let mut out = Transition::default();
        assert!(segment(&craft, &drive, h, &density).fly(STATE, &[7.4, 0.2], &mut out));
        out.states[steps - 1]
    };
    let exact = end(640);
    let error = |steps| end(steps).iter().zip(&exact).map(|(a, b)| (a - b).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    let order = (error(10) / error(20)).log2();
    assert!(order > 3.7 && order < 4.5, "order {order}");
}

#[test]
fn law_nose_on_flow_has_finite_slopes() {
    let mut plant = plant();
    plant.flow = MeanFlow::default();
    plant.tether = None;
    plant.vehicle.p_origin_cm = Vec3::zero();
    let craft = Craft::new(&plant).expect("integrable");
    let drive = steady(1);
    let segment = segment(&craft, &drive, 0.01, &[1.18]);
    let mut out = Transition::default();
    assert!(segment.differentiate([0.0; STATES], &[7.4], &mut out));
    // A pitch angle of dθ turns the nose by dθ: C_m,sin α pulls it back, q̇ = q S d C_m,sin/I_yy dθ.
    let stiffness = 0.5 * 1.18 * 7.4 * 7.4 * plant.vehicle.area_m2() * 0.2125 * -2.0655 / 0.0138;
    let slope = out.slopes[0][10 * 13 + 4] / 0.01;
    assert!((slope / stiffness - 1.0).abs() < 0.05, "{slope} {stiffness}");
}

/// A body that pitches with its nose on the flow, in a side gust of which only the standard deviation is known: α² is σ²/V² on average,
/// so C_m,2 adds C_m,2 σ²/V² to the damping of q + α̇ = 2q. What else is of second order acts on C_m,1: 1/60 of that.
#[test]
fn exact_unknown_gust_adds_the_mean_of_damping_that_grows_with_the_angle() {
    let mut plant = plant();
    plant.flow = MeanFlow::default();
    plant.tether = None;
    plant.vehicle.p_origin_cm = Vec3::zero();
    let craft = Craft::new(&plant).expect("integrable");
    let drive = steady(1);
    let (h, q, sigma, vw) = (1e-4, 0.1, 0.1, 7.4);
    let mut x = [0.0; STATES];
    x[10] = q;
    let rate = |spread_m_s: [f64; 3]| {
        let segment = Segment { spread_m_s, ..segment(&craft, &drive, h, &[1.18]) };
        let mut out = Transition::default();
        assert!(segment.fly(x, &[vw], &mut out));
        (out.states[0][10] - q) / h
    };
    let inertia = plant.vehicle.inertia.matrix()[(1, 1)];
    let scale = 0.5 * 1.18 * vw * vw * plant.vehicle.area_m2() * 0.2125 / inertia * 0.25 * 0.2125 / vw * 2.0 * q;
    let added = (rate([0.0, 0.0, sigma]) - rate([0.0; 3])) / scale;
    let expected = TABLE_5_5[8] * (sigma / vw).powi(2);
    assert!((added / expected - 1.0).abs() < 0.04, "{added} {expected}");
}

/// Four samples of five parts each end where twenty samples end, with the same slopes, to the rounding of twenty steps.
#[test]
fn exact_parts_of_a_sample_are_samples() {
    let plant = plant();
    let craft = Craft::new(&plant).expect("integrable");
    let (fine, inputs) = (drive(), [7.4, 0.2, -1.0, 0.3]);
    let parted = Drive { splits: 5, ..fine.clone() };
    let columns: Vec<Option<usize>> = (0..11).map(Some).collect();
    let of = |drive: &Drive, interval_s: f64, density: &[f64]| {
        let mut out = Transition::default();
        let flown = Segment { columns: &columns, free: 11, ..segment(&craft, drive, interval_s, density) };
        assert!(flown.differentiate(STATE, &inputs, &mut out));
        (out.states.clone(), out.slopes)
    };
    let (all, few) = (of(&fine, 1.0 / 150.0, &[1.18; 20]), of(&parted, 5.0 / 150.0, &[1.18; 4]));
    assert_eq!((few.0.len(), few.1.len()), (4, 4));
    for k in 0..4 {
        let pairs = few.0[k].iter().zip(&all.0[5 * k + 4]).chain(few.1[k].iter().zip(&all.1[5 * k + 4]));
        assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-11 * (1.0 + b.abs())), "sample {k}");
    }
}
