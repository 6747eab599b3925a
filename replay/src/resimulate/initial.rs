//! replay: the state from which a run began. In: a run made ready and its record. Out: the twelve numbers that bring the
//! simulated pose nearest to the measured one.

use super::replay::{Replay, turned};
use crate::ReplayError;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use rayon::prelude::*;
use std::f64::consts::TAU;
use windfall_model::{Plant, Record, Release, Sensors};
use windfall_pid::StopReason;

/// An estimated initial state.
#[derive(Clone, Debug, PartialEq)]
pub struct Initial {
    /// State at the first sample.
    pub release: Release,
    /// Standard errors for white sensor noise: position (m), velocity (m/s), rotation about body axes (rad), rates (rad/s).
    pub std_error: [f64; 12],
    /// Mean of squared pose residuals over their variances in the span used: 1 when the model is right.
    pub misfit: f64,
    /// Span from the first sample that was used, s.
    pub span_s: f64,
    /// Steps taken.
    pub iterations: usize,
    /// Why it ended.
    pub stop: StopReason,
}

/// Shortest span used, s: even a wrong model errs little in it, and 37 samples at 150 Hz give rates to 0.3 deg/s.
const FIRST_SPAN_S: f64 = 0.25;
/// Fewest samples used: two a state number and more.
const FEWEST: usize = 8;
/// Misfit up to which residuals look like sensor noise: 1, and as much again for noise of V_W and errors of estimation.
const LIKE_NOISE: f64 = 2.0;
/// Number of state numbers.
pub(crate) const N: usize = 12;
/// Steps at most.
const ITERATIONS: usize = 20;
/// A step is not worth taking when it lowers the sum of squares by less than this part of it.
const GAIN: f64 = 1e-6;
/// The same over a span that only leads to a longer one.
const GAIN_ON_THE_WAY: f64 = 1e-2;
/// Steps of the differences: m, m/s, rad, rad/s. Ten thousand times the integrator's error, a thousandth of what bends.
const STEPS: [f64; N] = [1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3];
/// Largest step in one iteration, same units: beyond it a linearisation means nothing.
const TRUST: [f64; N] = [0.3, 0.3, 0.3, 1.0, 1.0, 1.0, 0.3, 0.3, 0.3, 1.5, 1.5, 1.5];

/// Estimates the initial state of a run from its record: nonlinear least squares (Levenberg 1944, Marquardt 1963) of simulated
/// minus measured position and Euler angles, each over its sensor's standard deviation as the plant has it, all parameters
/// of the plant held. The plant must already be the one of this run.
///
/// The span begins with [`FIRST_SPAN_S`] and doubles, up to the whole run, as long as what is left looks like sensor noise. A
/// model that does not follow the run further is not bent to do so: over a long span its errors, not the run's beginning,
/// would decide on the state.
///
/// # Errors
/// A record that cannot be smoothed, or a flight that cannot even start.
pub fn estimate_initial(record: &Record, plant: &Plant) -> Result<Initial, ReplayError> {
    initial_of(&Replay::new(record, plant)?, record, &plant.sensors)
}

/// [`estimate_initial`] of a run made ready.
///
/// # Errors
/// As [`estimate_initial`].
pub fn initial_of(replay: &Replay, record: &Record, sensors: &Sensors) -> Result<Initial, ReplayError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
    let first = ((FIRST_SPAN_S / record.interval_s()).ceil() as usize).max(FEWEST).min(record.len());
    let mut problem = Problem { replay, record, weights: weights(sensors), samples: first };
    let Some(mut best) = problem.solve(replay.first(), GAIN_ON_THE_WAY) else {
        // A flight that fails midway still has a beginning; one that cannot be flown at all is an error.
        replay.fly_as_far_as_it_goes(replay.first())?;
        return Ok(failed(replay.first()));
    };
    let mut last = first;
    while problem.samples < record.len() && best.misfit < LIKE_NOISE {
        problem.samples = (2 * problem.samples).min(record.len());
        match problem.solve(best.release, GAIN_ON_THE_WAY) {
            Some(longer) if longer.misfit < LIKE_NOISE => (best, last) = (longer, problem.samples),
            _ => break,
        }
    }
    problem.samples = last;
    Ok(problem.solve(best.release, GAIN).unwrap_or(best))
}

