//! sim: random inputs in time. In: a disturbance with its spectrum, a stream of normal numbers. Out: a smooth realisation.

use crate::smooth::Smooth;
use nalgebra::{Matrix2, Matrix3, Matrix4, SMatrix, SVector, Vector2, Vector3, Vector4};
use windfall_model::{Disturbance, Shape, ShapingFilter, StateForm};

/// Samples of the disturbance at `interval_s`, `count` of them: its shaping filter in exact discrete form (no error of
/// time stepping), started from its stationary covariance.
#[must_use]
pub fn realise(d: &Disturbance, interval_s: f64, count: usize, normals: impl Iterator<Item = f64>) -> Vec<f64> {
    match d.filter() {
        StateForm::Two(filter) => realise_filter(&filter, interval_s, count, normals),
        StateForm::Four(ShapingFilter { a, b, c }) => {
            let a = Matrix4::from_fn(|i, k| a[i][k]);
            let covariance = stationary_of_four(&a, b.into());
            stepped((a * interval_s).exp(), covariance, c.into(), count, normals)
        }
    }
}

/// As [`realise`], for any stable filter of two states.
pub(crate) fn realise_filter(
    filter: &ShapingFilter<2>,
    interval_s: f64,
    count: usize,
    normals: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let a = matrix(filter.a);
    stepped((a * interval_s).exp(), stationary(&a, filter.b.into()), filter.c.into(), count, normals)
}

/// Samples of a process by its transition over an interval, its stationary covariance and its output row.
fn stepped<const N: usize>(
    step: SMatrix<f64, N, N>,
    covariance: SMatrix<f64, N, N>,
    c: SVector<f64, N>,
    count: usize,
    mut normals: impl Iterator<Item = f64>,
) -> Vec<f64> {
    let noise = root(&(covariance - step * covariance * step.transpose()));
    let mut draw = || SVector::<f64, N>::from_fn(|_, _| normals.next().unwrap_or(0.0));
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
        Shape::Constant => f64::INFINITY,
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

/// The same for four states.
fn stationary_of_four(a: &Matrix4<f64>, b: Vector4<f64>) -> Matrix4<f64> {
    let mut m = SMatrix::<f64, 16, 16>::zeros();
    for i in 0..4 {
        for k in 0..4 {
            for l in 0..4 {
                m[(4 * i + k, 4 * l + k)] += a[(i, l)];
                m[(4 * i + k, 4 * i + l)] += a[(k, l)];
            }
        }
    }
    let right = SVector::<f64, 16>::from_fn(|j, _| -b[j / 4] * b[j % 4]);
    let p = m.lu().solve(&right).unwrap_or_default();
    Matrix4::from_fn(|i, k| 0.5 * (p[4 * i + k] + p[4 * k + i]))
}

/// Lower triangular root of a positive semidefinite matrix (Cholesky); a direction without variance stays without.
fn root<const N: usize>(m: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let mut l = SMatrix::<f64, N, N>::zeros();
    for k in 0..N {
        let before: f64 = (0..k).map(|j| l[(k, j)] * l[(k, j)]).sum();
        l[(k, k)] = (m[(k, k)] - before).max(0.0).sqrt();
        if l[(k, k)] > 0.0 {
            for i in k + 1..N {
                let before: f64 = (0..k).map(|j| l[(i, j)] * l[(k, j)]).sum();
                l[(i, k)] = (m[(i, k)] - before) / l[(k, k)];
            }
        }
    }
    l
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_model::Entry;

    const SHAPES: [Shape; 4] = [
        Shape::DrydenLongitudinal { time_s: 0.08 },
        Shape::DrydenLateral { time_s: 0.08 },
        Shape::Narrow { centre_rad_s: 12.0, bandwidth_rad_s: 3.0 },
        Shape::Band { centre_rad_s: 12.0, bandwidth_rad_s: 18.0 },
    ];

    /// `L Lᵀ` is the matrix, also where it has a direction without variance; L has nothing above its diagonal. Bound: round-off.
    #[test]
    fn exact_a_root_times_itself() {
        let a = Matrix4::new(1.0, 0.3, -0.2, 0.5, 0.0, 0.8, 0.4, -0.6, 0.0, 0.0, 1.1, 0.7, 0.0, 0.0, 0.0, 0.9);
        for m in [a * a.transpose(), a.transpose() * a] {
            let l = root(&m);
            assert!((l * l.transpose() - m).amax() < 1e-15 && l.upper_triangle() == Matrix4::from_diagonal(&l.diagonal()));
        }
        let flat = Vector2::new(0.6, -0.8);
        let m = flat * flat.transpose();
        assert!((root(&m) * root(&m).transpose() - m).amax() < 1e-15);
    }

    /// A flow of twice the time in every respect has a grid of twice the interval: the same gusts in a scaled run.
    #[test]
    fn law_grids_scale_with_the_flow() {
        for shape in SHAPES {
            let slower = match shape {
                Shape::DrydenLongitudinal { time_s } => Shape::DrydenLongitudinal { time_s: 2.0 * time_s },
                Shape::DrydenLateral { time_s } => Shape::DrydenLateral { time_s: 2.0 * time_s },
                Shape::Narrow { centre_rad_s: c, bandwidth_rad_s: b } => {
                    Shape::Narrow { centre_rad_s: 0.5 * c, bandwidth_rad_s: 0.5 * b }
                }
                Shape::Band { centre_rad_s: c, bandwidth_rad_s: b } => {
                    Shape::Band { centre_rad_s: 0.5 * c, bandwidth_rad_s: 0.5 * b }
                }
                Shape::Constant => Shape::Constant,
            };
            // A small body, by which the grid is set, and a large one, by which it is not.
            for diameter_m in [0.02, 1e3] {
                let grid = |shape, speed_m_s| {
                    grid_s(&Disturbance { entry: Entry::AirVelocity(0), rms: 1.0, shape }, diameter_m, speed_m_s)
                };
                assert!((grid(slower, 3.5) / grid(shape, 7.0) - 2.0).abs() < 1e-15, "{shape:?}");
            }
        }
    }

    /// Samples of a grid go on for four intervals after the end, and for less than five.
    #[test]
    fn law_a_grid_covers_the_flight() {
        for (grid_s, duration_s) in [(0.1, 1.0), (0.3, 1.0), (0.007, 13.0)] {
            let spare = (samples(grid_s, duration_s) - 1) as f64 - duration_s / grid_s;
            assert!((4.0 - 1e-9..5.0).contains(&spare), "{grid_s} {duration_s}: {spare}");
        }
    }
}
