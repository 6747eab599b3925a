//! sim tests: flights over a planet. In: closed forms and an independent integration in turning axes. Out: distances.

use std::f64::consts::PI;
use windfall_model::frames::Vec3;
use windfall_model::planet::{
    Air, Atmosphere, AtmosphereTable, Dispersions, FlightStart, Geodetic, Gravity, Planet, PlanetBody, PlanetFlight,
    PlanetScenario, Reference, Spheroid, WindTable, Winds,
};
use windfall_model::{Aero, ApparentMass, Coefficient, Contribution, Factor, Inertia, Structure, Term, Variable, Vehicle};
use windfall_sim::{PlanetEnd, PlanetFlown, SimError, fly_planet};

const A_M: f64 = 6_378_137.0;
const F: f64 = 1.0 / 298.257_223_563;
const MU: f64 = 3.986_004_418e14;
const J2: f64 = 1.082_629_82e-3;
const TURN: f64 = 7.292_115e-5;

fn earth() -> Planet {
    Planet {
        figure: Spheroid { equatorial_radius_m: A_M, flattening: F },
        rotation_rad_s: TURN,
        gravity: Gravity::J2 { mu_m3_s2: MU, j2: J2 },
        atmosphere: Some(Atmosphere::Us1976),
        wind: Winds::STILL,
    }
}

fn body(aero: Aero, point: bool) -> PlanetBody {
    let vehicle = Vehicle {
        mass_kg: 14.6,
        inertia: Inertia { xx: 0.8, yy: 1.1, zz: 1.3, ..Inertia::default() },
        p_origin_cm: Vec3::zero(),
        diameter_m: 0.0,
        apparent: ApparentMass::default(),
        loose: None,
    };
    PlanetBody { vehicle, reference: Reference { area_m2: 0.018, span_m: 0.3, chord_m: 0.2 }, aero, point }
}

fn ball(drag: f64) -> PlanetBody {
    body(Aero::new(Structure::point_mass(), vec![drag]), true)
}

fn start(latitude_deg: f64, longitude_deg: f64, height_m: f64, v: [f64; 3]) -> FlightStart {
    let place = Geodetic { latitude_rad: latitude_deg.to_radians(), longitude_rad: longitude_deg.to_radians(), height_m };
    FlightStart { place, v_ground: Vec3::from_array(v), attitude_rad: [0.0; 3], w_inertial_body: Vec3::zero() }
}

fn fly(planet: &Planet, body: &PlanetBody, start: FlightStart, duration_s: f64, rate_hz: f64) -> Result<PlanetFlown, SimError> {
    let numerics = PlanetFlight::default_numerics();
    let flight = PlanetFlight { name: "test".to_owned(), duration_s, rate_hz, start, numerics };
    let scenario = PlanetScenario {
        name: "test".to_owned(),
        planet: planet.clone(),
        body: body.clone(),
        flights: Vec::new(),
        dispersions: Dispersions::default(),
    };
    fly_planet(&scenario, &flight)
}

/// The same physics written again in axes that turn with the Earth: Coriolis and centrifugal terms, gravity from its radial and
/// meridional parts, latitude by Newton's method on the height, air of the troposphere in one formula.
mod turning {
    use super::{A_M, F, J2, MU, TURN};

    /// Latitude (rad) and height (m) of a distance from the axis and along it.
    pub(super) fn geodetic(across: f64, z: f64) -> (f64, f64) {
        let e2 = F * (2.0 - F);
        let mut lat = (z / (across * (1.0 - e2))).atan();
        for _ in 0..8 {
            let n = A_M / (1.0 - e2 * lat.sin().powi(2)).sqrt();
            // g = across sin φ − (z + e² N sin φ) cos φ = 0, with its slope.
            let g = across * lat.sin() - (z + e2 * n * lat.sin()) * lat.cos();
            let slope = across * lat.cos() + z * lat.sin() + e2 * n * lat.sin().powi(2) - e2 * n * lat.cos().powi(2);
            lat -= g / slope;
        }
        let n = A_M / (1.0 - e2 * lat.sin().powi(2)).sqrt();
        (lat, if lat.abs() < 0.7 { across / lat.cos() - n } else { z / lat.sin() - n * (1.0 - e2) })
    }

    fn density(height_m: f64) -> f64 {
        let gas = 8314.32 / 28.9644;
        let h = 6_356_766.0 * height_m / (6_356_766.0 + height_m);
        let t = 288.15 - 0.0065 * h;
        101_325.0 * (t / 288.15).powf(9.80665 / (0.0065 * gas)) / (gas * t)
    }

