//! pid: the parameters' own least squares and the length of its steps. In: linearised runs, unknowns. Out: a step with its
//! covariance, or the unknown that the data do not determine.

use super::run::Linearised;
use nalgebra::{DMatrix, DVector};
use windfall_model::Unknowns;

/// Share of the largest singular value below which a combination of parameters counts as undetermined; as in the regression.
const RANK_TOLERANCE: f64 = 1e-10;
/// Cosine of two steps beyond which they lie on a line; largest lengthening and shortening.
const ON_A_LINE: f64 = 0.9;
const MOST_LONG: f64 = 10.0;
pub(super) const MOST_SHORT: f64 = 0.25;

/// How long steps should be. Where the model is wrong, residuals bend the misfit and Gauss-Newton steps are too short or too long by a
/// factor that two steps along one line tell (Aitken 1926).
#[derive(Default)]
pub(super) struct Pace {
    /// Last step in standard errors, and the part of it taken.
    last: Option<(DVector<f64>, f64)>,
}

impl Pace {
    /// Length of this step in Gauss-Newton's.
    pub(super) fn next(&mut self, normal: &Normal) -> f64 {
        let step = normal.in_errors();
        let ratio = self.last.as_ref().map_or(0.0, |(last, part)| {
            let (along, square) = (step.dot(last), last.norm_squared());
            // A part of a step leaves what it did not take: 1 − part × (1 − ratio of whole steps).
            let on_a_line = along.abs() > ON_A_LINE * step.norm() * last.norm();
            if on_a_line { 1.0 - (1.0 - along / square) / part } else { 0.0 }
        });
        self.last = Some((step, 1.0));
        let length = if ratio < 1.0 { 1.0 / (1.0 - ratio) } else { MOST_LONG };
        length.clamp(MOST_SHORT, MOST_LONG)
    }
    pub(super) fn took(&mut self, part: f64) {
        if let Some(last) = &mut self.last {
            last.1 = part;
        }
    }
}

/// The parameters' own least squares, all runs together.
pub(super) struct Normal {
    pub(super) step: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    pub(super) condition: f64,
}

impl Normal {
    /// By singular values of the stacked triangles with columns scaled to unit length; the column that weighs most in what is
    /// undetermined, and the rank, where there is such.
    pub(super) fn new(linear: &[Linearised], unknowns: &Unknowns) -> Result<Self, (usize, usize)> {
        let free = unknowns.free();
        let rows = linear.len() * (free + 1) + unknowns.priors().count();
        let mut a = DMatrix::zeros(rows.max(free), free);
        let mut b = DVector::zeros(rows.max(free));
        let mut row = 0;
        for l in linear {
            a.view_mut((row, 0), (free + 1, free)).copy_from(&l.information.columns(0, free));
            b.rows_mut(row, free + 1).copy_from(&l.information.column(free));
            row += free + 1;
        }
        for (column, off, std) in unknowns.priors() {
            a[(row, column)] = 1.0 / std;
            b[row] = off / std;
            row += 1;
        }
        let scale: Vec<f64> = a.column_iter().map(|c| c.norm()).collect();
        if let Some(column) = scale.iter().position(|s| !s.is_normal()) {
            return Err((column, scale.iter().filter(|s| s.is_normal()).count()));
        }
        for (mut c, s) in a.column_iter_mut().zip(&scale) {
            c /= *s;
        }
        let svd = a.svd(true, true);
        let singular = &svd.singular_values;
        let largest = singular.max();
        let rank = singular.iter().filter(|s| **s > RANK_TOLERANCE * largest).count();
        let (Some(u), Some(v_t)) = (&svd.u, &svd.v_t) else { return Err((0, 0)) };
        if rank < free {
            return Err((v_t.row(singular.imin()).transpose().iamax(), rank));
        }
        let inverse = DVector::from_iterator(free, singular.iter().map(|s| 1.0 / s));
        let unscale = DMatrix::from_diagonal(&DVector::from_iterator(free, scale.iter().map(|s| 1.0 / s)));
        let root = unscale * v_t.transpose() * DMatrix::from_diagonal(&inverse);
        let step = &root * (u.transpose() * b);
        Ok(Self { step, covariance: &root * root.transpose(), condition: largest / singular.min() })
    }
    /// The step in standard errors.
    fn in_errors(&self) -> DVector<f64> {
        DVector::from_fn(self.step.len(), |i, _| self.step[i] / self.covariance[(i, i)].sqrt())
    }
    /// Largest step in standard errors.
    pub(super) fn largest_step(&self) -> f64 {
        self.in_errors().amax()
    }
}

#[cfg(test)]
mod tests;
