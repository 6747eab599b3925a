//! pid: states by components (thesis §3.3 and Appendix B). In: smoothed signals. Out: velocities, rates and wind angles.
//!
//! Transcribed from the printed equations with Euler angles and components, on purpose not with the vector code of `model`.

use crate::PidError;
use crate::euler::Sines;
use crate::instrument::{Sample, sample};
use crate::smooth::Smoothed;
use windfall_model::{Plant, RunChannel};

/// Everything that a coefficient or regressor is made of, at one sample. SI, rad; axes in the names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Time, s: that of the record with the error of its clock undone.
    pub t_s: f64,
    /// Geometric origin in tunnel axes, m.
    pub p_tunnel_origin: [f64; 3],
    /// Its velocity in tunnel axes, m/s.
    pub v_tunnel_origin: [f64; 3],
    /// c.m. in tunnel axes, m.
    pub p_tunnel_cm: [f64; 3],
    /// c.m. velocity in tunnel axes, m/s.
    pub v_tunnel_cm: [f64; 3],
    /// R_x, R_y, R_z, rad.
    pub euler_rad: [f64; 3],
    /// Their rates, rad/s.
    pub euler_rate: [f64; 3],
    /// Body-to-tunnel matrix, by rows (eq. B.14).
    pub t_bef: [[f64; 3]; 3],
    /// Body rates p, q, r, rad/s (eq. 3.20).
    pub pqr: [f64; 3],
    /// Their derivatives, rad/s² (eq. 3.22).
    pub pqr_rate: [f64; 3],
    /// c.m. velocity against the tunnel, body axes, m/s (eq. 3.25).
    pub uvw: [f64; 3],
    /// Derivative of these components, m/s² (eq. 3.27).
    pub uvw_rate: [f64; 3],
    /// c.m. velocity against the air, body axes, m/s (eq. B.37).
    pub uvw_air: [f64; 3],
    /// Derivative of these components, m/s² (eq. B.40).
    pub uvw_air_rate: [f64; 3],
    /// Airspeed V_∞, m/s (eq. B.39).
    pub speed: f64,
    /// Dynamic pressure q_∞, Pa (eq. B.44).
    pub q_pa: f64,
    /// Angle of attack α, rad (eq. B.45).
    pub alpha: f64,
    /// Sideslip β, rad (eq. B.46).
    pub beta: f64,
    /// Total angle of attack α_T, rad (eq. B.47).
    pub alpha_t: f64,
    /// α̇, rad/s (eq. B.49).
    pub alpha_dot: f64,
    /// β̇, rad/s (eq. B.50).
    pub beta_dot: f64,
    /// Density, kg/m³.
    pub density: f64,
    /// Tunnel speed V_W, m/s.
    pub vw: f64,
    /// Its rate, m/s².
    pub vw_rate: f64,
}

impl State {
    /// Clock angle φ_αT, rad (eq. B.48); 0 at α_T = 0.
    #[must_use]
    pub fn phi(&self) -> f64 {
        let [_, v, w] = self.uvw_air;
        v.atan2(w)
    }
    /// An error where airspeed vanishes, the nose is horizontal or a value is not finite.
    #[inline]
    pub(crate) fn checked(&self) -> Result<(), PidError> {
        let ry_rad = self.euler_rad[1];
        let upright = ry_rad.abs() < std::f64::consts::FRAC_PI_2;
        if self.speed > 0.0 && self.beta_dot.is_finite() && self.alpha_dot.is_finite() && upright {
            return Ok(());
        }
        Err(PidError::NoFlow { t_s: self.t_s, speed_m_s: self.speed, ry_rad })
    }
}

/// States of a smoothed run. Instrument errors of the plant are undone; its mean flow gives the wind.
///
/// # Errors
/// [`PidError::NoFlow`] where airspeed vanishes, the nose is horizontal (|R_y| = 90°) or a value is not finite.
pub fn states(s: &Smoothed, plant: &Plant) -> Result<Vec<State>, PidError> {
    (0..s.t_s.len())
        .map(|i| {
            let state = state_at(s, plant, i);
            state.checked()?;
            Ok(state)
        })
        .collect()
}

/// State at sample i of a smoothed run, not yet checked.
#[inline(always)]
pub(crate) fn state_at(s: &Smoothed, plant: &Plant, i: usize) -> State {
    let density = plant.environment.density_kg_m3(s.ps_pa[i], s.ts_k[i]);
    state(s.t_s[i] / (1.0 + plant.sensors.time_base), &sample(s, &plant.sensors, i), density, plant)
}

