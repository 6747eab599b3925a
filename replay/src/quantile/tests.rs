//! replay tests: quantiles by hand.

use super::quantile;

/// Type 7 of four numbers: the place of p = 0.4 is 0.4·3 = 1.2, a fifth of the way from the second to the third.
#[test]
fn exact_quantiles_of_four_numbers() {
    let x = [1.0, 2.5, 7.5, 9.0];
    for (p, by_hand) in [(0.0, 1.0), (0.4, 3.5), (0.5, 5.0), (0.9, 8.55), (1.0, 9.0)] {
        assert!((quantile(&x, p) - by_hand).abs() < 1e-14, "{p}");
    }
    assert!((quantile(&[4.25], 0.7) - 4.25).abs() < 1e-15);
}
