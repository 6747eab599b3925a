//! discover: what smoothing takes out of tunnel records (thesis figures 3.1-3.3). In: a campaign, a smoother. Out: raw and smoothed signals
//! of every run, and spectra of both with the frequencies at which the smoother cuts: `smoothing.json`.

use super::figure::{short, times};
use super::signals::{RunTracks, SignalTracks, TrackSignal, named};
use super::tracks::{SAMPLES, empty, thinning};
use super::{Figure, Role, Series, Topic};
use crate::DiscoverError;
use rayon::prelude::*;
use realfft::RealFftPlanner;
use serde::{Deserialize, Serialize};
use windfall_model::{CHANNELS, Campaign, Data, PerChannel, Record, Run};
use windfall_pid::smooth::{Smoothed, Smoother, smooth};

/// Frequency bands of a spectrum, even on a logarithmic axis.
const BANDS: usize = 90;

/// Channels and their units on the page; the record's angles are in radians.
const SHOWN: PerChannel<(&str, &str)> =
    [("X", "m"), ("Y", "m"), ("Z", "m"), ("Rx", "deg"), ("Ry", "deg"), ("Rz", "deg"), ("V_W", "m/s")];

/// Records before and after smoothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SmoothingTracks {
    /// Each run: `measured` is the raw record, `after` the smoothed one, `noise_std` the sensor's noise as declared.
    pub signals: SignalTracks,
    /// A figure for each channel: amplitude spectral density of the raw and of the smoothed record, mean power of all runs; white noise as
    /// declared; a mark at each run's cut-off.
    pub spectra: Vec<Figure>,
}

/// A record and what a smoother makes of it.
struct SmoothedRun<'a> {
    run: &'a Run,
    record: &'a Record,
    smoothed: Smoothed,
}

/// Raw and smoothed signals of all tunnel runs and their spectra; without runs for bodies that are no tunnel models.
///
/// # Errors
/// A record that cannot be smoothed.
pub fn smoothing(campaign: &Campaign, smoother: &Smoother) -> Result<SmoothingTracks, DiscoverError> {
    let tunnel = campaign.runs.par_iter().filter_map(|run| match &run.data {
        Data::Tunnel(record) => Some((run, record)),
        Data::Point(_) => None,
    });
    let pairs = tunnel
        .map(|(run, record)| Ok(SmoothedRun { run, record, smoothed: smooth(record, smoother)? }))
        .collect::<Result<Vec<_>, DiscoverError>>()?;
    let declared = campaign.plant.sensors.std_by_channel();
    let noise: PerChannel<f64> = std::array::from_fn(|c| per_unit(c) * declared[c]);
    let thin = thinning(campaign, SAMPLES);
    let runs = pairs.iter().map(|p| of_run(p, &noise, thin)).collect();
    let signals = SignalTracks { after: "smoothed".to_owned(), runs, ..empty(campaign, &campaign.plant) };
    let spectra = if pairs.is_empty() { Vec::new() } else { (0..CHANNELS).map(|c| spectrum(c, &pairs, noise[c])).collect() };
    Ok(SmoothingTracks { signals, spectra })
}

/// Degrees of the angles.
fn per_unit(channel: usize) -> f64 {
    if SHOWN[channel].1 == "deg" { 1.0_f64.to_degrees() } else { 1.0 }
}

fn of_run(p: &SmoothedRun<'_>, noise: &PerChannel<f64>, thin: usize) -> RunTracks {
    let one = |(c, (name, unit)): (usize, &(&str, &str))| {
        let some = |x: &[f64]| x.iter().step_by(thin).map(|v| short(per_unit(c) * v)).collect();
        let (raw, smoothed) = (some(p.record.channels()[c]), some(&p.smoothed.channels[c].value));
        TrackSignal { measured: raw, after: smoothed, ..TrackSignal::new(name, unit, Some(noise[c]).filter(|s| *s > 0.0)) }
    };
    let channels = SHOWN.iter().enumerate().map(one).collect();
    RunTracks { t_s: times(&p.record.t_s, thin), channels, ..named(p.run) }
}

