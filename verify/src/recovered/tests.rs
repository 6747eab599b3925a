//! verify tests: errors over the largest value of their kind.

use super::*;

/// The worst of several, not that of the largest error.
#[test]
fn exact_worst_of_reconstructed() {
    let one = |largest_error, largest| Reconstructed { quantity: String::new(), unit: String::new(), largest_error, largest };
    let r = Recovery {
        method: "m".to_owned(),
        parameters: Vec::new(),
        states: vec![one(6e-6, 30.0), one(3e-6, 0.4), one(2e-6, 0.5)],
        coefficients: vec![one(3e-3, 2.5)],
    };
    let [states, coefficients] = &reconstructed(&r)[..] else { panic!("two checks") };
    assert!((states.figure - 7.5e-6).abs() < 1e-20 && (coefficients.figure - 1.2e-3).abs() < 1e-17);
}
