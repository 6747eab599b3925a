//! pid: the rows of a record that carry what its instruments saw. In: a record, its clock or filters. Out: the record on fewer rows, in their own time.

use super::Smoothing;
use super::clock::{Clock, on_lines, repeated, straight};
use super::low_pass::LowPass;
use windfall_model::{Bandwidth, ChannelGroup, ExportCause, POSE, Record, WindRows};

/// Rows, of those that are kept, that are left out at each end of a smoothed run: a filter starts and ends there.
const ENDS: usize = 2;
/// A channel with so many times the bandwidth that is kept is averaged between kept rows; others fold back what their filter took off.
const WIDER: f64 = 1.5;

/// Puts a record on the clock that its pose was sampled by, where rows were made between that clock's ticks.
pub(super) fn to_own_clock(r: &mut Record) {
    let flags = r.bridged.clone();
    let measured = move |i: usize| !flags.get(i).copied().unwrap_or(false);
    let channels = r.channels();
    let (pose, from_hz) = (&channels[..POSE], 1.0 / r.interval_s());
    let by_clock = |clock: &Clock, cause: ExportCause| {
        let original_hz = from_hz / clock.step();
        Bandwidth {
            channels: ChannelGroup::Position,
            cause,
            corner_hz: None,
            original_hz: Some(original_hz),
            bandwidth_hz: 0.5 * original_hz,
            thinned_from_hz: from_hz,
            thinned_to_hz: original_hz,
        }
    };
    let found = match repeated(pose, &measured) {
        Some(clock) => {
            // The sample of a tick is at the first row from it on; a tunnel speed of rows of its own is averaged.
            let picked = if repeated(&channels[POSE..], &measured) == Some(clock) { POSE + 1 } else { POSE };
            Some((by_clock(&clock, ExportCause::Repeated), on_ticks(r, &clock, &measured, picked)))
        }
        None => straight(pose, &measured)
            .map(|clock| (by_clock(&clock, ExportCause::Interpolated), on_ticks(r, &clock, &measured, 0))),
    };
    let Some((line, thinned)) = found else { return };
    let pose = [ChannelGroup::Position, ChannelGroup::Attitude].map(|channels| Bandwidth { channels, ..line });
    *r = Record { bandwidth: pose.to_vec(), ..thinned };
}

/// The record at a clock's ticks: of the first `picked_channels`, whose samples are repeated, the first row of each; of the others straight lines
/// by least squares.
fn on_ticks(r: &Record, clock: &Clock, measured: &dyn Fn(usize) -> bool, picked_channels: usize) -> Record {
    let n = r.len();
    let ticks = clock.ticks(n);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rows of the record")]
    let rows: Vec<usize> = ticks.iter().map(|x| ((x - 1e-9).ceil().max(0.0) as usize).min(n - 1)).collect();
    let all = |_: usize| true;
    let picked = |x: &[f64]| -> Vec<f64> { rows.iter().map(|i| x[*i]).collect() };
    let fitted =
        |x: &[f64], of: &dyn Fn(usize) -> bool| -> Vec<f64> { on_lines(x, clock, of).0.into_iter().take(ticks.len()).collect() };
    let mut thinned = Record { recording: None, ..r.clone() };
    let (start_s, step_s) = (r.t_s[0], r.interval_s());
    thinned.t_s = ticks.iter().map(|x| start_s + step_s * x).collect();
    for (c, (to, from)) in thinned.channels_mut().into_iter().zip(r.channels()).enumerate() {
        *to = if c < picked_channels { picked(from) } else { fitted(from, measured) };
    }
    for (to, from) in thinned.slow_mut().into_iter().zip(r.slow()) {
        if let (Some(to), Some(from)) = (to, from) {
            *to = fitted(from, &all);
        }
    }
    let near = |x: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a row of the record")]
        let i = x.round().max(0.0) as usize;
        !measured(i.min(n - 1))
    };
    if !r.bridged.is_empty() {
        thinned.bridged = if picked_channels > 0 {
            rows.iter().map(|i| !measured(*i)).collect()
        } else {
            ticks.iter().map(|x| near(*x)).collect()
        };
    }
    thinned
}

