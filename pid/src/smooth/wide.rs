//! pid: eight numbers side by side. In: rows of eight, functions of a spline. Out: their sums of products, on the vector unit.
//!
//! A product and the sum that takes it are rounded once, on every unit, and each number by itself, so that the unit decides on no bit. What is
//! summed stays in registers while the samples of an interval pass.

use super::bspline::ORDER;
use pulp::Simd;

/// The seven channels at one sample, or their coefficients, and a zero: as many as the widest vector unit takes at once.
pub(super) type WideRow = [f64; WIDE];
pub(super) const WIDE: usize = 8;

/// Vectors to a row.
#[inline(always)]
pub(super) fn parts<S: Simd>() -> std::ops::Range<usize> {
    0..WIDE / S::F64_LANES
}
#[inline(always)]
pub(super) fn load<S: Simd>(row: &WideRow, part: usize) -> S::f64s {
    S::as_simd_f64s(row).0[part]
}
#[inline(always)]
pub(super) fn store<S: Simd>(row: &mut WideRow, part: usize, x: S::f64s) {
    S::as_mut_simd_f64s(row).0[part] = x;
}
/// `sum + k·x`.
#[inline(always)]
pub(super) fn plus<S: Simd>(simd: S, sum: S::f64s, k: f64, x: S::f64s) -> S::f64s {
    simd.mul_add_f64s(simd.splat_f64s(k), x, sum)
}
/// `sum − k·x`.
#[inline(always)]
pub(super) fn minus<S: Simd>(simd: S, sum: S::f64s, k: f64, x: S::f64s) -> S::f64s {
    simd.negate_mul_add_f64s(simd.splat_f64s(k), x, sum)
}

/// One vector of each of the rows.
#[inline(always)]
pub(super) fn of_all<S: Simd>(simd: S, rows: &[WideRow; ORDER], part: usize) -> [S::f64s; ORDER] {
    let mut out = [simd.splat_f64s(0.0); ORDER];
    for (out, row) in out.iter_mut().zip(rows) {
        *out = load::<S>(row, part);
    }
    out
}
/// Value of the functions `b` with coefficients `c`.
#[inline(always)]
pub(super) fn gather<S: Simd>(simd: S, c: &[S::f64s; ORDER], b: &[f64; ORDER]) -> S::f64s {
    let mut sum = simd.splat_f64s(0.0);
    for (b, c) in b.iter().zip(c) {
        sum = plus(simd, sum, *b, *c);
    }
    sum
}
/// Adds to the sums of an interval what its samples give, less the fit `c` where there is one.
#[inline(always)]
pub(super) fn scatter<S: Simd>(
    simd: S,
    sums: &mut [WideRow; ORDER],
    values: &[[f64; ORDER]],
    samples: &[WideRow],
    fit: Option<&[WideRow; ORDER]>,
) {
    for part in parts::<S>() {
        let mut sum = of_all(simd, sums, part);
        let c = fit.map(|c| of_all(simd, c, part));
        for (b, y) in values.iter().zip(samples) {
            let mut y = load::<S>(y, part);
            if let Some(c) = &c {
                y = simd.sub_f64s(y, gather(simd, c, b));
            }
            for (sum, b) in sum.iter_mut().zip(b) {
                *sum = plus(simd, *sum, *b, y);
            }
        }
        for (row, sum) in sums.iter_mut().zip(sum) {
            store::<S>(row, part, sum);
        }
    }
}
