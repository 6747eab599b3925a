//! pid tests: the noise of a smoothed signal. In: differences with a mean. Out: their standard deviation.

use super::*;

/// Standard deviation about the mean as Welford (1962) adds it up.
#[test]
fn exact_noise_is_the_standard_deviation_about_the_mean() {
    let raw = [3.7, -1.2, 5.9, 0.4, 2.6];
    let smoothed = [1.5, -2.9, 1.1, -4.8, 0.3];
    let (mut mean, mut square) = (0.0, 0.0);
    for (n, (a, b)) in (1..).zip(raw.iter().zip(&smoothed)) {
        let off = a - b - mean;
        mean += off / f64::from(n);
        square += off * (a - b - mean);
    }
    assert!((noise(&raw, &smoothed) - (square / 4.0_f64).sqrt()).abs() < 1e-14);
}
