//! pid: equation error, each coefficient regressed by itself. In: records and a declared plant. Out: estimates per data set, with warnings.

mod noise;

use crate::PidError;
use crate::coefficients::{CoefficientRow, coefficients_of};
use crate::identification::{ALL_RUNS, CoefficientFit, DataSet, Estimate, Identification, Refused};
use crate::interval::{either_side, relative_percent};
use crate::regress::{Colour, Driven, PreparedColumns, Refusal, RegressionFit, RegressionOutcome, RegressionSeries, fit_under};
use crate::smooth::{Smoother, smooth};
use std::cell::OnceCell;
use windfall_model::{Aero, Campaign, Coefficient, Data, Factor, Plant, Record, Term, Use, VARIABLES, Variable};

/// One run, ready for regression.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRows {
    /// Run name.
    pub name: String,
    /// Kind of run.
    pub kind: String,
    /// Coefficients and flow variables.
    pub rows: Vec<CoefficientRow>,
    /// Factor of each row.
    pub weight: Vec<f64>,
    /// Sample interval, s.
    pub interval_s: f64,
    /// Bandwidth of the smoothing, Hz: the largest of the channels'.
    pub bandwidth_hz: f64,
}

impl RunRows {
    /// Times from the first row, s, between which no row is faded ([`faded`]): before and after, the smoother hangs on one side, and the noise
    /// of its derivatives is many times that inside. `None` where the ends meet.
    #[must_use]
    pub fn interior_s(&self) -> Option<[f64; 2]> {
        let fade_s = FADE_PERIODS / self.bandwidth_hz;
        let end_s = self.interval_s * (self.rows.len().max(1) - 1) as f64 - fade_s;
        (end_s > fade_s).then_some([fade_s, end_s])
    }
}

/// A record through smoothing, states and coefficients, for the plant as it acts in this run.
///
/// # Errors
/// As [`smooth`] and [`states`].
pub fn process(name: &str, kind: &str, record: &Record, plant: &Plant, smoother: &Smoother) -> Result<RunRows, PidError> {
    let s = smooth(record, smoother)?;
    let rows = coefficients_of(&s, plant)?;
    let bandwidth_hz = s.bandwidth_hz.iter().fold(0.0, |a: f64, b| a.max(*b));
    Ok(RunRows { name: name.to_owned(), kind: kind.to_owned(), rows, weight: s.weight, interval_s: s.interval_s, bandwidth_hz })
}

/// What is made of C_Y and C_N, which share their parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lateral {
    /// Both in one regression, errors for coloured residuals.
    Joint,
    /// The root of the sum of their squares, white errors: the thesis.
    RootOfSquares,
}

/// A method that regresses each coefficient by itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EquationError {
    pub(crate) name: &'static str,
    pub(crate) lateral: Lateral,
    /// Whether regressors are taken as exact; else as carrying the instruments' noise, and what drives body and residual alike is looked
    /// for.
    pub(crate) exact: bool,
}

/// The thesis to the letter.
pub(crate) const THESIS: EquationError = EquationError { name: "thesis", lateral: Lateral::RootOfSquares, exact: true };
/// Side and normal force together, regressors taken as exact: where a search starts.
pub(crate) const JOINT: EquationError = EquationError { name: "equation-error", lateral: Lateral::Joint, exact: true };
/// The same with intervals that hold, or reasons why there are none.
pub(crate) const HONEST: EquationError = EquationError { exact: false, ..JOINT };

impl EquationError {
    /// A campaign's declared parameters on each kind of run alone and on all, or on all alone.
    pub(crate) fn identify(
        self,
        campaign: &Campaign,
        smoother: &Smoother,
        combined_only: bool,
    ) -> Result<Identification, PidError> {
        let runs = processed(campaign, smoother)?;
        let draws = if self.exact { Vec::new() } else { drawn(campaign, &runs)? };
        let flows: Vec<FlowSeries<'_>> = runs.iter().map(FlowSeries::new).collect();
        let noisy: Vec<Vec<FlowSeries<'_>>> = draws.iter().map(|d| d.rows.iter().map(FlowSeries::new).collect()).collect();
        let steps: Vec<f64> = draws.iter().map(|d| d.step).collect();
        let prepared: Vec<Group> = groups(&campaign.plant, &campaign.declared)
            .into_iter()
            .map(|g| g.prepared(&flows, campaign, self.lateral).with_noise(&noisy, &steps, campaign))
            .collect();
        let mut warnings = Vec::new();
        let mut sets = sets(&runs);
        if combined_only {
            sets = sets.pop().into_iter().collect();
        }
        let data_sets = sets
            .into_iter()
            .map(|(name, members)| {
                DataSetWork { name: &name, members: &members, runs: &runs, campaign }.solve(&prepared, &mut warnings)
            })
            .collect::<Result<_, _>>()?;
        Ok(Identification {
            envelopes: Vec::new(),
            method: self.name.to_owned(),
            data_sets,
            warnings,
            reason: None,
            smoothing: smoother.words(),
            identifiability: None,
            compatibility: None,
        })
    }
}

