//! pid: the bandwidth of a record, which its export may have narrowed. In: a campaign as it was read. Out: the same, thinned to the rows that carry
//! what the instruments saw, and what was done in words.
//!
//! Many laboratories smooth or resample their records before they export them. Noise is then no longer white from row to row, and every method
//! here takes it for small where it is slow. A record that was sound stays as it is. One file for each thing that is recognised: `low_pass` for
//! filters, `clock` for rows between the samples of a slower clock; `thin` keeps the rows.

mod clock;
mod low_pass;
mod thin;

use low_pass::{LowPass, low_pass};
use serde::{Deserialize, Serialize};
use windfall_model::{Bandwidth, Campaign, ChannelGroup, Data, ExportCause, Record, Sensors};

/// What was recognised of one run's channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BandwidthLine {
    /// Name of the run.
    pub run: String,
    /// What it is.
    #[serde(flatten)]
    pub bandwidth: Bandwidth,
}

/// Fewest rows of a run that is looked at.
const FEWEST: usize = 60;

/// What was recognised, for every run and channel group.
#[must_use]
pub fn bandwidth_lines(campaign: &Campaign) -> Vec<BandwidthLine> {
    let of = |run: &windfall_model::Run| match &run.data {
        Data::Tunnel(r) => r.bandwidth.iter().map(|b| BandwidthLine { run: run.name.clone(), bandwidth: *b }).collect(),
        Data::Point(_) => Vec::new(),
    };
    campaign.runs.iter().flat_map(of).collect()
}

/// Thins the tunnel runs of a campaign to the bandwidth that their export left; what was done, in words. Runs without attitude stay as they are.
pub fn thin(campaign: &mut Campaign) -> Vec<String> {
    let sensors = campaign.plant.sensors;
    let mut runs: Vec<&mut Record> = campaign.runs.iter_mut().filter_map(|run| tunnel(&mut run.data)).collect();
    thin_records(&mut runs, &sensors);
    words(&bandwidth_lines(campaign))
}

/// What is recognised of a record by itself, in words; what a campaign of it would do is said as well.
#[must_use]
pub fn recognised(record: &Record, sensors: &Sensors) -> Vec<String> {
    let mut data = Data::Tunnel(record.clone());
    let Some(r) = tunnel(&mut data) else { return Vec::new() };
    thin_records(&mut [&mut *r], sensors);
    words(&r.bandwidth.iter().map(|b| BandwidthLine { run: String::from("this run"), bandwidth: *b }).collect::<Vec<_>>())
}

/// The records of runs of one campaign, thinned.
fn thin_records(runs: &mut [&mut Record], sensors: &Sensors) {
    for r in runs.iter_mut() {
        thin::to_own_clock(r);
        thin::wind_on_own_clock(r);
    }
    let found: Vec<Smoothing> = runs.iter().map(|r| smoothing(r, sensors)).collect();
    // Noise is learnt of all runs together, so that all have one rate.
    let narrowest = found.iter().filter_map(Smoothing::of_pose).fold(f64::INFINITY, f64::min);
    if narrowest.is_finite() {
        runs.iter_mut().zip(&found).for_each(|(r, smoothing)| thin::to_bandwidth(r, smoothing, narrowest));
    }
    runs.iter_mut().zip(&found).for_each(|(r, smoothing)| thin::wind_to_bandwidth(r, smoothing));
}

/// The record of a tunnel run that can be looked at: complete, and not too short.
fn tunnel(data: &mut Data) -> Option<&mut Record> {
    let Data::Tunnel(r) = data else { return None };
    let n = r.len();
    let full = |x: &[f64]| x.len() == n && x.iter().all(|v| v.is_finite());
    let complete = full(&r.t_s) && r.channels().iter().all(|x| full(x)) && r.slow().into_iter().flatten().all(full);
    (n >= FEWEST && complete).then_some(r)
}

/// Filters that shaped the noise of a record's channel groups.
#[derive(Clone, Debug, Default)]
struct Smoothing([Option<LowPass>; ChannelGroup::ALL.len()]);

impl Smoothing {
    fn of(&self, group: ChannelGroup) -> Option<&LowPass> {
        self.0[group as usize].as_ref()
    }
    /// Usable bandwidth of the pose, Hz.
    fn of_pose(&self) -> Option<f64> {
        let pose = [ChannelGroup::Position, ChannelGroup::Attitude];
        pose.iter().filter_map(|g| Some(self.of(*g)?.half_power_hz())).min_by(f64::total_cmp)
    }
}

