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

impl Clock {
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
}

/// Flies the lanes; there are inputs and wishes for each.
#[inline(always)]
pub(super) fn fly<S: Simd, const N: usize>(
    simd: S,
    kernel: &Kernel<'_, S>,
    inputs: &mut [Inputs<'_>],
    wishes: &[Wish],
    (samples, rate_hz): (usize, f64),
    mut y: [Lanes<S>; N],
    tracks: &mut Tracks<'_, '_, S>,
) {
    let channels = kernel.parts.channels;
    let lanes = S::F64_LANES;
    let used = tracks.lanes.len();
    let mut row = vec![0.0; channels.count() * lanes];
    let mut slots = [Lanes::zero(simd); ROOM];
    let gather = |of: &dyn Fn(&Wish) -> f64| Lanes::load(simd, &wishes.iter().map(of).collect::<Vec<_>>());
    let (rtol, atol) = (gather(&|w| w.relative_tolerance), gather(&|w| w.absolute_tolerance));
    let mut clock = Clock {
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
    };
    let mut k = [[Lanes::zero(simd); N]; 7];
    let mut argument = y;
    let mut first_stage = 0;
    fill(channels, inputs, &clock.t_s, lanes, &mut row);
    tracks.observe(simd, kernel, &y, &row, |_| true);
    while !tracks.done() {
        let h = Lanes::load(simd, &clock.h_s[..lanes]);
        for stage in first_stage..7 {
            let mut times = [0.0; LANES_MAX];
            for (lane, t) in times.iter_mut().enumerate().take(lanes) {
                *t = clock.t_s[lane] + C[stage] * clock.h_s[lane];
            }
            // The last two stages are at the same time.
            if stage < 6 {
                fill(channels, inputs, &times, lanes, &mut row);
            }
            for i in 0..N {
                let mut sum = Lanes::zero(simd);
                for j in 0..stage {
                    sum = k[j][i].mul_add(Lanes::splat(simd, A[stage][j]), sum);
                }
                argument[i] = h.mul_add(sum, y[i]);
            }
            k[stage] = kernel.rate(simd, &argument, &row, &mut slots);
            if first_stage == 0 {
                break;
            }
        }
        if first_stage == 0 {
            // The first step: a hundredth of the time in which the state would change by itself.
            let (size, speed) = (scaled(simd, &y, &y, &y, rtol, atol), scaled(simd, &k[0], &y, &y, rtol, atol));
            for lane in 0..used {
                clock.h_s[lane] = if tracks.lanes[lane].end.is_some() { 0.0 } else { 0.01 * size[lane] / speed[lane].max(1e-10) };
                clock.step_max_s[lane] = wishes[lane].step_max_s;
                let end_s = (samples - 1) as f64 / rate_hz;
                clock.budget[lane] = budget(end_s, wishes[lane].step_max_s.min(end_s));
                clock.cap(lane);
            }
            first_stage = 1;
            continue;
        }
        let mut error = k[0];
        for (i, e) in error.iter_mut().enumerate() {
            let mut sum = Lanes::zero(simd);
            for stage in 0..7 {
                sum = k[stage][i].mul_add(Lanes::splat(simd, E[stage]), sum);
            }
            *e = h * sum;
        }
        let errors = scaled(simd, &error, &y, &argument, rtol, atol);
        let taken = clock.h_s;
        let mut accepted = [0.0; LANES_MAX];
        for lane in 0..used {
            let track = &mut tracks.lanes[lane];
            if track.end.is_none() {
                let h_s = clock.h_s[lane];
                clock.tried[lane] += 1;
                if clock.judge(lane, errors[lane]) {
                    accepted[lane] = 1.0;
                    track.steps += 1;
                } else if clock.h_s[lane] <= UNDERFLOW * clock.t_s[lane].max(1e-3) {
                    track.end = Some(Err(SimError::StepTooSmall { t_s: clock.t_s[lane] }));
                }
                if clock.tried[lane] >= clock.budget[lane] && track.end.is_none() {
                    let (steps, t_s) = (clock.tried[lane], clock.t_s[lane]);
                    // What changes is not looked at here; how fast follows from the step that it allows.
                    track.end = Some(Err(SimError::TooManySteps { steps, t_s, what: "state", rate_per_s: 1.0 / h_s }));
                }
            }
        }
        // Samples that the accepted steps have passed.
        let mut dense = None;
        loop {
            let mut at = [0.0; LANES_MAX];
            let mut times = clock.t_s;
            let mut whose = [false; LANES_MAX];
            for lane in 0..used {
                let (t, h) = (clock.t_s[lane], taken[lane]);
                let sample = clock.sample_s(lane);
                // The step that was cut to end on the last sample ends there, whatever the rounding.
                let last = clock.next[lane] + 1 == samples && sample - (t + h) < 1e-9 * h;
                if accepted[lane] > 0.0 && tracks.lanes[lane].end.is_none() && (sample <= t + h || last) {
                    whose[lane] = true;
                    times[lane] = sample;
                    at[lane] = ((sample - t) / h).min(1.0);
                    clock.next[lane] += 1;
                }
            }
            if !whose.contains(&true) {
                break;
            }
            let dense: &[[Lanes<S>; N]; 4] = dense.get_or_insert_with(
                #[inline(always)]
                || extension(simd, h, &k, &y, &argument),
            );
            let theta = Lanes::load(simd, &at[..lanes]);
            let rest = Lanes::splat(simd, 1.0) - theta;
            let mut seen = y;
            for i in 0..N {
                let inner = rest.mul_add(dense[3][i], dense[2][i]);
                let middle = theta.mul_add(inner, dense[1][i]);
                seen[i] = theta.mul_add(rest.mul_add(middle, dense[0][i]), y[i]);
            }
            fill(channels, inputs, &times, lanes, &mut row);
            tracks.observe(simd, kernel, &seen, &row, |lane| whose[lane]);
        }
        let mask = Lanes::load(simd, &accepted[..lanes]);
        for i in 0..N {
            y[i] = mask.where_above(0.0, argument[i], y[i]);
            k[0][i] = mask.where_above(0.0, k[6][i], k[0][i]);
        }
        for lane in 0..used {
            clock.t_s[lane] += accepted[lane] * taken[lane];
            if tracks.lanes[lane].end.is_some() {
                clock.h_s[lane] = 0.0;
            } else {
                clock.cap(lane);
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
