//! pid: a piece of flight and what it depends on. In: state and inputs at its first sample, parameters. Out: states at its samples,
//! with their derivatives by the variational equations.
//!
//! Fourth-order Runge-Kutta with one step a sample (several, where samples are far apart: [`splits`]), for the state and for its derivatives, whose matrix is taken at both ends and in the
//! middle of a step (there on the cubic through the ends; Hairer, Norsett and Wanner 1993, II.6): an end is the next step's start, so that
//! two linearisations a step do. They are the derivatives of the discrete map to the order of the method, not to rounding. The pitch
//! mode (1 Hz) at 150 Hz turns by 0.04 rad a step: its phase errs by 2e-8 of a turn.

use super::{Craft, Dual, Extra, STATES, Scalar, TunnelAir};
use pulp::{Arch, Simd, WithSimd};
use windfall_model::Record;

/// Inputs at one instant: tunnel speed and its rate, gust velocity and its rate.
pub(crate) const INPUTS: usize = 8;
/// Directions of differentiation at a time: the state's, then air velocity, its rate and the coefficients. Two passes of twelve are
/// half as long as one of twenty-four, whose numbers are too large to be copied without a call.
const LANES: usize = STATES;

/// How inputs follow from their own states `s` between two nodes: `inputs(τ) = M(τ) s`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drive {
    /// Number of input states.
    pub(crate) states: usize,
    /// Parts of a sample interval that are integrated one by one: more than one where samples are too far apart for one step.
    pub(crate) splits: usize,
    /// M at every half part of a piece, row-major, [`INPUTS`] rows.
    pub(crate) at: Vec<Vec<f64>>,
}

/// Longest step over the samples of a record that was thinned to its bandwidth, s: a fiftieth of the pitch mode's period, in which the error of
/// the Runge-Kutta method is 2e-6 of its frequency.
const LONGEST_STEP_S: f64 = 0.02;

/// Parts of a sample interval of a record that are integrated one by one.
pub(crate) fn splits(record: &Record) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    let parts = (record.interval_s() / LONGEST_STEP_S - 1e-6).ceil() as usize;
    if record.bandwidth.is_empty() { 1 } else { parts.max(1) }
}

impl Drive {
    #[inline(always)]
    fn inputs(&self, half_steps: usize, s: &[f64]) -> [f64; INPUTS] {
        let m = &self.at[half_steps];
        let mut inputs = [0.0; INPUTS];
        for (input, row) in inputs.iter_mut().zip(m.chunks_exact(self.states)) {
            *input = row.iter().zip(s).map(|(a, b)| a * b).sum();
        }
        inputs
    }
}

/// A piece of flight to integrate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<'a> {
    pub(crate) craft: &'a Craft<'a>,
    pub(crate) drive: &'a Drive,
    /// All parameters of the structure.
    pub(crate) parameters: &'a [f64],
    /// Column of each of them among the free ones; none where held.
    pub(crate) columns: &'a [Option<usize>],
    /// Number of free ones.
    pub(crate) free: usize,
    /// Time of the first sample from the run's first, s.
    pub(crate) start_s: f64,
    pub(crate) interval_s: f64,
    /// Density at the samples from the first on, kg/m³.
    pub(crate) density: &'a [f64],
    /// Number of steps.
    pub(crate) steps: usize,
    /// Standard deviation of the part of the gust's velocity that is not known, tunnel axes, m/s: rates are means over it, so that
    /// what is not linear in the flow angles (a damping that grows with their square) acts as it does on average. Zeros: none.
    pub(crate) spread_m_s: [f64; 3],
}

/// States after each step, and their derivatives by (state, input states, free parameters), row-major.
#[derive(Clone, Debug, Default)]
pub(crate) struct Transition {
    pub(crate) states: Vec<[f64; STATES]>,
    pub(crate) slopes: Vec<Vec<f64>>,
    /// Slopes of the first rate by the inputs.
    pub(crate) first_input: [[f64; INPUTS]; STATES],
    work: Work,
}

