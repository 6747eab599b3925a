//! sim: free flight over a planet. In: planet, body, order. Out: places, velocities, attitudes at the sample times.
//!
//! Newton in inertial axes from the planet's centre, Euler in body axes, quaternion from body to inertial. The equations do not
//! depend on time (see [`windfall_model::planet`]); the planet's turning is taken off the longitude where a sample is looked at. Each
//! sample interval is integrated by itself, so that samples are ends of steps.

pub(crate) mod forces;

use crate::dynamics::quaternion_rate;
use crate::error::SimError;
use crate::integrate::{RUNAWAY_RAD_S, Span, solve};
use forces::{Acting, BodyForces};
use nalgebra::{Matrix3, SVector};
use ode_solvers::System;
use ode_solvers::dop_shared::{IntegrationError, OutputType};
use std::f64::consts::{PI, TAU};
use windfall_model::Numerics;
use windfall_model::frames::{Body, Inertial, Ned, Rotation, Vec3};
use windfall_model::planet::{FlightStart, Geodetic, Planet, PlanetFlight, PlanetScenario, Surroundings};

/// States of a body without attitude: position 0-2, velocity 3-5, inertial axes.
const POINT: usize = 6;
/// States of a rigid body: the same, quaternion 6-9, body rates 10-12.
const RIGID: usize = 13;
/// Height by which a flight may be beyond its atmosphere: round-off of a planet's radius, with room, m.
const SLACK_M: f64 = 1e-3;
/// Time to which contact with the ground is found, s.
const CONTACT_S: f64 = 1e-9;

/// What happened, at the sample times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanetTruth {
    /// Time, s.
    pub t_s: Vec<f64>,
    /// Geodetic place of the c.m.; longitude in (−π, π].
    pub place: Vec<Geodetic>,
    /// Velocity over the ground, m/s, local north-east-down axes.
    pub v_ground_ned: Vec<[f64; 3]>,
    /// Roll, pitch, yaw from the local north-east-down axes, rad; empty for a point mass.
    pub attitude_rad: Vec<[f64; 3]>,
    /// Body rates p, q, r against inertial axes, rad/s; empty for a point mass.
    pub w_inertial_body: Vec<[f64; 3]>,
}

impl PlanetTruth {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t_s.len()
    }
    /// True when there are no samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }
}

/// How a flight ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanetEnd {
    /// It lasted as long as ordered.
    Completed,
    /// The c.m. reached height 0.
    Ground {
        /// When, s.
        t_s: f64,
        /// Where.
        place: Geodetic,
        /// Velocity over the ground, m/s, north-east-down.
        v_ground_ned: [f64; 3],
    },
}

/// A flight over a planet.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanetFlown {
    /// What happened.
    pub truth: PlanetTruth,
    /// How it ended.
    pub end: PlanetEnd,
    /// Accepted steps of the integrator.
    pub steps: u64,
}

/// Flies one flight of a scenario. It ends at the ground (height 0) unless it starts there.
///
/// # Errors
/// A number that cannot be flown, a start below the ground, a flight that leaves its atmosphere, something that became NaN, or an
/// integrator that gave up.
pub fn fly_planet(scenario: &PlanetScenario, flight: &PlanetFlight) -> Result<PlanetFlown, SimError> {
    let forces = Forces::new(scenario)?;
    check(scenario, flight)?;
    if scenario.body.point { sampled::<POINT>(&forces, flight) } else { sampled::<RIGID>(&forces, flight) }
}

/// Whether a flight of a scenario can begin.
pub(crate) fn check(scenario: &PlanetScenario, flight: &PlanetFlight) -> Result<(), SimError> {
    let setup = |what, value, allowed| Err(SimError::Setup { what, value, allowed });
    let FlightStart { place, v_ground, attitude_rad, w_inertial_body } = &flight.start;
    let all = [place.latitude_rad, place.longitude_rad, v_ground.norm(), attitude_rad.iter().sum(), w_inertial_body.norm()];
    if let Some(bad) = all.into_iter().find(|x| !x.is_finite()) {
        return setup("state at the first sample", bad, "finite");
    }
    if place.height_m.is_nan() || place.height_m < 0.0 {
        return setup(
            "height_m, height of the start over the ellipsoid",
            place.height_m,
            "zero or more: the surface or above it",
        );
    }
    if let Some([low, high]) = scenario.planet.atmosphere.as_ref().map(windfall_model::planet::Atmosphere::range_m)
        && !(low - SLACK_M..=high + SLACK_M).contains(&place.height_m)
    {
        return Err(SimError::OutsideAtmosphere { t_s: 0.0, height_m: place.height_m, low_m: low, high_m: high });
    }
    if !(flight.duration_s >= 0.0 && flight.duration_s.is_finite() && flight.rate_hz > 0.0 && flight.rate_hz.is_finite()) {
        return setup("duration_s times rate_hz", flight.duration_s * flight.rate_hz, "positive and finite");
    }
    Ok(())
}

