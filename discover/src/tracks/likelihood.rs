//! discover: Gaussian likelihood of binned residuals with variance components. In: residuals and unit
//! covariances. Out: log-likelihood, whitening, component sizes.

use super::bins::{BIN, Cov, Residual};
use nalgebra::SVector;

/// A covariance per bin with its Cholesky factors.
pub(crate) struct Whitening {
    inverse_lower: Vec<Cov>,
    log_det: f64,
}

impl Whitening {
    /// Factors every bin; `None` when one is not positive definite.
    pub(crate) fn new(sigma: &[Cov]) -> Option<Self> {
        let mut inverse_lower = Vec::with_capacity(sigma.len());
        let mut log_det = 0.0;
        for s in sigma {
            let (inverse, ln) = inverse_of_factor(s)?;
            log_det += 2.0 * ln;
            inverse_lower.push(inverse);
        }
        Some(Self { inverse_lower, log_det })
    }
    /// Residuals to unit variance.
    pub(crate) fn whiten(&self, z: &[f64]) -> Residual {
        let mut out = vec![0.0; z.len()];
        for ((li, zb), ob) in self.inverse_lower.iter().zip(z.chunks_exact(BIN)).zip(out.chunks_exact_mut(BIN)) {
            if zb.iter().all(|x| *x == 0.0) {
                continue;
            }
            for i in 0..BIN {
                ob[i] = (0..=i).map(|j| li[(i, j)] * zb[j]).sum();
            }
        }
        out
    }
    /// −½ Σ (ln|Σ| + zᵀΣ⁻¹z); constants that no hypothesis changes are left out.
    pub(crate) fn log_likelihood(&self, z: &[f64]) -> f64 {
        -0.5 * (self.log_det + self.whiten(z).iter().map(|x| x * x).sum::<f64>())
    }
}

/// `LᵀL`, for the inverse `L` of a lower factor.
fn squared(l: &Cov) -> Cov {
    let mut inverse = Cov::zeros();
    for j in 0..BIN {
        for k in j..BIN {
            let f = l[(k, j)];
            for i in 0..=k {
                inverse[(i, j)] += l[(k, i)] * f;
            }
        }
    }
    inverse
}

/// Inverse of the lower Cholesky factor `L` of `Σ = LLᵀ`, and Σ ln L_ii; `None` when Σ is not positive definite.
fn inverse_of_factor(s: &Cov) -> Option<(Cov, f64)> {
    let mut l = *s;
    let (mut inverse, mut ln) = (Cov::zeros(), 0.0);
    for j in 0..BIN {
        for k in 0..j {
            let f = l[(j, k)];
            for i in j..BIN {
                l[(i, j)] -= l[(i, k)] * f;
            }
        }
        let d = l[(j, j)];
        if d.is_nan() || d <= 0.0 {
            return None;
        }
        let root = d.sqrt();
        ln += root.ln();
        for i in j..BIN {
            l[(i, j)] /= root;
        }
    }
    for j in 0..BIN {
        inverse[(j, j)] = 1.0;
        for k in j..BIN {
            let x = inverse[(k, j)] / l[(k, k)];
            inverse[(k, j)] = x;
            for i in k + 1..BIN {
                inverse[(i, j)] -= l[(i, k)] * x;
            }
        }
    }
    Some((inverse, ln))
}

/// Noise plus scaled components.
pub(crate) fn total(noise: &[Cov], components: &[&[Cov]], sizes: &[f64]) -> Vec<Cov> {
    let mut sigma = noise.to_vec();
    for (component, v) in components.iter().zip(sizes) {
        if *v > 0.0 {
            for (s, m) in sigma.iter_mut().zip(*component) {
                *s += m * *v;
            }
        }
    }
    sigma
}

