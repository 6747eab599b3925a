use super::testing::{butterworth, forward_backward, motion, on_straight_lines, white};
use super::*;

const ROWS: usize = 1800;

fn sensors() -> Sensors {
    Sensors { position_std_m: 7.5e-4, roll_std_rad: 1e-3, pitch_yaw_std_rad: 2e-3, wind_std_m_s: 2.57e-3, ..Sensors::default() }
}

/// Seven channels at a rate, in the noise of [`sensors`].
fn record(seed: u64, rate_hz: f64, rows: usize) -> Record {
    let mut record = Record { t_s: (0..rows).map(|i| i as f64 / rate_hz).collect(), ..Record::default() };
    for (c, (to, std)) in record.channels_mut().into_iter().zip(sensors().std_by_channel()).enumerate() {
        let noise = white(100 * seed + c as u64, rows, std);
        *to = motion(rows, rate_hz, 0.2, c as u64).iter().zip(noise).map(|(m, w)| m + w).collect();
    }
    (record.ps_pa, record.ts_k) = (vec![101_325.0; rows], vec![299.0; rows]);
    record
}

fn filtered(mut r: Record, channels: std::ops::Range<usize>, corner_hz: f64) -> Record {
    let corner = corner_hz * r.interval_s();
    for c in channels {
        let x = r.channels()[c].to_vec();
        *r.channels_mut()[c] = forward_backward(&x, &|x| butterworth(x, 2, corner));
    }
    r
}

fn thinned(mut records: Vec<Record>) -> Vec<Record> {
    let mut runs: Vec<&mut Record> = records.iter_mut().collect();
    thin_records(&mut runs, &sensors());
    records
}

/// Variance of white noise on a smooth motion, by sixth differences (924 times it).
fn noise(x: &[f64]) -> f64 {
    let of = |w: &[f64]| w[0] - 6.0 * w[1] + 15.0 * w[2] - 20.0 * w[3] + 15.0 * w[4] - 6.0 * w[5] + w[6];
    x.windows(7).map(|w| of(w).powi(2) / 924.0).sum::<f64>() / (x.len() - 6) as f64
}

/// A sound record stays as it is, to the last bit.
#[test]
fn law_a_sound_record_is_not_touched() {
    for seed in 0..10 {
        let r = record(seed, 150.0, ROWS);
        assert_eq!(thinned(vec![r.clone()]), vec![r]);
    }
}

/// Pose smoothed at 12 Hz (forward and backward, second order: usable to 9.6 Hz): every eighth row, at its own time, in noise of the share
/// that is left of the spectrum. Of 200 rows the variance is known to 15 %; three of these, and what folding leaves uneven (15 %).
#[test]
fn recover_the_bandwidth_of_a_pose() {
    let raw = record(3, 150.0, ROWS);
    let r = filtered(raw.clone(), 0..6, 12.0);
    let kept = thinned(vec![r.clone()]).remove(0);
    let step = (kept.interval_s() * 150.0).round();
    assert!((7.0..=9.0).contains(&step), "every {step}");
    assert!(kept.t_s.iter().all(|t| r.t_s.iter().any(|own| own.to_bits() == t.to_bits())), "times of the record");
    let groups: Vec<ChannelGroup> = kept.bandwidth.iter().map(|b| b.channels).collect();
    assert_eq!(groups, [ChannelGroup::Position, ChannelGroup::Attitude]);
    for (c, std) in sensors().std_by_channel().into_iter().enumerate() {
        let ratio = noise(kept.channels()[c]) / (std * std / step);
        assert!((0.4..1.7).contains(&ratio), "channel {c}: {ratio}");
    }
    assert!((kept.noise_share(0) * step - 1.0).abs() < 1e-9);
    let b = &kept.bandwidth[0];
    assert!((b.corner_hz.expect("a corner") / 12.0 - 1.0).abs() < 0.1 && (b.bandwidth_hz / 9.6 - 1.0).abs() < 0.1, "{b:?}");
}