/// A body and its surroundings made ready.
struct Forces<'a> {
    planet: &'a Planet,
    body: BodyForces<'a>,
}

impl<'a> Forces<'a> {
    fn new(scenario: &'a PlanetScenario) -> Result<Self, SimError> {
        Ok(Self { planet: &scenario.planet, body: BodyForces::new(&scenario.body)? })
    }
    fn surroundings<const N: usize>(&self, y: &SVector<f64, N>) -> Surroundings {
        self.planet.surroundings(Vec3::new(y[0], y[1], y[2]), Vec3::new(y[3], y[4], y[5]))
    }
}

/// What of the surroundings acts on a body.
fn acting(s: &Surroundings) -> Acting {
    Acting { gravity: s.gravity, v_air: s.v_air, a_air: s.a_air, density_kg_m3: s.air.map_or(0.0, |a| a.density_kg_m3()) }
}

impl<const N: usize> System<f64, SVector<f64, N>> for &Forces<'_> {
    fn system(&self, _t: f64, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        let s = self.surroundings(y);
        let a = if N == POINT {
            self.body.point(&acting(&s))
        } else {
            let q = [y[6], y[7], y[8], y[9]];
            let w = Vec3::new(y[10], y[11], y[12]);
            let (a, w_rate) = self.body.rigid(&acting(&s), Rotation::from_quaternion(q), w);
            dy.as_mut_slice()[6..10].copy_from_slice(&quaternion_rate(q, w.to_array()));
            dy.as_mut_slice()[10..13].copy_from_slice(&w_rate.to_array());
            a
        };
        for k in 0..3 {
            dy[k] = y[3 + k];
            dy[3 + k] = a.xyz[k];
        }
    }
}

/// State at the first sample.
pub(crate) fn start_state<const N: usize>(planet: &Planet, start: &FlightStart) -> SVector<f64, N> {
    let p = planet.figure.position(&start.place);
    let r_inertial_ned = start.place.r_inertial_ned();
    let v = r_inertial_ned * start.v_ground + planet.ground_velocity(p);
    let mut y = SVector::<f64, N>::zeros();
    y.as_mut_slice()[0..3].copy_from_slice(&p.to_array());
    y.as_mut_slice()[3..6].copy_from_slice(&v.to_array());
    if N == RIGID {
        let q = (r_inertial_ned * r_ned_body(start.attitude_rad)).to_quaternion();
        y.as_mut_slice()[6..10].copy_from_slice(&q);
        y.as_mut_slice()[10..13].copy_from_slice(&start.w_inertial_body.to_array());
    }
    y
}

/// Body to north-east-down axes by yaw, pitch and roll (Stevens and Lewis 2003, eq. 1.3-20).
fn r_ned_body([roll, pitch, yaw]: [f64; 3]) -> Rotation<Ned, Body> {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    #[rustfmt::skip]
    let m = Matrix3::new(
        cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy,
        cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy,
        -sp,     sr * cp,                cr * cp,
    );
    Rotation::from_matrix(m)
}

/// Roll, pitch and yaw of a rotation; roll and yaw in (−π, π], singular at a pitch of ±π/2.
fn roll_pitch_yaw(r_ned_body: Rotation<Ned, Body>) -> [f64; 3] {
    let m = &r_ned_body.matrix;
    [m[(2, 1)].atan2(m[(2, 2)]), (-m[(2, 0)]).atan2(m[(2, 1)].hypot(m[(2, 2)])), m[(1, 0)].atan2(m[(0, 0)])]
}

fn sampled<const N: usize>(forces: &Forces<'_>, flight: &PlanetFlight) -> Result<PlanetFlown, SimError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "duration and rate are checked positive")]
    let intervals = (flight.duration_s * flight.rate_hz * (1.0 + 1e-12)).floor() as usize;
    let interval_s = 1.0 / flight.rate_hz;
    let mut y = start_state::<N>(forces.planet, &flight.start);
    let mut truth = PlanetTruth::default();
    observe(forces, 0.0, &y, &mut truth);
    let (mut steps, ends_at_ground) = (0, flight.start.place.height_m > 0.0);
    for k in 1..=intervals {
        let before_s = (k - 1) as f64 / flight.rate_hz;
        let (next, taken) = advance(forces, y, interval_s, before_s, flight.numerics)?;
        steps += taken;
        if ends_at_ground && forces.surroundings(&next).place.height_m <= 0.0 {
            let end = contact(forces, y, [before_s, interval_s], flight.numerics)?;
            return Ok(PlanetFlown { truth, end, steps });
        }
        let t_s = k as f64 / flight.rate_hz;
        sound(forces, &next, t_s)?;
        observe(forces, t_s, &next, &mut truth);
        y = next;
    }
    Ok(PlanetFlown { truth, end: PlanetEnd::Completed, steps })
}

