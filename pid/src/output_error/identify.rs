//! pid: a campaign by output error. In: campaign, options. Out: the contract's identification, each kind of run alone and combined.

use super::problem::{Outcome, Solved, solve};
use super::residual::{ChannelFit, channel_fits, coloured};
use super::run::{Nominal, PreparedRun};
use super::unknowns::{EstimateOptions, unknowns};
use crate::PidError;
use crate::compatibility::{self, NotExamined};
use crate::identifiability::{examine, of_runs};
use crate::identification::{ALL_RUNS, CoefficientFit, DataSet, Estimate, Identification, in_unit_of};
use crate::interval::{ci95, relative_percent};
use crate::not_noise::{NotNoise, is_noise};
use crate::{Method, SearchKind};
use nalgebra::DMatrix;
use windfall_model::{Campaign, Coefficient, Data, Plant, Unknowns, Use};

/// Identifies a campaign's declared parameters by output error.
///
/// # Errors
/// A faulty record, no usable run, a plant that cannot be integrated, options that name what is not there, or a search that ended
/// without an answer ([`PidError::NoAnswer`] says why).
pub fn identify(campaign: &Campaign, options: &EstimateOptions) -> Result<Identification, PidError> {
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let free = unknowns(campaign, options)?;
    let mut warnings = Vec::new();
    let all: Vec<usize> = (0..runs.len()).collect();
    let start = runs.iter().map(|r| r.smoothed.clone()).collect();
    let work = SetWork { campaign, runs: &runs, kinds: &plants, options };
    let combined = work.solve(ALL_RUNS, &all, free.clone(), start, &mut warnings)?;
    // The search began by asking just this, unless it had to hold something.
    let first = &combined.1.first;
    let identifiability = if first.ncols() == free.free() {
        Some(examine(first.clone(), &free.names(), &free.values()))
    } else {
        of_runs(&runs, &free)
    };
    let compatibility = options.compatibility.then(|| {
        let examined = compatibility::instruments(&runs, &combined.1).ok_or(NotExamined::NoAnswerWithErrors);
        compatibility::join(compatibility::pressure(campaign), examined)
    });
    let mut data_sets = Vec::new();
    let alone = if options.combined_only { Vec::new() } else { kinds(&plants) };
    for (kind, members) in alone {
        let nominals = members.iter().map(|&i| combined.1.nominals[i].clone()).collect();
        // Every kind starts from what all runs gave, and ends where its own likelihood is largest.
        let mut free = free.clone();
        free.all.iter_mut().zip(&combined.1.unknowns.all).for_each(|(u, found)| u.at = found.at);
        match work.solve(&kind, &members, free, nominals, &mut warnings) {
            Ok((set, _)) => data_sets.push(set),
            Err(e) => warnings.push(format!("data set {kind}: left out: {e}")),
        }
    }
    data_sets.push(combined.0);
    Ok(Identification {
        envelopes: Vec::new(),
        method: Method::OutputError.name().to_owned(),
        data_sets,
        warnings,
        reason: None,
        smoothing: None,
        identifiability,
        compatibility,
    })
}

/// Plant, index and kind of every run to identify on.
pub(crate) struct RunPlant {
    index: usize,
    kind: String,
    plant: Plant,
}

pub(crate) fn run_plants(campaign: &Campaign) -> Result<Vec<RunPlant>, PidError> {
    let used = campaign.runs.iter().enumerate().filter(|(_, r)| r.used == Use::Identify);
    let plants: Vec<RunPlant> = used
        .map(|(index, r)| RunPlant { index, kind: r.kind.clone(), plant: campaign.plant_for(&campaign.plant, index) })
        .collect();
    if plants.is_empty() { Err(PidError::NoRuns { campaign: campaign.name.clone() }) } else { Ok(plants) }
}

pub(crate) fn ready<'a>(campaign: &'a Campaign, plants: &'a [RunPlant]) -> Result<Vec<PreparedRun<'a>>, PidError> {
    let one = |p: &'a RunPlant| {
        let run = &campaign.runs[p.index];
        let Data::Tunnel(record) = &run.data else {
            return Err(PidError::PointMass { campaign: campaign.name.clone(), run: run.name.clone() });
        };
        PreparedRun::new(&run.name, record, &p.plant)
    };
    plants.iter().map(one).collect()
}

/// Members of each kind, in order of appearance.
pub(crate) fn kinds(plants: &[RunPlant]) -> Vec<(String, Vec<usize>)> {
    let mut kinds: Vec<(String, Vec<usize>)> = Vec::new();
    for (i, p) in plants.iter().enumerate() {
        match kinds.iter_mut().find(|(kind, _)| *kind == p.kind) {
            Some((_, members)) => members.push(i),
            None => kinds.push((p.kind.clone(), vec![i])),
        }
    }
    kinds
}

struct SetWork<'w, 'a> {
    campaign: &'w Campaign,
    runs: &'w [PreparedRun<'a>],
    kinds: &'w [RunPlant],
    options: &'w EstimateOptions,
}

