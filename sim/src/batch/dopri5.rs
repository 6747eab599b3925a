//! sim: the method of Dormand and Prince, 5(4) with dense output (Dormand & Prince 1980; Hairer, Nørsett & Wanner 1993, §II.4-6),
//! on lanes, each with a time and a step of its own. In: a kernel, states at release, inputs, tolerances. Out: states at the
//! sample times, shown to the tracks.
//!
//! A lane's steps follow from its own error alone; one that has ended stands still until the others have.

use super::inputs::{Channels, Inputs};
use super::kernel::Kernel;
use super::lane::Lanes;
use super::terms::ROOM;
use super::track::{LANES_MAX, Tracks};
use crate::error::SimError;
use crate::integrate::budget;
use pulp::Simd;

const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
/// Fifth order less fourth.
const E: [f64; 7] = [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];
/// Fifth coefficient of the dense output.
const D: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];
/// Step control as in the single flight: safety, exponent of the error before, limits of a change.
const SAFETY: f64 = 0.9;
const BETA: f64 = 0.04;
const SHRINK: f64 = 0.2;
const GROW: f64 = 10.0;
/// Part of the time below which a step no longer moves it.
const UNDERFLOW: f64 = 1e-14;

/// What a lane asks for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wish {
    pub(super) relative_tolerance: f64,
    pub(super) absolute_tolerance: f64,
    /// Longest step that overlooks no input, s.
    pub(super) step_max_s: f64,
}