/// State after `span_s` and accepted steps.
fn advance<const N: usize>(
    forces: &Forces<'_>,
    y: SVector<f64, N>,
    span_s: f64,
    t_s: f64,
    n: Numerics,
) -> Result<(SVector<f64, N>, u64), SimError> {
    let span = Span { end_s: span_s, sample_s: span_s, step_max_s: span_s, output: OutputType::Sparse };
    let (outcome, last) = solve(forces, y, n, span, |outcome, states| (outcome, states.last().copied()));
    let last = last.unwrap_or(y);
    if !last.sum().is_finite() {
        return Err(SimError::NotFinite { what: "state over the planet", t_s });
    }
    match outcome {
        Ok(stats) => Ok((last, u64::from(stats.accepted_steps))),
        Err(IntegrationError::MaxNumStepReached { n_step, x }) => {
            let (v, w) = (Vec3::<Inertial>::new(last[3], last[4], last[5]), last.as_slice().get(10..13).map_or(0.0, norm));
            let what = if w > v.norm() { "body rate" } else { "velocity" };
            Err(SimError::TooManySteps { steps: n_step, t_s: t_s + x, what, rate_per_s: w.max(1.0 / span_s) })
        }
        Err(_) => Err(SimError::StepTooSmall { t_s }),
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Body rates must be sane and the height inside the atmosphere.
fn sound<const N: usize>(forces: &Forces<'_>, y: &SVector<f64, N>, t_s: f64) -> Result<(), SimError> {
    if y.as_slice().get(10..13).is_some_and(|w| norm(w) > RUNAWAY_RAD_S) {
        return Err(SimError::Runaway { limit_rad_s: RUNAWAY_RAD_S, t_s });
    }
    let Some(atmosphere) = &forces.planet.atmosphere else { return Ok(()) };
    let [low_m, high_m] = atmosphere.range_m();
    let height_m = forces.surroundings(y).place.height_m;
    if (low_m - SLACK_M..=high_m + SLACK_M).contains(&height_m) {
        return Ok(());
    }
    Err(SimError::OutsideAtmosphere { t_s, height_m, low_m, high_m })
}

/// When the ground is reached within an interval that begins above it: bisection, each try integrated from the interval's beginning.
fn contact<const N: usize>(
    forces: &Forces<'_>,
    y: SVector<f64, N>,
    [t_s, interval_s]: [f64; 2],
    n: Numerics,
) -> Result<PlanetEnd, SimError> {
    let (mut above, mut below, mut at) = (0.0, interval_s, y);
    while below - above > CONTACT_S.max(4.0 * f64::EPSILON * t_s) {
        let middle = 0.5 * (above + below);
        let (state, _) = advance(forces, y, middle, t_s, n)?;
        if forces.surroundings(&state).place.height_m <= 0.0 {
            below = middle;
        } else {
            (above, at) = (middle, state);
        }
    }
    let (place, v) = seen(forces, t_s + below, &at);
    Ok(PlanetEnd::Ground { t_s: t_s + below, place, v_ground_ned: v.to_array() })
}

/// Place with the planet's own longitude, and velocity over the ground.
fn seen<const N: usize>(forces: &Forces<'_>, t_s: f64, y: &SVector<f64, N>) -> (Geodetic, Vec3<Ned>) {
    let s = forces.surroundings(y);
    let longitude = s.place.longitude_rad - forces.planet.rotation_rad_s * t_s;
    let turns = ((longitude - PI) / TAU).ceil();
    (Geodetic { longitude_rad: longitude - turns * TAU, ..s.place }, s.r_inertial_ned.inverse() * s.v_ground)
}

/// Appends one sample.
fn observe<const N: usize>(forces: &Forces<'_>, t_s: f64, y: &SVector<f64, N>, truth: &mut PlanetTruth) {
    let (place, v) = seen(forces, t_s, y);
    truth.t_s.push(t_s);
    truth.place.push(place);
    truth.v_ground_ned.push(v.to_array());
    if N == RIGID {
        let r_inertial_body: Rotation<Inertial, Body> = Rotation::from_quaternion([y[6], y[7], y[8], y[9]]);
        let r_ned_inertial = forces.surroundings(y).r_inertial_ned.inverse();
        truth.attitude_rad.push(roll_pitch_yaw(r_ned_inertial * r_inertial_body));
        truth.w_inertial_body.push([y[10], y[11], y[12]]);
    }
}