/// Every run to identify on, ready for regression.
pub(crate) fn processed(campaign: &Campaign, smoother: &Smoother) -> Result<Vec<RunRows>, PidError> {
    let mut runs = Vec::new();
    for (i, run) in campaign.runs.iter().enumerate().filter(|(_, r)| r.used == Use::Identify) {
        let Data::Tunnel(record) = &run.data else {
            return Err(PidError::PointMass { campaign: campaign.name.clone(), run: run.name.clone() });
        };
        let plant = campaign.plant_for(&campaign.plant, i);
        runs.push(process(&run.name, &run.kind, record, &plant, smoother)?);
    }
    if runs.is_empty() {
        return Err(PidError::NoRuns { campaign: campaign.name.clone() });
    }
    Ok(runs)
}

/// Rows of every run to identify on under draws of its instruments' noise.
fn drawn(campaign: &Campaign, runs: &[RunRows]) -> Result<Vec<noise::Draws>, PidError> {
    let used = campaign.runs.iter().enumerate().filter(|(_, r)| r.used == Use::Identify);
    let tunnel = used.filter_map(|(i, r)| match &r.data {
        Data::Tunnel(record) => Some((i, record)),
        Data::Point(_) => None,
    });
    let one =
        |(rows, (i, record)): (&RunRows, (usize, &Record))| noise::draws(rows, record, &campaign.plant_for(&campaign.plant, i));
    runs.iter().zip(tunnel).map(one).collect()
}

/// Indices of runs: each kind in order of appearance, then all.
fn sets(runs: &[RunRows]) -> Vec<(String, Vec<usize>)> {
    let mut sets: Vec<(String, Vec<usize>)> = Vec::new();
    for (i, run) in runs.iter().enumerate() {
        match sets.iter_mut().find(|(kind, _)| *kind == run.kind) {
            Some((_, members)) => members.push(i),
            None => sets.push((run.kind.clone(), vec![i])),
        }
    }
    sets.push((ALL_RUNS.to_owned(), (0..runs.len()).collect()));
    sets
}

/// Coefficients that share all their parameters, and those parameters: what one regression is about.
#[derive(Clone, Debug)]
struct Group {
    coefficients: Vec<Coefficient>,
    parameters: Vec<usize>,
    /// For each run, the series that it contributes.
    series: Vec<Vec<PreparedColumns>>,
}

impl Group {
    fn label(&self) -> &'static str {
        self.coefficients.last().map_or("", |c| c.name())
    }
    fn prepared(mut self, flows: &[FlowSeries<'_>], campaign: &Campaign, lateral: Lateral) -> Self {
        let one = |flow| run_series(&self, flow, campaign, lateral).into_iter().map(PreparedColumns::new).collect();
        self.series = flows.iter().map(one).collect();
        self
    }
    /// With what draws of the noise make of each run's series.
    fn with_noise(mut self, noisy: &[Vec<FlowSeries<'_>>], steps: &[f64], campaign: &Campaign) -> Self {
        for (i, (flows, step)) in noisy.iter().zip(steps).enumerate() {
            let draws: Vec<Vec<RegressionSeries>> =
                flows.iter().map(|f| run_series(&self, f, campaign, Lateral::Joint)).collect();
            let own = std::mem::take(&mut self.series[i]);
            let of = |part: usize| draws.iter().map(move |d| d[part].clone());
            self.series[i] = own.into_iter().enumerate().map(|(part, p)| p.with_noise(of(part), *step)).collect();
        }
        self
    }
}

/// Coefficient (as in results) and name of each parameter that an identification of this plant looks for.
#[must_use]
pub fn estimated(plant: &Plant, declared: &[bool]) -> Vec<(&'static str, String)> {
    let name = |g: &Group, p: &usize| (g.label(), plant.aero.structure.parameters[*p].clone());
    groups(plant, declared).iter().flat_map(|g| g.parameters.iter().map(|p| name(g, p)).collect::<Vec<_>>()).collect()
}

fn groups(plant: &Plant, declared: &[bool]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for coefficient in Coefficient::ALL {
        let mut parameters: Vec<usize> = plant
            .aero
            .structure
            .contributions
            .iter()
            .filter(|k| k.coefficient == coefficient && declared[k.parameter])
            .map(|k| k.parameter)
            .collect();
        parameters.sort_unstable();
        parameters.dedup();
        if parameters.is_empty() {
            continue;
        }
        match groups.iter_mut().find(|g| g.parameters == parameters) {
            Some(g) => g.coefficients.push(coefficient),
            None => groups.push(Group { coefficients: vec![coefficient], parameters, series: Vec::new() }),
        }
    }
    groups
}

/// One data set on its way to a result.
#[derive(Clone, Copy)]
struct DataSetWork<'a> {
    name: &'a str,
    members: &'a [usize],
    runs: &'a [RunRows],
    campaign: &'a Campaign,
}

