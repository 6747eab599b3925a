//! model tests: a rigid body in free flight by momentum and by unit vectors. In: a body with everything. Out: whether each sign is right.

use nalgebra::{Matrix3, Vector3};
use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};
use windfall_model::{
    Aero, Coefficient as C, Contribution, Environment, Factor, FreeBody, FreeFlight, FreeState, Inertia, MeanFlow, MovedPart,
    Plant, PointMass, Sensors, Setting, Structure, Term, Thrust, Turbulence, Variable as V, Vehicle, WakeShedding,
};

type Vector = Vector3<f64>;

const MASS: f64 = 0.8;
const CENTRE: [f64; 3] = [0.03, -0.02, 0.015];
const PART: f64 = 0.1;
const PLACE: [f64; 3] = [0.2, -0.1, 0.3];
const SHIFT: f64 = 0.04;
const LIFTED: f64 = 0.15;
const LIFTS_AT: [f64; 3] = [0.01, 0.02, -0.05];
const APPARENT: [f64; 3] = [0.05, 0.08, 0.11];
const WIND: [f64; 3] = [-0.7, 0.4, 0.3];
const PUSH: [f64; 3] = [0.2, -0.3, 0.1];
const TURN: [f64; 3] = [0.4, 0.5, -0.6];
const DAMPING: [f64; 3] = [-0.05, -0.03, -0.02];
const EXCESS: [f64; 3] = [0.25, -0.5, 0.75];
const COEFFICIENTS: [f64; 6] = [0.4, -0.1, 0.7, 0.02, -0.03, 0.05];
/// A steady thrust, N, and where it acts, m.
const THRUST: [f64; 3] = [0.9, 0.0, -1.2];
const THRUST_AT: [f64; 3] = [0.1, 0.4, 0.2];
const LENGTH: f64 = 0.3;
const AREA: f64 = 0.25;
const DENSITY: f64 = 1.2;
const GRAVITY: f64 = 9.8;

fn plant(wind_axes: bool) -> Plant {
    let all = [C::CA, C::CY, C::CN, C::Cl, C::Cm, C::Cn];
    // Each coefficient a constant and a share of sin α_T.
    let one = |(i, c): (usize, C)| {
        let term =
            |k: usize, factors: &[Factor]| Contribution { coefficient: c, parameter: 2 * i + k, term: Term::new(1.0, factors) };
        [term(0, &[]), term(1, &[Factor::Power(V::SinAlphaT, 1)])]
    };
    let contributions: Vec<Contribution> = all.into_iter().enumerate().flat_map(one).collect();
    let structure = Structure { name: "body".to_owned(), parameters: (0..12).map(|i| format!("c{i}")).collect(), contributions };
    Plant {
        vehicle: Vehicle {
            mass_kg: MASS,
            inertia: Inertia { xx: 0.021, yy: 0.034, zz: 0.043, xy: 0.001, xz: -0.002, yz: 0.0015 },
            p_origin_cm: Vec3::from_array(CENTRE),
            diameter_m: LENGTH,
            apparent: Default::default(),
            loose: None,
        },
        aero: Aero::new(structure, COEFFICIENTS.into_iter().flat_map(|c| [c, 0.5 * c]).collect()),
        tether: None,
        flow: MeanFlow::default(),
        turbulence: Turbulence::default(),
        shedding: WakeShedding::default(),
        drift: Default::default(),
        scatter: Default::default(),
        contacts: Vec::new(),
        environment: Environment { gravity_m_s2: GRAVITY, gas_constant_j_kg_k: f64::NAN },
        sensors: Sensors::default(),
        point: PointMass { inputs: vec![PLACE[1]], air_density_kg_m3: DENSITY, ..PointMass::default() },
        free_flight: Some(FreeFlight {
            area_m2: AREA,
            wind_axes,
            buoyancy_kg: LIFTED,
            p_origin_buoyancy: Vec3::from_array(LIFTS_AT),
            rate_damping_n_m_s: DAMPING,
            damping_excess: EXCESS,
            parts: vec![MovedPart {
                mass_kg: PART,
                place_m: [Setting::Fixed(PLACE[0]), Setting::Input(0), Setting::Fixed(PLACE[2])],
            }],
            thrusts: vec![Thrust {
                size_n: Setting::Fixed(1.5),
                direction: Vec3::new(0.6, 0.0, -0.8),
                place_m: THRUST_AT.map(Setting::Fixed),
            }],
            part_shift: Vec3::new(SHIFT, SHIFT, SHIFT),
            apparent_kg: APPARENT,
            v_tunnel_air: Vec3::from_array(WIND),
            push: Vec3::from_array(PUSH),
            turn: Vec3::from_array(TURN),
            ..FreeFlight::default()
        }),
    }
}

/// Mass, first and second moment about the origin from the definitions: the vehicle about its centre, and a particle where it truly is.
fn moments() -> (f64, Vector, Matrix3<f64>) {
    let about_centre = Matrix3::new(0.021, -0.001, 0.002, -0.001, 0.034, -0.0015, 0.002, -0.0015, 0.043);
    let particle = |m: f64, r: Vector| -r.cross_matrix() * r.cross_matrix() * m;
    let (centre, place) = (Vector::from(CENTRE), Vector::new(PLACE[0], PLACE[1] + SHIFT, PLACE[2]));
    (MASS + PART, centre * MASS + place * PART, about_centre + particle(MASS, centre) + particle(PART, place))
}

