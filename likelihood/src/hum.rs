//! likelihood: lines of the instruments. In: a record. Out: the record without the sinusoids that no load on the model makes.
//!
//! Mains hum and vibrating cameras put narrow lines into the pose. Above the model's modes such a line asks for loads that the air cannot
//! give; it is then the instrument's, and is fitted by least squares and taken off.

use crate::spectrum::{hann, periodogram};
use std::f64::consts::TAU;
use windfall_model::{POSE, Plant, Record};
use windfall_pid::equations::{ADDED, Craft, MOTION, TunnelAir};
use windfall_pid::golden::minimise;

/// Prior sizes of coefficients that vary: of forces, of the roll moment, of pitch and yaw moments.
pub(crate) const FORCE: f64 = 0.05;
pub(crate) const ROLL: f64 = 0.005;
pub(crate) const MOMENT: f64 = 0.02;

/// A line above this multiple of the pitch mode's frequency is the instrument's when the load that would make it is above this multiple
/// of what is plausible for loads that vary. The mode is the faster one of the model's and of what is seen: starting values may be far off, and
/// the roll angle of large swings moves at two and four times their frequency with hardly any load.
const FAST: f64 = 5.0;
const IMPLAUSIBLE: f64 = 10.0;
/// Most lines of a channel; chance of calling noise a line in a record; ordinates either side from which the level of noise is taken.
const MOST: usize = 3;
const CHANCE: f64 = 1e-4;
const BESIDE: usize = 40;
/// Ordinates of a Hann window's main lobe either side.
const LOBE: usize = 3;

/// A run's mean air, density, kg/m³, and speed, m/s; and how fast its model is seen to swing, Hz, zero where that is not looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HumStream {
    pub(crate) density_kg_m3: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) swing_hz: f64,
}

/// A line that was taken off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hum {
    /// Channel of the pose.
    pub channel: usize,
    /// Its frequency, Hz.
    pub hz: f64,
    /// Its amplitude, SI (rad).
    pub amplitude: f64,
}

/// Frequency of the pitch mode at small angles, Hz, from the rates of motion's slope.
fn pitch_hz(plant: &Plant, stream: HumStream) -> f64 {
    let Ok(craft) = Craft::complete(plant) else { return 0.0 };
    let mut x = [0.0; MOTION];
    let air = TunnelAir { t_s: 0.0, density_kg_m3: stream.density_kg_m3, vw_m_s: stream.speed_m_s, vw_rate_m_s2: 0.0 };
    let mut rate = |angle: f64| {
        x[4] = angle;
        craft.rates(&x, air, &[0.0; ADDED], &mut Vec::new()).map_or(0.0, |r| r[10])
    };
    const ANGLE: f64 = 0.02;
    let stiffness = -(rate(ANGLE) - rate(-ANGLE)) / (2.0 * ANGLE);
    stiffness.max(0.0).sqrt() / TAU
}

/// Frequency at which angles together swing most, Hz: the highest ordinate of their periodograms; zero where they are too short.
fn swing_hz(angles: &[Vec<f64>], dt_s: f64) -> f64 {
    let about_mean = |x: &Vec<f64>| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        periodogram(x.iter().map(|v| v - mean).collect::<Vec<_>>().into_iter()).map_or_else(Vec::new, |p| p.power)
    };
    let powers: Vec<Vec<f64>> = angles.iter().map(about_mean).collect();
    let sum = |k: usize| powers.iter().filter_map(|p| p.get(k)).sum::<f64>();
    let most = (0..powers.first().map_or(0, Vec::len)).max_by(|a, b| sum(*a).total_cmp(&sum(*b)));
    most.map_or(0.0, |k| k as f64 / (angles[0].len() as f64 * dt_s))
}

/// Coefficient of the load that would move a channel by an amplitude at a frequency against the model's inertia, over what is plausible.
fn load_of(plant: &Plant, stream: HumStream, channel: usize, hz: f64, amplitude: f64) -> f64 {
    let v = &plant.vehicle;
    let qs = 0.5 * stream.density_kg_m3 * stream.speed_m_s * stream.speed_m_s * v.area_m2();
    let acceleration = (TAU * hz).powi(2) * amplitude;
    match channel {
        0..3 => v.mass_kg * acceleration / qs / FORCE,
        3 => v.inertia.xx * acceleration / (qs * v.diameter_m) / ROLL,
        _ => v.inertia.yy * acceleration / (qs * v.diameter_m) / MOMENT,
    }
}

