//! sim: the classical Runge-Kutta method of fourth order on lanes (Kutta 1901). In: a kernel, states at release, inputs. Out:
//! states at the sample times, shown to the tracks.

use super::inputs::{Channels, Inputs};
use super::kernel::Kernel;
use super::lane::Lanes;
use super::terms::ROOM;
use super::track::Tracks;
use pulp::Simd;

/// Steps whose inputs are tabulated at a time.
const BLOCK: usize = 32;

/// Sampling and stepping, the same for all lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepGrid {
    pub(super) rate_hz: f64,
    pub(super) steps_per_sample: usize,
}

impl StepGrid {
    /// Length of a step, s.
    pub(super) fn step_s(self) -> f64 {
        1.0 / (self.rate_hz * self.steps_per_sample as f64)
    }
}

/// Flies the lanes; there are inputs for each.
#[inline(always)]
pub(super) fn fly<S: Simd, const N: usize>(
    simd: S,
    kernel: &Kernel<'_, S>,
    inputs: &mut [Inputs<'_>],
    grid: StepGrid,
    mut y: [Lanes<S>; N],
    tracks: &mut Tracks<'_, '_, S>,
) {
    let channels = kernel.parts.channels;
    let width = channels.count() * S::F64_LANES;
    let mut table = vec![0.0; (2 * BLOCK + 1) * width];
    let mut slots = [Lanes::zero(simd); ROOM];
    let h = grid.step_s();
    let one_speed = inputs[1..].iter().all(|other| other.same_speed(&inputs[0]));
    // Ended by the tracks, which know how many samples there are.
    for n in 0.. {
        let place = n % BLOCK;
        if place == 0 {
            tabulate(inputs, one_speed, channels, n, grid, &mut table);
        }
        let row = |k: usize| &table[(2 * place + k) * width..(2 * place + k + 1) * width];
        if n % grid.steps_per_sample == 0 {
            tracks.observe(simd, kernel, &y, row(0), |_| true);
            if tracks.done() {
                return;
            }
        }
        // y ← y + h (k₁ + 2k₂ + 2k₃ + k₄)/6, the next stage's argument y + c h k beside it.
        let (mut argument, mut sum) = (y, y);
        for (input, ahead, weight) in [(0, 0.5, 1.0 / 6.0), (1, 0.5, 1.0 / 3.0), (1, 1.0, 1.0 / 3.0), (2, 0.0, 1.0 / 6.0)] {
            let k = kernel.rate(simd, &argument, row(input), &mut slots);
            let (ahead, weight) = (Lanes::splat(simd, ahead * h), Lanes::splat(simd, weight * h));
            for i in 0..N {
                argument[i] = ahead.mul_add(k[i], y[i]);
                sum[i] = weight.mul_add(k[i], sum[i]);
            }
        }
        y = sum;
        for track in tracks.lanes.iter_mut().filter(|track| track.end.is_none()) {
            track.steps += 1;
        }
    }
}

/// Inputs at the starts, middles and ends of the steps from `first` on.
#[inline(never)]
fn tabulate(inputs: &mut [Inputs<'_>], one_speed: bool, channels: Channels, first: usize, grid: StepGrid, table: &mut [f64]) {
    let lanes = inputs.len();
    let width = channels.count() * lanes;
    let half_step_s = 0.5 * grid.step_s();
    // From the number of half steps, the same whatever the block.
    let t_s = |k: usize| (2 * first + k) as f64 * half_step_s;
    for (lane, inputs) in inputs.iter_mut().enumerate() {
        for (k, row) in table.chunks_exact_mut(width).enumerate() {
            if one_speed && lane > 0 {
                row[lane] = row[0];
                row[lanes + lane] = row[lanes];
            } else {
                Channels::fill_speed(inputs, t_s(k), lane, lanes, row);
            }
        }
        if channels.count() > 2 {
            for (k, row) in table.chunks_exact_mut(width).enumerate() {
                channels.fill_rest(inputs, t_s(k), lane, lanes, row);
            }
        }
    }
}