/// Maximum-likelihood sizes (variances, not negative) of components by the minorise-maximise update of Zhou, Hu, Zhou and
/// Lange (2019), which never lowers the likelihood, extrapolated in the logarithm by the squared scheme of Varadhan and Roland
/// (2008); from the given start, until the likelihood gains little.
pub(crate) fn components(noise: &[Cov], parts: &[&[Cov]], z: &[f64], start: &[f64], effort: Effort) -> (Vec<f64>, f64) {
    let step = |log: &[f64]| -> Option<(Vec<f64>, f64)> {
        let sizes: Vec<f64> = log.iter().map(|x| x.exp()).collect();
        let (ratios, l) = sweep(noise, parts, &sizes, z)?;
        Some((ratios.iter().zip(log).map(|(r, x)| (x + r.max(1e-6).ln()).max(SMALLEST)).collect(), l))
    };
    let mut x0: Vec<f64> = start.iter().map(|v| v.max(1e-300).ln().max(SMALLEST)).collect();
    let mut last = f64::NEG_INFINITY;
    for _ in 0..effort.rounds {
        let Some((x1, l0)) = step(&x0) else { break };
        if l0 - last < effort.gain && last.is_finite() {
            last = l0;
            break;
        }
        last = l0;
        let Some((x2, l1)) = step(&x1) else { break };
        let far = extrapolated(&x0, &x1, &x2);
        x0 = match step(&far) {
            Some((next, l)) if l >= l1 => next,
            _ => x2,
        };
    }
    (x0.iter().map(|x| if *x <= SMALLEST { 0.0 } else { x.exp() }).collect(), last)
}

/// Where three values of an iteration that converges linearly lead: exactly to its limit at one rate up to 31/32, with steps as
/// long as 32 of its own at the most.
fn extrapolated(x0: &[f64], x1: &[f64], x2: &[f64]) -> Vec<f64> {
    let r: Vec<f64> = x1.iter().zip(x0).map(|(a, b)| a - b).collect();
    let v: Vec<f64> = x2.iter().zip(x1).zip(&r).map(|((a, b), r)| a - b - r).collect();
    let norm = |x: &[f64]| x.iter().map(|a| a * a).sum::<f64>().sqrt();
    let a = -(norm(&r) / norm(&v).max(1e-12)).clamp(1.0, 32.0);
    x0.iter().zip(&r).zip(&v).map(|((x, r), v)| (x - 2.0 * a * r + a * a * v).max(SMALLEST)).collect()
}

/// How exactly sizes are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Effort {
    /// Gain of log-likelihood per round at which to stop.
    pub(crate) gain: f64,
    /// Most rounds, of three evaluations each.
    pub(crate) rounds: usize,
}

impl Effort {
    /// For estimates.
    pub(crate) const FULL: Self = Self { gain: 0.02, rounds: 40 };
}

/// Logarithm below which a size counts as zero.
const SMALLEST: f64 = -30.0;

/// Square roots of the update's ratios per component, and the log-likelihood, at given sizes.
fn sweep(noise: &[Cov], parts: &[&[Cov]], sizes: &[f64], z: &[f64]) -> Option<(Vec<f64>, f64)> {
    let mut num = vec![0.0; parts.len()];
    let mut den = vec![0.0; parts.len()];
    let mut l = 0.0;
    for (bin, (zb, start)) in z.chunks_exact(BIN).zip(noise).enumerate() {
        let mut sigma = *start;
        for (part, v) in parts.iter().zip(sizes) {
            if *v > 0.0 {
                sigma.zip_apply(&part[bin], |s, m| *s += m * v);
            }
        }
        let (lower, ln) = inverse_of_factor(&sigma)?;
        let inv = squared(&lower);
        let z = SVector::<f64, BIN>::from_column_slice(zb);
        let x = inv * z;
        l -= ln + 0.5 * x.dot(&z);
        for (c, part) in parts.iter().enumerate() {
            if sizes[c] > 0.0 {
                let m = &part[bin];
                num[c] += x.dot(&(m * x));
                den[c] += inv.dot(m);
            }
        }
    }
    Some((num.iter().zip(den).map(|(n, d)| if d > 0.0 { (n / d).sqrt() } else { 0.0 }).collect(), l))
}

#[cfg(test)]
mod tests;
