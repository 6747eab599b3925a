//! discover tests: figures of runs against sums by hand and against the attitude's quaternion.

use super::*;
use crate::statistics::tests::setup;

/// Sums and sums of squares of five numbers.
#[test]
fn exact_moments() {
    let x = [3.5, -7.25, 1.125, 0.4, 2.0];
    let (sum, squares) = (-0.225, 12.25 + 52.5625 + 1.265_625 + 0.16 + 4.0);
    let expected = [
        (Moment::Mean, sum / 5.0),
        (Moment::Std, f64::sqrt((squares - sum * sum / 5.0) / 4.0)),
        (Moment::Median, 1.125),
        (Moment::LargestSize, 7.25),
    ];
    for (which, expected) in expected {
        assert!((moment(which, x.to_vec()) - expected).abs() < 1e-14, "{which:?}");
    }
}

/// Of the truth: Θ is the angle whose cosine is `1 − 2 (q_y² + q_z²)` of the quaternion.
#[test]
fn exact_angle_of_the_truth() {
    let setup = setup();
    let rows = true_runs(&setup, &setup.plant, 4..6).expect("flies");
    for (row, run) in rows.iter().zip(4..) {
        let (truth, _) = fly_truth(&setup.plant, &setup.flown, Seed { campaign: setup.seed, run }).expect("flies");
        let theta = |[_, _, y, z]: &[f64; 4]| (1.0 - 2.0 * (y * y + z * z)).acos().to_degrees();
        let omega = |[_, q, r]: &[f64; 3]| q.hypot(*r).to_degrees();
        let mean = |x: Vec<f64>| x.iter().sum::<f64>() / x.len() as f64;
        let expected = [
            mean(truth.quaternion.iter().map(theta).collect()),
            mean(truth.w_tunnel_body.iter().map(omega).collect()),
            truth.w_tunnel_body.iter().map(|w| w[1].abs().to_degrees()).fold(0.0, f64::max),
        ];
        assert!(expected[0] > 1.0);
        for (found, expected) in row.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{run}: {found} {expected}");
        }
    }
}

/// Every other sample of 800, in degrees, to six digits.
#[test]
fn exact_history() {
    let mut setup = setup();
    setup.flown.rate_hz = 400.0;
    let found = history(&setup, &setup.plant, vec!["x"], 3).expect("flies");
    let record = fly(&setup.plant, &setup.flown, Seed { campaign: setup.seed, run: 3 }).expect("flies").record;
    let a = measured(&record).expect("smooth");
    assert_eq!((record.len(), found.t_s.len(), found.run), (801, 401, 3));
    for (series, all, per_unit) in [
        (&found.t_s, &a.t_s, 1.0),
        (&found.theta_deg, &a.theta_rad, 180.0 / std::f64::consts::PI),
        (&found.omega_qr_deg_s, &a.omega_qr_rad_s, 180.0 / std::f64::consts::PI),
    ] {
        for (k, x) in series.iter().enumerate() {
            let expected = per_unit * all[2 * k];
            assert!((x - expected).abs() <= 6e-6 * expected.abs(), "{k}: {x} {expected}");
        }
    }
}
