//! pid tests: local polynomials against dense least squares. In: crooked samples. Out: values, derivatives, noise, weights.

use super::*;
use nalgebra::DVector;

/// Weights of value, rate and second derivative (per sample) at a place among m samples: powers of the distance, pseudo-inverse.
fn dense(m: usize, place: f64, degree: usize) -> [DVector<f64>; 3] {
    let powers = DMatrix::from_fn(m, degree + 1, |i, j| (i as f64 - place).powi(i32::try_from(j).expect("small")));
    let inverse = powers.pseudo_inverse(1e-14).expect("a small number");
    [(0, 1.0), (1, 1.0), (2, 2.0)].map(|(row, factorial)| inverse.row(row).transpose() * factorial)
}

#[test]
fn exact_windows_are_dense_least_squares_and_their_variances() {
    const N: usize = 23;
    const DT: f64 = 0.13;
    let x: [Vec<f64>; CHANNELS] = std::array::from_fn(|c| (0..N).map(|i| 3.0 + ((i * i + 5 * c) as f64).sin()).collect());
    let raw = std::array::from_fn(|c| x[c].as_slice());
    // Rounded to a sample; at least 2 samples for degree 3, and the window is not longer than the run.
    let (width_s, half) = ([0.4, 0.1, 9.0, 0.64, 0.7, 1.0, 1.3], [3, 2, 11, 5, 5, 8, 10]);
    let fit = smooth(raw, DT, &width_s, 3).expect("good settings");
    let mut weight = [1.0_f64; N];
    for c in 0..CHANNELS {
        let (h, m) = (half[c], 2 * half[c] + 1);
        assert!((fit.bandwidth_hz[c] * 4.0 * h as f64 * DT - 1.0).abs() < 1e-14);
        let middle = dense(m, h as f64, 3);
        let mut square = 0.0;
        for i in 0..N {
            let start = i.saturating_sub(h).min(N - m);
            let own = dense(m, (i - start) as f64, 3);
            let y = DVector::from_column_slice(&x[c][start..start + m]);
            let [value, rate, second] = [0, 1, 2].map(|k| own[k].dot(&y));
            let s = &fit.channels[c];
            // Rounding through powers of up to 22 samples: a condition number of 1e5.
            assert!((s.value[i] - value).abs() < 1e-10);
            assert!((s.rate[i] - rate / DT).abs() < 1e-9 && (s.second[i] - second / (DT * DT)).abs() < 1e-8);
            square += (x[c][i] - value).powi(2);
            weight[i] = weight[i].min(middle[2].norm() / own[2].norm());
        }
        // A residual in the middle of a window has the variance σ² (1 − its own weight).
        let std = (square / N as f64 / (1.0 - middle[0][h])).sqrt();
        assert!((fit.noise_std[c] - std).abs() < 1e-9);
    }
    assert!(fit.weight.iter().zip(weight).all(|(found, w)| (found - w).abs() < 1e-9));
}

/// A polynomial of degree 12 comes back: abscissae in [−1, 1] keep its digits, those of other intervals lose five and more.
#[test]
fn exact_polynomial_of_degree_12_keeps_its_digits() {
    let y: Vec<f64> = (0..61).map(|i| (12.0 * (f64::from(i) / 30.0 - 1.0).acos()).cos()).collect();
    let found = Window::new(30, 12).apply(&y, 1.0);
    let worst = found.value.iter().zip(&y).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
    assert!(worst < 1e-12, "{worst}");
}
