//! sim: descents to the ground, many of them. In: a planet scenario, bodies, seeds. Out: what each did over height and at touch-down.
//!
//! The physics is that of [`crate::fly_planet`], with gusts and a scattered start; air and wind come from a table over height and steps are
//! of one length, so that thousands of flights are affordable. How near the two come is a test (`sim/tests/it/descent.rs`).

mod equations;
mod gusts;
mod place;
mod profile;

use crate::error::SimError;
use crate::integrate::RUNAWAY_RAD_S;
use crate::planet::forces::BodyForces;
use crate::planet::{check, start_state};
use crate::{Channel, Seed};
use equations::{Equations, EvenGust, RigidState, attitude, rates};
use gusts::{Gusts, streams};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use profile::Profile;
use std::f64::consts::FRAC_PI_2;
use windfall_model::frames::{Inertial, Vec3};
use windfall_model::planet::{GustProfile, Planet, PlanetBody, PlanetFlight, PlanetScenario, StartDispersion};

/// Height of the last part of a descent, over which root mean squares are taken, m.
pub const LAST_M: f64 = 1000.0;
/// Room above the start that a gust may carry a body to, m.
const ROOM_M: f64 = 2000.0;
/// Height to which contact with the ground is found, m.
const CONTACT_M: f64 = 1e-6;
/// Rounds of that search; each gains the factor by which the speed changes within a step.
const CONTACT_ROUNDS: usize = 8;

/// What is seen of a descent at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DescentState {
    /// Time from the start, s.
    pub t_s: f64,
    /// Height over the ellipsoid, m.
    pub height_m: f64,
    /// Speed against the air, gusts included, m/s.
    pub airspeed_m_s: f64,
    /// Speed downward over the ground, m/s.
    pub descent_m_s: f64,
    /// Speed along the ground, m/s.
    pub across_m_s: f64,
    /// Total angle of attack, rad, in [0, π].
    pub alpha_t_rad: f64,
    /// Angle of the body's x axis from the vertical downward, rad, in [0, π].
    pub off_vertical_rad: f64,
    /// Body rate across the x axis, √(q² + r²), rad/s.
    pub pitch_yaw_rate_rad_s: f64,
    /// Body rate p about the x axis, rad/s.
    pub roll_rate_rad_s: f64,
}

/// The end of a descent on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchDown {
    /// What is seen there.
    pub state: DescentState,
    /// Way over the ground from the start, toward north and east in the horizontal plane of the start, m.
    pub drift_m: [f64; 2],
    /// Root mean square of the angle from the vertical over the last [`LAST_M`], rad.
    pub off_vertical_rms_rad: f64,
    /// Root mean square of √(q² + r²) over the last [`LAST_M`], rad/s.
    pub pitch_yaw_rate_rms_rad_s: f64,
}

/// One descent.
#[derive(Clone, Debug, PartialEq)]
pub struct DescentFlown {
    /// At each of the ordered heights, highest first; none where it did not come.
    pub at_heights: Vec<Option<DescentState>>,
    /// The end on the ground; none where the ordered duration ended before.
    pub touch_down: Option<TouchDown>,
    /// Height at which the total angle of attack first passed 90°, m.
    pub tumbled_at_m: Option<f64>,
}

impl DescentState {
    /// Linear between this and a later instant.
    fn between(&self, o: &Self, part: f64) -> Self {
        let mix = |a: f64, b: f64| a + part * (b - a);
        Self {
            t_s: mix(self.t_s, o.t_s),
            height_m: mix(self.height_m, o.height_m),
            airspeed_m_s: mix(self.airspeed_m_s, o.airspeed_m_s),
            descent_m_s: mix(self.descent_m_s, o.descent_m_s),
            across_m_s: mix(self.across_m_s, o.across_m_s),
            alpha_t_rad: mix(self.alpha_t_rad, o.alpha_t_rad),
            off_vertical_rad: mix(self.off_vertical_rad, o.off_vertical_rad),
            pitch_yaw_rate_rad_s: mix(self.pitch_yaw_rate_rad_s, o.pitch_yaw_rate_rad_s),
            roll_rate_rad_s: mix(self.roll_rate_rad_s, o.roll_rate_rad_s),
        }
    }
}

