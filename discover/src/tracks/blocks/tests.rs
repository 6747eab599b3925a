//! discover tests: covariances per bin against the dense product with the basis.

use super::super::tests::{ball, thrown, times};
use super::*;

/// `Bᵀ K B`, its symmetrical half, in blocks of twelve along the diagonal: 18 orders of two channels, so that six pad the second
/// bin.
#[test]
fn exact_blocks_are_the_basis_about_the_kernel() {
    let t_s = times(11, 0.4, 1.7);
    let record = thrown(&t_s, &[0, 2], [1.0, 0.0, -2.0], [3.0, 0.0, 5.0]);
    let track = Track::new(&record, &[], 0, &ball(0.0), false).expect("flies");
    let kernel = |axis: usize, s: f64, r: f64| (axis as f64 + 0.7) * (s * s + 3.1 * s * r + 0.4 * r);
    let n = t_s.len();
    let dense = DMatrix::from_fn(2 * n, 2 * n, |i, j| {
        if i / n == j / n { kernel(track.axes[i / n], track.t_s[i % n], track.t_s[j % n]) } else { 0.0 }
    });
    let full = track.basis.transpose() * dense * &track.basis;
    let blocks = track.blocks(kernel, 0.7);
    assert_eq!((blocks.len(), full.nrows(), track.bins()), (2, 18, 2));
    for (bin, block) in blocks.iter().enumerate() {
        for i in 0..BIN {
            for j in 0..BIN {
                let [a, b] = [i, j].map(|k| bin * BIN + k);
                let inside = a < 18 && b < 18;
                let expected = if inside { f64::midpoint(full[(a, b)], full[(b, a)]) } else { 0.7 * f64::from(u8::from(i == j)) };
                assert!((block[(i, j)] - expected).abs() < 1e-12, "bin {bin}, {i} {j}: {} {expected}", block[(i, j)]);
            }
        }
    }
}
