//! pid: a campaign whose recorders share one clock. In: a campaign and a lag of V_W. Out: the same runs, the tunnel's columns moved, without
//! what only one of the recorders saw.

use windfall_model::{Acts, CATALOGUE, Campaign, Data, Effect, Plant, Record};

/// Share of a run that must be left.
const LEAST_LEFT: f64 = 0.5;

/// Time by which V_W is recorded later than the pose in a plant, s.
pub(super) fn lag_s(plant: &Plant) -> f64 {
    plant.sensors.wind_delay_s - plant.sensors.pose_delay_s
}

/// The same as a campaign declares it, by its plant and its effects.
pub(super) fn declared_lag_s(campaign: &Campaign) -> f64 {
    let mut plant = campaign.plant.clone();
    campaign.knowledge.effects.iter().for_each(|(effect, values)| (effect.apply)(&mut plant, values));
    lag_s(&plant)
}

/// The effect whose one strength is a lag of that sign, and its strength.
pub(super) fn effect_of(plant: &Plant, extra_s: f64) -> Option<(&'static Effect, Vec<f64>)> {
    let strength = extra_s.abs();
    let is_it = |e: &&Effect| {
        let mut with = plant.clone();
        let alone = e.acts.on(Acts::Lander) && (e.parameters)(&[]).len() == 1;
        if alone {
            (e.apply)(&mut with, &[strength]);
        }
        // Rounding of lags of seconds.
        alone && (lag_s(&with) - lag_s(plant) - extra_s).abs() < 1e-9 * (1.0 + strength)
    };
    CATALOGUE.iter().copied().find(is_it).map(|e| (e, vec![strength]))
}

/// The campaign with V_W and all that the tunnel's recorder wrote so much earlier, cut to what both recorders have, and the lag that was
/// taken out: a whole number of samples. None where a run would lose more than half of itself, or nothing is to be moved.
pub(super) fn moved(campaign: &Campaign, lag_s: f64) -> Option<(Campaign, f64)> {
    let mut out = campaign.clone();
    let interval_s = out.runs.iter().find_map(|r| match &r.data {
        Data::Tunnel(r) if r.len() > 1 => Some(r.interval_s()),
        _ => None,
    })?;
    let taken_s = (lag_s / interval_s).round() * interval_s;
    if taken_s.abs() < interval_s {
        return None;
    }
    for run in &mut out.runs {
        if let Data::Tunnel(r) = &mut run.data {
            *r = earlier(r, taken_s)?;
        }
    }
    Some((out, taken_s))
}

/// A record with the tunnel's columns so much earlier; between samples by a straight line.
fn earlier(r: &Record, by_s: f64) -> Option<Record> {
    let n = r.len();
    let samples = by_s / r.interval_s();
    let whole = samples.round();
    // Of a record with the interval that the lag was rounded to there is nothing between samples.
    let samples = if (samples - whole).abs() < 1e-6 { whole } else { samples };
    let at = |i: usize| i as f64 + samples;
    let rows: Vec<usize> = (0..n).filter(|i| (0.0..=(n - 1) as f64).contains(&at(*i))).collect();
    let (first, last) = (*rows.first()?, *rows.last()?);
    if ((rows.len()) as f64) < LEAST_LEFT * n as f64 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the last sample")]
    let place = |i: usize| (at(i).floor() as usize, at(i).fract());
    let later = |x: &[f64]| -> Vec<f64> {
        (0..n)
            .map(|i| {
                if i < first || i > last {
                    return x[i];
                }
                let (k, s) = place(i);
                if s > 0.0 { x[k] + s * (x[k + 1] - x[k]) } else { x[k] }
            })
            .collect()
    };
    let mut out = r.clone();
    out.vw_m_s = later(&r.vw_m_s);
    for (to, from) in out.slow_mut().into_iter().zip(r.slow()) {
        if let (Some(to), Some(from)) = (to, from) {
            *to = later(from);
        }
    }
    if !r.bridged.is_empty() {
        let is_bridged = |i: usize| r.bridged.get(i).copied().unwrap_or(false);
        out.bridged = (0..n).map(|i| is_bridged(i) || (first..=last).contains(&i) && is_bridged(place(i).0)).collect();
    }
    Some(out.rows(&(first..last + 1)))
}

#[cfg(test)]
mod tests;
