//! pid: the search for parameters and turbulence of largest likelihood. In: a campaign. Out: the contract's identification.

use super::filter::{Filter, Pass, Seen};
use crate::PidError;
use crate::equations::Transition;
use crate::identifiability::of_runs;
use crate::identification::{CoefficientFit, DataSet, Estimate, Identification, NORMAL_95};
use crate::output_error::{
    CHANNELS, Columns, NOT_NOISE, Options, Run, StopReason, Unknowns, estimates, kinds, low_frequency_p, ready, run_plants,
    spread,
};
use nalgebra::{DMatrix, DVector};
use realfft::RealFftPlanner;
use windfall_model::{Campaign, Turbulence};

const METHOD: &str = "filter-error";
/// Names of what describes the gusts; their logarithms are sought.
const GUSTS: [&str; 4] = ["axial_rms_m_s", "lateral_rms_m_s", "axial_scale_m", "lateral_scale_m"];
/// Difference of a logarithm.
const STEP: f64 = 1e-3;
/// Scale at which the search starts, three model diameters (m).
const START_SCALE_M: f64 = 0.6;
/// Sizes tried for a start, m/s: from 1 % of the tunnel speed by this factor, up or down, within these bounds.
const START_SIZE_M_S: f64 = 0.08;
const SIZE_FACTOR: f64 = 3.0;
const SIZES_M_S: std::ops::Range<f64> = 8e-4..2.0;
/// A scale that the data do not tell stays near its start: prior standard deviation of its logarithm, so 0.08 to 4 m are likely.
const SCALE_PRIOR: f64 = 1.0;
/// Largest step of a logarithm.
const TRUST: f64 = 0.7;
/// By how much twice the log-likelihood may fall in a step: the score leaves out how the gain depends on the parameters.
const SLACK: f64 = 0.1;
/// Levenberg's share of the information's diagonal: at first, and where no step helps any more.
const FIRST_DAMPING: f64 = 0.1;
const LAST_DAMPING: f64 = 1e4;
/// By how much the damping also shortens the whole step.
const SHORTENING: f64 = 0.1;
/// Size of a gust that is not there, m/s.
pub(crate) const NONE_M_S: f64 = 1e-6;
/// A gust whose logarithm has a larger standard error cannot be told from none.
const UNTOLD: f64 = 0.5;
/// Where gusts explain the data, five to eight iterations are enough; where something else is missing, more do not help.
const MOST_ITERATIONS: usize = 15;
/// The search ends when no unknown moves by more than this part of its standard error.
const SETTLED: f64 = 0.02;

/// Identifies a campaign's declared parameters together with its turbulence.
///
/// # Errors
/// As [`crate::output_error::identify`].
pub fn identify(campaign: &Campaign, options: &Options) -> Result<Identification, PidError> {
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let mut warnings = Vec::new();
    let (combined, point) = likeliest(campaign, options, &runs, &mut warnings)?;
    let identifiability = if point.unknowns.free() > 0 { of_runs(&runs, &point.unknowns) } else { None };
    let mut data_sets = Vec::new();
    let alone = if options.combined_only { Vec::new() } else { kinds(&plants) };
    for (kind, members) in alone {
        match solve(campaign, &kind, &runs, &members, point.clone(), options, &mut warnings) {
            Ok((set, _)) => data_sets.push(set),
            Err(e) => warnings.push(format!("data set {kind}: left out: {e}")),
        }
    }
    data_sets.push(combined);
    Ok(Identification { method: METHOD.to_owned(), data_sets, warnings, reason: None, identifiability })
}

/// Columns and response of one run.
pub(crate) type Linear = (DMatrix<f64>, DVector<f64>);

