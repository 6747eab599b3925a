//! sim tests: descents by steps of one length. In: closed forms, the tight integrator, half the step. Out: distances.

use std::f64::consts::FRAC_PI_2;
use windfall_model::frames::Vec3;
use windfall_model::planet::{
    Air, Atmosphere, AtmosphereTable, Dispersions, FlightStart, Geodetic, Gravity, GustProfile, Planet, PlanetBody, PlanetFlight,
    PlanetScenario, Reference, Spheroid, StartDispersion, WindTable, Winds,
};
use windfall_model::{Aero, ApparentMass, Inertia, Structure, Turbulence, Vehicle};
use windfall_sim::{Descent, DescentFlown, PlanetEnd, Seed, fly_planet};

const RADIUS_M: f64 = 6_051_800.0;
const STEP_S: f64 = 0.1;

/// The full-scale lander of the thesis' Table 2.2 with the parameters of Table 5.5, its roll moment apart.
fn lander(cl_0: f64) -> PlanetBody {
    let values = vec![6.662, 3.5129, -2.0035, cl_0, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];
    let vehicle = Vehicle {
        mass_kg: 840.4,
        inertia: Inertia { xx: 360.9, yy: 235.7, zz: 235.6, ..Inertia::default() },
        p_origin_cm: Vec3::zero(),
        diameter_m: 0.85,
        apparent: ApparentMass::default(),
        loose: None,
    };
    PlanetBody {
        vehicle,
        reference: Reference::of_diameter(0.85),
        aero: Aero::new(Structure::axisymmetric(), values),
        point: false,
    }
}

fn venus(rotation_rad_s: f64, wind: Winds, atmosphere: Atmosphere) -> Planet {
    Planet {
        figure: Spheroid { equatorial_radius_m: RADIUS_M, flattening: 0.0 },
        rotation_rad_s,
        gravity: Gravity::Central { mu_m3_s2: 3.248_585_92e14 },
        atmosphere: Some(atmosphere),
        wind,
    }
}

fn flight(height_m: f64, v: [f64; 3], off_deg: f64, duration_s: f64) -> PlanetFlight {
    let start = FlightStart {
        place: Geodetic { latitude_rad: 0.1, longitude_rad: 1.0, height_m },
        v_ground: Vec3::from_array(v),
        attitude_rad: [0.0, off_deg.to_radians() - FRAC_PI_2, 0.0],
        w_inertial_body: Vec3::zero(),
    };
    PlanetFlight { name: "test".to_owned(), duration_s, rate_hz: 1.0, start, numerics: PlanetFlight::default_numerics() }
}

fn scenario(planet: Planet, body: PlanetBody, flight: PlanetFlight, dispersions: Dispersions) -> PlanetScenario {
    PlanetScenario { name: "test".to_owned(), planet, body, flights: vec![flight], dispersions }
}

fn fly(s: &PlanetScenario, heights_m: Vec<f64>, step_s: f64, seed: Option<Seed>) -> DescentFlown {
    let descent = Descent::new(s, &s.flights[0], heights_m, step_s).expect("sound");
    descent.fly(&s.body, seed).expect("flies")
}

fn wind() -> Winds {
    Winds::Table(WindTable::new(vec![[0.0, 0.0, -1.0], [1.5e3, 1.0, -3.0], [3e3, 0.0, -8.0]]).expect("ascends"))
}

/// Down from 3 km over the turning planet in sheared wind, ten degrees off, against the integrator at 1e-13. Bounds: the phase of the
/// pitch mode lags by 6e-5 of 0.3 rad a step, which after its decay in 10 s is 3e-3 of what is left of ten degrees; density between rows
/// of the table to 5e-7 is 3e-7 of the speed, 0.1 ms and 1 mm in 380 s.
#[test]
fn law_as_the_tight_integrator() {
    let s = scenario(
        venus(-2.992_37e-7, wind(), Atmosphere::Venus),
        lander(0.0125),
        flight(3e3, [0.0, -8.0, 9.0], 10.0, 500.0),
        Dispersions::default(),
    );
    let tight = fly_planet(&s, &s.flights[0]).expect("flies");
    let PlanetEnd::Ground { t_s, v_ground_ned, .. } = tight.end else { panic!("no ground: {:?}", tight.end) };
    let flown = fly(&s, vec![2.9e3, 2.5e3, 1e3, 10.0], STEP_S, None);
    let landed = flown.touch_down.expect("the ground");
    let far =
        |what: &str, a: f64, b: f64, bound: f64| assert!((a - b).abs() <= bound, "{what}: {a} {b}, apart {:e}", (a - b).abs());
    far("time, s", landed.state.t_s, t_s, 1e-3);
    far("speed down, m/s", landed.state.descent_m_s, v_ground_ned[2], 1e-5);
    far("speed across, m/s", landed.state.across_m_s, v_ground_ned[0].hypot(v_ground_ned[1]), 1e-4);
    // Attitude at the tight truth's samples: the nose from the vertical, and the time of that height.
    for (state, height_m) in flown.at_heights.iter().zip([2.9e3, 2.5e3, 1e3, 10.0]) {
        let state = state.expect("passed");
        let after = tight.truth.place.iter().position(|p| p.height_m <= height_m).expect("passed");
        let (a, b) = (tight.truth.place[after - 1].height_m, tight.truth.place[after].height_m);
        let time = tight.truth.t_s[after - 1] + (a - height_m) / (a - b);
        // Height is followed by one-second samples: a tenth of a metre of curvature.
        far("time at a height, s", state.t_s, time, 2e-2);
        far("rate, rad/s", state.roll_rate_rad_s, tight.truth.w_inertial_body[after][0], 2e-3);
    }
    assert!(flown.tumbled_at_m.is_none());
}

