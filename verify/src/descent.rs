//! verify: descents against linear theory. In: the full-scale lander in Venus' air. Out: distances from terminal speed, frequency, damping.

use super::flown::largest;
use super::{Bound, Check, CheckKind};
use crate::VerifyError;
use nalgebra::{Complex, DMatrix, DVector, Matrix3};
use std::f64::consts::{FRAC_PI_2, TAU};
use windfall_model::frames::Vec3;
use windfall_model::planet::{
    Air, Atmosphere, AtmosphereTable, Dispersions, FlightStart, Geodetic, Gravity, Planet, PlanetBody, PlanetFlight,
    PlanetScenario, Reference, Spheroid, Winds,
};
use windfall_model::{Aero, ApparentMass, Inertia, Structure, Vehicle};
use windfall_replay::descent::{SteadyFall, steady_fall};
use windfall_sim::{Descent, fly_planet};

/// Where a descent begins, m.
const START_M: f64 = 20e3;
/// Heights of whose air small pitching is flown, m.
const HEIGHTS_M: [f64; 5] = [20e3, 15e3, 10e3, 5e3, 0.0];
/// Angle at which pitching begins, rad: what is of third order in it, 205·α² in the damping of 3.3, stays below 1e-5.
const SMALL_RAD: f64 = 3e-4;
/// Sample rate (Hz) and time (s) of pitching.
const RATE_HZ: f64 = 5.0;
const TIME_S: f64 = 8.0;

pub(super) fn checks() -> Result<Vec<Check>, VerifyError> {
    let source = "full-scale lander (thesis Tables 2.2, 5.5), Venus' air (Seiff and others 1985); Etkin and Reid 1996, ch. 4";
    let exact =
        |id, what: &str, figure: f64, bound| Check::new(CheckKind::Exact, id, what, (figure, "-"), Bound::at_most(bound), source);
    let (frequency, damping) = pitching()?;
    Ok(vec![
        exact(
            "descent-terminal-speed",
            "descent from 20 km on Venus: speed over height against the terminal speed",
            falling()?,
            1e-3,
        ),
        exact(
            "descent-pitch-frequency",
            "small pitching in the air of five heights: frequency against linear theory",
            frequency,
            1e-4,
        ),
        exact("descent-pitch-damping", "its decay", damping, 1e-3),
    ])
}

fn scenario(atmosphere: Atmosphere, start: FlightStart, duration_s: f64) -> PlanetScenario {
    // Without the steady roll moment, which would couple pitch and yaw.
    let values = vec![6.662, 3.5129, -2.0035, 0.0, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];
    let vehicle = Vehicle {
        mass_kg: 840.4,
        inertia: Inertia { xx: 360.9, yy: 235.7, zz: 235.6, ..Inertia::default() },
        p_origin_cm: Vec3::zero(),
        diameter_m: 0.85,
        apparent: ApparentMass::default(),
        loose: None,
    };
    let aero = Aero::new(Structure::axisymmetric(), values);
    let planet = Planet {
        figure: Spheroid { equatorial_radius_m: 6_051_800.0, flattening: 0.0 },
        rotation_rad_s: 0.0,
        gravity: Gravity::Central { mu_m3_s2: 3.248_585_92e14 },
        atmosphere: Some(atmosphere),
        wind: Winds::STILL,
    };
    let name = "check".to_owned();
    let numerics = PlanetFlight::default_numerics();
    let flight = PlanetFlight { name: name.clone(), duration_s, rate_hz: RATE_HZ, start, numerics };
    let body = PlanetBody { vehicle, reference: Reference::of_diameter(0.85), aero, point: false };
    PlanetScenario { name, planet, body, flights: vec![flight], dispersions: Dispersions::default() }
}