/// Innovations of every run about the likeliest point, as a regression on the parameters of a wider structure: over their standard
/// deviation, rows of unit variance, white at the truth. Response and columns such that a parameter's least-squares estimate is its value
/// itself; the second number is that of the point.
pub(crate) fn linearised(campaign: &Campaign, wide: &windfall_model::Aero) -> Result<Vec<Linear>, PidError> {
    let options = Options { combined_only: true, ..Options::default() };
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let (_, point) = likeliest(campaign, &options, &runs, &mut Vec::new())?;
    let mut wider = campaign.clone();
    wider.plant.aero = wide.clone();
    wider.declared = vec![true; wide.values.len()];
    for (i, name) in campaign.plant.aero.structure.parameters.iter().enumerate() {
        if let Some(k) = wide.structure.index(name) {
            wider.plant.aero.values[k] = point.unknowns.parameters[i];
        }
    }
    let plants = run_plants(&wider)?;
    let wide_runs = ready(&wider, &plants)?;
    let unknowns = Unknowns::new(&wider, &options)?;
    let (c, mut work) = (unknowns.columns(), Transition::default());
    let noise = noise_of(&runs.iter().collect::<Vec<_>>());
    let flown = |run: &Run<'_>| {
        let seen = Filter::new(run, noise).run(&point.turbulence(), &c, &mut work)?;
        let weight: Vec<f64> = seen.pass.variance.iter().map(|v| v.sqrt().recip()).collect();
        let x = DMatrix::from_fn(weight.len(), c.free, |row, j| seen.by_parameter[row * c.free + j] * weight[row]);
        let innovation = DVector::from_fn(weight.len(), |row, _| seen.pass.innovation[row] * weight[row]);
        let y = &x * DVector::from_column_slice(c.parameters) - innovation;
        Some((x, y))
    };
    wide_runs.iter().map(flown).collect::<Option<_>>().ok_or_else(|| PidError::NoAnswer {
        campaign: campaign.name.clone(),
        set: "combined".to_owned(),
        method: METHOD,
        reason: StopReason::FlightFails.words(),
    })
}