#[derive(Clone, Debug, Default)]
struct Work {
    slopes: Vec<f64>,
    at: Vec<f64>,
    sum: Vec<f64>,
    stage: Vec<f64>,
    terms: Vec<f64>,
    /// Mean of the terms over what the gust may be.
    mean: Vec<f64>,
    /// Start, middle and end of a step.
    instants: [Instant; 3],
}

/// Rate at one instant and its derivatives.
#[derive(Clone, Copy, Debug, Default)]
struct Linear {
    rate: [f64; STATES],
    by_state: [[f64; STATES]; STATES],
    by_input: [[f64; INPUTS]; STATES],
    by_coefficient: [[f64; 6]; STATES],
}

/// What the variational equations need of one instant.
#[derive(Clone, Debug, Default)]
struct Instant {
    linear: Linear,
    /// Slopes of the rates of velocities and body rates by input states and parameters, row-major.
    forcing: Vec<f64>,
}

/// States whose rates are velocities and body rates: no input or parameter acts on them at once.
const KINEMATIC: usize = 6;
/// Rows of the working matrices are filled up to a multiple of this, so that no loop over one ends in single numbers.
const UNIT: usize = 4;

impl Segment<'_> {
    /// Columns of the derivatives.
    pub(crate) fn width(&self) -> usize {
        STATES + self.drive.states + self.free
    }

    /// Density at the start of a part of a step or at the next one's; linear between samples.
    fn density_at(&self, part: usize, on: usize) -> f64 {
        let (splits, last) = (self.drive.splits, self.density.len() - 1);
        let (step, left) = ((part + on) / splits, (part + on) % splits);
        let from = self.density[step.min(last)];
        if left == 0 { from } else { from + left as f64 / splits as f64 * (self.density[(step + 1).min(last)] - from) }
    }

    /// Length of a part, s.
    fn part_s(&self) -> f64 {
        self.interval_s / self.drive.splits as f64
    }

    fn air(&self, step: usize, half: usize, inputs: &[f64; INPUTS]) -> TunnelAir {
        TunnelAir {
            t_s: self.start_s + (step as f64 + 0.5 * half as f64) * self.part_s(),
            density_kg_m3: 0.5 * (self.density_at(step, half / 2) + self.density_at(step, half.div_ceil(2))),
            vw_m_s: inputs[0],
            vw_rate_m_s2: inputs[1],
        }
    }

    /// States after each step; false where the flight cannot go on.
    pub(crate) fn fly(&self, x: [f64; STATES], s: &[f64], out: &mut Transition) -> bool {
        Arch::new().dispatch(Widest { segment: self, x, s, out, slopes: false })
    }

    /// States after each step with their derivatives; false where the flight cannot go on.
    pub(crate) fn differentiate(&self, x: [f64; STATES], s: &[f64], out: &mut Transition) -> bool {
        Arch::new().dispatch(Widest { segment: self, x, s, out, slopes: true })
    }

    #[inline(always)]
    fn states_alone(&self, x: [f64; STATES], s: &[f64], out: &mut Transition) -> bool {
        out.states.clear();
        let terms = &mut out.work.terms;
        terms.resize(self.craft.terms.acts.len(), 0.0);
        let mut x = x;
        for part in 0..self.steps * self.drive.splits {
            let Some(first) = self.rate(&x, (part, 0), self.drive.inputs(2 * part, s), terms) else { return false };
            let Some(next) = self.step(&x, part, s, first, terms) else { return false };
            x = next;
            if (part + 1).is_multiple_of(self.drive.splits) {
                out.states.push(x);
            }
        }
        true
    }

    #[inline(always)]
    fn with_slopes(&self, x: [f64; STATES], s: &[f64], out: &mut Transition) -> bool {
        let (width, h) = (self.width(), self.part_s());
        let stride = width.next_multiple_of(UNIT);
        out.states.clear();
        out.slopes.resize(self.steps, Vec::new());
        let w = &mut out.work;
        w.terms.resize(self.craft.terms.acts.len(), 0.0);
        for matrix in [&mut w.slopes, &mut w.at, &mut w.sum, &mut w.stage] {
            matrix.clear();
            matrix.resize(STATES * stride, 0.0);
        }
        (0..STATES).for_each(|i| w.slopes[i * stride + i] = 1.0);
        // In an unresolved gust, whose side changes from step to step, an end is not the next step's start.
        let shared = !self.is_spread();
        let mut x = x;
        for step in 0..self.steps * self.drive.splits {
            let mut next = x;
            // One call for all three: it is long, and copied to wherever it is called from.
            for place in [START, END, MIDDLE] {
                let ends = [START, END].map(|e| w.instants[e].linear.rate);
                let mut at = x;
                if place == END {
                    let Some(end) = self.step(&x, step, s, ends[0], &mut w.terms) else { return false };
                    (next, at) = (end, end);
                } else if place == MIDDLE {
                    for i in 0..STATES {
                        at[i] = 0.5 * (x[i] + next[i]) + 0.125 * h * (ends[0][i] - ends[1][i]);
                    }
                } else if shared && step > 0 {
                    continue;
                }
                if !self.instant(&at, (step, place), s, stride, w) {
                    return false;
                }
            }
            if step == 0 {
                out.first_input = w.instants[START].linear.by_input;
            }
            carry(w, h, stride);
            if !w.slopes.iter().all(|v| v.is_finite()) {
                return false;
            }
            w.instants.swap(START, END);
            x = next;
            if !(step + 1).is_multiple_of(self.drive.splits) {
                continue;
            }
            out.states.push(x);
            let kept = &mut out.slopes[step / self.drive.splits];
            kept.clear();
            w.slopes.chunks_exact(stride).for_each(|row| kept.extend_from_slice(&row[..width]));
        }
        true
    }

    /// The state a step later, the first stage's rate given; `None` where the flight cannot go on.
    #[inline(always)]
    fn step(&self, x: &[f64; STATES], step: usize, s: &[f64], first: [f64; STATES], terms: &mut [f64]) -> Option<[f64; STATES]> {
        let h = self.part_s();
        let (mut k, mut sum) = (first, [0.0; STATES]);
        for (a, half, b) in RK4 {
            if half > 0 {
                let mut at = *x;
                (0..STATES).for_each(|i| at[i] += h * a * k[i]);
                k = self.rate(&at, (step, half), self.drive.inputs(2 * step + half, s), terms)?;
            }
            (0..STATES).for_each(|i| sum[i] += b * k[i]);
        }
        let mut next = *x;
        (0..STATES).for_each(|i| next[i] += h * sum[i]);
        next.iter().all(|v| v.is_finite()).then_some(next)
    }

    /// Linearises at one instant of a step, into its place; false where the flight cannot go on.
    #[inline(always)]
    fn instant(&self, x: &[f64; STATES], at: (usize, usize), s: &[f64], stride: usize, w: &mut Work) -> bool {
        let column = 2 * at.0 + at.1;
        let Some(linear) = self.linear(x, at, self.drive.inputs(column, s), w) else { return false };
        let n = self.drive.states;
        let instant = &mut w.instants[at.1];
        instant.linear = linear;
        instant.forcing.clear();
        instant.forcing.resize((STATES - KINEMATIC) * (stride - STATES), 0.0);
        for (row, out) in (KINEMATIC..STATES).zip(instant.forcing.chunks_exact_mut(stride - STATES)) {
            for (slope, source) in linear.by_input[row].iter().zip(self.drive.at[column].chunks_exact(n)) {
                out.iter_mut().zip(source).for_each(|(o, s)| *o += slope * s);
            }
            for ((coefficient, parameter), value) in self.craft.terms.acts.iter().zip(&w.mean) {
                if let Some(column) = parameter.and_then(|p| self.columns[p]) {
                    out[n + column] += linear.by_coefficient[row][*coefficient] * value;
                }
            }
        }
        true
    }

    fn is_spread(&self) -> bool {
        self.spread_m_s.iter().any(|s| *s != 0.0)
    }

    /// Inputs with the unresolved gust on either side, and how many of them count: one without such a gust. Signs change from step to
    /// step so that its axes do not mix.
    #[inline(always)]
    fn sides(&self, step: usize, inputs: [f64; INPUTS]) -> ([[f64; INPUTS]; 2], usize) {
        if !self.is_spread() {
            return ([inputs; 2], 1);
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the number of a sample")]
        let pattern = ((self.start_s / self.interval_s).round() as usize + step) % 4;
        let sign = [1.0, if pattern < 2 { 1.0 } else { -1.0 }, if pattern.is_multiple_of(2) { 1.0 } else { -1.0 }];
        let mut sides = [inputs; 2];
        for k in 0..3 {
            sides[0][2 + k] += sign[k] * self.spread_m_s[k];
            sides[1][2 + k] -= sign[k] * self.spread_m_s[k];
        }
        (sides, 2)
    }

    /// Rate of the state, the mean over the unresolved gust.
    #[inline(always)]
    fn rate(&self, x: &[f64; STATES], at: (usize, usize), inputs: [f64; INPUTS], terms: &mut [f64]) -> Option<[f64; STATES]> {
        let mut mean = [0.0; STATES];
        let (sides, count) = self.sides(at.0, inputs);
        for inputs in &sides[..count] {
            let extra = Extra {
                velocity: [inputs[2], inputs[3], inputs[4]],
                acceleration: [inputs[5], inputs[6], inputs[7]],
                coefficients: [0.0; 6],
            };
            let rate = self.craft.rate(x, self.air(at.0, at.1, inputs), &extra, self.parameters, terms)?;
            mean.iter_mut().zip(rate).for_each(|(m, r)| *m += r);
        }
        if count == 2 {
            mean.iter_mut().for_each(|m| *m *= 0.5);
        }
        Some(mean)
    }

    /// Rate and its derivatives, the mean over the unresolved gust.
    #[inline(always)]
    fn linear(&self, x: &[f64; STATES], at: (usize, usize), inputs: [f64; INPUTS], work: &mut Work) -> Option<Linear> {
        let mut mean = Linear::default();
        let (sides, count) = self.sides(at.0, inputs);
        let weight = 1.0 / count as f64;
        work.mean.clear();
        work.mean.resize(work.terms.len(), 0.0);
        for inputs in &sides[..count] {
            self.add_linear(x, self.air(at.0, at.1, inputs), inputs, weight, &mut work.terms, &mut mean)?;
            work.mean.iter_mut().zip(&work.terms).for_each(|(m, t)| *m += weight * t);
        }
        Some(mean)
    }

    #[inline(always)]
    fn add_linear(
        &self,
        x: &[f64; STATES],
        air: TunnelAir,
        inputs: &[f64; INPUTS],
        weight: f64,
        terms: &mut [f64],
        mean: &mut Linear,
    ) -> Option<()> {
        type D = Dual<LANES>;
        // One call for both: it is long, and copied to wherever it is called from.
        let mut by = [[D::default(); STATES]; 2];
        for (by_extra, rates) in by.iter_mut().enumerate().map(|(k, rates)| (k == 1, rates)) {
            let state = |value: f64, i: usize| if by_extra { D::real(value) } else { D::variable(value, i) };
            let added = |value: f64, i: usize| if by_extra { D::variable(value, i) } else { D::real(value) };
            let (mut states, mut coefficients) = ([D::default(); STATES], [D::default(); 6]);
            states.iter_mut().enumerate().for_each(|(i, one)| *one = state(x[i], i));
            coefficients.iter_mut().enumerate().for_each(|(i, one)| *one = added(0.0, 6 + i));
            let velocity = each!(|i| added(inputs[2 + i], i));
            let acceleration = each!(|i| added(inputs[5 + i], 3 + i));
            let extra = Extra { velocity, acceleration, coefficients };
            *rates = self.craft.rate(&states, air, &extra, self.parameters, terms)?;
        }
        let [by_state, by_extra] = by;
        let shape = self.craft.wind_per_speed(x);
        let dot = |a: &[f64], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for i in 0..STATES {
            let d = &by_extra[i].slopes;
            let (velocity, acceleration) = (&d[..3], &d[3..6]);
            let speed = dot(velocity, shape.along) + dot(acceleration, shape.rate);
            let by_input = [speed, dot(acceleration, shape.along), d[0], d[1], d[2], d[3], d[4], d[5]];
            mean.rate[i] += weight * by_state[i].value;
            mean.by_state[i].iter_mut().zip(&by_state[i].slopes).for_each(|(m, s)| *m += weight * s);
            mean.by_input[i].iter_mut().zip(by_input).for_each(|(m, s)| *m += weight * s);
            mean.by_coefficient[i].iter_mut().zip(&d[6..]).for_each(|(m, s)| *m += weight * s);
        }
        Some(())
    }
}

