//! discover: amounts that are never negative in all (drag, friction) where they follow settings. In: a fit. Out: whether an effect takes away
//! more than there is in some run.
//!
//! Without settings an amount has a range: what the runs have of it may be taken away. With settings it is a sum in every run, whose
//! estimate scatters; it is negative where it lies further below zero than its error allows.

use crate::tracks::{TrackFit, TrackModel};
use nalgebra::DVector;
use windfall_model::{Campaign, Data, Net, Plant};

/// Standard errors below zero from which an amount is negative: one in 740 by chance.
const NEGATIVE: f64 = 3.0;
/// Rows of a run, evenly taken, at which recorded settings are looked at.
const ROWS: usize = 64;

/// A plant at the settings of a run: one, or where they were recorded row by row at rows evenly taken.
pub(super) fn at_settings(campaign: &Campaign, run: usize, plant: &Plant) -> Vec<Plant> {
    let r = &campaign.runs[run];
    let Data::Point(record) = &r.data else { return Vec::new() };
    let own = record.plant(plant, run, &r.inputs);
    let rows = record.recorded_inputs.first().map_or(0, |(_, series)| series.len());
    if rows == 0 {
        return vec![own];
    }
    let at = |row: usize| {
        let mut there = own.clone();
        for (place, series) in &record.recorded_inputs {
            if let (Some(u), Some(x)) = (there.point.inputs.get_mut(*place), series.get(row)) {
                *u = *x;
            }
        }
        there
    };
    (0..rows).step_by(rows.div_ceil(ROWS)).map(at).collect()
}

/// An amount at every setting of some runs, with its standard error; `of` may be any number of the plant.
pub(super) fn over_runs(
    campaign: &Campaign,
    runs: &[usize],
    fit: &TrackFit,
    of: &dyn Fn(&Plant) -> f64,
) -> Vec<(usize, f64, f64)> {
    let values = |h: &TrackModel| -> Vec<(usize, f64)> {
        let plant = h.plant(&campaign.plant);
        runs.iter()
            .flat_map(|&r| at_settings(campaign, r, &plant).into_iter().map(move |p| (r, p)))
            .map(|(r, p)| (r, of(&p)))
            .collect()
    };
    let at = values(&fit.hypothesis);
    let moved: Vec<Vec<f64>> = fit
        .free
        .iter()
        .map(|f| {
            let (h, step) = fit.hypothesis.moved(*f);
            values(&h).iter().zip(&at).map(|(x, y)| (x.1 - y.1) / step).collect()
        })
        .collect();
    let std = |i: usize| {
        let slope = DVector::from_iterator(moved.len(), moved.iter().map(|m| m[i]));
        slope.dot(&(&fit.covariance * &slope)).max(0.0).sqrt()
    };
    at.iter().enumerate().map(|(i, (run, value))| (*run, *value, std(i))).collect()
}

/// Whether an effect of a fit takes away more of an amount than some run has of it.
pub(super) fn is_overdrawn(campaign: &Campaign, runs: &[usize], fit: &TrackFit, k: usize) -> bool {
    let follows = !campaign.inputs.is_empty();
    let nets = fit.hypothesis.effects[k].parameters.iter().filter_map(|p| p.net);
    nets.filter(|_| follows).any(|Net(of)| over_runs(campaign, runs, fit, &of).iter().any(|(_, x, std)| *x < -NEGATIVE * std))
}