/// Attitude against the tight integrator sample by sample, by descents ordered to end between: off-vertical at the height of each sample.
#[test]
fn law_attitude_as_the_tight_integrator() {
    let s = scenario(
        venus(-2.992_37e-7, wind(), Atmosphere::Venus),
        lander(0.0125),
        flight(3e3, [0.0, -8.0, 9.0], 10.0, 40.0),
        Dispersions::default(),
    );
    let tight = fly_planet(&s, &s.flights[0]).expect("flies").truth;
    let heights: Vec<f64> = tight.place.iter().skip(1).take(30).map(|p| p.height_m).collect();
    let flown = fly(&s, heights, STEP_S, None);
    let mut largest = 0.0_f64;
    for (k, state) in flown.at_heights.iter().enumerate() {
        let [_, pitch, _] = tight.attitude_rad[k + 1];
        let state = state.expect("passed");
        // Nose down: the angle from the vertical is π/2 + pitch in size.
        largest = largest.max((state.off_vertical_rad - (FRAC_PI_2 + pitch).abs()).abs());
        let [_, q, r] = tight.w_inertial_body[k + 1];
        largest = largest.max((state.pitch_yaw_rate_rad_s - q.hypot(r)).abs() / 3.0);
    }
    // Phase (6e-5 of 0.29 rad a step) and the chord over a step of 0.1 s, (ω h)²/8 of ten degrees: 2e-3 rad.
    assert!(largest < 2e-3, "{largest}");
}

/// Steps of half the length through the same gust: the error falls by 2⁴ = 16, to 20 % of terms of fifth order.
#[test]
fn order_four_in_the_step() {
    let planet = venus(0.0, Winds::STILL, Atmosphere::Venus);
    let at = |step_s: f64| {
        let s = scenario(planet.clone(), lander(0.0), flight(3e3, [0.0, 3.0, 9.0], 8.0, 400.0), Dispersions::default());
        let flown = fly(&s, vec![2950.0], step_s, None);
        flown.touch_down.map(|t| (t.state.t_s, t.state.off_vertical_rad, t.drift_m[1])).expect("the ground")
    };
    let (a, b, c) = (at(0.2), at(0.1), at(0.05));
    let ratio = (a.2 - b.2) / (b.2 - c.2);
    assert!((12.0..24.0).contains(&ratio), "drift {a:?} {b:?} {c:?}: {ratio}");
}

/// Vertical fall through an isothermal gas in uniform gravity, with y = ρ S C_A H/m:
/// `V² = (2 g H/y)(1 + 1/y + 2/y² + 6/y³ + ..)`, the asymptotic series of `2 g H e⁻ʸ Ei(y)`. At y > 60 four terms leave 1e-6.
#[test]
fn exact_terminal_speed_over_height() {
    let (gravity, temperature_k, r) = (8.87, 700.0, 190.0);
    let scale_m = r * temperature_k / gravity;
    let air = |h: f64| (h, Air { pressure_pa: 9e6 * (-h / scale_m).exp(), temperature_k, gas_constant_j_kg_k: r });
    let atmosphere = Atmosphere::Table(AtmosphereTable::new(vec![air(0.0), air(2.5e4)]).expect("ascends"));
    let planet = Planet { gravity: Gravity::Uniform { gravity_m_s2: gravity }, ..venus(0.0, Winds::STILL, atmosphere) };
    let heights: Vec<f64> = (0..18).map(|k| 1.8e4 - 1e3 * f64::from(k)).collect();
    let s = scenario(planet, lander(0.0), flight(2e4, [0.0, 0.0, 14.0], 0.0, 4000.0), Dispersions::default());
    let flown = fly(&s, heights.clone(), STEP_S, None);
    let area = s.body.reference.area_m2;
    for (h, state) in heights.iter().zip(&flown.at_heights) {
        let density = air(*h).1.density_kg_m3();
        let y = density * area * 6.662 * scale_m / 840.4;
        let series = 1.0 + 1.0 / y + 2.0 / (y * y) + 6.0 / (y * y * y);
        let exact = (2.0 * gravity * scale_m / y * series).sqrt();
        let v = state.expect("passed").descent_m_s;
        assert!((v / exact - 1.0).abs() < 3e-6, "{h} m: {v} m/s, exact {exact}");
    }
}