/// A flight in the widest vector unit of the machine. Nothing is contracted or summed in another order: the same bits on every one.
struct Widest<'w, 's> {
    segment: &'w Segment<'s>,
    x: [f64; STATES],
    s: &'w [f64],
    out: &'w mut Transition,
    slopes: bool,
}

impl WithSimd for Widest<'_, '_> {
    type Output = bool;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        if self.slopes {
            self.segment.with_slopes(self.x, self.s, self.out)
        } else {
            self.segment.states_alone(self.x, self.s, self.out)
        }
    }
}

/// Slopes a step later, by the classical Runge-Kutta method.
#[inline(always)]
fn carry(w: &mut Work, h: f64, stride: usize) {
    w.sum.fill(0.0);
    for (a, half, b) in RK4 {
        if half == 0 {
            w.at.copy_from_slice(&w.slopes);
        } else {
            w.at.iter_mut().zip(&w.slopes).zip(&w.stage).for_each(|((at, s), k)| *at = s + h * a * k);
        }
        variation(&w.instants[half], &w.at, stride, &mut w.stage);
        w.sum.iter_mut().zip(&w.stage).for_each(|(s, k)| *s += b * k);
    }
    w.slopes.iter_mut().zip(&w.sum).for_each(|(s, k)| *s += h * k);
}

