//! pid: filter error as a regression. In: a campaign, a wider structure. Out: whitened innovations about the likeliest point, linear in
//! the wider structure's parameters.

use super::filter::{Filter, FilteredRun};
use super::search::{Begin, Search, no_answer, noise_of, started};
use crate::equations::Transition;
use crate::identification::ALL_RUNS;
use crate::output_error::{EstimateOptions, FreeColumns, PreparedRun, ready, run_plants, unknowns};
use crate::{PidError, StopReason};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Aero, Campaign};

/// Columns and response of one run.
pub(crate) type Linear = (DMatrix<f64>, DVector<f64>);

/// Innovations of every run about the likeliest point, as a regression on the parameters of a wider structure: over their standard
/// deviation, rows of unit variance, white at the truth. Response and columns such that a parameter's least-squares estimate is its value
/// itself; the second number is that of the point.
pub(crate) fn linearised(campaign: &Campaign, wide: &Aero) -> Result<Vec<Linear>, PidError> {
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    let plants = run_plants(campaign)?;
    let runs = ready(campaign, &plants)?;
    let all: Vec<usize> = (0..runs.len()).collect();
    let begin = Begin::From(started(campaign, &options)?);
    let point = Search::new(&runs, &all, &options).find(begin).map_err(|stop| no_answer(stop, campaign, ALL_RUNS))?.point;
    let mut wider = campaign.clone();
    wider.plant.aero = wide.clone();
    wider.declared = vec![true; wide.values.len()];
    let found = point.unknowns.parameters();
    for (i, name) in campaign.plant.aero.structure.parameters.iter().enumerate() {
        if let Some(k) = wide.structure.index(name) {
            wider.plant.aero.values[k] = found[i];
        }
    }
    let plants = run_plants(&wider)?;
    let wide_runs = ready(&wider, &plants)?;
    let (c, mut work) = (FreeColumns::of(&unknowns(&wider, &options)?), Transition::default());
    let noise = noise_of(&runs.iter().collect::<Vec<_>>());
    let flown = |run: &PreparedRun<'_>| {
        let seen = Filter::new(run, noise).run(&point.random(), &c, &mut work)?;
        Some(regression(&seen, &c.parameters))
    };
    wide_runs.iter().map(flown).collect::<Option<_>>().ok_or_else(|| no_answer(StopReason::FlightFails, campaign, ALL_RUNS))
}

/// One run's columns and response, every parameter free.
fn regression(seen: &FilteredRun, parameters: &[f64]) -> Linear {
    let free = parameters.len();
    let weight: Vec<f64> = seen.pass.variance.iter().map(|v| v.sqrt().recip()).collect();
    let x = DMatrix::from_fn(weight.len(), free, |row, j| seen.by_parameter[row * free + j] * weight[row]);
    let innovation = DVector::from_fn(weight.len(), |row, _| seen.pass.innovation[row] * weight[row]);
    let y = &x * DVector::from_column_slice(parameters) - innovation;
    (x, y)
}

#[cfg(test)]
mod tests;
