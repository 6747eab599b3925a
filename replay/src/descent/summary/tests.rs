//! replay tests: spread of a few numbers by hand.

use super::Spread;

/// Mean 3, variance (4 + 1 + 0 + 9)/3, quantiles at places 0.075, 1.5 and 2.925 of 1, 2, 3, 6; of one number no scatter.
#[test]
fn exact_spread_of_four_numbers() {
    let s = Spread::of(vec![3.0, 1.0, 6.0, 2.0]);
    assert!((s.mean - 3.0).abs() < 1e-15 && (s.std - (14.0_f64 / 3.0).sqrt()).abs() < 1e-15);
    for (q, by_hand) in s.quantiles.into_iter().zip([1.075, 2.5, 5.775]) {
        assert!((q - by_hand).abs() < 1e-14, "{q}, not {by_hand}");
    }
    assert!(Spread::of(vec![7.0]).std.abs() < 1e-300);
}
