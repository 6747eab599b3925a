//! pid: symmetric banded systems. In: normal matrix of a local basis. Out: its Cholesky factor and solutions.

use super::bspline::ORDER;
use super::wide::{WideRow, load, minus, parts, store};
use pulp::Simd;

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
    pub(super) fn forward_to(&self, b: &mut [f64], first: usize) {
        for i in first..b.len() {
            let row = &self.rows[i];
            let mut v = b[i];
            for k in BAND.saturating_sub(i - first)..BAND {
                v -= row[k] * b[i + k - BAND];
            }
            b[i] = v * row[BAND];
        }
    }
    /// Solves for eight right-hand sides in place.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(&self, simd: S, b: &mut [WideRow]) {
        for part in parts::<S>() {
            self.forward(simd, b, part);
            self.backward(simd, b, part);
        }
    }
    /// L z = b.
    #[inline(always)]
    fn forward<S: Simd>(&self, simd: S, b: &mut [WideRow], part: usize) {
        for (i, row) in self.rows.iter().enumerate() {
            let mut v = load::<S>(&b[i], part);
            for k in BAND.saturating_sub(i)..BAND {
                v = minus(simd, v, row[k], load::<S>(&b[i + k - BAND], part));
            }
            store::<S>(&mut b[i], part, simd.mul_f64s(v, simd.splat_f64s(row[BAND])));
        }
    }
    /// Lᵀ c = z.
    #[inline(always)]
    fn backward<S: Simd>(&self, simd: S, b: &mut [WideRow], part: usize) {
        let n = self.rows.len();
        for i in (0..n).rev() {
            let mut v = load::<S>(&b[i], part);
            for ahead in (1..=BAND.min(n - 1 - i)).rev() {
                v = minus(simd, v, self.rows[i + ahead][BAND - ahead], load::<S>(&b[i + ahead], part));
            }
            store::<S>(&mut b[i], part, simd.mul_f64s(v, simd.splat_f64s(self.rows[i][BAND])));
        }
    }
}
