//! pid: the two measures of the lander's swinging (thesis §5.3.3). In: a run record. Out: Θ and ω_q,r at its samples.

use crate::PidError;
use crate::euler::rates;
use crate::smooth::{Smoother, smooth};
use windfall_model::Record;
use windfall_model::frames::EulerXyz;

/// Series at the samples of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Angles {
    /// Times, s.
    pub t_s: Vec<f64>,
    /// Off-vertical angle Θ, rad (eq. 5.1).
    pub theta_rad: Vec<f64>,
    /// Pitch and yaw rate ω_q,r, rad/s (eq. 5.2).
    pub omega_qr_rad_s: Vec<f64>,
    /// Body rates p, q, r, rad/s.
    pub pqr_rad_s: Vec<[f64; 3]>,
}

/// Θ and ω_q,r of a record, smoothed as asked.
///
/// # Errors
/// As [`smooth`].
pub fn rates_and_angles(record: &Record, smoother: &Smoother) -> Result<Angles, PidError> {
    let s = smooth(record, smoother)?;
    let [_, _, _, rx, ry, rz, _] = &s.channels;
    let pqr_rad_s: Vec<[f64; 3]> = (0..s.t_s.len())
        .map(|i| rates([rx.value[i], ry.value[i], rz.value[i]], [rx.rate[i], ry.rate[i], rz.rate[i]], [0.0; 3]).0)
        .collect();
    Ok(Angles {
        theta_rad: (0..s.t_s.len())
            .map(|i| EulerXyz { rx_rad: rx.value[i], ry_rad: ry.value[i], rz_rad: rz.value[i] }.off_vertical_rad())
            .collect(),
        omega_qr_rad_s: pqr_rad_s.iter().map(|[_, q, r]| q.hypot(*r)).collect(),
        pqr_rad_s,
        t_s: s.t_s,
    })
}
