//! pid tests: one number of several estimates.

use super::*;

fn estimate(coefficient: &str, name: &str, estimate: f64, std_error: f64) -> Estimate {
    Estimate {
        coefficient: coefficient.to_owned(),
        name: name.to_owned(),
        estimate,
        std_error,
        rse_percent: None,
        ci95: [0.0; 2],
        std_error_white: 0.0,
    }
}

fn set(parameters: Vec<Estimate>, covariance: Vec<Vec<f64>>) -> DataSet {
    DataSet {
        name: String::new(),
        runs: Vec::new(),
        parameters,
        fits: Vec::new(),
        condition_number: 1.0,
        n_samples: 0,
        covariance,
        curves: Vec::new(),
        held: vec![Held { name: "held".to_owned(), value: 0.7 }],
        constants: Vec::new(),
        effects: Vec::new(),
        refused: Vec::new(),
        envelope: None,
    }
}

/// Means by inverse variance, 1/0.04 and 1/0.25: shares 25/29 and 4/29, with which the covariance is carried over.
#[test]
fn exact_mean_of_two_estimates_and_its_covariance() {
    let parameters = vec![estimate("Cn", "m", 1.3, 0.2), estimate("CA", "a", 6.6, 0.3), estimate("Cm", "m", 1.9, 0.5)];
    let own = [[0.04, 0.011, 0.03], [0.011, 0.09, -0.02], [0.03, -0.02, 0.25]];
    let set = set(parameters, own.map(|r| r.to_vec()).to_vec());
    let structure = Structure {
        name: String::new(),
        parameters: ["m", "held", "a", "other"].map(str::to_owned).to_vec(),
        contributions: Vec::new(),
    };
    let (first, second) = (25.0 / 29.0, 4.0 / 29.0);
    let values = set.values(&structure, &[8.0, 8.0, 8.0, 8.5]);
    for (found, expected) in values.iter().zip([first * 1.3 + second * 1.9, 0.7, 6.6, 8.5]) {
        assert!((found - expected).abs() < 1e-14, "{values:?}");
    }
    let covariance = set.covariance_of(&structure).expect("complete");
    let m = first * first * 0.04 + 2.0 * first * second * 0.03 + second * second * 0.25;
    let ma = first * 0.011 - second * 0.02;
    let expected = DMatrix::from_row_slice(4, 4, &[m, 0.0, ma, 0.0, 0.0, 0.0, 0.0, 0.0, ma, 0.0, 0.09, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!((&covariance - expected).amax() < 1e-15, "{covariance}");
}

/// Exact estimates count like rounding, which is in proportion to each: weights 1/4 and 1/9.
#[test]
fn exact_mean_of_exact_estimates() {
    let set = set(vec![estimate("Cm", "m", -2.0, 0.0), estimate("Cn", "m", -3.0, 0.0)], Vec::new());
    let expected = -(2.0 / 4.0 + 3.0 / 9.0) / (1.0 / 4.0 + 1.0 / 9.0);
    assert!((set.value("m").expect("two") - expected).abs() < 1e-14);
    assert_eq!(set.covariance_of(&Structure::axisymmetric()), None);
}
