//! discover: held-out runs flown again, for the page (thesis figures 5.6 and 5.8). In: a campaign, the plants before and after. Out:
//! histories of Θ, ω_q,r and the errors, and how Θ and ω_q,r are distributed.

use super::figure::{Figure, Role, Series, Topic, histogram, thinned, times};
use super::sides::Sides;
use crate::DiscoverError;
use rayon::prelude::*;
use windfall_model::{Campaign, Data, Record};
use windfall_pid::rates_and_angles;
use windfall_replay::{Replay, ReplayError, TrajectoryError, estimate_initial, instant_errors};

/// Θ and ω_q,r with title and unit.
const SWING: [(&str, &str); 2] = [("off-vertical angle Θ", "Θ (deg)"), ("pitch and yaw rate ω_q,r", "ω_q,r (deg/s)")];

/// Θ (deg) and ω_q,r (deg/s) of one side of a run.
type SwingSeries = (Role, [Vec<f64>; 2]);

/// Figures of the held-out runs of these indices.
pub(super) fn held_out(campaign: &Campaign, held: &[usize], sides: &Sides) -> Result<Vec<Figure>, DiscoverError> {
    let runs: Vec<(Vec<Figure>, Vec<SwingSeries>)> =
        held.par_iter().map(|&i| flown_again(campaign, i, sides)).collect::<Result<_, _>>()?;
    let (figures, swings): (Vec<_>, Vec<_>) = runs.into_iter().unzip();
    let mut all: Vec<Figure> = figures.into_iter().flatten().collect();
    // Kinds of runs swing differently: calm ones would hide those that were perturbed.
    let mut kinds: Vec<&str> = held.iter().map(|i| campaign.runs[*i].kind.as_str()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let own = held.iter().zip(&swings).filter(|(i, _)| campaign.runs[**i].kind == kind).map(|(_, s)| s);
        all.extend(distributions(kind, &own.collect::<Vec<_>>()));
    }
    Ok(all)
}

/// One held-out run: Θ and ω_q,r, and the distance of position and attitude.
fn flown_again(campaign: &Campaign, index: usize, sides: &Sides) -> Result<(Vec<Figure>, Vec<SwingSeries>), DiscoverError> {
    let run = &campaign.runs[index];
    let Data::Tunnel(record) = &run.data else { return Err(ReplayError::NotTunnel { run: run.name.clone() }.into()) };
    let t_s = times(&record.t_s, 1);
    let mut swings: Vec<SwingSeries> = Vec::new();
    let (mut attitude, mut position) = (Vec::new(), Vec::new());
    for (role, plant) in sides.each() {
        let own = campaign.plant_for(plant, index);
        let replay = Replay::new(record, &own)?;
        if swings.is_empty() {
            swings.push((Role::Measured, swing(record, &replay)?));
        }
        let flown = replay.fly_as_far_as_it_goes(estimate_initial(record, &own)?.release)?.record;
        swings.push((role, swing(&flown, &replay)?));
        let [angle_deg, distance_mm] = apart(&instant_errors(record, &flown));
        attitude.push(thinned(role, &t_s, &angle_deg));
        position.push(thinned(role, &t_s, &distance_mm));
    }
    let figure = |title: &str, y_label: &str, series: Vec<Series>| Figure {
        topic: Topic::Trajectory,
        title: format!("{}: {title}", run.name),
        x_label: "time in the run (s)".to_owned(),
        y_label: y_label.to_owned(),
        series,
        ..Figure::default()
    };
    let over_time = |k: usize| swings.iter().map(|(role, s)| thinned(*role, &t_s, &s[k])).collect();
    let mut all: Vec<Figure> = (0..2).map(|k| figure(SWING[k].0, SWING[k].1, over_time(k))).collect();
    all.push(figure("attitude error", "angle to measured (deg)", attitude));
    all.push(figure("position error", "distance to measured (mm)", position));
    Ok((all, swings))
}

/// Angles, deg, and distances, mm.
fn apart(errors: &[TrajectoryError]) -> [Vec<f64>; 2] {
    let (angles, distances) = errors.iter().map(|e| (e.attitude_rms_deg, 1e3 * e.position_rms_m)).unzip();
    [angles, distances]
}

fn swing(record: &Record, replay: &Replay) -> Result<[Vec<f64>; 2], DiscoverError> {
    let a = rates_and_angles(record, replay.smoother())?;
    Ok([a.theta_rad, a.omega_qr_rad_s].map(|s| s.into_iter().map(f64::to_degrees).collect()))
}

/// Distributions of Θ and ω_q,r over all samples of runs of a kind, up to the largest that was measured and a fifth more.
fn distributions(kind: &str, runs: &[&Vec<SwingSeries>]) -> Vec<Figure> {
    let Some(first) = runs.first() else { return Vec::new() };
    let of = |k: usize, place: usize| -> Vec<f64> { runs.iter().flat_map(|r| r[place].1[k].iter().copied()).collect() };
    let one = |(k, (title, x_label)): (usize, (&str, &str))| {
        let most = of(k, 0).into_iter().fold(0.0, f64::max);
        let series = first.iter().enumerate().map(|(place, (role, _))| histogram(*role, &of(k, place), [0.0, 1.2 * most]));
        Figure {
            topic: Topic::Distribution,
            title: format!("{title}: distribution over {kind} runs held out"),
            x_label: x_label.to_owned(),
            y_label: format!("density (1/{})", if k == 0 { "deg" } else { "(deg/s)" }),
            series: series.collect(),
            ..Figure::default()
        }
    };
    SWING.into_iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests;
