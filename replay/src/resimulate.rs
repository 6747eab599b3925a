//! replay: re-simulation (thesis §5.3.3). In: a campaign and a model. Out: how near its flights come to the measured runs.
//!
//! Each run is flown again from its own initial state with its recorded tunnel speed. Trajectories are compared without chance;
//! the statistics of Θ and ω_q,r with all that the plant says is random, both sides through the same smoothing.

mod bands;
mod initial;
mod replay;
mod statistics;

use crate::ReplayError;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use statistics::{Squares, table_5_6};
use windfall_model::frames::Vec3;
use windfall_model::{Campaign, Data, Plant, Run, wrench_at_cm};
use windfall_pid::coefficients::coefficients;
use windfall_pid::{DataSet, FoundNumber, Identification, StopReason, rates_and_angles};
use windfall_sim::Seed;

pub use bands::Band;
pub use initial::{Initial, estimate_initial, initial_of};
pub use replay::Replay;

pub use statistics::{Statistic, Swing, TrajectoryError, instant_errors, mean_median_std};

/// A parameter's value as flown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlownParameter {
    /// Name in the structure, of a size or scale of the gusts, key of a constant, or family and name of an effect's number.
    pub name: String,
    /// Value. The static moment, which C_m and C_n give apart, is their mean weighted by inverse variance: the plant has one.
    pub value: f64,
    /// False where the identification has no estimate, and a held value or the campaign's own was flown.
    pub identified: bool,
}

/// How one run compares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunComparison {
    /// Name of the run.
    pub name: String,
    /// Kind of the run.
    pub kind: String,
    /// `identify` or `hold-out`.
    pub used: String,
    /// rms errors, flown from the initial state that was estimated from the run.
    pub trajectory: TrajectoryError,
    /// rms errors, flown from the smoothed states at the first sample.
    pub trajectory_from_first_sample: TrajectoryError,
    /// Table 5.6 of this run.
    pub statistics: Vec<Statistic>,
    /// Mean of squared pose residuals over sensor variances, in the span that the initial state was estimated on: 1 for a right
    /// model; none where the flight fails before the run's end, so that nothing was estimated.
    pub misfit: Option<f64>,
    /// That span from the first sample, s: the run's duration for a model that follows the run to the end.
    pub initial_span_s: f64,
    /// How the estimation of the initial state ended.
    pub initial: StopReason,
    /// Duration of the run, s.
    pub duration_s: f64,
    /// How far the model could be flown, s; shorter than the run when the flight failed.
    pub flown_s: f64,
    /// rms of the force residual over mass at the measured states, body x, y, z, m/s²; its sensor noise included.
    pub specific_force_rms: [f64; 3],
    /// rms of the moment residual over inertia at the measured states, body x, y, z, rad/s²; its sensor noise included.
    pub specific_moment_rms: [f64; 3],
    /// Θ and ω_q,r over time with what the parameters' errors leave open; empty without draws.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<Band>,
    /// Samples of the measurement.
    #[serde(skip)]
    pub test: Swing,
    /// Samples of the first simulation.
    #[serde(skip)]
    pub simulation: Swing,
}

/// Some runs' comparison, joined: every sample counts alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HoldOut {
    /// rms errors over all runs.
    pub trajectory: TrajectoryError,
    /// Table 5.6 over all runs.
    pub statistics: Vec<Statistic>,
    /// rms of the force residual over mass, body x, y, z, m/s².
    pub specific_force_rms: [f64; 3],
    /// rms of the moment residual over inertia, body x, y, z, rad/s².
    pub specific_moment_rms: [f64; 3],
    /// Each run.
    pub runs: Vec<RunComparison>,
}