/// Marks the rows at which the tunnel speed was sampled, where its clock ticks at every so many rows, and puts straight lines between them.
pub(super) fn wind_on_own_clock(r: &mut Record) {
    let flags = r.bridged.clone();
    let measured = move |i: usize| !flags.get(i).copied().unwrap_or(false);
    let series = [r.vw_m_s.as_slice()];
    let repeated = repeated(&series, &measured).map(|c| (c, ExportCause::Repeated));
    let found = repeated.or_else(|| straight(&series, &measured).map(|c| (c, ExportCause::Interpolated)));
    // Ticks between rows are left to the filter that straight lines are.
    let Some((clock, cause)) = found.filter(|(c, _)| c.p == 1) else { return };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a row of the record")]
    let first = clock.first.round() as usize;
    let (own, rate_hz) = (r.vw_m_s.clone(), 1.0 / r.interval_s());
    let last = first + (own.len() - 1 - first) / clock.q * clock.q;
    for (i, v) in r.vw_m_s.iter_mut().enumerate() {
        let before = first + i.saturating_sub(first) / clock.q * clock.q;
        let after = (before + clock.q).min(last);
        let share = if i > before && after > before { (i - before) as f64 / clock.q as f64 } else { 0.0 };
        *v = own[before.min(last)] + share.min(1.0) * (own[after] - own[before.min(last)]);
    }
    r.wind_rows = Some(WindRows { first, every: clock.q });
    let original_hz = rate_hz / clock.q as f64;
    r.bandwidth.push(Bandwidth {
        channels: ChannelGroup::TunnelSpeed,
        cause,
        corner_hz: None,
        original_hz: Some(original_hz),
        bandwidth_hz: 0.5 * original_hz,
        thinned_from_hz: rate_hz,
        thinned_to_hz: original_hz,
    });
}

/// Marks the rows that the tunnel speed's bandwidth is enough for, where it is less than that of the pose.
pub(super) fn wind_to_bandwidth(r: &mut Record, smoothing: &Smoothing) {
    let Some(filter) = smoothing.of(ChannelGroup::TunnelSpeed) else { return };
    let rate_hz = 1.0 / r.interval_s();
    let usable_hz = filter.half_power_hz();
    // The filter of the pose, whose rows are kept already, is found a little narrower or wider here.
    let every = if usable_hz * WIDER < 0.5 * rate_hz { every(rate_hz, usable_hz) } else { 1 };
    if every < 2 || r.wind_rows.is_some() {
        return;
    }
    r.wind_rows = Some(WindRows { first: 0, every });
    let to_hz = rate_hz / every as f64;
    match r.bandwidth.iter_mut().find(|b| b.channels == ChannelGroup::TunnelSpeed) {
        Some(line) => line.thinned_to_hz = to_hz,
        None => r.bandwidth.push(line_of(ChannelGroup::TunnelSpeed, Some(filter), filter.half_power_hz(), [rate_hz, to_hz])),
    }
}

/// Rows from one that is kept to the next, so that half of the rate that is kept is at most the bandwidth.
fn every(rate_hz: f64, bandwidth_hz: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
    let every = (0.5 * rate_hz / bandwidth_hz).ceil() as usize;
    every
}

