//! discover: a track of specific forces. In: a record and a plant. Out: initial velocities, offsets and what they leave.
//!
//! Of a specific force the initial velocity may leave nothing (in a vacuum), and the accelerometer has an offset of its own in every run.
//! Both are held to make a constant and a slope in time, which are taken out of every residual; the velocity is that of least squares,
//! with a normal prior of what gravity makes in the time of the run and not beyond that: with hardly any drag, a slope would ask for
//! any velocity.

use super::start::STEPS;
use super::track::Track;
use nalgebra::{DMatrix, DVector};
use windfall_model::Plant;

impl Track {
    /// Bases, start and residual of specific forces: a constant and a slope along each axis are the initial state's.
    pub(super) fn lay_forces(&mut self, own: &Plant) -> Option<()> {
        let (n, m, end) = (self.t_s.len(), self.axes.len(), self.duration_s());
        let lines = DMatrix::from_fn(n * m, 2 * m, |row, column| {
            let (axis, of_axis) = (row / n, column % m);
            let x = if column < m { 1.0 } else { self.t_s[row % n] / end - 0.5 };
            if axis == of_axis { x } else { 0.0 }
        });
        self.lay_bases(&lines, None);
        let (theta, e) = self.launched(own)?;
        self.start = theta;
        self.laid = self.basis.tr_mul(&e);
        self.push = DMatrix::zeros(0, 0);
        Some(())
    }

    /// Initial velocities and offsets of specific forces, and what they leave, by least squares with the prior of the velocity. A body that
    /// was tossed up and one that was dropped both make a slope, so that the search starts from either, and the better end is taken.
    pub(super) fn launched(&self, own: &Plant) -> Option<(DVector<f64>, DVector<f64>)> {
        let (m, end) = (self.axes.len(), self.duration_s());
        let reach = (own.environment.gravity_m_s2 * end * end).max(1e-6);
        let mut tossed = DVector::zeros(2 * m);
        tossed[0] = -0.5 * reach;
        let ends = [DVector::zeros(2 * m), tossed].map(|start| self.launched_from(own, start, reach));
        ends.into_iter().flatten().min_by(|a, b| a.2.total_cmp(&b.2)).map(|(theta, e, _)| (theta, e))
    }

    /// One search: velocities times the duration within `reach`, offsets, residual, and the cost.
    fn launched_from(&self, own: &Plant, start: DVector<f64>, reach: f64) -> Option<(DVector<f64>, DVector<f64>, f64)> {
        let (n, m) = (self.t_s.len(), self.axes.len());
        let std = self.std.max(1e-6);
        let centred = |theta: &DVector<f64>| -> Option<(DVector<f64>, Vec<f64>)> {
            let mut e = self.left(own, theta)?;
            let means: Vec<f64> = (0..m).map(|a| e.rows(a * n, n).mean()).collect();
            for (a, mean) in means.iter().enumerate() {
                e.rows_mut(a * n, n).add_scalar_mut(-mean);
            }
            Some((e, means))
        };
        let mut theta = start;
        for _ in 0..STEPS {
            let e = centred(&theta)?.0 / std;
            let mut jacobian = DMatrix::zeros(n * m, m);
            for a in 0..m {
                let h = 1e-4 * reach;
                let at = |by: f64| {
                    let mut moved = theta.clone();
                    moved[a] += by;
                    centred(&moved).map(|c| c.0 / std)
                };
                jacobian.set_column(a, &((at(h)? - at(-h)?) / (2.0 * h)));
            }
            let normal = jacobian.tr_mul(&jacobian) + DMatrix::<f64>::identity(m, m) / (reach * reach);
            let slope = jacobian.tr_mul(&e) + theta.rows(0, m) / (reach * reach);
            let before = theta.rows(0, m).into_owned();
            let after = (&before - normal.cholesky()?.solve(&slope)).map(|x| x.clamp(-reach, reach));
            theta.rows_mut(0, m).copy_from(&after);
            if (after - before).amax() < 1e-9 * reach {
                break;
            }
        }
        let (e, means) = centred(&theta)?;
        theta.rows_mut(m, m).copy_from_slice(&means);
        let cost = e.norm_squared() / (std * std) + theta.rows(0, m).norm_squared() / (reach * reach);
        Some((theta, e, cost))
    }
}

#[cfg(test)]
mod tests;
