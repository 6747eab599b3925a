//! pid: the search for the most likely parameters. In: runs made ready, starting values, what is free. Out: a solution.

use super::normal::{MOST_SHORT, Normal, Pace};
use super::run::{FreeColumns, Linearised, Misfit, Nominal, PreparedRun};
use crate::StopReason;
use crate::equations::Transition;
use nalgebra::{DMatrix, DVector};
use windfall_model::{POSE, PerChannel, Unknowns};

/// A finished search.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// All parameters of the structure: estimated, tied or held.
    pub parameters: Vec<f64>,
    /// Names of the free unknowns, in the order of the covariance.
    pub names: Vec<String>,
    /// Their estimates.
    pub estimates: Vec<f64>,
    /// Covariance for white residuals (the Cramér-Rao bound).
    pub covariance: DMatrix<f64>,
    /// Standard deviation of each channel: X, Y, Z (m), R_x, R_y, R_z (rad), V_W (m/s).
    pub noise_std: PerChannel<f64>,
    /// Condition number of the information's root with columns of unit length.
    pub condition: f64,
    /// Twice the log-likelihood, up to a constant.
    pub log_likelihood2: f64,
    /// Iterations made.
    pub iterations: usize,
    /// Why it ended.
    pub stop: StopReason,
}

/// A solution with all that later steps need, or which unknown the data do not determine.
#[derive(Debug)]
pub(crate) enum Outcome {
    Solved(Box<Solved>),
    Undetermined {
        column: usize,
        rank: usize,
    },
    /// The search ended without an answer.
    Stopped(StopReason),
}

/// A solution with its linearisation.
#[derive(Debug)]
pub(crate) struct Solved {
    pub(crate) solution: Solution,
    /// [`sensitivities`] where the search began.
    pub(crate) first: DMatrix<f64>,
    pub(crate) unknowns: Unknowns,
    pub(crate) nominals: Vec<Nominal>,
    pub(crate) linear: Vec<Linearised>,
    pub(crate) residuals: Vec<PerChannel<Vec<f64>>>,
}

/// What is left to go, by the last two steps' ratio, below this part of every standard error ends the search.
const STEP: f64 = 1e-3;
/// Steps that shrink faster than this are taken to go on so.
const MOST_SHRUNK: f64 = 0.5;
/// The same as [`STEP`] when iterations are used up: where the model is wrong, steps shrink slowly and white noise's errors are too small.
const NEARLY: f64 = 0.1;
/// Smallest noise of a channel, as part of its sensor's: exact data must not divide by zero.
const FLOOR: f64 = 1e-4;
/// What sensors are taken to have where a plant states nothing: thesis Table A.3 (m, rad, m/s).
const TABLE_A_3: PerChannel<f64> = [7.5e-4, 7.5e-4, 7.5e-4, 1.09e-3, 1.92e-3, 1.92e-3, 2.57e-3];
/// By how much the misfit may grow in a step: one squared standard deviation. Gaps between pieces are closed at that price, and the
/// noise's variance moves between steps.
const SLACK: f64 = 1.0;
/// Most halvings of a step.
const HALVINGS: u32 = 8;

