//! sim: what is kept of the flights side by side. In: states at the sample times. Out: truth or states by flight, how each
//! ended, and what went wrong in each; one lane's fault leaves the others as they are.

use super::Order;
use super::kernel::{Kernel, Sight};
use super::lane::Lanes;
use crate::error::SimError;
use crate::fly::crossing;
use crate::integrate::{RUNAWAY_RAD_S, outside, samples};
use crate::truth::{End, Truth};
use nalgebra::Vector6;
use pulp::Simd;
use std::f64::consts::TAU;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    Truth,
    States,
}

/// States that every flight has.
const STATES: usize = 13;
/// States, then R_x, R_y, R_z, V_W, α_T, airspeed and tether force.
const SEEN: usize = STATES + 7;
/// Lanes at most.
const LANES_MAX: usize = 16;

/// One flight's results so far.
pub(super) struct Track<'a> {
    order: &'a Order<'a>,
    pub(super) truth: Truth,
    pub(super) states: Vec<[f64; STATES]>,
    last: Option<[f64; 6]>,
    /// Samples so far.
    pub(super) count: usize,
    /// How the flight ended, once it has.
    pub(super) end: Option<Result<End, SimError>>,
}

impl<'a> Track<'a> {
    pub(super) fn new(order: &'a Order<'a>, keep: Keep) -> Self {
        let n = samples(order.flight);
        let (truth, states) = match keep {
            Keep::Truth => (Truth::with_capacity(n), Vec::new()),
            Keep::States => (Truth::default(), Vec::with_capacity(n)),
        };
        Self { order, truth, states, last: None, count: 0, end: None }
    }

    /// Takes one sample, unless the flight has ended.
    fn take(&mut self, row: &[f64; SEEN], keep: Keep) {
        if self.end.is_some() {
            return;
        }
        let y: &[f64; STATES] = row.first_chunk().expect("a row begins with the states");
        let k = self.count;
        let t_s = k as f64 / self.order.flight.rate_hz;
        let now = [y[0], y[1], y[2], y[3], y[4], y[5]];
        self.end = self.stop(y, t_s, &now);
        if self.end.is_some() {
            return;
        }
        self.last = Some(now);
        self.count += 1;
        match keep {
            Keep::States => self.states.push(*y),
            Keep::Truth => self.push(t_s, row),
        }
        if self.count == samples(self.order.flight) {
            self.end = Some(Ok(End::Completed));
        }
    }

    fn stop(&self, y: &[f64; STATES], t_s: f64, now: &[f64; 6]) -> Option<Result<End, SimError>> {
        if !y.iter().sum::<f64>().is_finite() {
            let parts = [("position", 0..3), ("velocity", 3..6), ("attitude", 6..10), ("body rate", 10..13)];
            let bad = |r: &std::ops::Range<usize>| y[r.clone()].iter().any(|x| !x.is_finite());
            let what = parts.iter().find(|(_, r)| bad(r)).map_or("state", |(name, _)| name);
            return Some(Err(SimError::NotFinite { what, t_s }));
        }
        if y[10] * y[10] + y[11] * y[11] + y[12] * y[12] > RUNAWAY_RAD_S * RUNAWAY_RAD_S {
            return Some(Err(SimError::Runaway { limit_rad_s: RUNAWAY_RAD_S, t_s }));
        }
        let section = self.order.flight.section.filter(|s| outside(s, [y[0], y[1], y[2]]))?;
        let before = self.last.as_ref()?;
        let dt = 1.0 / self.order.flight.rate_hz;
        Some(Ok(crossing(&section, t_s - dt, dt, &Vector6::from(*before), &Vector6::from(*now))))
    }

    fn push(&mut self, t_s: f64, row: &[f64; SEEN]) {
        let three = |k: usize| [row[k], row[k + 1], row[k + 2]];
        let truth = &mut self.truth;
        truth.t_s.push(t_s);
        truth.p_tunnel_cm.push(three(0));
        truth.v_tunnel_cm.push(three(3));
        let q = [row[6], row[7], row[8], row[9]];
        let per_norm = 1.0 / q.iter().map(|c| c * c).sum::<f64>().sqrt();
        truth.quaternion.push(q.map(|c| c * per_norm));
        truth.w_tunnel_body.push(three(10));
        truth.attitude_rad.push(three(13));
        truth.vw_m_s.push(row[16]);
        truth.alpha_t_rad.push(row[17]);
        truth.airspeed_m_s.push(row[18]);
        truth.tether_n.push(row[19]);
    }
}

