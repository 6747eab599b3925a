//! discover: is a track's residual beyond the noise of its tracker? In: residual of one axis in the basis. Out: a p-value.
//!
//! Cameras drift: their errors are white plus a random walk of unknown size, and a smooth residual must not be called physics
//! because a fast one is small. Both sizes are taken from the fast orders of the same residual (above [`SLOW`]); what they imply
//! for the slow orders is compared with what is there, with an F distribution whose second degrees of freedom say how well the
//! fast orders know it (Satterthwaite 1946).

use super::bins::{BIN, Cov};
use super::likelihood::{Effort, components, total};
use crate::residual::ChannelResidual;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Orders per run that count as slow: up to two and a half periods in the run.
const SLOW: usize = 4;

/// Effort of fitting two sizes.
const EFFORT: Effort = Effort { gain: 1e-4, rounds: 60 };

/// Noise, its two parts and the residual of one axis.
pub(super) struct AxisNoise<'a> {
    pub(super) noise: &'a [Cov],
    pub(super) parts: [&'a Vec<Cov>; 2],
    pub(super) z: &'a [f64],
}

impl AxisNoise<'_> {
    pub(super) fn judge(&self, channel: &str, places: &[(usize, usize, f64)], fitted: f64) -> ChannelResidual {
        let slow: Vec<usize> = places.iter().filter(|p| p.1 < SLOW).map(|p| p.0).collect();
        let fast: Vec<usize> = places.iter().filter(|p| p.1 >= SLOW).map(|p| p.0).collect();
        let sizes = self.sizes(&fast);
        let refs = [self.parts[0].as_slice(), self.parts[1].as_slice()];
        let sigma = total(self.noise, &refs, &sizes);
        let mean = |of: &dyn Fn(usize) -> f64| (places.iter().map(|p| of(p.0)).sum::<f64>() / places.len().max(1) as f64).sqrt();
        let statistic = groups(&slow).map(|g| quadratic(&sigma[g[0] / BIN], &g, self.z)).sum::<f64>();
        let first = (slow.len() as f64 - fitted).max(1.0);
        let second = self.known(&slow, &fast, &sigma, &sizes);
        let p_value = tail(statistic, first, second);
        ChannelResidual {
            channel: channel.to_owned(),
            rms: mean(&|i| self.z[i].powi(2)),
            expected_rms: mean(&|i| sigma[i / BIN][(i % BIN, i % BIN)]),
            p_value: if statistic.is_finite() { p_value } else { 0.0 },
        }
    }

    /// Maximum-likelihood sizes of the parts, from some numbers alone.
    fn sizes(&self, of: &[usize]) -> [f64; 2] {
        let bins: Vec<Vec<usize>> = groups(of).collect();
        let cut = |all: &[Cov], unused: f64| -> Vec<Cov> {
            bins.iter()
                .map(|g| {
                    let mut m = Cov::identity() * unused;
                    for i in g {
                        for j in g {
                            m[(i % BIN, j % BIN)] = all[i / BIN][(i % BIN, j % BIN)];
                        }
                    }
                    m
                })
                .collect()
        };
        let mut z = vec![0.0; bins.len() * BIN];
        for (b, g) in bins.iter().enumerate() {
            g.iter().for_each(|i| z[b * BIN + i % BIN] = self.z[*i]);
        }
        let parts = self.parts.map(|p| cut(p, 0.0));
        let (sizes, _) = components(&cut(self.noise, 1.0), &[&parts[0], &parts[1]], &z, &[1.0, 1.0], EFFORT);
        [sizes[0], sizes[1]]
    }

    /// Degrees of freedom with which the fast numbers know the variance of the slow ones.
    fn known(&self, slow: &[usize], fast: &[usize], sigma: &[Cov], sizes: &[f64; 2]) -> f64 {
        let mut information = Matrix2::zeros();
        for g in groups(fast) {
            let Some(inverse) = cut(&sigma[g[0] / BIN], &g).try_inverse() else { return 1.0 };
            let by = self.parts.map(|p| &inverse * cut(&p[g[0] / BIN], &g));
            information += Matrix2::from_fn(|i, j| 0.5 * (&by[i] * &by[j]).trace());
        }
        let share = |m: &[Cov]| slow.iter().map(|&i| m[i / BIN][(i % BIN, i % BIN)]).sum::<f64>();
        let whole = share(sigma);
        let weights = Vector2::from_fn(|i, _| if sizes[i] > 0.0 { share(self.parts[i]) } else { 0.0 });
        let live = Matrix2::from_fn(|i, j| {
            if weights[i] > 0.0 && weights[j] > 0.0 { information[(i, j)] } else { f64::from(u8::from(i == j)) }
        });
        let variance = live.try_inverse().map_or(f64::INFINITY, |inverse| weights.dot(&(inverse * weights)));
        (2.0 * whole * whole / variance.max(f64::MIN_POSITIVE)).clamp(1.0, 1e6)
    }
}

/// Upper tail of F for a sum of `first` squares; that of χ² when the denominator is as good as known (where the F tail of the
/// library loses its digits).
fn tail(statistic: f64, first: f64, second: f64) -> f64 {
    if second > 1e4 {
        return ChiSquared::new(first).map_or(1.0, |c| c.sf(statistic));
    }
    FisherSnedecor::new(first, second).map_or(1.0, |f| f.sf(statistic / first))
}

/// Numbers in the same bin, together.
fn groups(of: &[usize]) -> impl Iterator<Item = Vec<usize>> + '_ {
    of.chunk_by(|a, b| a / BIN == b / BIN).map(<[usize]>::to_vec)
}

fn cut(m: &Cov, g: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(g.len(), g.len(), |i, j| m[(g[i] % BIN, g[j] % BIN)])
}

fn quadratic(m: &Cov, g: &[usize], z: &[f64]) -> f64 {
    let x = DVector::from_iterator(g.len(), g.iter().map(|i| z[*i]));
    cut(m, g).cholesky().map_or(f64::NAN, |c| x.dot(&c.solve(&x)))
}

#[cfg(test)]
mod tests;
