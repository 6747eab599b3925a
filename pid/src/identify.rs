//! pid: from a campaign to its parameters. In: records and a declared plant. Out: estimates per data set, with warnings.

use crate::PidError;
use crate::coefficients::{Row, coefficients};
use crate::identification::{CoefficientFit, DataSet, Estimate, Identification};
use crate::regress::{Fit, Outcome, Series, ols};
use crate::smooth::{Smoother, TABLE_3_1_HZ, smooth};
use crate::states::states;
use windfall_model::{Campaign, Coefficient, Data, Plant, Record, Use};

/// How to identify.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The thesis to the letter: Fourier smoothing with Table 3.1's cutoffs, C_N,T from the root of squares, white standard errors.
    Thesis,
    /// Equation error: spline smoothing, C_Y and C_N together, standard errors for coloured residuals.
    EquationError,
}

impl Method {
    /// Name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Thesis => "thesis",
            Self::EquationError => "equation-error",
        }
    }
    /// The smoother that belongs to the method.
    #[must_use]
    pub const fn smoother(self) -> Smoother {
        match self {
            Self::Thesis => Smoother::Thesis { cutoffs_hz: TABLE_3_1_HZ },
            Self::EquationError => Smoother::Auto,
        }
    }
}

/// One run, ready for regression.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRows {
    /// Run name.
    pub name: String,
    /// Kind of run.
    pub kind: String,
    /// Coefficients and flow variables.
    pub rows: Vec<Row>,
    /// Factor of each row.
    pub weight: Vec<f64>,
    /// Sample interval, s.
    pub interval_s: f64,
}

/// A record through smoothing, states and coefficients, for the plant as it acts in this run.
///
/// # Errors
/// As [`smooth`] and [`states`].
pub fn process(name: &str, kind: &str, record: &Record, plant: &Plant, smoother: &Smoother) -> Result<RunRows, PidError> {
    let s = smooth(record, smoother)?;
    let rows = coefficients(&states(&s, plant)?, plant);
    Ok(RunRows { name: name.to_owned(), kind: kind.to_owned(), rows, interval_s: s.interval_s, weight: s.weight })
}

/// Identifies a campaign's declared parameters on the runs it has for that: on each kind of run alone and on all, `combined`.
///
/// # Errors
/// No usable run, a faulty record, fewer samples than parameters, or nothing that can be estimated. A parameter that the runs do
/// not excite is left out and named in the warnings.
pub fn identify(campaign: &Campaign, method: Method) -> Result<Identification, PidError> {
    identify_with(campaign, method, &method.smoother())
}

/// [`identify`] with another smoother.
///
/// # Errors
/// As [`identify`].
pub fn identify_with(campaign: &Campaign, method: Method, smoother: &Smoother) -> Result<Identification, PidError> {
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
    let mut warnings = Vec::new();
    let data_sets = sets(&runs)
        .into_iter()
        .map(|(name, members)| data_set(&name, &members, campaign, method, &mut warnings))
        .collect::<Result<_, _>>()?;
    Ok(Identification { method: method.name().to_owned(), data_sets, warnings })
}

/// Each kind in order of appearance, then all.
fn sets(runs: &[RunRows]) -> Vec<(String, Vec<&RunRows>)> {
    let mut sets: Vec<(String, Vec<&RunRows>)> = Vec::new();
    for run in runs {
        match sets.iter_mut().find(|(kind, _)| *kind == run.kind) {
            Some((_, members)) => members.push(run),
            None => sets.push((run.kind.clone(), vec![run])),
        }
    }
    sets.push(("combined".to_owned(), runs.iter().collect()));
    sets
}

/// Coefficients that share all their parameters, and those parameters: what one regression is about.
#[derive(Clone, Debug, PartialEq)]
struct Group {
    coefficients: Vec<Coefficient>,
    parameters: Vec<usize>,
}

impl Group {
    fn label(&self) -> &'static str {
        self.coefficients.last().map_or("", |c| c.name())
    }
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
            None => groups.push(Group { coefficients: vec![coefficient], parameters }),
        }
    }
    groups
}

fn data_set(
    name: &str,
    runs: &[&RunRows],
    campaign: &Campaign,
    method: Method,
    warnings: &mut Vec<String>,
) -> Result<DataSet, PidError> {
    let mut set = DataSet {
        name: name.to_owned(),
        runs: runs.iter().map(|r| r.name.clone()).collect(),
        parameters: Vec::new(),
        fits: Vec::new(),
        condition_number: 1.0,
        n_samples: runs.iter().map(|r| r.rows.len()).sum(),
    };
    for mut group in groups(&campaign.plant, &campaign.declared) {
        let Some(fit) = regress(&mut group, runs, campaign, method, name, warnings)? else { continue };
        report(&mut set, &group, &fit, campaign, method, warnings);
    }
    if set.parameters.is_empty() {
        return Err(PidError::NothingToEstimate { campaign: campaign.name.clone() });
    }
    Ok(set)
}