/// Noise of each channel, root mean square over runs.
fn noise_of(runs: &[&Run<'_>]) -> [f64; CHANNELS] {
    std::array::from_fn(|c| (runs.iter().map(|r| r.noise_std[c].powi(2)).sum::<f64>() / runs.len() as f64).sqrt().max(1e-9))
}

/// All runs together, from where regression says.
fn likeliest(
    campaign: &Campaign,
    options: &Options,
    runs: &[Run<'_>],
    warnings: &mut Vec<String>,
) -> Result<(DataSet, Point), PidError> {
    let mut unknowns = Unknowns::new(campaign, options)?;
    // Regression gives where to start; where it cannot, the declared values do.
    if let Ok(first) = crate::identify::identify_with(campaign, crate::Method::EquationError, &crate::smooth::Smoother::Auto)
        && let Some(set) = first.data_set("combined")
    {
        unknowns.start(&set.values(&campaign.plant.aero.structure, &unknowns.parameters));
    }
    let gusts = [START_SIZE_M_S, START_SIZE_M_S, START_SCALE_M, START_SCALE_M].map(f64::ln);
    let start = Point { unknowns, gusts, untold: [None; 2] };
    let all: Vec<usize> = (0..runs.len()).collect();
    solve(campaign, "combined", runs, &all, start, options, warnings)
}

/// Where the search is.
#[derive(Clone)]
struct Point {
    unknowns: Unknowns,
    /// Logarithms of rms (m/s) and scale (m).
    gusts: [f64; 4],
    /// Axial and lateral gusts that cannot be told from none: the rms at which that was found, m/s.
    untold: [Option<f64>; 2],
}

impl Point {
    fn turbulence(&self) -> Turbulence {
        let [axial_rms_m_s, lateral_rms_m_s, axial_scale_m, lateral_scale_m] = self.gusts.map(f64::exp);
        Turbulence { axial_rms_m_s, lateral_rms_m_s, axial_scale_m, lateral_scale_m }
    }
    fn moved(&self, step: &DVector<f64>) -> Self {
        let free = self.unknowns.free();
        Self {
            unknowns: self.unknowns.moved(&step.rows(0, free).into_owned(), 1.0),
            gusts: std::array::from_fn(|k| self.gusts[k] + step[free + k]),
            untold: self.untold,
        }
    }
    /// Takes gusts that the data cannot tell from none for none; true where there was one.
    fn give_up_untold(&mut self, covariance: &DMatrix<f64>) -> bool {
        let free = self.unknowns.free();
        let mut any = false;
        for k in 0..2 {
            let error = covariance[(free + k, free + k)].sqrt();
            if self.untold[k].is_none() && error > UNTOLD {
                self.untold[k] = Some(self.gusts[k].exp());
                (self.gusts[k], self.gusts[2 + k]) = (NONE_M_S.ln(), START_SCALE_M.ln());
                any = true;
            }
        }
        any
    }
    /// True for size and scale of gusts that are none.
    fn gone(&self, index: usize) -> bool {
        let free = self.unknowns.free();
        index >= free && self.untold[(index - free) % 2].is_some()
    }
    fn varied(&self, k: usize, by: f64) -> Turbulence {
        let mut other = self.clone();
        other.gusts[k] += by;
        other.turbulence()
    }
}

/// Likelihood at a point: twice its logarithm, score and information.
struct Local {
    log_likelihood2: f64,
    score: DVector<f64>,
    information: DMatrix<f64>,
    /// Whitened innovations of every run, by channel.
    whitened: Vec<[Vec<f64>; CHANNELS]>,
    /// Sum of squared innovations by channel.
    left: [f64; CHANNELS],
    samples: f64,
}

fn solve(
    campaign: &Campaign,
    name: &str,
    runs: &[Run<'_>],
    members: &[usize],
    mut point: Point,
    options: &Options,
    warnings: &mut Vec<String>,
) -> Result<(DataSet, Point), PidError> {
    let noise = noise_of(&members.iter().map(|&i| &runs[i]).collect::<Vec<_>>());
    let filters: Vec<Filter<'_, '_>> = members.iter().map(|&i| Filter::new(&runs[i], noise)).collect();
    let stopped = |stop: StopReason| PidError::NoAnswer {
        campaign: campaign.name.clone(),
        set: name.to_owned(),
        method: METHOD,
        reason: stop.words(),
    };
    let mut work = Transition::default();
    if name == "combined" {
        likeliest_size(&filters, &mut point, &mut work);
    }
    let mut now = local(&filters, &point, &mut work).ok_or_else(|| stopped(StopReason::FlightFails))?;
    let mut damping = FIRST_DAMPING;
    for _ in 0..options.iterations.min(MOST_ITERATIONS) {
        let free = point.unknowns.free();
        let covariance = inverse(&now.information).map_err(|column| PidError::NoAnswer {
            campaign: campaign.name.clone(),
            set: name.to_owned(),
            method: METHOD,
            reason: if column < free { UNEXCITED } else { StopReason::NoDescent.words() },
        })?;
        if point.give_up_untold(&covariance) {
            now = local(&filters, &point, &mut work).ok_or_else(|| stopped(StopReason::FlightFails))?;
            continue;
        }
        let step = &covariance * &now.score;
        if (0..step.len()).all(|i| step[i].abs() < SETTLED * covariance[(i, i)].sqrt()) {
            report_gusts(name, &point, &covariance, warnings);
            return Ok((data_set(campaign, name, &filters, &point, &now, &covariance, warnings), point));
        }
        loop {
            let step = damped(&now, free, damping).unwrap_or_else(|| step.clone());
            let there = (step.rows(free, 4).amax() < TRUST).then(|| point.moved(&step)).and_then(|next| {
                let there = local(&filters, &next, &mut work)?;
                Some((next, there)).filter(|(_, t)| t.log_likelihood2 > now.log_likelihood2 - SLACK)
            });
            if let Some(there) = there {
                (point, now) = there;
                damping *= 0.1;
                break;
            }
            damping *= 5.0;
            if damping > LAST_DAMPING {
                return Err(stopped(StopReason::NoDescent));
            }
        }
    }
    Err(stopped(StopReason::Iterations))
}

/// Starts from the likeliest size of gust, equal along and across the stream, found by climbing from the first of them.
fn likeliest_size(filters: &[Filter<'_, '_>], point: &mut Point, work: &mut Transition) {
    let mut value = |size: f64| {
        let [.., axial, lateral] = point.gusts;
        let gusts = [size.ln(), size.ln(), axial, lateral];
        log_likelihood2(filters, &Point { gusts, ..point.clone() }, work).unwrap_or(f64::NEG_INFINITY)
    };
    let mut size = START_SIZE_M_S;
    let mut best = value(size);
    for factor in [SIZE_FACTOR, 1.0 / SIZE_FACTOR] {
        let mut climbed = false;
        while SIZES_M_S.contains(&(size * factor)) {
            let next = value(size * factor);
            if next <= best {
                break;
            }
            (size, best, climbed) = (size * factor, next, true);
        }
        if climbed {
            break;
        }
    }
    (point.gusts[0], point.gusts[1]) = (size.ln(), size.ln());
}

/// Twice the log-likelihood alone.
fn log_likelihood2(filters: &[Filter<'_, '_>], point: &Point, work: &mut Transition) -> Option<f64> {
    let c = point.unknowns.columns();
    let none = vec![None; c.columns.len()];
    let without = Columns { columns: &none, bias_columns: [None; CHANNELS], free: 0, ..c };
    let mut sum = 0.0;
    for filter in filters {
        sum += filter.run(&point.turbulence(), &without, work)?.pass.log_likelihood2();
    }
    Some(sum).filter(|s| s.is_finite())
}

const UNEXCITED: &str = "a parameter is not excited by these runs: add a run with larger angles or rates, or do not declare it";

/// Scoring step with Levenberg's damping of the gusts, whose logarithms bend the likelihood; what is left after shortening the whole.
fn damped(now: &Local, free: usize, damping: f64) -> Option<DVector<f64>> {
    let mut m = now.information.clone();
    (free..free + 4).for_each(|k| m[(k, k)] *= 1.0 + damping);
    let covariance = inverse(&m).ok()?;
    Some(covariance * &now.score / (1.0 + SHORTENING * damping))
}

/// Inverse by Cholesky of the matrix scaled to unit diagonal, or the column that spoils it.
fn inverse(m: &DMatrix<f64>) -> Result<DMatrix<f64>, usize> {
    let scale: Vec<f64> = m.diagonal().iter().map(|d| d.sqrt()).collect();
    if let Some(column) = scale.iter().position(|s| !s.is_normal()) {
        return Err(column);
    }
    let scaled = DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / (scale[i] * scale[j]));
    let inverse = scaled.cholesky().ok_or(0_usize)?.inverse();
    Ok(DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}

fn local(filters: &[Filter<'_, '_>], point: &Point, work: &mut Transition) -> Option<Local> {
    let c = point.unknowns.columns();
    let none = vec![None; c.columns.len()];
    let without = Columns { columns: &none, bias_columns: [None; CHANNELS], free: 0, ..c };
    let (free, base) = (c.free, point.turbulence());
    let count = free + 4;
    let mut out = Local {
        log_likelihood2: 0.0,
        score: DVector::zeros(count),
        information: DMatrix::zeros(count, count),
        whitened: Vec::new(),
        left: [0.0; CHANNELS],
        samples: 0.0,
    };
    for filter in filters {
        let seen = filter.run(&base, &c, work)?;
        let varied = [
            filter.again(&point.varied(0, STEP), &seen),
            filter.again(&point.varied(1, STEP), &seen),
            filter.run(&point.varied(2, STEP), &without, work)?.pass,
            filter.run(&point.varied(3, STEP), &without, work)?.pass,
        ];
        out.add(&seen, &varied, free);
    }
    for (column, off, std) in point.unknowns.priors() {
        out.log_likelihood2 -= (off / std).powi(2);
        out.score[column] += off / (std * std);
        out.information[(column, column)] += std.powi(-2);
    }
    for k in 2..4 {
        let off = point.gusts[k] - START_SCALE_M.ln();
        out.log_likelihood2 -= (off / SCALE_PRIOR).powi(2);
        out.score[free + k] -= off / SCALE_PRIOR.powi(2);
        out.information[(free + k, free + k)] += SCALE_PRIOR.powi(-2);
    }
    for index in (0..count).filter(|i| point.gone(*i)) {
        // What describes a gust that has vanished stays where it is.
        out.score[index] = 0.0;
        out.information.row_mut(index).fill(0.0);
        out.information.column_mut(index).fill(0.0);
        out.information[(index, index)] = 1.0;
    }
    (out.log_likelihood2.is_finite() && out.score.iter().all(|v| v.is_finite())).then_some(out)
}

impl Local {
    /// Adds a run: `−Σ ν²/s + ln s`, its score and its expected information (Harvey 1989, eq. 3.4.70).
    fn add(&mut self, seen: &Seen, varied: &[Pass; 4], free: usize) {
        let pass = &seen.pass;
        self.log_likelihood2 += pass.log_likelihood2();
        let mut whitened: [Vec<f64>; CHANNELS] = Default::default();
        // Slopes of an innovation in its own standard deviations.
        let mut slopes = DVector::zeros(free + 4);
        for (row, (innovation, variance)) in pass.innovation.iter().zip(&pass.variance).enumerate() {
            let std = variance.sqrt();
            let e = innovation / std;
            for j in 0..free {
                slopes[j] = seen.by_parameter[row * free + j] / std;
            }
            let mut bends = [0.0; 4];
            for (k, v) in varied.iter().enumerate() {
                slopes[free + k] = (v.innovation[row] - innovation) / (STEP * std);
                bends[k] = (v.variance[row] / variance).ln() / STEP;
            }
            self.score.axpy(-e, &slopes, 1.0);
            self.information.syger(1.0, &slopes, &slopes, 1.0);
            for k in 0..4 {
                self.score[free + k] += 0.5 * (e * e - 1.0) * bends[k];
                (0..=k).for_each(|j| self.information[(free + k, free + j)] += 0.5 * bends[k] * bends[j]);
            }
            whitened[row % CHANNELS].push(e);
            self.left[row % CHANNELS] += innovation * innovation;
        }
        self.information.fill_upper_triangle_with_lower_triangle();
        self.samples += (pass.innovation.len() / CHANNELS) as f64;
        self.whitened.push(whitened);
    }
}

fn report_gusts(name: &str, point: &Point, covariance: &DMatrix<f64>, warnings: &mut Vec<String>) {
    let free = point.unknowns.free();
    if point.untold.iter().all(Option::is_some) {
        warnings.push(format!("data set {name}: no turbulence that these runs could tell: --method output-error says more"));
    }
    for k in 2..4 {
        if covariance[(free + k, free + k)].sqrt() > 0.5 * SCALE_PRIOR && !point.gone(free + k) {
            warnings.push(format!("data set {name}: {} is told by its prior more than by the data", GUSTS[k]));
        }
    }
}

fn data_set(
    campaign: &Campaign,
    name: &str,
    filters: &[Filter<'_, '_>],
    point: &Point,
    now: &Local,
    covariance: &DMatrix<f64>,
    warnings: &mut Vec<String>,
) -> DataSet {
    let mut planner = RealFftPlanner::new();
    let intervals: Vec<f64> = filters.iter().map(|f| f.run.interval_s).collect();
    let fits: Vec<CoefficientFit> = (0..CHANNELS)
        .map(|c| {
            let series: Vec<&[f64]> = now.whitened.iter().map(|w| w[c].as_slice()).collect();
            let total: f64 = filters.iter().map(|f| spread(f.run.record.channels()[c])).sum();
            CoefficientFit {
                coefficient: crate::smooth::CHANNELS[c].to_owned(),
                r2: if total > 0.0 { 1.0 - now.left[c] / total } else { 0.0 },
                residual_std: (now.left[c] / now.samples).sqrt(),
                residual_whiteness_p: low_frequency_p(&series, &intervals, &mut planner),
            }
        })
        .collect();
    // The innovations of the tunnel speed test the smoothness that it is taken to have, not the declared model.
    let bad: Vec<&str> = fits[..6]
        .iter()
        .filter(|f| f.residual_whiteness_p < NOT_NOISE / CHANNELS as f64)
        .map(|f| f.coefficient.as_str())
        .collect();
    if !bad.is_empty() {
        warnings.push(format!(
            "data set {name}: the residual is not noise in {}, turbulence allowed for: the declared model lacks another effect; intervals \
             say nothing of its bias: try windfall close",
            bad.join(", ")
        ));
    }
    let mut parameters = estimates(campaign, &point.unknowns, covariance, covariance);
    parameters.extend(gust_estimates(point, covariance));
    let information = covariance.clone();
    let eigen = {
        let d: Vec<f64> = information.diagonal().iter().map(|v| v.sqrt()).collect();
        DMatrix::from_fn(d.len(), d.len(), |i, j| information[(i, j)] / (d[i] * d[j])).symmetric_eigenvalues()
    };
    DataSet {
        name: name.to_owned(),
        runs: filters.iter().map(|f| f.run.name.to_owned()).collect(),
        parameters,
        fits,
        condition_number: (eigen.max() / eigen.min().max(f64::MIN_POSITIVE)).sqrt(),
        n_samples: filters.iter().map(|f| f.run.record.len()).sum(),
        held: Vec::new(),
    }
}

/// Size and scale of the gusts under the word `turbulence`; intervals are those of the logarithms.
fn gust_estimates(point: &Point, covariance: &DMatrix<f64>) -> Vec<Estimate> {
    let free = point.unknowns.free();
    let one = |(k, name): (usize, &&str)| {
        if let Some(limit) = point.untold[k % 2] {
            return (k < 2).then(|| Estimate {
                coefficient: "turbulence".to_owned(),
                name: (*name).to_owned(),
                estimate: 0.0,
                std_error: limit,
                rse_percent: f64::MAX,
                ci95: [0.0, NORMAL_95 * limit],
                std_error_white: limit,
            });
        }
        let (estimate, relative) = (point.gusts[k].exp(), covariance[(free + k, free + k)].max(0.0).sqrt());
        Some(Estimate {
            coefficient: "turbulence".to_owned(),
            name: (*name).to_owned(),
            estimate,
            std_error: estimate * relative,
            rse_percent: 100.0 * relative,
            ci95: [estimate * (-NORMAL_95 * relative).exp(), estimate * (NORMAL_95 * relative).exp()],
            std_error_white: estimate * relative,
        })
    };
    GUSTS.iter().enumerate().filter_map(one).collect()
}
