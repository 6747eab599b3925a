//! sim tests: a rigid body in free flight. In: a body like a small airship and its source's printed equations. Out: accelerations against a
//! statement about the centre of mass, conserved quantities, the order of the integrator.

use nalgebra::{Matrix3, Vector3};
use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};
use windfall_model::{
    Aero, Coefficient, Contribution, Environment, Factor, FreeBody, FreeFlight, FreeState, Inertia, MeanFlow, MovedPart, Plant,
    PointMass, PointRecord, Sensors, Setting, Structure, Term, Thrust, Turbulence, Variable, Vehicle, WakeShedding,
};
use windfall_sim::{FreeFlown, Seed, fly_free, record_free};

use Coefficient as C;
use Variable::{Alpha, Beta};

/// zhu-yj/ABNODE, `utils/parameters.py` at commit 138a1de: coefficient, value, angle, power (0: none).
const TERMS: [(C, f64, Variable, u8); 18] = [
    (C::CA, 0.2425, Alpha, 0),
    (C::CA, 4.4195, Alpha, 2),
    (C::CA, 7.5080, Beta, 2),
    (C::CY, 0.0083, Alpha, 0),
    (C::CY, -0.0744, Alpha, 2),
    (C::CY, -2.1140, Beta, 1),
    (C::CN, 0.1594, Alpha, 0),
    (C::CN, 2.9375, Alpha, 1),
    (C::CN, 4.5537, Beta, 2),
    (C::Cl, 0.0131, Alpha, 0),
    (C::Cl, -0.0301, Alpha, 1),
    (C::Cl, -0.5256, Beta, 1),
    (C::Cm, 0.0568, Alpha, 0),
    (C::Cm, 0.0933, Alpha, 1),
    (C::Cm, 5.2357, Beta, 4),
    (C::Cn, 0.0006, Alpha, 0),
    (C::Cn, -0.0012, Alpha, 1),
    (C::Cn, -0.0936, Beta, 1),
];
/// Mass without gondola, kg, its centre, m, its inertia about the origin, kg m², gondola, kg, displaced air, kg; the same file.
const MASS: f64 = 0.10482;
const CENTRE: [f64; 3] = [-0.0432, -0.0003, 0.0079];
const ABOUT_ORIGIN: [f64; 3] = [0.03, 0.015, 0.01];
const GONDOLA: f64 = 0.05407;
const DISPLACED: f64 = 0.15204;
const DAMPING: [f64; 3] = [-0.0503, -0.0264, -0.0137];
const GRAVITY: f64 = 9.8;
/// Thrusts left and right, N, gondola x, y, z, m: one of the runs.
const INPUTS: [f64; 5] = [0.01666, 0.05292, 0.0747, 0.0006, 0.238];

fn inertia() -> Inertia {
    let r = CENTRE;
    let square: f64 = r.iter().map(|x| x * x).sum();
    let moment = |i: usize| ABOUT_ORIGIN[i] - MASS * (square - r[i] * r[i]);
    let product = |i: usize, j: usize| -MASS * r[i] * r[j];
    Inertia { xx: moment(0), yy: moment(1), zz: moment(2), xy: product(0, 1), xz: product(0, 2), yz: product(1, 2) }
}

fn structure() -> (Structure, Vec<f64>) {
    let contribution = |(i, (coefficient, _, v, power)): (usize, &(C, f64, Variable, u8))| {
        let factors: Vec<Factor> = (*power > 0).then_some(Factor::Power(*v, *power)).into_iter().collect();
        Contribution { coefficient: *coefficient, parameter: i, term: Term::new(1.0, &factors) }
    };
    let contributions = TERMS.iter().enumerate().map(contribution).collect();
    let parameters = (0..TERMS.len()).map(|i| format!("c{i}")).collect();
    (Structure { name: "wind".to_owned(), parameters, contributions }, TERMS.iter().map(|t| t.1).collect())
}

