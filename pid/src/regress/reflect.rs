//! pid: Householder's reflections (1958) of tall columns on the vector unit. In: columns, the response last. Out: R and what is left of the response.
//!
//! Sums are kept in 32 parts whatever the unit, products and sums rounded one by one, so that the unit decides on no bit.

use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Parts of a sum.
const PARTS: usize = 32;

/// What least squares needs of tall columns.
pub(super) struct Triangle {
    /// Length of each column but the last.
    pub(super) scale: Vec<f64>,
    /// R of these columns, each of unit length; of no meaning where a length is zero or not finite.
    pub(super) r: DMatrix<f64>,
    /// First elements of Qᵀ times the last column, as many.
    pub(super) z: DMatrix<f64>,
}

impl Triangle {
    /// Columns as long as each other and longer than they are many.
    pub(super) fn of(mut columns: Vec<Vec<f64>>) -> Self {
        let (scale, diagonal) = Arch::new().dispatch(Reflected(&mut columns));
        let k = diagonal.len();
        let above = |i: usize, j: usize| if i < j { columns[j][i] } else { 0.0 };
        let r = DMatrix::from_fn(k, k, |i, j| if i == j { diagonal[j] } else { above(i, j) });
        Self { scale, r, z: DMatrix::from_fn(k, 1, |i, _| columns[k][i]) }
    }
    /// R⁻¹ with its rows over the columns' lengths: what brings z back to parameters of the columns as they were.
    pub(super) fn inverse(&self) -> Option<DMatrix<f64>> {
        let mut inverse = self.r.solve_upper_triangular(&DMatrix::identity(self.scale.len(), self.scale.len()))?;
        for (mut row, s) in inverse.row_iter_mut().zip(&self.scale) {
            row /= *s;
        }
        Some(inverse)
    }
}

/// Scales and reflects; lengths of the columns and diagonal of R, what is above it is left in the columns.
struct Reflected<'a>(&'a mut [Vec<f64>]);

impl WithSimd for Reflected<'_> {
    type Output = (Vec<f64>, Vec<f64>);
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let last = self.0.len() - 1;
        let (mut scale, mut diagonal) = (vec![0.0; last], vec![0.0; last]);
        for (column, scale) in self.0.iter_mut().zip(&mut scale) {
            *scale = dot(simd, column, column).sqrt();
            for x in column {
                *x /= *scale;
            }
        }
        for (j, diagonal) in diagonal.iter_mut().enumerate() {
            let (before, after) = self.0.split_at_mut(j + 1);
            let v = &mut before[j][j..];
            let size = dot(simd, v, v).sqrt();
            // Away from the first element, so that nothing cancels.
            *diagonal = if v[0] > 0.0 { -size } else { size };
            // Twice over vᵀv.
            let per = 1.0 / (*diagonal * (*diagonal - v[0]));
            if !per.is_finite() {
                continue;
            }
            v[0] -= *diagonal;
            for column in after {
                let column = &mut column[j..];
                let share = per * dot(simd, v, column);
                subtract(simd, column, share, v);
            }
        }
        (scale, diagonal)
    }
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [simd.splat_f64s(0.0); PARTS];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<PARTS>(), b.as_chunks::<PARTS>());
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(S::as_simd_f64s(a).0).zip(S::as_simd_f64s(b).0) {
            *sum = simd.add_f64s(*sum, simd.mul_f64s(*a, *b));
        }
    }
    let mut parts = [0.0; PARTS];
    for (part, sum) in S::as_mut_simd_f64s(&mut parts).0.iter_mut().zip(sums) {
        *part = sum;
    }
    for ((part, a), b) in parts.iter_mut().zip(a_rest).zip(b_rest) {
        *part += a * b;
    }
    parts.iter().sum()
}

/// `x − k·v` in the place of `x`.
#[inline(always)]
fn subtract<S: Simd>(simd: S, x: &mut [f64], k: f64, v: &[f64]) {
    let ((x, x_rest), (v, v_rest)) = (S::as_mut_simd_f64s(x), S::as_simd_f64s(v));
    let all = simd.splat_f64s(k);
    for (x, v) in x.iter_mut().zip(v) {
        *x = simd.sub_f64s(*x, simd.mul_f64s(all, *v));
    }
    for (x, v) in x_rest.iter_mut().zip(v_rest) {
        *x -= k * v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;
    use pulp::Scalar;

    fn columns(rows: usize, count: usize) -> Vec<Vec<f64>> {
        let at = |i: usize, j: usize| ((1 + j) as f64 * 0.37 * i as f64).sin() + 0.1 * ((i * i + 7 * j) as f64).cos();
        (0..count).map(|j| (0..rows).map(|i| at(i, j)).collect()).collect()
    }

    /// The normal equations hold: Xᵀ(y − X b) = 0 for b from R b = z, to rounding of sums of so many numbers below 2.
    #[test]
    fn exact_residual_is_orthogonal_to_the_columns() {
        for rows in [6, 40, 1000] {
            let all = columns(rows, 6);
            let t = Triangle::of(all.clone());
            let b = t.inverse().expect("full rank") * &t.z;
            let x = DMatrix::from_fn(rows, 5, |i, j| all[j][i]);
            let left = DVector::from_column_slice(&all[5]) - &x * b;
            assert!((x.transpose() * left).norm() < 1e-12 * rows as f64, "{rows} rows");
            let unit = DMatrix::from_fn(rows, 5, |i, j| all[j][i] / t.scale[j]);
            assert!((t.r.transpose() * &t.r - unit.transpose() * &unit).norm() < 1e-13, "{rows} rows");
        }
    }

    /// A column almost along the first row, either way: nothing cancels, so its products with the others keep their digits.
    #[test]
    fn exact_column_along_the_first_row_keeps_its_digits() {
        for first in [1.7, -1.7] {
            let all = vec![vec![first, 1.1e-6, -0.7e-6, 0.4e-6], vec![0.3, -0.8, 0.6, 1.9], vec![0.2, 0.5, -1.4, 0.9]];
            let t = Triangle::of(all.clone());
            let unit = DMatrix::from_fn(4, 2, |i, j| all[j][i] / t.scale[j]);
            assert!((t.r.transpose() * &t.r - unit.transpose() * unit).norm() < 1e-15);
            let left = DVector::from_column_slice(&all[2])
                - DMatrix::from_fn(4, 2, |i, j| all[j][i]) * (t.inverse().expect("full rank") * &t.z);
            assert!((0..2).all(|j| left.dot(&DVector::from_column_slice(&all[j])).abs() < 1e-14));
        }
    }

    #[test]
    fn exact_bits_on_every_unit() {
        let (mut a, mut b) = (columns(1003, 5), columns(1003, 5));
        assert_eq!(Arch::new().dispatch(Reflected(&mut a)), Reflected(&mut b).with_simd(Scalar::new()));
        assert_eq!(a, b);
    }
}
