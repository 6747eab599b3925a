//! sim: motion of a rigid body in free flight through air at rest. In: a plant, a start, times. Out: states at those times, poses as recorded.

use crate::error::SimError;
use crate::seed::{Channel, Seed};
use nalgebra::{Rotation3, SVector, Vector3};
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};
use windfall_model::{FreeBody, FreeState, Measured, Plant, PointRecord};

/// Position, attitude, velocity and body rates.
type State = SVector<f64, 13>;

/// Largest share of a step's change by which neighbouring steps may be uneven before one more is taken: times in decimal seconds.
const ROUNDING: f64 = 1e-6;

fn packed(s: &FreeState) -> State {
    let mut y = State::zeros();
    y.fixed_rows_mut::<3>(0).copy_from(&s.p_tunnel_origin.xyz);
    y.fixed_rows_mut::<4>(3).copy_from_slice(&s.attitude);
    y.fixed_rows_mut::<3>(7).copy_from(&s.v_tunnel_origin.xyz);
    y.fixed_rows_mut::<3>(10).copy_from(&s.w_tunnel_body.xyz);
    y
}

fn unpacked(y: &State) -> FreeState {
    FreeState {
        p_tunnel_origin: Vec3::new(y[0], y[1], y[2]),
        attitude: [y[3], y[4], y[5], y[6]],
        v_tunnel_origin: Vec3::new(y[7], y[8], y[9]),
        w_tunnel_body: Vec3::new(y[10], y[11], y[12]),
    }
}

fn rate(body: &FreeBody, y: &State) -> State {
    let s = unpacked(y);
    let [v_rate, w_rate] = body.accelerations(&s);
    let travel = Rotation::<Tunnel, Body>::from_quaternion(s.attitude) * s.v_tunnel_origin;
    let ([w, x, y, z], [p, q, r]) = (s.attitude, s.w_tunnel_body.to_array());
    let turned = [-x * p - y * q - z * r, w * p + y * r - z * q, w * q + z * p - x * r, w * r + x * q - y * p];
    packed(&FreeState {
        p_tunnel_origin: travel,
        attitude: turned.map(|a| 0.5 * a),
        v_tunnel_origin: v_rate,
        w_tunnel_body: w_rate,
    })
}

/// One step of the classical Runge-Kutta method, the quaternion brought back to unit length.
fn stepped(body: &FreeBody, y: &State, h: f64) -> State {
    let a = rate(body, y);
    let b = rate(body, &(y + a * (0.5 * h)));
    let c = rate(body, &(y + b * (0.5 * h)));
    let d = rate(body, &(y + c * h));
    let mut out = y + (a + (b + c) * 2.0 + d) * (h / 6.0);
    let length = out.fixed_rows::<4>(3).norm();
    out.fixed_rows_mut::<4>(3).unscale_mut(length);
    out
}

/// States of a rigid body in free flight at `times_s` (s, increasing, uneven allowed), from `start` at the first of them, with the run's
/// inputs in `plant.point.inputs`. Steps are even between two times and not longer than `longest_step_s`, so that flights are smooth
/// functions of every number of the plant; their error falls with the fourth power of the step.
///
/// # Errors
/// A plant that is no rigid body in free flight, times that do not increase, a state that is not finite.
pub fn fly_free(plant: &Plant, times_s: &[f64], longest_step_s: f64, start: &FreeState) -> Result<Vec<FreeState>, SimError> {
    let body = FreeBody::new(plant).ok_or(SimError::NotFinite { what: "mass matrix of the body in free flight", t_s: 0.0 })?;
    if !(longest_step_s > 0.0 && longest_step_s.is_finite()) {
        return Err(SimError::Setup { what: "longest step, s", value: longest_step_s, allowed: "above zero" });
    }
    let mut y = packed(start);
    let mut before = times_s.first().copied().unwrap_or(0.0);
    let mut out = Vec::with_capacity(times_s.len());
    for &t_s in times_s {
        let interval_s = t_s - before;
        if !(interval_s >= 0.0 && interval_s.is_finite()) {
            return Err(SimError::Setup { what: "step to the next sample time, s", value: interval_s, allowed: "zero or more" });
        }
        let steps = (interval_s / longest_step_s - ROUNDING).ceil().max(if interval_s > 0.0 { 1.0 } else { 0.0 });
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of steps")]
        for _ in 0..steps as usize {
            y = stepped(&body, &y, interval_s / steps);
        }
        if !y.iter().all(|x| x.is_finite()) {
            return Err(SimError::NotFinite { what: "state of the body in free flight", t_s });
        }
        before = t_s;
        out.push(unpacked(&y));
    }
    Ok(out)
}