/// An initial state as this record leaves it open for a plant near another one: estimated again over the same span, from that one's
/// answer, and moved by the estimate's error with standard normal numbers `z`; `None` where the flight fails.
pub(crate) fn again(replay: &Replay, record: &Record, sensors: &Sensors, near: &Initial, z: [f64; N]) -> Option<Release> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of samples")]
    let samples = ((near.span_s / record.interval_s()).round() as usize + 1).min(record.len());
    if samples < FEWEST {
        return None;
    }
    let (found, square) = Problem { replay, record, weights: weights(sensors), samples }.solve_squared(near.release, GAIN)?;
    // Residuals are in standard deviations: the triangle is the root of the information.
    let error = square.r.solve_upper_triangular(&SVector::from(z))?.component_mul(&square.scale);
    Some(moved(found.release, &error.into()))
}

fn failed(release: Release) -> Initial {
    let stop = StopReason::FlightFails;
    Initial { release, std_error: [f64::INFINITY; N], misfit: f64::INFINITY, span_s: 0.0, iterations: 0, stop }
}

/// One over the standard deviation of X, Y, Z, R_x, R_y, R_z; one over that of thesis Table A.3 where a plant states none.
fn weights(s: &Sensors) -> [f64; 6] {
    let or = |std: f64, table: f64| 1.0 / if std > 0.0 { std } else { table };
    let p = or(s.position_std_m, 7.5e-4);
    let (roll, a) = (or(s.roll_std_rad, 0.0623_f64.to_radians()), or(s.pitch_yaw_std_rad, 0.110_f64.to_radians()));
    [p, p, p, roll, a, a]
}

struct Problem<'a> {
    replay: &'a Replay,
    record: &'a Record,
    weights: [f64; 6],
    /// Samples used, from the first.
    samples: usize,
}

enum Stepped {
    Taken { release: Release, residual: DVector<f64>, gain: f64 },
    NotWorth,
    None,
}

impl Problem<'_> {
    /// Least squares over the samples used, to steps that gain less than `worth`; `None` when the flight from the start fails in them.
    fn solve(&self, start: Release, worth: f64) -> Option<Initial> {
        self.solve_squared(start, worth).map(|found| found.0)
    }

    /// [`Problem::solve`], with the problem as it was linearised for the last step.
    fn solve_squared(&self, start: Release, worth: f64) -> Option<(Initial, Square)> {
        let mut release = start;
        let mut residual = self.residual(start)?;
        let mut square = self.square(release, &residual);
        let mut damping = 1e-6;
        let (mut stop, mut iterations) = (StopReason::Iterations, 0);
        while iterations < ITERATIONS && stop == StopReason::Iterations {
            iterations += 1;
            match self.step(release, &residual, &square, &mut damping) {
                Stepped::Taken { release: next, residual: r, gain } => {
                    (release, residual) = (next, r);
                    if gain < worth {
                        stop = StopReason::Converged;
                    } else {
                        square = self.square(release, &residual);
                    }
                }
                Stepped::NotWorth => stop = StopReason::Converged,
                Stepped::None => stop = StopReason::NoDescent,
            }
        }
        let misfit = residual.norm_squared() / residual.len() as f64;
        let span_s = (self.samples - 1) as f64 * self.record.interval_s();
        Some((Initial { release, std_error: square.std_error(), misfit, span_s, iterations, stop }, square))
    }

    /// Weighted residuals, six a sample; `None` when the flight fails before the end.
    fn residual(&self, release: Release) -> Option<DVector<f64>> {
        let n = self.samples;
        let flown = self.replay.fly_beginning(release, n).ok()?;
        if flown.record.len() < n {
            return None;
        }
        let (simulated, measured) = (flown.record.channels(), self.record.channels());
        let mut r = DVector::zeros(6 * n);
        for c in 0..6 {
            for i in 0..n {
                let mut d = simulated[c][i] - measured[c][i];
                if c >= 3 {
                    d -= TAU * (d / TAU).round();
                }
                r[c * n + i] = d * self.weights[c];
            }
        }
        r.iter().all(|v| v.is_finite()).then_some(r)
    }

    /// Triangle and right-hand side of the linearised problem, columns by forward differences.
    fn square(&self, release: Release, residual: &DVector<f64>) -> Square {
        let columns: Vec<DVector<f64>> = (0..N)
            .into_par_iter()
            .map(|k| {
                let mut by = [0.0; N];
                by[k] = STEPS[k];
                match self.residual(moved(release, &by)) {
                    Some(r) => (r - residual) / STEPS[k],
                    None => DVector::zeros(residual.len()),
                }
            })
            .collect();
        let mut j = DMatrix::from_columns(&columns);
        let scale = SVector::<f64, N>::from_fn(|k, _| match j.column(k).norm() {
            s if s > 0.0 => 1.0 / s,
            _ => 0.0,
        });
        for k in 0..N {
            j.column_mut(k).scale_mut(scale[k]);
        }
        let qr = j.qr();
        let mut rhs = residual.clone();
        qr.q_tr_mul(&mut rhs);
        let r = qr.r();
        Square { r: SMatrix::from_fn(|a, b| r[(a, b)]), rhs: SVector::from_fn(|a, _| -rhs[a]), scale }
    }

    /// The first damped step that lowers the sum of squares.
    fn step(&self, release: Release, residual: &DVector<f64>, square: &Square, damping: &mut f64) -> Stepped {
        let before = residual.norm_squared();
        for _ in 0..12 {
            let Some(delta) = square.solve(*damping) else { return Stepped::None };
            if square.predicted_gain(&delta) < 1e-9 * before {
                return Stepped::NotWorth;
            }
            let shrink = (0..N).map(|k| delta[k].abs() / TRUST[k]).fold(1.0, f64::max);
            let next = moved(release, &std::array::from_fn(|k| delta[k] / shrink));
            if let Some(r) = self.residual(next) {
                let gain = 1.0 - r.norm_squared() / before;
                if gain > 0.0 {
                    *damping = (*damping * 0.1).max(1e-12);
                    return Stepped::Taken { release: next, residual: r, gain };
                }
            }
            *damping *= 10.0;
        }
        Stepped::None
    }
}

