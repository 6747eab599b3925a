//! discover: a distribution over runs against one published run. In: rows of figures. Out: distance, p-value, intervals.
//!
//! Figures are positive and are compared by their logarithms, whose distribution over runs is nearer to normal.

use super::ensemble::{Rows, quantile};
use nalgebra::{DMatrix, DVector};

/// Mean and covariance over runs of the logarithms of the figures in use.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    pub(super) mean: DVector<f64>,
    pub(super) covariance: DMatrix<f64>,
    /// Lower triangular root `L Lᵀ = Σ`.
    root: DMatrix<f64>,
}

/// Smallest standard deviation of a figure's logarithm over runs that is believed: the printed digits of the tables.
const PRINTED: f64 = 1e-4;

pub(super) fn logs(row: &[f64], used: &[usize]) -> DVector<f64> {
    DVector::from_iterator(used.len(), used.iter().map(|&i| row[i].max(1e-12).ln()))
}

impl Spread {
    pub(super) fn of(rows: &Rows, used: &[usize]) -> Option<Self> {
        Self::with_floor(rows, used, PRINTED)
    }
    /// With every figure's standard deviation widened by `floor`.
    pub(super) fn with_floor(rows: &Rows, used: &[usize], floor: f64) -> Option<Self> {
        let (n, m) = (rows.len() as f64, used.len());
        let all: Vec<DVector<f64>> = rows.iter().map(|r| logs(r, used)).collect();
        let mean = all.iter().fold(DVector::zeros(m), |s, y| s + y) / n;
        let mut covariance = DMatrix::zeros(m, m);
        for y in &all {
            let d = y - &mean;
            covariance += &d * d.transpose() / (n - 1.0);
        }
        for i in 0..m {
            covariance[(i, i)] += floor * floor;
        }
        let root = covariance.clone().cholesky()?.l();
        Some(Self { mean, covariance, root })
    }
    /// A difference in units of the spread over runs.
    pub(super) fn whiten(&self, d: &DVector<f64>) -> DVector<f64> {
        self.root.solve_lower_triangular(d).unwrap_or_else(|| DVector::from_element(d.len(), f64::INFINITY))
    }
    /// Minus twice the normal log likelihood of a published run, without its constant.
    pub(super) fn surprise(&self, test: &DVector<f64>) -> f64 {
        let log_determinant = 2.0 * self.root.diagonal().iter().map(|x| x.ln()).sum::<f64>();
        self.whiten(&(test - &self.mean)).norm_squared() + log_determinant
    }
}

/// What the parameters can absorb, seen from their estimate.
#[derive(Clone, Debug)]
pub(super) struct Tangent {
    /// Whitened change of the figures over the whole plausible range of each parameter, by columns.
    columns: DMatrix<f64>,
    /// Orthonormal directions of figures that the parameters move by more than the spread over runs.
    absorbed: DMatrix<f64>,
}

/// A direction counts as decided when crossing the plausible range moves the figures by more than this many standard
/// deviations of one run.
const DECIDED: f64 = 1.0;

impl Tangent {
    /// From the derivative of the mean log figures with respect to the places in [0, 1].
    pub(super) fn new(spread: &Spread, derivative: &DMatrix<f64>) -> Self {
        let mut columns = derivative.clone();
        for k in 0..derivative.ncols() {
            columns.set_column(k, &spread.whiten(&derivative.column(k).into_owned()));
        }
        if columns.ncols() == 0 {
            return Self { absorbed: columns.clone(), columns };
        }
        let svd = columns.clone().svd(true, false);
        let u = svd.u.unwrap_or_else(|| DMatrix::zeros(columns.nrows(), 0));
        let kept: Vec<usize> = (0..svd.singular_values.len()).filter(|&k| svd.singular_values[k] > DECIDED).collect();
        Self { columns, absorbed: u.select_columns(&kept) }
    }
    /// Figures left to judge by.
    pub(super) fn degrees(&self) -> usize {
        self.absorbed.nrows() - self.absorbed.ncols()
    }
    /// Directions of the parameters that the figures decide.
    pub(super) fn rank(&self) -> usize {
        self.absorbed.ncols()
    }
    /// Squared length of what the parameters cannot absorb of a whitened difference.
    pub(super) fn left(&self, z: &DVector<f64>) -> f64 {
        let inside = self.absorbed.transpose() * z;
        (z.norm_squared() - inside.norm_squared()).max(0.0)
    }
    /// Standard error of each place, by inverse information with a weak prior of the plausible range (standard deviation of a
    /// uniform number, 1/√12), so that what is not decided keeps about its range.
    pub(super) fn std_errors(&self, runs: usize) -> Vec<f64> {
        let k = self.columns.ncols();
        let noise = 1.0 + 1.0 / runs as f64;
        let information = self.columns.transpose() * &self.columns / noise + DMatrix::identity(k, k) * 12.0;
        information.try_inverse().map_or_else(|| vec![1.0; k], |c| (0..k).map(|i| c[(i, i)].sqrt()).collect())
    }
}

/// Share of `rows`, judged like a published run (each after re-estimation, linearised), that lie at least as far out as `test`;
/// counted with the published run itself (Davison and Hinkley 1997, eq. 4.11).
pub(super) fn p_value(spread: &Spread, tangent: &Tangent, rows: &Rows, test: &DVector<f64>, used: &[usize]) -> f64 {
    let distance = |y: &DVector<f64>| tangent.left(&spread.whiten(&(y - &spread.mean)));
    let far = distance(test);
    let beyond = rows.iter().filter(|r| distance(&logs(r, used)) >= far).count();
    (beyond + 1) as f64 / (rows.len() + 1) as f64
}

/// Share of the runs of one explanation that another one would reject at level 5 %.
pub(super) fn rejected(spread: &Spread, tangent: &Tangent, own: &Rows, others: &Rows, used: &[usize]) -> f64 {
    let distance = |r: &Vec<f64>| tangent.left(&spread.whiten(&(logs(r, used) - &spread.mean)));
    let mut own: Vec<f64> = own.iter().map(distance).collect();
    let limit = quantile(&mut own, 0.95);
    others.iter().filter(|r| distance(r) > limit).count() as f64 / others.len() as f64
}

#[cfg(test)]
mod tests;