/// Result of a re-simulation.
///
/// ```
/// use windfall_pid::{Method, identify};
/// use windfall_replay::{campaign_of, resimulate};
/// use windfall_sim::{Seed, fly};
/// let file = windfall_scenarios::read_bundled("appendix-c").expect("bundled");
/// let flight = &file.scenario.flights[0];
/// let record = fly(&file.scenario.plant, flight, Seed::default())?.record;
/// let campaign = campaign_of(&file.declared_plant, &[(flight, record)]);
/// let again = resimulate(&campaign, &identify(&campaign, Method::EquationError)?, 1)?;
/// assert!(again.trajectory.attitude_rms_deg < 1e-3);
/// # Ok::<(), windfall_replay::ReplayError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Resimulation {
    /// Method of the identification.
    pub method: String,
    /// Its data set.
    pub data_set: String,
    /// What was flown.
    pub parameters: Vec<FlownParameter>,
    /// Seeds.
    pub seeds: usize,
    /// rms errors over all runs.
    pub trajectory: TrajectoryError,
    /// Table 5.6 over all runs.
    pub statistics: Vec<Statistic>,
    /// Each run.
    pub runs: Vec<RunComparison>,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// Flies an identified model (its combined data set) against every run of a campaign. With more than one seed the simulated
/// statistics are means over seeds 0, 1, …, with their spread beside them.
///
/// # Errors
/// A point-mass campaign, no run, an identification of another structure, or a record or flight that cannot be used.
pub fn resimulate(campaign: &Campaign, identification: &Identification, seeds: usize) -> Result<Resimulation, ReplayError> {
    resimulate_with_draws(campaign, identification, seeds, 0)
}

/// [`resimulate`], and flights with parameters drawn from their covariance: bands on Θ and ω_q,r of every run, and intervals of the
/// statistics.
///
/// # Errors
/// As [`resimulate`]; [`ReplayError::NoCovariance`] for an identification without covariance when draws are asked for.
pub fn resimulate_with_draws(
    campaign: &Campaign,
    identification: &Identification,
    seeds: usize,
    draws: usize,
) -> Result<Resimulation, ReplayError> {
    let set = identification.combined().ok_or(ReplayError::NoDataSet)?;
    let plant = set.plant_in(campaign)?;
    let all: Vec<usize> = (0..campaign.runs.len()).collect();
    let plants = if draws > 0 { bands::drawn(&plant, set, draws)? } else { Vec::new() };
    let joined = join(compared(campaign, &plant, &all, seeds, &plants)?);
    let structure = &plant.aero.structure;
    let mut parameters: Vec<FlownParameter> = structure
        .parameters
        .iter()
        .zip(&plant.aero.values)
        .map(|(name, &value)| FlownParameter { name: name.clone(), value, identified: set.value(name).is_some() })
        .collect();
    let mut warnings = warnings(campaign, &parameters, &joined.runs);
    let not_flown = set.not_flown();
    if !not_flown.is_empty() {
        warnings.push(format!(
            "random moments ({}) are no part of a plant and not flown: statistics lack what they make; windfall close may name what they \
             stand for",
            not_flown.join(", ")
        ));
    }
    let estimated = |name: &str| set.parameters.iter().any(|p| p.name == name);
    let gust = |(name, value): (&str, f64)| FlownParameter { name: name.to_owned(), value, identified: estimated(name) };
    parameters.extend(set.gusts().into_iter().map(gust));
    parameters.extend(beside(campaign, set));
    let HoldOut { trajectory, statistics, runs, .. } = joined;
    let (method, data_set) = (identification.method.clone(), set.name.clone());
    Ok(Resimulation { method, data_set, parameters, seeds: seeds.max(1), trajectory, statistics, runs, warnings })
}

/// Constants and effects that are flown with the parameters.
fn beside(campaign: &Campaign, set: &DataSet) -> Vec<FlownParameter> {
    let flown = |name: String, value: f64, identified: bool| FlownParameter { name, value, identified };
    let mut all: Vec<FlownParameter> =
        set.constants.iter().map(|c| flown(c.name.clone(), c.estimate, c.std_error.is_some())).collect();
    for e in &set.effects {
        let one = |p: &FoundNumber| flown(format!("{}.{}", e.family, p.name), p.estimate, p.std_error.is_some());
        all.extend(e.parameters.iter().map(one));
    }
    for (effect, values) in set.declared_beside(campaign) {
        let names = (effect.parameters)(&campaign.inputs);
        all.extend(names.iter().zip(values).map(|(p, v)| flown(format!("{}.{}", effect.family, p.name), *v, false)));
    }
    all
}