/// One run of two smoothed: both have one rate afterwards, and the noise of the other is that of the first.
#[test]
fn law_all_runs_have_one_rate() {
    let kept = thinned(vec![filtered(record(1, 150.0, ROWS), 0..7, 12.0), record(2, 150.0, ROWS)]);
    assert!((kept[0].interval_s() - kept[1].interval_s()).abs() < 1e-9);
    let [a, b] = [0, 1].map(|i| noise(&kept[i].position_m[1]));
    assert!((0.5..2.0).contains(&(a / b)), "{a} {b}");
    assert!(kept[1].bandwidth.iter().all(|b| b.cause == ExportCause::OtherRuns));
}

/// Straight lines from 100 to 150 Hz: the samples come back to rounding, at their times, and nothing else is done to them.
#[test]
fn exact_a_record_resampled_by_straight_lines() {
    let raw = record(4, 100.0, 1200);
    let mut r = Record { t_s: (0..1799).map(|i| f64::from(i) / 150.0).collect(), ..Record::default() };
    for (to, from) in r.channels_mut().into_iter().zip(raw.channels()) {
        *to = on_straight_lines(from, 100.0, 150.0)[..1799].to_vec();
    }
    (r.ps_pa, r.ts_k) = (vec![101_325.0; 1799], vec![299.0; 1799]);
    let kept = thinned(vec![r]).remove(0);
    assert!((kept.interval_s() - 0.01).abs() < 1e-9 && kept.bandwidth[0].cause == ExportCause::Interpolated);
    for (own, truth) in kept.channels().iter().zip(raw.channels()) {
        assert!(own.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-9));
    }
    let line = BandwidthLine { run: "perturbed-1".to_owned(), bandwidth: kept.bandwidth[0] };
    let said = words(&[line.clone(), BandwidthLine { bandwidth: kept.bandwidth[1], ..line }]);
    let expected = "perturbed-1: the pose was recorded at 100 Hz and resampled by straight lines; usable bandwidth 50 Hz; rows are thinned from \
                    150 to 100 Hz before anything is fitted";
    assert_eq!(said, [expected]);
}

/// Every sample of 50 Hz given three times: the samples come back to the last bit, the tunnel speed's too.
#[test]
fn exact_a_record_of_repeated_samples() {
    let raw = record(5, 50.0, 600);
    let mut r = Record { t_s: (0..1800).map(|i| f64::from(i) / 150.0).collect(), ..Record::default() };
    for (to, from) in r.channels_mut().into_iter().zip(raw.channels()) {
        *to = (0..1800).map(|i| from[i / 3]).collect();
    }
    (r.ps_pa, r.ts_k) = (vec![101_325.0; 1800], vec![299.0; 1800]);
    let kept = thinned(vec![r]).remove(0);
    assert_eq!(kept.channels(), raw.channels());
    assert!((kept.interval_s() - 0.02).abs() < 1e-9 && kept.bandwidth[0].cause == ExportCause::Repeated, "{:?}", kept.bandwidth);
}

/// A tunnel speed that is sampled at 10 Hz and repeated leaves the pose as it is.
#[test]
fn law_a_slow_tunnel_speed_keeps_the_rows() {
    let mut r = record(6, 150.0, ROWS);
    let own = r.vw_m_s.clone();
    r.vw_m_s = (0..ROWS).map(|i| own[i / 15 * 15]).collect();
    let kept = thinned(vec![r.clone()]).remove(0);
    assert_eq!((kept.wind_rows, &kept.position_m), (Some(windfall_model::WindRows { first: 0, every: 15 }), &r.position_m));
    assert!((0..ROWS / 15).all(|k| (kept.vw_m_s[15 * k] - own[15 * k]).abs() < 1e-12));
    let said = words(&[BandwidthLine { run: "one".to_owned(), bandwidth: kept.bandwidth[0] }]);
    assert_eq!(
        said,
        [
            "one: the tunnel speed was recorded at 10 Hz and every sample repeated; usable bandwidth 5 Hz; it is taken as sampled at 10 Hz"
        ]
    );
}
