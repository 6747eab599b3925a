//! discover: measured poses of rigid bodies beside flown ones, for the page. In: a campaign and its models. Out: series per channel and run.

use super::figure::short;
use super::figures::runs_flown;
use super::pose_rates::{RATES, rates};
use super::sides::Sides;
use super::signals::{RunTracks, TrackSignal, named};
use crate::DiscoverError;
use crate::tracks::{TrackEvidence, TrackResidual, kept_of, rotation_of, stated_std};
use windfall_model::frames::{Body, Rotation, Tunnel, r_ned_tunnel};
use windfall_model::{Campaign, Data, Measured, PointRecord, Run};

/// Position along tunnel axes, then the angles of roll, pitch and heading from level.
const CHANNELS: [(&str, &str); 6] =
    [("X (down)", "m"), ("Y", "m"), ("Z", "m"), ("roll", "deg"), ("pitch", "deg"), ("heading", "deg")];

/// Every run at the samples that closing looks at.
pub(super) fn runs(campaign: &Campaign, sides: &Sides) -> Result<Vec<RunTracks>, DiscoverError> {
    let indices: Vec<usize> = (0..campaign.runs.len()).collect();
    let evidence = TrackEvidence::new(campaign, &indices, &sides.before)?;
    let mut all: Vec<RunTracks> = campaign.runs.iter().map(|run| measured(campaign, run)).collect();
    for (role, flown) in runs_flown(&evidence, sides) {
        for r in flown {
            let Data::Point(track) = &campaign.runs[r.run].data else { continue };
            let rows = series(&r.t_s, &simulated(track, &r));
            for (channel, values) in all[r.run].channels.iter_mut().zip(rows) {
                *channel.side(role) = values;
            }
        }
    }
    Ok(all)
}

/// A position and an attitude.
type Pose = ([f64; 3], Rotation<Tunnel, Body>);

fn measured(campaign: &Campaign, run: &Run) -> RunTracks {
    let empty = named(run);
    let Data::Point(track) = &run.data else { return empty };
    let by = kept_of(track.t_s.len());
    let poses: Vec<Pose> = (0..track.t_s.len()).step_by(by).map(|i| pose(track, i)).collect();
    let std = |k: usize| {
        let std = stated_std(&campaign.plant, Measured::Pose, k);
        Some(if k < 3 { std } else { std.to_degrees() }).filter(|s| *s > 0.0)
    };
    let one = |((k, (name, unit)), values): ((usize, &(&str, &str)), Vec<f64>)| {
        let noise = if k < CHANNELS.len() { std(k) } else { None };
        TrackSignal { measured: values, ..TrackSignal::new(name, unit, noise) }
    };
    let t_s: Vec<f64> = track.t_s.iter().step_by(by).map(|t| t - track.t_s[0]).collect();
    let channels = CHANNELS.iter().chain(&RATES).enumerate().zip(series(&t_s, &poses)).map(one).collect();
    RunTracks { t_s: t_s.into_iter().map(short).collect(), channels, ..empty }
}

fn pose(track: &PointRecord, i: usize) -> Pose {
    let position = track.position_m.each_ref().map(|s| s.as_ref().map_or(f64::NAN, |x| x[i]));
    (position, Rotation::from_quaternion(track.attitude[i]))
}

/// What was flown: measured less the residual, rotations of which are from the flown attitude to the measured one.
fn simulated(track: &PointRecord, r: &TrackResidual) -> Vec<Pose> {
    let by = kept_of(track.t_s.len());
    let left = |k: usize, i: usize| r.residual_m[k].as_ref().map_or(f64::NAN, |e| e[i]);
    let one = |i: usize| {
        let (p, attitude) = pose(track, i * by);
        let turned = rotation_of(std::array::from_fn(|k| -left(3 + k, i)));
        (std::array::from_fn(|k| p[k] - left(k, i)), attitude * turned)
    };
    (0..r.t_s.len()).map(one).collect()
}

/// The six channels of poses, the heading without jumps; rates, speed and incidence.
fn series(t_s: &[f64], poses: &[Pose]) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = vec![Vec::new(); 6];
    let mut heading: Option<f64> = None;
    for (p, attitude) in poses {
        let m = (r_ned_tunnel() * *attitude).matrix;
        let roll = m[(2, 1)].atan2(m[(2, 2)]);
        let pitch = (-m[(2, 0)]).atan2(m[(0, 0)].hypot(m[(1, 0)]));
        let turn = m[(1, 0)].atan2(m[(0, 0)]);
        let near = heading.map_or(turn, |h| turn + std::f64::consts::TAU * ((h - turn) / std::f64::consts::TAU).round());
        heading = Some(near);
        let values = p.iter().copied().chain([roll, pitch, near].map(f64::to_degrees));
        all.iter_mut().zip(values).for_each(|(s, x)| s.push(short(x)));
    }
    let (positions, attitudes): (Vec<[f64; 3]>, Vec<_>) = poses.iter().copied().unzip();
    all.extend(rates(t_s, &positions, &attitudes).map(|s| s.into_iter().map(short).collect::<Vec<f64>>()));
    all
}

#[cfg(test)]
mod tests;