/// The linearised problem `min |r x − rhs|`, with columns scaled to unit length.
struct Square {
    r: SMatrix<f64, N, N>,
    rhs: SVector<f64, N>,
    scale: SVector<f64, N>,
}

impl Square {
    /// Step in state units, by QR of the triangle with the damping below it.
    fn solve(&self, damping: f64) -> Option<SVector<f64, N>> {
        let mut a = SMatrix::<f64, 24, N>::zeros();
        a.fixed_view_mut::<N, N>(0, 0).copy_from(&self.r);
        for k in 0..N {
            a[(N + k, k)] = damping.sqrt();
        }
        let mut b = SVector::<f64, 24>::zeros();
        b.fixed_rows_mut::<N>(0).copy_from(&self.rhs);
        let qr = a.qr();
        qr.q_tr_mul(&mut b);
        let x = qr.r().solve_upper_triangular(&b.fixed_rows::<N>(0).into_owned())?;
        Some(x.component_mul(&self.scale))
    }
    /// What a step in state units takes off the sum of squares, were the problem linear.
    fn predicted_gain(&self, delta: &SVector<f64, N>) -> f64 {
        let x = delta.zip_map(&self.scale, |d, s| if s > 0.0 { d / s } else { 0.0 });
        self.rhs.norm_squared() - (self.r * x - self.rhs).norm_squared()
    }
    fn std_error(&self) -> [f64; N] {
        match self.r.try_inverse() {
            Some(inverse) => std::array::from_fn(|k| inverse.row(k).norm() * self.scale[k]),
            None => [f64::INFINITY; N],
        }
    }
}

/// A release moved by position, velocity, rotation about body axes and rates.
fn moved(r: Release, by: &[f64; N]) -> Release {
    let add = |x: [f64; 3], from: usize| std::array::from_fn(|k| x[k] + by[from + k]);
    Release {
        position_m: add(r.position_m, 0),
        velocity_m_s: add(r.velocity_m_s, 3),
        attitude_rad: turned(r.attitude_rad, [by[6], by[7], by[8]]),
        rates_rad_s: add(r.rates_rad_s, 9),
    }
}

#[cfg(test)]
mod tests;
