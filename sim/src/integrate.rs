//! sim: `ode_solvers` at work. In: a flight made ready and its first state. Out: states at the sample times.
//!
//! What the library needs (each reproduced): time as one more state; start at t = 0; an end a little beyond the last sample,
//! since a sample that falls on the end is taken from the step before; an own check for what became NaN; events by root-finding
//! on the samples.

use crate::error::SimError;
use crate::setup::Setup;
use nalgebra::SVector;
use ode_solvers::dop_shared::{IntegrationError, OutputType, Stats};
use ode_solvers::{Dop853, Dopri5, System};
use std::cell::Cell;
use windfall_model::{Flight, Integrator, Numerics, TestSection};

/// The end lies this part of a sample interval beyond the last sample.
pub(crate) const BEYOND: f64 = 1e-3;
/// Steps at most for any flight, and for each second of it beyond: a body at the rate at which a flight is given up turns 160 times a
/// second, and the higher method takes some 60 steps a turn at the default tolerance. Landers take a hundred a second.
const STEPS: f64 = 1e5;
const STEPS_PER_S: f64 = 1e4;
/// Steps at most for each of those that inputs ask for at least.
const STEPS_PER_INPUT: f64 = 10.0;
/// Part of a state, beside one unit, by which it is moved to see how it changes by itself: the root of rounding.
const NUDGE: f64 = 1e-8;

/// Body rate, rad/s, at which a flight is given up: 160 turns a second are no lander's, and steps would shrink without end.
pub(crate) const RUNAWAY_RAD_S: f64 = 1000.0;

/// What went wrong on the way.
#[derive(Default)]
struct Fault {
    /// First thing that was not finite in the right-hand side: its name and time.
    first: Cell<Option<(&'static str, f64)>>,
    /// When body rates ran away.
    runaway: Cell<Option<f64>>,
}

struct Rhs<'a, const N: usize> {
    setup: &'a Setup<'a>,
    section: Option<TestSection>,
    fault: &'a Fault,
}

impl<const N: usize> System<f64, SVector<f64, N>> for Rhs<'_, N> {
    #[inline]
    fn system(&self, _t: f64, y: &SVector<f64, N>, dy: &mut SVector<f64, N>) {
        self.setup.rate(y, dy);
        // A sum is finite only when every part is (overflow of finite parts aside, which is as bad).
        if !dy.sum().is_finite() && self.fault.first.get().is_none() {
            self.fault.first.set(Some((self.setup.not_finite(y, dy), y[crate::state::TIME])));
        }
    }
    /// Called with the last sample so far: stop once it is outside the test section or spins beyond reason.
    fn solout(&mut self, t: f64, y: &SVector<f64, N>, _dy: &SVector<f64, N>) -> bool {
        if y[10] * y[10] + y[11] * y[11] + y[12] * y[12] > RUNAWAY_RAD_S * RUNAWAY_RAD_S {
            self.fault.runaway.set(Some(t));
            return true;
        }
        self.section.is_some_and(|s| outside(&s, [y[0], y[1], y[2]]))
    }
}

/// True when a place (m, tunnel axes) is beyond wall or nets.
pub(crate) fn outside(s: &TestSection, p: [f64; 3]) -> bool {
    p[0] < s.top_x_m || p[0] > s.bottom_x_m || p[1].hypot(p[2]) > s.radius_m
}

/// Steps after which a flight of this length is given up: bounded whatever the plant.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive; saturates at the largest count")]
pub(crate) fn budget(end_s: f64, step_max_s: f64) -> u32 {
    (STEPS + end_s * STEPS_PER_S + STEPS_PER_INPUT * end_s / step_max_s) as u32
}

/// Number of samples of a flight: from release to its duration, both included.
pub(crate) fn samples(flight: &Flight) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "duration and rate are checked positive")]
    let n = (flight.duration_s * flight.rate_hz * (1.0 + 1e-12)).floor() as usize;
    n + 1
}

/// Flies from `start` and shows the states at the sample times to `look`; they may end early, with the first state outside,
/// where the test section is left. Gives what `look` made of them and the number of accepted steps.
pub(crate) fn integrate<const N: usize, T>(
    setup: &Setup<'_>,
    flight: &Flight,
    start: SVector<f64, N>,
    look: impl FnOnce(&[SVector<f64, N>]) -> T,
) -> Result<(T, u64), SimError> {
    let fault = Fault::default();
    let rhs = Rhs::<N> { setup, section: flight.section, fault: &fault };
    let n = flight.numerics;
    let count = samples(flight);
    let dt = 1.0 / flight.rate_hz;
    let end = ((count - 1) as f64 + BEYOND) * dt;
    let h_max = setup.step_max_s.min(end);
    let span = Span { end_s: end, sample_s: dt, step_max_s: h_max, output: OutputType::Dense };
    solve(rhs, start, n, span, |outcome, states| finished(setup, outcome, states, &fault, look))
}

/// How far to integrate, s, and what is put out.
pub(crate) struct Span {
    pub(crate) end_s: f64,
    pub(crate) sample_s: f64,
    pub(crate) step_max_s: f64,
    pub(crate) output: OutputType,
}

