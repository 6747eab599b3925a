//! likelihood tests: predictive densities against those of normal numbers, and of a flight that a fit has not seen.

use super::*;
use crate::flown::flown;
use crate::model::Id;

/// Log density of what is off by `d` under a covariance.
fn normal(d: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
    let root = Cholesky::new(covariance.clone()).expect("definite");
    let logs: f64 = root.l().diagonal().iter().map(|x| x.ln()).sum();
    -0.5 * d.dot(&root.solve(d)) - logs
}

/// Of a linear model with normal errors: the density under the errors' covariance and what the numbers add; as far off as four hundred errors; without
/// numbers the likelihood itself, and where there is none, none.
#[test]
fn exact_linear() {
    let h = DMatrix::from_row_slice(4, 2, &[1.0, 0.5, -2.0, 1e-3, 0.3, 2.0, 0.0, -1.5]);
    let errors = DMatrix::from_diagonal(&DVector::from_vec(vec![0.01, 0.04, 0.02, 0.09]));
    let covariance = DMatrix::from_row_slice(2, 2, &[0.25, -3.0, -3.0, 100.0]);
    let inverse = errors.clone().try_inverse().expect("regular");
    for y in [[0.2, -0.1, 0.4, 0.3], [40.0, -30.0, 17.0, 80.0]] {
        let y = DVector::from_row_slice(&y);
        let at = |off: &DVector<f64>| {
            let left = &y - &h * off;
            Some(NearFit {
                off: off.clone(),
                log_likelihood: normal(&left, &errors),
                slopes: h.tr_mul(&(&inverse * left)),
                information: h.tr_mul(&inverse) * &h,
            })
        };
        let all = &errors + &h * &covariance * h.transpose();
        let (found, expected) = (averaged(&covariance, at).expect("a density"), normal(&y, &all));
        assert!((found / expected - 1.0).abs() < 1e-10, "{found} {expected}");
        let none = |off: &DVector<f64>| {
            let (slopes, information) = (DVector::zeros(0), DMatrix::zeros(0, 0));
            Some(NearFit { off: off.clone(), slopes, information, ..at(&DVector::zeros(2))? })
        };
        let alone = averaged(&DMatrix::zeros(0, 0), none).expect("a density");
        assert!((alone - normal(&y, &errors)).abs() < 1e-12, "{alone}");
    }
    assert!(averaged(&covariance, |_| None).is_none());
}

/// Where information is understated fourfold a step goes far beyond the top: half of it is taken, and so on to the top, `κa/(1 + κ)` off.
#[test]
fn exact_shorter_steps() {
    let (a, information) = (3.0, 4.0);
    let at = |off: &DVector<f64>| {
        let left = a - off[0];
        Some(NearFit {
            off: off.clone(),
            log_likelihood: -0.5 * information * left * left,
            slopes: DVector::from_element(1, information * left),
            information: DMatrix::from_element(1, 1, 0.25 * information),
        })
    };
    let found = averaged(&DMatrix::identity(1, 1), at).expect("a density");
    let top = -0.5 * a * a * information / (1.0 + information);
    assert!((found - (top - 0.5 * 2.0_f64.ln())).abs() < 0.01, "{found} {top}");
}

/// Numbers known much better than a run could tell leave it as likely as they are; one that is hardly known may stand anywhere within its error, at which the
/// likelihood itself falls by hundreds; a fit that knows it badly predicts worse than one that knows it well.
#[test]
fn law_a_number_hardly_known() {
    let (engine, model) = flown(2.0, "center-of-mass", &[0.0, 1e-3, 0.0]);
    let fit = engine.climb(&model, false, 12).expect("a fit");
    let n = fit.numbers.len();
    let likelihood = |fit: &Fit| engine.sum(&fit.model, &[], &[]).expect("a pass").log_likelihood;
    let predicted = |fit: &Fit| engine.predictive(fit, &[0]).expect("a density");
    let sure = Fit { covariance: DMatrix::from_diagonal(&fit.covariance.diagonal()) * 1e-8, ..fit.clone() };
    assert!((predicted(&sure) - likelihood(&fit)).abs() < 1e-3, "{} {}", predicted(&sure), likelihood(&fit));

    let i = fit.numbers.iter().position(|n| n.id == Id::Declared(0)).expect("declared");
    let std = fit.covariance[(i, i)].sqrt();
    let wide = |by: f64| {
        let mut covariance = DMatrix::from_diagonal(&DVector::from_element(n, 1e-20));
        covariance[(i, i)] = (1000.0 * std).powi(2);
        let mut model = fit.model.clone();
        model.change(&fit.numbers[i], by * 1000.0 * std);
        Fit { model, covariance, ..fit.clone() }
    };
    let (at, off) = (wide(0.0), wide(0.1));
    assert!(likelihood(&off) < likelihood(&at) - 100.0, "{} {}", likelihood(&off), likelihood(&at));
    // Half the square of a tenth.
    assert!((predicted(&at) - predicted(&off) - 0.005).abs() < 0.03, "{} {}", predicted(&at), predicted(&off));
    // A thousand errors wide, with what other numbers hold of it: at least the logarithm of a hundred worse.
    assert!(predicted(&at) < predicted(&sure) - 100.0_f64.ln(), "{} {}", predicted(&at), predicted(&sure));
    assert!(engine.predictive(&fit, &[]).is_none());
}
