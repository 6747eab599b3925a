//! verify: normal equations of a fit, corrected for noise in the regressors. In: whitened residuals and columns, of the data and
//! of what each copy adds. Out: a step with its covariance, or the number that the data do not determine.

use super::super::evidence::Residual;
use super::super::hypothesis::{Free, Hypothesis};
use super::super::likelihood::Whitening;
use super::{Columns, Point};
use nalgebra::{DMatrix, DVector};

/// Part of a column that no other has, over its length, below which normal equations count as singular: columns are one-sided
/// differences over steps of a thousandth, and agree no better than that when they are the same.
const SINGULAR: f64 = 1e-3;

/// One corrected Gauss-Newton step.
pub(crate) struct Step {
    pub(crate) delta: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
    pub(crate) inverse: DMatrix<f64>,
}

/// Whitened residuals and columns.
pub(crate) struct Whitened {
    a: Vec<Residual>,
    da: Vec<Vec<Residual>>,
    looped: Vec<f64>,
}

impl Point {
    pub(crate) fn whitened(&self, w: &Whitening) -> Whitened {
        Whitened { a: vec![w.whiten(&self.z)], da: self.dz.iter().map(|d| vec![w.whiten(d)]).collect(), looped: vec![0.0] }
    }
}

impl Whitened {
    pub(crate) fn new(w: &Whitening, columns: &Columns) -> Self {
        let all = |c: &Vec<Residual>| c.iter().map(|x| w.whiten(x)).collect::<Vec<_>>();
        Self { a: all(&columns.a), da: columns.da.iter().map(all).collect(), looped: columns.looped.clone() }
    }
}

/// Whitened normal equations with the correction for noise in the regressors.
#[derive(Clone)]
pub(crate) struct Normal {
    /// Score `aᵀz` less what noise and the closed loop give at the truth.
    pub(crate) g: DVector<f64>,
    /// Information `aᵀa` less what noise alone gives.
    pub(crate) j: DMatrix<f64>,
    /// Variance of the score, `aᵀa`, and of the correction.
    pub(crate) v: DMatrix<f64>,
}

impl Normal {
    /// Equations of some columns.
    pub(crate) fn new(at: &Whitened, columns: &Whitened) -> Self {
        let empty = Self { g: DVector::zeros(0), j: DMatrix::zeros(0, 0), v: DMatrix::zeros(0, 0) };
        empty.with(at, &Whitened { a: Vec::new(), da: vec![Vec::new(); at.da.len()], looped: Vec::new() }, columns)
    }
    /// Equations of known columns (these) and more; `at` holds the residual and its copies as its only column.
    pub(crate) fn with(&self, at: &Whitened, known: &Whitened, more: &Whitened) -> Self {
        let (n, m) = (known.a.len(), more.a.len());
        let mut all = Self {
            g: self.g.clone().resize_vertically(n + m, 0.0),
            j: self.j.clone().resize(n + m, n + m, 0.0),
            v: self.v.clone().resize(n + m, n + m, 0.0),
        };
        let weight = 1.0 / at.da.len().max(1) as f64;
        for i in 0..m {
            let noise: f64 = more.da.iter().zip(&at.da).map(|(d, z)| dot(&d[i], &z[0])).sum();
            all.g[n + i] = dot(&more.a[i], &at.a[0]) - weight * noise - more.looped[i];
            for k in 0..=n + i {
                let (other, dother): (&Residual, Vec<&Residual>) = if k < n {
                    (&known.a[k], known.da.iter().map(|d| &d[k]).collect())
                } else {
                    (&more.a[k - n], more.da.iter().map(|d| &d[k - n]).collect())
                };
                let v = dot(&more.a[i], other);
                let noise: f64 = more.da.iter().zip(dother).map(|(d, o)| dot(&d[i], o)).sum();
                for (r, c) in [(n + i, k), (k, n + i)] {
                    // The correction is a mean over the copies and has their scatter.
                    all.v[(r, c)] = v + weight * weight * noise;
                    all.j[(r, c)] = v - weight * noise;
                }
            }
        }
        all
    }
    /// Equations of some of the numbers.
    pub(crate) fn some(&self, kept: &[usize]) -> Self {
        let part = |m: &DMatrix<f64>| DMatrix::from_fn(kept.len(), kept.len(), |i, k| m[(kept[i], kept[k])]);
        Self { g: DVector::from_fn(kept.len(), |i, _| self.g[kept[i]]), j: part(&self.j), v: part(&self.v) }
    }
    /// Adds what is known of the constants without the data: each declared value is one more observation of it.
    pub(crate) fn add_prior(&mut self, h: &Hypothesis, free: &[Free]) {
        for (place, f) in free.iter().enumerate() {
            if let Free::Constant(i) = *f {
                let (constant, departure) = &h.constants[i];
                let information = constant.std.powi(-2);
                self.g[place] += information * departure;
                self.j[(place, place)] += information;
                self.v[(place, place)] += information;
            }
        }
    }
    /// The number (of those that may be held) that weighs most in the direction of least information.
    pub(crate) fn undetermined(&self, may: impl Fn(usize) -> bool) -> Option<usize> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.v[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let eigen = scaled_back(&self.j, &scale).symmetric_eigen();
        let (least, _) = eigen.eigenvalues.argmin();
        (0..p)
            .filter(|&i| may(i))
            .max_by(|a, b| eigen.eigenvectors[(*a, least)].abs().total_cmp(&eigen.eigenvectors[(*b, least)].abs()))
    }
    /// Solution `−J⁻¹g` and its covariance `J⁻¹VJ⁻¹`; `None` when `J`, scaled, is not positive definite.
    pub(crate) fn solve(&self) -> Option<Step> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.v[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let scaled = |m: &DMatrix<f64>| scaled_back(m, &scale);
        let inverse = scaled(&self.j).cholesky().filter(|c| c.l_dirty().diagonal().iter().all(|d| *d > SINGULAR))?.inverse();
        let g = DVector::from_fn(p, |i, _| self.g[i] * scale[i]);
        let delta = -(&inverse * g);
        let covariance = &inverse * scaled(&self.v) * &inverse;
        Some(Step {
            delta: delta.component_mul(&scale),
            covariance: scaled_back(&covariance, &scale),
            inverse: scaled_back(&inverse, &scale),
        })
    }
}

/// Inner product in eight partial sums, so that it uses vector units.
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
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

pub(super) fn scaled_back(m: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, k| m[(i, k)] * scale[i] * scale[k])
}