fn airship() -> Plant {
    let (structure, values) = structure();
    let gondola_z = Setting::Input(4);
    let thrust = |input: usize, y: f64| Thrust {
        size_n: Setting::Input(input),
        direction: Vec3::new(1.0, 0.0, 0.0),
        place_m: [Setting::Fixed(0.0), Setting::Fixed(y), gondola_z],
    };
    Plant {
        vehicle: Vehicle {
            mass_kg: MASS,
            inertia: inertia(),
            p_origin_cm: Vec3::from_array(CENTRE),
            diameter_m: 1.0,
            apparent: Default::default(),
            loose: None,
        },
        aero: Aero::new(structure, values),
        tether: None,
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: GRAVITY, gas_constant_j_kg_k: f64::NAN },
        sensors: Sensors::default(),
        point: PointMass { inputs: INPUTS.to_vec(), air_density_kg_m3: 1.2187, ..PointMass::default() },
        free_flight: Some(FreeFlight {
            area_m2: 0.25,
            wind_axes: true,
            buoyancy_kg: DISPLACED,
            rate_damping_n_m_s: DAMPING,
            parts: vec![MovedPart { mass_kg: GONDOLA, place_m: [Setting::Input(2), Setting::Input(3), gondola_z] }],
            thrusts: vec![thrust(0, -0.15), thrust(1, 0.15)],
            ..FreeFlight::default()
        }),
    }
}

/// Tunnel axes (X down, Y, Z) from north-east-down ones.
fn tunnel_from_ned() -> Matrix3<f64> {
    Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
}

/// Body from north-east-down by roll, pitch and yaw, as the source prints it.
fn body_from_ned([roll, pitch, yaw]: [f64; 3]) -> Matrix3<f64> {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    #[rustfmt::skip]
    let m = Matrix3::new(
        cp * cy, cp * sy, -sp,
        sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp,
        cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp,
    );
    m
}

fn state(angles: [f64; 3], v: [f64; 3], w: [f64; 3]) -> FreeState {
    let r = tunnel_from_ned() * body_from_ned(angles).transpose();
    FreeState {
        p_tunnel_origin: Vec3::zero(),
        attitude: Rotation::<Tunnel, Body>::from_matrix(r).to_quaternion(),
        v_tunnel_origin: Vec3::from_array(v),
        w_tunnel_body: Vec3::from_array(w),
    }
}

/// The source's forces and moments, put together about the centre of mass in axes that do not turn: `a = F/m`,
/// `ω̇ = J⁻¹ (M − ω × J ω)`, and carried to the origin.
fn about_the_centre(angles: [f64; 3], v: [f64; 3], w: [f64; 3]) -> [Vector3<f64>; 2] {
    let (v, w) = (Vector3::from(v), Vector3::from(w));
    let speed = v.norm();
    let (alpha, beta) = (v.z.atan2(v.x), (v.y / speed).asin());
    let mut c = [0.0; 6];
    for (coefficient, value, variable, power) in TERMS {
        let x = if variable == Alpha { alpha } else { beta };
        c[coefficient as usize] += value * x.powi(i32::from(power));
    }
    let q = 0.5 * 1.2187 * speed * speed * 0.25;
    let ((sa, ca), (sb, cb)) = (alpha.sin_cos(), beta.sin_cos());
    let wind = Matrix3::new(ca * cb, -ca * sb, -sa, sb, cb, 0.0, sa * cb, -sa * sb, ca);
    let air = wind * Vector3::new(-q * c[0], q * c[1], -q * c[2]);
    let damping = Vector3::from_fn(|i, _| DAMPING[i] * w[i]);
    let moment = wind * (Vector3::new(c[3], c[4], c[5]) * q + damping);
    let (body, gondola) = (Vector3::from(CENTRE), Vector3::new(INPUTS[2], INPUTS[3], INPUTS[4]));
    let m = MASS + GONDOLA;
    let centre = (body * MASS + gondola * GONDOLA) / m;
    let down = body_from_ned(angles) * Vector3::z();
    // Weights where the masses are, buoyancy at the origin, thrusts at their propellers.
    let pulls = [
        (body, down * (MASS * GRAVITY)),
        (gondola, down * (GONDOLA * GRAVITY)),
        (Vector3::zeros(), down * (-DISPLACED * GRAVITY)),
        (Vector3::new(0.0, -0.15, INPUTS[4]), Vector3::x() * INPUTS[0]),
        (Vector3::new(0.0, 0.15, INPUTS[4]), Vector3::x() * INPUTS[1]),
        (Vector3::zeros(), air),
    ];
    let force: Vector3<f64> = pulls.iter().map(|(_, f)| f).sum();
    let torque: Vector3<f64> = moment + pulls.iter().map(|(r, f)| (r - centre).cross(f)).sum::<Vector3<f64>>();
    let point = |mass: f64, r: Vector3<f64>| (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * mass;
    let j = Matrix3::from_diagonal(&ABOUT_ORIGIN.into()) + point(GONDOLA, gondola) - point(m, centre);
    let turning = j.try_inverse().expect("a body's inertia") * (torque - w.cross(&(j * w)));
    let of_origin = force / m - turning.cross(&centre) - w.cross(&w.cross(&centre));
    [of_origin - w.cross(&v), turning]
}

/// Round-off of sums of numbers below ten.
#[test]
fn exact_accelerations_are_those_about_the_centre_of_mass() {
    let body = FreeBody::new(&airship()).expect("a body");
    assert!((body.mass_kg() - 0.15889).abs() < 1e-12);
    for (angles, v, w) in [
        ([0.05, -0.1, 0.4], [0.5, 0.02, 0.06], [0.02, 0.08, -0.5]),
        ([-0.6, 0.7, 2.9], [0.3, -0.25, -0.2], [-0.7, 0.4, 0.9]),
        ([1.2, -1.1, -2.0], [-0.2, 0.4, 0.3], [1.5, -0.8, 0.3]),
    ] {
        let found = body.accelerations(&state(angles, v, w)).map(|x| x.xyz);
        let expected = about_the_centre(angles, v, w);
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).amax() < 1e-12, "{found:?} {expected:?}");
        }
    }
}