/// State of one instant, not yet checked.
#[inline(always)]
pub(crate) fn state(t_s: f64, x: &Sample, density: f64, plant: &Plant) -> State {
    let pick = |first: usize, order: usize| [x[first][order], x[first + 1][order], x[first + 2][order]];
    let (position, velocity, acceleration) = (pick(0, 0), pick(0, 1), pick(0, 2));
    let (euler, euler_rate) = (pick(3, 0), pick(3, 1));
    let r_cm = plant.vehicle.p_origin_cm.to_array();
    let sines = Sines::of(euler);
    let (t, t_dot) = (sines.t_bef(), sines.t_bef_rate(euler_rate));
    let (pqr, pqr_rate) = sines.rates(euler_rate, pick(3, 2));
    // Eqs 3.25-3.28.
    let uvw = add(transposed(&t, velocity), cross(pqr, r_cm));
    let uvw_rate = add(add(transposed(&t_dot, velocity), transposed(&t, acceleration)), cross(pqr_rate, r_cm));
    let p_cm = add(position, times(&t, r_cm));
    let v_cm = add(velocity, times(&t_dot, r_cm));
    let [vw, vw_rate, _] = x[RunChannel::Wind.at()];
    let (wind, wind_rate) = wind(plant, p_cm, v_cm, vw, vw_rate);
    // Eqs B.37-B.41, for a wind with all three components.
    let uvw_air = sub(uvw, transposed(&t, wind));
    let uvw_air_rate = sub(uvw_rate, add(transposed(&t, wind_rate), transposed(&t_dot, wind)));
    let a = wind_angles(uvw_air, uvw_air_rate);
    State {
        t_s,
        p_tunnel_origin: position,
        v_tunnel_origin: velocity,
        p_tunnel_cm: p_cm,
        v_tunnel_cm: v_cm,
        euler_rad: euler,
        euler_rate,
        t_bef: t,
        pqr,
        pqr_rate,
        uvw,
        uvw_rate,
        uvw_air,
        uvw_air_rate,
        speed: a.speed,
        q_pa: 0.5 * density * a.speed * a.speed,
        alpha: a.alpha,
        beta: a.beta,
        alpha_t: a.alpha_t,
        alpha_dot: a.alpha_dot,
        beta_dot: a.beta_dot,
        density,
        vw,
        vw_rate,
    }
}

/// Air velocity and its total rate at the c.m., tunnel axes: upward V_W (eq. B.38), varied across the section as the plant says.
fn wind(plant: &Plant, p: [f64; 3], v: [f64; 3], vw: f64, vw_rate: f64) -> ([f64; 3], [f64; 3]) {
    let f = &plant.flow;
    let ([_, y, z], [_, y_dot, z_dot]) = (p, v);
    let [g_y, g_z] = f.gradient_per_m;
    let factor = 1.0 + f.profile_per_m2 * (y * y + z * z) + g_y * y + g_z * z;
    let factor_dot = 2.0 * f.profile_per_m2 * (y * y_dot + z * z_dot) + g_y * y_dot + g_z * z_dot;
    let swirl = f.swirl_rad_per_m;
    let lateral = [f.angularity_rad[0] - swirl * z, f.angularity_rad[1] + swirl * y];
    let lateral_dot = [-swirl * z_dot, swirl * y_dot];
    let (across, across_rate) = if f.steady_at_m_s == 0.0 { (vw, vw_rate) } else { (f.steady_at_m_s, 0.0) };
    (
        [-vw * factor, across * lateral[0], across * lateral[1]],
        [
            -vw_rate * factor - vw * factor_dot,
            across_rate * lateral[0] + across * lateral_dot[0],
            across_rate * lateral[1] + across * lateral_dot[1],
        ],
    )
}

/// Airspeed across the body, m/s.
#[expect(
    clippy::imprecise_flops,
    reason = "speeds are far from where squares overflow or vanish, and this is done at every sample"
)]
pub(crate) fn across(v: f64, w: f64) -> f64 {
    (v * v + w * w).sqrt()
}

struct WindAngles {
    speed: f64,
    alpha: f64,
    beta: f64,
    alpha_t: f64,
    alpha_dot: f64,
    beta_dot: f64,
}

/// Eqs B.39, B.45-B.47, B.49-B.50.
fn wind_angles([u, v, w]: [f64; 3], [u_dot, v_dot, w_dot]: [f64; 3]) -> WindAngles {
    let speed2 = u * u + v * v + w * w;
    let speed = speed2.sqrt();
    let uw2 = u * u + w * w;
    WindAngles {
        speed,
        alpha: w.atan2(u),
        beta: (v / speed).clamp(-1.0, 1.0).asin(),
        // B.47 as an arctangent: the same angle, without the arccosine's loss of digits near 0.
        alpha_t: across(v, w).atan2(u),
        alpha_dot: (u * w_dot - u_dot * w) / uw2,
        beta_dot: (v_dot * speed2 - v * (u * u_dot + v * v_dot + w * w_dot)) / (speed2 * uw2.sqrt()),
    }
}

pub(crate) fn times(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}
pub(crate) fn transposed(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| m[0][k] * v[0] + m[1][k] * v[1] + m[2][k] * v[2])
}
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
