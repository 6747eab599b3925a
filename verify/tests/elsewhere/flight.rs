//! One run from release to end: true poses and speeds at the samples, and between them when an instrument is late.

use crate::algebra::{M, V, attitude, norm, product, rodrigues, scale, sub, times, transpose, turned};
use crate::motion::{STATES, State, World};

/// How a run is flown.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    pub(crate) hold_out: bool,
    pub(crate) duration: f64,
    pub(crate) rate_hz: f64,
    /// Place, Euler angles (rad), velocity, body rates at release.
    pub(crate) start: [V; 4],
    /// Length scale of the test section over the thesis', and the largest angle that the model may reach, rad.
    pub(crate) size: f64,
    pub(crate) steep: f64,
}

/// Truth at one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) t: f64,
    pub(crate) x: V,
    pub(crate) v: V,
    pub(crate) r: M,
    pub(crate) w: V,
    pub(crate) speed_w: f64,
    pub(crate) wind_rate: f64,
    pub(crate) angle: f64,
}

/// A flown run.
#[derive(Clone, Debug)]
pub(crate) struct Flown {
    /// Samples from `-lead` on.
    pub(crate) samples: Vec<Sample>,
    pub(crate) step: f64,
    pub(crate) lead: f64,
}

/// Limits of the test section, m, and the largest angle, rad, that a model may reach.
const WIDE: f64 = 1.4;
const HIGH: f64 = 1.3;
pub(crate) const STEEP: f64 = 0.75;

/// Flies; `None` when it leaves the section, tumbles or is not a number. `lead` seconds are flown before the record begins.
pub(crate) fn fly(world: &World<'_>, plan: &Plan, lead: f64) -> Option<Flown> {
    flown(world, plan, lead, |s| inside(s, plan))
}

/// The same wherever it leads, short of tumbling: for a model that follows a record.
pub(crate) fn follow(world: &World<'_>, plan: &Plan) -> Option<Flown> {
    flown(world, plan, 0.0, |s| s.angle < 1.3)
}

fn flown(world: &World<'_>, plan: &Plan, lead: f64, allowed: impl Fn(&Sample) -> bool) -> Option<Flown> {
    let h = 1.0 / plan.rate_hz;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive durations")]
    let (before, count) = ((lead / h).ceil() as usize, (plan.duration / h).round() as usize + 1);
    let [x, angles, v, w] = plan.start;
    let mut base = attitude(angles);
    let hand = match &world.drive {
        crate::motion::Drive::Hand(hand) => hand.start(x[0]),
        crate::motion::Drive::Given(track) => [track.at(0.0), 0.0, 0.0],
    };
    let mut y = world.state(x, &base, v, w, hand);
    let mut samples = Vec::with_capacity(before + count);
    for k in 0..before + count {
        let t = (k as f64 - before as f64) * h;
        let sample = look(world, t, &y, &base);
        if !allowed(&sample) {
            return None;
        }
        samples.push(sample);
        y = world.step(t, &y, &base, h);
        if y.iter().any(|v| !v.is_finite()) {
            return None;
        }
        base = product(&base, &turned([y[3], y[4], y[5]]));
        y[3..6].fill(0.0);
    }
    Some(Flown { samples, step: h, lead: before as f64 * h })
}

pub(crate) fn look(world: &World<'_>, t: f64, y: &[f64; STATES], base: &M) -> Sample {
    let (i, _) = world.instant(t, y, base);
    let angle = i.u[1].hypot(i.u[2]).atan2(i.u[0]);
    Sample { t, x: i.x, v: i.v, r: i.r, w: i.w, speed_w: i.speed_w, wind_rate: wind_rate(world, t, y), angle }
}

fn wind_rate(world: &World<'_>, t: f64, y: &State) -> f64 {
    match &world.drive {
        crate::motion::Drive::Hand(_) => y[13],
        crate::motion::Drive::Given(track) => (track.at(t + 1e-4) - track.at(t - 1e-4)) / 2e-4,
    }
}

fn inside(s: &Sample, plan: &Plan) -> bool {
    s.x[0].abs() < plan.size * HIGH && s.x[1].hypot(s.x[2]) < plan.size * WIDE && s.angle < plan.steep
}

impl Flown {
    /// Number of samples of the record.
    pub(crate) fn len(&self) -> usize {
        self.samples.len() - self.first()
    }
    fn first(&self) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive count")]
        let first = (self.lead / self.step).round() as usize;
        first
    }
    /// Sample `k` of the record.
    pub(crate) fn sample(&self, k: usize) -> &Sample {
        &self.samples[self.first() + k]
    }
    /// Place, attitude and tunnel speed that long before sample `k`, by cubic polynomials between samples; a negative delay is
    /// not asked for.
    pub(crate) fn before(&self, k: usize, delay: f64) -> (V, M, f64) {
        if delay < 1e-12 {
            let s = self.sample(k);
            return (s.x, s.r, s.speed_w);
        }
        let place = ((self.first() + k) as f64 - delay / self.step).max(0.0);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the samples")]
        let i = (place as usize).min(self.samples.len() - 2);
        let (a, b, z, h) = (&self.samples[i], &self.samples[i + 1], place - i as f64, self.step);
        let cubic = |y: [f64; 2], rate: [f64; 2]| {
            let (d, m0, m1) = (y[1] - y[0], rate[0] * h, rate[1] * h);
            y[0] + z * (m0 + z * (3.0 * d - 2.0 * m0 - m1 + z * (m0 + m1 - 2.0 * d)))
        };
        let x = std::array::from_fn(|j| cubic([a.x[j], b.x[j]], [a.v[j], b.v[j]]));
        // The turn from a to b in Rodrigues parameters; their rates are a quarter of the body rates to second order.
        let turn = rodrigues(&product(&transpose(&a.r), &b.r));
        let end = crate::algebra::turning(turn, b.w);
        let s = std::array::from_fn(|j| cubic([0.0, turn[j]], [0.25 * a.w[j], end[j]]));
        (x, product(&a.r, &turned(s)), cubic([a.speed_w, b.speed_w], [a.wind_rate, b.wind_rate]))
    }
}

/// Start of a run released at an angle: tilted by `tilt` in direction `clock`, rolled, with small rates; place and speed near rest. Lengths
/// and times are those of a model of a `size` of the thesis'.
pub(crate) fn released(c: &mut crate::chance::Chance, tilt: f64, still: f64, size: f64) -> [V; 4] {
    let clock = c.phase();
    let roll = c.phase() - std::f64::consts::PI;
    let x = [c.uniform(-0.12, 0.12), c.uniform(-0.25, 0.25), c.uniform(-0.25, 0.25)];
    let v = scale([c.normal(), c.normal(), c.normal()], 0.015);
    let w = [c.uniform(-0.4, 0.4), still * c.normal(), still * c.normal()];
    [scale(x, size), [roll, tilt * clock.cos(), tilt * clock.sin()], scale(v, size.sqrt()), scale(w, 1.0 / size.sqrt())]
}

/// Largest distance of two attitudes and places, for comparisons.
pub(crate) fn apart(a: (V, &M), b: (V, &M)) -> (f64, f64) {
    let turn = rodrigues(&product(&transpose(a.1), b.1));
    (norm(sub(a.0, b.0)), 4.0 * norm(turn))
}

/// Position of the geometric origin.
pub(crate) fn origin(x: V, r: &M, cm: V) -> V {
    sub(x, times(r, cm))
}
