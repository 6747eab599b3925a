//! discover tests: slow numbers against what the fast ones say, in closed forms of the F distribution.

use super::super::tests::close;
use super::*;

/// Two runs of twelve orders of one axis.
fn places() -> Vec<(usize, usize, f64)> {
    (0..24).map(|i| (i, i % 12, 0.3)).collect()
}

/// White noise alone, known from 16 fast numbers of mean square 1.7, and eight slow ones less six that were fitted: an F test with
/// 2 and 16 degrees of freedom, whose tail is `(1 + 2F/16)⁻⁸`. The size of the noise is found until a round gains 1e-4 of
/// log-likelihood, half a per cent of the size at the worst.
#[test]
fn exact_f_test_of_white_noise() {
    let square = 1.7_f64;
    let z: Vec<f64> = (0..24_usize)
        .map(|i| if i % 12 < 4 { 0.9 + 0.31 * i as f64 / 4.0 } else { square.sqrt() * if i % 2 == 0 { 1.0 } else { -1.0 } })
        .collect();
    let (noise, white, none) = (vec![Cov::identity() * 0.3; 2], vec![Cov::identity(); 2], vec![Cov::zeros(); 2]);
    let judged = AxisNoise { noise: &noise, parts: [&white, &none], z: &z }.judge("X", &places(), 6.0);
    let slow: f64 = z.iter().enumerate().filter(|(i, _)| i % 12 < 4).map(|(_, z)| z * z).sum();
    let f = slow / square / 2.0;
    let expected = (1.0 + 2.0 * f / 16.0).powi(-8);
    assert!((judged.p_value / expected - 1.0).abs() < 0.03 && (1e-4..0.5).contains(&expected), "{judged:?} {expected}");
    close(judged.rms, ((slow + 16.0 * square) / 24.0).sqrt(), 1e-12);
    assert!((judged.expected_rms / square.sqrt() - 1.0).abs() < 3e-3, "{judged:?}");
}

/// Sizes `v` of two diagonal parts have the information `½ Σ pᵢ pⱼ/σ²` of the fast numbers; what they imply for the slow ones in
/// sum is known as well as a sum of `2 W²/var W` squares (Satterthwaite 1946). A part whose size is zero is none.
#[test]
fn exact_degrees_of_freedom_of_two_sizes() {
    let own = |i: usize| [1.0 + 0.1 * i as f64, 2.9 - 0.17 * (i % 12) as f64, 0.3 + 0.05 * i as f64];
    let of = |k: usize| -> Vec<Cov> {
        (0..2).map(|b| Cov::from_diagonal(&nalgebra::SVector::from_fn(|i, _| own(b * BIN + i)[k]))).collect()
    };
    let (parts, sigma, z) = ([of(0), of(1)], of(2), vec![0.0; 24]);
    let judge = AxisNoise { noise: &sigma, parts: [&parts[0], &parts[1]], z: &z };
    let [slow, fast]: [Vec<usize>; 2] = [(0..24).filter(|i| i % 12 < 4).collect(), (0..24).filter(|i| i % 12 >= 4).collect()];
    let sum = |of: &[usize], f: &dyn Fn([f64; 3]) -> f64| of.iter().map(|i| f(own(*i))).sum::<f64>();
    let information = |i: usize, j: usize| sum(&fast, &|x| 0.5 * x[i] * x[j] / x[2].powi(2));
    let [a, b, c] = [information(0, 0), information(0, 1), information(1, 1)];
    let [u, v, whole] = [0, 1, 2].map(|k| sum(&slow, &|x| x[k]));
    let both = (u * u * c - 2.0 * u * v * b + v * v * a) / (a * c - b * b);
    for (sizes, variance) in [([0.4, 0.7], both), ([0.4, 0.0], u * u / a), ([0.0, 0.7], v * v / c)] {
        let expected = 2.0 * whole * whole / variance;
        assert!((judge.known(&slow, &fast, &sigma, &sizes) / expected - 1.0).abs() < 1e-10, "{expected}");
    }
}

/// `(1 + 2F/d)^(−d/2)` with 2 and `d` degrees of freedom, and its limit `exp(−χ²/2)` from 10,000 of them, where the two are apart
/// by a share `χ⁴/4d` or so.
#[test]
fn exact_tail_of_two_degrees_of_freedom() {
    for (x, d) in [(3.7_f64, 7.0_f64), (11.0, 40.0)] {
        close(tail(x, 2.0, d), (1.0 + x / d).powf(-0.5 * d), 1e-12);
    }
    close(tail(3.7, 2.0, 10_001.0), (-0.5 * 3.7_f64).exp(), 1e-12);
}
