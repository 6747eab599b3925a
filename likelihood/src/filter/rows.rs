//! likelihood: sums of rows, the filter's inner loops. In: rows of whole vectors. Out: their sums, in the order in which they stand.
//!
//! A part of the sum stays in registers while all rows are added to it. To be called from within a dispatch to the machine's vector unit.

/// Rows are of a multiple of this many numbers.
pub(super) const VECTOR: usize = 4;

/// `y += a x`.
#[inline(always)]
pub(super) fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

/// `y += Σ aᵢ xᵢ`, `xᵢ` the rows of `x`, `stride` apart; rows with a zero before them are left out. `y` is of whole vectors.
#[inline(always)]
pub(super) fn add_rows(a: &[f64], x: &[f64], stride: usize, y: &mut [f64]) {
    let mut from = 0;
    while from < y.len() {
        let x = &x[from..];
        let y = &mut y[from..];
        from += match y.len() {
            ..8 => part::<4>(a, x, stride, y),
            8..12 => part::<8>(a, x, stride, y),
            12..16 => part::<12>(a, x, stride, y),
            16..24 => part::<16>(a, x, stride, y),
            24..32 => part::<24>(a, x, stride, y),
            _ => part::<32>(a, x, stride, y),
        };
    }
}

/// The first `W` numbers of [`add_rows`], and how many they are.
#[inline(always)]
fn part<const W: usize>(a: &[f64], x: &[f64], stride: usize, y: &mut [f64]) -> usize {
    let Some(out) = y.first_chunk_mut::<W>() else { return y.len() };
    let mut sum = *out;
    for (i, &a) in a.iter().enumerate() {
        if a != 0.0
            && let Some(x) = x[i * stride..].first_chunk::<W>()
        {
            sum.iter_mut().zip(x).for_each(|(sum, x)| *sum += a * x);
        }
    }
    *out = sum;
    W
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same bits as row after row, of any length.
    #[test]
    fn exact_sums_of_rows() {
        for n in (4..80).step_by(4) {
            let x: Vec<f64> = (0..5 * n).map(|i| (i as f64 * 0.7).sin()).collect();
            let a = [0.3, 0.0, -1.7, 2.2, 1e-3];
            let (mut one, mut other) = (vec![0.1; n], vec![0.1; n]);
            add_rows(&a, &x, n, &mut one);
            a.iter().enumerate().for_each(|(i, a)| axpy(*a, &x[i * n..(i + 1) * n], &mut other));
            assert_eq!(one, other);
        }
    }
}