/// A wrench by hand: level and straight ahead at 0.5 m/s, so that α = β = 0 and only constants are left.
/// q S = 0.5·1.2187·0.25·0.25 = 0.0380844 N; net weight (0.15889 − 0.15204)·9.8 = 0.06713 N (the source's own `G`).
#[test]
fn exact_wrench_of_level_flight_by_hand() {
    let body = FreeBody::new(&airship()).expect("a body");
    let [f, m] = body.wrench(&state([0.0; 3], [0.5, 0.0, 0.0], [0.0; 3])).map(Vec3::to_array);
    let q = 0.038_084_375;
    let first = [MASS * -0.0432 + GONDOLA * 0.0747, MASS * -0.0003 + GONDOLA * 0.0006];
    let expected_f = [0.06958 - 0.2425 * q, 0.0083 * q, 0.06713 - 0.1594 * q];
    let expected_m = [
        0.0131 * q + GRAVITY * first[1],
        0.0568 * q + 0.06958 * 0.238 - GRAVITY * first[0],
        0.0006 * q + (0.01666 - 0.05292) * 0.15,
    ];
    for (a, b) in f.iter().zip(&expected_f).chain(m.iter().zip(&expected_m)) {
        assert!((a - b).abs() < 1e-12, "{f:?} {m:?}");
    }
}

fn without_air() -> Plant {
    let mut plant = airship();
    plant.point.air_density_kg_m3 = 0.0;
    let free = plant.free_flight.as_mut().expect("free");
    (free.rate_damping_n_m_s, free.thrusts) = ([0.0; 3], Vec::new());
    plant
}

fn flown(plant: &Plant, start: &FreeState, seconds: usize, step_s: f64) -> Vec<FreeState> {
    let times: Vec<f64> = (0..=10 * seconds).map(|i| 0.1 * i as f64).collect();
    fly_free(plant, &times, step_s, start).expect("flies")
}