/// Keeps every k-th row, so that half of the rate is at most the bandwidth.
pub(super) fn to_bandwidth(r: &mut Record, smoothing: &Smoothing, bandwidth_hz: f64) {
    let rate_hz = 1.0 / r.interval_s();
    let every = every(rate_hz, bandwidth_hz);
    if every < 2 || r.len() < 4 * ENDS * every {
        return;
    }
    let kept_hz = rate_hz / every as f64;
    let smoothed = smoothing.of_pose().is_some();
    let ends = if smoothed { ENDS * every } else { every };
    let rows: Vec<usize> = (ends..r.len() - ends).step_by(every).collect();
    let wider = |group: ChannelGroup| smoothing.of(group).is_none_or(|f| f.half_power_hz() > WIDER * 0.5 * kept_hz);
    let mut thinned = Record { recording: None, ..r.clone() };
    thinned.t_s = rows.iter().map(|i| r.t_s[*i]).collect();
    for group in ChannelGroup::ALL {
        for c in group.channels() {
            let from = r.channels()[c];
            let kept = rows.iter().map(|i| if wider(group) { mean(from, *i, every) } else { from[*i] }).collect();
            *thinned.channels_mut()[c] = kept;
        }
    }
    for (to, from) in thinned.slow_mut().into_iter().zip(r.slow()) {
        if let (Some(to), Some(from)) = (to, from) {
            *to = rows.iter().map(|i| mean(from, *i, every)).collect();
        }
    }
    if !r.bridged.is_empty() {
        thinned.bridged = rows.iter().map(|i| r.bridged[*i]).collect();
    }
    thinned.bandwidth = lines(r, smoothing, bandwidth_hz, kept_hz);
    // Samples of the tunnel speed that are farther apart than the rows stay so, nearly.
    thinned.wind_rows = r.wind_rows.map(|w| WindRows { first: 0, every: w.every.div_ceil(every) }).filter(|w| w.every > 1);
    *r = thinned;
}

/// What is to be said of a record whose rows are kept at that rate.
fn lines(r: &Record, smoothing: &Smoothing, bandwidth_hz: f64, kept_hz: f64) -> Vec<Bandwidth> {
    let rate_hz = 1.0 / r.interval_s();
    let mut all: Vec<Bandwidth> = r.bandwidth.iter().map(|b| Bandwidth { thinned_to_hz: kept_hz, ..*b }).collect();
    let from_hz = all.first().map_or(rate_hz, |b| b.thinned_from_hz);
    for channels in ChannelGroup::ALL {
        let filter = smoothing.of(channels);
        let beside = smoothing.of_pose().is_none() && channels != ChannelGroup::TunnelSpeed;
        if filter.is_some() || beside {
            all.push(line_of(channels, filter, bandwidth_hz, [from_hz, kept_hz]));
        }
    }
    all
}

fn line_of(channels: ChannelGroup, filter: Option<&LowPass>, bandwidth_hz: f64, [from_hz, to_hz]: [f64; 2]) -> Bandwidth {
    Bandwidth {
        channels,
        cause: if filter.is_some() { ExportCause::Smoothed } else { ExportCause::OtherRuns },
        corner_hz: filter.map(|f| f.corner_hz),
        original_hz: None,
        bandwidth_hz: filter.map_or(bandwidth_hz, LowPass::half_power_hz),
        thinned_from_hz: from_hz,
        thinned_to_hz: to_hz,
    }
}

/// The middle of the cubic that fits a row and `half` rows on each side by least squares (Savitzky and Golay 1964): motion passes, and noise above
/// half of the rate of every `half`-th row does not. Fewer rows at the ends.
fn mean(x: &[f64], i: usize, half: usize) -> f64 {
    let half = half.min(i).min(x.len() - 1 - i);
    if half < 2 {
        return x[i];
    }
    let h = half as f64;
    let scale = 3.0 / ((2.0 * h - 1.0) * (2.0 * h + 1.0) * (2.0 * h + 3.0));
    let about = x[i];
    let weight = |d: f64| scale * (3.0 * h * h + 3.0 * h - 1.0 - 5.0 * d * d);
    let sum: f64 = x[i - half..=i + half].iter().enumerate().map(|(k, v)| weight(k as f64 - h) * (v - about)).sum();
    about + sum
}

#[cfg(test)]
mod tests;