/// The tracks of the lanes, and the roll angles of the sample before, from which the next are unwrapped.
pub(super) struct Tracks<'a, 't, S: Simd> {
    pub(super) lanes: &'t mut [Track<'a>],
    keep: Keep,
    roll: Lanes<S>,
}

impl<'a, 't, S: Simd> Tracks<'a, 't, S> {
    pub(super) fn new(simd: S, lanes: &'t mut [Track<'a>], keep: Keep) -> Self {
        Self { lanes, keep, roll: Lanes::zero(simd) }
    }
    /// True when every flight has ended.
    pub(super) fn done(&self) -> bool {
        self.lanes.iter().all(|t| t.end.is_some())
    }

    /// Shows the lanes in `whose` (by number) their states `y` with inputs `row` at their next sample.
    #[inline(always)]
    pub(super) fn observe<const N: usize>(
        &mut self,
        simd: S,
        kernel: &Kernel<'_, S>,
        y: &[Lanes<S>; N],
        row: &[f64],
        whose: impl Fn(usize) -> bool,
    ) {
        let mut seen = [[0.0; LANES_MAX]; SEEN];
        for k in 0..STATES {
            y[k].store(&mut seen[k][..S::F64_LANES]);
        }
        let mut roll = self.roll;
        if self.keep == Keep::Truth {
            let s = kernel.sight(simd, y, row);
            let derived = Self::derived(kernel, &s, y, roll);
            for (k, x) in derived.iter().enumerate() {
                x.store(&mut seen[STATES + k][..S::F64_LANES]);
            }
            roll = derived[0];
        }
        self.hand_out(&seen, &whose);
        // A lane that is not at a sample keeps its roll.
        let mut kept = [0.0; LANES_MAX];
        self.roll.store(&mut kept[..S::F64_LANES]);
        let mut fresh = [0.0; LANES_MAX];
        roll.store(&mut fresh[..S::F64_LANES]);
        for lane in 0..S::F64_LANES {
            if whose(lane) {
                kept[lane] = fresh[lane];
            }
        }
        self.roll = Lanes::load(simd, &kept[..S::F64_LANES]);
    }

    #[inline(never)]
    fn hand_out(&mut self, seen: &[[f64; LANES_MAX]; SEEN], whose: &impl Fn(usize) -> bool) {
        for (lane, track) in self.lanes.iter_mut().enumerate() {
            if whose(lane) {
                let mut row = [0.0; SEEN];
                for (x, channel) in row.iter_mut().zip(seen) {
                    *x = channel[lane];
                }
                track.take(&row, self.keep);
            }
        }
    }

    /// R_x, R_y, R_z, V_W, α_T, airspeed and tether force.
    #[inline(always)]
    fn derived<const N: usize>(kernel: &Kernel<'_, S>, s: &Sight<S>, y: &[Lanes<S>; N], last: Lanes<S>) -> [Lanes<S>; 7] {
        let m = &s.m;
        let rx = (-m[1][2]).atan2(m[2][2]);
        let ry = m[0][2].atan2(m[0][0].mul_add(m[0][0], m[0][1] * m[0][1]).sqrt());
        let rz = (-m[0][1]).atan2(m[0][0]);
        let turns = (last - rx).scale(1.0 / TAU).round();
        let cross2 = s.b[1].mul_add(s.b[1], s.b[2] * s.b[2]);
        let speed = s.b[0].mul_add(s.b[0], cross2).sqrt();
        let alpha_t = cross2.sqrt().atan2(s.b[0]);
        let q = kernel.pressure(s);
        let tension = if kernel.parts.tether { kernel.tension(s, y, q).0 } else { q.scale(0.0) };
        [turns.scale(TAU) + rx, ry, rz, s.vw, alpha_t, speed, tension]
    }
}