/// Most likely unknowns of these runs. `nominals` are where trajectories start: the smoothed ones, or a neighbour's solution.
pub(crate) fn solve(runs: &[PreparedRun<'_>], unknowns: Unknowns, nominals: Vec<Nominal>, iterations: usize) -> Outcome {
    solve_from(runs, unknowns, nominals, first_noise(runs), iterations)
}

/// One step of all unknowns, and their covariance.
pub(crate) struct Glance {
    pub(crate) step: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
}

/// One step of all unknowns from here, with its covariance, each channel's noise as given; the column that the data do not determine
/// where there is one. `None` where the flight cannot go on.
pub(crate) fn one_step(
    runs: &[PreparedRun<'_>],
    unknowns: &Unknowns,
    nominals: &[Nominal],
    std: &PerChannel<f64>,
) -> Option<Result<Glance, usize>> {
    let (c, mut work) = (FreeColumns::of(unknowns), Transition::default());
    let linear: Option<Vec<Linearised>> =
        runs.iter().zip(nominals).map(|(run, nominal)| run.linearise(nominal, &c, std, &mut work)).collect();
    Some(Normal::new(&linear?, unknowns).map(|n| Glance { step: n.step, covariance: n.covariance }).map_err(|(column, _)| column))
}

/// [`solve`], from known noise.
pub(crate) fn solve_from(
    runs: &[PreparedRun<'_>],
    unknowns: Unknowns,
    nominals: Vec<Nominal>,
    std: PerChannel<f64>,
    iterations: usize,
) -> Outcome {
    let mut search = Search { runs, unknowns, nominals, std, work: Transition::default() };
    let Some(mut misfits) = search.misfits(&search.unknowns.clone(), &search.nominals.clone()) else {
        return Outcome::Stopped(StopReason::FlightFails);
    };
    let mut pace = Pace::default();
    let (mut first, mut before_last) = (DMatrix::default(), 0.0);
    for iteration in 1..=iterations.max(1) {
        let Some(linear) = search.linearise() else { return Outcome::Stopped(StopReason::FlightFails) };
        if iteration == 1 {
            first = sensitivities(&linear, search.unknowns.free());
        }
        let normal = match Normal::new(&linear, &search.unknowns) {
            Ok(normal) => normal,
            Err((column, rank)) => return Outcome::Undetermined { column, rank },
        };
        let largest = normal.largest_step();
        let whole = pace.next(&normal);
        let Some((next, fraction)) = search.descend(&linear, &normal, &misfits, whole) else {
            if largest < 30.0 * STEP {
                // Rounding is all that is left.
                return search.finish(&normal, first, misfits, iteration, StopReason::Converged);
            }
            return Outcome::Stopped(StopReason::NoDescent);
        };
        pace.took(fraction);
        misfits = next;
        let before = search.std;
        search.update_noise(&misfits);
        let settled = search.std.iter().zip(before).all(|(a, b)| (a / b).ln().abs() < STEP);
        let gaps: f64 = misfits.iter().map(|m| m.gaps).sum();
        let left = left(largest, before_last, fraction);
        before_last = largest;
        if left < STEP && settled && fraction >= MOST_SHORT && gaps < 1e-3 {
            return search.finish(&normal, first, misfits, iteration, StopReason::Converged);
        }
        if iteration >= iterations && largest < NEARLY && gaps < 1e-3 {
            return search.finish(&normal, first, misfits, iteration, StopReason::Nearly);
        }
    }
    Outcome::Stopped(StopReason::Iterations)
}

/// What is left to go after a fraction of a step: where steps shrink by a ratio, the sum of those to come.
fn left(largest: f64, before_last: f64, fraction: f64) -> f64 {
    let ratio = if fraction > 0.5 { largest / before_last } else { f64::INFINITY };
    if ratio < MOST_SHRUNK { largest * ratio / (1.0 - ratio) } else { largest }
}

/// What the runs tell about the free unknowns: rows whose squares sum to the information.
pub(crate) fn sensitivities(linear: &[Linearised], free: usize) -> DMatrix<f64> {
    let mut a = DMatrix::zeros(linear.len() * free, free);
    for (i, l) in linear.iter().enumerate() {
        a.view_mut((i * free, 0), (free, free)).copy_from(&l.information.view((0, 0), (free, free)));
    }
    a
}

/// Root mean square over the runs of what smoothing sees as noise.
fn first_noise(runs: &[PreparedRun<'_>]) -> PerChannel<f64> {
    let mean = |c: usize| runs.iter().map(|r| r.noise_std[c].powi(2)).sum::<f64>() / runs.len() as f64;
    let floor = floor(runs);
    std::array::from_fn(|c| mean(c).sqrt().max(floor[c]))
}

/// Smallest noise that a channel is given.
pub(crate) fn floor(runs: &[PreparedRun<'_>]) -> PerChannel<f64> {
    let declared = runs[0].craft.plant.sensors.std_by_channel();
    std::array::from_fn(|c| FLOOR * if declared[c] > 0.0 { declared[c] } else { TABLE_A_3[c] })
}

struct Search<'r, 'a> {
    runs: &'r [PreparedRun<'a>],
    unknowns: Unknowns,
    nominals: Vec<Nominal>,
    std: PerChannel<f64>,
    work: Transition,
}

impl Search<'_, '_> {
    fn linearise(&mut self) -> Option<Vec<Linearised>> {
        let c = FreeColumns::of(&self.unknowns);
        let work = &mut self.work;
        self.runs.iter().zip(&self.nominals).map(|(run, nominal)| run.linearise(nominal, &c, &self.std, work)).collect()
    }
    fn misfits(&mut self, unknowns: &Unknowns, nominals: &[Nominal]) -> Option<Vec<Misfit>> {
        let c = FreeColumns::of(unknowns);
        let work = &mut self.work;
        self.runs.iter().zip(nominals).map(|(run, nominal)| run.misfit(nominal, &c, work)).collect()
    }
    fn merit(&self, misfits: &[Misfit], unknowns: &Unknowns) -> f64 {
        let weighted = |m: &Misfit| {
            let one = |(r, s): (&Vec<f64>, &f64)| r.iter().map(|r| r * r).sum::<f64>() / (s * s);
            m.residuals.iter().zip(&self.std).map(one).sum::<f64>() + m.gaps + m.jumps
        };
        misfits.iter().map(weighted).sum::<f64>() + unknowns.prior_misfit()
    }
    /// The longest of the step's halves, `whole` times as long, that lowers the merit, taken.
    fn descend(&mut self, linear: &[Linearised], normal: &Normal, now: &[Misfit], whole: f64) -> Option<(Vec<Misfit>, f64)> {
        let before = self.merit(now, &self.unknowns);
        let steps: Vec<_> = self.runs.iter().zip(linear).map(|(r, l)| r.step(l, &normal.step)).collect::<Option<_>>()?;
        for halving in 0..=HALVINGS {
            let fraction = whole * 0.5_f64.powi(halving as i32);
            let unknowns = self.unknowns.moved(normal.step.as_slice(), fraction);
            let nominals: Vec<Nominal> = self.nominals.iter().zip(&steps).map(|(n, s)| n.moved(s, fraction)).collect();
            let Some(misfits) = self.misfits(&unknowns, &nominals) else { continue };
            let merit = self.merit(&misfits, &unknowns);
            if merit.is_finite() && merit <= before + SLACK {
                (self.unknowns, self.nominals) = (unknowns, nominals);
                return Some((misfits, fraction));
            }
        }
        None
    }
    /// Variances of maximum likelihood given the residuals; what the initial states took is given back.
    fn update_noise(&mut self, misfits: &[Misfit]) {
        let floor = floor(self.runs);
        for (c, floor) in floor.into_iter().enumerate() {
            let squares: f64 = misfits.iter().flat_map(|m| &m.residuals[c]).map(|r| r * r).sum();
            let count: usize = misfits.iter().map(|m| m.residuals[c].len()).sum();
            let taken = if c < POSE { 2.0 * self.runs.len() as f64 } else { 0.0 };
            self.std[c] = (squares / (count as f64 - taken).max(1.0)).sqrt().max(floor);
        }
    }
    fn finish(
        mut self,
        normal: &Normal,
        first: DMatrix<f64>,
        misfits: Vec<Misfit>,
        iterations: usize,
        stop: StopReason,
    ) -> Outcome {
        // Covariance and profile at the solution, not at the last step's start.
        let Some(linear) = self.linearise() else { return Outcome::Stopped(StopReason::FlightFails) };
        let last = Normal::new(&linear, &self.unknowns).ok();
        let normal = last.as_ref().unwrap_or(normal);
        let count: usize = misfits.iter().map(|m| m.residuals[0].len()).sum();
        let logs: f64 = self.std.iter().map(|s| 2.0 * s.ln()).sum();
        let solution = Solution {
            parameters: self.unknowns.parameters(),
            names: self.unknowns.names(),
            estimates: self.unknowns.values(),
            covariance: normal.covariance.clone(),
            noise_std: self.std,
            condition: normal.condition,
            log_likelihood2: -self.merit(&misfits, &self.unknowns) - count as f64 * logs,
            iterations,
            stop,
        };
        Outcome::Solved(Box::new(Solved {
            solution,
            first,
            unknowns: self.unknowns,
            nominals: self.nominals,
            linear,
            residuals: misfits.into_iter().map(|m| m.residuals).collect(),
        }))
    }
}

#[cfg(test)]
mod tests;
