//! discover: series for the figures of a closing. In: a campaign and its closing. Out: plain series: residual spectra against noise,
//! residual over the variable that it follows, held-out runs flown again before and after, residual tracks of point masses.

use super::balance::{BalanceResidual, BandPowers};
use super::figure::{Figure, Role, Series, Topic, thinned};
use super::flown::held_out;
use super::settings::{lift, pushes};
use super::sides::Sides;
use super::track_shape::{ShapeChannel, shapes};
use super::whitened::whitened;
use super::{Closing, Options, Verdict, runs_of};
use crate::DiscoverError;
use crate::residual::{ChannelResidual, LeadTable};
use crate::tracks::{TrackEvidence, TrackResidual, stated_std};
use windfall_model::{Campaign, Coefficient, Measured, Plant, Use};

/// Frequency bands of a spectrum.
const BANDS: usize = 40;
/// Intervals of equal count over which a residual's mean is taken.
const INTERVALS: usize = 12;
/// Most channels whose residual is shown over a variable.
const CHANNELS: usize = 3;

/// Figures of a closing. Nothing new is estimated but the initial states of held-out runs.
///
/// # Errors
/// A closing that was read from a file; as closing itself.
pub fn figures(campaign: &Campaign, closing: &Closing, options: &Options) -> Result<Vec<Figure>, DiscoverError> {
    let used = runs_of(campaign, Use::Identify);
    let held = runs_of(campaign, Use::HoldOut);
    let sides = closing.plants()?;
    if campaign.has_tracks() {
        let evidence = TrackEvidence::new(campaign, if held.is_empty() { &used } else { &held }, &sides.before)?;
        let flown = runs_flown(&evidence, sides);
        let mut all = tracks(&flown);
        all.extend(track_shapes(campaign, &flown));
        let kind = campaign.measured();
        all.extend(whitened(&evidence, sides, |axis| label(kind, axis).0));
        let evidence = TrackEvidence::new(campaign, &used, &sides.before)?;
        all.extend(pushes_by_run(campaign, sides)?);
        all.extend(over_variables(&|plant| evidence.lead_table(plant), sides, closing));
        return Ok(all);
    }
    let balance = BalanceResidual::new(campaign, &used, options)?;
    let mut all = held_out(campaign, &held, sides)?;
    all.extend(over_variables(&|plant| balance.lead_table(plant), sides, closing));
    all.extend(spectra(&balance, sides));
    if !campaign.knowledge.wind_tunnel.is_empty() {
        let plants: Vec<(Role, &Plant)> = sides.each().collect();
        all.extend(super::static_curves::figures(campaign, &plants, super::reached_rad(campaign)?));
    }
    Ok(all)
}

/// What every run of a campaign lacks, over its settings.
fn pushes_by_run(campaign: &Campaign, sides: &Sides) -> Result<Vec<Figure>, DiscoverError> {
    if campaign.inputs.is_empty() {
        return Ok(Vec::new());
    }
    let all: Vec<usize> = (0..campaign.runs.len()).collect();
    let evidence = TrackEvidence::new(campaign, &all, &sides.before)?;
    let flown = runs_flown(&evidence, sides);
    let kind = campaign.measured();
    let std_m = stated_std(&campaign.plant, kind, 0);
    let lift = lift(campaign, sides.last(), &evidence, std_m);
    let pushes = pushes(campaign, &flown, [0, 1, 2].map(|k| label(kind, k).0), std_m);
    Ok(lift.into_iter().chain(pushes).collect())
}

/// Tracks flown again by each side.
pub(super) fn runs_flown(evidence: &TrackEvidence, sides: &Sides) -> Vec<(Role, Vec<TrackResidual>)> {
    sides.each().map(|(role, plant)| (role, evidence.series(plant))).collect()
}

/// Amplitude spectra of the six residuals, runs joined, in bands of frequency.
fn spectra(balance: &BalanceResidual<'_>, sides: &Sides) -> Vec<Figure> {
    let all: Vec<(Role, [BandPowers; 6])> = sides.each().map(|(role, plant)| (role, balance.spectra(plant))).collect();
    let noise = balance.noise(sides.last());
    let curve = |role: Role, bands: &BandPowers| {
        let (x, y): (Vec<f64>, Vec<f64>) = bands.iter().map(|(f, power)| (*f, power.sqrt())).unzip();
        thinned(role, &x, &y)
    };
    let one = |(c, name): (usize, &Coefficient)| Figure {
        topic: Topic::Spectrum,
        title: format!("residual of {}", name.name()),
        x_label: "frequency (Hz)".to_owned(),
        y_label: "amplitude (1/√Hz)".to_owned(),
        log_y: true,
        series: std::iter::once(curve(Role::Noise, &noise[c])).chain(all.iter().map(|(role, s)| curve(*role, &s[c]))).collect(),
        ..Figure::default()
    };
    Coefficient::ALL.iter().enumerate().map(one).collect()
}

