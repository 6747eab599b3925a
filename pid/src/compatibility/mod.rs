//! pid: do the instruments agree with each other, before anything aerodynamic is believed (data compatibility; Klein and Morelli 2006,
//! ch. 10; Jategaonkar 2015, ch. 10). In: a campaign's runs. Out: scale, delay, misalignment and lever arm with intervals, and which of
//! them the runs cannot tell.
//!
//! An aircraft's record has rates and accelerations beside its pose and can be tested by kinematics alone. This one has not. What needs
//! no aerodynamics is the tunnel's own pair, q_W against ½ρV_W² ([`pressure`]). The rest is determined by forces: which way they act against
//! the reported angles, when, and how they change with the vertical speed. So the instruments' errors are put into output error as
//! unknowns beside the declared parameters, initial states and tunnel speed. Their intervals then hold whatever the parameters are,
//! and a structure that lacks something shows here too: what is found is inconsistent with the declared *structure*.

mod pressure;

use crate::PidError;
use crate::information::Correlation;
use crate::interval::{NORMAL_95, ci95};
use crate::output_error::{
    Glance, KINDS, Outcome, PreparedRun, Solved, channel_fits, coloured, not_noise, one_step, ready, run_plants, solve_from,
    unknowns, with_errors,
};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use windfall_model::{Campaign, UnknownId, Unknowns};

pub use pressure::Pressure;

/// Chance of finding a consistent campaign inconsistent: half for each of the two tests.
pub const FALSE_ALARM_RATE: f64 = 0.01;
/// A step of more standard errors than this is taken in full, by iteration; a shorter one is the answer to second order (Le Cam 1956).
const NEAR: f64 = 3.0;
/// Correlation from which two errors are named as a pair.
const CORRELATED: f64 = 0.9;
/// Iterations of the search with the instruments' errors free.
const ITERATIONS: usize = 20;

/// Whether the instruments agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// Nothing was found, at [`FALSE_ALARM_RATE`].
    Consistent,
    /// They do not, and errors of the instruments account for it.
    Inconsistent,
    /// Output error gave no answer, or its residual is not noise with errors of the instruments either: what it finds of them may be
    /// what the declared model lacks.
    Undecided,
}

/// What was examined.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compatibility {
    /// Whether they agree.
    pub verdict: Agreement,
    /// Chance that a consistent campaign is found inconsistent.
    pub false_alarm_rate: f64,
    /// Dynamic pressure against tunnel speed; none where no run has it.
    pub pressure: Option<Pressure>,
    /// The instruments' errors, all estimated together and with the declared parameters; none where they were not examined.
    pub instruments: Option<Instruments>,
    /// Why the trajectories were not examined; none where they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_examined: Option<NotExamined>,
}

/// Why the instruments were not examined by trajectories.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NotExamined {
    /// Output error, which the examination is part of, was not run.
    NotAsked,
    /// Output error gave no answer.
    NoAnswer,
    /// Output error gave one, and none with the instruments' errors as unknowns beside the parameters.
    NoAnswerWithErrors,
}

impl Compatibility {
    /// Of dynamic pressure alone.
    #[must_use]
    pub fn of_pressure(pressure: Pressure) -> Self {
        join(Some(pressure), Err(NotExamined::NotAsked))
    }
}

/// Errors of the instruments by trajectories.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instruments {
    /// Each error, the others free.
    pub errors: Vec<InstrumentError>,
    /// Probability of these or larger ones when there is none.
    pub p_value: f64,
    /// The fewest errors that account for what is inconsistent, the others zero; empty where nothing is.
    pub account: Vec<InstrumentError>,
    /// Probability of what they leave.
    pub account_p_value: f64,
    /// Single errors that would each account for it as well; these runs cannot tell which.
    pub rivals: Vec<InstrumentError>,
    /// Errors that these runs do not tell, taken as zero.
    pub not_told: Vec<String>,
    /// Errors (and declared parameters) whose estimates go together, correlated by 0.9 or more.
    pub correlations: Vec<Correlation>,
    /// Channels whose residual is not noise even so: the declared model lacks something, and what is found may be that.
    pub residual: Vec<String>,
}

impl Instruments {
    /// Adds a delay of V_W, s, that was taken out of the records before they were examined.
    pub fn add_wind_delay(&mut self, by_s: f64) {
        // Where the recorders agree on one clock nothing is left to add to.
        if self.account.iter().all(|e| e.name != "wind_delay_s") {
            return;
        }
        let all = self.errors.iter_mut().chain(&mut self.account).chain(&mut self.rivals);
        for e in all.filter(|e| e.name == "wind_delay_s") {
            e.estimate += by_s;
            e.ci95 = e.ci95.map(|x| x + by_s);
        }
    }
}