fn start(height_m: f64, speed_m_s: f64, off_rad: f64) -> FlightStart {
    FlightStart {
        place: Geodetic { height_m, ..Geodetic::default() },
        v_ground: Vec3::new(0.0, 0.0, speed_m_s),
        attitude_rad: [0.0, off_rad - FRAC_PI_2, 0.0],
        w_inertial_body: Vec3::zero(),
    }
}

/// Linear theory of a scenario at a height; its start lends the place.
fn theory(s: &PlanetScenario, height_m: f64) -> Result<SteadyFall, VerifyError> {
    let none = VerifyError::NoTerminalSpeed { scenario: s.name.clone() };
    steady_fall(s, &s.body, &s.flights[0].start, height_m).ok_or(none)
}

/// Largest relative distance from the terminal speed at every kilometre below the first. The body lags behind it by `V²'/4g` of itself,
/// 4e-4 at 19 km, since it has to slow down.
fn falling() -> Result<f64, VerifyError> {
    let at_start = theory(&scenario(Atmosphere::Venus, start(START_M, 0.0, 0.0), 1.0), START_M)?.terminal_speed_m_s;
    let s = scenario(Atmosphere::Venus, start(START_M, at_start, 0.0), 4000.0);
    let heights: Vec<f64> = (0..20).map(|k| START_M - 1e3 * f64::from(k + 1)).collect();
    let flown = Descent::new(&s, &s.flights[0], heights.clone(), 0.1)?.fly(&s.body, None)?;
    let mut far = Vec::new();
    for (h, state) in heights.into_iter().zip(flown.at_heights) {
        let speed = state.map_or(f64::NAN, |x| x.descent_m_s);
        far.push(speed / theory(&s, h)?.terminal_speed_m_s - 1.0);
    }
    Ok(largest(far.into_iter()))
}

/// Largest relative distances of frequency and decay, in air that has one height's density at all heights.
fn pitching() -> Result<(f64, f64), VerifyError> {
    let (mut frequency, mut damping) = (Vec::new(), Vec::new());
    for height_m in HEIGHTS_M {
        let air = Atmosphere::Venus.at(height_m);
        let row = |h: f64| (h, Air { ..air });
        let same = AtmosphereTable::new(vec![row(0.0), row(2.0 * START_M)]).expect("two rows that ascend");
        let frozen = |start| scenario(Atmosphere::Table(same.clone()), start, TIME_S);
        let known = theory(&frozen(start(START_M, 0.0, 0.0)), START_M)?;
        let s = frozen(start(START_M, known.terminal_speed_m_s, SMALL_RAD));
        let truth = fly_planet(&s, &s.flights[0])?.truth;
        let q: Vec<f64> = truth.w_inertial_body.iter().map(|w| w[1]).collect();
        let found = oscillation(&q, 1.0 / RATE_HZ);
        frequency.push(found.im / (TAU * known.pitch_frequency_hz.unwrap_or(f64::NAN)) - 1.0);
        damping.push(-found.re / known.pitch_damping_per_s - 1.0);
    }
    Ok((largest(frequency.into_iter()), largest(damping.into_iter())))
}

/// Exponent (1/s) of the oscillation in a free motion of third order: least squares of its linear recurrence (Prony 1795).
fn oscillation(x: &[f64], interval_s: f64) -> Complex<f64> {
    let n = x.len() - 3;
    let a = DMatrix::from_fn(n, 3, |i, k| x[i + 2 - k]);
    let b = DVector::from_fn(n, |i, _| x[i + 3]);
    let c = a.svd(true, true).solve(&b, 0.0).unwrap_or_else(|_| DVector::zeros(3));
    #[rustfmt::skip]
    let companion = Matrix3::new(
        c[0], c[1], c[2],
        1.0, 0.0, 0.0,
        0.0, 1.0, 0.0,
    );
    let roots = companion.complex_eigenvalues();
    roots.iter().find(|r| r.im > 0.0).map_or(Complex::new(f64::NAN, f64::NAN), |r| r.ln() / interval_s)
}

#[cfg(test)]
mod tests;