/// Place, size over noise and name of the channels beyond noise.
fn beyond_noise(channels: &[ChannelResidual], false_alarm: f64) -> Vec<(usize, f64, String)> {
    let beyond = channels.iter().enumerate().filter(|(_, c)| c.p_value < false_alarm);
    beyond.map(|(k, c)| (k, c.rms / c.expected_rms, c.channel.clone())).collect()
}

/// The channels beyond noise, highest first, each over the variable that its slow part follows best.
fn over_variables(of: &dyn Fn(&Plant) -> LeadTable, sides: &Sides, closing: &Closing) -> Vec<Figure> {
    // Of a lander the residual's channels are those of the instruments; forces and moments are shown, the largest share first.
    let tunnel = closing.residual.per_channel.len() > of(&sides.before).residuals.len();
    let mut channels = if tunnel { Vec::new() } else { beyond_noise(&closing.residual.per_channel, closing.false_alarm_rate) };
    if tunnel && closing.verdict != Verdict::Consistent {
        let table = slow(of(&sides.before));
        channels = Coefficient::ALL
            .iter()
            .enumerate()
            .filter_map(|(k, c)| {
                let r = table.residuals.get(k)?;
                let share = table.variables.iter().filter_map(|(_, x)| Some(means(x, r)?.share)).fold(0.0, f64::max);
                Some((k, share, c.name().to_owned()))
            })
            .collect();
    }
    channels.sort_by(|a, b| b.1.total_cmp(&a.1));
    let tables: Vec<(Role, LeadTable)> = sides.each().map(|(role, plant)| (role, slow(of(plant)))).collect();
    let Some((_, first)) = tables.first() else { return Vec::new() };
    channels
        .iter()
        .take(CHANNELS)
        .filter_map(|(k, _, channel)| {
            let k = *k;
            let residual = first.residuals.get(k)?;
            let shares = first.variables.iter().enumerate().filter_map(|(v, (_, x))| Some((v, means(x, residual)?.share)));
            let (v, _) = shares.max_by(|a, b| a.1.total_cmp(&b.1))?;
            let series = tables.iter().filter_map(|(role, t)| {
                let m = means(&t.variables.get(v)?.1, t.residuals.get(k)?)?;
                Some(thinned(*role, &m.x, &m.y))
            });
            let name = &first.variables[v].0;
            Some(Figure {
                topic: Topic::Variable,
                title: format!("residual of {channel} over {name}"),
                x_label: name.clone(),
                y_label: format!("mean residual of {channel}"),
                series: series.collect(),
                ..Figure::default()
            })
        })
        .collect()
}

/// Means of neighbouring samples, a fifth of a second each and never over two runs: fast sensor noise sits in the residual and in
/// what it is held against, and would look like a dependence. Tables without time stay as they are.
fn slow(table: LeadTable) -> LeadTable {
    const BLOCK_S: f64 = 0.2;
    let Some((_, t_s)) = table.variables.iter().find(|(name, _)| name.starts_with("time")) else { return table };
    let mut ends: Vec<usize> = Vec::new();
    let mut start = 0;
    for i in 1..t_s.len() {
        if t_s[i] < t_s[i - 1] || t_s[i] - t_s[start] >= BLOCK_S {
            ends.push(i);
            start = i;
        }
    }
    ends.push(t_s.len());
    let blocks = |s: &[f64]| {
        let starts = std::iter::once(0).chain(ends.iter().copied());
        starts.zip(&ends).map(|(a, &b)| s[a..b].iter().sum::<f64>() / (b - a).max(1) as f64).collect::<Vec<f64>>()
    };
    LeadTable {
        residuals: table.residuals.iter().map(|s| blocks(s)).collect(),
        variables: table.variables.iter().map(|(name, s)| (name.clone(), blocks(s))).collect(),
    }
}

struct Means {
    share: f64,
    x: Vec<f64>,
    y: Vec<f64>,
}