/// A flight of a rigid body in free flight, as it was and as it was recorded.
#[derive(Clone, Debug)]
pub struct FreeFlown {
    /// States at the recorded times.
    pub states: Vec<FreeState>,
    /// Pose as it was recorded.
    pub record: PointRecord,
    /// Steps of the integrator.
    pub steps: u64,
}

/// Steps of the integrator in a sample interval.
const STEPS_PER_SAMPLE: u64 = 2;

/// Flies for `duration_s` from `start` and records the pose at `rate_hz` as the plant's instruments do: of the tracked point, with scale, clock and
/// alignment; with their noise where a seed is given.
///
/// # Errors
/// As [`fly_free`].
pub fn record_free(
    plant: &Plant,
    duration_s: f64,
    rate_hz: f64,
    start: &FreeState,
    noise: Option<Seed>,
) -> Result<FreeFlown, SimError> {
    let none = SimError::Setup { what: "rigid body in free flight", value: 0.0, allowed: "[free_flight]" };
    let free = plant.free_flight.as_ref().ok_or(none)?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a checked number of samples")]
    let samples = (duration_s * rate_hz + ROUNDING).floor() as usize + 1;
    let t_s: Vec<f64> = (0..samples).map(|i| i as f64 / rate_hz).collect();
    let s = &plant.sensors;
    let ticks = 1.0 + s.time_base;
    let true_s: Vec<f64> = t_s.iter().map(|t| t / ticks).collect();
    let states = fly_free(plant, &true_s, 1.0 / (STEPS_PER_SAMPLE as f64 * rate_hz * ticks), start)?;
    let [rx_rad, ry_rad, rz_rad] = s.misalignment_rad;
    let reported = Rotation::<Body, Body>::from_matrix(EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body().matrix);
    let stds = [s.position_std_m, s.position_std_m, s.position_std_m, s.roll_std_rad, s.pitch_yaw_std_rad, s.pitch_yaw_std_rad];
    let mut normals: Vec<_> = (0..6_u8).map(|c| noise.map(|seed| seed.normals(Channel::Sensor(c)))).collect();
    let mut position: [Vec<f64>; 3] = Default::default();
    let mut attitude = Vec::with_capacity(samples);
    for state in &states {
        let error: Vec<f64> =
            normals.iter_mut().zip(stds).map(|(n, std)| std * n.as_mut().and_then(Iterator::next).unwrap_or(0.0)).collect();
        let r = Rotation::<Tunnel, Body>::from_quaternion(state.attitude);
        let p = (state.p_tunnel_origin + r * free.p_origin_tracked) * (1.0 + s.length_scale);
        position.iter_mut().zip(p.to_array()).zip(&error).for_each(|((series, x), e)| series.push(x + e));
        let turned = Rotation3::from_scaled_axis(Vector3::new(error[3], error[4], error[5])).into_inner();
        attitude.push((r * reported * Rotation::<Body, Body>::from_matrix(turned)).to_quaternion());
    }
    let record =
        PointRecord { t_s, position_m: position.map(Some), attitude, measured: Measured::Pose, ..PointRecord::default() };
    let steps = (samples as u64 - 1) * STEPS_PER_SAMPLE;
    Ok(FreeFlown { states, record, steps })
}
