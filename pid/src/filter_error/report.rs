//! pid: what filter error found, in the contract's words. In: filters, the point reached and the likelihood there. Out: a data set with
//! its warnings.

use super::filter::Filter;
use super::likelihood::LocalLikelihood;
use super::point::{RANDOM, SCALE_PRIOR, SIZES, SearchPoint};
use crate::identification::{CoefficientFit, DataSet, Estimate, Held, in_unit_of};
use crate::interval::{NORMAL_95, relative_percent};
use crate::not_noise::NotNoise;
use crate::output_error::{aligned, estimates, low_frequency_p, spread};
use crate::plant::{Gust, PROCESS_NOISE, START_SCALE_M, TURBULENCE};
use nalgebra::DMatrix;
use realfft::RealFftPlanner;
use windfall_model::{CHANNEL_NAMES, CHANNELS, Campaign};

/// Coefficient and name of what drives the runs at random.
const NAMES: [(&str, &str); RANDOM] = [
    (TURBULENCE, Gust::AxialRms.name()),
    (TURBULENCE, Gust::LateralRms.name()),
    (TURBULENCE, Gust::AxialScale.name()),
    (TURBULENCE, Gust::LateralScale.name()),
    (PROCESS_NOISE, "roll_rad_s1_5"),
    (PROCESS_NOISE, "across_rad_s1_5"),
];

/// Warnings of what the data did not determine of the random drive.
fn report_random(name: &str, point: &SearchPoint, covariance: &DMatrix<f64>, warnings: &mut Vec<String>) {
    let free = point.unknowns.free();
    if point.is_still() {
        warnings.push(format!("data set {name}: no turbulence that these runs could tell: --method output-error says more"));
    } else if !point.sought.scales {
        warnings.push(format!(
            "data set {name}: scales of the gusts are held at {} m: what is left has not the colour of gusts",
            START_SCALE_M
        ));
    }
    if point.sought.turning {
        warnings.push(format!(
            "data set {name}: gusts alone do not explain these runs; random moments are allowed for beside them (process-noise)"
        ));
    }
    for (k, (_, name_k)) in NAMES.iter().enumerate().take(4).skip(2) {
        if !point.held(free + k) && covariance[(free + k, free + k)].sqrt() > 0.5 * SCALE_PRIOR {
            warnings.push(format!("data set {name}: {name_k} is determined by its prior more than by the data"));
        }
    }
}

pub(super) fn data_set(
    campaign: &Campaign,
    name: &str,
    filters: &[Filter<'_, '_>],
    point: &SearchPoint,
    now: &LocalLikelihood,
    covariance: &DMatrix<f64>,
    warnings: &mut Vec<String>,
) -> DataSet {
    report_random(name, point, covariance, warnings);
    let fits = channel_fits(filters, now);
    let left = NotNoise::of(&fits);
    // The innovations of the tunnel speed test the smoothness that it is taken to have, not the declared model.
    if !left.is_noise_of_pose() {
        warnings.push(format!(
            "data set {name}: the residual is {}, turbulence allowed for: the declared model lacks another effect; intervals say nothing \
             of its bias: try windfall close",
            left.clause()
        ));
    }
    let mut parameters = estimates(campaign, &point.unknowns, covariance, covariance);
    parameters.extend(random_estimates(point, covariance));
    DataSet {
        refused: Vec::new(),
        envelope: None,
        name: name.to_owned(),
        runs: filters.iter().map(|f| f.run.name.to_owned()).collect(),
        covariance: aligned(campaign, &point.unknowns, covariance, &parameters),
        curves: Vec::new(),
        parameters,
        fits,
        condition_number: condition_number(covariance),
        n_samples: filters.iter().map(|f| f.run.record.len()).sum(),
        held: held_scales(point),
        constants: Vec::new(),
        effects: Vec::new(),
    }
}

/// How well each channel is explained.
fn channel_fits(filters: &[Filter<'_, '_>], now: &LocalLikelihood) -> Vec<CoefficientFit> {
    let mut planner = RealFftPlanner::new();
    let intervals: Vec<f64> = filters.iter().map(|f| f.run.interval_s).collect();
    let fit = |c: usize| {
        let series: Vec<&[f64]> = now.whitened.iter().map(|w| w[c].as_slice()).collect();
        let total: f64 = filters.iter().map(|f| spread(f.run.record.channels()[c])).sum();
        CoefficientFit {
            coefficient: CHANNEL_NAMES[c].to_owned(),
            r2: if total > 0.0 { 1.0 - now.left[c] / total } else { 0.0 },
            residual_std: in_unit_of(CHANNEL_NAMES[c], (now.left[c] / now.samples).sqrt()),
            residual_whiteness_p: low_frequency_p(&series, &intervals, &mut planner),
        }
    };
    (0..CHANNELS).map(fit).collect()
}

/// Of the correlations, as the root: what scaled slopes have.
fn condition_number(covariance: &DMatrix<f64>) -> f64 {
    let d: Vec<f64> = covariance.diagonal().iter().map(|v| v.sqrt()).collect();
    let eigen = DMatrix::from_fn(d.len(), d.len(), |i, j| covariance[(i, j)] / (d[i] * d[j])).symmetric_eigenvalues();
    (eigen.max() / eigen.min().max(f64::MIN_POSITIVE)).sqrt()
}

/// Scales at which gusts were taken, where these were not estimated.
fn held_scales(point: &SearchPoint) -> Vec<Held> {
    let free = point.unknowns.free();
    let scales = (2..4).filter(|&k| point.held(free + k) && point.negligible[k - 2].is_none());
    scales.map(|k| Held { name: NAMES[k].1.to_owned(), value: point.random[k].exp() }).collect()
}

/// Sizes and scales of what drives the runs at random; intervals are those of the logarithms.
fn random_estimates(point: &SearchPoint, covariance: &DMatrix<f64>) -> Vec<Estimate> {
    let free = point.unknowns.free();
    let one = |(k, (coefficient, name)): (usize, &(&str, &str))| {
        let make = |estimate: f64, std_error: f64, ci95: [f64; 2]| Estimate {
            coefficient: (*coefficient).to_owned(),
            name: (*name).to_owned(),
            estimate,
            std_error,
            rse_percent: relative_percent(std_error, estimate),
            ci95,
            std_error_white: std_error,
        };
        if let Some(limit) = SIZES.iter().position(|s| *s == k).and_then(|size| point.negligible[size]) {
            return Some(make(0.0, limit, [0.0, NORMAL_95 * limit]));
        }
        if point.held(free + k) {
            return None;
        }
        let (estimate, relative) = (point.random[k].exp(), covariance[(free + k, free + k)].max(0.0).sqrt());
        let ends = [-NORMAL_95, NORMAL_95].map(|z| estimate * (z * relative).exp());
        Some(make(estimate, estimate * relative, ends))
    };
    NAMES.iter().enumerate().filter_map(one).collect()
}

#[cfg(test)]
mod tests;
