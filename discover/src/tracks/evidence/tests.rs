//! discover tests: evidence of tracks against what is known of parabolas with errors that no initial state makes.

use super::super::pose::rotation_of;
use super::super::tests::{ball, brick, campaign, close, thrown, times, wiggle};
use super::*;
use windfall_model::PointRecord;
use windfall_model::frames::{Body, Rotation, Tunnel};

/// What position, force and angle have beyond a flight in a vacuum.
const ERRORS: [f64; 3] = [0.4, 0.3, 0.01];

/// A throw along one or two axes with errors.
fn noisy(n: usize, axes: &[usize], end_s: f64) -> PointRecord {
    let t_s = times(n, 0.4, 0.4 + end_s);
    let mut record = thrown(&t_s, axes, [3.0, 0.0, -2.0], [-4.0, 0.0, 5.0]);
    for (k, series) in record.position_m.iter_mut().flatten().enumerate() {
        series.iter_mut().zip(wiggle(&t_s, ERRORS[0], k as f64, true)).for_each(|(x, e)| *x += e);
    }
    record
}

/// The same with an accelerometer whose errors are slow: cosines of one to three half periods.
fn felt(n: usize, axes: &[usize], end_s: f64) -> PointRecord {
    let t_s = times(n, 0.0, end_s);
    let wave = |t: &f64| (1..4).map(|k| (std::f64::consts::PI * f64::from(k) * t / end_s).cos()).sum::<f64>();
    let mean = t_s.iter().map(wave).sum::<f64>() / n as f64;
    let force = t_s.iter().map(|t| 0.9 + ERRORS[1] * (wave(t) - mean)).collect();
    PointRecord { measured: Measured::PositionAndForce, specific_force_m_s2: [Some(force), None, None], ..noisy(n, axes, end_s) }
}

fn evidence_of(runs: Vec<PointRecord>) -> TrackEvidence {
    let c = campaign(ball(0.0), &[], runs.into_iter().map(|r| (Vec::new(), r)).collect());
    TrackEvidence::new(&c, &(0..c.runs.len()).collect::<Vec<_>>(), &c.plant).expect("flies")
}

/// A record of one axis that is taken in groups of two, and one of two axes.
fn two() -> TrackEvidence {
    evidence_of(vec![noisy(258, &[2], 5.0), noisy(9, &[0, 2], 1.3)])
}

/// White noise is that of a sample over the samples of a group; numbers of the second run begin where the padding of the first
/// ends.
#[test]
fn exact_noise_and_places() {
    let e = two();
    let white = e.white_variance(2);
    for (i, order, _) in e.places(2) {
        let group = if i / BIN < 11 { 2.0 } else { 1.0 };
        close(e.noise[i / BIN][(i % BIN, i % BIN)], white / group, 1e-12);
        assert_eq!(order, if i < 132 { i } else { (i - 133) / 2 });
    }
    // The first has 129 means and 127 numbers in eleven bins, the second nine samples and seven numbers of each axis.
    let places = |axis: usize| e.places(axis).iter().map(|p| p.0).collect::<Vec<_>>();
    assert_eq!(places(2), (0..127).chain((0..7).map(|o| 132 + 2 * o + 1)).collect::<Vec<_>>());
    assert_eq!(places(0), (0..7).map(|o| 132 + 2 * o).collect::<Vec<_>>());
    e.places(0).iter().for_each(|(_, o, hz)| close(*hz, (*o as f64 + 2.0) / 2.0 / 1.3, 1e-14));
    assert_eq!(e.samples(), 127 + 14);
}

