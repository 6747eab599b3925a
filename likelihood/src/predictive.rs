//! likelihood: how likely runs are that a fit has not seen. In: a fit, other runs. Out: their log predictive density, over all that the fit leaves
//! of its numbers.
//!
//! A number that the fit hardly knows may be known well by the other runs: at the fit's own value they are then unlikely by chance alone, and by
//! thousands of nats more or less for a hundredth of its standard error. Averaged over what the fit leaves, that does not matter.

use crate::engine::{Engine, Fit};
use nalgebra::{Cholesky, DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Most steps to the top of likelihood and fit together, and most halvings of one.
const MOST: usize = 12;
const SHORTER: usize = 6;
/// A step that promises less than this, in nats, is the last.
const ENOUGH: f64 = 0.02;

/// How likely other runs are at numbers near a fit's.
#[derive(Clone, Debug)]
pub struct NearFit {
    /// How far off the fit's the numbers are, each in its unit.
    pub off: DVector<f64>,
    /// Log-likelihood there.
    pub log_likelihood: f64,
    /// Its slopes by the numbers.
    pub slopes: DVector<f64>,
    /// Information on them, the expectation of minus the second slopes.
    pub information: DMatrix<f64>,
}

/// Where likelihood and fit together are largest.
#[derive(Clone, Debug)]
pub struct Top {
    /// Log of the mean likelihood over the fit's numbers.
    pub log_mean: f64,
    /// How far off the fit's the numbers are there, each in its unit.
    pub off: DVector<f64>,
    /// Probability that numbers as uncertain as the fit leaves them are asked to move as far. One where nothing moves.
    pub p_value: f64,
}

/// Log of the mean likelihood over numbers that are normal with that covariance, by Laplace's approximation (Tierney and Kadane 1986): exact where
/// the likelihood is normal. `at` has the likelihood at numbers that far off the mean, `None` where there is none. Of a covariance that is not
/// positive definite the likelihood at the mean.
pub fn averaged(covariance: &DMatrix<f64>, at: impl Fn(&DVector<f64>) -> Option<NearFit>) -> Option<f64> {
    Some(top(covariance, at)?.log_mean)
}

/// [`averaged`], with the numbers that the other runs and the fit together ask for.
pub fn top(covariance: &DMatrix<f64>, at: impl Fn(&DVector<f64>) -> Option<NearFit>) -> Option<Top> {
    let n = covariance.nrows();
    let mut here = at(&DVector::zeros(n))?;
    // In numbers u of unit covariance, with off = L u.
    let Some(lower) = Cholesky::new(covariance.clone()).map(|c| c.unpack()) else {
        return Some(Top { log_mean: here.log_likelihood, off: here.off, p_value: 1.0 });
    };
    let unit = |off: &DVector<f64>| lower.solve_lower_triangular(off);
    let value = |l: &NearFit| unit(&l.off).map(|u| l.log_likelihood - 0.5 * u.norm_squared());
    for _ in 0..MOST {
        let u = unit(&here.off)?;
        let slope = lower.tr_mul(&here.slopes) - &u;
        let step = posterior(&lower, &here)?.solve(&slope);
        if 0.5 * slope.dot(&step) < ENOUGH {
            break;
        }
        let now = value(&here)?;
        let shorter = |halvings: i32| at(&(&lower * (&u + &step * 0.5_f64.powi(halvings))));
        let Some(next) = (0..SHORTER as i32).filter_map(shorter).find(|l| value(l).is_some_and(|v| v > now)) else { break };
        here = next;
    }
    let root = posterior(&lower, &here)?;
    let logs: f64 = root.l_dirty().diagonal().iter().map(|x| x.ln()).sum();
    let p_value = chance_of_moving(&unit(&here.off)?, &(lower.tr_mul(&here.information) * &lower));
    Some(Top { log_mean: value(&here)? - logs, off: here.off, p_value })
}

/// Probability that numbers of unit covariance are asked to move as far, by runs with this information on them. Where fit and runs are of one
/// truth the covariance of the move is `M (I + M)⁻¹`, with M the information. Its square has the mean `Σw` and the variance `2 Σw²` of the
/// eigenvalues w; χ² with both (Satterthwaite 1946).
fn chance_of_moving(u: &DVector<f64>, information: &DMatrix<f64>) -> f64 {
    if information.is_empty() {
        return 1.0;
    }
    let weights = information.clone().symmetric_eigenvalues().map(|m| m.max(0.0) / (1.0 + m.max(0.0)));
    let (sum, squares) = (weights.sum(), weights.norm_squared());
    if squares <= 0.0 {
        return 1.0;
    }
    ChiSquared::new(sum * sum / squares).map_or(1.0, |c| c.sf(u.norm_squared() * sum / squares))
}

/// Root of the information of fit and other runs together, in numbers of unit covariance.
fn posterior(lower: &DMatrix<f64>, here: &NearFit) -> Option<Cholesky<f64, nalgebra::Dyn>> {
    let n = lower.nrows();
    Cholesky::new(DMatrix::identity(n, n) + lower.tr_mul(&here.information) * lower)
}

impl Engine {
    /// Log predictive density of other runs in the same noise: their likelihood averaged over what the fit leaves of its numbers (Gelman
    /// et al. 2013, §7.1). Random inputs are as fitted. `None` without such runs or where the model departs.
    #[must_use]
    pub fn predictive(&self, fit: &Fit, runs: &[usize]) -> Option<f64> {
        let others = self.beside(&self.campaign, runs)?;
        Some(others.top_near(fit)?.log_mean)
    }

    /// Where the likelihood of these runs and another fit's numbers are largest together. `None` where the fit's model departs.
    pub(crate) fn top_near(&self, fit: &Fit) -> Option<Top> {
        let at = |wanted: &DVector<f64>| {
            let mut model = fit.model.clone();
            let numbers = &fit.numbers[..wanted.len()];
            // Within its range a number may have gone less far.
            let off = numbers.iter().zip(wanted.iter()).map(|(n, by)| model.moved(n, *by));
            let off = DVector::from_iterator(numbers.len(), off);
            let sum = self.sum(&model, numbers, &[]).ok()?;
            Some(NearFit { off, log_likelihood: sum.log_likelihood, slopes: sum.b, information: sum.g })
        };
        top(&fit.covariance, at)
    }
}

#[cfg(test)]
mod tests;
