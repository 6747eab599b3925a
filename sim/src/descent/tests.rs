//! sim: descents against a second derivation in axes that turn with the planet. In: a body crooked in every number, wind with shear, a
//! gust that grows. Out: distances at touch-down.

use super::*;
use nalgebra::Matrix3;
use windfall_model::planet::{
    Air, Atmosphere, AtmosphereTable, Dispersions, FlightStart, Geodetic, Gravity, Reference, Spheroid, WindTable, Winds,
};
use windfall_model::{Aero, ApparentMass, Inertia, Structure, Vehicle};

type V3 = Vector3<f64>;

const RADIUS_M: f64 = 6_051_800.0;
const MU_M3_S2: f64 = 3.248_585_92e14;
/// A day of 2.2 h: at the equator a third of the weight goes.
const TURN_RAD_S: f64 = 8e-4;
const GAS: Air = Air { pressure_pa: 3e5, temperature_k: 500.0, gas_constant_j_kg_k: 300.0 };
/// Wind toward north and east at the ground, m/s, and its growth with height, 1/s.
const WIND: [[f64; 2]; 2] = [[3.0, -2.0], [0.04, -0.03]];
/// Gust toward north, east, down at the start, m/s, and its growth, m/s².
const GUST: EvenGust = EvenGust { from: [0.5, -1.0, 0.8], rate: [0.3, -0.2, 0.25] };
const MASS_KG: f64 = 20.0;
const REFERENCE: Reference = Reference { area_m2: 0.3, span_m: 0.7, chord_m: 0.4 };
const INERTIA: Inertia = Inertia { xx: 1.1, yy: 0.9, zz: 1.4, xy: 0.05, xz: -0.08, yz: 0.06 };
const P_ORIGIN_CM: [f64; 3] = [0.02, -0.01, 0.015];
/// C_A, C_N of sine and its cube, C_l at rest and of p, C_m of sine and its cube, C_m and C_n of damping and of it times angle squared.
const AERO: [f64; 11] = [1.2, 0.7, -0.3, 0.004, -0.5, -0.3, 0.1, -2.0, 1.5, -1.7, 1.1];

fn scenario(
    atmosphere: Option<Atmosphere>,
    gravity: Gravity,
    turn_rad_s: f64,
    start: FlightStart,
    duration_s: f64,
) -> PlanetScenario {
    let top_m = 2e3;
    let row = |h: f64| [h, WIND[0][0] + h * WIND[1][0], WIND[0][1] + h * WIND[1][1]];
    let wind = WindTable::new(vec![row(-100.0), row(top_m)]).expect("ascends");
    let vehicle = Vehicle {
        mass_kg: MASS_KG,
        inertia: INERTIA,
        p_origin_cm: Vec3::from_array(P_ORIGIN_CM),
        diameter_m: 0.5,
        apparent: ApparentMass::default(),
        loose: None,
    };
    let aero = Aero::new(Structure::axisymmetric(), AERO.to_vec());
    let flight =
        PlanetFlight { name: "test".to_owned(), duration_s, rate_hz: 1.0, start, numerics: PlanetFlight::default_numerics() };
    PlanetScenario {
        name: "test".to_owned(),
        planet: Planet {
            figure: Spheroid { equatorial_radius_m: RADIUS_M, flattening: 0.0 },
            rotation_rad_s: turn_rad_s,
            gravity,
            atmosphere,
            wind: Winds::Table(wind),
        },
        body: PlanetBody { vehicle, reference: REFERENCE, aero, point: false },
        flights: vec![flight],
        dispersions: Dispersions::default(),
    }
}

/// The same physics in axes that turn with the planet. Attitude is the matrix from body to them; momentum is about the centre of mass
/// in body axes.
#[derive(Clone, Copy)]
struct Turning {
    p: V3,
    v: V3,
    r: Matrix3<f64>,
    momentum: V3,
}

