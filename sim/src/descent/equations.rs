//! sim: a descent's equations and their steps. In: state, gust over a step. Out: the state after it.
//!
//! Runge and Kutta's classical method of fourth order. At 0.1 s the pitch mode of a lander (some 3 rad/s) gains a phase error of 6e-5 and
//! loses 4e-6 of its amplitude in a step; where the stages part, as in the strong damping of large angles, the step is halved.

use super::place::{LocalAxes, local};
use super::profile::Profile;
use crate::dynamics::quaternion_rate;
use crate::error::SimError;
use crate::planet::forces::{Acting, BodyForces};
use windfall_model::frames::{Body, Inertial, Rotation, Vec3};
use windfall_model::planet::Planet;

/// Position 0-2, velocity 3-5, inertial axes; quaternion to them 6-9; body rates 10-12.
pub(super) type RigidState = [f64; 13];

/// Most parts of a step.
const MOST_PARTS: u32 = 1 << 12;
/// Allowed `h/6 |k₃ − k₂|` of the body rates over the rates: of a mode λ it is `(hλ)³/24`, so that `h|λ|` stays below ½.
const STAGES_APART: f64 = 5e-3;
/// Body rate that is added to the rates there, rad/s: below it angles hardly change in a step.
const SMALL_RATE_RAD_S: f64 = 0.05;

/// A gust that changes evenly: velocity toward north, east, down (m/s) at the time 0, and its rate (m/s²).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EvenGust {
    pub(super) from: [f64; 3],
    pub(super) rate: [f64; 3],
}

impl EvenGust {
    pub(super) fn at(&self, t_s: f64) -> [f64; 3] {
        [0, 1, 2].map(|k| self.from[k] + t_s * self.rate[k])
    }
}

/// Planet and body.
pub(super) struct Equations<'a> {
    pub(super) planet: &'a Planet,
    pub(super) profile: &'a Profile,
    pub(super) body: BodyForces<'a>,
}

/// Place, velocity over the ground and against the air.
pub(super) struct Moving {
    pub(super) local: LocalAxes,
    pub(super) v_ground: Vec3<Inertial>,
    pub(super) v_air: Vec3<Inertial>,
    wind: Vec3<Inertial>,
    shear: [f64; 2],
    density_kg_m3: f64,
}

fn position(y: &RigidState) -> Vec3<Inertial> {
    Vec3::new(y[0], y[1], y[2])
}
fn velocity(y: &RigidState) -> Vec3<Inertial> {
    Vec3::new(y[3], y[4], y[5])
}
pub(super) fn rates(y: &RigidState) -> Vec3<Body> {
    Vec3::new(y[10], y[11], y[12])
}
pub(super) fn attitude(y: &RigidState) -> Rotation<Inertial, Body> {
    Rotation::from_quaternion([y[6], y[7], y[8], y[9]])
}

impl Equations<'_> {
    /// How the body moves in a gust.
    #[inline]
    pub(super) fn moving(&self, y: &RigidState, gust: [f64; 3]) -> Moving {
        let p = position(y);
        let local = local(&self.planet.figure, p);
        let air = self.profile.at(local.height_m);
        let v_ground = velocity(y) - self.planet.ground_velocity(p);
        let wind = local.north * (air.wind[0] + gust[0]) + local.east * (air.wind[1] + gust[1]) + local.down * gust[2];
        Moving { local, v_ground, v_air: v_ground - wind, wind, shear: air.shear, density_kg_m3: air.density_kg_m3 }
    }

    #[inline]
    fn rate(&self, y: &RigidState, gust: [f64; 3], gust_rate: [f64; 3]) -> RigidState {
        let m = self.moving(y, gust);
        let LocalAxes { north, east, down, .. } = m.local;
        let climb = -m.v_ground.dot(down);
        let a_air = self.planet.ground_velocity(velocity(y) + m.wind)
            + north * (m.shear[0] * climb + gust_rate[0])
            + east * (m.shear[1] * climb + gust_rate[1])
            + down * gust_rate[2];
        let gravity = self.planet.gravity.acceleration(position(y), down, &self.planet.figure);
        let acting = Acting { gravity, v_air: m.v_air, a_air, density_kg_m3: m.density_kg_m3 };
        let w = rates(y);
        let (a, w_rate) = self.body.rigid(&acting, attitude(y), w);
        let q = quaternion_rate([y[6], y[7], y[8], y[9]], w.to_array());
        let ([ax, ay, az], [pd, qd, rd]) = (a.to_array(), w_rate.to_array());
        [y[3], y[4], y[5], ax, ay, az, q[0], q[1], q[2], q[3], pd, qd, rd]
    }

    /// The state after `step_s`; `parts` is how many steps the last one took, and this one.
    pub(super) fn step(&self, y: &RigidState, gust: &EvenGust, step_s: f64, parts: &mut u32) -> Result<RigidState, SimError> {
        *parts = (*parts / 2).max(1);
        loop {
            if let Some(next) = self.in_parts(y, gust, step_s, *parts) {
                return Ok(next);
            }
            if *parts >= MOST_PARTS {
                return Err(SimError::StepTooSmall { t_s: 0.0 });
            }
            *parts *= 2;
        }
    }

    fn in_parts(&self, y: &RigidState, gust: &EvenGust, step_s: f64, parts: u32) -> Option<RigidState> {
        let h = step_s / f64::from(parts);
        let mut y = *y;
        for k in 0..parts {
            y = self.runge_kutta(&y, gust, h * f64::from(k), h)?;
        }
        Some(y)
    }

    /// One step; none where its stages part.
    #[inline]
    fn runge_kutta(&self, y: &RigidState, gust: &EvenGust, t_s: f64, h: f64) -> Option<RigidState> {
        let (middle, end) = (gust.at(t_s + 0.5 * h), gust.at(t_s + h));
        let k1 = self.rate(y, gust.at(t_s), gust.rate);
        let k2 = self.rate(&along(y, 0.5 * h, &k1), middle, gust.rate);
        let k3 = self.rate(&along(y, 0.5 * h, &k2), middle, gust.rate);
        let apart = (rates(&k3) - rates(&k2)).norm() * (h / 6.0);
        if apart.is_nan() || apart > STAGES_APART * (SMALL_RATE_RAD_S + rates(y).norm()) {
            return None;
        }
        let k4 = self.rate(&along(y, h, &k3), end, gust.rate);
        let mut next: RigidState = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        let norm = next[6..10].iter().map(|x| x * x).sum::<f64>().sqrt();
        next[6..10].iter_mut().for_each(|x| *x /= norm);
        Some(next)
    }
}

#[inline]
fn along(y: &RigidState, h: f64, k: &RigidState) -> RigidState {
    std::array::from_fn(|i| y[i] + h * k[i])
}
