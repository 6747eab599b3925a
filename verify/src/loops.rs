//! verify: the loop on the program's own noisy campaign (thesis §5.3). In: flights with sensor noise. Out: static curves,
//! prediction and re-simulation against what was flown.

use super::{Bound, Check, CheckKind, Setups};
use crate::VerifyError;
use rayon::prelude::*;
use windfall_model::{Campaign, Data, Flight, Plant, Record, Sensors, Use};
use windfall_pid::coefficients::CoefficientRow;
use windfall_pid::{DataSet, Method, identify, process};
use windfall_replay::campaign_of;
use windfall_replay::{HoldOut, ReplayError, Statistic, hold_out};
use windfall_sim::{Seed, fly};

/// Draws of sensor noise for the simulated column of Table 5.6.
const SEEDS: usize = 16;

/// Thesis Table 5.6, simulation over test, in its order.
const TABLE_5_6: [f64; 6] =
    [1.3257 / 2.5653, 1.2761 / 2.3575, 0.2028 / 1.4957, 1.3210 / 14.8574, 0.2489 / 12.3386, 2.3376 / 9.8990];

pub(super) fn checks(setups: &Setups<'_>) -> Result<Vec<Check>, VerifyError> {
    let truth = &setups.combined.plant;
    let campaign = fly_all(setups)?;
    let found = identify(&campaign, Method::EquationError)?;
    let set = found.of_all_runs().ok_or(ReplayError::NoDataSet)?;
    let plant = set.plant_in(&campaign)?;
    let held_out: Vec<usize> = (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == Use::HoldOut).collect();
    let mut all = static_curves(truth, &plant, set);
    all.extend(prediction(&campaign, truth, &plant, &held_out)?);
    all.extend(resimulation(&campaign, &plant, set, &held_out)?);
    Ok(all)
}

fn fly_all(setups: &Setups<'_>) -> Result<Campaign, VerifyError> {
    let s = setups.combined;
    let records: Vec<(&Flight, Record)> = s
        .flights
        .par_iter()
        .enumerate()
        .map(|(i, f)| Ok((f, fly(&s.plant.for_run(i, &[]), f, Seed { campaign: s.seed, run: i as u64 })?.record)))
        .collect::<Result<_, VerifyError>>()?;
    Ok(campaign_of(&s.plant, &records))
}