impl Turning {
    fn moved(&self, h: f64, rate: &Self) -> Self {
        Self {
            p: self.p + h * rate.p,
            v: self.v + h * rate.v,
            r: self.r + h * rate.r,
            momentum: self.momentum + h * rate.momentum,
        }
    }
    /// North, east, down and the height.
    fn place(&self) -> ([V3; 3], f64) {
        let down = -self.p.normalize();
        let east = V3::z().cross(&self.p).normalize();
        ([east.cross(&down), east, down], self.p.norm() - RADIUS_M)
    }
    /// Velocity against the air in body axes.
    fn through_air(&self, t_s: f64) -> V3 {
        let ([north, east, down], height_m) = self.place();
        let gust = |k: usize| GUST.from[k] + t_s * GUST.rate[k];
        let wind = |k: usize| WIND[0][k] + height_m * WIND[1][k] + gust(k);
        self.r.transpose() * (self.v - north * wind(0) - east * wind(1) - down * gust(2))
    }
    fn body_rates(&self) -> V3 {
        INERTIA.matrix().cholesky().expect("a body").solve(&self.momentum)
    }
    fn angles(&self, t_s: f64) -> [f64; 2] {
        let u = self.through_air(t_s);
        [u.z.atan2(u.x), (u.y / u.norm()).asin()]
    }
    fn rate(&self, t_s: f64) -> Self {
        let (u, w, turn) = (self.through_air(t_s), self.body_rates(), V3::new(0.0, 0.0, TURN_RAD_S));
        let speed = u.norm();
        let qs = 0.5 * GAS.density_kg_m3() * speed * speed * REFERENCE.area_m2;
        let across = u.y.hypot(u.z);
        let (s, sin_phi, cos_phi) = (across / speed, u.y / across, u.z / across);
        let of_angle = |k: usize| AERO[k] * s + AERO[k + 1] * s.powi(3);
        let (normal, static_moment) = (of_angle(1), of_angle(5));
        let force = V3::new(-AERO[0] * u.x / speed, -normal * sin_phi, -normal * cos_phi) * qs;
        let p = self.p;
        let a = p * (-MU_M3_S2 / p.norm().powi(3)) + self.r * force / MASS_KG
            - 2.0 * turn.cross(&self.v)
            - turn.cross(&turn.cross(&p));
        let mut rate =
            Self { p: self.v, v: a, r: self.r * w.cross_matrix() - turn.cross_matrix() * self.r, momentum: V3::zeros() };
        // Rates of the angles of flow by a difference along the path.
        const DT: f64 = 1e-4;
        let (ahead, behind) = (self.moved(DT, &rate).angles(t_s + DT), self.moved(-DT, &rate).angles(t_s - DT));
        let [alpha_rate, beta_rate] = [0, 1].map(|k| (ahead[k] - behind[k]) / (2.0 * DT));
        let [alpha, beta] = self.angles(t_s);
        let hat = |length_m: f64| length_m / (2.0 * speed);
        let (b, c) = (REFERENCE.span_m, REFERENCE.chord_m);
        let pitch = 0.5 * (w.y + alpha_rate) * hat(c);
        let yaw = 0.5 * (w.z - beta_rate) * hat(b);
        let moment = V3::new(
            b * (AERO[3] + AERO[4] * w.x * hat(b)),
            c * (static_moment * cos_phi + (AERO[7] + AERO[8] * alpha * alpha) * pitch),
            b * (-static_moment * sin_phi + (AERO[9] + AERO[10] * beta * beta) * yaw),
        ) * qs;
        // From the centre of mass to the origin, where the force acts.
        let arm = -V3::from(P_ORIGIN_CM);
        rate.momentum = moment + arm.cross(&force) - w.cross(&self.momentum);
        rate
    }
    /// Runge and Kutta's step of fourth order.
    fn step(&self, t_s: f64, h: f64) -> Self {
        let a = self.rate(t_s);
        let b = self.moved(0.5 * h, &a).rate(t_s + 0.5 * h);
        let c = self.moved(0.5 * h, &b).rate(t_s + 0.5 * h);
        let d = self.moved(h, &c).rate(t_s + h);
        self.moved(h / 6.0, &a).moved(h / 3.0, &b).moved(h / 3.0, &c).moved(h / 6.0, &d)
    }
    fn seen(&self, t_s: f64) -> DescentState {
        let ([north, east, down], height_m) = self.place();
        let (u, w) = (self.through_air(t_s), self.body_rates());
        DescentState {
            t_s,
            height_m,
            airspeed_m_s: u.norm(),
            descent_m_s: self.v.dot(&down),
            across_m_s: self.v.dot(&north).hypot(self.v.dot(&east)),
            alpha_t_rad: (u.x / u.norm()).acos(),
            off_vertical_rad: self.r.column(0).dot(&down).acos(),
            pitch_yaw_rate_rad_s: w.y.hypot(w.z),
            roll_rate_rad_s: w.x,
        }
    }
}