/// One error. The sense is that of `model::Sensors`: what is recorded is the truth times 1 + scale, a delay ago, turned by the
/// misalignment about body x, y, z, moved by the lever arm in body axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InstrumentError {
    /// Name, with its unit.
    pub name: String,
    /// SI unit; `-` for none.
    pub unit: String,
    /// Estimate.
    pub estimate: f64,
    /// Standard error.
    pub std_error: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
}

impl InstrumentError {
    fn new(kind: usize, estimate: f64, variance: f64) -> Self {
        let std_error = variance.max(0.0).sqrt();
        Self {
            name: KINDS[kind].0.to_owned(),
            unit: KINDS[kind].1.to_owned(),
            estimate,
            std_error,
            ci95: ci95(estimate, std_error),
        }
    }
}

/// Examines a campaign's tunnel instruments alone: no model, no flight.
#[must_use]
pub fn pressure(campaign: &Campaign) -> Option<Pressure> {
    pressure::examine(campaign)
}

/// Examines a campaign from scratch: as [`crate::output_error::identify`] with `compatibility`, without its parameters.
///
/// # Errors
/// As [`crate::output_error::identify`].
pub fn compatibility(campaign: &Campaign) -> Result<Compatibility, PidError> {
    let campaign = &campaign.with_effects_in_plant();
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let unknowns = unknowns(campaign, &crate::output_error::EstimateOptions::default())?;
    let nominals = runs.iter().map(|r| r.smoothed.clone()).collect();
    let solved = match crate::output_error::solve(&runs, unknowns, nominals, ITERATIONS) {
        Outcome::Solved(solved) => instruments(&runs, &solved).ok_or(NotExamined::NoAnswerWithErrors),
        _ => Err(NotExamined::NoAnswer),
    };
    Ok(join(pressure(campaign), solved))
}

/// Both tests as one verdict.
pub(crate) fn join(pressure: Option<Pressure>, examined: Result<Instruments, NotExamined>) -> Compatibility {
    let not_examined = examined.as_ref().err().copied();
    let instruments = examined.ok();
    let each = 0.5 * FALSE_ALARM_RATE;
    let verdict = match &instruments {
        _ if pressure.as_ref().is_some_and(|p| p.p_value < each) => Agreement::Inconsistent,
        Some(i) if i.residual.is_empty() && i.p_value < each => Agreement::Inconsistent,
        Some(i) if i.residual.is_empty() => Agreement::Consistent,
        _ => Agreement::Undecided,
    };
    Compatibility { verdict, false_alarm_rate: FALSE_ALARM_RATE, pressure, instruments, not_examined }
}

