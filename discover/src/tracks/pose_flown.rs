//! discover: a track of poses, flown. In: a plant and an initial state. Out: what would be recorded.

use super::pose::{KEPT, Poses, rotation_of, rotation_vector};
use super::track::{STATE_STEP, Track};
use nalgebra::{DVector, Matrix3};
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{FreeState, Plant};
use windfall_sim::fly_free;

/// True body axes from those that are reported.
fn reported(own: &Plant) -> Rotation<Body, Body> {
    let [rx_rad, ry_rad, rz_rad] = own.sensors.misalignment_rad;
    Rotation::from_matrix(EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix)
}

impl Track {
    /// States at the samples from an initial state.
    pub(super) fn pose_states(&self, poses: &Poses, own: &Plant, theta: &DVector<f64>) -> Option<Vec<FreeState>> {
        let three = |k: usize| [theta[k], theta[k + 1], theta[k + 2]];
        let free = own.free_flight.as_ref()?;
        // Recorded times are the true ones times `ticks`, positions times `longer`, attitudes turned by `reported`.
        let (ticks, longer, reported) = (1.0 + own.sensors.time_base, 1.0 + own.sensors.length_scale, reported(own));
        let per_s = ticks / self.duration_s();
        let attitude = poses.r_tunnel_body[0] * rotation_of(three(3)) * reported.inverse();
        let w_tunnel_body = reported * (Vec3::<Body>::from_array(three(9)) * per_s);
        let velocity = Vec3::<Tunnel>::from_array(three(6)) * (per_s / longer);
        let start = FreeState {
            p_tunnel_origin: Vec3::<Tunnel>::from_array(three(0)) * (1.0 / longer) - attitude * free.p_origin_tracked,
            attitude: attitude.to_quaternion(),
            v_tunnel_origin: attitude.inverse() * velocity - w_tunnel_body.cross(free.p_origin_tracked),
            w_tunnel_body,
        };
        let t_s: Vec<f64> = self.t_s.iter().map(|t| t / ticks).collect();
        fly_free(own, &t_s, poses.step_s, &start).ok()
    }

    /// Whether a change of the initial velocity or rates is still there at the end: central differences about the record's own state.
    pub(super) fn keeps_its_start(&self, poses: &Poses, own: &Plant) -> Option<bool> {
        let theta = poses.start(self.duration_s());
        let end = |k: usize, by: f64| {
            let mut moved = theta.clone();
            moved[k] += by;
            self.pose_states(poses, own, &moved)?.last().copied()
        };
        let mut blocks = [Matrix3::zeros(); 2];
        for k in 0..6 {
            let (up, down) = (end(6 + k, STATE_STEP)?, end(6 + k, -STATE_STEP)?);
            let velocity = |s: &FreeState| Rotation::<Tunnel, Body>::from_quaternion(s.attitude) * s.v_tunnel_origin;
            let changes = [(velocity(&up) - velocity(&down)).xyz, (up.w_tunnel_body - down.w_tunnel_body).xyz];
            let per_unit = 0.5 * self.duration_s() / STATE_STEP;
            blocks[k / 3].set_column(k % 3, &(changes[k / 3] * per_unit));
        }
        Some(blocks.iter().all(|b| b.determinant().abs().cbrt() >= KEPT))
    }

    /// What would be recorded: positions along X, Y, Z, then rotations from the measured attitudes about x, y, z.
    pub(super) fn pose_flown(&self, poses: &Poses, own: &Plant, theta: &DVector<f64>) -> Option<DVector<f64>> {
        let states = self.pose_states(poses, own, theta)?;
        let free = own.free_flight.as_ref()?;
        let longer = 1.0 + own.sensors.length_scale;
        let reported = reported(own);
        let n = states.len();
        let mut out = DVector::zeros(6 * n);
        for (i, s) in states.iter().enumerate() {
            let attitude = Rotation::<Tunnel, Body>::from_quaternion(s.attitude);
            let position = (s.p_tunnel_origin + attitude * free.p_origin_tracked) * longer;
            let turned = rotation_vector(poses.r_tunnel_body[i].inverse() * (attitude * reported));
            for (a, x) in position.to_array().into_iter().chain(turned).enumerate() {
                out[a * n + i] = x;
            }
        }
        Some(out)
    }

    /// Speed (m/s), angle of attack and of sideslip (rad) at every sample.
    pub(super) fn pose_flow(&self, poses: &Poses, own: &Plant, theta: &DVector<f64>) -> Option<Vec<[f64; 3]>> {
        let air = own.free_flight.as_ref()?.v_tunnel_air;
        let flow = |s: &FreeState| {
            let u = s.v_tunnel_origin - Rotation::<Tunnel, Body>::from_quaternion(s.attitude).inverse() * air;
            [u.norm(), u.z().atan2(u.x()), u.y().atan2(u.x().hypot(u.z()))]
        };
        Some(self.pose_states(poses, own, theta)?.iter().map(flow).collect())
    }
}

#[cfg(test)]
mod tests;