/// A flight of a scenario made ready to be flown down many times.
#[derive(Debug)]
pub struct Descent<'a> {
    planet: &'a Planet,
    flight: &'a PlanetFlight,
    gusts: Option<&'a GustProfile>,
    start: StartDispersion,
    profile: Profile,
    heights_m: Vec<f64>,
    step_s: f64,
    ceiling_m: f64,
}

impl<'a> Descent<'a> {
    /// Makes a flight of a scenario ready, with the scenario's gusts and scatter of the start. `heights_m`: where it is looked at,
    /// highest first; `step_s`: the step of integration and of the gusts.
    ///
    /// # Errors
    /// A start that cannot be flown from or is not above the ground, a body without attitude, a step that is not positive.
    pub fn new(
        scenario: &'a PlanetScenario,
        flight: &'a PlanetFlight,
        heights_m: Vec<f64>,
        step_s: f64,
    ) -> Result<Self, SimError> {
        let setup = |what, value, allowed| Err(SimError::Setup { what, value, allowed });
        check(scenario, flight)?;
        let from_m = flight.start.place.height_m;
        if scenario.body.point {
            return setup("bodies without attitude to descend, number", 1.0, "none: a descent needs a rigid body");
        }
        if from_m <= 0.0 {
            return setup("height_m of the start of a descent", from_m, "above zero");
        }
        if !(step_s > 0.0 && step_s.is_finite()) {
            return setup("step of a descent, s", step_s, "positive and finite");
        }
        let highest = scenario.planet.atmosphere.as_ref().map_or(f64::INFINITY, |a| a.range_m()[1]);
        let ceiling_m = (from_m + ROOM_M).min(highest);
        Ok(Self {
            planet: &scenario.planet,
            flight,
            gusts: scenario.dispersions.gusts.as_ref(),
            start: scenario.dispersions.start,
            profile: Profile::new(&scenario.planet, ceiling_m),
            heights_m,
            step_s,
            ceiling_m,
        })
    }

    /// Flies a body down: through gusts and from a scattered start of that seed, or without both.
    ///
    /// # Errors
    /// A body that cannot be flown, something that became NaN, a body that spins without end or climbs out of the air.
    pub fn fly(&self, body: &PlanetBody, seed: Option<Seed>) -> Result<DescentFlown, SimError> {
        let equations = Equations { planet: self.planet, profile: &self.profile, body: BodyForces::new(body)? };
        let first = self.first(seed);
        match (self.gusts, seed) {
            (Some(profile), Some(seed)) => {
                let mut gusts = Gusts::new(profile, streams(seed));
                let begin = gusts.now(self.flight.start.place.height_m);
                self.down(&equations, first, begin, |at| {
                    gusts.advance(self.step_s, at.airspeed_m_s, at.height_m);
                    gusts.now(at.height_m)
                })
            }
            _ => self.down(&equations, first, [0.0; 3], |_| [0.0; 3]),
        }
    }