/// Integrates from zero and shows the outcome and the states that were put out to `take`.
pub(crate) fn solve<const N: usize, S: System<f64, SVector<f64, N>>, T>(
    rhs: S,
    start: SVector<f64, N>,
    n: Numerics,
    Span { end_s: end, sample_s: dt, step_max_s: h_max, output }: Span,
    take: impl FnOnce(Result<Stats, IntegrationError>, &[SVector<f64, N>]) -> T,
) -> T {
    let steps_max = budget(end, h_max);
    let (rtol, atol) = (n.relative_tolerance, n.absolute_tolerance);
    // The remaining numbers are the defaults of the library (Hairer's); stiffness is not tested.
    match n.method {
        Integrator::Dopri5 => {
            let mut solver = Dopri5::from_param(
                rhs,
                0.0,
                end,
                dt,
                start,
                rtol,
                atol,
                0.9,
                0.04,
                0.2,
                10.0,
                h_max,
                0.0,
                steps_max,
                u32::MAX,
                output,
            );
            let outcome = solver.integrate();
            take(outcome, solver.y_out())
        }
        Integrator::Dop853 => {
            let mut solver = Dop853::from_param(
                rhs,
                0.0,
                end,
                dt,
                start,
                rtol,
                atol,
                0.9,
                0.0,
                0.333,
                6.0,
                h_max,
                0.0,
                steps_max,
                u32::MAX,
                output,
            );
            let outcome = solver.integrate();
            take(outcome, solver.y_out())
        }
    }
}

fn finished<const N: usize, T>(
    setup: &Setup<'_>,
    outcome: Result<Stats, IntegrationError>,
    states: &[SVector<f64, N>],
    fault: &Fault,
    look: impl FnOnce(&[SVector<f64, N>]) -> T,
) -> Result<(T, u64), SimError> {
    let stats = outcome.map_err(|e| explain(setup, &e, states.last(), fault))?;
    if let Some(t_s) = fault.runaway.get() {
        return Err(SimError::Runaway { limit_rad_s: RUNAWAY_RAD_S, t_s });
    }
    if states.iter().all(|y| y.sum().is_finite()) {
        return Ok((look(states), u64::from(stats.accepted_steps)));
    }
    let (what, t_s) = fault.first.get().unwrap_or(("state", 0.0));
    Err(SimError::NotFinite { what, t_s })
}

fn explain<const N: usize>(setup: &Setup<'_>, e: &IntegrationError, last: Option<&SVector<f64, N>>, fault: &Fault) -> SimError {
    match (fault.first.get(), e) {
        (Some((what, t_s)), _) => SimError::NotFinite { what, t_s },
        (None, IntegrationError::MaxNumStepReached { x, n_step }) => {
            let (what, rate_per_s) = last.map_or(("state", f64::INFINITY), |y| setup.fastest(y));
            SimError::TooManySteps { steps: *n_step, t_s: *x, what, rate_per_s }
        }
        (None, IntegrationError::StepSizeUnderflow { x } | IntegrationError::StiffnessDetected { x }) => {
            SimError::StepTooSmall { t_s: *x }
        }
    }
}

/// Parts of the state, in its order; beyond them operator and loose part.
const PARTS: [(&str, std::ops::Range<usize>); 4] =
    [("position", 0..3), ("velocity", 3..6), ("attitude", 6..10), ("body rate", 10..13)];

impl Setup<'_> {
    /// The part of the state that changes fastest by itself at `y`, and how fast, 1/s: the largest slope of a rate by its own state.
    #[cold]
    pub(crate) fn fastest<const N: usize>(&self, y: &SVector<f64, N>) -> (&'static str, f64) {
        let rate = |y: &SVector<f64, N>| {
            let mut dy = SVector::<f64, N>::zeros();
            self.rate(y, &mut dy);
            dy
        };
        let here = rate(y);
        let slope = |k: usize| {
            let step = NUDGE * (1.0 + y[k].abs());
            let mut moved = *y;
            moved[k] += step;
            ((rate(&moved)[k] - here[k]) / step).abs()
        };
        let others = ("state of operator or loose part", crate::state::BASE..N);
        let parts = PARTS.into_iter().chain([others]);
        let all = parts.map(|(name, range)| (name, range.map(slope).fold(0.0, f64::max)));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("state", 0.0))
    }
    /// Names what is not finite, in the order in which one thing follows from another.
    #[cold]
    fn not_finite<const N: usize>(&self, y: &SVector<f64, N>, dy: &SVector<f64, N>) -> &'static str {
        let good = |range: std::ops::Range<usize>| y.as_slice()[range].iter().all(|x| x.is_finite());
        let i = self.instant(y);
        let checks = [
            (good(0..3), "position"),
            (good(3..6), "velocity"),
            (good(6..10), "attitude"),
            (good(10..13), "body rate"),
            (i.vw_m_s.is_finite() && i.vw_rate_m_s2.is_finite(), "tunnel speed"),
            (i.v_air_cm.is_finite() && i.a_air.is_finite(), "air velocity"),
            (i.flow.values.iter().all(|v| v.is_finite()), "flow variable"),
            (i.early.iter().all(|c| c.is_finite()), "aerodynamic coefficient"),
            (i.other.f.is_finite() && i.other.m.is_finite(), "force of tether or contact"),
            (dy.as_slice()[3..6].iter().all(|x| x.is_finite()), "acceleration"),
            (dy.as_slice()[10..13].iter().all(|x| x.is_finite()), "angular acceleration"),
        ];
        checks.iter().find(|(good, _)| !good).map_or("state of operator or loose part", |(_, name)| name)
    }
}
