//! replay: are the stated errors true here? In: a campaign and its identification. Out: scatter of estimates over copies of the campaign,
//! beside the standard errors that are stated.
//!
//! Parametric bootstrap (Efron and Tibshirani 1993, §6.5): the identified model is flown again in every run from its estimated initial
//! state, with the recorded tunnel speed, the noise that smoothing finds in the record and the turbulence that was estimated; each copy
//! is identified in the same way. A ratio of 1 says that the errors are true where the identified model is; what that model lacks it
//! cannot show.

use crate::ReplayError;
use crate::resimulate::{Replay, initial_of};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Data, Plant, Release, Use};
use windfall_pid::output_error::{EstimateOptions, Prior};
use windfall_pid::{DataSet, Estimate, Identification, Method, identify_by};
use windfall_sim::{Channel, Seed};

/// Sets the copies' chance apart from that of a simulated campaign with a small seed.
const COPIES: u64 = 0x626f_6f74_0000_0000;
/// Stream of the priors, far from those of runs.
const PRIORS: u64 = 1 << 32;

/// Scatter against stated errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bootstrap {
    /// Copies that were asked for.
    pub draws: usize,
    /// Why copies gave no answer.
    pub failed: Vec<String>,
    /// Standard error of every ratio, from the number of copies: 1/√(2(n − 1)).
    pub ratio_std_error: f64,
    /// Each parameter.
    pub parameters: Vec<BootstrapLine>,
}

/// One parameter over the copies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BootstrapLine {
    /// Coefficient, as in the identification.
    pub coefficient: String,
    /// Parameter.
    pub name: String,
    /// What was flown.
    pub flown: f64,
    /// Standard error stated by the identification.
    pub std_error: f64,
    /// Standard deviation of the estimates over the copies.
    pub scatter: f64,
    /// Scatter over stated standard error.
    pub ratio: f64,
    /// Mean of the estimates less what was flown, over the stated standard error.
    pub bias_over_std_error: f64,
    /// Share of the copies' own 95 % intervals that hold what was flown.
    pub covered: f64,
}

/// Flies and identifies copies of a campaign, with the same ties as the campaign was; constants and effects that were found with the parameters
/// are held in them. A prior is a measurement made elsewhere: every
/// copy has its own, about the identified value. Copy i is a function of i alone.
///
/// # Errors
/// A point-mass campaign, an identification of another structure, a record or flight that cannot be used, or no two copies with an
/// answer.
pub fn bootstrap(
    campaign: &Campaign,
    found: &Identification,
    method: Method,
    options: &EstimateOptions,
    draws: usize,
) -> Result<Bootstrap, ReplayError> {
    let set = found.of_all_runs().ok_or(ReplayError::NoDataSet)?;
    // Instruments are as declared in what is flown and in what is identified: not every method can undo their errors.
    let plant = Plant { sensors: campaign.plant.sensors, ..set.plant_in(campaign)? };
    let flown: Vec<(usize, Replay, Release)> = campaign
        .runs
        .par_iter()
        .enumerate()
        .filter(|(_, r)| r.used == Use::Identify)
        .map(|(i, run)| {
            let Data::Tunnel(record) = &run.data else { return Err(ReplayError::NotTunnel { run: run.name.clone() }) };
            let own = campaign.plant_for(&plant, i);
            let replay = Replay::new(record, &own)?;
            let initial = initial_of(&replay, record, &own.sensors)?;
            Ok((i, replay, initial.release))
        })
        .collect::<Result<_, _>>()?;
    let one = |draw: usize| -> Result<DataSet, ReplayError> {
        let chance = COPIES ^ draw as u64;
        // The model that is flown, its constants and effects held: gusts are the method's own to find, and it takes none from the plant.
        let mut copy = Campaign { plant: plant.clone(), ..campaign.clone() };
        copy.knowledge.effects.clear();
        for (i, replay, release) in &flown {
            let seed = Seed { campaign: chance, run: *i as u64 };
            copy.runs[*i].data = Data::Tunnel(replay.draw(*release, seed)?.record);
        }
        let mut options = EstimateOptions { combined_only: true, compatibility: false, ..options.clone() };
        draw_priors(&mut options.priors, &plant, chance);
        identify_by(&copy, method, &options)?.of_all_runs().cloned().ok_or(ReplayError::NoDataSet)
    };
    let all: Vec<Result<DataSet, ReplayError>> = (0..draws).into_par_iter().map(one).collect();
    let mut failed = Vec::new();
    let mut sets = Vec::new();
    for (draw, result) in all.into_iter().enumerate() {
        match result {
            Ok(set) => sets.push(set),
            Err(e) => failed.push(format!("copy {draw}: {e}")),
        }
    }
    let parameters: Vec<BootstrapLine> = set.parameters.iter().filter_map(|p| line(p, &plant, &sets)).collect();
    if parameters.is_empty() {
        return Err(ReplayError::NoCopies {
            reason: failed.first().cloned().unwrap_or_else(|| "fewer than two copies".to_owned()),
        });
    }
    Ok(Bootstrap { draws, failed, ratio_std_error: ratio_std_error(sets.len()), parameters })
}

/// Relative standard error of a standard deviation of so many normal numbers.
fn ratio_std_error(n: usize) -> f64 {
    1.0 / (2.0 * (n as f64 - 1.0)).sqrt()
}

/// Priors as they come out when what is flown is measured elsewhere again.
fn draw_priors(priors: &mut [Prior], plant: &Plant, chance: u64) {
    let mut normals = Seed { campaign: chance, run: PRIORS }.normals(Channel::Varied(0));
    for prior in priors {
        let flown = plant.aero.value(&prior.name).unwrap_or(prior.mean);
        prior.mean = flown + prior.std * normals.next().unwrap_or(0.0);
    }
}

fn line(p: &Estimate, plant: &Plant, sets: &[DataSet]) -> Option<BootstrapLine> {
    let own: Vec<&Estimate> = sets.iter().filter_map(|s| s.get(&p.coefficient, &p.name)).collect();
    let flown = plant.aero.value(&p.name).unwrap_or(p.estimate);
    if own.len() < 2 || p.std_error <= 0.0 {
        return None;
    }
    let n = own.len() as f64;
    let mean = own.iter().map(|e| e.estimate - flown).sum::<f64>() / n;
    let scatter = (own.iter().map(|e| (e.estimate - flown - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let covered = own.iter().filter(|e| e.ci95[0] <= flown && flown <= e.ci95[1]).count() as f64 / n;
    Some(BootstrapLine {
        coefficient: p.coefficient.clone(),
        name: p.name.clone(),
        flown,
        std_error: p.std_error,
        scatter,
        ratio: scatter / p.std_error,
        bias_over_std_error: mean / p.std_error,
        covered,
    })
}

#[cfg(test)]
mod tests;
