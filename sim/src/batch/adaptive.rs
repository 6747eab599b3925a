//! sim: methods of Runge-Kutta with steps of their own length on lanes, each lane with a time and a step of its own. In: a method, a kernel,
//! states at release, inputs, tolerances. Out: states at the sample times, shown to the tracks.
//!
//! A lane's steps follow from its own error alone; one that has ended stands still until the others have. First step, error and step
//! control are those of the single flight (Hairer, Nørsett & Wanner 1993, §II.4).

use super::inputs::{Channels, Inputs};
use super::kernel::Kernel;
use super::lane::Lanes;
use super::terms::ROOM;
use super::track::{LANES_MAX, Tracks};
use crate::error::SimError;
use crate::integrate::{BEYOND, budget};
use pulp::Simd;

/// Part of the time below which a step no longer moves it.
const UNDERFLOW: f64 = 1e-14;
/// Of the step that the error allows, this part is taken.
const SAFETY: f64 = 0.9;

/// How a method's error sets the next step.
pub(super) struct Control {
    /// Order of the method.
    pub(super) order: f64,
    /// Exponent of the error of the step before.
    pub(super) beta: f64,
    /// Least and largest change of a step.
    pub(super) shrink: f64,
    pub(super) grow: f64,
}

/// An embedded pair with dense output; it keeps the rates of the stages of the steps tried last.
pub(super) trait EmbeddedPair<S: Simd, const N: usize>: Sized {
    const CONTROL: Control;
    /// Coefficients of the polynomial through a step.
    type Dense: AsRef<[[Lanes<S>; N]]>;
    /// Before the first step.
    fn new(simd: S) -> Self;
    /// Tries the steps: the states at their ends.
    fn attempt(&mut self, simd: S, from: &StepStart<S, N>, rhs: &mut Rhs<'_, '_, S>) -> [Lanes<S>; N];
    /// Error of each lane's step over what it may be.
    fn errors(&self, simd: S, from: &StepStart<S, N>, end: &[Lanes<S>; N], tolerance: &Tolerance<S>) -> [f64; LANES_MAX];
    /// Rates at the ends of the steps; what was looked at last is still there.
    fn rate_at_end(&mut self, end: &[Lanes<S>; N], rhs: &mut Rhs<'_, '_, S>) -> [Lanes<S>; N];
    /// States within the steps, once the rates at their ends are known: with θ the part of the step and θ' = 1 − θ,
    /// `y + θ(c₀ + θ'(c₁ + θ(c₂ + θ'(…))))`.
    fn dense(&mut self, simd: S, from: &StepStart<S, N>, end: &[Lanes<S>; N], rhs: &mut Rhs<'_, '_, S>) -> Self::Dense;
}

/// Where each lane's step begins, and its length, s.
pub(super) struct StepStart<S: Simd, const N: usize> {
    t_s: [f64; LANES_MAX],
    h_s: [f64; LANES_MAX],
    pub(super) h: Lanes<S>,
    pub(super) y: [Lanes<S>; N],
    pub(super) rate: [Lanes<S>; N],
}

/// Relative and absolute tolerance of each lane.
pub(super) struct Tolerance<S: Simd> {
    relative: Lanes<S>,
    absolute: Lanes<S>,
}

impl<S: Simd> Tolerance<S> {
    /// Sum of squares of `x` over `atol + rtol·max(|a|, |b|)`.
    #[inline(always)]
    pub(super) fn sum<const N: usize>(&self, simd: S, x: &[Lanes<S>; N], a: &[Lanes<S>; N], b: &[Lanes<S>; N]) -> Lanes<S> {
        let mut sum = Lanes::zero(simd);
        for i in 0..N {
            let part = x[i] / self.relative.mul_add(a[i].abs().max(b[i].abs()), self.absolute);
            sum = part.mul_add(part, sum);
        }
        sum
    }
}

/// Rates at the lanes' own times.
pub(super) struct Rhs<'k, 'i, S: Simd> {
    simd: S,
    kernel: &'k Kernel<'k, S>,
    inputs: &'k mut [Inputs<'i>],
    row: Vec<f64>,
    slots: [Lanes<S>; ROOM],
}

