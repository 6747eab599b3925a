//! verify: Gaussian likelihood of binned residuals with variance components (Whittle 1953 for spectra). In: residuals and unit
//! covariances. Out: log-likelihood, whitening, component sizes.

use super::evidence::{BIN, Cov, Residual};
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
            let l = s.cholesky()?.l();
            log_det += 2.0 * (0..6).map(|i| l[(i, i)].ln()).sum::<f64>();
            inverse_lower.push(l.solve_lower_triangular(&Cov::identity())?);
        }
        Some(Self { inverse_lower, log_det })
    }
    /// Residuals to unit variance.
    pub(crate) fn whiten(&self, z: &[f64]) -> Residual {
        let mut out = vec![0.0; z.len()];
        for ((li, zb), ob) in self.inverse_lower.iter().zip(z.chunks_exact(BIN)).zip(out.chunks_exact_mut(BIN)) {
            for part in [0, 6] {
                for i in 0..6 {
                    ob[part + i] = (0..=i).map(|j| li[(i, j)] * zb[part + j]).sum();
                }
            }
        }
        out
    }
    /// −½ Σ (2 ln|Σ| + zᵀΣ⁻¹z): both parts of a bin share Σ; constants that no hypothesis changes are left out.
    pub(crate) fn log_likelihood(&self, z: &[f64]) -> f64 {
        -0.5 * (2.0 * self.log_det + self.whiten(z).iter().map(|x| x * x).sum::<f64>())
    }
    fn inverse(&self, bin: usize) -> Cov {
        let l = &self.inverse_lower[bin];
        l.transpose() * l
    }
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
/// Lange (2019), which never lowers the likelihood; from the given start, until the likelihood gains less than `gain`.
pub(crate) fn components(noise: &[Cov], parts: &[&[Cov]], z: &[f64], start: &[f64], gain: f64) -> (Vec<f64>, f64) {
    let mut sizes = start.to_vec();
    let mut last = f64::NEG_INFINITY;
    for iteration in 0..400 {
        let Some(w) = Whitening::new(&total(noise, parts, &sizes)) else { break };
        let l = w.log_likelihood(z);
        if iteration > 3 && l - last < gain {
            return (sizes, l);
        }
        last = l;
        let ratios = ratios(&w, parts, &sizes, z);
        // Squaring every other step's ratio is the usual acceleration; a plain step follows, so ascent is kept in pairs.
        for (v, r) in sizes.iter_mut().zip(ratios) {
            *v *= r;
        }
    }
    (sizes, last)
}

fn ratios(w: &Whitening, parts: &[&[Cov]], sizes: &[f64], z: &[f64]) -> Vec<f64> {
    let mut num = vec![0.0; parts.len()];
    let mut den = vec![0.0; parts.len()];
    for (bin, zb) in z.chunks_exact(BIN).enumerate() {
        let inv = w.inverse(bin);
        let re = inv * SVector::<f64, 6>::from_column_slice(&zb[..6]);
        let im = inv * SVector::<f64, 6>::from_column_slice(&zb[6..]);
        for (c, part) in parts.iter().enumerate() {
            if sizes[c] > 0.0 {
                let m = &part[bin];
                num[c] += (re.transpose() * m * re)[0] + (im.transpose() * m * im)[0];
                den[c] += 2.0 * inv.component_mul(m).sum();
            }
        }
    }
    num.iter().zip(den).map(|(n, d)| if d > 0.0 { (n / d).sqrt() } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    #[test]
    fn recover_component_sizes() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let bins = 2000;
        let noise = vec![Cov::identity(); bins];
        let a: Vec<Cov> = (0..bins)
            .map(|_| Cov::from_diagonal_element(1.0))
            .map(|mut m| {
                m[(0, 0)] = 0.0;
                m
            })
            .collect();
        let g = SVector::<f64, 6>::new(1.0, 2.0, 0.0, 0.0, 1.0, 0.0);
        let b: Vec<Cov> = (0..bins).map(|k| g * g.transpose() * (1.0 / (1.0 + k as f64 / 500.0))).collect();
        let (va, vb) = (0.5, 3.0);
        let mut z = Vec::new();
        for k in 0..bins {
            for _ in 0..2 {
                let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
                let common = draw() * (vb / (1.0 + k as f64 / 500.0)).sqrt();
                for (c, gc) in g.iter().enumerate() {
                    z.push(draw() + if c > 0 { draw() * f64::sqrt(va) } else { 0.0 } + gc * common);
                }
            }
        }
        let (v, _) = components(&noise, &[&a, &b], &z, &[1.0, 1.0], 1e-4);
        // 20,000 numbers inform the first, 4,000 the second: 4 standard errors.
        assert!((v[0] - va).abs() < 4.0 * 1.5 * (2.0 / 20_000.0_f64).sqrt(), "{v:?}");
        assert!((v[1] - vb).abs() < 4.0 * vb * 1.3 * (2.0 / 4_000.0_f64).sqrt(), "{v:?}");
    }
}
