//! verify tests: descents follow linear theory; the exponent of a motion of third order.

use super::*;
use crate::tests::pass;

#[test]
fn exact_descents_follow_linear_theory() {
    pass(&checks().expect("flies"));
}

/// A decaying exponential and a damped oscillation: its exponent, from their sum.
#[test]
fn exact_exponent_of_an_oscillation() {
    let at = |t: f64| 0.7 * (-0.9 * t).exp() + (-0.35 * t).exp() * (2.6 * t + 0.4).cos();
    let found = oscillation(&(0..60).map(|k| at(0.17 * f64::from(k))).collect::<Vec<f64>>(), 0.17);
    assert!((found.re + 0.35).abs() < 1e-9 && (found.im - 2.6).abs() < 1e-9, "{found}");
}
