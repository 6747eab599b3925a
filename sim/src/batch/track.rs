//! sim: what is kept of the flights side by side. In: states at the sample times. Out: truth or states by flight, how each
//! ended, and what went wrong in each; one lane's fault leaves the others as they are.

use super::Order;
use super::kernel::Kernel;
use super::lane::Lanes;
use crate::error::SimError;
use crate::fly::crossing;
use crate::integrate::{RUNAWAY_RAD_S, outside, samples};
use crate::truth::{End, Truth};
use nalgebra::Vector6;
use pulp::{Simd, WithSimd};
use std::f64::consts::TAU;
use windfall_model::TestSection;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum KeepSamples {
    Truth,
    States,
}

/// States that every flight has.
const STATES: usize = 13;
/// States, then R_x, R_y, R_z, V_W, α_T, airspeed and tether force.
const SEEN: usize = STATES + 7;
/// Lanes at most.
pub(super) const LANES_MAX: usize = 8;
/// Numbers seen at a sample, by channel and lane.
type Seen = [[f64; LANES_MAX]; SEEN];

/// Series of one flight; flown again their memory is used again.
#[derive(Debug, Default)]
pub(super) struct SampleSeries {
    pub(super) truth: Truth,
    pub(super) states: Vec<[f64; STATES]>,
}

/// One flight's results so far.
pub(super) struct LaneTrack<'a> {
    order: &'a Order<'a>,
    keep: KeepSamples,
    total: usize,
    pub(super) series: SampleSeries,
    /// Steps taken.
    pub(super) steps: u64,
    /// How the flight ended, once it has.
    pub(super) end: Option<Result<End, SimError>>,
}

impl<'a> LaneTrack<'a> {
    pub(super) fn new(order: &'a Order<'a>, keep: KeepSamples, mut series: SampleSeries) -> Self {
        let total = samples(order.flight);
        series.states.clear();
        series.truth.clear();
        match keep {
            KeepSamples::Truth => series.truth.reserve(total),
            KeepSamples::States => series.states.reserve(total),
        }
        Self { order, keep, total, series, steps: 0, end: None }
    }
    /// Samples so far.
    pub(super) fn count(&self) -> usize {
        match self.keep {
            KeepSamples::Truth => self.series.truth.len(),
            KeepSamples::States => self.series.states.len(),
        }
    }

    /// Takes a lane's sample, unless the flight has ended. `calm` is false where something is not finite or spins beyond reason.
    #[inline]
    fn take(&mut self, seen: &Seen, lane: usize, calm: bool) {
        if self.end.is_some() {
            return;
        }
        let left = |s: &TestSection| outside(s, row(seen, 0, lane));
        if !calm || self.order.flight.section.as_ref().is_some_and(left) {
            self.end = self.stop(seen, lane);
            if self.end.is_some() {
                return;
            }
        }
        match self.keep {
            KeepSamples::States => self.series.states.push(row(seen, 0, lane)),
            KeepSamples::Truth => self.push(seen, lane),
        }
        if self.count() == self.total {
            self.end = Some(Ok(End::Completed));
        }
    }

    #[inline(never)]
    fn stop(&self, seen: &Seen, lane: usize) -> Option<Result<End, SimError>> {
        let y: [f64; STATES] = row(seen, 0, lane);
        let t_s = self.count() as f64 / self.order.flight.rate_hz;
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
        let before = self.before()?;
        let now = Vector6::from_column_slice(&y[..6]);
        let dt = 1.0 / self.order.flight.rate_hz;
        Some(Ok(crossing(&section, t_s - dt, dt, &before, &now)))
    }

    /// Position and velocity at the sample before.
    fn before(&self) -> Option<Vector6<f64>> {
        match self.keep {
            KeepSamples::States => self.series.states.last().map(|y| Vector6::from_column_slice(&y[..6])),
            KeepSamples::Truth => {
                let (p, v) = (self.series.truth.p_tunnel_cm.last()?, self.series.truth.v_tunnel_cm.last()?);
                Some(Vector6::new(p[0], p[1], p[2], v[0], v[1], v[2]))
            }
        }
    }

    #[inline]
    fn push(&mut self, seen: &Seen, lane: usize) {
        let t_s = self.series.truth.len() as f64 / self.order.flight.rate_hz;
        let truth = &mut self.series.truth;
        truth.t_s.push(t_s);
        truth.p_tunnel_cm.push(row(seen, 0, lane));
        truth.v_tunnel_cm.push(row(seen, 3, lane));
        let q: [f64; 4] = row(seen, 6, lane);
        let per_norm = 1.0 / q.iter().map(|c| c * c).sum::<f64>().sqrt();
        truth.quaternion.push(q.map(|c| c * per_norm));
        truth.w_tunnel_body.push(row(seen, 10, lane));
        truth.attitude_rad.push(row(seen, 13, lane));
        truth.vw_m_s.push(seen[16][lane]);
        truth.alpha_t_rad.push(seen[17][lane]);
        truth.airspeed_m_s.push(seen[18][lane]);
        truth.tether_n.push(seen[19][lane]);
    }
}

