//! discover tests: angles of measured poses against the sequence that they are made of, and flown poses from what they leave.

use super::*;
use crate::close::tests::{body, campaign};
use windfall_model::frames::EulerNed;

/// Angles that come from the aerospace sequence are it, and a heading that passes half a turn goes on.
#[test]
fn exact_roll_pitch_and_heading() {
    let poses: Vec<_> = [3.0, 3.2]
        .map(|psi_rad| {
            let e = EulerNed { psi_rad, theta_rad: -0.2, phi_rad: 0.1 }.to_xyz().r_tunnel_body();
            ([1.0, 2.0, 3.0], Rotation::from_matrix(e.matrix))
        })
        .to_vec();
    let all = series(&[0.0, 0.1], &poses);
    for (channel, expected) in all[3..6].iter().zip([[0.1_f64, 0.1], [-0.2, -0.2], [3.0, 3.2]]) {
        // Six digits are kept.
        assert!(channel.iter().zip(expected).all(|(a, b)| (a - b.to_degrees()).abs() < 1e-3), "{channel:?} {expected:?}");
    }
}

/// A heading that grows by two radians from pose to pose passes half a turn many times, and goes on.
#[test]
fn exact_heading_of_many_turns() {
    let at = |k: i32| {
        let e = EulerNed { psi_rad: 2.0 * f64::from(k), theta_rad: 0.1, phi_rad: -0.3 }.to_xyz().r_tunnel_body();
        ([0.0; 3], Rotation::from_matrix(e.matrix))
    };
    let poses: Vec<Pose> = (0..15).map(at).collect();
    let t: Vec<f64> = (0..15).map(f64::from).collect();
    let heading = &series(&t, &poses)[5];
    assert!((0..15).all(|k| (heading[k] - (2.0 * k as f64).to_degrees()).abs() < 1e-2), "{heading:?}");
}

/// A residual is measured less flown, and the rotation from the flown attitude to the measured one about the body's axes.
#[test]
fn exact_flown_poses_from_what_they_leave() {
    let attitude = |i: usize| {
        let k = i as f64;
        EulerNed { psi_rad: 0.4 * k, theta_rad: 0.2 - 0.1 * k, phi_rad: 0.3 * k }.to_xyz().r_tunnel_body()
    };
    let place = |i: usize, k: usize| 0.7 * (i as f64) - 0.2 * (k * k) as f64;
    let error = |i: usize, k: usize| 0.03 * ((1 + 5 * i + 3 * k) as f64).sin();
    let turned = |i: usize| attitude(i).matrix * rotation_of([3, 4, 5].map(|k| error(i, k))).matrix;
    let track = PointRecord {
        t_s: vec![7.0, 7.1, 7.25, 7.3],
        position_m: std::array::from_fn(|k| Some((0..4).map(|i| place(i, k) + error(i, k)).collect())),
        attitude: (0..4).map(|i| Rotation::<Tunnel, Body>::from_matrix(turned(i)).to_quaternion()).collect(),
        measured: Measured::Pose,
        ..PointRecord::default()
    };
    let left = TrackResidual {
        run: 0,
        measured: Measured::Pose,
        t_s: vec![0.0, 0.1, 0.25, 0.3],
        residual_m: std::array::from_fn(|k| Some((0..4).map(|i| error(i, k)).collect())),
        position_m: [0.0; 3],
        velocity_m_s: [0.0; 3],
    };
    // To rounding of a quaternion and back.
    for (i, (p, r)) in simulated(&track, &left).iter().enumerate() {
        assert!((0..3).all(|k| (p[k] - place(i, k)).abs() < 1e-14), "{i}: {p:?}");
        assert!((r.matrix - attitude(i).matrix).amax() < 1e-14, "{i}: {}", r.matrix);
    }
    let c = campaign(body(), &[], vec![(Vec::new(), track)]);
    let run = measured(&c, &c.runs[0]);
    assert!(run.t_s.iter().zip(&left.t_s).all(|(a, b)| (a - b).abs() < 1e-6), "{:?}", run.t_s);
}