/// Whether a line of a channel is the instrument's.
pub(crate) fn of_instrument(plant: &Plant, stream: HumStream, channel: usize, hz: f64, amplitude: f64) -> bool {
    hz > FAST * pitch_hz(plant, stream).max(stream.swing_hz) && load_of(plant, stream, channel, hz, amplitude) > IMPLAUSIBLE
}

/// Takes the instruments' lines off the pose of a record; what they were, ascending by channel.
pub(crate) fn take_off(record: &mut Record, plant: &Plant) -> Vec<Hum> {
    let n = record.len() as f64;
    let mean = |x: &[f64]| x.iter().sum::<f64>() / n;
    let density = mean(&record.ps_pa) / (plant.environment.gas_constant_j_kg_k * mean(&record.ts_k));
    let dt = record.interval_s();
    let swing_hz = swing_hz(&record.attitude_rad[1..], dt);
    let stream = HumStream { density_kg_m3: density, speed_m_s: record.mean_airspeed_m_s(), swing_hz };
    let mut all = Vec::new();
    for channel in 0..POSE {
        let series = if channel < 3 { &mut record.position_m[channel] } else { &mut record.attitude_rad[channel - 3] };
        for _ in 0..MOST {
            let Some(w) = line(series) else { break };
            let (c, s) = sinusoid(series, w);
            let hum = Hum { channel, hz: w / TAU / dt, amplitude: c.hypot(s) };
            if !of_instrument(plant, stream, channel, hum.hz, hum.amplitude) {
                break;
            }
            series.iter_mut().enumerate().for_each(|(i, x)| *x -= c * (w * i as f64).cos() + s * (w * i as f64).sin());
            all.push(hum);
        }
    }
    all
}

/// An ordinate over the mean level of those beside it, its own lobe left out.
fn over(power: &[f64], k: usize) -> f64 {
    let beside = (k.saturating_sub(BESIDE)..=(k + BESIDE).min(power.len() - 1)).filter(|i| i.abs_diff(k) > LOBE);
    let mut beside: Vec<f64> = beside.map(|i| power[i]).collect();
    let middle = beside.len() / 2;
    // An exponential's median is ln 2 of its mean.
    power[k] / (*beside.select_nth_unstable_by(middle, f64::total_cmp).1 / std::f64::consts::LN_2)
}

/// Frequency, rad a sample, of the line in the upper spectrum of a series' differences that stands out most, if any does.
fn line(series: &[f64]) -> Option<f64> {
    let n = series.len().checked_sub(1).filter(|n| *n >= 8 * BESIDE)?;
    let power = periodogram(series.windows(2).map(|w| w[1] - w[0]))?.power;
    let looked = BESIDE + LOBE..power.len().saturating_sub(LOBE + 1);
    // Peaks only: a level is asked for where it may matter.
    let peaks = looked.clone().filter(|&k| power[k] > power[k - 1] && power[k] >= power[k + 1]);
    let (k, height) = peaks.map(|k| (k, over(&power, k))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    if height < ((looked.len() * POSE) as f64 / CHANCE).ln() {
        return None;
    }
    let bin = TAU / n as f64;
    let at = |w: f64| {
        let (c, s) = projected(series, w);
        -(c * c + s * s)
    };
    Some(minimise(at, [(k as f64 - 1.0) * bin, (k as f64 + 1.0) * bin], 1e-3 * bin))
}

/// Projections of a series' windowed differences on cosine and sine of a frequency.
fn projected(series: &[f64], w: f64) -> (f64, f64) {
    let window = hann(series.len() - 1);
    let pairs = series.windows(2).enumerate().map(|(i, x)| (w * (i as f64 + 0.5), (x[1] - x[0]) * window(i)));
    pairs.fold((0.0, 0.0), |(c, s), (phase, x)| (c + x * phase.cos(), s + x * phase.sin()))
}

/// Amplitudes of cosine and sine of a frequency in a series, from its differences: those of `a cos wi + b sin wi` are
/// `2 sin(w/2) (b cos w(i + ½) − a sin w(i + ½))`. The window keeps motion out.
fn sinusoid(series: &[f64], w: f64) -> (f64, f64) {
    let (c, s) = projected(series, w);
    // A Hann window has a mean of one half, a squared sinusoid another.
    let by = 4.0 / (series.len() - 1) as f64 / (2.0 * (0.5 * w).sin());
    (-s * by, c * by)
}

#[cfg(test)]
mod tests;