impl<S: Simd> Rhs<'_, '_, S> {
    /// Reads the inputs of each lane at its own time.
    #[inline(always)]
    fn look(&mut self, t_s: &[f64; LANES_MAX]) {
        fill(self.kernel.parts.channels, self.inputs, t_s, S::F64_LANES, &mut self.row);
    }
    /// Reads the inputs at this part of the steps.
    #[inline(always)]
    pub(super) fn look_ahead<const N: usize>(&mut self, from: &StepStart<S, N>, part: f64) {
        self.look(&std::array::from_fn(|lane| from.t_s[lane] + part * from.h_s[lane]));
    }
    /// Rates of states at the time that was looked at.
    #[inline(always)]
    pub(super) fn rate<const N: usize>(&mut self, y: &[Lanes<S>; N]) -> [Lanes<S>; N] {
        self.kernel.rate_by_call(self.simd, y, &self.row, &mut self.slots)
    }
}

/// `y + h Σ a k` over the stages listed.
#[inline(always)]
pub(super) fn ahead<S: Simd, const N: usize, const K: usize>(
    simd: S,
    from: &StepStart<S, N>,
    k: &[[Lanes<S>; N]; K],
    weights: &[(usize, f64)],
) -> [Lanes<S>; N] {
    let mut out = from.y;
    for (i, y) in out.iter_mut().enumerate() {
        *y = from.h.mul_add(weighted(simd, k, weights, i), *y);
    }
    out
}

/// Component `i` of `Σ a k` over the stages listed.
#[inline(always)]
pub(super) fn weighted<S: Simd, const N: usize, const K: usize>(
    simd: S,
    k: &[[Lanes<S>; N]; K],
    weights: &[(usize, f64)],
    i: usize,
) -> Lanes<S> {
    let mut sum = Lanes::zero(simd);
    for &(stage, a) in weights {
        sum = k[stage % K][i].mul_add(Lanes::splat(simd, a), sum);
    }
    sum
}

/// What a lane asks for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wish {
    pub(super) relative_tolerance: f64,
    pub(super) absolute_tolerance: f64,
    /// Longest step that overlooks no input, s.
    pub(super) step_max_s: f64,
}

/// Where each lane is.
pub(super) struct Clock {
    rate_hz: f64,
    end_s: f64,
    control: Control,
    t_s: [f64; LANES_MAX],
    h_s: [f64; LANES_MAX],
    step_max_s: [f64; LANES_MAX],
    error_before: [f64; LANES_MAX],
    rejected: [bool; LANES_MAX],
    next: [usize; LANES_MAX],
    /// Steps tried, and how many may be.
    tried: [u32; LANES_MAX],
    budget: [u32; LANES_MAX],
}

/// Samples that some lanes have reached: when, at which share of the step, and whose.
struct Due {
    t_s: [f64; LANES_MAX],
    at: [f64; LANES_MAX],
    whose: [bool; LANES_MAX],
}