/// Half of a normal's squares are below 0.4549 of its variance. Of the fast half of each run's orders the median square of a
/// sample, two of which make a mean in the first run; what is stated, 0.5, where that is less; a micrometre at least.
#[test]
fn exact_white_variance_is_a_median() {
    use statrs::distribution::{ChiSquared, ContinuousCDF};
    close(ChiSquared::new(1.0).expect("positive").cdf(0.4549), 0.5, 1e-4);
    let mut e = two();
    e.tracks[0].laid = DVector::from_fn(127, |i, _| if i < 63 { 9.0 } else { 0.02 + 1e-4 * ((i * 29) % 64) as f64 });
    // Order by order both axes: of the first seven and three orders too large, then four squares of each axis.
    e.tracks[1].laid = DVector::from_fn(14, |i, _| {
        if i < 6 {
            9.0
        } else if i % 2 == 0 {
            0.11 + 0.01 * i as f64
        } else {
            0.001
        }
    });
    // Of axis 2: 64 squares of the first and four tiny ones of the second; the 34th of all from below is the 30th of the first.
    close(e.white_variance(2), 2.0 * (0.02_f64 + 1e-4 * 30.0).powi(2) / 0.4549, 1e-9);
    close(e.white_variance(0), (0.11_f64 + 0.10).powi(2) / 0.4549, 1e-9);
    e.tracks.iter_mut().for_each(|t| t.laid.fill(3.0));
    close(e.white_variance(2), 0.25, 1e-15);
    e.tracks.iter_mut().for_each(|t| t.laid.fill(0.0));
    close(e.white_variance(2) / 1e-12, 1.0, 1e-12);
}

/// Errors that no initial state makes are what is left: over all samples of both runs, and of forces apart.
#[test]
fn exact_rms_is_that_of_the_errors() {
    let square = |n: usize, end_s: f64, phase: f64| {
        wiggle(&times(n, 0.4, 0.4 + end_s), ERRORS[0], phase, true).iter().map(|e| e * e).sum::<f64>()
    };
    let plain = evidence_of(vec![noisy(9, &[0, 2], 1.3), noisy(7, &[2], 0.8)]);
    let sum = square(9, 1.3, 0.0) + square(9, 1.3, 1.0) + square(7, 0.8, 0.0);
    close(plain.rms_m(&ball(0.0)), (sum / 25.0).sqrt(), 1e-9);
    let record = felt(9, &[0, 2], 1.3);
    let force = record.specific_force_m_s2[0].clone().expect("measured");
    let with = evidence_of(vec![record]);
    close(with.rms_m(&ball(0.0)), ((square(9, 1.3, 0.0) + square(9, 1.3, 1.0)) / 18.0).sqrt(), 1e-9);
    close(with.rms_m_s2(&ball(0.0)), (force.iter().map(|f| (f - 0.9).powi(2)).sum::<f64>() / 9.0).sqrt(), 1e-9);
}

/// Components of the unmodelled residual of five runs: white noise, a walk, a slow force and a push along each axis, and white
/// noise of an accelerometer. Root mean squares of numbers that are given come back in the channels' units; all of one size, noise
/// of that size is what is expected without a walk, to half a per cent (a gain of 1e-4).
#[test]
fn exact_channels_in_their_units() {
    let mut e = evidence_of(vec![felt(9, &[0, 2], 1.3); 5]);
    assert_eq!((e.axes(), e.firsts.clone(), e.components()), (vec![0, 2, 3], vec![0, 4, 8], 9));
    for (c, stated) in [(0, 0.5), (2, 0.5), (3, 0.2)] {
        let white = e.white_variance(c);
        close(e.stds(c)[0], stated, 1e-15);
        close(e.stds(c)[1], stated * white.sqrt(), 1e-15);
    }
    let mut z = vec![0.0; e.tracks.len() * 2 * BIN];
    let sizes = [1.3, 2.1, 1.7];
    for (axis, size) in [0, 2, 3].into_iter().zip(sizes) {
        e.places(axis).into_iter().for_each(|(i, order, _)| z[i] = if order % 2 == 0 { size } else { -size });
    }
    e.walks.iter_mut().flatten().for_each(|m| m.fill(0.0));
    for ((judged, size), (name, unit)) in e.channel_residuals(&z, 0).iter().zip(sizes).zip([("X", 0.5), ("Z", 0.5), ("fX", 0.2)])
    {
        assert_eq!(judged.channel, name);
        close(judged.rms, size * unit, 1e-12);
        assert!((judged.expected_rms / judged.rms - 1.0).abs() < 1e-2, "{judged:?}");
    }
}