fn gusty() -> Dispersions {
    let turbulence =
        Turbulence { axial_rms_m_s: 0.4, lateral_rms_m_s: 0.3, axial_scale_m: 40.0, lateral_scale_m: 60.0, bandwidth: 0.0 };
    Dispersions { gusts: GustProfile::steady(turbulence), ..Dispersions::default() }
}

/// A seed is a flight: the same bits again, other bits with another.
#[test]
fn law_a_seed_is_a_flight() {
    let s = scenario(venus(0.0, wind(), Atmosphere::Venus), lander(0.0125), flight(2e3, [0.0, -5.0, 9.0], 5.0, 400.0), gusty());
    let one = |run| fly(&s, vec![1e3, 0.0], STEP_S, Some(Seed { campaign: 3, run }));
    assert_eq!(one(7), one(7));
    assert_ne!(one(7), one(8));
    // Without a seed the air flows evenly.
    let still = scenario(s.planet.clone(), s.body.clone(), s.flights[0].clone(), Dispersions::default());
    assert_eq!(fly(&s, vec![1e3], STEP_S, None), fly(&still, vec![1e3], STEP_S, Some(Seed { campaign: 3, run: 7 })));
}

/// The scatter of the start is the ordered one: over 4000 seeds each standard deviation to 5 % (four times 1/√(2·4000)).
#[test]
fn law_the_start_scatters_as_ordered() {
    let dispersions = Dispersions {
        start: StartDispersion {
            velocity_ned_m_s: [0.0, 2.0, 0.0],
            attitude_body_rad: [0.3, 0.02, 0.0],
            rates_rad_s: [0.1, 0.0, 0.05],
        },
        ..Dispersions::default()
    };
    // A tenth of a second from the start to the first height.
    let s =
        scenario(venus(0.0, Winds::STILL, Atmosphere::Venus), lander(0.0), flight(1.0, [0.0, 0.0, 9.0], 0.0, 10.0), dispersions);
    let descent = Descent::new(&s, &s.flights[0], vec![1.0], 0.05).expect("sound");
    let n = 4000;
    let mut squares = [0.0; 4];
    for run in 0..n {
        let at = descent.fly(&s.body, Some(Seed { campaign: 1, run })).expect("flies").at_heights[0].expect("the start");
        let all = [at.across_m_s, at.off_vertical_rad, at.roll_rate_rad_s, at.pitch_yaw_rate_rad_s];
        squares.iter_mut().zip(all).for_each(|(sum, x)| *sum += x * x / n as f64);
    }
    for (square, std) in squares.into_iter().zip([2.0, 0.02, 0.1, 0.05]) {
        assert!((square.sqrt() / std - 1.0).abs() < 0.05, "{} {std}", square.sqrt());
    }
}

/// Lateral gusts of 0.3 m/s turn the air's direction by 0.3/V; a body without moments keeps its attitude, so that its total angle of
/// attack over many seeds has that size in each direction, less what its drag lets it follow (2 % here).
#[test]
fn law_gusts_have_their_size_in_flight() {
    let mut body = lander(0.0);
    body.aero.values[3..].fill(0.0);
    body.vehicle.mass_kg = 8.404e7;
    let s = scenario(venus(0.0, Winds::STILL, Atmosphere::Venus), body, flight(200.0, [0.0, 0.0, 40.0], 0.0, 60.0), gusty());
    let descent = Descent::new(&s, &s.flights[0], vec![100.0], 0.05).expect("sound");
    let n = 3000;
    let mut square = 0.0;
    for run in 0..n {
        let at = descent.fly(&s.body, Some(Seed { campaign: 2, run })).expect("flies").at_heights[0].expect("passed");
        square += (at.alpha_t_rad.tan() * at.descent_m_s).powi(2) / n as f64;
    }
    // Two components; standard error of a variance over 2·3000 numbers 1.8 %.
    assert!((square / (2.0 * 0.09) - 1.0).abs() < 0.08, "{square}");
}

/// A body that is unstable turns over: an answer, with the height, and no error.
#[test]
fn law_a_descent_that_tumbles_is_an_answer() {
    let mut body = lander(0.0);
    body.aero.values[5] = 3.0;
    body.aero.values[6] = 0.0;
    let s = scenario(
        venus(0.0, Winds::STILL, Atmosphere::Venus),
        body,
        flight(1e3, [0.0, 0.0, 9.0], 1.0, 400.0),
        Dispersions::default(),
    );
    let flown = fly(&s, vec![500.0], STEP_S, None);
    let at = flown.tumbled_at_m.expect("turned over");
    assert!(at < 1e3 && flown.touch_down.is_some(), "{flown:?}");
    assert!(Descent::new(&s, &s.flights[0], vec![], 0.0).is_err_and(|e| e.to_string().contains("step of a descent")));
}