impl<'a> DataSetWork<'a> {
    fn solve(self, groups: &[Group], warnings: &mut Vec<String>) -> Result<DataSet, PidError> {
        let mut set = DataSet {
            name: self.name.to_owned(),
            runs: self.members.iter().map(|&i| self.runs[i].name.clone()).collect(),
            parameters: Vec::new(),
            fits: Vec::new(),
            condition_number: 1.0,
            n_samples: self.members.iter().map(|&i| self.runs[i].rows.len()).sum(),
            covariance: Vec::new(),
            curves: Vec::new(),
            held: Vec::new(),
            constants: Vec::new(),
            effects: Vec::new(),
            refused: Vec::new(),
            envelope: None,
        };
        let mut fits = Vec::new();
        for group in groups {
            fits.push(self.regress(group, None, warnings)?);
        }
        // What drives the body drives all of its motion, also that of a coefficient whose own residual does not show it.
        let drive = fits.iter().flatten().find_map(|(_, fit)| fit.driven);
        for (group, found) in groups.iter().zip(fits) {
            let found = match (found, drive) {
                (Some((_, fit)), Some(_)) if fit.driven.is_none() => self.regress(group, drive, &mut Vec::new())?,
                (found, _) => found,
            };
            if let Some((columns, fit)) = found {
                self.report(&mut set, group, &columns, &fit, warnings);
            }
        }
        if set.parameters.is_empty() && set.refused.is_empty() {
            return Err(PidError::NothingToEstimate { campaign: self.campaign.name.clone() });
        }
        Ok(set)
    }

    fn parameter(self, group: &Group, column: usize) -> &'a str {
        &self.campaign.plant.aero.structure.parameters[group.parameters[column]]
    }

    /// Fits a group, leaving out what the data do not determine; which columns are left, and their fit.
    fn regress(
        self,
        group: &Group,
        drive: Option<Driven>,
        warnings: &mut Vec<String>,
    ) -> Result<Option<(Vec<usize>, RegressionFit)>, PidError> {
        let series: Vec<&PreparedColumns> = self.members.iter().flat_map(|&i| &group.series[i]).collect();
        let mut columns: Vec<usize> = (0..group.parameters.len()).collect();
        while !columns.is_empty() {
            let outcome = fit_under(&series, &columns, drive).map_err(|e| match e {
                PidError::TooFewSamples { samples, needed, .. } => PidError::TooFewSamples {
                    what: format!("data set {}, coefficient {}", self.name, group.label()),
                    samples,
                    needed,
                },
                other => other,
            })?;
            match outcome {
                RegressionOutcome::Fit(fit) => return Ok(Some((columns, *fit))),
                RegressionOutcome::Deficient { column, rank } => {
                    warnings.push(format!(
                        "data set {}, coefficient {}: {} is not excited (rank {rank} of {}); it is left out: add a run with larger \
                         angles or rates, or do not declare it",
                        self.name,
                        group.label(),
                        self.parameter(group, columns[column]),
                        columns.len(),
                    ));
                    columns.remove(column);
                }
            }
        }
        Ok(None)
    }

    fn report(self, set: &mut DataSet, group: &Group, columns: &[usize], fit: &RegressionFit, warnings: &mut Vec<String>) {
        let white = RegressionFit::std_errors(&fit.covariance_white);
        let honest = RegressionFit::std_errors(&fit.covariance);
        let before = set.parameters.len();
        let kept: Vec<usize> = (0..columns.len()).filter(|i| fit.refused[*i].is_none()).collect();
        for row in &mut set.covariance {
            row.extend(kept.iter().map(|_| 0.0));
        }
        for &i in &kept {
            let own = kept.iter().map(|&j| fit.covariance[(i, j)]);
            set.covariance.push(std::iter::repeat_n(0.0, before).chain(own).collect());
        }
        self.say(set, group, columns, fit, warnings);
        for i in kept {
            let (estimate, std_error) = (fit.estimate[i], honest[i]);
            let name = self.parameter(group, columns[i]);
            if std_error > estimate.abs() {
                warnings.push(format!(
                    "data set {}, coefficient {}: {name} = {estimate:.3e} has a standard error of {std_error:.3e}, more than itself: \
                     these runs hardly excite it; use runs with larger angles or rates, or do not declare it",
                    self.name,
                    group.label()
                ));
            }
            set.parameters.push(Estimate {
                coefficient: group.label().to_owned(),
                name: name.to_owned(),
                estimate,
                std_error,
                rse_percent: relative_percent(std_error, estimate),
                ci95: either_side(estimate, fit.half_width[i], std_error),
                std_error_white: white[i],
            });
        }
        set.fits.push(CoefficientFit {
            coefficient: group.label().to_owned(),
            r2: fit.r2,
            residual_std: fit.s2.sqrt(),
            residual_whiteness_p: fit.whiteness_p,
        });
        set.condition_number = set.condition_number.max(fit.condition);
    }
}

