//! discover tests: intervals by the normal law.

use super::*;
use statrs::distribution::{ContinuousCDF, Normal};

/// Between the ends lie 95 % of a normal number, as much below as above; to the digits of [`NORMAL_95`].
#[test]
fn exact_interval() {
    let normal = Normal::new(-3.7, 0.45).expect("positive");
    let [low, high] = ci95(-3.7, 0.45);
    assert!((normal.cdf(low) - 0.025).abs() < 1e-9 && (normal.cdf(high) - 0.975).abs() < 1e-9, "{low} {high}");
}