    /// State at the first sample, scattered where there is a seed.
    fn first(&self, seed: Option<Seed>) -> RigidState {
        let mut y: RigidState = start_state::<13>(self.planet, &self.flight.start).into();
        let Some(seed) = seed.filter(|_| !self.start.is_exact()) else { return y };
        let mut normals = seed.normals(Channel::Start);
        let mut scattered = |std: [f64; 3]| std.map(|s| s * normals.next().unwrap_or(0.0));
        let v = self.flight.start.place.r_inertial_ned() * Vec3::from_array(scattered(self.start.velocity_ned_m_s));
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(scattered(self.start.attitude_body_rad)));
        let w = scattered(self.start.rates_rad_s);
        let q = Quaternion::new(y[6], y[7], y[8], y[9]) * turn.into_inner();
        for (k, (v, w)) in v.to_array().into_iter().zip(w).enumerate() {
            y[3 + k] += v;
            y[10 + k] += w;
        }
        y[6..10].copy_from_slice(&[q.w, q.i, q.j, q.k]);
        y
    }

    /// Steps down to the ground; `next_gust` gives the gust at the end of a step that begins as seen.
    fn down(
        &self,
        equations: &Equations<'_>,
        first: RigidState,
        begin: [f64; 3],
        mut next_gust: impl FnMut(&DescentState) -> [f64; 3],
    ) -> Result<DescentFlown, SimError> {
        let mut log = Log::new(&self.heights_m);
        let (mut y, mut gust, mut parts) = (first, begin, 1);
        let mut before = seen(equations, &y, gust, 0.0);
        log.see(None, &before);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a duration is checked positive and finite")]
        let steps = (self.flight.duration_s / self.step_s).ceil() as u64;
        for k in 1..=steps {
            let end = next_gust(&before);
            let even = EvenGust { from: gust, rate: [0, 1, 2].map(|i| (end[i] - gust[i]) / self.step_s) };
            let next = equations.step(&y, &even, self.step_s, &mut parts).map_err(|e| at(e, before.t_s))?;
            let after = seen(equations, &next, end, k as f64 * self.step_s);
            if after.height_m <= 0.0 {
                let (y, last) = self.contact(equations, &y, &even, [&before, &after])?;
                log.see(Some(&before), &last);
                let touch_down = log.touch_down(&last, self.drift(first, &y, last.t_s));
                return Ok(log.into_flown(Some(touch_down)));
            }
            self.sound(&after)?;
            log.see(Some(&before), &after);
            (y, gust, before) = (next, end, after);
        }
        Ok(log.into_flown(None))
    }

    fn sound(&self, s: &DescentState) -> Result<(), SimError> {
        let t_s = s.t_s;
        if s.pitch_yaw_rate_rad_s.hypot(s.roll_rate_rad_s) > RUNAWAY_RAD_S {
            return Err(SimError::Runaway { limit_rad_s: RUNAWAY_RAD_S, t_s });
        }
        if s.height_m > self.ceiling_m {
            return Err(SimError::OutsideAtmosphere { t_s, height_m: s.height_m, low_m: 0.0, high_m: self.ceiling_m });
        }
        Ok(())
    }

    /// State on the ground, which is reached within a step: the part of the step is improved by the height that is left.
    fn contact(
        &self,
        equations: &Equations<'_>,
        y: &RigidState,
        gust: &EvenGust,
        [before, after]: [&DescentState; 2],
    ) -> Result<(RigidState, DescentState), SimError> {
        let fall_m = before.height_m - after.height_m;
        let mut part = before.height_m / fall_m;
        let mut parts = 1;
        let mut landed = (*y, *before);
        for _ in 0..CONTACT_ROUNDS {
            let step_s = part * self.step_s;
            let next = equations.step(y, gust, step_s, &mut parts).map_err(|e| at(e, before.t_s))?;
            landed = (next, seen(equations, &next, gust.at(step_s), before.t_s + step_s));
            if landed.1.height_m.abs() <= CONTACT_M {
                break;
            }
            part = (part + landed.1.height_m / fall_m).clamp(0.0, 1.0);
        }
        Ok(landed)
    }

    /// Way over the ground: both ends in axes that turn with the planet.
    fn drift(&self, first: RigidState, last: &RigidState, t_s: f64) -> [f64; 2] {
        let (sin, cos) = (-self.planet.rotation_rad_s * t_s).sin_cos();
        let moved: Vec3<Inertial> =
            Vec3::new(cos * last[0] - sin * last[1] - first[0], sin * last[0] + cos * last[1] - first[1], last[2] - first[2]);
        let ned = self.flight.start.place.r_inertial_ned().inverse() * moved;
        [ned.x(), ned.y()]
    }
}