/// What shaped the noise of a record.
fn smoothing(record: &Record, sensors: &Sensors) -> Smoothing {
    let (rate_hz, std) = (1.0 / record.interval_s(), sensors.std_by_channel());
    Smoothing(ChannelGroup::ALL.map(|group| {
        let series: Vec<(Vec<f64>, f64)> = group.channels().map(|c| (filled(record, c), std[c])).collect();
        low_pass(&series, rate_hz)
    }))
}

/// A channel with the noise of its neighbours where rows were bridged, so that its spectrum is that of measured rows.
fn filled(record: &Record, channel: usize) -> Vec<f64> {
    let mut x = record.channels()[channel].to_vec();
    if !record.bridged.contains(&true) {
        return x;
    }
    let measured = x.windows(5).zip(record.bridged.windows(5)).filter(|(_, b)| !b.contains(&true));
    // Fourth differences of white noise have 70 times its variance.
    let fourth: Vec<f64> = measured.map(|(s, _)| (s[0] - 4.0 * s[1] + 6.0 * s[2] - 4.0 * s[3] + s[4]).powi(2) / 70.0).collect();
    let std = (fourth.iter().sum::<f64>() / fourth.len().max(1) as f64).sqrt();
    // A bridge has about half the variance of its ends, and the sequence has the other half; phases that grow with the square of the place
    // are spread evenly and without correlation (Weyl 1916).
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    for (i, v) in x.iter_mut().enumerate().filter(|(i, _)| record.bridged[*i]) {
        let phase = (GOLDEN * (1.0 + channel as f64) * (i as f64).powi(2)) % 1.0;
        *v += std * (std::f64::consts::TAU * phase).cos();
    }
    x
}

/// One sentence for all runs and channels of which the same is to be said.
#[must_use]
pub fn words(lines: &[BandwidthLine]) -> Vec<String> {
    let kind = |b: &Bandwidth| (std::mem::discriminant(&b.cause), b.thinned_from_hz.to_bits(), b.thinned_to_hz.to_bits());
    let mut said: Vec<Vec<&BandwidthLine>> = Vec::new();
    for line in lines {
        match said.iter_mut().find(|s| kind(&s[0].bandwidth) == kind(&line.bandwidth)) {
            Some(s) => s.push(line),
            None => said.push(vec![line]),
        }
    }
    said.iter().map(|s| sentence(s)).collect()
}

fn sentence(lines: &[&BandwidthLine]) -> String {
    let mut runs: Vec<&str> = lines.iter().map(|l| l.run.as_str()).collect();
    runs.dedup();
    let has = |g: ChannelGroup| lines.iter().any(|l| l.bandwidth.channels == g);
    let names: Vec<&str> = match (has(ChannelGroup::Position), has(ChannelGroup::Attitude)) {
        (true, true) => std::iter::once("the pose").chain(has(ChannelGroup::TunnelSpeed).then_some("the tunnel speed")).collect(),
        _ => ChannelGroup::ALL.into_iter().filter(|g| has(*g)).map(ChannelGroup::name).collect(),
    };
    let range = |of: &dyn Fn(&Bandwidth) -> f64| {
        let all = || lines.iter().map(|l| of(&l.bandwidth));
        [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)].map(digits)
    };
    let [usable, _] = range(&|b| b.bandwidth_hz);
    let own = digits(lines[0].bandwidth.original_hz.unwrap_or(f64::NAN));
    let was = if names.len() > 1 { "were" } else { "was" };
    let done = match lines[0].bandwidth.cause {
        ExportCause::Smoothed => {
            let [low, high] = range(&|b| b.corner_hz.unwrap_or(f64::NAN));
            let corner = if low == high { low } else { format!("{low} to {high}") };
            format!("{was} smoothed at {corner} Hz")
        }
        ExportCause::Interpolated => format!("{was} recorded at {own} Hz and resampled by straight lines"),
        ExportCause::Repeated => format!("{was} recorded at {own} Hz and every sample repeated"),
        ExportCause::OtherRuns => format!("{was} not smoothed, but thinned with the other runs"),
    };
    let b = &lines[0].bandwidth;
    let thinned = if names == ["the tunnel speed"] {
        format!("; it is taken as sampled at {} Hz", digits(b.thinned_to_hz))
    } else if b.thinned_to_hz < b.thinned_from_hz {
        format!(
            "; rows are thinned from {} to {} Hz before anything is fitted",
            digits(b.thinned_from_hz),
            digits(b.thinned_to_hz)
        )
    } else {
        String::new()
    };
    format!("{}: {} {done}; usable bandwidth {usable} Hz{thinned}", runs.join(", "), names.join(" and "))
}

/// Three digits, without trailing zeros.
fn digits(hz: f64) -> String {
    let text = if hz < 10.0 { format!("{hz:.2}") } else { format!("{hz:.1}") };
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