fn begin() -> FlightStart {
    FlightStart {
        place: Geodetic { latitude_rad: 0.6, longitude_rad: 1.0, height_m: 200.0 },
        v_ground: Vec3::new(4.0, -7.0, 18.0),
        attitude_rad: [0.4, -1.3, 0.7],
        w_inertial_body: Vec3::new(0.6, -0.4, 0.3),
    }
}

fn turned(axis: V3, angle: f64) -> Matrix3<f64> {
    *nalgebra::Rotation3::new(axis * angle).matrix()
}

/// Two hundred metres down through wind with shear and a gust that grows, from an attitude and rates about all axes: at touch-down time,
/// speeds, way over the ground, attitude and rates, and root mean squares on the way.
///
/// Bounds: of a step h of both methods `(ω h)⁵/120` with the fastest mode of 6 rad/s, 0.3 rad, 1000 steps: 2e-6 rad, and 20 m/s of that
/// across. Differences along the path see north turn as the body goes over the ground, which the simulator leaves out:
/// 10 m/s · 10 m/s/R = 2e-5 m/s² against gusts and shear of 1, in damping alone, 1e-6 rad/s over 20 m/s.
#[test]
fn law_a_descent_is_that_of_axes_that_turn() {
    const STEP_S: f64 = 0.01;
    let air = Atmosphere::Table(AtmosphereTable::new(vec![(-100.0, GAS), (2e3, GAS)]).expect("ascends"));
    let s = scenario(Some(air), Gravity::Central { mu_m3_s2: MU_M3_S2 }, TURN_RAD_S, begin(), 60.0);
    let descent = Descent::new(&s, &s.flights[0], vec![], STEP_S).expect("sound");
    let equations = Equations { planet: &s.planet, profile: &descent.profile, body: BodyForces::new(&s.body).expect("sound") };
    let flown = descent.down(&equations, descent.first(None), GUST.from, |at| GUST.at(at.t_s + STEP_S)).expect("flies");
    let landed = flown.touch_down.expect("the ground");

    let FlightStart { place: Geodetic { latitude_rad: lat, longitude_rad: lon, height_m }, attitude_rad, .. } = begin();
    let p = turned(V3::z(), lon) * turned(V3::y(), -lat) * V3::x() * (RADIUS_M + height_m);
    let mut y = Turning { p, v: V3::zeros(), r: Matrix3::identity(), momentum: INERTIA.matrix() * begin().w_inertial_body.xyz };
    let (axes, _) = y.place();
    let ned = Matrix3::from_columns(&axes);
    let [roll, pitch, yaw] = attitude_rad;
    y.v = ned * begin().v_ground.xyz;
    y.r = ned * turned(V3::z(), yaw) * turned(V3::y(), pitch) * turned(V3::x(), roll);
    let (mut t_s, mut squares) = (0.0, [0.0; 2]);
    let mut add = |state: &DescentState, h: f64| {
        squares[0] += h * state.off_vertical_rad.powi(2);
        squares[1] += h * state.pitch_yaw_rate_rad_s.powi(2);
    };
    for k in 1.. {
        let next = y.step(t_s, STEP_S);
        if next.place().1 <= 0.0 {
            break;
        }
        (y, t_s) = (next, f64::from(k) * STEP_S);
        add(&y.seen(t_s), STEP_S);
    }
    let (mut short, mut long) = (0.0, STEP_S);
    for _ in 0..40 {
        let middle = 0.5 * (short + long);
        if y.step(t_s, middle).place().1 > 0.0 { short = middle } else { long = middle }
    }
    (y, t_s) = (y.step(t_s, short), t_s + short);
    let seen = y.seen(t_s);
    add(&seen, short);

    let moved = ned.transpose() * (y.p - p);
    let a = &landed.state;
    for (what, here, there, bound) in [
        ("time, s", a.t_s, seen.t_s, 1e-6),
        ("airspeed, m/s", a.airspeed_m_s, seen.airspeed_m_s, 2e-5),
        ("descent, m/s", a.descent_m_s, seen.descent_m_s, 2e-5),
        ("across, m/s", a.across_m_s, seen.across_m_s, 2e-5),
        ("drift north, m", landed.drift_m[0], moved.x, 4e-5),
        ("drift east, m", landed.drift_m[1], moved.y, 4e-5),
        ("angle of attack, rad", a.alpha_t_rad, seen.alpha_t_rad, 2e-6),
        ("off the vertical, rad", a.off_vertical_rad, seen.off_vertical_rad, 2e-6),
        ("rate across, rad/s", a.pitch_yaw_rate_rad_s, seen.pitch_yaw_rate_rad_s, 1e-5),
        ("roll rate, rad/s", a.roll_rate_rad_s, seen.roll_rate_rad_s, 1e-5),
        ("off the vertical, rms, rad", landed.off_vertical_rms_rad, (squares[0] / t_s).sqrt(), 2e-6),
        ("rate across, rms, rad/s", landed.pitch_yaw_rate_rms_rad_s, (squares[1] / t_s).sqrt(), 1e-5),
    ] {
        assert!((here - there).abs() < bound, "{what}: {here} {there}, apart {:e}", (here - there).abs());
    }
}