impl Clock {
    fn new(samples: usize, rate_hz: f64, control: Control, wishes: &[Wish]) -> Self {
        let end_s = ((samples - 1) as f64 + BEYOND) / rate_hz;
        let step_max_s = std::array::from_fn(|lane| wishes.get(lane).map_or(end_s, |w| w.step_max_s.min(end_s)));
        Self {
            rate_hz,
            end_s,
            control,
            t_s: [0.0; LANES_MAX],
            h_s: [0.0; LANES_MAX],
            step_max_s,
            error_before: [1e-4; LANES_MAX],
            rejected: [false; LANES_MAX],
            next: [1; LANES_MAX],
            tried: [0; LANES_MAX],
            budget: step_max_s.map(|h| budget(end_s, h)),
        }
    }
    /// The step within its limit, and so that the last one ends at the end.
    fn cap(&mut self, lane: usize) {
        let left = self.end_s - self.t_s[lane];
        let h = self.h_s[lane].min(self.step_max_s[lane]);
        self.h_s[lane] = if h * 1.01 > left { left } else { h };
    }
    /// The next step after one of this error; true when it is accepted.
    fn judge(&mut self, lane: usize, error: f64) -> bool {
        let c = &self.control;
        let power = error.powf(1.0 / c.order - 0.75 * c.beta);
        if error <= 1.0 {
            let most = if self.rejected[lane] { 1.0 } else { c.grow };
            let factor = SAFETY * self.error_before[lane].powf(c.beta) / power;
            self.h_s[lane] *= factor.clamp(c.shrink, most);
            self.error_before[lane] = error.max(1e-4);
            self.rejected[lane] = false;
            true
        } else {
            // A NaN comes here, too, and ends in an underflow that is reported.
            self.h_s[lane] *= (SAFETY / power).max(c.shrink);
            self.rejected[lane] = true;
            false
        }
    }
    /// Judges each lane's step: 1 where it is accepted. A lane whose step vanishes, or whose steps are used up, ends.
    fn accept<S: Simd>(&mut self, errors: &[f64; LANES_MAX], tracks: &mut Tracks<'_, '_, S>) -> [f64; LANES_MAX] {
        let mut accepted = [0.0; LANES_MAX];
        for (lane, track) in tracks.lanes.iter_mut().enumerate().filter(|(_, t)| t.end.is_none()) {
            let h_s = self.h_s[lane];
            self.tried[lane] += 1;
            if self.judge(lane, errors[lane]) {
                accepted[lane] = 1.0;
                track.steps += 1;
            } else if self.h_s[lane] <= UNDERFLOW * self.t_s[lane].max(1e-3) {
                track.end = Some(Err(SimError::StepTooSmall { t_s: self.t_s[lane] }));
            }
            if self.tried[lane] >= self.budget[lane] && track.end.is_none() {
                let (steps, t_s) = (self.tried[lane], self.t_s[lane]);
                // What changes is not looked at here; how fast follows from the step that it allows.
                track.end = Some(Err(SimError::TooManySteps { steps, t_s, what: "state", rate_per_s: 1.0 / h_s }));
            }
        }
        accepted
    }
    /// The next sample of each lane within its accepted step; none when no lane has one.
    fn due<S: Simd, const N: usize>(
        &mut self,
        from: &StepStart<S, N>,
        accepted: &[f64; LANES_MAX],
        tracks: &Tracks<'_, '_, S>,
    ) -> Option<Due> {
        let mut due = Due { t_s: from.t_s, at: [0.0; LANES_MAX], whose: [false; LANES_MAX] };
        for (lane, track) in tracks.lanes.iter().enumerate() {
            let (t, h) = (from.t_s[lane], from.h_s[lane]);
            let sample = self.next[lane] as f64 / self.rate_hz;
            if accepted[lane] > 0.0 && track.end.is_none() && sample <= t + h {
                due.whose[lane] = true;
                due.t_s[lane] = sample;
                due.at[lane] = (sample - t) / h;
                self.next[lane] += 1;
            }
        }
        due.whose.contains(&true).then_some(due)
    }
}

