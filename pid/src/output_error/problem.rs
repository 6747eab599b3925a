//! pid: the search for the most likely parameters. In: runs made ready, starting values, what is free. Out: a solution.

use super::instruments::{ERRORS, Errors, KINDS};
use super::run::{CHANNELS, Columns, Linearised, Misfit, Nominal, Run};
use crate::PidError;
use crate::equations::Transition;
use nalgebra::{DMatrix, DVector};
use windfall_model::{Campaign, Structure};

/// What is done with a parameter; those not named are free.
#[derive(Clone, Debug, PartialEq)]
pub enum Handling {
    /// Kept at its declared value.
    Held,
    /// Equal to another parameter, which is free.
    Tied {
        /// Name of that parameter.
        to: String,
    },
}

/// What is known of a parameter beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Prior {
    /// Parameter.
    pub name: String,
    /// Value.
    pub mean: f64,
    /// Standard deviation, positive.
    pub std: f64,
}

/// What to estimate, and how long.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Parameters that are not simply free.
    pub handling: Vec<(String, Handling)>,
    /// Knowledge from elsewhere.
    pub priors: Vec<Prior>,
    /// Also estimate constant errors of R_y and R_z, equal in all runs (rad). Off: free flight tells them only through small
    /// lateral forces.
    pub angle_biases: bool,
    /// Most iterations.
    pub iterations: usize,
    /// Only all runs together, without each kind of run alone.
    pub combined_only: bool,
    /// Also examine whether the instruments agree (output error, all runs together).
    pub compatibility: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            handling: Vec::new(),
            priors: Vec::new(),
            angle_biases: false,
            iterations: 30,
            combined_only: false,
            compatibility: false,
        }
    }
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StopReason {
    /// The last step was below a thousandth of a standard error, and all pieces meet.
    Converged,
    /// Iterations used up, the last step below a tenth of a standard error, and all pieces meet.
    Nearly,
    /// Iterations used up.
    Iterations,
    /// No step, however short, made the misfit smaller.
    NoDescent,
    /// The model cannot fly through the record: airspeed vanishes, the nose is horizontal, or numbers overflow.
    FlightFails,
}

impl StopReason {
    /// In words, with what to try.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::Nearly => "converged to a tenth of a standard error",
            Self::Iterations => {
                "iterations used up while parameters still moved: declare fewer parameters, hold some, or give priors; where the \
                 declared model's flights drift away from the record, take --method filter-error"
            }
            Self::NoDescent => {
                "no step lowers the misfit: flights of the declared model drift away from these runs; take --method filter-error, \
                 which lets them, and windfall close"
            }
            Self::FlightFails => {
                "the declared model cannot fly through the record (no airspeed or nose horizontal): check units, cut the window"
            }
        }
    }
}

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
    pub noise_std: [f64; CHANNELS],
    /// Condition number of the information's root with columns of unit length.
    pub condition: f64,
    /// Twice the log-likelihood, up to a constant.
    pub log_likelihood2: f64,
    /// Iterations made.
    pub iterations: usize,
    /// Why it ended.
    pub stop: StopReason,
}

/// The free unknowns: parameters of the structure, then biases.
#[derive(Clone, Debug)]
pub(crate) struct Unknowns {
    /// Values of all the structure's parameters.
    pub(crate) parameters: Vec<f64>,
    /// Column of each; none where held.
    pub(crate) columns: Vec<Option<usize>>,
    pub(crate) biases: [f64; CHANNELS],
    pub(crate) bias_columns: [Option<usize>; CHANNELS],
    /// Other errors of the instruments, when they are examined.
    pub(crate) errors: Option<Errors>,
    pub(crate) names: Vec<String>,
    /// Mean and standard deviation, by column.
    priors: Vec<(usize, f64, f64)>,
}

