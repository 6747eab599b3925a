//! discover: statistics of simulated records. In: a plant, a flight, run numbers. Out: one row of figures for each run.

use super::{FigureQuantity, Moment, SimulatedHistory, StatisticFigure, StatisticsError, StatisticsSetup};
use crate::close::short;
use rayon::prelude::*;
use windfall_model::frames::EulerXyz;
use windfall_model::{Plant, Record};
use windfall_pid::smooth::{Smoother, TABLE_3_1_HZ};
use windfall_pid::{Angles, rates_and_angles};
use windfall_sim::{Seed, fly, fly_truth};

/// Figures of every run, in the order of the setup; rows by run.
pub(super) type Rows = Vec<Vec<f64>>;

/// Flies the runs numbered `runs` with `plant`; gives figures of the records, and the share of runs that left the section.
/// Equal run numbers have equal chance whatever the plant: common random numbers.
pub(super) fn fly_runs(
    setup: &StatisticsSetup,
    plant: &Plant,
    runs: std::ops::Range<u64>,
) -> Result<(Rows, f64), StatisticsError> {
    let all: Vec<(Vec<f64>, bool)> = runs.into_par_iter().map(|run| one(setup, plant, run)).collect::<Result<_, _>>()?;
    let left = all.iter().filter(|(_, left)| *left).count() as f64 / all.len() as f64;
    Ok((all.into_iter().map(|(row, _)| row).collect(), left))
}

/// The same figures from the truth of the runs, without instruments and smoothing: cheaper, and what the processing changes.
pub(super) fn true_runs(setup: &StatisticsSetup, plant: &Plant, runs: std::ops::Range<u64>) -> Result<Rows, StatisticsError> {
    runs.into_par_iter()
        .map(|run| {
            let (truth, _) = fly_truth(plant, &setup.flown, Seed { campaign: setup.seed, run })?;
            let angles = Angles {
                theta_rad: truth
                    .attitude_rad
                    .iter()
                    .map(|&[rx_rad, ry_rad, rz_rad]| EulerXyz { rx_rad, ry_rad, rz_rad }.off_vertical_rad())
                    .collect(),
                omega_qr_rad_s: truth.w_tunnel_body.iter().map(|[_, q, r]| q.hypot(*r)).collect(),
                pqr_rad_s: truth.w_tunnel_body,
                t_s: truth.t_s,
            };
            Ok(figures(&angles, &setup.figures))
        })
        .collect()
}

fn one(setup: &StatisticsSetup, plant: &Plant, run: u64) -> Result<(Vec<f64>, bool), StatisticsError> {
    // Beyond the walls the run goes on, so that every run has the same length; how many would have ended is counted.
    let flown = fly(plant, &setup.flown, Seed { campaign: setup.seed, run })?;
    let left = setup.flight.section.is_some_and(|s| {
        let beyond = |p: &[f64; 3]| p[0] < s.top_x_m || p[0] > s.bottom_x_m || p[1].hypot(p[2]) > s.radius_m;
        flown.truth.p_tunnel_cm.iter().any(beyond)
    });
    Ok((figures(&measured(&flown.record)?, &setup.figures), left))
}

/// Most samples of a history.
const SAMPLES: usize = 600;

/// Θ and ω_q,r over time of one run of a plant with these families added.
pub(super) fn history(
    setup: &StatisticsSetup,
    plant: &Plant,
    families: Vec<&'static str>,
    run: u64,
) -> Result<SimulatedHistory, StatisticsError> {
    let a = measured(&fly(plant, &setup.flown, Seed { campaign: setup.seed, run })?.record)?;
    let stride = a.t_s.len().div_ceil(SAMPLES).max(1);
    // Six digits: more cannot be seen.
    let some = |x: &[f64], per_unit: f64| x.iter().step_by(stride).map(|v| short(per_unit * v)).collect();
    Ok(SimulatedHistory {
        families,
        run,
        t_s: some(&a.t_s, 1.0),
        theta_deg: some(&a.theta_rad, 1_f64.to_degrees()),
        omega_qr_deg_s: some(&a.omega_qr_rad_s, 1_f64.to_degrees()),
    })
}

/// Θ and ω_q,r as the thesis has them: from the record's angles after its Fourier smoothing with the cutoffs of Table 3.1.
fn measured(record: &Record) -> Result<Angles, StatisticsError> {
    Ok(rates_and_angles(record, &Smoother::Thesis { cutoffs_hz: TABLE_3_1_HZ })?)
}

fn figures(a: &Angles, figures: &[StatisticFigure]) -> Vec<f64> {
    let series = |q: FigureQuantity| -> Vec<f64> {
        match q {
            FigureQuantity::Theta => a.theta_rad.iter().map(|x| x.to_degrees()).collect(),
            FigureQuantity::OmegaQr => a.omega_qr_rad_s.iter().map(|x| x.to_degrees()).collect(),
            FigureQuantity::PitchRate => a.pqr_rad_s.iter().map(|w| w[1].to_degrees()).collect(),
            FigureQuantity::YawRate => a.pqr_rad_s.iter().map(|w| w[2].to_degrees()).collect(),
        }
    };
    figures.iter().map(|f| moment(f.statistic, series(f.quantity))).collect()
}

pub(super) fn moment(which: Moment, mut x: Vec<f64>) -> f64 {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    match which {
        Moment::Mean => mean,
        Moment::Std => (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt(),
        Moment::Median => quantile(&mut x, 0.5),
        Moment::LargestSize => x.iter().fold(0.0, |m, v| m.max(v.abs())),
    }
}

/// Quantile of numbers in any order, which it sorts.
pub(super) fn quantile(x: &mut [f64], p: f64) -> f64 {
    x.sort_by(f64::total_cmp);
    windfall_replay::quantile(x, p)
}

#[cfg(test)]
mod tests;
