//! discover tests: poses and their start.

use super::super::tests::{close, thrown, times};
use super::*;
use nalgebra::Matrix4;

/// There and back to rounding, from far below a sensor's noise to nearly half a turn.
#[test]
fn law_rotation_vectors_round_trip() {
    for v in [[0.0, 0.0, 0.0], [1e-9, -2e-9, 3e-9], [0.1, -0.2, 0.05], [-1.5, 2.0, 1.0]] {
        let back = rotation_vector(rotation_of(v));
        assert!(v.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-15 + 1e-14 * a.abs()), "{v:?} {back:?}");
    }
}

/// Poses that follow no cubic, turned by rotation vectors from a crooked attitude.
fn crooked(samples: usize, first_s: f64) -> (PointRecord, Vec<[f64; 3]>) {
    let t_s = times(samples, first_s, first_s + 0.02 * samples as f64);
    let own = |i: usize, k: usize| (0.7 * k as f64 + 1.3 * i as f64).sin();
    let turns: Vec<[f64; 3]> = (0..samples).map(|i| [4, 5, 6].map(|k| 0.3 * (own(i, k) - own(0, k)))).collect();
    let base = Rotation::<Tunnel, Body>::from_quaternion([0.5, -0.1, 0.7, 0.5_f64]);
    let mut record = thrown(&t_s, &[0, 1, 2], [1.0, -2.0, 0.4], [2.0, 3.0, -1.0]);
    for (k, series) in record.position_m.iter_mut().flatten().enumerate() {
        series.iter_mut().enumerate().for_each(|(i, x)| *x += own(i, k));
    }
    record.attitude = turns.iter().map(|v| (base * rotation_of(*v)).to_quaternion()).collect();
    (record, turns)
}

/// Values and slopes at the first sample of cubics by least squares, from normal equations in the time over that of eleven samples
/// of 240, of which every fifth is kept, and over that of eight where there are no more; late in a record, where times have
/// round-off of 3e-11 s.
#[test]
fn exact_start_is_that_of_cubics_by_least_squares() {
    for (samples, first_s, n) in [(240, 0.0, 11), (8, 0.0, 8), (240, 2e5, 11)] {
        let (record, turns) = crooked(samples, first_s);
        let (found, _) = first_of(&record).expect("poses");
        let unit = |i: usize| (record.t_s[i] - first_s) / (record.t_s[n - 1] - first_s);
        let powers = DMatrix::from_fn(n, 4, |i, k| unit(i).powi(k as i32));
        let normal = Matrix4::from_fn(|i, k| powers.column(i).dot(&powers.column(k)));
        for channel in 0..6 {
            let series = |i: usize| {
                record.position_m.get(channel).map_or_else(|| turns[i][channel - 3], |s| s.as_ref().expect("measured")[i])
            };
            let right = powers.tr_mul(&DVector::from_fn(n, |i, _| series(i)));
            let c = normal.lu().solve(&right.fixed_rows::<4>(0).into_owned()).expect("regular");
            close(found[0][channel], c[0], 1e-9);
            close(found[1][channel], c[1] / (record.t_s[n - 1] - first_s), 1e-7);
        }
    }
}

/// Steps of two intervals, from the first time to the last, and rates times a duration.
#[test]
fn exact_step_and_start_of_poses() {
    let (record, _) = crooked(9, 3.7);
    let poses = Poses::of(&record, &record).expect("poses");
    close(poses.step_s, 2.0 * 0.18 / 8.0, 1e-14);
    let start = poses.start(1.3);
    (0..6).for_each(|k| close(start[k], poses.first[0][k], 0.0));
    (0..6).for_each(|k| close(start[6 + k], 1.3 * poses.first[1][k], 1e-14));
}