/// The step of which an error says nothing.
fn at(error: SimError, t_s: f64) -> SimError {
    if matches!(error, SimError::StepTooSmall { .. }) { SimError::StepTooSmall { t_s } } else { error }
}

fn seen(equations: &Equations<'_>, y: &RigidState, gust: [f64; 3], t_s: f64) -> DescentState {
    let m = equations.moving(y, gust);
    let r = attitude(y);
    let [u, v, w] = (r.inverse() * m.v_air).to_array();
    let [p, q, rr] = rates(y).to_array();
    let nose: Vec3<Inertial> = Vec3::from(r.matrix.column(0).into_owned());
    let (along, descent_m_s) = (nose.dot(m.local.down), m.v_ground.dot(m.local.down));
    DescentState {
        t_s,
        height_m: m.local.height_m,
        airspeed_m_s: m.v_air.norm(),
        descent_m_s,
        across_m_s: m.v_ground.dot(m.local.north).hypot(m.v_ground.dot(m.local.east)),
        alpha_t_rad: v.hypot(w).atan2(u),
        off_vertical_rad: nose.cross(m.local.down).norm().atan2(along),
        pitch_yaw_rate_rad_s: q.hypot(rr),
        roll_rate_rad_s: p,
    }
}

/// What is kept of a descent under way.
struct Log<'a> {
    heights_m: &'a [f64],
    at_heights: Vec<Option<DescentState>>,
    tumbled_at_m: Option<f64>,
    /// Time in the last part, and squares of angle and rate times time.
    last: [f64; 3],
}

impl<'a> Log<'a> {
    fn new(heights_m: &'a [f64]) -> Self {
        Self { heights_m, at_heights: Vec::with_capacity(heights_m.len()), tumbled_at_m: None, last: [0.0; 3] }
    }
    /// One more instant, and the one before it.
    fn see(&mut self, before: Option<&DescentState>, now: &DescentState) {
        while let Some(height_m) = self.heights_m.get(self.at_heights.len()).filter(|h| now.height_m <= **h + CONTACT_M) {
            let crossed = before.filter(|b| b.height_m > *height_m);
            let state = crossed.map(|b| b.between(now, (b.height_m - height_m) / (b.height_m - now.height_m)));
            // A start below an ordered height never was there.
            let there = state.or_else(|| ((now.height_m - height_m).abs() <= CONTACT_M).then_some(*now));
            self.at_heights.push(there);
        }
        if self.tumbled_at_m.is_none() && now.alpha_t_rad > FRAC_PI_2 {
            self.tumbled_at_m = Some(now.height_m);
        }
        if let Some(b) = before.filter(|_| now.height_m < LAST_M) {
            let dt = now.t_s - b.t_s;
            let squares = [1.0, now.off_vertical_rad.powi(2), now.pitch_yaw_rate_rad_s.powi(2)];
            self.last.iter_mut().zip(squares).for_each(|(sum, x)| *sum += dt * x);
        }
    }
    fn touch_down(&self, state: &DescentState, drift_m: [f64; 2]) -> TouchDown {
        let [time, angle, rate] = self.last;
        let rms = |sum: f64, at_end: f64| if time > 0.0 { (sum / time).sqrt() } else { at_end };
        TouchDown {
            state: *state,
            drift_m,
            off_vertical_rms_rad: rms(angle, state.off_vertical_rad),
            pitch_yaw_rate_rms_rad_s: rms(rate, state.pitch_yaw_rate_rad_s),
        }
    }
    fn into_flown(mut self, touch_down: Option<TouchDown>) -> DescentFlown {
        self.at_heights.resize(self.heights_m.len(), None);
        DescentFlown { at_heights: self.at_heights, touch_down, tumbled_at_m: self.tumbled_at_m }
    }
}

#[cfg(test)]
mod tests;