    /// Acceleration in turning axes; `wind` gives north and east over height.
    pub(super) fn acceleration(y: &[f64; 6], per_density: f64, wind: &dyn Fn(f64) -> [f64; 2]) -> [f64; 3] {
        let [x, y_, z, vx, vy, vz] = *y;
        let across = x.hypot(y_);
        let r = across.hypot(z);
        let (lat, height) = geodetic(across, z);
        let lon = y_.atan2(x);
        // Radial and meridional (northward) gravity of the potential with J2.
        let (s, c) = (z / r, across / r);
        let k = J2 * (A_M / r).powi(2);
        let radial = -MU / (r * r) * (1.0 - 1.5 * k * (3.0 * s * s - 1.0));
        let north = -MU / (r * r) * 3.0 * k * s * c;
        let gravity = [(radial * c - north * s) * lon.cos(), (radial * c - north * s) * lon.sin(), radial * s + north * c];
        let [wn, we] = wind(height);
        let air = [-lat.sin() * lon.cos() * wn - lon.sin() * we, -lat.sin() * lon.sin() * wn + lon.cos() * we, lat.cos() * wn];
        let u = [vx - air[0], vy - air[1], vz - air[2]];
        let drag = -per_density * density(height) * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt();
        [
            gravity[0] + 2.0 * TURN * vy + TURN * TURN * x + drag * u[0],
            gravity[1] - 2.0 * TURN * vx + TURN * TURN * y_ + drag * u[1],
            gravity[2] + drag * u[2],
        ]
    }

