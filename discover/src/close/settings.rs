//! discover: what each launch lacks over its settings, and its lift coefficient, for the page. In: residuals of tracks, inputs of their runs.
//! Out: a point for every run.
//!
//! A residual of positions that is a parabola is a push that the model does not have: a₀ + a₁ t + a₂ t²/2 is fitted to it, and a₂ is the push.

use super::figure::{Figure, Role, Series, Topic, short};
use crate::tracks::{TrackEvidence, TrackResidual};
use nalgebra::{Matrix3, Vector3};
use windfall_model::{Campaign, Measured, Plant};
use windfall_pid::NORMAL_95;

/// Settings that are shown at most, those with the most values first; of two their difference is one more.
const SHOWN: usize = 3;

/// A setting of the runs: its words and its value in each.
type Setting = (String, Vec<f64>);

/// A figure for each measured axis and setting; none without settings that differ, or where positions were not measured.
pub(super) fn pushes(
    campaign: &Campaign,
    sides: &[(Role, Vec<TrackResidual>)],
    names: [&'static str; 3],
    std_m: f64,
) -> Vec<Figure> {
    if !matches!(campaign.measured(), Measured::Position | Measured::PositionAndForce) {
        return Vec::new();
    }
    let settings = settings(campaign);
    let one = |axis: usize, (words, values): &Setting| {
        let points = |(role, runs): &(Role, Vec<TrackResidual>)| series(*role, runs, axis, values, std_m);
        let series: Vec<Series> = sides.iter().map(points).filter(|s| !s.x.is_empty()).collect();
        let ends = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
        let zero = Series { role: Role::Noise, x: ends.to_vec(), y: vec![0.0; 2], ..Series::default() };
        (!series.is_empty()).then(|| Figure {
            topic: Topic::Setting,
            title: format!("push along {} over {words}", names[axis]),
            x_label: words.clone(),
            y_label: "measured less modelled (m/s²)".to_owned(),
            series: std::iter::once(zero).chain(series).collect(),
            ..Figure::default()
        })
    };
    settings.iter().flat_map(|s| (0..3).filter_map(|axis| one(axis, s)).collect::<Vec<_>>()).collect()
}

/// Step by which the lift coefficient is moved for its derivative: positions are linear in it.
const STEP: f64 = 1e-2;

/// Lift coefficient of every launch beside the fitted line, over the spin ratio r ω/V where an input is the spin in rev/s, otherwise over the
/// settings; none of a plant without lift. Each launch has its initial state and its C_L fitted to all measured axes, everything else held;
/// bars: 95 % of the tracker's noise alone.
pub(super) fn lift(campaign: &Campaign, plant: &Plant, evidence: &TrackEvidence, std_m: f64) -> Option<Figure> {
    let follows = plant.point.lift_per_input.iter().any(|k| *k != 0.0);
    if !follows || !matches!(campaign.measured(), Measured::Position | Measured::PositionAndForce) {
        return None;
    }
    let mut more = plant.clone();
    more.point.lift_constant += STEP;
    let (own, moved) = (evidence.series(plant), evidence.series(&more));
    let fitted = |run: usize| {
        let inputs = &campaign.runs[run].inputs;
        plant.point.lift_constant + plant.point.lift_per_input.iter().zip(inputs).map(|(k, u)| k * u).sum::<f64>()
    };
    let spin = campaign.inputs.iter().position(|n| n.ends_with("_rev_s"));
    let setting = settings(campaign).into_iter().next();
    let x_label = if spin.is_some() { "spin ratio r ω/V (1)".to_owned() } else { setting.as_ref()?.0.clone() };
    let place = |r: &TrackResidual| match (spin, &setting) {
        (Some(k), _) => {
            let rim_m_s = 0.5 * plant.vehicle.diameter_m * std::f64::consts::TAU * campaign.runs[r.run].inputs[k];
            rim_m_s / Vector3::from(r.velocity_m_s).norm()
        }
        (None, Some((_, all))) => all[r.run],
        _ => f64::NAN,
    };
    let one = |(a, b): (&TrackResidual, &TrackResidual)| {
        let (more, std) = extra(a, b, std_m)?;
        let fitted = fitted(a.run);
        Some([place(a), fitted + more, std, fitted]).filter(|p| p.iter().all(|x| x.is_finite()))
    };
    let mut points: Vec<[f64; 4]> = own.iter().zip(&moved).filter(|(a, b)| a.run == b.run).filter_map(one).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let of = |f: &dyn Fn(&[f64; 4]) -> f64| points.iter().map(|p| short(f(p))).collect::<Vec<f64>>();
    let end = |sign: f64| of(&|p| p[1] + sign * NORMAL_95 * p[2]);
    let x = of(&|p| p[0]);
    let measured =
        Series { role: Role::Measured, x: x.clone(), y: of(&|p| p[1]), band: Some([end(-1.0), end(1.0)]), points: true };
    let line = Series { role: Role::After, x, y: of(&|p| p[3]), ..Series::default() };
    (points.len() > 1).then(|| Figure {
        topic: Topic::Setting,
        title: "lift coefficient of every launch, and the fitted line".to_owned(),
        x_label,
        y_label: "C_L (1)".to_owned(),
        series: vec![line, measured],
        ..Figure::default()
    })
}

/// What a launch has beyond the coefficient of the first residual, and its standard deviation; the second one is of a coefficient larger by
/// [`STEP`]. Both have their initial states fitted, so that what is left is linear in it.
fn extra(own: &TrackResidual, moved: &TrackResidual, std_m: f64) -> Option<(f64, f64)> {
    let (mut product, mut square) = (0.0, 0.0);
    for (a, b) in own.residual_m.iter().zip(&moved.residual_m).take(3) {
        let (Some(a), Some(b)) = (a, b) else { continue };
        for (a, b) in a.iter().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite()) {
            let slope = (a - b) / STEP;
            product += a * slope;
            square += slope * slope;
        }
    }
    (square > 0.0).then(|| (product / square, std_m / square.sqrt()))
}