/// Flies the lanes; there are inputs and wishes for each.
#[inline(always)]
pub(super) fn fly<S: Simd, const N: usize, M: EmbeddedPair<S, N>>(
    simd: S,
    kernel: &Kernel<'_, S>,
    inputs: &mut [Inputs<'_>],
    wishes: &[Wish],
    (samples, rate_hz): (usize, f64),
    y: [Lanes<S>; N],
    tracks: &mut Tracks<'_, '_, S>,
) {
    let gather = |of: &dyn Fn(&Wish) -> f64| Lanes::load(simd, &wishes.iter().map(of).collect::<Vec<_>>());
    let tolerance = Tolerance { relative: gather(&|w| w.relative_tolerance), absolute: gather(&|w| w.absolute_tolerance) };
    let row = vec![0.0; kernel.parts.channels.count() * S::F64_LANES];
    let mut rhs = Rhs { simd, kernel, inputs, row, slots: [Lanes::zero(simd); ROOM] };
    let mut clock = Clock::new(samples, rate_hz, M::CONTROL, wishes);
    let mut method = M::new(simd);
    rhs.look(&clock.t_s);
    tracks.observe(simd, kernel, &y, &rhs.row, |_| true);
    let mut from = StepStart { t_s: clock.t_s, h_s: clock.h_s, h: Lanes::zero(simd), y, rate: rhs.rate(&y) };
    begin(simd, &mut from, &mut clock, &mut rhs, &tolerance);
    while !tracks.done() {
        (from.t_s, from.h_s) = (clock.t_s, clock.h_s);
        from.h = Lanes::load(simd, &from.h_s[..S::F64_LANES]);
        let end = method.attempt(simd, &from, &mut rhs);
        let errors = method.errors(simd, &from, &end, &tolerance);
        let rate = method.rate_at_end(&end, &mut rhs);
        let accepted = clock.accept(&errors, tracks);
        let mut due = clock.due(&from, &accepted, tracks);
        if due.is_some() {
            let dense = method.dense(simd, &from, &end, &mut rhs);
            while let Some(now) = due {
                rhs.look(&now.t_s);
                tracks.observe(simd, kernel, &within(simd, &from.y, dense.as_ref(), &now), &rhs.row, |lane| now.whose[lane]);
                due = clock.due(&from, &accepted, tracks);
            }
        }
        let mask = Lanes::load(simd, &accepted[..S::F64_LANES]);
        for i in 0..N {
            from.y[i] = mask.where_above(0.0, end[i], from.y[i]);
            from.rate[i] = mask.where_above(0.0, rate[i], from.rate[i]);
        }
        for (lane, track) in tracks.lanes.iter().enumerate() {
            clock.t_s[lane] += accepted[lane] * from.h_s[lane];
            if track.end.is_some() {
                clock.h_s[lane] = 0.0;
            } else {
                clock.cap(lane);
            }
        }
    }
}

/// The first step: an Euler step of a hundredth of the time in which the state would change by itself shows the second derivative; then as
/// long as a hundredth of the tolerance allows to the larger of the two.
#[inline(always)]
fn begin<S: Simd, const N: usize>(
    simd: S,
    from: &mut StepStart<S, N>,
    clock: &mut Clock,
    rhs: &mut Rhs<'_, '_, S>,
    tolerance: &Tolerance<S>,
) {
    let lanes = S::F64_LANES;
    let size = root(tolerance.sum(simd, &from.y, &from.y, &from.y));
    // Time is one of the single flight's states; its rate is 1.
    let time = tolerance.absolute.recip();
    let speed = root(time.mul_add(time, tolerance.sum(simd, &from.rate, &from.y, &from.y)));
    from.h_s = std::array::from_fn(|lane| (0.01 * size[lane] / speed[lane]).min(clock.step_max_s[lane]));
    from.h = Lanes::load(simd, &from.h_s[..lanes]);
    let mut moved = from.y;
    for (y, rate) in moved.iter_mut().zip(&from.rate) {
        *y = from.h.mul_add(*rate, *y);
    }
    rhs.look_ahead(from, 1.0);
    let mut turn = rhs.rate(&moved);
    for (b, rate) in turn.iter_mut().zip(&from.rate) {
        *b = *b - *rate;
    }
    let turn = root(tolerance.sum(simd, &turn, &from.y, &from.y));
    for lane in 0..lanes {
        let steepest = speed[lane].max(turn[lane] / from.h_s[lane]);
        clock.h_s[lane] = (100.0 * from.h_s[lane]).min((0.01 / steepest).powf(1.0 / clock.control.order));
        clock.cap(lane);
    }
}

/// Root of each lane.
#[inline(always)]
pub(super) fn root<S: Simd>(x: Lanes<S>) -> [f64; LANES_MAX] {
    let mut out = [1.0; LANES_MAX];
    x.sqrt().store(&mut out[..S::F64_LANES]);
    out
}

/// States at the samples that are due.
#[inline(always)]
fn within<S: Simd, const N: usize>(simd: S, y: &[Lanes<S>; N], dense: &[[Lanes<S>; N]], due: &Due) -> [Lanes<S>; N] {
    let theta = Lanes::load(simd, &due.at[..S::F64_LANES]);
    let rest = Lanes::splat(simd, 1.0) - theta;
    let mut out = *y;
    for (i, y) in out.iter_mut().enumerate() {
        let mut sum = Lanes::zero(simd);
        for (order, c) in dense.iter().enumerate().rev() {
            sum = if order % 2 == 0 { rest } else { theta }.mul_add(sum, c[i]);
        }
        *y = theta.mul_add(sum, *y);
    }
    out
}

/// Inputs of each lane at its own time.
#[inline(never)]
fn fill(channels: Channels, inputs: &mut [Inputs<'_>], t_s: &[f64; LANES_MAX], lanes: usize, row: &mut [f64]) {
    for (lane, inputs) in inputs.iter_mut().enumerate() {
        Channels::fill_speed(inputs, t_s[lane], lane, lanes, row);
        channels.fill_rest(inputs, t_s[lane], lane, lanes, row);
    }
}