/// Means over intervals of equal count, and the share of variance between them.
fn means(x: &[f64], y: &[f64]) -> Option<Means> {
    let mut order: Vec<usize> = (0..x.len().min(y.len())).collect();
    if order.len() < 2 * INTERVALS || order.iter().any(|&i| !(x[i].is_finite() && y[i].is_finite())) {
        return None;
    }
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let mean = |s: &[f64], part: &[usize]| part.iter().map(|&i| s[i]).sum::<f64>() / part.len() as f64;
    let whole = mean(y, &order);
    let total: f64 = order.iter().map(|&i| (y[i] - whole).powi(2)).sum();
    let parts = intervals(x, &order);
    if parts.len() < 2 {
        return None;
    }
    let (xs, ys): (Vec<f64>, Vec<f64>) = parts.iter().map(|p| (mean(x, p), mean(y, p))).unzip();
    let between: f64 = parts.iter().zip(&ys).map(|(p, m)| p.len() as f64 * (m - whole).powi(2)).sum();
    Some(Means { share: between / total.max(f64::MIN_POSITIVE), x: xs, y: ys })
}

/// Intervals of about equal count of samples in order; samples of one value, as the settings of runs have, are in one interval.
fn intervals<'o>(x: &[f64], order: &'o [usize]) -> Vec<&'o [usize]> {
    let least = order.len().div_ceil(INTERVALS);
    let same = 1e-9 * (x[order[order.len() - 1]] - x[order[0]]).max(1e-6 * x[order[0]].abs());
    let mut parts = Vec::new();
    let mut from = 0;
    for to in 1..=order.len() {
        let closed = to == order.len() || to - from >= least && x[order[to]] - x[order[to - 1]] > same;
        if closed {
            parts.push(&order[from..to]);
            from = to;
        }
    }
    parts
}

/// Title, factor and label of a channel's residual.
fn label(kind: Measured, channel: usize) -> (&'static str, f64, &'static str) {
    let down = ["X (down)", "Y", "Z"];
    let name =
        if kind != Measured::Angle && channel < 3 { down[channel] } else { kind.names().get(channel).copied().unwrap_or("") };
    let (per_unit, y_label) = match kind {
        _ if kind.is_force(channel) => (1.0, "specific force error (m/s²)"),
        Measured::Angle => (1.0_f64.to_degrees(), "angle error (deg)"),
        Measured::Pose if channel > 2 => (1.0_f64.to_degrees(), "attitude error (deg)"),
        _ => (1e3, "position error (mm)"),
    };
    (name, per_unit, y_label)
}

/// Residual of tracks in each channel over time: rms over runs.
fn tracks(all: &[(Role, Vec<TrackResidual>)]) -> Vec<Figure> {
    let kind = all.iter().flat_map(|(_, r)| r).next().map_or(Measured::Position, |r| r.measured);
    let end_s = all.iter().flat_map(|(_, r)| r).filter_map(|r| r.t_s.last().copied()).fold(0.0, f64::max);
    (0..6)
        .filter_map(|axis| {
            let (name, per_unit, y_label) = label(kind, axis);
            let series: Vec<Series> = all
                .iter()
                .filter_map(|(role, runs)| {
                    let mut sums = [(0.0, 0.0, 0.0); BANDS];
                    for r in runs {
                        for (t, e) in r.t_s.iter().zip(r.residual_m[axis].as_ref()?) {
                            let b = (0..BANDS).rev().find(|b| *t >= end_s * *b as f64 / BANDS as f64).unwrap_or(0);
                            let s = &mut sums[b];
                            *s = (s.0 + e * e, s.1 + t, s.2 + 1.0);
                        }
                    }
                    let filled = sums.iter().filter(|s| s.2 > 0.0);
                    let (x, y): (Vec<f64>, Vec<f64>) = filled.map(|s| (s.1 / s.2, per_unit * (s.0 / s.2).sqrt())).unzip();
                    Some(thinned(*role, &x, &y))
                })
                .collect();
            (!series.is_empty()).then(|| Figure {
                topic: Topic::Trajectory,
                title: format!("{name}: measured less re-simulated, rms over runs"),
                x_label: "time in the run (s)".to_owned(),
                y_label: y_label.to_owned(),
                series,
                ..Figure::default()
            })
        })
        .collect()
}

/// How the residual of every measured channel is distributed and correlated.
fn track_shapes(campaign: &Campaign, all: &[(Role, Vec<TrackResidual>)]) -> Vec<Figure> {
    let kind = campaign.measured();
    let one = |place: usize| {
        let (name, per_unit, y_label) = label(kind, place);
        let unit = y_label.rsplit_once('(').map_or("", |(_, u)| u.trim_end_matches(')'));
        shapes(&ShapeChannel { place, name, per_unit, unit, stated_std: stated_std(&campaign.plant, kind, place) }, all)
    };
    (0..6).flat_map(one).collect()
}

#[cfg(test)]
mod tests;