/// The right-hand side of the variational equations.
#[inline(always)]
fn variation(instant: &Instant, at: &[f64], stride: usize, out: &mut [f64]) {
    for (row, out) in out.chunks_exact_mut(stride).enumerate() {
        out.fill(0.0);
        for (slope, source) in instant.linear.by_state[row].iter().zip(at.chunks_exact(stride)) {
            if *slope != 0.0 {
                out.iter_mut().zip(source).for_each(|(o, s)| *o += slope * s);
            }
        }
        if row >= KINEMATIC {
            let forcing = &instant.forcing[(row - KINEMATIC) * (stride - STATES)..][..stride - STATES];
            out[STATES..].iter_mut().zip(forcing).for_each(|(o, f)| *o += f);
        }
    }
}

/// Places of a step's instants, by the half steps at which they are.
const START: usize = 0;
const MIDDLE: usize = 1;
const END: usize = 2;

/// Stages of the classical Runge-Kutta method (Kutta 1901): fraction of the step from which the stage is taken, the same in
/// half steps, weight.
const RK4: [(f64, usize, f64); 4] = [(0.0, 0, 1.0 / 6.0), (0.5, 1, 1.0 / 3.0), (0.5, 1, 1.0 / 3.0), (1.0, 2, 1.0 / 6.0)];