/// Fits a group, leaving out what the data do not determine.
fn regress(
    group: &mut Group,
    runs: &[&RunRows],
    campaign: &Campaign,
    method: Method,
    set: &str,
    warnings: &mut Vec<String>,
) -> Result<Option<Fit>, PidError> {
    while !group.parameters.is_empty() {
        let series = stack(group, runs, campaign, method);
        let outcome = ols(&series).map_err(|e| match e {
            PidError::TooFewSamples { samples, needed, .. } => {
                PidError::TooFewSamples { what: format!("data set {set}, coefficient {}", group.label()), samples, needed }
            }
            other => other,
        })?;
        match outcome {
            Outcome::Fit(fit) => return Ok(Some(*fit)),
            Outcome::Deficient { column, rank } => {
                let parameter = group.parameters.remove(column);
                warnings.push(format!(
                    "data set {set}, coefficient {}: {} is not excited (rank {rank} of {}); it is left out: add a run with larger \
                     angles or rates, or do not declare it",
                    group.label(),
                    campaign.plant.aero.structure.parameters[parameter],
                    group.parameters.len() + 1,
                ));
            }
        }
    }
    Ok(None)
}

/// Seconds over which residuals may be correlated: two periods of the slowest pitching that the tunnel allows (1 Hz).
const CORRELATED_S: f64 = 2.0;

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
fn stack(group: &Group, runs: &[&RunRows], campaign: &Campaign, method: Method) -> Vec<Series> {
    let mut all = Vec::new();
    for run in runs {
        let parts: Vec<Series> = group.coefficients.iter().map(|&c| series(group, run, campaign, c)).collect();
        match method {
            Method::Thesis => all.push(total(&parts)),
            Method::EquationError => all.extend(parts.into_iter().map(|s| Series {
                weight: run.weight.clone(),
                correlated_samples: (CORRELATED_S / run.interval_s).round() as usize,
                ..s
            })),
        }
    }
    all
}

/// One coefficient of one run; what effects add to the plant and what undeclared parameters hold is taken off the response.
fn series(group: &Group, run: &RunRows, campaign: &Campaign, coefficient: Coefficient) -> Series {
    let aero = &campaign.plant.aero;
    let mine = || aero.structure.contributions.iter().filter(|k| k.coefficient == coefficient);
    let fixed = |row: &Row| -> f64 {
        let held = mine().filter(|k| !group.parameters.contains(&k.parameter) && !campaign.declared[k.parameter]);
        let held: f64 = held.map(|k| aero.values[k.parameter] * k.term.value(&row.flow)).sum();
        let extra: f64 = aero.extra.iter().filter(|(c, _, _)| *c == coefficient).map(|(_, v, t)| v * t.value(&row.flow)).sum();
        held + extra
    };
    let regressor = |p: &usize| -> Vec<f64> {
        run.rows.iter().map(|row| mine().filter(|k| k.parameter == *p).map(|k| k.term.value(&row.flow)).sum()).collect()
    };
    Series {
        regressors: group.parameters.iter().map(regressor).collect(),
        response: run.rows.iter().map(|row| row.exp_origin[coefficient as usize] - fixed(row)).collect(),
        ..Series::default()
    }
}

/// Root of the sum of squares over a group's coefficients, of response and of each regressor: for C_Y and C_N that is C_N,T on
/// sin α_T and sin³ α_T (eqs 4.2, 4.5). A single coefficient stays as it is.
fn total(parts: &[Series]) -> Series {
    if let [only] = parts {
        return only.clone();
    }
    let root = |columns: Vec<&[f64]>| -> Vec<f64> {
        (0..columns[0].len()).map(|i| columns.iter().map(|c| c[i] * c[i]).sum::<f64>().sqrt()).collect()
    };
    let parameters = parts[0].regressors.len();
    Series {
        regressors: (0..parameters).map(|p| root(parts.iter().map(|s| s.regressors[p].as_slice()).collect())).collect(),
        response: root(parts.iter().map(|s| s.response.as_slice()).collect()),
        ..Series::default()
    }
}

fn report(set: &mut DataSet, group: &Group, fit: &Fit, campaign: &Campaign, method: Method, warnings: &mut Vec<String>) {
    let white = Fit::std_errors(&fit.covariance_white);
    let honest = if method == Method::Thesis { white.clone() } else { Fit::std_errors(&fit.covariance) };
    let half = if method == Method::Thesis { 1.96 } else { fit.t95() };
    for (i, &p) in group.parameters.iter().enumerate() {
        let (estimate, std_error) = (fit.estimate[i], honest[i]);
        let name = campaign.plant.aero.structure.parameters[p].clone();
        if std_error > estimate.abs() {
            warnings.push(format!(
                "data set {}, coefficient {}: {name} = {estimate:.3e} has a standard error of {std_error:.3e}, more than itself: these \
                 runs hardly excite it; use runs with larger angles or rates, or do not declare it",
                set.name,
                group.label()
            ));
        }
        set.parameters.push(Estimate {
            coefficient: group.label().to_owned(),
            name,
            estimate,
            std_error,
            rse_percent: (100.0 * std_error / estimate.abs()).min(f64::MAX),
            ci95: [estimate - half * std_error, estimate + half * std_error],
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
