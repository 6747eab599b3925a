//! pid tests: intervals and relative errors by hand.

use super::*;

/// An interval of 95 % is printed to nine places.
#[test]
fn exact_intervals_and_relative_errors() {
    let [low, high] = ci95(-3.7, 0.4);
    let normal = |x: f64| statrs::function::erf::erf(x / std::f64::consts::SQRT_2);
    assert!((normal((high + 3.7) / 0.4) - 0.95).abs() < 1e-9 && (low + high + 7.4).abs() < 1e-14, "{low} {high}");
    for (found, expected) in either_side(2.0, 3.0, 0.7).into_iter().zip([-0.1, 4.1]) {
        assert!((found - expected).abs() < 1e-15);
    }
    assert!((relative_percent(0.3, -2.4).expect("a number") - 12.5).abs() < 1e-14);
    assert_eq!(relative_percent(0.3, 0.0), None);
}
