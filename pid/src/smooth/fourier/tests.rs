//! pid tests: the noise of a smoothed signal. In: differences with a mean. Out: their standard deviation.

use super::*;

/// Standard deviation about the mean as Welford (1962) adds it up; the same about a mean that squares would drown in.
#[test]
fn exact_noise_is_the_standard_deviation_about_the_mean() {
    let raw = [3.75, -1.25, 5.875, 0.5, 2.75];
    let smoothed = [1.5, -2.875, 1.125, -4.75, 0.25];
    let (mut mean, mut square) = (0.0, 0.0);
    for (n, (a, b)) in (1..).zip(raw.iter().zip(&smoothed)) {
        let off = a - b - mean;
        mean += off / f64::from(n);
        square += off * (a - b - mean);
    }
    let std = (square / 4.0_f64).sqrt();
    assert!((noise(&raw, &smoothed) - std).abs() < 1e-14);
    // Eighths beside 2²⁷ are exact, their mean, 3.275 more, is not: what it is off by counts 2²⁸ times unless it is squared.
    assert!((noise(&raw.map(|a| a + f64::from(1 << 27)), &smoothed) - std).abs() < 1e-12);
}