/// Where each lane is.
struct Clock {
    rate_hz: f64,
    samples: usize,
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
    fn new(samples: usize, rate_hz: f64) -> Self {
        Self {
            rate_hz,
            samples,
            t_s: [0.0; LANES_MAX],
            h_s: [0.0; LANES_MAX],
            step_max_s: [0.0; LANES_MAX],
            error_before: [1e-4; LANES_MAX],
            rejected: [false; LANES_MAX],
            next: [1; LANES_MAX],
            tried: [0; LANES_MAX],
            budget: [0; LANES_MAX],
        }
    }
    fn sample_s(&self, lane: usize) -> f64 {
        self.next[lane] as f64 / self.rate_hz
    }
    /// The step, so that the last one ends on the last sample.
    fn cap(&mut self, lane: usize) {
        let left = (self.samples - 1) as f64 / self.rate_hz - self.t_s[lane];
        let h = self.h_s[lane].min(self.step_max_s[lane]);
        self.h_s[lane] = if h * 1.01 >= left { left } else { h };
    }
    /// The next step after one of this error; true when it is accepted.
    fn judge(&mut self, lane: usize, error: f64) -> bool {
        let power = error.powf(0.2 - 0.75 * BETA);
        if error <= 1.0 {
            let most = if self.rejected[lane] { 1.0 } else { GROW };
            let factor = SAFETY * self.error_before[lane].powf(BETA) / power;
            self.h_s[lane] *= factor.clamp(SHRINK, most);
            self.error_before[lane] = error.max(1e-4);
            self.rejected[lane] = false;
            true
        } else {
            // A NaN comes here, too, and ends in an underflow that is reported.
            self.h_s[lane] *= (SAFETY / power).max(SHRINK);
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
    fn due<S: Simd>(&mut self, taken: &Taken, tracks: &Tracks<'_, '_, S>) -> Option<Due> {
        let mut due = Due { t_s: self.t_s, at: [0.0; LANES_MAX], whose: [false; LANES_MAX] };
        for (lane, track) in tracks.lanes.iter().enumerate() {
            let (t, h) = (self.t_s[lane], taken.h_s[lane]);
            let sample = self.sample_s(lane);
            // The step that was cut to end on the last sample ends there, whatever the rounding.
            let last = self.next[lane] + 1 == self.samples && sample - (t + h) < 1e-9 * h;
            if taken.accepted[lane] > 0.0 && track.end.is_none() && (sample <= t + h || last) {
                due.whose[lane] = true;
                due.t_s[lane] = sample;
                due.at[lane] = ((sample - t) / h).min(1.0);
                self.next[lane] += 1;
            }
        }
        due.whose.contains(&true).then_some(due)
    }
}

/// Lanes between two steps, and the room that a step needs.
struct Steps<S: Simd, const N: usize> {
    clock: Clock,
    rtol: Lanes<S>,
    atol: Lanes<S>,
    y: [Lanes<S>; N],
    /// Rates of the stages, and the state of the latest.
    k: [[Lanes<S>; N]; 7],
    argument: [Lanes<S>; N],
    row: Vec<f64>,
    slots: [Lanes<S>; ROOM],
}

/// The step of each lane, s, and 1 where it was accepted.
struct Taken {
    h_s: [f64; LANES_MAX],
    accepted: [f64; LANES_MAX],
}

/// Flies the lanes; there are inputs and wishes for each.
#[inline(always)]
pub(super) fn fly<S: Simd, const N: usize>(
    simd: S,
    kernel: &Kernel<'_, S>,
    inputs: &mut [Inputs<'_>],
    wishes: &[Wish],
    (samples, rate_hz): (usize, f64),
    y: [Lanes<S>; N],
    tracks: &mut Tracks<'_, '_, S>,
) {
    let channels = kernel.parts.channels;
    let gather = |of: &dyn Fn(&Wish) -> f64| Lanes::load(simd, &wishes.iter().map(of).collect::<Vec<_>>());
    let mut steps = Steps {
        clock: Clock::new(samples, rate_hz),
        rtol: gather(&|w| w.relative_tolerance),
        atol: gather(&|w| w.absolute_tolerance),
        y,
        k: [[Lanes::zero(simd); N]; 7],
        argument: y,
        row: vec![0.0; channels.count() * S::F64_LANES],
        slots: [Lanes::zero(simd); ROOM],
    };
    fill(channels, inputs, &steps.clock.t_s, S::F64_LANES, &mut steps.row);
    tracks.observe(simd, kernel, &y, &steps.row, |_| true);
    steps.stage(simd, kernel, inputs, 0);
    steps.begin(simd, wishes, tracks);
    while !tracks.done() {
        for stage in 1..7 {
            steps.stage(simd, kernel, inputs, stage);
        }
        let errors = steps.errors(simd);
        let h_s = steps.clock.h_s;
        let taken = Taken { h_s, accepted: steps.clock.accept(&errors, tracks) };
        steps.show(simd, kernel, inputs, &taken, tracks);
        steps.advance(simd, &taken, tracks);
    }
}

impl<S: Simd, const N: usize> Steps<S, N> {
    /// Rate at a stage; the stages before it are done.
    #[inline(always)]
    fn stage(&mut self, simd: S, kernel: &Kernel<'_, S>, inputs: &mut [Inputs<'_>], stage: usize) {
        let lanes = S::F64_LANES;
        let h = Lanes::load(simd, &self.clock.h_s[..lanes]);
        let mut times = [0.0; LANES_MAX];
        for (lane, t) in times.iter_mut().enumerate().take(lanes) {
            *t = self.clock.t_s[lane] + C[stage] * self.clock.h_s[lane];
        }
        // The last two stages are at the same time.
        if stage < 6 {
            fill(kernel.parts.channels, inputs, &times, lanes, &mut self.row);
        }
        for i in 0..N {
            let mut sum = Lanes::zero(simd);
            for (k, a) in self.k[..stage].iter().zip(&A[stage]) {
                sum = k[i].mul_add(Lanes::splat(simd, *a), sum);
            }
            self.argument[i] = h.mul_add(sum, self.y[i]);
        }
        self.k[stage] = kernel.rate(simd, &self.argument, &self.row, &mut self.slots);
    }

    /// The first step: a hundredth of the time in which the state would change by itself.
    #[inline(always)]
    fn begin(&mut self, simd: S, wishes: &[Wish], tracks: &Tracks<'_, '_, S>) {
        let of = |x| scaled(simd, x, &self.y, &self.y, self.rtol, self.atol);
        let (size, speed) = (of(&self.y), of(&self.k[0]));
        let clock = &mut self.clock;
        for (lane, track) in tracks.lanes.iter().enumerate() {
            clock.h_s[lane] = if track.end.is_some() { 0.0 } else { 0.01 * size[lane] / speed[lane].max(1e-10) };
            clock.step_max_s[lane] = wishes[lane].step_max_s;
            let end_s = (clock.samples - 1) as f64 / clock.rate_hz;
            clock.budget[lane] = budget(end_s, wishes[lane].step_max_s.min(end_s));
            clock.cap(lane);
        }
    }

    /// Error of each lane's step over what it may be.
    #[inline(always)]
    fn errors(&self, simd: S) -> [f64; LANES_MAX] {
        let h = Lanes::load(simd, &self.clock.h_s[..S::F64_LANES]);
        let mut error = self.k[0];
        for (i, e) in error.iter_mut().enumerate() {
            let mut sum = Lanes::zero(simd);
            for (k, weight) in self.k.iter().zip(&E) {
                sum = k[i].mul_add(Lanes::splat(simd, *weight), sum);
            }
            *e = h * sum;
        }
        scaled(simd, &error, &self.y, &self.argument, self.rtol, self.atol)
    }

    /// Shows the samples that the accepted steps have passed.
    #[inline(always)]
    fn show(
        &mut self,
        simd: S,
        kernel: &Kernel<'_, S>,
        inputs: &mut [Inputs<'_>],
        taken: &Taken,
        tracks: &mut Tracks<'_, '_, S>,
    ) {
        let lanes = S::F64_LANES;
        let mut dense = None;
        while let Some(due) = self.clock.due(taken, tracks) {
            let h = Lanes::load(simd, &taken.h_s[..lanes]);
            let dense: &[[Lanes<S>; N]; 4] = dense.get_or_insert_with(
                #[inline(always)]
                || extension(simd, h, &self.k, &self.y, &self.argument),
            );
            let theta = Lanes::load(simd, &due.at[..lanes]);
            let rest = Lanes::splat(simd, 1.0) - theta;
            let mut seen = self.y;
            for i in 0..N {
                let inner = rest.mul_add(dense[3][i], dense[2][i]);
                let middle = theta.mul_add(inner, dense[1][i]);
                seen[i] = theta.mul_add(rest.mul_add(middle, dense[0][i]), self.y[i]);
            }
            fill(kernel.parts.channels, inputs, &due.t_s, lanes, &mut self.row);
            tracks.observe(simd, kernel, &seen, &self.row, |lane| due.whose[lane]);
        }
    }

    /// Moves the lanes whose step was accepted to its end.
    #[inline(always)]
    fn advance(&mut self, simd: S, taken: &Taken, tracks: &Tracks<'_, '_, S>) {
        let mask = Lanes::load(simd, &taken.accepted[..S::F64_LANES]);
        for i in 0..N {
            self.y[i] = mask.where_above(0.0, self.argument[i], self.y[i]);
            self.k[0][i] = mask.where_above(0.0, self.k[6][i], self.k[0][i]);
        }
        for (lane, track) in tracks.lanes.iter().enumerate() {
            self.clock.t_s[lane] += taken.accepted[lane] * taken.h_s[lane];
            if track.end.is_some() {
                self.clock.h_s[lane] = 0.0;
            } else {
                self.clock.cap(lane);
            }
        }
    }
}

/// Second to fifth coefficient of the dense output.
#[inline(always)]
fn extension<S: Simd, const N: usize>(
    simd: S,
    h: Lanes<S>,
    k: &[[Lanes<S>; N]; 7],
    y: &[Lanes<S>; N],
    end: &[Lanes<S>; N],
) -> [[Lanes<S>; N]; 4] {
    let mut out = [*y; 4];
    for i in 0..N {
        let rise = end[i] - y[i];
        let bend = h * k[0][i] - rise;
        let mut sum = Lanes::zero(simd);
        for stage in 0..7 {
            sum = k[stage][i].mul_add(Lanes::splat(simd, D[stage]), sum);
        }
        out[0][i] = rise;
        out[1][i] = bend;
        out[2][i] = rise - h * k[6][i] - bend;
        out[3][i] = h * sum;
    }
    out
}

/// Root mean square of `x` over `atol + rtol·max(|a|, |b|)`, by lane.
#[inline(always)]
fn scaled<S: Simd, const N: usize>(
    simd: S,
    x: &[Lanes<S>; N],
    a: &[Lanes<S>; N],
    b: &[Lanes<S>; N],
    rtol: Lanes<S>,
    atol: Lanes<S>,
) -> [f64; LANES_MAX] {
    let mut sum = Lanes::zero(simd);
    for i in 0..N {
        let part = x[i] / rtol.mul_add(a[i].abs().max(b[i].abs()), atol);
        sum = part.mul_add(part, sum);
    }
    let mut out = [0.0; LANES_MAX];
    sum.scale(1.0 / N as f64).sqrt().store(&mut out[..S::F64_LANES]);
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
