//! likelihood: normal equations of all columns, and what sets of them are worth. In: G and b. Out: log marginal likelihoods, estimates.
//!
//! With normal priors the gain of a set over none is `½ yᵀy − ½ ln |I + S G S|`, S the priors' standard deviations and y = L⁻¹ S b with
//! L Lᵀ = I + S G S (e.g. Bishop 2006, §3.5): a small solve for every set, from one pass over the data.

use crate::model::Number;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Whitened normal equations at a model, in total values: a member's present value is part of its column.
#[derive(Clone, Debug)]
pub struct Gram {
    /// The columns' numbers.
    pub numbers: Vec<Number>,
    /// `Σ DᵀD`.
    pub g: DMatrix<f64>,
    /// `Σ Dᵀν` with the present values put back: linear in departures from null.
    pub b: DVector<f64>,
    /// The same without: linear in departures from the present values.
    pub b_here: DVector<f64>,
    /// Log-likelihood at the present values.
    pub log_likelihood: f64,
}

/// Estimates of a set.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// Log marginal likelihood over that of nulls.
    pub gain: f64,
    /// Log-likelihood at the means over that at nulls: what the runs say alone, however plausible a size was beforehand.
    pub fit: f64,
    /// Means.
    pub mean: DVector<f64>,
    /// Covariance.
    pub covariance: DMatrix<f64>,
}

/// The step to the top of `rᵀx − ½ xᵀA x` that takes no number out of its range: one that stands at an end and would leave stays (active
/// set; Nocedal and Wright, Numerical Optimization, 2006, §16.5). A step of all numbers with that one cut off may lead downhill however short it is.
/// With A's factor; `None` where A is not positive definite.
pub(crate) fn step_within(
    mut a: DMatrix<f64>,
    mut r: DVector<f64>,
    leaves: impl Fn(usize, f64) -> bool,
) -> Option<(DVector<f64>, Cholesky<f64, Dyn>)> {
    let whole = Cholesky::new(a.clone())?;
    let mut step = whole.solve(&r);
    loop {
        let out: Vec<usize> = (0..step.len()).filter(|&i| leaves(i, step[i])).collect();
        if out.is_empty() {
            return Some((step, whole));
        }
        for i in out {
            a.row_mut(i).fill(0.0);
            a.column_mut(i).fill(0.0);
            (a[(i, i)], r[i]) = (1.0, 0.0);
        }
        step = Cholesky::new(a.clone())?.solve(&r);
    }
}

impl Gram {
    pub(crate) fn new(numbers: Vec<Number>, g: DMatrix<f64>, b_here: DVector<f64>, log_likelihood: f64) -> Self {
        let values = DVector::from_iterator(numbers.len(), numbers.iter().map(|n| n.value));
        let b = &b_here + &g * values;
        Self { numbers, g, b, b_here, log_likelihood }
    }

    /// What the numbers at these places are worth, and their estimates as totals; `None` where they cannot be told apart at all.
    #[must_use]
    pub fn posterior(&self, places: &[usize]) -> Option<Posterior> {
        let n = places.len();
        let s = |i: usize| self.numbers[places[i]].prior;
        let a = DMatrix::from_fn(n, n, |i, k| f64::from(u8::from(i == k)) + s(i) * self.g[(places[i], places[k])] * s(k));
        let cholesky = Cholesky::new(a)?;
        let y = cholesky.l().solve_lower_triangular(&DVector::from_fn(n, |i, _| s(i) * self.b[places[i]]))?;
        let logs: f64 = cholesky.l_dirty().diagonal().iter().map(|x| x.ln()).sum();
        let inverse = cholesky.inverse();
        let mean = cholesky.l().transpose().solve_upper_triangular(&y)?;
        Some(Posterior {
            gain: 0.5 * y.norm_squared() - logs,
            fit: 0.5 * (y.norm_squared() + mean.norm_squared()),
            mean: DVector::from_fn(n, |i, _| s(i) * mean[i]),
            covariance: DMatrix::from_fn(n, n, |i, k| s(i) * inverse[(i, k)] * s(k)),
        })
    }

    /// Log-likelihood with the log prior and the Laplace approximation of what integrating over all numbers gives, at the optimum that
    /// the quadratic has; and the step to it.
    #[must_use]
    pub fn laplace(&self) -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        let n = self.numbers.len();
        if n == 0 {
            return Some((self.log_likelihood, DVector::zeros(0), DMatrix::zeros(0, 0)));
        }
        let s = |i: usize| self.numbers[i].prior;
        let v = DVector::from_iterator(n, self.numbers.iter().map(|n| n.value / n.prior));
        let a = DMatrix::from_fn(n, n, |i, k| f64::from(u8::from(i == k)) + s(i) * self.g[(i, k)] * s(k));
        let r = DVector::from_fn(n, |i, _| s(i) * self.b_here[i] - v[i]);
        let (step, cholesky) = step_within(a, r.clone(), |i, by| self.numbers[i].leaves(by))?;
        let logs: f64 = cholesky.l_dirty().diagonal().iter().map(|x| x.ln()).sum();
        let total = self.log_likelihood + 0.5 * r.dot(&step) - 0.5 * v.norm_squared() - logs;
        let inverse = cholesky.inverse();
        let covariance = DMatrix::from_fn(n, n, |i, k| s(i) * inverse[(i, k)] * s(k));
        Some((total, DVector::from_fn(n, |i, _| s(i) * step[i]), covariance))
    }

    /// The same with the numbers at `places` always in, eliminated: what is left of the others. Gains are then over that of those alone.
    #[must_use]
    pub fn given(&self, places: &[usize], others: &[usize]) -> Option<Self> {
        let (n, m) = (places.len(), others.len());
        let s = |i: usize| self.numbers[places[i]].prior;
        let a = DMatrix::from_fn(n, n, |i, k| f64::from(u8::from(i == k)) + s(i) * self.g[(places[i], places[k])] * s(k));
        let cholesky = Cholesky::new(a)?;
        let cross = DMatrix::from_fn(n, m, |i, k| s(i) * self.g[(places[i], others[k])]);
        let own = DVector::from_fn(n, |i, _| s(i) * self.b[places[i]]);
        let (solved, y) = (cholesky.l().solve_lower_triangular(&cross)?, cholesky.l().solve_lower_triangular(&own)?);
        let g = DMatrix::from_fn(m, m, |i, k| self.g[(others[i], others[k])]) - solved.transpose() * &solved;
        let b = DVector::from_fn(m, |i, _| self.b[others[i]]) - solved.transpose() * y;
        Some(Self {
            numbers: others.iter().map(|&i| self.numbers[i]).collect(),
            b_here: b.clone(),
            g,
            b,
            log_likelihood: self.log_likelihood,
        })
    }
}

#[cfg(test)]
mod tests;