/// Errors of the instruments beside a solution's parameters. `None` where the search with them does not end.
pub(crate) fn instruments(runs: &[PreparedRun<'_>], solved: &Solved) -> Option<Instruments> {
    let mut unknowns = with_errors(solved.unknowns.clone());
    let mut not_told = Vec::new();
    let (step, mut covariance) = loop {
        let first = solved.unknowns.free();
        match one_step(runs, &unknowns, &solved.nominals, &solved.solution.noise_std)? {
            Err(column) if column < first => return None,
            Err(column) => {
                not_told.push(unknowns.name(column).to_owned());
                unknowns.hold(column);
            }
            Ok(Glance { step, covariance }) => {
                let (ratio, column) = worst(&kinds(&unknowns), &covariance)?;
                if ratio > 1.0 {
                    not_told.push(unknowns.name(column).to_owned());
                    unknowns.hold(column);
                } else {
                    break (step, covariance);
                }
            }
        }
    };
    let determined = kinds(&unknowns);
    let coloured_before = !not_noise(&channel_fits(runs, solved)).is_empty();
    let mut residual = Vec::new();
    let mut values: Vec<f64> = determined.iter().map(|k| step[k.1]).collect();
    if is_far(&step, &covariance) || coloured_before {
        let found = solve_from(runs, unknowns.clone(), solved.nominals.clone(), solved.solution.noise_std, ITERATIONS);
        let Outcome::Solved(found) = found else { return None };
        values = determined.iter().map(|k| found.solution.estimates[k.1]).collect();
        residual = not_noise(&channel_fits(runs, &found));
        covariance = if residual.is_empty() {
            found.solution.covariance.clone()
        } else {
            coloured(runs, &found).unwrap_or_else(|| found.solution.covariance.clone())
        };
    }
    Some(judged(&determined, &values, &covariance, &unknowns.names(), not_told, residual))
}

/// Kind and column of each error that is free.
fn kinds(unknowns: &Unknowns) -> Vec<(usize, usize)> {
    let place = |name| unknowns.position(UnknownId::Nuisance(name));
    let column = |(kind, k): (usize, &(&'static str, &str, f64))| Some((kind, unknowns.all[place(k.0)?].column()?));
    KINDS.iter().enumerate().filter_map(column).collect()
}

/// Half of the widest interval over what its kind can be at most, and its column: above one the runs do not tell that error.
fn worst(determined: &[(usize, usize)], covariance: &DMatrix<f64>) -> Option<(f64, usize)> {
    let beyond = |&(kind, column): &(usize, usize)| (NORMAL_95 * covariance[(column, column)].sqrt() / KINDS[kind].2, column);
    determined.iter().map(beyond).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Whether a step leaves what is near in any column.
fn is_far(step: &DVector<f64>, covariance: &DMatrix<f64>) -> bool {
    step.iter().zip(covariance.diagonal().iter()).any(|(d, v)| d.abs() > NEAR * v.sqrt())
}

fn judged(
    determined: &[(usize, usize)],
    values: &[f64],
    covariance: &DMatrix<f64>,
    names: &[String],
    not_told: Vec<String>,
    residual: Vec<String>,
) -> Instruments {
    let m = determined.len();
    let own = DMatrix::from_fn(m, m, |i, j| covariance[(determined[i].1, determined[j].1)]);
    let estimate = DVector::from_column_slice(values);
    let joint = Joint::new(estimate, own);
    let errors =
        determined.iter().enumerate().map(|(i, k)| InstrumentError::new(k.0, values[i], joint.covariance[(i, i)])).collect();
    let (p_value, mut chosen, limit) = (joint.left(&[]), Vec::new(), 0.5 * FALSE_ALARM_RATE);
    while joint.left(&chosen) < limit && chosen.len() < m {
        let with = |k: usize| joint.square_left(&chosen.iter().copied().chain([k]).collect::<Vec<_>>());
        let open = (0..m).filter(|k| !chosen.contains(k));
        chosen.extend(open.min_by(|a, b| with(*a).total_cmp(&with(*b))));
    }
    let of = |set: &[usize]| -> Vec<InstrumentError> {
        let (values, variance) = joint.alone(set);
        set.iter().enumerate().map(|(i, &k)| InstrumentError::new(determined[k].0, values[i], variance[(i, i)])).collect()
    };
    let rivals = match chosen[..] {
        [one] => (0..m).filter(|k| *k != one && joint.left(&[*k]) >= limit).flat_map(|k| of(&[k])).collect(),
        _ => Vec::new(),
    };
    let mut correlations = Vec::new();
    for (i, (_, a)) in determined.iter().enumerate() {
        for b in (0..determined[0].1).chain(determined[..i].iter().map(|k| k.1)) {
            let correlation = covariance[(*a, b)] / (covariance[(*a, *a)] * covariance[(b, b)]).sqrt();
            if correlation.abs() >= CORRELATED {
                correlations.push(Correlation { first: names[b].clone(), second: names[*a].clone(), correlation });
            }
        }
    }
    correlations.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    let account_p_value = joint.left(&chosen);
    Instruments { errors, p_value, account: of(&chosen), account_p_value, rivals, not_told, correlations, residual }
}

/// Estimates with their covariance, as a quadratic likelihood.
struct Joint {
    estimate: DVector<f64>,
    covariance: DMatrix<f64>,
    information: DMatrix<f64>,
}

impl Joint {
    fn new(estimate: DVector<f64>, covariance: DMatrix<f64>) -> Self {
        // Columns of unit variance: errors in m, s and rad differ by decades.
        let scale = covariance.diagonal().map(|v| 1.0 / v.sqrt());
        let unit = DMatrix::from_diagonal(&scale);
        let inner =
            (&unit * &covariance * &unit).pseudo_inverse(1e-13).unwrap_or_else(|_| DMatrix::zeros(scale.len(), scale.len()));
        Self { estimate, covariance, information: &unit * inner * &unit }
    }
    /// Estimates of these when the others are zero, with their covariance.
    fn alone(&self, set: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
        if set.is_empty() {
            return (DVector::zeros(0), DMatrix::zeros(0, 0));
        }
        let own = DMatrix::from_fn(set.len(), set.len(), |i, j| self.information[(set[i], set[j])]);
        let pull = &self.information * &self.estimate;
        let pull = DVector::from_iterator(set.len(), set.iter().map(|k| pull[*k]));
        let covariance = own.pseudo_inverse(1e-14).unwrap_or_else(|_| DMatrix::zeros(set.len(), set.len()));
        (&covariance * pull, covariance)
    }
    /// What these leave of the estimates' square over their covariance.
    fn square_left(&self, set: &[usize]) -> f64 {
        let mut left = self.estimate.clone();
        let (values, _) = self.alone(set);
        set.iter().zip(values.iter()).for_each(|(k, v)| left[*k] -= v);
        left.dot(&(&self.information * &left))
    }
    /// Probability of as much when it is noise.
    fn left(&self, set: &[usize]) -> f64 {
        let degrees = self.estimate.len() - set.len();
        ChiSquared::new(degrees as f64).map_or(1.0, |d| d.sf(self.square_left(set).max(0.0)))
    }
}

#[cfg(test)]
mod tests;
