//! discover: one track's numbers in bins. In: a track in its basis, kernels of noise in time. Out: its residual, covariances per bin.

use super::bins::{BIN, Cov, Residual};
use super::track::Track;
use nalgebra::{DMatrix, DVector};

impl Track {
    pub(super) fn bins(&self) -> usize {
        self.basis.ncols().div_ceil(BIN)
    }

    /// A residual track in the basis, padded to whole bins.
    pub(super) fn binned(&self, e: &DVector<f64>) -> Residual {
        let mut z = self.basis.tr_mul(e).as_slice().to_vec();
        z.resize(self.bins() * BIN, 0.0);
        z
    }

    /// Covariance per bin of a steady push of 1 m/s² (standard deviation) along an axis.
    pub(super) fn push_blocks(&self, axis: usize) -> Vec<Cov> {
        let mut all = vec![Cov::zeros(); self.bins()];
        if let Some(k) = self.axes.iter().position(|a| *a == axis) {
            let c = self.push.column(k);
            let m = c.len();
            all[0].view_mut((0, 0), (m, m)).copy_from(&(c * c.transpose()));
        }
        all
    }

    /// Covariance per bin of noise that is independent between axes, from its kernel (axis, time, time) in time; entries that
    /// pad the last bin get `unused` on the diagonal.
    pub(super) fn blocks(&self, kernel: impl Fn(usize, f64, f64) -> f64, unused: f64) -> Vec<Cov> {
        let n = self.t_s.len();
        // Along each axis apart: most kernels are of one alone.
        let along = |(k, &axis): (usize, &usize)| {
            let time = DMatrix::from_fn(n, n, |i, j| kernel(axis, self.t_s[i], self.t_s[j]));
            (time.amax() > 0.0).then(|| (k, time * self.basis.rows(k * n, n)))
        };
        let parts: Vec<(usize, DMatrix<f64>)> = self.axes.iter().enumerate().filter_map(along).collect();
        (0..self.bins())
            .map(|bin| {
                let used = (self.basis.ncols() - bin * BIN).min(BIN);
                let mut block = DMatrix::zeros(used, used);
                for (k, right) in &parts {
                    let b = self.basis.view((k * n, bin * BIN), (n, used));
                    block += b.tr_mul(&right.columns(bin * BIN, used));
                }
                let mut m = Cov::identity() * unused;
                for i in 0..used {
                    for j in 0..used {
                        m[(i, j)] = 0.5 * (block[(i, j)] + block[(j, i)]);
                    }
                }
                m
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
