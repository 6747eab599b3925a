//! sim: motion of a rigid body in free flight through air at rest. In: a plant, a start, times. Out: states at those times.

use crate::error::SimError;
use nalgebra::SVector;
use windfall_model::frames::{Body, Rotation, Tunnel, Vec3};
use windfall_model::{FreeBody, FreeState, Plant};

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
