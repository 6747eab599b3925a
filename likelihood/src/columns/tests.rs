//! likelihood tests: bases by formulas written out, what is shown by rotations multiplied together.

use super::*;
use nalgebra::{Rotation2, Rotation3, Vector2, Vector3};
use std::f64::consts::{PI, TAU};
use windfall_pid::equations::Dual;

/// Each basis by its words. The total angle's rate is a difference along the motion (h² of a third derivative: 1e-10).
#[test]
fn exact_bases() {
    let (t, [y, z], roll, [a, b], w) = (3.7, [0.23, -0.17], 0.7, [0.21, -0.13], [0.31, -0.07, 0.11]);
    let v = View {
        run: 2,
        t_s: t,
        duration_s: 12.5,
        speed_m_s: 8.1,
        mean_speed_m_s: 7.4,
        tunnel_speed_m_s: 7.9,
        height_m: -0.41,
        away_m: [y, z],
        roll_rad: roll,
        alpha_rad: a,
        beta_rad: b,
        rates_rad_s: w,
    };
    let (total, own) = (Vector2::new(a, b).norm(), Rotation2::new(-roll) * Vector2::new(y, z) / 0.3);
    let later = |h: f64| Vector2::new(a + h * (w[1] - w[0] * b), b + h * (w[0] * a - w[2])).norm();
    let opening = ((later(1e-5) - later(-1e-5)) / 2e-5 * 10.0).tanh();
    let (fast, slow, high) = (7.0 / 7.4, 5.0 / 7.4, -4.1 / 3.0);
    let all = [
        (Basis::Time(3), (2.0 * PI * t / 12.5).cos()),
        (Basis::Time(6), (3.0 * PI * t / 12.5).sin()),
        (Basis::Run(2), 1.0),
        (Basis::Run(3), 0.0),
        (Basis::Speed(2), fast * fast),
        (Basis::TunnelSpeed(3), slow * slow * slow),
        (Basis::Height(2), high * high),
        (Basis::Place(2, 1), y * y * z / 0.027),
        (Basis::Away(1, 2), own.norm_squared() * own.x),
        (Basis::Away(2, 2), own.norm_squared() * own.y),
        (Basis::Angle(3, false), total * total * a / 0.027),
        (Basis::Angle(3, true), total * total * b / 0.027),
        (Basis::TotalAngle(4), (a * a + b * b).powi(2) / 0.0081),
        (Basis::OneSided(2, 2), b * b / 0.09),
        (Basis::Roll(3, false), (3.0 * roll).cos()),
        (Basis::Roll(3, true), (3.0 * roll).sin()),
        (Basis::Hysteresis(1, false), -(0.7_f64.tanh())),
        (Basis::Hysteresis(2, true), 1.1_f64.tanh() * 1.3 / 3.0),
        (Basis::Opening(1), opening * a / 0.3),
        (Basis::Opening(2), opening * b / 0.3),
        (Basis::BothAngles, a * b / 0.09),
        (Basis::Rate(1), w[1]),
        (Basis::RateSquare(1), -w[1] * w[1]),
        (Basis::Elapsed(2), 0.37 * 0.37),
        (Basis::Slope(0, Along::Speed), fast),
        (Basis::Slope(1, Along::Time), 0.37 * 0.7),
        (Basis::Slope(2, Along::Height), -high * 1.3 / 3.0),
        (Basis::Damping(2, Along::Height), high * w[2]),
    ];
    for (basis, value) in all {
        assert!((basis.value(&v) - value).abs() < 1e-9, "{basis:?}: {} {value}", basis.value(&v));
    }
}

/// Times of samples are read late: what is late alike is not.
#[test]
fn exact_lag_of_the_record() {
    let lag = |pose_delay_s, wind_delay_s| lag_s(&Sensors { pose_delay_s, wind_delay_s, ..Sensors::default() });
    assert!((lag(0.03, 0.11) - 0.08).abs() < 1e-15 && lag(0.07, 0.07).abs() < 1e-15);
}

fn rotation([rx, ry, rz]: [f64; 3]) -> Rotation3<f64> {
    let about = Rotation3::from_axis_angle;
    about(&Vector3::x_axis(), rx) * about(&Vector3::y_axis(), ry) * about(&Vector3::z_axis(), rz)
}