    /// Runge and Kutta's method of fourth order.
    pub(super) fn fly(mut y: [f64; 6], seconds: f64, steps: usize, rate: &dyn Fn(&[f64; 6]) -> [f64; 6]) -> [f64; 6] {
        let h = seconds / steps as f64;
        let moved = |y: &[f64; 6], k: &[f64; 6], h: f64| std::array::from_fn::<f64, 6, _>(|i| y[i] + h * k[i]);
        for _ in 0..steps {
            let a = rate(&y);
            let b = rate(&moved(&y, &a, 0.5 * h));
            let c = rate(&moved(&y, &b, 0.5 * h));
            let d = rate(&moved(&y, &c, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        y
    }
}

/// A ball thrown at 47° latitude through wind that turns with height, 30 s, against the integration in turning axes with steps of 5 ms,
/// whose own error is below 1e-9 m; what is left is round-off of a radius over 6000 steps. Issue's bound: 1e-6 m.
#[test]
fn exact_flight_agrees_with_turning_axes() {
    let wind = |h: f64| [3.0 - 2e-3 * h, -6.0 + 1e-2 * h];
    let rows = [0.0, 12_000.0].map(|h| [h, wind(h)[0], wind(h)[1]]);
    let mut planet = earth();
    planet.wind = Winds::Table(WindTable::new(rows.to_vec()).expect("ascends"));
    let v0 = [120.0, -80.0, -60.0];
    let s = start(47.0, -122.0, 9144.0, v0);
    let flown = fly(&planet, &ball(0.4), s, 30.0, 1.0).expect("flies");
    let (lat, lon) = (s.place.latitude_rad, s.place.longitude_rad);
    let n = A_M / (1.0 - F * (2.0 - F) * lat.sin().powi(2)).sqrt();
    let across = (n + 9144.0) * lat.cos();
    let z = (n * (1.0 - F).powi(2) + 9144.0) * lat.sin();
    let [vn, ve, vd] = v0;
    let out = -lat.sin() * vn - lat.cos() * vd;
    let y0 = [
        across * lon.cos(),
        across * lon.sin(),
        z,
        out * lon.cos() - ve * lon.sin(),
        out * lon.sin() + ve * lon.cos(),
        lat.cos() * vn - lat.sin() * vd,
    ];
    let per_density = 0.5 * 0.4 * 0.018 / 14.6;
    let rate = |y: &[f64; 6]| {
        let a = turning::acceleration(y, per_density, &wind);
        [y[3], y[4], y[5], a[0], a[1], a[2]]
    };
    let y = turning::fly(y0, 30.0, 6000, &rate);
    let (lat, height) = turning::geodetic(y[0].hypot(y[1]), y[2]);
    let (place, v) = (flown.truth.place[30], flown.truth.v_ground_ned[30]);
    assert!((place.height_m - height).abs() < 1e-6, "{}", place.height_m - height);
    assert!((place.latitude_rad - lat).abs() * A_M < 1e-6, "{}", (place.latitude_rad - lat) * A_M);
    assert!((place.longitude_rad - y[1].atan2(y[0])).abs() * A_M < 1e-6);
    let lon = y[1].atan2(y[0]);
    let (out, east) = (y[3] * lon.cos() + y[4] * lon.sin(), y[4] * lon.cos() - y[3] * lon.sin());
    let ned = [lat.cos() * y[5] - lat.sin() * out, east, -lat.sin() * y[5] - lat.cos() * out];
    assert!(v.iter().zip(ned).all(|(a, b)| (a - b).abs() < 1e-7), "{v:?} {ned:?}");
    assert_eq!(flown.end, PlanetEnd::Completed);
}

/// A circular orbit of a point in central gravity comes back after its period over a planet at rest, and lags the ground's turning.
#[test]
fn exact_circular_orbit() {
    let radius = A_M + 4e5;
    let (speed, period_s) = ((MU / radius).sqrt(), 2.0 * PI * (radius.powi(3) / MU).sqrt());
    for turn in [0.0, TURN] {
        let planet = Planet {
            figure: Spheroid { equatorial_radius_m: A_M, flattening: 0.0 },
            rotation_rad_s: turn,
            gravity: Gravity::Central { mu_m3_s2: MU },
            atmosphere: None,
            wind: Winds::STILL,
        };
        let s = start(0.0, 10.0, 4e5, [0.0, speed - turn * radius, 0.0]);
        let flown = fly(&planet, &ball(0.0), s, period_s, 1.0 / period_s).expect("flies");
        let end = flown.truth.place[1];
        // Tolerance 1e-13 of the radius in each of some hundred steps; errors along an orbit grow with the turn.
        assert!((end.height_m - 4e5).abs() < 1e-4, "{}", end.height_m);
        let lag = (end.longitude_rad - 10_f64.to_radians() + turn * period_s) * radius;
        assert!(lag.abs() < 1e-3 && end.latitude_rad.abs() < 1e-15, "{lag}");
    }
}

fn flat_as_can_be(atmosphere: Option<Atmosphere>) -> Planet {
    Planet {
        figure: Spheroid { equatorial_radius_m: A_M, flattening: 0.0 },
        rotation_rad_s: 0.0,
        gravity: Gravity::Uniform { gravity_m_s2: 9.0 },
        atmosphere,
        wind: Winds::STILL,
    }
}

/// Uniform gravity and uniform air: `h = h_0 − (V²/g) ln cosh(g t/V)`, and the ground at the time and speed of that formula. Bound:
/// round-off of the radius.
#[test]
fn exact_fall_to_the_ground_through_uniform_air() {
    let air = Air { pressure_pa: 1e5, temperature_k: 300.0, gas_constant_j_kg_k: 287.0 };
    let table = AtmosphereTable::new(vec![(0.0, air), (2e3, air)]).expect("ascends");
    let density = air.density_kg_m3();
    let flown = fly(&flat_as_can_be(Some(Atmosphere::Table(table))), &ball(0.7), start(20.0, 30.0, 1e3, [0.0; 3]), 60.0, 2.0)
        .expect("flies");
    let terminal = (2.0 * 14.6 * 9.0 / (density * 0.7 * 0.018)).sqrt();
    let fallen = |t: f64| terminal * terminal / 9.0 * (9.0 * t / terminal).cosh().ln();
    for (t, g) in flown.truth.t_s.iter().zip(&flown.truth.place) {
        assert!((1e3 - fallen(*t) - g.height_m).abs() < 1e-7, "{t}: {}", g.height_m);
    }
    let PlanetEnd::Ground { t_s, v_ground_ned, .. } = flown.end else { panic!("{:?}", flown.end) };
    assert!((fallen(t_s) - 1e3).abs() < 1e-6, "{t_s}");
    assert!((v_ground_ned[2] - terminal * (9.0 * t_s / terminal).tanh()).abs() < 1e-7);
    assert!(flown.truth.t_s.last().is_some_and(|t| *t < t_s && t_s - t <= 0.5));
}

/// At the start on the ground a flight goes on; it may rise and stays a flight when it comes down again.
#[test]
fn law_a_flight_from_the_ground_does_not_end_there() {
    let flown = fly(&flat_as_can_be(None), &ball(0.0), start(0.0, 0.0, 0.0, [0.0, 0.0, -9.0]), 3.0, 1.0).expect("flies");
    assert_eq!((flown.end, flown.truth.len()), (PlanetEnd::Completed, 4));
    assert!((flown.truth.place[2].height_m).abs() < 1e-7 && (flown.truth.place[3].height_m + 13.5).abs() < 1e-7);
}

/// A rigid body without moments keeps its attitude against the stars. Beside the north pole of a planet that turns, it moves over with
/// the ground, and north there turns against the clock as the inertial longitude grows: the yaw grows with it.
#[test]
fn exact_attitude_against_a_turning_planet() {
    let turn = 1e-3;
    let mut planet = flat_as_can_be(None);
    planet.rotation_rad_s = turn;
    planet.gravity = Gravity::Uniform { gravity_m_s2: 0.0 };
    let mut s = start(90.0 - 1e-9, 0.0, 1e6, [0.0; 3]);
    s.attitude_rad = [0.1, 0.2, 0.3];
    let free = body(Aero::new(Structure { name: "none".to_owned(), parameters: vec![], contributions: vec![] }, vec![]), false);
    let flown = fly(&planet, &free, s, 500.0, 0.01).expect("flies");
    let truth = &flown.truth;
    for ((t, a), place) in truth.t_s.iter().zip(&truth.attitude_rad).zip(&truth.place) {
        let meridian = place.longitude_rad + turn * t;
        // Down at the place differs from the axis by 2e-11 rad.
        assert!((a[0] - 0.1).abs() < 1e-9 && (a[1] - 0.2).abs() < 1e-9, "{t}: {a:?}");
        assert!((a[2] - 0.3 - meridian).abs() < 1e-8, "{t}: {a:?} {meridian}");
    }
    assert!(truth.attitude_rad[5][2] > 0.7);
}

fn spinning(variable: Variable, coefficient: Coefficient) -> PlanetBody {
    let structure = Structure {
        name: "one".to_owned(),
        parameters: vec!["k".to_owned()],
        contributions: vec![Contribution { coefficient, parameter: 0, term: Term::new(1.0, &[Factor::Power(variable, 1)]) }],
    };
    body(Aero::new(structure, vec![-2.0]), false)
}

/// Damping about each axis at constant speed decays as `exp(−k ρ V S l²/(4 I) t)`, with the span in roll and yaw and the chord in
/// pitch. Speed is constant where gravity is none and only moments act; bound: the tolerance over 5 s.
#[test]
fn exact_rate_damping_uses_its_own_length() {
    let air = Air { pressure_pa: 1e5, temperature_k: 300.0, gas_constant_j_kg_k: 287.0 };
    let table = AtmosphereTable::new(vec![(0.0, air), (2e6, air)]).expect("ascends");
    let mut planet = flat_as_can_be(Some(Atmosphere::Table(table)));
    planet.gravity = Gravity::Uniform { gravity_m_s2: 0.0 };
    for (axis, variable, coefficient, length, inertia) in [
        (0, Variable::RollRate, Coefficient::Cl, 0.3, 0.8),
        (1, Variable::PitchRate, Coefficient::Cm, 0.2, 1.1),
        (2, Variable::YawRate, Coefficient::Cn, 0.3, 1.3),
    ] {
        let mut s = start(0.0, 0.0, 1e3, [0.0, 0.0, -200.0]);
        let mut rates = [0.0; 3];
        rates[axis] = 0.5;
        s.w_inertial_body = Vec3::from_array(rates);
        let flown = fly(&planet, &spinning(variable, coefficient), s, 5.0, 1.0).expect("flies");
        let per_s = 2.0 * air.density_kg_m3() * 200.0 * 0.018 * length * length / (4.0 * inertia);
        for (t, w) in flown.truth.t_s.iter().zip(&flown.truth.w_inertial_body) {
            assert!((w[axis] - 0.5 * (-per_s * t).exp()).abs() < 1e-12, "{axis} {t}: {}", w[axis]);
        }
    }
}

#[test]
fn law_what_cannot_be_flown_is_named() {
    let message = |r: Result<PlanetFlown, SimError>| r.expect_err("cannot be flown").to_string();
    let high = message(fly(&earth(), &ball(0.1), start(0.0, 0.0, 85e3, [0.0, 0.0, -500.0]), 30.0, 1.0));
    assert!(high.contains("outside the atmosphere") && high.contains("86000"), "{high}");
    let low = message(fly(&earth(), &ball(0.1), start(0.0, 0.0, -1.0, [0.0; 3]), 30.0, 1.0));
    assert!(low.contains("height_m") && low.contains("zero or more"), "{low}");
    let circular =
        message(fly(&earth(), &spinning(Variable::PitchDamping, Coefficient::CN), start(0.0, 0.0, 1e3, [0.0; 3]), 1.0, 1.0));
    assert!(circular.contains("damping variable"), "{circular}");
}

/// Over a planet that turns, eastward across the longitude of 180°: from sample to sample, and to the touch-down between two, longitude
/// grows by the mean speed eastward over the radius. Bound: `h³/12` of a rate of acceleration `2 Ω g` over the radius, 1e-10, twice.
#[test]
fn exact_longitudes_go_round_and_the_ground_turns() {
    let turn = 1e-3;
    let planet = Planet { rotation_rad_s: turn, ..flat_as_can_be(None) };
    let flown = fly(&planet, &ball(0.0), start(0.0, 179.98, 1e3, [0.0, 300.0, 0.0]), 60.0, 1.0).expect("flies");
    let PlanetEnd::Ground { t_s, place, v_ground_ned } = flown.end else { panic!("{:?}", flown.end) };
    let truth = &flown.truth;
    let mut seen: Vec<_> =
        truth.t_s.iter().zip(&truth.place).zip(&truth.v_ground_ned).map(|((t, p), v)| (*t, *p, v[1])).collect();
    seen.push((t_s, place, v_ground_ned[1]));
    for pair in seen.windows(2) {
        let [(before_s, a, east), (after_s, b, then)] = [pair[0], pair[1]];
        let radius = A_M + 0.5 * (a.height_m + b.height_m);
        let wanted = 0.5 * (east + then) / radius * (after_s - before_s);
        let gone = (b.longitude_rad - a.longitude_rad).rem_euclid(2.0 * PI);
        assert!((gone - wanted).abs() < 2e-10, "{before_s} {after_s}: {gone} {wanted}");
        assert!(b.longitude_rad > -PI && b.longitude_rad <= PI, "{}", b.longitude_rad);
    }
    assert!(seen[0].1.longitude_rad > 3.0 && place.longitude_rad < -3.0 && truth.t_s.last().is_some_and(|t| t_s - t > 0.1));
}

/// A wheel at 2·10⁴ turns a second and a ball that the air holds like glue ask for more steps than any flight gets: which of both, when and
/// how fast is said. So is a body rate beyond all landers, whichever axes it is about.
#[test]
fn law_flights_without_end_are_given_up() {
    let free = body(Aero::new(Structure { name: "none".to_owned(), parameters: vec![], contributions: vec![] }, vec![]), false);
    let wheel = |w: [f64; 3], duration_s: f64| {
        let s = FlightStart { w_inertial_body: Vec3::from_array(w), ..start(0.0, 0.0, 1e3, [0.0; 3]) };
        fly(&flat_as_can_be(None), &free, s, duration_s, 1.0 / duration_s)
    };
    let Err(SimError::TooManySteps { what, t_s, rate_per_s, .. }) = wheel([6e4, 0.0, 8e4], 1.0) else { panic!("flew") };
    // Its energy is kept: the size of the rate stays between those about the axes of most and least inertia.
    let twice = 0.8 * 6e4_f64.powi(2) + 1.3 * 8e4_f64.powi(2);
    assert!(what == "body rate" && t_s > 0.0 && t_s < 1.0, "{what} {t_s}");
    assert!(rate_per_s > 0.99 * (twice / 1.3).sqrt() && rate_per_s < 1.01 * (twice / 0.8).sqrt(), "{rate_per_s}");
    for w in [[0.0, 700.0, 800.0], [900.0, 0.0, 600.0]] {
        assert!(matches!(wheel(w, 1e-3), Err(SimError::Runaway { .. })), "{w:?}");
    }
    assert!(wheel([900.0, 100.0, 100.0], 1e-3).is_ok());
    let air = Air { pressure_pa: 1e5, temperature_k: 300.0, gas_constant_j_kg_k: 287.0 };
    let table = AtmosphereTable::new(vec![(0.0, air), (2e3, air)]).expect("ascends");
    let glued = fly(&flat_as_can_be(Some(Atmosphere::Table(table))), &ball(1e18), start(0.0, 0.0, 1e3, [0.0; 3]), 0.25, 4.0);
    let Err(SimError::TooManySteps { what, rate_per_s, .. }) = glued else { panic!("{glued:?}") };
    // A ball has no rate of its own: the step that was asked for.
    assert!(what == "velocity" && (rate_per_s - 4.0).abs() < 1e-12, "{what} {rate_per_s}");
    let backward = fly(&flat_as_can_be(None), &ball(0.0), start(0.0, 0.0, 1e3, [0.0; 3]), -2.0, 3.0).expect_err("backward");
    assert!(backward.to_string().contains("duration_s times rate_hz is -6;"), "{backward}");
}