impl Unknowns {
    /// # Errors
    /// [`PidError::Unknown`] for a name the structure does not have, a tie of or to a parameter that is not free, what is
    /// held or tied twice, or a prior without width.
    pub(crate) fn new(campaign: &Campaign, options: &Options) -> Result<Self, PidError> {
        let structure = &campaign.plant.aero.structure;
        let count = structure.parameters.len();
        let (mut held, mut tied) = (vec![false; count], vec![None; count]);
        for (name, handling) in &options.handling {
            let i = index(structure, name)?;
            let fault = |what| Err(PidError::Unknown { what, name: name.clone() });
            if held[i] || tied[i].is_some() {
                return fault("held or tied more than once");
            }
            if !campaign.declared[i] && matches!(handling, Handling::Tied { .. }) {
                return fault("tie of a parameter that is not declared or is held");
            }
            match handling {
                Handling::Held => held[i] = true,
                Handling::Tied { to } => tied[i] = Some(index(structure, to)?),
            }
        }
        let (mut columns, mut names) = (vec![None; count], Vec::new());
        for i in (0..count).filter(|i| campaign.declared[*i] && !held[*i] && tied[*i].is_none()) {
            columns[i] = Some(names.len());
            names.push(structure.parameters[i].clone());
        }
        let mut parameters = campaign.plant.aero.values.clone();
        for (i, to) in tied.iter().enumerate().filter_map(|(i, t)| t.map(|t| (i, t))) {
            columns[i] = Some(columns[to].filter(|_| tied[to].is_none()).ok_or_else(|| PidError::Unknown {
                what: "tie to a parameter that is not free",
                name: structure.parameters[to].clone(),
            })?);
            parameters[i] = parameters[to];
        }
        let mut bias_columns = [None; CHANNELS];
        if options.angle_biases {
            for (channel, name) in [(4, "Ry_bias_rad"), (5, "Rz_bias_rad")] {
                bias_columns[channel] = Some(names.len());
                names.push(name.to_owned());
            }
        }
        let prior = |p: &Prior| {
            let column = names.iter().position(|n| *n == p.name);
            let fault = |what| PidError::Unknown { what, name: p.name.clone() };
            let wide = p.std > 0.0 && p.std.is_finite() && p.mean.is_finite();
            Ok((
                column.ok_or_else(|| fault("prior of a parameter that is not free"))?,
                p.mean,
                if wide {
                    p.std
                } else {
                    return Err(fault("prior without a positive standard deviation"));
                },
            ))
        };
        let priors = options.priors.iter().map(prior).collect::<Result<_, _>>()?;
        Ok(Self { parameters, columns, biases: [0.0; CHANNELS], bias_columns, errors: None, names, priors })
    }

    /// With all errors of the instruments free beside what is free already, from zero.
    pub(crate) fn with_errors(mut self) -> Self {
        let first = self.free();
        self.errors = Some(Errors { values: [0.0; ERRORS], columns: std::array::from_fn(|k| Some(first + k)) });
        self.names.extend(KINDS.iter().map(|k| k.0.to_owned()));
        self
    }

    /// Holds one more unknown at its value.
    pub(crate) fn hold(&mut self, column: usize) {
        let lower = |c: &mut Option<usize>| {
            *c = match *c {
                Some(k) if k == column => None,
                Some(k) if k > column => Some(k - 1),
                other => other,
            }
        };
        self.columns.iter_mut().for_each(lower);
        self.bias_columns.iter_mut().for_each(lower);
        self.errors.iter_mut().flat_map(|e| &mut e.columns).for_each(lower);
        self.names.remove(column);
        self.priors.retain(|p| p.0 != column);
        self.priors.iter_mut().filter(|p| p.0 > column).for_each(|p| p.0 -= 1);
    }