/// The number that stands highest over its noise, not the largest; and an effect must take more than the stated variance of all
/// numbers along some axis, 0.25 of each.
#[test]
fn exact_peak_and_what_tells() {
    let e = two();
    let mut z = vec![0.0; e.tracks.iter().map(|t| t.bins() * BIN).sum()];
    (z[40], z[132 + 7]) = (0.8, 0.9);
    let channel = e.axes().iter().position(|a| *a == 2).expect("measured");
    close(e.peak_hz(&z, channel).expect("measured"), 0.5 * 42.0 / e.tracks[0].duration_s(), 1e-13);
    let after = vec![0.0; z.len()];
    for (by, tells) in [(0.99, false), (1.01, true)] {
        let mut before = after.clone();
        before[132 + 2] = (by * 0.25 * 7.0_f64).sqrt();
        assert_eq!((e.tells(&before, &after), e.tells(&after, &before)), (tells, false), "{by}");
        // With as much again before and after.
        let left: Vec<f64> = after.iter().enumerate().map(|(i, _)| if i == 134 { 2.0 } else { 0.0 }).collect();
        before[134] = (by * 0.25 * 7.0_f64 + 4.0).sqrt();
        assert_eq!(e.tells(&before, &left), tells, "{by}");
    }
}

/// Bricks that fall without a turn, in a vacuum, whose pose has errors that no initial state makes: of positions, and of angles
/// about one axis.
fn poses(runs: usize) -> TrackEvidence {
    let t_s = times(9, 0.0, 1.3);
    let mut record = thrown(&t_s, &[0, 1, 2], [3.0, 1.0, -2.0], [-4.0, 0.0, 5.0]);
    for (k, series) in record.position_m.iter_mut().flatten().enumerate() {
        series.iter_mut().zip(wiggle(&t_s, ERRORS[0], k as f64, true)).for_each(|(x, e)| *x += e);
    }
    let base = Rotation::<Tunnel, Body>::from_quaternion([0.5, -0.1, 0.7, 0.5]);
    let angles = wiggle(&t_s, ERRORS[2], 2.5, true);
    record.attitude = angles.iter().map(|a| (base * rotation_of([*a, 0.0, 0.0])).to_quaternion()).collect();
    record.measured = Measured::Pose;
    let inputs = |r: usize| vec![(0.7 * r as f64).sin()];
    let c = campaign(brick(), &["spin"], (0..runs).map(|r| (inputs(r), record.clone())).collect());
    TrackEvidence::new(&c, &(0..runs).collect::<Vec<_>>(), &c.plant).expect("flies")
}

/// Root mean squares over samples: of the distance, and of the angle.
#[test]
fn exact_rms_of_poses() {
    let t_s = times(9, 0.0, 1.3);
    let square = |size: f64, phase: f64| wiggle(&t_s, size, phase, true).iter().map(|e| e * e).sum::<f64>() / 9.0;
    let [place, angle] = poses(2).pose_rms(&brick());
    close(place, (0..3).map(|k| square(ERRORS[0], f64::from(k))).sum::<f64>().sqrt(), 1e-9);
    close(angle, square(ERRORS[2], 2.5).sqrt(), 1e-9);
}

/// Twelve numbers of each of 24 runs, two of each channel; six of fewer runs.
#[test]
fn exact_channels_of_poses_are_every_sixth_number() {
    for (runs, per_channel) in [(24, 2), (3, 1)] {
        let e = poses(runs);
        let z: Vec<f64> = (0..runs * BIN).map(|i| (0.3 + 1.7 * i as f64 + 0.1 * (i * i) as f64).sin()).collect();
        for (channel, judged) in e.channel_residuals(&z, 0).iter().enumerate() {
            let own = |r: usize, k: usize| z[r * BIN + 6 * k + channel];
            let values = DMatrix::from_fn(runs, per_channel, own);
            close(judged.rms, (values.norm_squared() / (runs * per_channel) as f64).sqrt(), 1e-14);
            let inputs = DMatrix::from_fn(runs, 1, |r, _| (0.7 * r as f64).sin());
            let expected = scatter::judge("", &values, &inputs, 0.0);
            close(judged.p_value, expected.p_value, 1e-12);
        }
        assert_eq!((e.peak_hz(&z, 0), e.slow_numbers()), (None, Some(6 * per_channel)));
    }
}
