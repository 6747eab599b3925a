//! discover: chances of a gain of likelihood. In: a statistic. Out: p-values corrected for what was tried.

use crate::residual::ChannelResidual;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Upper tail of χ², corrected for `tried` attempts (Šidák 1967).
#[must_use]
pub fn p_value(statistic: f64, degrees: usize, tried: usize) -> f64 {
    if statistic.is_nan() || statistic <= 0.0 || degrees == 0 {
        return 1.0;
    }
    let one = ChiSquared::new(degrees as f64).map_or(1.0, |d| d.sf(statistic));
    p_value_of_best(one, tried)
}

/// Probability that the best of several does so well by chance (Šidák 1967).
pub(super) fn p_value_of_best(p: f64, tried: usize) -> f64 {
    -f64::exp_m1(tried as f64 * f64::ln_1p(-p.min(1.0 - 1e-16)))
}

/// Chance of the channel furthest beyond noise.
pub(super) fn p_least(c: &[ChannelResidual]) -> f64 {
    let least = c.iter().map(|x| x.p_value).fold(1.0, f64::min);
    p_value_of_best(least, c.len())
}

#[cfg(test)]
mod tests;
