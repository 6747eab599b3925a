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
    /// Of the numbers that are not held, in their order.
    pub(crate) covariance: DMatrix<f64>,
    /// Numbers that the step leaves at an end of their range, because the optimum lies beyond it.
    pub(crate) held: Vec<usize>,
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
    /// The step to the least squares within bounds (`lower ≤ delta ≤ upper`, zero among them), with the covariance `J⁻¹` of what is not held at one.
    ///
    /// # Errors
    /// `J`, scaled, is not positive definite: the number to hold, of those that may be, or `None` without any.
    ///
    /// An active-set method (Lawson and Hanson 1974, ch. 23): the number furthest out is held at its end, and let go again where its slope points inside.
    pub(crate) fn solve_within(&self, bounds: &[[f64; 2]], may: impl Fn(usize) -> bool) -> Result<NormalStep, Option<usize>> {
        let p = self.g.len();
        let size = |i: usize| self.j[(i, i)].max(f64::MIN_POSITIVE).sqrt();
        let mut held: Vec<usize> = (0..p).filter(|i| bounds[*i][0] >= bounds[*i][1]).collect();
        let mut delta = DVector::from_fn(p, |i, _| if held.contains(&i) { bounds[i][0] } else { 0.0 });
        let mut let_go = vec![false; p];
        loop {
            let open: Vec<usize> = (0..p).filter(|i| !held.contains(i)).collect();
            let slope_of_held = |i: usize| held.iter().map(|&k| self.j[(i, k)] * delta[k]).sum::<f64>();
            let part = Self {
                g: DVector::from_iterator(open.len(), open.iter().map(|&i| self.g[i] + slope_of_held(i))),
                j: DMatrix::from_fn(open.len(), open.len(), |i, k| self.j[(open[i], open[k])]),
            };
            let Some((solved, covariance)) = part.solve() else {
                return Err(part.undetermined(|i| may(open[i])).map(|i| open[i]));
            };
            open.iter().zip(solved.iter()).for_each(|(&i, x)| delta[i] = *x);
            let out = |i: usize| (bounds[i][0] - delta[i]).max(delta[i] - bounds[i][1]) * size(i);
            if let Some(worst) = open.iter().copied().filter(|i| out(*i) > 0.0).max_by(|a, b| out(*a).total_cmp(&out(*b))) {
                delta[worst] = delta[worst].clamp(bounds[worst][0], bounds[worst][1]);
                held.push(worst);
                continue;
            }
            // Downhill inside; each is let go once at the most, so that the search ends.
            let slope = &self.g + &self.j * &delta;
            let downhill = |i: usize| if delta[i] <= bounds[i][0] { -slope[i] } else { slope[i] };
            let inside = |i: usize| downhill(i) / size(i);
            let may_move = |i: &usize| bounds[*i][0] < bounds[*i][1] && !let_go[*i] && inside(*i) > 0.0;
            match held.iter().copied().filter(may_move).max_by(|a, b| inside(*a).total_cmp(&inside(*b))) {
                Some(i) => {
                    let_go[i] = true;
                    held.retain(|k| *k != i);
                }
                None => {
                    held.sort_unstable();
                    return Ok(NormalStep { delta, covariance, held });
                }
            }
        }
    }
    /// Solution `−J⁻¹g` and its covariance `J⁻¹`; `None` when `J`, scaled, is not positive definite.
    fn solve(&self) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let p = self.g.len();
        let scale = DVector::from_fn(p, |i, _| 1.0 / self.j[(i, i)].max(f64::MIN_POSITIVE).sqrt());
        let scaled = scaled_back(&self.j, &scale);
        let inverse = scaled.clone().cholesky().filter(|c| c.l_dirty().diagonal().iter().all(|d| *d > SINGULAR))?.inverse();
        let delta = -(&inverse * self.g.component_mul(&scale));
        let covariance = &inverse * scaled * &inverse;
        Some((delta.component_mul(&scale), scaled_back(&covariance, &scale)))
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