fn spectrum(c: usize, pairs: &[SmoothedRun<'_>], noise: f64) -> Figure {
    let (name, unit) = SHOWN[c];
    let raw: Vec<(&[f64], f64)> = pairs.iter().map(|p| (p.record.channels()[c], p.smoothed.interval_s)).collect();
    let smoothed: Vec<(&[f64], f64)> =
        pairs.iter().map(|p| (p.smoothed.channels[c].value.as_slice(), p.smoothed.interval_s)).collect();
    let curve = |role, series: &[(&[f64], f64)]| {
        let (x, y) = density(series).into_iter().map(|(f, p)| (short(f), short(per_unit(c) * p.sqrt()))).unzip();
        Series { role, x, y, ..Series::default() }
    };
    let mut series = vec![curve(Role::Measured, &raw), curve(Role::After, &smoothed)];
    // One-sided density of white noise; of runs of other rates the mean, as of the records.
    let level = noise * (pairs.iter().map(|p| 2.0 * p.smoothed.interval_s).sum::<f64>() / pairs.len() as f64).sqrt();
    if let (true, Some(first), Some(last)) = (level > 0.0, series[0].x.first(), series[0].x.last()) {
        series.push(Series { role: Role::Noise, x: vec![*first, *last], y: vec![short(level); 2], ..Series::default() });
    }
    let mut marks: Vec<f64> = pairs.iter().map(|p| short(p.smoothed.bandwidth_hz[c])).filter(|f| f.is_finite()).collect();
    marks.sort_by(f64::total_cmp);
    marks.dedup();
    Figure {
        topic: Topic::Spectrum,
        title: format!("{name}: spectrum of the raw and of the smoothed record"),
        x_label: "frequency (Hz)".to_owned(),
        y_label: format!("amplitude ({unit}/√Hz)"),
        log_y: true,
        log_x: true,
        marks,
        series,
        ..Figure::default()
    }
}

/// Mean one-sided power spectral density (unit²/Hz) of several series of their own intervals (s), over bands of frequency (Hz) that are even
/// on a logarithmic axis: periodograms of what a straight line leaves, under a sine taper.
fn density(series: &[(&[f64], f64)]) -> Vec<(f64, f64)> {
    let usable = || series.iter().filter(|(x, dt)| x.len() > 2 && *dt > 0.0);
    let low = usable().map(|(x, dt)| 1.0 / (x.len() as f64 * dt)).fold(f64::INFINITY, f64::min);
    let high = usable().map(|(_, dt)| 0.5 / dt).fold(0.0, f64::max);
    let ratio = (high / low).ln();
    let mut sums = [(0.0, 0.0, 0.0); BANDS];
    let mut planner = RealFftPlanner::new();
    for (x, dt) in usable() {
        let n = x.len();
        let taper: Vec<f64> = (0..n).map(|i| (std::f64::consts::PI * (i as f64 + 0.5) / n as f64).sin()).collect();
        let power: f64 = taper.iter().map(|w| w * w).sum();
        let fft = planner.plan_fft_forward(n);
        let (mut input, mut output) = (fft.make_input_vec(), fft.make_output_vec());
        input.iter_mut().zip(without_line(x)).zip(&taper).for_each(|((to, x), w)| *to = x * w);
        if fft.process(&mut input, &mut output).is_err() {
            continue;
        }
        for (k, z) in output.iter().enumerate().skip(1) {
            let f = k as f64 / (n as f64 * dt);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a band")]
            let band = (((f / low).ln() / ratio * BANDS as f64).max(0.0) as usize).min(BANDS - 1);
            let s = &mut sums[band];
            *s = (s.0 + f, s.1 + 2.0 * dt * z.norm_sqr() / power, s.2 + 1.0);
        }
    }
    sums.iter().filter(|s| s.2 > 0.0).map(|s| (s.0 / s.2, s.1 / s.2)).collect()
}

/// What a straight line by least squares leaves: a drift would leak into all frequencies.
fn without_line(x: &[f64]) -> Vec<f64> {
    let middle = 0.5 * (x.len() - 1) as f64;
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let (across, along) = x.iter().enumerate().fold((0.0, 0.0), |(a, b), (i, v)| {
        let t = i as f64 - middle;
        (a + t * (v - mean), b + t * t)
    });
    x.iter().enumerate().map(|(i, v)| v - mean - across / along * (i as f64 - middle)).collect()
}

#[cfg(test)]
mod tests;
