//! discover tests: flown poses against the simulator's record, and how much of a start is kept against its decay by damping.

use super::super::tests::{brick, close, thrown, times};
use super::*;
use windfall_model::{Measured, PointRecord};
use windfall_sim::record_free;

/// A tumbling body whose tracked point, clock, scale and axes are off, as the simulator records it: the start as it was recorded
/// leaves nothing but a turn that was put into the first measured attitude. Its step of 20 ms beside the simulator's of 10 ms
/// leaves 1e-8.
#[test]
fn exact_poses_are_those_that_are_recorded() {
    let mut plant = brick();
    plant.free_flight.as_mut().expect("rigid").p_origin_tracked = Vec3::new(0.2, -0.3, 0.5);
    (plant.sensors.time_base, plant.sensors.length_scale) = (0.02, 0.03);
    plant.sensors.misalignment_rad = [0.1, -0.2, 0.15];
    let attitude = Rotation::<Tunnel, Body>::from_quaternion([0.5, -0.1, 0.7, 0.5]);
    let start = FreeState {
        p_tunnel_origin: Vec3::new(1.0, -2.0, 0.4),
        attitude: attitude.to_quaternion(),
        v_tunnel_origin: Vec3::new(2.0, 0.5, -1.0),
        w_tunnel_body: Vec3::new(1.1, -0.7, 0.9),
    };
    let mut record = record_free(&plant, 0.3, 50.0, &start, None).expect("flies").record;
    let (first, turn) = (record.attitude[0], [0.05, -0.03, 0.04]);
    let reported = attitude.inverse() * Rotation::<Tunnel, Body>::from_quaternion(first);
    record.attitude[0] = (Rotation::<Tunnel, Body>::from_quaternion(first) * rotation_of(turn).inverse()).to_quaternion();
    let track = Track::new(&record, &[], 0, &plant, false).expect("flies");
    let poses = Poses::of(&record, &record).expect("poses");
    let tracked = Vec3::<Body>::new(0.2, -0.3, 0.5);
    let speed = attitude * (start.v_tunnel_origin + start.w_tunnel_body.cross(tracked)) * (1.03 / 1.02 * 0.3);
    let rates = reported.inverse() * start.w_tunnel_body * (0.3 / 1.02);
    let place = (start.p_tunnel_origin + attitude * tracked) * 1.03;
    let theta = [place.to_array(), turn, speed.to_array(), rates.to_array()].concat();
    let flown = track.pose_flown(&poses, &track.own(&plant), &DVector::from_vec(theta)).expect("flies");
    let n = record.t_s.len();
    assert_eq!((n, flown.len()), (16, 96));
    for i in 0..n {
        (0..3).for_each(|a| close(flown[a * n + i], record.position_m[a].as_ref().expect("measured")[i], 1e-7));
        (0..3).for_each(|a| close(flown[(3 + a) * n + i], if i == 0 { turn[a] } else { 0.0 }, 1e-7));
    }
}

/// Rates that fall by `exp(−λ T)` about every axis, `λ` a moment per rate over an inertia, to a little more or less than the half
/// from which a flight keeps its start; the velocity stays as it is.
#[test]
fn exact_start_is_kept_where_half_of_it_is() {
    let t_s = times(9, 0.0, 0.7);
    let record = PointRecord {
        measured: Measured::Pose,
        attitude: vec![[0.5, -0.1, 0.7, 0.5]; 9],
        ..thrown(&t_s, &[0, 1, 2], [1.0; 3], [2.0, 3.0, -1.0])
    };
    for (kept, keeps) in [(0.51, true), (0.49, false)] {
        let mut plant = brick();
        let per_s = -f64::ln(kept) / 0.7;
        plant.free_flight.as_mut().expect("rigid").rate_damping_n_m_s = [0.02, 0.03, 0.04].map(|inertia| -per_s * inertia);
        assert_eq!(Track::new(&record, &[], 0, &plant, false).expect("flies").given, !keeps, "{kept}");
    }
}