fn start() -> FreeState {
    let q = [0.5_f64, -0.3, 0.6, 0.2];
    let n = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    FreeState {
        p_tunnel_origin: Vec3::zero(),
        attitude: q.map(|x| x / n),
        v_tunnel_origin: Vec3::new(3.0, -0.8, 1.1),
        w_tunnel_body: Vec3::new(0.6, -1.4, 0.9),
    }
}
fn rotation(s: &FreeState) -> Matrix3<f64> {
    Rotation::<Tunnel, Body>::from_quaternion(s.attitude).matrix
}

#[track_caller]
fn same(a: Vector, b: Vector, bound: f64) {
    assert!((a - b).norm() <= bound * (1.0 + b.norm()), "{a} {b}");
}

/// Momentum of body and carried air changes by the force, and moment of momentum about the moving origin by the moment less v × momentum of
/// the body and u × that of the air (Kirchhoff; Lamb 1932, §124). Differences along the motion that the accelerations make: step 1e-5 of
/// quantities near 10, bound 1e-7.
#[test]
fn law_momentum_changes_by_force_and_moment() {
    let body = FreeBody::new(&plant(false)).expect("has a mass matrix");
    let (m, first, second) = moments();
    assert!((body.mass_kg() - m).abs() < 1e-15);
    let (s0, r0) = (start(), rotation(&start()));
    let [a, w_rate] = body.accelerations(&s0).map(|x| x.xyz);
    let at = |t: f64| {
        let (v, w) = (s0.v_tunnel_origin.xyz + a * t, s0.w_tunnel_body.xyz + w_rate * t);
        // Turned by the mean rate, which is exact to the third order.
        let turn = (s0.w_tunnel_body.xyz + w_rate * (0.5 * t)) * t;
        let r = r0 * nalgebra::Rotation3::from_scaled_axis(turn).into_inner();
        let u = v - r.transpose() * Vector::from(WIND);
        let carried = u.component_mul(&Vector::from(APPARENT));
        (r * (v * m + w.cross(&first) + carried), r * (first.cross(&v) + second * w))
    };
    let h = 1e-5;
    let rate = |f: &dyn Fn(f64) -> Vector| (f(h) - f(-h)) / (2.0 * h);
    let [f, moment] = body.wrench(&s0).map(|x| x.xyz);
    let (v, w) = (s0.v_tunnel_origin.xyz, s0.w_tunnel_body.xyz);
    let u = v - r0.transpose() * Vector::from(WIND);
    let left = v.cross(&(v * m + w.cross(&first))) + u.cross(&u.component_mul(&Vector::from(APPARENT)));
    same(rate(&|t| at(t).0), r0 * f, 1e-7);
    same(rate(&|t| at(t).1), r0 * (moment - left), 1e-7);
}

/// Weight, lift of the displaced air, thrust, push, turn and air by unit vectors, along body and along wind axes (drag along the flow, lift across it
/// in the body's plane of symmetry).
#[test]
fn exact_forces_and_moments_by_unit_vectors() {
    let (m, first, second) = moments();
    for (wind_axes, v) in [(false, [3.0, -0.8, 1.1]), (true, [3.0, -0.8, 1.1]), (true, [-0.5, 2.0, -1.7])] {
        let s = FreeState { v_tunnel_origin: Vec3::from_array(v), ..start() };
        let to_body = rotation(&s).transpose();
        let (down, w) = (to_body * Vector::x(), s.w_tunnel_body.xyz);
        let u = Vector::from(v) - to_body * Vector::from(WIND);
        let q = 0.5 * DENSITY * u.norm_squared();
        let sine = u.y.hypot(u.z) / u.norm();
        let c = COEFFICIENTS.map(|c| c * (1.0 + 0.5 * sine));
        let (x, z) =
            if wind_axes { (u.normalize(), Vector::new(-u.z, 0.0, u.x).normalize()) } else { (Vector::x(), Vector::z()) };
        let y = z.cross(&x);
        let air = (y * c[1] - x * c[0] - z * c[2]) * (q * AREA);
        let about = |i: usize| c[3 + i] * q * AREA * LENGTH + DAMPING[i] * (1.0 + EXCESS[i]) * w[i];
        let air_moment = x * about(0) + y * about(1) + z * about(2);
        let weight = down * ((m - LIFTED) * GRAVITY);
        let f = weight + Vector::from(THRUST) + to_body * Vector::from(PUSH) * m + air;
        let hung = (first - Vector::from(LIFTS_AT) * LIFTED).cross(&down) * GRAVITY;
        let [found_f, found_m] = FreeBody::new(&plant(wind_axes)).expect("has a mass matrix").wrench(&s).map(|x| x.xyz);
        same(found_f, f, 1e-13);
        let thrust = Vector::from(THRUST_AT).cross(&Vector::from(THRUST));
        same(found_m, hung + thrust + air_moment + second * Vector::from(TURN), 1e-13);
    }
    // At rest in the air.
    let resting = FreeState {
        v_tunnel_origin: Rotation::<Tunnel, Body>::from_quaternion(start().attitude).inverse() * Vec3::from_array(WIND),
        ..start()
    };
    let [f, _] = FreeBody::new(&plant(false)).expect("has a mass matrix").wrench(&resting).map(|x| x.xyz);
    let to_body = rotation(&resting).transpose();
    let still = to_body * (Vector::x() * ((m - LIFTED) * GRAVITY) + Vector::from(PUSH) * m);
    same(f, still + Vector::from(THRUST), 1e-13);
}