impl DataSetWork<'_> {
    /// What is not estimated and why, and what else than noise is in the residual.
    fn say(self, set: &mut DataSet, group: &Group, columns: &[usize], fit: &RegressionFit, warnings: &mut Vec<String>) {
        let here = format!("data set {}, coefficient {}", self.name, group.label());
        if let Some(d) = fit.driven {
            warnings.push(format!(
                "{here}: the residual has {:.1} times the power of the instruments' noise: something else moves the body as well, gusts or what the model lacks; estimated by what the body did {} diameters of flow before, which is less precise: try --method filter-error, or windfall close",
                d.ratio, d.lag
            ));
        }
        for (&column, refusal) in columns.iter().zip(&fit.refused) {
            let Some(refusal) = refusal else { continue };
            let (name, reason) = (self.parameter(group, column), refusal.words());
            warnings.push(format!("{here}: {name} is not estimated: {reason}"));
            set.refused.push(Refused { coefficient: group.label().to_owned(), name: name.to_owned(), reason });
        }
    }
}

impl Refusal {
    /// The reason, and what to do.
    fn words(self) -> String {
        match self {
            Self::Noise { signal_to_noise } if signal_to_noise > 0.0 => format!(
                "its regressor is mostly the instruments' noise (signal-to-noise ratio {signal_to_noise:.2}); use --method output-error, or a run with larger angles or rates"
            ),
            Self::Noise { .. } => "its regressor is no more than the instruments' noise; use --method output-error, or a run with larger angles or rates"
                .to_owned(),
            Self::Weak { strength } => format!(
                "what moves the body is also in the residual, and the motion before tells too little of its regressor (F = {strength:.1}, 10 needed); use --method filter-error, or a longer run or one with larger angles or rates"
            ),
        }
    }
}

/// What one run adds to a group's regression.
fn run_series(group: &Group, flow: &FlowSeries<'_>, campaign: &Campaign, lateral: Lateral) -> Vec<RegressionSeries> {
    let run = flow.run;
    let part = |&c: &Coefficient| series(&group.parameters, flow, &campaign.plant.aero, &campaign.declared, c);
    let parts: Vec<RegressionSeries> = group.coefficients.iter().map(part).collect();
    if lateral == Lateral::RootOfSquares {
        return vec![total(&parts)];
    }
    let (weight, residuals) = (faded(run), Colour::Weighted(cosines(run)));
    parts.into_iter().map(|s| RegressionSeries { weight: weight.clone(), residuals, ..s }).collect()
}

/// Cosines up to the bandwidth of the smoothing: beyond it the rows carry nothing.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number, clamped to the samples")]
pub(crate) fn cosines(run: &RunRows) -> usize {
    let n = run.rows.len();
    ((2.0 * run.interval_s * n as f64 * run.bandwidth_hz) as usize).clamp(1, n)
}

/// Fade of the rows at both ends, in periods of the smoothing's bandwidth (4 knot intervals): there the noise of derivatives is
/// largest and does not cancel between neighbours.
const FADE_PERIODS: f64 = 3.0;