/// Without air, `t = √(2h/g)`: contact is found within a step in which the speed grows by half of its mean. Bound: a micrometre over
/// the speed, and round-off of the radius over it.
#[test]
fn exact_touch_down_of_a_fall_without_air() {
    let mut start = begin();
    (start.v_ground, start.place.height_m) = (Vec3::zero(), 47.0);
    let s = scenario(None, Gravity::Uniform { gravity_m_s2: 9.0 }, 0.0, start, 60.0);
    let descent = Descent::new(&s, &s.flights[0], vec![], 2.0).expect("sound");
    let landed = descent.fly(&s.body, None).expect("flies").touch_down.expect("the ground").state;
    let time_s = (2.0 * 47.0 / 9.0_f64).sqrt();
    assert!(landed.height_m.abs() <= CONTACT_M, "{}", landed.height_m);
    assert!((landed.t_s - time_s).abs() < 1e-7 && (landed.descent_m_s - 9.0 * time_s).abs() < 1e-6, "{landed:?} {time_s}");
}

/// By hand: a start at an ordered height is there, one below another never was, and between two instants a state is linear.
#[test]
fn exact_states_at_ordered_heights() {
    let at = |t_s: f64, height_m: f64| DescentState { t_s, height_m, ..DescentState::default() };
    let heights = [300.0, 200.0, 125.0];
    let mut log = Log::new(&heights);
    let (first, second) = (at(0.0, 200.0), at(4.0, 100.0));
    log.see(None, &first);
    log.see(Some(&first), &second);
    assert_eq!(log.into_flown(None).at_heights, [None, Some(first), Some(at(3.0, 125.0))]);
}