/// One static curve: name, what its parameters are called, and their regressors at α_T.
type Curve = (&'static str, &'static [&'static str], fn(f64) -> [f64; 2]);

/// §5.3.1: C_A, C_N,T and C_m over α_T to 25°. Figure: distance of the curves in units of what the intervals of the parameters
/// allow together, where that is largest.
fn static_curves(truth: &Plant, found: &Plant, set: &DataSet) -> Vec<Check> {
    let odd = |a: f64| [a.sin(), a.sin().powi(3)];
    let curves: [Curve; 3] =
        [("CA", &["CA_T0"], |a| [a.cos(), 0.0]), ("CN_T", &["CN_sin", "CN_sin3"], odd), ("Cm", &["Cm_sin", "Cm_sin3"], odd)];
    curves
        .iter()
        .map(|(name, parameters, regressors)| {
            let mut worst: f64 = 0.0;
            let mut largest: f64 = 0.0;
            for degrees in 1..=25 {
                let r = regressors(f64::from(degrees).to_radians());
                let (mut difference, mut allowed) = (0.0, 0.0);
                for (p, x) in parameters.iter().zip(r) {
                    let value = |plant: &Plant| plant.aero.value(p).unwrap_or(0.0);
                    difference += (value(found) - value(truth)) * x;
                    allowed += half_interval(set, p) * x.abs();
                }
                worst = worst.max(difference.abs() / allowed);
                largest = largest.max(difference.abs());
            }
            let what =
                format!("{name} over alpha_T to 25 deg, off by at most {largest:.2e}: part of what the 95 % intervals allow");
            let source = "thesis §5.3.1; intervals of the identification";
            Check::new(CheckKind::Recovered, format!("static-curve-{name}"), what, (worst, "1"), Bound::at_most(1.0), source)
        })
        .collect()
}

/// Half of the 95 % interval of a parameter; the narrowest where two coefficients give it.
fn half_interval(set: &DataSet, name: &str) -> f64 {
    let halves = set.parameters.iter().filter(|p| p.name == name).map(|p| 0.5 * (p.ci95[1] - p.ci95[0]));
    halves.fold(f64::INFINITY, f64::min)
}

/// §5.3.2: residuals on runs not used, with identified over with true parameters.
fn prediction(campaign: &Campaign, truth: &Plant, found: &Plant, runs: &[usize]) -> Result<Vec<Check>, VerifyError> {
    let mut rows: Vec<CoefficientRow> = Vec::new();
    for &i in runs {
        let run = &campaign.runs[i];
        let Data::Tunnel(record) = &run.data else { return Err(ReplayError::NotTunnel { run: run.name.clone() }.into()) };
        let smoother = Method::EquationError.smoother();
        rows.extend(process(&run.name, &run.kind, record, &campaign.plant_for(truth, i), &smoother)?.rows);
    }
    let groups: [(&str, &[usize]); 5] = [("CA", &[0]), ("CN", &[1, 2]), ("Cl", &[3]), ("Cm", &[4]), ("Cn", &[5])];
    Ok(groups
        .iter()
        .map(|(name, members)| {
            let (own, best) = (residual_std(&rows, found, members), residual_std(&rows, truth, members));
            let what = format!("{name} predicted on held-out runs: residual std {own:.3e}, over that with the true parameters");
            let source = "thesis §5.3.2 (there C_A's is almost twice that of the source runs); 2 % for errors of estimation";
            Check::new(CheckKind::Recovered, format!("prediction-{name}"), what, (own / best, "1"), Bound::at_most(1.02), source)
        })
        .collect())
}

fn residual_std(rows: &[CoefficientRow], plant: &Plant, members: &[usize]) -> f64 {
    let sum: f64 = rows
        .iter()
        .map(|row| {
            let model = plant.aero.coefficients(&row.flow);
            members.iter().map(|&k| (row.exp_origin[k] - model[k]).powi(2)).sum::<f64>()
        })
        .sum();
    (sum / (rows.len() * members.len()).max(1) as f64).sqrt()
}

/// §5.3.3: the identified model flown against runs not used.
fn resimulation(campaign: &Campaign, found: &Plant, set: &DataSet, runs: &[usize]) -> Result<Vec<Check>, VerifyError> {
    let h = hold_out(campaign, found, runs, SEEDS)?;
    let mut all = trajectories(&h, campaign, found, set, runs);
    for (s, thesis) in h.statistics.iter().zip(TABLE_5_6) {
        let what = format!(
            "{} of {} on held-out runs: {:.4} measured, {:.4} re-simulated: their ratio",
            s.statistic, s.quantity, s.test, s.simulation
        );
        let id = format!("table-5.6-{}-{}", s.quantity, s.statistic);
        let source = "thesis §5.3.3, Table 5.6; four standard deviations of noise draws, and 1 % for errors of estimation";
        let (ratio, bound) = simulated_over_test(s);
        all.push(Check::new(CheckKind::Recovered, id, what, (ratio, "1"), bound, source).beside(thesis));
    }
    Ok(all)
}

fn simulated_over_test(s: &Statistic) -> (f64, Bound) {
    let half = 0.01 + 4.0 * s.simulation_std.unwrap_or(0.0) / s.simulation;
    (s.simulation / s.test, Bound::around(1.0, half))
}

fn trajectories(h: &HoldOut, campaign: &Campaign, found: &Plant, set: &DataSet, runs: &[usize]) -> Vec<Check> {
    let duration = runs.iter().map(|&i| h.runs.iter().find(|r| r.name == campaign.runs[i].name).map_or(0.0, |r| r.duration_s));
    let longest_s = duration.fold(0.0, f64::max);
    let ca = [half_interval(set, "CA_T0"), found.aero.value("CA_T0").unwrap_or(1.0)];
    let [attitude_deg, position_m] = allowed(&campaign.plant.sensors, ca, longest_s);
    vec![
        Check::new(
            CheckKind::Recovered,
            "resimulation-attitude",
            "attitude of held-out runs, re-simulated against measured: rms",
            (h.trajectory.attitude_rms_deg, "deg"),
            Bound::at_most(attitude_deg),
            "noise of Table A.3 plus a fifth for errors of estimation",
        ),
        Check::new(
            CheckKind::Recovered,
            "resimulation-position",
            "position of held-out runs, re-simulated against measured: rms",
            (h.trajectory.position_rms_m, "m"),
            Bound::at_most(position_m),
            "noise of Table A.3 and the drift that the interval of C_A allows over the longest run",
        ),
    ]
}

/// Largest rms of attitude (deg) and position (m): noise with a fifth for errors of estimation, and noise with the drift that an error of
/// `C_A` makes: it shifts the trim speed by half of its relative size, and the height by that times the duration.
fn allowed(s: &Sensors, [error, ca]: [f64; 2], longest_s: f64) -> [f64; 2] {
    let attitude = (s.roll_std_rad.powi(2) + 2.0 * s.pitch_yaw_std_rad.powi(2)).sqrt().to_degrees();
    let drift = error / ca.abs() * 0.5 * 7.43 * longest_s;
    [1.2 * attitude, (3.0_f64.sqrt() * s.position_std_m).hypot(drift)]
}

#[cfg(test)]
mod tests;