fn warnings(campaign: &Campaign, parameters: &[FlownParameter], runs: &[RunComparison]) -> Vec<String> {
    let lost = parameters.iter().zip(&campaign.declared).filter(|(p, d)| !p.identified && **d);
    let mut all: Vec<String> = lost
        .map(|(p, _)| {
            format!("{}: no estimate, flown with the campaign's value {}; identify it on runs that excite it", p.name, p.value)
        })
        .collect();
    all.extend(runs.iter().filter(|r| r.flown_s < 0.999 * r.duration_s).map(|r| {
        let (name, flown, whole) = (&r.name, r.flown_s, r.duration_s);
        format!("run {name}: the model can be flown for {flown:.3} of {whole:.3} s only; look for an unstable parameter")
    }));
    all
}

/// Compares flights of a plant, effects included, with some runs of a campaign: parameters stay as they are, each run's initial
/// state alone is estimated from it. Trajectories are those without chance (gusts and shedding have no recorded history);
/// statistics are drawn with `seeds` seeds (at least one), instruments as noisy as the record.
///
/// # Errors
/// A point-mass run, no run, or a record or flight that cannot be used.
pub fn hold_out(campaign: &Campaign, plant: &Plant, runs: &[usize], seeds: usize) -> Result<HoldOut, ReplayError> {
    Ok(join(compared(campaign, plant, runs, seeds, &[])?))
}

/// Each run, flown by the plant and by plants drawn around it.
fn compared(
    campaign: &Campaign,
    plant: &Plant,
    runs: &[usize],
    seeds: usize,
    drawn: &[Plant],
) -> Result<Vec<Compared>, ReplayError> {
    if runs.is_empty() {
        return Err(ReplayError::NoRuns { what: "hold-out" });
    }
    runs.par_iter().map(|&i| compare(campaign, plant, i, seeds.max(1), drawn)).collect()
}

/// One run's comparison and what joining needs.
struct Compared {
    run: RunComparison,
    squares: Squares,
    draws: Vec<Swing>,
    /// One per drawn plant.
    drawn: Vec<Swing>,
    samples: usize,
}

fn join(all: Vec<Compared>) -> HoldOut {
    let mut squares = Squares::default();
    let mut test = Swing::default();
    let mut draws = vec![Swing::default(); all.first().map_or(0, |c| c.draws.len())];
    let mut drawn = vec![Swing::default(); all.first().map_or(0, |c| c.drawn.len())];
    let (mut force, mut moment, mut samples) = ([0.0; 3], [0.0; 3], 0.0);
    for c in &all {
        squares.add(&c.squares);
        test.append(&c.run.test);
        draws.iter_mut().zip(&c.draws).for_each(|(d, o)| d.append(o));
        drawn.iter_mut().zip(&c.drawn).for_each(|(d, o)| d.append(o));
        let n = c.samples as f64;
        samples += n;
        for k in 0..3 {
            force[k] += n * c.run.specific_force_rms[k].powi(2);
            moment[k] += n * c.run.specific_moment_rms[k].powi(2);
        }
    }
    HoldOut {
        trajectory: squares.error(),
        statistics: with_intervals(table_5_6(&test, &draws), &drawn),
        specific_force_rms: force.map(|s| (s / samples).sqrt()),
        specific_moment_rms: moment.map(|s| (s / samples).sqrt()),
        runs: all.into_iter().map(|c| c.run).collect(),
    }
}

/// Lines of Table 5.6 with their intervals over drawn plants.
fn with_intervals(mut lines: Vec<Statistic>, drawn: &[Swing]) -> Vec<Statistic> {
    if !drawn.is_empty() {
        lines.iter_mut().zip(bands::intervals(drawn)).for_each(|(l, ci)| l.draws_ci95 = Some(ci));
    }
    lines
}