/// Without drag, thrust and damping the sum of kinetic energy, that of the air dragged along and the potential of weight and buoyancy
/// stays; without weight as well, momentum does. Steps of 2 ms over 5 s: fourth order leaves 1e-9.
#[test]
fn law_energy_and_momentum_without_dissipation() {
    let mut plant = without_air();
    let free = plant.free_flight.as_mut().expect("free");
    free.apparent_kg = [0.03, 0.08, 0.12];
    free.p_origin_buoyancy = Vec3::new(0.01, 0.0, -0.02);
    let start = state([0.2, -0.3, 1.0], [0.4, -0.1, 0.2], [0.8, -0.5, 0.6]);
    let (mass, apparent) = (MASS + GONDOLA, [0.03, 0.08, 0.12]);
    let (body, gondola) = (Vector3::from(CENTRE), Vector3::new(INPUTS[2], INPUTS[3], INPUTS[4]));
    let centre = (body * MASS + gondola * GONDOLA) / mass;
    let point = |m: f64, r: Vector3<f64>| (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * m;
    let second = Matrix3::from_diagonal(&ABOUT_ORIGIN.into()) + point(GONDOLA, gondola);
    let energy = |s: &FreeState, g: f64| {
        let (v, w) = (s.v_tunnel_origin.xyz, s.w_tunnel_body.xyz);
        let r = Rotation::<Tunnel, Body>::from_quaternion(s.attitude).matrix;
        let depth = |at: Vector3<f64>| s.p_tunnel_origin.x() + (r * at).x;
        let moving = mass * (0.5 * v.norm_squared() + v.dot(&w.cross(&centre))) + 0.5 * w.dot(&(second * w));
        let dragged: f64 = (0..3).map(|i| 0.5 * apparent[i] * v[i] * v[i]).sum();
        moving + dragged - g * (mass * depth(centre) - DISPLACED * depth(Vector3::new(0.01, 0.0, -0.02)))
    };
    let all = flown(&plant, &start, 5, 0.002);
    let change = energy(&all[50], GRAVITY) - energy(&start, GRAVITY);
    assert!(change.abs() < 1e-9 && (all[50].w_tunnel_body - start.w_tunnel_body).norm() > 0.1, "{change}");
    plant.environment.gravity_m_s2 = 0.0;
    plant.free_flight.as_mut().expect("free").apparent_kg = [0.0; 3];
    let momentum = |s: &FreeState| {
        let r = Rotation::<Tunnel, Body>::from_quaternion(s.attitude).matrix;
        r * (s.v_tunnel_origin.xyz + s.w_tunnel_body.xyz.cross(&centre)) * mass
    };
    let last = flown(&plant, &start, 5, 0.002)[50];
    assert!((momentum(&last) - momentum(&start)).amax() < 1e-10);
}

/// A flight in air that moves steadily is that in air at rest, seen from a room that moves the other way: also with air dragged along.
#[test]
fn law_moving_air_is_a_moving_room() {
    let mut plant = airship();
    plant.free_flight.as_mut().expect("free").apparent_kg = [0.02, 0.06, 0.1];
    let start = state([0.1, -0.2, 0.5], [0.5, 0.03, 0.1], [0.1, 0.2, -0.4]);
    let still = flown(&plant, &start, 4, 0.002);
    let air = Vec3::<Tunnel>::new(0.05, -0.1, 0.2);
    plant.free_flight.as_mut().expect("free").v_tunnel_air = air;
    let r = Rotation::<Tunnel, Body>::from_quaternion(start.attitude);
    let carried = FreeState { v_tunnel_origin: start.v_tunnel_origin + r.inverse() * air, ..start };
    let moved = flown(&plant, &carried, 4, 0.002);
    for (i, (a, b)) in still.iter().zip(&moved).enumerate() {
        let along = a.p_tunnel_origin + air * (0.1 * i as f64);
        assert!((along - b.p_tunnel_origin).norm() < 1e-9 && (a.w_tunnel_body - b.w_tunnel_body).norm() < 1e-9, "{i}");
    }
}

/// Where the gondola is moves the centre of mass and the inertia; where its setting is off, both follow, and a place that is fixed stays.
#[test]
fn exact_parts_move_with_their_inputs() {
    let mut plant = airship();
    plant.point.inputs[2] = 0.1047;
    let moved = FreeBody::new(&plant).expect("a body");
    let mut shifted = airship();
    shifted.free_flight.as_mut().expect("free").part_shift = Vec3::new(0.03, 0.0, 0.0);
    let shifted = FreeBody::new(&shifted).expect("a body");
    let s = state([0.1, 0.2, 0.3], [0.4, 0.1, 0.1], [0.5, 0.3, -0.2]);
    for (a, b) in moved.accelerations(&s).iter().zip(shifted.accelerations(&s)) {
        assert!((*a - b).norm() < 1e-14);
    }
    let at_rest = state([0.0; 3], [0.0; 3], [0.0; 3]);
    let here = FreeBody::new(&airship()).expect("a body");
    // Nose down by the moved weight alone: 0.05407 kg · 9.8 m/s² · 0.03 m.
    let more = moved.wrench(&at_rest)[1] - here.wrench(&at_rest)[1];
    assert!((more.to_array()[1] + GONDOLA * GRAVITY * 0.03).abs() < 1e-15 && more.to_array()[0].abs() < 1e-15, "{more:?}");
    let mut lacking = airship();
    lacking.point.inputs.truncate(3);
    assert!(FreeBody::new(&lacking).is_none());
}

/// The classical method: halving the step takes a sixteenth of the error, 2⁴ within a fifth at finite steps; and the step that closing
/// takes of a record at 60 Hz, two samples, is right to a hundredth of a millimetre over 12 s.
#[test]
fn order_four_and_right_at_the_step_of_a_record() {
    let start = state([0.05, -0.1, 0.4], [0.5, 0.02, 0.06], [0.02, 0.08, -0.5]);
    let end = |step_s: f64| flown(&airship(), &start, 12, step_s)[120].p_tunnel_origin;
    let exact = end(0.1 / 64.0);
    let errors = [0.1, 0.05, 0.025].map(|h| (end(h) - exact).norm());
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 16.0 - 1.0).abs() < 0.3, "{errors:?}");
    }
    assert!((end(1.0 / 30.0) - exact).norm() < 1e-5, "{errors:?}");
    assert!(fly_free(&without_air(), &[0.0, -0.1], 0.1, &start).is_err());
    assert!(fly_free(&without_air(), &[0.0, 0.1], 0.0, &start).is_err());
}

