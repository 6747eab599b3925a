//! discover: normal equations of a fit. In: whitened residual and columns. Out: a step with its covariance, or the number that the data
//! do not determine.

use super::bins::Residual;
use super::model::{Free, TrackModel};
use nalgebra::{DMatrix, DVector};

/// Part of a column that no other has, over its length, below which normal equations count as singular: columns are one-sided
/// differences over steps of a thousandth, and agree no better than that when they are the same.
const SINGULAR: f64 = 1e-3;

/// One Gauss-Newton step.
pub(crate) struct NormalStep {
    pub(crate) delta: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
}

/// Whitened normal equations.
#[derive(Clone)]
pub(crate) struct NormalEquations {
    /// Score `aᵀz`.
    g: DVector<f64>,
    /// Information `aᵀa`, and the variance of the score.
    j: DMatrix<f64>,
}

impl NormalEquations {
    /// Equations of a residual and columns, all whitened.
    pub(crate) fn new(z: &Residual, columns: &[Residual]) -> Self {
        let m = columns.len();
        let mut all = Self { g: DVector::zeros(m), j: DMatrix::zeros(m, m) };
        for i in 0..m {
            all.g[i] = dot(&columns[i], z);
            for k in 0..=i {
                let v = dot(&columns[i], &columns[k]);
                all.j[(i, k)] = v;
                all.j[(k, i)] = v;
            }
        }
        all
    }
    /// Score and information.
    pub(crate) fn parts(self) -> (DVector<f64>, DMatrix<f64>) {
        (self.g, self.j)
    }
    /// Adds what is known without the data: each value with a prior is one more observation of it.
    pub(crate) fn add_prior(&mut self, h: &TrackModel, free: &[Free]) {
        for (place, f) in free.iter().enumerate() {
            if let Some((departure, std)) = h.prior(*f) {
                let information = std.powi(-2);
                self.g[place] += information * departure;
                self.j[(place, place)] += information;
            }
        }
    }
    /// The number (of those that may be held) that weighs most in the direction of least information.
    pub(crate) fn undetermined(&self, may: impl Fn(usize) -> bool) -> Option<usize> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.j[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let eigen = scaled_back(&self.j, &scale).symmetric_eigen();
        let (least, _) = eigen.eigenvalues.argmin();
        (0..p)
            .filter(|&i| may(i))
            .max_by(|a, b| eigen.eigenvectors[(*a, least)].abs().total_cmp(&eigen.eigenvectors[(*b, least)].abs()))
    }
    /// Solution `−J⁻¹g` and its covariance `J⁻¹JJ⁻¹`; `None` when `J`, scaled, is not positive definite.
    pub(crate) fn solve(&self) -> Option<NormalStep> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.j[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let scaled = |m: &DMatrix<f64>| scaled_back(m, &scale);
        let inverse = scaled(&self.j).cholesky().filter(|c| c.l_dirty().diagonal().iter().all(|d| *d > SINGULAR))?.inverse();
        let g = DVector::from_fn(p, |i, _| self.g[i] * scale[i]);
        let delta = -(&inverse * g);
        let covariance = &inverse * scaled(&self.j) * &inverse;
        Some(NormalStep { delta: delta.component_mul(&scale), covariance: scaled_back(&covariance, &scale) })
    }
}

/// Inner product in eight partial sums, so that it uses vector units.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (x, y) = (x.chunks_exact(8), y.chunks_exact(8));
    let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in x.zip(y) {
        for ((s, a), b) in sums.iter_mut().zip(a).zip(b) {
            *s += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

fn scaled_back(m: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, k| m[(i, k)] * scale[i] * scale[k])
}

#[cfg(test)]
mod tests;