/// Row factors of a run, faded in and out as sin².
pub(crate) fn faded(run: &RunRows) -> Vec<f64> {
    let n = run.rows.len();
    let fade = (FADE_PERIODS / (run.bandwidth_hz * run.interval_s)).min(0.5 * n as f64);
    let factor = |i: usize| ((i.min(n - 1 - i) as f64 + 0.5) / fade).min(1.0);
    let faded = |(i, w): (usize, &f64)| match factor(i) {
        1.0 => *w,
        x => w * (std::f64::consts::FRAC_PI_2 * x).sin().powi(2),
    };
    run.weight.iter().enumerate().map(faded).collect()
}

/// A run and its flow variables, each in a series of its own where a term asks for it.
struct FlowSeries<'a> {
    run: &'a RunRows,
    variables: [OnceCell<Vec<f64>>; VARIABLES],
}

impl<'a> FlowSeries<'a> {
    fn new(run: &'a RunRows) -> Self {
        Self { run, variables: [const { OnceCell::new() }; VARIABLES] }
    }
    fn variable(&self, v: Variable) -> &[f64] {
        self.variables[v as usize].get_or_init(|| self.run.rows.iter().map(|row| row.flow.get(v)).collect())
    }
    /// A term at every sample.
    fn term(&self, term: &Term) -> Vec<f64> {
        let mut products = vec![term.scale; self.run.rows.len()];
        for factor in &term.factors {
            match *factor {
                Factor::Power(v, 1) => products.iter_mut().zip(self.variable(v)).for_each(|(p, x)| *p *= x),
                Factor::Power(v, 2) => products.iter_mut().zip(self.variable(v)).for_each(|(p, x)| *p *= x * x),
                Factor::Power(v, 3) => products.iter_mut().zip(self.variable(v)).for_each(|(p, x)| *p *= x * x * x),
                other => products.iter_mut().zip(&self.run.rows).for_each(|(p, row)| *p *= other.value(&row.flow)),
            }
        }
        products
    }
    /// Sum of terms, each times a number.
    fn sum<'t>(&self, terms: impl Iterator<Item = (f64, &'t Term)>) -> Vec<f64> {
        let mut sums = vec![0.0; self.run.rows.len()];
        for (k, term) in terms {
            sums.iter_mut().zip(self.term(term)).for_each(|(sum, x)| *sum += k * x);
        }
        sums
    }
}

/// One coefficient of one run; what effects add to the plant and what undeclared parameters hold is taken off the response.
fn series(
    parameters: &[usize],
    flow: &FlowSeries<'_>,
    aero: &Aero,
    declared: &[bool],
    coefficient: Coefficient,
) -> RegressionSeries {
    let mine: Vec<_> = aero.structure.contributions.iter().filter(|k| k.coefficient == coefficient).collect();
    let held = mine.iter().filter(|k| !declared[k.parameter]).map(|k| (aero.values[k.parameter], &k.term));
    let extra = aero.extra.iter().filter(|(c, _, _)| *c == coefficient).map(|(_, v, t)| (*v, t));
    let fixed = flow.sum(held.chain(extra).filter(|(v, _)| *v != 0.0));
    let regressor = |p: &usize| flow.sum(mine.iter().filter(|k| k.parameter == *p).map(|k| (1.0, &k.term)));
    RegressionSeries {
        regressors: parameters.iter().map(regressor).collect(),
        response: flow.run.rows.iter().zip(fixed).map(|(row, fixed)| row.exp_origin[coefficient as usize] - fixed).collect(),
        ..RegressionSeries::default()
    }
}

/// Root of the sum of squares over a group's coefficients, of response and of each regressor: for C_Y and C_N that is C_N,T on
/// sin α_T and sin³ α_T (eqs 4.2, 4.5). A single coefficient stays as it is.
fn total(parts: &[RegressionSeries]) -> RegressionSeries {
    if let [only] = parts {
        return only.clone();
    }
    let root = |columns: Vec<&[f64]>| -> Vec<f64> {
        (0..columns[0].len()).map(|i| columns.iter().map(|c| c[i] * c[i]).sum::<f64>().sqrt()).collect()
    };
    let parameters = parts[0].regressors.len();
    RegressionSeries {
        regressors: (0..parameters).map(|p| root(parts.iter().map(|s| s.regressors[p].as_slice()).collect())).collect(),
        response: root(parts.iter().map(|s| s.response.as_slice()).collect()),
        ..RegressionSeries::default()
    }
}

#[cfg(test)]
pub(crate) mod tests;
