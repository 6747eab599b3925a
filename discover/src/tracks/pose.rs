//! discover: poses of a rigid body in free flight. In: positions and attitudes as recorded. Out: those that are kept, and the initial state
//! (`pose_flown` flies from it).
//!
//! The attitude enters as a vector: the rotation from the measured attitude of a sample to the flown one, in the body's axes, rad. What was
//! measured is then zero, and residuals are small rotations about x, y and z. An initial state is position, the rotation vector from the
//! first measured attitude, and velocity (tunnel axes) and body rates times the duration: twelve numbers, as the record has them.
//!
//! Where air damps a light body within seconds, the state is that of cubics through the record's first samples, the same under every plant. The best state of
//! a whole flight would be another: a wrong model may ask for any velocity at the start to be elsewhere later. What the
//! cubics are off by changes nothing, to first order: bases are orthogonal to a change of the initial state, as those of other tracks. A flight that keeps
//! its start ([`KEPT`]) is flown from its best state, as other tracks are.
//!
//! Records are thinned and not averaged: those that their makers have smoothed gain nothing by a mean, and white noise costs what a
//! sample in so many has.

use nalgebra::{DMatrix, DVector, Matrix2, Rotation3, UnitQuaternion, Vector3};
use windfall_model::PointRecord;
use windfall_model::frames::{Body, Rotation, Tunnel};

/// Most samples of a track of poses.
const MOST: usize = 48;
/// Kept samples in the arc that the start is taken from, and fewest samples of the record in it.
const FIRST: usize = 2;
const FEWEST: usize = 8;
/// Share of a change of the initial velocity, and of the initial rates, that is left at a flight's end, from which it keeps its start: the volume that
/// three independent changes span, its cube root. One in a vacuum, whatever the inertia (Liouville); 1/e after one time constant of damping.
pub(super) const KEPT: f64 = 0.5;
/// Samples of the record in a step of its flights: a record follows its motion, so that the classical method at twice its interval is
/// right to far below its noise (`order_four_and_right_at_the_step_of_a_record` of the simulator's tests).
const STEP: f64 = 2.0;

/// Attitudes of a track.
pub(super) struct Poses {
    /// Measured at every sample.
    pub(super) r_tunnel_body: Vec<Rotation<Tunnel, Body>>,
    /// Longest step of its flights, s.
    pub(super) step_s: f64,
    /// Position and rotation vector at the first sample, and their rates.
    first: [[f64; 6]; 2],
    /// Covariance of a channel's value and rate at the first sample, over the variance of a sample's noise.
    first_of_noise: Matrix2<f64>,
}

impl Poses {
    /// Of a record before it is thinned, and after; `None` of a record without attitudes.
    pub(super) fn of(whole: &PointRecord, thin: &PointRecord) -> Option<Self> {
        let last = whole.t_s.len().saturating_sub(1);
        let interval_s = (whole.t_s.last()? - whole.t_s.first()?) / last.max(1) as f64;
        let r_tunnel_body = thin.attitude.iter().map(|q| Rotation::from_quaternion(*q)).collect();
        let whole_too = whole.attitude.len() == whole.t_s.len() && thin.attitude.len() == thin.t_s.len();
        let (first, first_of_noise) = if whole_too { first_of(whole)? } else { return None };
        Some(Self { r_tunnel_body, step_s: STEP * interval_s, first, first_of_noise })
    }

    /// The record's initial state, rates times the duration.
    pub(super) fn start(&self, duration_s: f64) -> DVector<f64> {
        let [values, rates] = self.first;
        DVector::from_iterator(12, values.into_iter().chain(rates.map(|x| x * duration_s)))
    }
}

impl Poses {
    /// Covariance of a channel's place and rate times the duration in [`Poses::start`], over the variance of a sample's noise.
    pub(super) fn start_of_noise(&self, duration_s: f64) -> Matrix2<f64> {
        let scale = Matrix2::new(1.0, 0.0, 0.0, duration_s);
        scale * self.first_of_noise * scale
    }
}

/// Values and rates, at the first sample, of cubics through the first samples: of positions, and of rotation vectors from the first attitude.
fn first_of(record: &PointRecord) -> Option<([[f64; 6]; 2], Matrix2<f64>)> {
    let all = record.t_s.len();
    let n = (FIRST * kept_of(all) + 1).max(FEWEST).min(all);
    let span = record.t_s[n - 1] - record.t_s[0];
    let powers = DMatrix::from_fn(n, 4, |i, k| ((record.t_s[i] - record.t_s[0]) / span).powi(k as i32));
    let inverse = powers.tr_mul(&powers).try_inverse()?;
    let of_noise = Matrix2::from_fn(|i, k| inverse[(i, k)] / span.powi((i + k) as i32));
    let svd = powers.svd(true, true);
    let from_first = Rotation::<Tunnel, Body>::from_quaternion(record.attitude[0]).inverse();
    let [mut values, mut rates] = [[0.0; 6]; 2];
    for (a, (value, rate)) in values.iter_mut().zip(&mut rates).enumerate() {
        let at = |i: usize| match record.position_m.get(a) {
            Some(series) => series.as_ref().map(|x| x[i]),
            None => Some(rotation_vector(from_first * Rotation::from_quaternion(record.attitude[i]))[a - 3]),
        };
        let series = (0..n).map(at).collect::<Option<Vec<f64>>>()?;
        let c = svd.solve(&DVector::from_vec(series), 1e-12).ok()?;
        (*value, *rate) = (c[0], c[1] / span);
    }
    Some(([values, rates], of_noise))
}

/// Every so-manieth sample of a record of that length is kept.
pub(crate) fn kept_of(samples: usize) -> usize {
    samples.div_ceil(MOST).max(1)
}

/// Every so-manieth sample.
pub(super) fn thinned(record: &PointRecord) -> PointRecord {
    let by = kept_of(record.t_s.len());
    let some = |x: &[f64]| x.iter().step_by(by).copied().collect::<Vec<f64>>();
    PointRecord {
        t_s: some(&record.t_s),
        position_m: record.position_m.each_ref().map(|s| s.as_deref().map(some)),
        attitude: record.attitude.iter().step_by(by).copied().collect(),
        ..record.clone()
    }
}

/// Rotation vector, rad: axis times angle, the angle in [0, π].
pub(crate) fn rotation_vector(r: Rotation<Body, Body>) -> [f64; 3] {
    let [w, x, y, z] = r.to_quaternion();
    let v = Vector3::new(x, y, z);
    let sine = v.norm();
    let scale = if sine > 0.0 { 2.0 * sine.atan2(w) / sine } else { 2.0 };
    (v * scale).into()
}

/// The rotation of a rotation vector, rad.
pub(crate) fn rotation_of(v: [f64; 3]) -> Rotation<Body, Body> {
    Rotation::from_matrix(Rotation3::from(UnitQuaternion::from_scaled_axis(Vector3::from(v))).into_inner())
}

#[cfg(test)]
mod tests;