impl SetWork<'_, '_> {
    fn solve(
        &self,
        name: &str,
        members: &[usize],
        mut unknowns: Unknowns,
        nominals: Vec<Nominal>,
        warnings: &mut Vec<String>,
    ) -> Result<(DataSet, Box<Solved>), PidError> {
        debug_assert_eq!(self.kinds.len(), self.runs.len(), "a plant for every run");
        let runs: Vec<PreparedRun<'_>> = members.iter().map(|&i| self.runs[i].clone()).collect();
        let stopped = |stop| PidError::NoAnswer {
            campaign: self.campaign.name.clone(),
            set: name.to_owned(),
            search: SearchKind::OutputError,
            stop,
        };
        loop {
            if unknowns.free() == 0 {
                return Err(PidError::NothingToEstimate { campaign: self.campaign.name.clone() });
            }
            let found = solve(&runs, unknowns.clone(), nominals.clone(), self.options.iterations);
            match found {
                Outcome::Solved(solved) => return Ok((self.report(name, &runs, &solved, warnings), solved)),
                Outcome::Undetermined { column, rank } => {
                    warnings.push(format!(
                        "data set {name}: {} is not excited (rank {rank} of {}); it is held at its declared value: add a run with \
                         larger angles or rates, or do not declare it",
                        unknowns.name(column),
                        unknowns.free()
                    ));
                    unknowns.hold(column);
                }
                Outcome::Stopped(stop) => return Err(stopped(stop)),
            }
        }
    }

    fn report(&self, name: &str, runs: &[PreparedRun<'_>], solved: &Solved, warnings: &mut Vec<String>) -> DataSet {
        let fits = channel_fits(runs, solved);
        let fits: Vec<CoefficientFit> = fits.into_iter().map(fit).collect();
        let left = NotNoise::of(&fits);
        let covariance = if left.is_none() {
            solved.solution.covariance.clone()
        } else {
            warnings.push(format!(
                "data set {name}: the residual is {}: {}; intervals are widened for the residual's colour but say nothing of bias: try \
                 --method filter-error, and windfall close",
                left.clause(),
                left.meaning()
            ));
            self::coloured(runs, solved).unwrap_or_else(|| solved.solution.covariance.clone())
        };
        let parameters = estimates(self.campaign, &solved.unknowns, &covariance, &solved.solution.covariance);
        DataSet {
            refused: Vec::new(),
            envelope: None,
            name: name.to_owned(),
            runs: runs.iter().map(|r| r.name.to_owned()).collect(),
            covariance: aligned(self.campaign, &solved.unknowns, &covariance, &parameters),
            curves: Vec::new(),
            parameters,
            fits,
            condition_number: solved.solution.condition,
            n_samples: runs.iter().map(|r| r.record.len()).sum(),
            held: Vec::new(),
            constants: Vec::new(),
            effects: Vec::new(),
        }
    }
}

/// Channels whose residual is not noise, with their probability.
pub(crate) fn not_noise(fits: &[ChannelFit]) -> Vec<String> {
    let bad = fits.iter().filter(|f| !is_noise(f.whiteness_p));
    bad.map(|f| format!("{} (p = {:.1e})", f.channel, f.whiteness_p)).collect()
}

fn fit(f: ChannelFit) -> CoefficientFit {
    CoefficientFit {
        coefficient: f.channel.to_owned(),
        r2: f.r2,
        residual_std: in_unit_of(f.channel, f.residual_std),
        residual_whiteness_p: f.whiteness_p,
    }
}

/// Covariance in the order of the estimates; those that are no parameter of the structure keep their own variance.
pub(crate) fn aligned(
    campaign: &Campaign,
    unknowns: &Unknowns,
    covariance: &DMatrix<f64>,
    parameters: &[Estimate],
) -> Vec<Vec<f64>> {
    let structure = &campaign.plant.aero.structure;
    let column = |p: &Estimate| structure.index(&p.name).and_then(|i| unknowns.all[i].column());
    let columns: Vec<Option<usize>> = parameters.iter().map(column).collect();
    let entry = |i: usize, j: usize| match (columns[i], columns[j]) {
        (Some(a), Some(b)) => covariance[(a, b)],
        _ if i == j => parameters[i].std_error.powi(2),
        _ => 0.0,
    };
    (0..columns.len()).map(|i| (0..columns.len()).map(|j| entry(i, j)).collect()).collect()
}

/// Estimates under every coefficient on which a parameter acts: side and normal force as one, as the regression has them.
pub(crate) fn estimates(
    campaign: &Campaign,
    unknowns: &Unknowns,
    covariance: &DMatrix<f64>,
    white: &DMatrix<f64>,
) -> Vec<Estimate> {
    let structure = &campaign.plant.aero.structure;
    let mut out: Vec<Estimate> = Vec::new();
    for coefficient in Coefficient::ALL {
        for (i, name) in structure.parameters.iter().enumerate() {
            let Some(column) = unknowns.all[i].column() else { continue };
            let acts = structure.contributions.iter().any(|k| k.coefficient == coefficient && k.parameter == i);
            let label = if coefficient == Coefficient::CY { Coefficient::CN.name() } else { coefficient.name() };
            if !acts || out.iter().any(|e| e.coefficient == label && e.name == *name) {
                continue;
            }
            let estimate = unknowns.all[i].value();
            let std_error = covariance[(column, column)].max(0.0).sqrt();
            out.push(Estimate {
                coefficient: label.to_owned(),
                name: name.clone(),
                estimate,
                std_error,
                rse_percent: relative_percent(std_error, estimate),
                ci95: ci95(estimate, std_error),
                std_error_white: white[(column, column)].max(0.0).sqrt(),
            });
        }
    }
    out
}

#[cfg(test)]
mod tests;
