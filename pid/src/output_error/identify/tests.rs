//! pid tests: estimates as they are reported.

use super::super::run::tests::erring;
use super::super::unknowns::unknowns;
use super::*;
use windfall_model::Knowledge;

/// Standard errors from the covariance's diagonal, and intervals that hold 95 % of a normal distribution.
#[test]
fn exact_intervals_are_those_of_a_normal_distribution() {
    let plant = erring();
    let declared: Vec<bool> = (0..plant.aero.values.len()).map(|i| i < 2).collect();
    let campaign = Campaign::of_flights("", &plant, &declared, &Knowledge::default(), Vec::new());
    let unknowns = unknowns(&campaign, &EstimateOptions::default()).expect("nothing asked for");
    let covariance = DMatrix::from_row_slice(2, 2, &[0.09, 0.01, 0.01, 0.0016]);
    let found = estimates(&campaign, &unknowns, &covariance, &(&covariance * 0.25));
    assert_eq!(found.len(), 2);
    let normal = |x: f64| statrs::function::erf::erf(x / std::f64::consts::SQRT_2);
    for (e, (i, std)) in found.iter().zip([(0, 0.3), (1, 0.04)]) {
        assert_eq!(e.name, plant.aero.structure.parameters[i]);
        assert!((e.estimate - plant.aero.values[i]).abs() < 1e-15 && (e.std_error - std).abs() < 1e-15);
        assert!((e.std_error_white - 0.5 * std).abs() < 1e-15);
        let [low, high] = e.ci95.map(|x| (x - e.estimate) / std);
        // Printed to nine places.
        assert!((low + high).abs() < 1e-12 && (normal(high) - 0.95).abs() < 1e-9, "{low} {high}");
    }
}