fn compare(campaign: &Campaign, plant: &Plant, index: usize, seeds: usize, drawn: &[Plant]) -> Result<Compared, ReplayError> {
    let (run, plant): (&Run, _) = (&campaign.runs[index], &campaign.plant_for(plant, index));
    let Data::Tunnel(record) = &run.data else { return Err(ReplayError::NotTunnel { run: run.name.clone() }) };
    let replay = Replay::new(record, plant)?;
    let initial = initial_of(&replay, record, &plant.sensors)?;
    let measured = rates_and_angles(record, replay.smoother())?;
    let errors = |release| -> Result<(Squares, f64), ReplayError> {
        let flown = replay.fly_as_far_as_it_goes(release)?;
        let simulated = rates_and_angles(&flown.record, replay.smoother())?;
        let squares = Squares::new(record, &measured.pqr_rad_s, &flown.record, &simulated.pqr_rad_s);
        Ok((squares, flown.truth.t_s.last().copied().unwrap_or(0.0)))
    };
    let (squares, flown_s) = errors(initial.release)?;
    let (from_first, _) = errors(replay.first())?;
    let draws = draws(&replay, &initial, index, seeds)?;
    let test = swing(&measured);
    let (specific_force_rms, specific_moment_rms) = specific_residual(&replay, plant);
    let (statistics, misfit, initial_span_s) =
        (table_5_6(&test, &draws), Some(initial.misfit).filter(|m| m.is_finite()), initial.span_s);
    let (initial_stop, base) = (initial.stop, (replay, initial));
    let of_draws = if drawn.is_empty() { None } else { Some(bands::of_run(campaign, index, drawn, &base, &test)?) };
    let (bands, drawn) = of_draws.map_or_else(Default::default, |b| (b.bands, b.draws));
    let comparison = RunComparison {
        name: run.name.clone(),
        kind: run.kind.clone(),
        used: run.used.name().to_owned(),
        trajectory: squares.error(),
        trajectory_from_first_sample: from_first.error(),
        statistics: with_intervals(statistics, &drawn),
        misfit,
        initial_span_s,
        initial: initial_stop,
        duration_s: record.duration_s(),
        flown_s,
        specific_force_rms,
        specific_moment_rms,
        bands,
        test,
        simulation: draws.first().cloned().unwrap_or_default(),
    };
    Ok(Compared { run: comparison, squares, draws, drawn, samples: record.len() })
}

/// Θ and ω_q,r of one draw per seed, through instruments and smoothing as the measurement.
fn draws(replay: &Replay, initial: &Initial, run: usize, seeds: usize) -> Result<Vec<Swing>, ReplayError> {
    (0..seeds)
        .into_par_iter()
        .map(|seed| {
            let flown = replay.draw(initial.release, Seed { campaign: seed as u64, run: run as u64 })?;
            Ok(swing(&rates_and_angles(&flown.record, replay.smoother())?))
        })
        .collect()
}

fn swing(a: &windfall_pid::Angles) -> Swing {
    let degrees = |x: &[f64]| x.iter().map(|v| v.to_degrees()).collect();
    Swing { theta_deg: degrees(&a.theta_rad), omega_qr_deg_s: degrees(&a.omega_qr_rad_s) }
}

/// rms of what the plant leaves of force over mass (m/s²) and moment over inertia (rad/s²), at the measured states.
fn specific_residual(replay: &Replay, plant: &Plant) -> ([f64; 3], [f64; 3]) {
    let v = &plant.vehicle;
    let inverse = v.inertia.matrix().try_inverse().unwrap_or_default();
    let rows = coefficients(replay.states(), plant);
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    for row in &rows {
        let model = plant.aero.coefficients(&row.flow);
        let left: [f64; 6] = std::array::from_fn(|k| row.exp_origin[k] - model[k]);
        let w = wrench_at_cm(&left, row.q_pa, v.area_m2(), v.diameter_m, v.p_origin_cm);
        let specific: Vec3<windfall_model::frames::Body> = (inverse * w.m.xyz).into();
        for k in 0..3 {
            force[k] += (w.f.xyz[k] / v.mass_kg).powi(2);
            moment[k] += specific.xyz[k].powi(2);
        }
    }
    let n = rows.len().max(1) as f64;
    (force.map(|s| (s / n).sqrt()), moment.map(|s| (s / n).sqrt()))
}

#[cfg(test)]
mod tests;