/// `N` channels of one lane from `first` on.
#[inline]
fn row<const N: usize>(seen: &Seen, first: usize, lane: usize) -> [f64; N] {
    std::array::from_fn(|k| seen[first + k][lane % LANES_MAX])
}

/// The tracks of the lanes, and the roll angles of the sample before, from which the next are unwrapped.
pub(super) struct Tracks<'a, 't, S: Simd> {
    pub(super) lanes: &'t mut [LaneTrack<'a>],
    keep: KeepSamples,
    roll: Lanes<S>,
    seen: Seen,
}

impl<'a, 't, S: Simd> Tracks<'a, 't, S> {
    pub(super) fn new(simd: S, lanes: &'t mut [LaneTrack<'a>], keep: KeepSamples) -> Self {
        Self { lanes, keep, roll: Lanes::zero(simd), seen: [[0.0; LANES_MAX]; SEEN] }
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
        for (x, seen) in y.iter().zip(&mut self.seen[..STATES]) {
            x.store(&mut seen[..S::F64_LANES]);
        }
        let mut roll = self.roll;
        if self.keep == KeepSamples::Truth {
            let mut derived = [roll; 7];
            derive(Derived { simd, kernel, y, row, out: &mut derived });
            for (k, x) in derived.iter().enumerate() {
                x.store(&mut self.seen[STATES + k][..S::F64_LANES]);
            }
            roll = derived[0];
        }
        // Finite and below the limit when every state is finite and the spin is.
        let mut spin = y[10].mul_add(y[10], y[11].mul_add(y[11], y[12] * y[12]));
        for x in y {
            spin = x.mul_add(Lanes::zero(simd), spin);
        }
        let mut calm = [0.0; LANES_MAX];
        spin.store(&mut calm[..S::F64_LANES]);
        self.hand_out(&calm, &whose);
        // A lane that is not at a sample keeps its roll.
        let (mut kept, mut fresh) = ([0.0; LANES_MAX], [0.0; LANES_MAX]);
        self.roll.store(&mut kept[..S::F64_LANES]);
        roll.store(&mut fresh[..S::F64_LANES]);
        for lane in 0..S::F64_LANES {
            if whose(lane) {
                kept[lane] = fresh[lane];
            }
        }
        self.roll = Lanes::load(simd, &kept[..S::F64_LANES]);
    }

    #[inline(never)]
    fn hand_out(&mut self, spin2: &[f64; LANES_MAX], whose: &impl Fn(usize) -> bool) {
        for (lane, track) in self.lanes.iter_mut().enumerate() {
            if whose(lane) {
                track.take(&self.seen, lane, spin2[lane] <= RUNAWAY_RAD_S * RUNAWAY_RAD_S);
            }
        }
    }
}

/// R_x, R_y, R_z, V_W, α_T, airspeed and tether force, behind a call as rates are; the first of `out` is the roll of the sample before.
struct Derived<'a, S: Simd, const N: usize> {
    simd: S,
    kernel: &'a Kernel<'a, S>,
    y: &'a [Lanes<S>; N],
    row: &'a [f64],
    out: &'a mut [Lanes<S>; 7],
}

#[inline(never)]
fn derive<S: Simd, const N: usize>(derived: Derived<'_, S, N>) {
    derived.simd.vectorize(derived);
}

impl<S: Simd, const N: usize> WithSimd for Derived<'_, S, N> {
    type Output = ();
    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) {
        let Self { simd, kernel, y, row, out } = self;
        let s = kernel.sight(simd, y, row);
        let m = &s.m;
        let rx = (-m[1][2]).atan2(m[2][2]);
        let ry = m[0][2].atan2(m[0][0].mul_add(m[0][0], m[0][1] * m[0][1]).sqrt());
        let rz = (-m[0][1]).atan2(m[0][0]);
        let turns = (out[0] - rx).scale(1.0 / TAU).round();
        let cross2 = s.b[1].mul_add(s.b[1], s.b[2] * s.b[2]);
        let speed = s.b[0].mul_add(s.b[0], cross2).sqrt();
        let alpha_t = cross2.sqrt().atan2(s.b[0]);
        let q = kernel.pressure(&s);
        let tension = if kernel.parts.tether { kernel.tension(&s, y, q).0 } else { q.scale(0.0) };
        *out = [turns.scale(TAU) + rx, ry, rz, s.vw, alpha_t, speed, tension];
    }
}