/// A body turned on by many small rotations about its own axes, its roll angle after three turns: one sample late, and the mean of
/// three. Left over are third powers of times and, of the mean, products of two turns: ω² t² |arm|/2 of the place, (ω t)²/2 of the
/// attitude.
#[test]
fn exact_what_is_shown_is_the_mean_along_the_motion() {
    const STEPS: u32 = 2000;
    let arm = Vector3::new(0.12, -0.07, 0.05);
    let x = [0.1, -0.2, 0.3, 2.4 + 3.0 * TAU, -0.3, 0.2 - TAU, 0.5, -0.4, 0.3, 1.0, -0.8, 0.6];
    let rate: [f64; STATES] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.1, -2.3, 4.2, -5.3, 7.2, 6.1];
    let part = |x: &[f64], k: usize| Vector3::new(x[k], x[k + 1], x[k + 2]);
    let after = |t: f64| {
        let h = t / f64::from(STEPS);
        let mut attitude = rotation([x[3], x[4], x[5]]);
        for i in 0..STEPS {
            attitude *= Rotation3::new((part(&x, 9) + part(&rate, 9) * (h * (f64::from(i) + 0.5))) * h);
        }
        (part(&x, 0) + part(&x, 6) * t + part(&rate, 6) * (0.5 * t * t), attitude)
    };
    for (misalignment, scale) in [([0.0; 3], 0.0), ([0.21, -0.13, 0.34], 0.07)] {
        let sensors = Sensors { misalignment_rad: misalignment, length_scale: scale, ..Sensors::default() };
        for times in [[0.006; 3], [-0.003, 0.002, 0.004]] {
            let mean = |of: &dyn Fn(f64) -> f64| times.into_iter().map(of).sum::<f64>() / 3.0;
            let found = shown(&sensors, arm.into(), &x, &rate, [mean(&|t| t), mean(&|t| t * t)]);
            for (k, shown) in found[..3].iter().enumerate() {
                let origin = |t: f64| {
                    let (place, attitude) = after(t);
                    (place - attitude * arm)[k] * (1.0 + scale)
                };
                assert!((shown - mean(&origin)).abs() < 2e-6, "{k} {times:?}: {shown}");
            }
            // Small angles between the attitude that is shown and each sample's: their mean is none.
            let angles = [found[3], found[4], found[5]];
            let off: Vector3<f64> =
                times.iter().map(|t| (rotation(angles).inverse() * after(*t).1 * rotation(misalignment)).scaled_axis()).sum();
            assert!(off.amax() / 3.0 < 1e-5, "{times:?}: {off}");
            assert!((0..3).all(|k| (angles[k] - x[3 + k]).abs() < 1.0), "turns are kept: {angles:?}");
        }
    }
}

/// Slopes of what is shown are those of central differences, with and without a misaligned body and a scale.
#[test]
fn exact_slopes_of_what_is_shown() {
    let arm = [0.02, -0.01, 0.03];
    let x = [0.1, -0.2, 0.3, 0.4, -0.3, 0.2, 0.5, -0.4, 0.3, 1.0, -0.8, 0.6];
    let rate: Vec<f64> = (0..16).map(|i| 0.3 * f64::from(i) - 1.0).collect();
    for (misalignment, scale) in [([0.0; 3], 0.0), ([0.02, -0.03, 0.04], 0.01)] {
        let sensors = Sensors { misalignment_rad: misalignment, length_scale: scale, ..Sensors::default() };
        let of = |x: &[f64; STATES]| shown(&sensors, arm, x, &rate, [0.004, 3e-5]);
        let duals = shown(&sensors, arm, &std::array::from_fn(|i| Dual::<STATES>::variable(x[i], i)), &rate, [0.004, 3e-5]);
        for i in 0..STATES {
            let at = |by: f64| of(&std::array::from_fn(|k| if k == i { x[k] + by } else { x[k] }));
            let (up, down) = (at(1e-5), at(-1e-5));
            for c in 0..POSE {
                // h²/6 of third derivatives of order one, and rounding over h.
                assert!((duals[c].slopes[i] - (up[c] - down[c]) / 2e-5).abs() < 1e-9, "{c} by {i}");
            }
        }
    }
}
