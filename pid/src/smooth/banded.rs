//! pid: symmetric banded systems. In: normal matrix of a local basis. Out: its Cholesky factor and solutions.

use super::bspline::ORDER;

const BAND: usize = ORDER - 1;

/// Symmetric positive definite matrix, half-bandwidth 7: `rows[i][k]` is the element (i, i − 7 + k).
pub(super) struct Banded {
    pub(super) rows: Vec<[f64; ORDER]>,
}

/// Lower Cholesky factor in the same storage, with reciprocals on the diagonal.
pub(super) struct BandedFactor {
    rows: Vec<[f64; ORDER]>,
}

impl Banded {
    pub(super) fn zeros(n: usize) -> Self {
        Self { rows: vec![[0.0; ORDER]; n] }
    }
    /// Adds the outer product of eight values that start at coefficient `first`.
    pub(super) fn add_outer(&mut self, first: usize, b: &[f64; ORDER]) {
        for (i, bi) in b.iter().enumerate() {
            let row = &mut self.rows[first + i];
            for (j, bj) in b.iter().enumerate().take(i + 1) {
                row[BAND + j - i] += bi * bj;
            }
        }
    }
    /// Cholesky factor; `None` when the matrix is not positive definite to rounding.
    pub(super) fn factor(mut self) -> Option<BandedFactor> {
        for i in 0..self.rows.len() {
            let mut row = self.rows[i];
            for k in BAND.saturating_sub(i)..BAND {
                let j = i + k - BAND;
                let other = &self.rows[j];
                // Columns common to rows i and j: column c sits at m in row i and m + (i − j) in row j.
                let shift = i - j;
                let sum: f64 = (BAND.saturating_sub(i)..k).map(|m| row[m] * other[m + shift]).sum();
                row[k] = (row[k] - sum) * other[BAND];
            }
            let diagonal = row[BAND];
            let rest = diagonal - row[..BAND].iter().map(|v| v * v).sum::<f64>();
            if rest <= diagonal * 1.0e-14 || !rest.is_finite() {
                return None;
            }
            row[BAND] = 1.0 / rest.sqrt();
            self.rows[i] = row;
        }
        Some(BandedFactor { rows: self.rows })
    }
}

impl BandedFactor {
    /// L z = b in place, from the row `first` (those before are zero) to the end of `b`.
    #[inline(always)]
    pub(super) fn forward_to<const W: usize>(&self, b: &mut [[f64; W]], first: usize) {
        for i in first..b.len() {
            let row = &self.rows[i];
            let mut v = b[i];
            for k in BAND.saturating_sub(i - first)..BAND {
                let z = b[i + k - BAND];
                for (v, z) in v.iter_mut().zip(z) {
                    *v -= row[k] * z;
                }
            }
            b[i] = v.map(|v| v * row[BAND]);
        }
    }
    /// Lᵀ c = z in place.
    #[inline(always)]
    fn backward<const W: usize>(&self, b: &mut [[f64; W]]) {
        for i in (0..self.rows.len()).rev() {
            let row = &self.rows[i];
            let v = b[i].map(|v| v * row[BAND]);
            b[i] = v;
            for k in BAND.saturating_sub(i)..BAND {
                for (z, v) in b[i + k - BAND].iter_mut().zip(v) {
                    *z -= row[k] * v;
                }
            }
        }
    }
    /// Solves for W right-hand sides in place.
    #[inline(always)]
    pub(super) fn solve<const W: usize>(&self, b: &mut [[f64; W]]) {
        self.forward_to(b, 0);
        self.backward(b);
    }
}