    pub(crate) fn free(&self) -> usize {
        self.names.len()
    }
    pub(crate) fn columns(&self) -> Columns<'_> {
        Columns {
            parameters: &self.parameters,
            columns: &self.columns,
            biases: self.biases,
            bias_columns: self.bias_columns,
            errors: self.errors,
            free: self.free(),
        }
    }
    /// Values by column.
    pub(crate) fn values(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.free()];
        let errors = self.errors.iter().flat_map(|e| e.columns.iter().zip(&e.values));
        let all = self.columns.iter().zip(&self.parameters).chain(self.bias_columns.iter().zip(&self.biases)).chain(errors);
        all.filter_map(|(c, v)| c.map(|c| (c, *v))).for_each(|(c, v)| values[c] = v);
        values
    }
    /// Free parameters start from these values; tied ones from that of the first of them.
    pub(crate) fn start(&mut self, values: &[f64]) {
        for column in 0..self.free() {
            let mine = |c: &Option<usize>| *c == Some(column);
            let first = self.columns.iter().position(mine).map(|i| values[i]).filter(|v| v.is_finite());
            if let Some(value) = first {
                self.parameters.iter_mut().zip(&self.columns).filter(|(_, c)| mine(c)).for_each(|(p, _)| *p = value);
            }
        }
    }
    pub(crate) fn moved(&self, step: &DVector<f64>, fraction: f64) -> Self {
        let mut moved = self.clone();
        let own = moved.parameters.iter_mut().zip(&self.columns).chain(moved.biases.iter_mut().zip(&self.bias_columns));
        let errors = moved.errors.iter_mut().flat_map(|e| e.values.iter_mut().zip(&e.columns));
        own.chain(errors).for_each(|(v, c)| *v += c.map_or(0.0, |c| fraction * step[c]));
        moved
    }
    /// Column of each prior, distance of its mean from here, and standard deviation.
    pub(crate) fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let values = self.values();
        self.priors.iter().map(move |(c, mean, std)| (*c, mean - values[*c], *std))
    }
    /// Twice the priors' part of the negative log-likelihood.
    pub(crate) fn prior_misfit(&self) -> f64 {
        self.priors().map(|(_, off, std)| (off / std).powi(2)).sum()
    }
}

fn index(structure: &Structure, name: &str) -> Result<usize, PidError> {
    structure
        .index(name)
        .ok_or_else(|| PidError::Unknown { what: "name that is no parameter of the structure", name: name.to_owned() })
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
    pub(crate) residuals: Vec<[Vec<f64>; CHANNELS]>,
}

/// Share of the largest singular value below which a combination of parameters counts as undetermined; as in the regression.
const RANK_TOLERANCE: f64 = 1e-10;
/// What is left to go, by the last two steps' ratio, below this part of every standard error ends the search.
const STEP: f64 = 1e-3;
/// Steps that shrink faster than this are taken to go on so.
const MOST_SHRUNK: f64 = 0.5;
/// The same as [`STEP`] when iterations are used up: where the model is wrong, steps shrink slowly and white noise's errors are too small.
const NEARLY: f64 = 0.1;
/// Smallest noise of a channel, as part of its sensor's: exact data must not divide by zero.
const FLOOR: f64 = 1e-4;
/// What sensors are taken to have where a plant states nothing: thesis Table A.3 (m, rad, m/s).
const TABLE_A_3: [f64; CHANNELS] = [7.5e-4, 7.5e-4, 7.5e-4, 1.09e-3, 1.92e-3, 1.92e-3, 2.57e-3];
/// By how much the misfit may grow in a step: one squared standard deviation. Gaps between pieces are closed at that price, and the
/// noise's variance moves between steps.
const SLACK: f64 = 1.0;
/// Most halvings of a step.
const HALVINGS: u32 = 8;

