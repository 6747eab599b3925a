//! sim: random inputs in time. In: a disturbance with its spectrum, a stream of normal numbers. Out: a smooth realisation.

use crate::smooth::Smooth;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use windfall_model::{Disturbance, Shape, ShapingFilter};

/// Samples of the disturbance at `interval_s`, `count` of them: its shaping filter in exact discrete form (no error of
/// time stepping), started from its stationary covariance.
#[must_use]
pub fn realise(d: &Disturbance, interval_s: f64, count: usize, normals: impl Iterator<Item = f64>) -> Vec<f64> {
    realise_filter(&d.filter(), interval_s, count, normals)
}

/// As [`realise`], for any stable filter of two states.
pub(crate) fn realise_filter(
    filter: &ShapingFilter,
    interval_s: f64,
    count: usize,
    mut normals: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let a = matrix(filter.a);
    let covariance = stationary(&a, filter.b.into());
    let step = (a * interval_s).exp();
    let noise = root(&(covariance - step * covariance * step.transpose()));
    let c: Vector2<f64> = filter.c.into();
    let mut draw = || Vector2::from_fn(|_, _| normals.next().unwrap_or(0.0));
    let mut x = root(&covariance) * draw();
    let mut next = || {
        let y = c.dot(&x);
        x = step * x + noise * draw();
        y
    };
    (0..count).map(|_| next()).collect()
}

/// A smooth realisation over `duration_s` on the disturbance's own grid.
pub(crate) fn smooth(d: &Disturbance, grid_s: f64, duration_s: f64, normals: impl Iterator<Item = f64>) -> Smooth {
    Smooth::new(grid_s, &realise(d, grid_s, samples(grid_s, duration_s), normals))
}

/// Samples that cover a duration with four to spare, so that nothing is held within it.
pub(crate) fn samples(grid_s: f64, duration_s: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "durations and grids are checked positive")]
    let n = (duration_s / grid_s).ceil() as usize;
    n + 5
}

/// Interval of the grid, s: a sixteenth of the disturbance's own time, and no longer than the air needs for a sixth of the
/// diameter; finer gusts average out over the body. Scales with the flow, so that Froude-scaled runs see the same gusts.
pub(crate) fn grid_s(d: &Disturbance, diameter_m: f64, speed_m_s: f64) -> f64 {
    let own = match d.shape {
        Shape::DrydenLongitudinal { time_s } | Shape::DrydenLateral { time_s } => time_s,
        Shape::Narrow { centre_rad_s, .. } | Shape::Band { centre_rad_s, .. } => 1.0 / centre_rad_s,
    };
    (own / 16.0).min(diameter_m / speed_m_s / 6.0)
}

fn matrix(rows: [[f64; 2]; 2]) -> Matrix2<f64> {
    Matrix2::new(rows[0][0], rows[0][1], rows[1][0], rows[1][1])
}

/// Stationary covariance: `A P + P Aᵀ + b bᵀ = 0`, three equations for the three numbers of P.
fn stationary(a: &Matrix2<f64>, b: Vector2<f64>) -> Matrix2<f64> {
    #[rustfmt::skip]
    let lyapunov = Matrix3::new(
        2.0 * a.m11, 2.0 * a.m12,   0.0,
        a.m21,       a.m11 + a.m22, a.m12,
        0.0,         2.0 * a.m21,   2.0 * a.m22,
    );
    let right = -Vector3::new(b.x * b.x, b.x * b.y, b.y * b.y);
    let p = lyapunov.lu().solve(&right).unwrap_or_default();
    Matrix2::new(p.x, p.y, p.y, p.z)
}

/// Lower triangular root of a positive semidefinite matrix.
fn root(m: &Matrix2<f64>) -> Matrix2<f64> {
    let a = m.m11.max(0.0).sqrt();
    let b = if a > 0.0 { m.m21 / a } else { 0.0 };
    Matrix2::new(a, 0.0, b, (m.m22 - b * b).max(0.0).sqrt())
}