/// Inputs that differ between runs, and the difference of two.
fn settings(campaign: &Campaign) -> Vec<Setting> {
    let of = |k: usize| campaign.runs.iter().map(|r| r.inputs.get(k).copied().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    let count = |values: &[f64]| {
        let mut bits: Vec<u64> = values.iter().map(|v| v.to_bits()).collect();
        bits.sort_unstable();
        bits.dedup();
        bits.len()
    };
    let mut all: Vec<Setting> = campaign.inputs.iter().enumerate().map(|(k, n)| (n.replace('_', " "), of(k))).collect();
    all.retain(|(_, values)| count(values) > 1);
    all.sort_by_key(|(_, values)| std::cmp::Reverse(count(values)));
    if let [(a, x), (b, y)] = all.as_slice() {
        let difference = (format!("{a} less {b}"), x.iter().zip(y).map(|(x, y)| x - y).collect::<Vec<f64>>());
        if count(&difference.1) > 1 {
            all.insert(0, difference);
        }
    }
    all.truncate(SHOWN);
    all
}

fn series(role: Role, runs: &[TrackResidual], axis: usize, values: &[f64], std_m: f64) -> Series {
    let one = |r: &TrackResidual| {
        let (push, std) = push(&r.t_s, r.residual_m[axis].as_ref()?, std_m)?;
        Some((values[r.run], push, std)).filter(|p| p.0.is_finite() && p.1.is_finite())
    };
    let mut points: Vec<(f64, f64, f64)> = runs.iter().filter_map(one).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let end = |sign: f64| points.iter().map(|p| short(p.1 + sign * NORMAL_95 * p.2)).collect();
    Series {
        role,
        x: points.iter().map(|p| p.0).collect(),
        y: points.iter().map(|p| short(p.1)).collect(),
        band: Some([end(-1.0), end(1.0)]),
        points: true,
    }
}

/// The push in a residual, and its standard deviation from white noise of the positions.
fn push(t_s: &[f64], residual_m: &[f64], std_m: f64) -> Option<(f64, f64)> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (t, e) in t_s.iter().zip(residual_m).filter(|(_, e)| e.is_finite()) {
        let row = Vector3::new(1.0, *t, 0.5 * t * t);
        normal += row * row.transpose();
        right += row * *e;
    }
    let inverse = normal.try_inverse()?;
    Some(((inverse * right)[2], std_m * inverse[(2, 2)].max(0.0).sqrt()))
}

#[cfg(test)]
mod tests;