/// Most likely unknowns of these runs. `nominals` are where trajectories start: the smoothed ones, or a neighbour's solution.
pub(crate) fn solve(runs: &[Run<'_>], unknowns: Unknowns, nominals: Vec<Nominal>, iterations: usize) -> Outcome {
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
    runs: &[Run<'_>],
    unknowns: &Unknowns,
    nominals: &[Nominal],
    std: &[f64; CHANNELS],
) -> Option<Result<Glance, usize>> {
    let (c, mut work) = (unknowns.columns(), Transition::default());
    let linear: Option<Vec<Linearised>> =
        runs.iter().zip(nominals).map(|(run, nominal)| run.linearise(nominal, &c, std, &mut work)).collect();
    Some(Normal::new(&linear?, unknowns).map(|n| Glance { step: n.step, covariance: n.covariance }).map_err(|(column, _)| column))
}

/// [`solve`], from known noise.
pub(crate) fn solve_from(
    runs: &[Run<'_>],
    unknowns: Unknowns,
    nominals: Vec<Nominal>,
    std: [f64; CHANNELS],
    iterations: usize,
) -> Outcome {
    let mut search = Search { runs, unknowns, nominals, std, work: Transition::default() };
    let Some(mut misfits) = search.misfits(&search.unknowns.clone(), &search.nominals.clone()) else {
        return Outcome::Stopped(StopReason::FlightFails);
    };
    let mut pace = Pace::default();
    let (mut first, mut before_last) = (None, 0.0);
    for iteration in 1..=iterations.max(1) {
        let Some(linear) = search.linearise() else { return Outcome::Stopped(StopReason::FlightFails) };
        first.get_or_insert_with(|| sensitivities(&linear, search.unknowns.free()));
        let normal = match Normal::new(&linear, &search.unknowns) {
            Ok(normal) => normal,
            Err((column, rank)) => return Outcome::Undetermined { column, rank },
        };
        let largest = normal.largest_step();
        let whole = pace.next(&normal);
        let Some((next, fraction)) = search.descend(&linear, &normal, &misfits, whole) else {
            if largest < 30.0 * STEP {
                // Rounding is all that is left.
                return search.finish(&normal, first.unwrap_or_default(), misfits, iteration, StopReason::Converged);
            }
            return Outcome::Stopped(StopReason::NoDescent);
        };
        pace.took(fraction);
        misfits = next;
        let before = search.std;
        search.update_noise(&misfits);
        let settled = search.std.iter().zip(before).all(|(a, b)| (a / b).ln().abs() < STEP);
        let gaps: f64 = misfits.iter().map(|m| m.gaps).sum();
        // Steps shrink by a ratio: what is left is their sum.
        let ratio = if fraction > 0.5 { largest / before_last } else { f64::INFINITY };
        let left = if ratio < MOST_SHRUNK { largest * ratio / (1.0 - ratio) } else { largest };
        before_last = largest;
        if left < STEP && settled && fraction >= MOST_SHORT && gaps < 1e-3 {
            return search.finish(&normal, first.unwrap_or_default(), misfits, iteration, StopReason::Converged);
        }
        if iteration >= iterations && largest < NEARLY && gaps < 1e-3 {
            return search.finish(&normal, first.unwrap_or_default(), misfits, iteration, StopReason::Nearly);
        }
    }
    Outcome::Stopped(StopReason::Iterations)
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
fn first_noise(runs: &[Run<'_>]) -> [f64; CHANNELS] {
    let mean = |c: usize| runs.iter().map(|r| r.noise_std[c].powi(2)).sum::<f64>() / runs.len() as f64;
    let floor = floor(runs);
    std::array::from_fn(|c| mean(c).sqrt().max(floor[c]))
}

/// Smallest noise that a channel is given.
pub(crate) fn floor(runs: &[Run<'_>]) -> [f64; CHANNELS] {
    let s = runs[0].craft.plant.sensors;
    let (p, a) = (s.position_std_m, s.pitch_yaw_std_rad);
    let declared = [p, p, p, s.roll_std_rad, a, a, s.wind_std_m_s];
    std::array::from_fn(|c| FLOOR * if declared[c] > 0.0 { declared[c] } else { TABLE_A_3[c] })
}

struct Search<'r, 'a> {
    runs: &'r [Run<'a>],
    unknowns: Unknowns,
    nominals: Vec<Nominal>,
    std: [f64; CHANNELS],
    work: Transition,
}

impl Search<'_, '_> {
    fn linearise(&mut self) -> Option<Vec<Linearised>> {
        let c = self.unknowns.columns();
        let work = &mut self.work;
        self.runs.iter().zip(&self.nominals).map(|(run, nominal)| run.linearise(nominal, &c, &self.std, work)).collect()
    }
    fn misfits(&mut self, unknowns: &Unknowns, nominals: &[Nominal]) -> Option<Vec<Misfit>> {
        let c = unknowns.columns();
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
            let unknowns = self.unknowns.moved(&normal.step, fraction);
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
            let taken = if c < 6 { 2.0 * self.runs.len() as f64 } else { 0.0 };
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
            parameters: self.unknowns.parameters.clone(),
            names: self.unknowns.names.clone(),
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

/// How long steps should be. Where the model is wrong, residuals bend the misfit and Gauss-Newton steps are too short or too long by a
/// factor that two steps along one line tell (Aitken 1926).
#[derive(Default)]
struct Pace {
    /// Last step in standard errors, and the part of it taken.
    last: Option<(DVector<f64>, f64)>,
}

/// Cosine of two steps beyond which they lie on a line; largest lengthening and shortening.
const ON_A_LINE: f64 = 0.9;
const MOST_LONG: f64 = 10.0;
const MOST_SHORT: f64 = 0.25;

impl Pace {
    /// Length of this step in Gauss-Newton's.
    fn next(&mut self, normal: &Normal) -> f64 {
        let step = normal.in_errors();
        let ratio = self.last.as_ref().map_or(0.0, |(last, part)| {
            let (along, square) = (step.dot(last), last.norm_squared());
            // A part of a step leaves what it did not take: 1 − part × (1 − ratio of whole steps).
            let on_a_line = along.abs() > ON_A_LINE * step.norm() * last.norm();
            if on_a_line { 1.0 - (1.0 - along / square) / part } else { 0.0 }
        });
        self.last = Some((step, 1.0));
        let length = if ratio < 1.0 { 1.0 / (1.0 - ratio) } else { MOST_LONG };
        length.clamp(MOST_SHORT, MOST_LONG)
    }
    fn took(&mut self, part: f64) {
        if let Some(last) = &mut self.last {
            last.1 = part;
        }
    }
}

/// The parameters' own least squares, all runs together.
struct Normal {
    step: DVector<f64>,
    covariance: DMatrix<f64>,
    condition: f64,
}

impl Normal {
    /// By singular values of the stacked triangles with columns scaled to unit length; the column that weighs most in what is
    /// undetermined, and the rank, where there is such.
    fn new(linear: &[Linearised], unknowns: &Unknowns) -> Result<Self, (usize, usize)> {
        let free = unknowns.free();
        let rows = linear.len() * (free + 1) + unknowns.priors.len();
        let mut a = DMatrix::zeros(rows.max(free), free);
        let mut b = DVector::zeros(rows.max(free));
        let mut row = 0;
        for l in linear {
            a.view_mut((row, 0), (free + 1, free)).copy_from(&l.information.columns(0, free));
            b.rows_mut(row, free + 1).copy_from(&l.information.column(free));
            row += free + 1;
        }
        for (column, off, std) in unknowns.priors() {
            a[(row, column)] = 1.0 / std;
            b[row] = off / std;
            row += 1;
        }
        let scale: Vec<f64> = a.column_iter().map(|c| c.norm()).collect();
        if let Some(column) = scale.iter().position(|s| !s.is_normal()) {
            return Err((column, scale.iter().filter(|s| s.is_normal()).count()));
        }
        for (mut c, s) in a.column_iter_mut().zip(&scale) {
            c /= *s;
        }
        let svd = a.svd(true, true);
        let singular = &svd.singular_values;
        let largest = singular.max();
        let rank = singular.iter().filter(|s| **s > RANK_TOLERANCE * largest).count();
        let (Some(u), Some(v_t)) = (&svd.u, &svd.v_t) else { return Err((0, 0)) };
        if rank < free {
            return Err((v_t.row(singular.imin()).transpose().iamax(), rank));
        }
        let inverse = DVector::from_iterator(free, singular.iter().map(|s| 1.0 / s));
        let unscale = DMatrix::from_diagonal(&DVector::from_iterator(free, scale.iter().map(|s| 1.0 / s)));
        let root = unscale * v_t.transpose() * DMatrix::from_diagonal(&inverse);
        let step = &root * (u.transpose() * b);
        Ok(Self { step, covariance: &root * root.transpose(), condition: largest / singular.min() })
    }
    /// The step in standard errors.
    fn in_errors(&self) -> DVector<f64> {
        DVector::from_fn(self.step.len(), |i, _| self.step[i] / self.covariance[(i, i)].sqrt())
    }
    /// Largest step in standard errors.
    fn largest_step(&self) -> f64 {
        self.in_errors().amax()
    }
}