/// A record's times are those of its rate, and between two of them the body is flown in two steps, whatever its clock says.
#[test]
fn exact_a_record_is_flown_in_two_steps_a_sample() {
    let start = state([0.05, -0.1, 0.4], [0.5, 0.02, 0.06], [0.02, 0.08, -0.5]);
    for ticks in [1.0, 0.75] {
        let mut plant = airship();
        plant.sensors.time_base = ticks - 1.0;
        let flown = record_free(&plant, 2.0, 8.0, &start, None).expect("flies");
        let times: Vec<f64> = (0..17).map(|i| f64::from(i) / 8.0).collect();
        assert_eq!(flown.record.t_s, times);
        let truth: Vec<f64> = times.iter().map(|t| t / ticks).collect();
        assert_eq!(flown.states, fly_free(&plant, &truth, 1.0 / (16.0 * ticks), &start).expect("flies"), "{ticks}");
    }
}

/// What is recorded: the tracked point in a longer unit by a faster clock, another attitude; and noise of the stated sizes about it, the same for
/// the same seed.
#[test]
fn law_records_carry_the_instruments_errors() {
    let mut plant = airship();
    plant.point.inputs = vec![0.0747, 0.0006, 0.238, 0.01666, 0.05292];
    let start = FreeState {
        p_tunnel_origin: Vec3::new(1.0, 2.0, 3.0),
        attitude: [1.0, 0.0, 0.0, 0.0],
        v_tunnel_origin: Vec3::new(0.4, 0.0, 0.1),
        w_tunnel_body: Vec3::zero(),
    };
    let record = |p: &Plant, seed| record_free(p, 4.0, 50.0, &start, seed).expect("flies");
    let exact = record(&plant, None);
    assert_eq!((exact.record.t_s.len(), exact.states.len(), exact.steps), (201, 201, 400));
    let mut off = plant.clone();
    (off.sensors.length_scale, off.sensors.time_base) = (0.02, 0.25);
    off.free_flight.as_mut().expect("free").p_origin_tracked = Vec3::new(0.1, 0.0, 0.0);
    off.sensors.misalignment_rad = [0.0, 0.0, 0.1];
    let seen = record(&off, None);
    // At 1.25 s of the fast clock one second has passed; body x is tunnel X at the start.
    let along = |r: &PointRecord, axis: usize, i: usize| r.position_m[axis].as_ref().expect("measured")[i];
    assert!((along(&seen.record, 0, 0) - 1.02 * 1.1).abs() < 1e-12);
    let state = |f: &FreeFlown, i: usize| f.states[i].p_tunnel_origin.to_array();
    assert!(state(&seen, 50).iter().zip(state(&exact, 40)).all(|(a, b)| (a - b).abs() < 1e-7));
    let [w, x, y, z] = seen.record.attitude[0];
    assert!((w - 0.05_f64.cos()).abs() < 1e-12 && x.abs() + y.abs() < 1e-12 && (z - 0.05_f64.sin()).abs() < 1e-12);
    (plant.sensors.position_std_m, plant.sensors.roll_std_rad, plant.sensors.pitch_yaw_std_rad) = (0.002, 0.01, 0.02);
    let seed = Some(Seed { campaign: 9, run: 1 });
    let noisy = record(&plant, seed);
    assert_eq!(noisy.record, record(&plant, seed).record);
    let mut squares = [0.0; 4];
    for i in 0..201 {
        squares[0] += (along(&noisy.record, 0, i) - along(&exact.record, 0, i)).powi(2);
        let turned = Rotation::<Tunnel, Body>::from_quaternion(exact.record.attitude[i]).inverse()
            * Rotation::<Tunnel, Body>::from_quaternion(noisy.record.attitude[i]);
        let q = turned.to_quaternion();
        (0..3).for_each(|k| squares[k + 1] += (2.0 * q[k + 1]).powi(2));
    }
    for (square, std) in squares.iter().zip([0.002, 0.01, 0.02, 0.02]) {
        // A standard deviation from 201 draws is known to 5 %: three times that.
        assert!(((square / 201.0).sqrt() / std - 1.0).abs() < 0.15, "{squares:?}");
    }
}
