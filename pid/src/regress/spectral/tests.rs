//! pid tests: least squares weighted by spectrum against dense sums. In: crooked series. Out: cosines, spectrum, estimates.

use super::*;
use crate::regress::Colour;

fn series(n: usize) -> RegressionSeries {
    let at = |c: usize| (0..n).map(|i| (0.7 + 0.37 * (c * i) as f64).sin() + 0.3 * ((i * i + 7 * c) as f64).cos()).collect();
    RegressionSeries {
        regressors: vec![at(1), at(2), at(3)],
        response: at(5),
        weight: Vec::new(),
        residuals: Colour::Weighted(17),
    }
}

/// DCT-II as it is written, orthonormal, over the length with its zeros: 29 rows and one.
#[test]
fn exact_cosines_are_the_transform_as_written() {
    let s = series(29);
    let found = cosines(&s, 17);
    for (x, c) in s.regressors.iter().zip(&found.regressors).chain([(&s.response, &found.response)]) {
        assert_eq!(c.len(), 17);
        for (k, c) in c.iter().enumerate() {
            let term = |(i, x): (usize, &f64)| x * (PI * k as f64 * (2 * i + 1) as f64 / 60.0).cos();
            let sum = x.iter().enumerate().map(term).sum::<f64>();
            let unit: f64 = if k == 0 { 1.0 / 30.0 } else { 2.0 / 30.0 };
            assert!((c - unit.sqrt() * sum).abs() < 1e-13);
        }
    }
}

/// Means over 12 neighbours on each side, as far as there are any; where they vanish, 1e-14 of the mean over all.
#[test]
fn exact_spectrum_is_the_mean_of_neighbours_with_a_floor() {
    let mut e: Vec<f64> = (0..61).map(|i| if i < 20 { 3.0 + f64::from(i * i).sin() } else { 0.0 }).collect();
    e[0] = 8.3;
    let all: f64 = e.iter().map(|v| v * v).sum::<f64>() / 61.0;
    for (k, found) in spectrum(&e).into_iter().enumerate() {
        let near: Vec<f64> = (0..61).filter(|i| k.abs_diff(*i) <= 12).map(|i| e[i].powi(2)).collect();
        let mean = (near.iter().sum::<f64>() / near.len() as f64).max(1e-14 * all);
        // Differences of running sums: round-off of the whole over 13 of them, and nothing where the sum stands still.
        assert!((found - mean).abs() < 1e-14 * all + 1e-12 * mean, "{k}: {found} {mean}");
        assert!(k < 32 || (found / mean - 1.0).abs() < 1e-12, "{k}: {found} {mean}");
    }
}

/// From the weights at which the rounds end: normal equations, chi square over the freedom that is left, and the whitened rows.
#[test]
fn exact_weighted_fit_is_dense_least_squares_under_its_own_weights() {
    let parts = [cosines(&series(29), 17), cosines(&series(45), 23)];
    let (all, columns) = ([&parts[0], &parts[1]], [2, 0]);
    let weights = spectra(&all, &columns).expect("full rank");
    let found = weighted(&all, &columns).expect("full rank");
    let rows: Vec<(f64, [f64; 2], f64)> = parts
        .iter()
        .zip(&weights)
        .flat_map(|(c, v)| (0..c.len()).map(|k| (v[k], columns.map(|j| c.regressors[j][k]), c.response[k])))
        .collect();
    let x = DMatrix::from_fn(40, 2, |i, j| rows[i].1[j]);
    let y = DVector::from_fn(40, |i, _| rows[i].2);
    let inverse = DMatrix::from_diagonal(&DVector::from_fn(40, |i, _| 1.0 / rows[i].0));
    let bread = (x.transpose() * &inverse * &x).try_inverse().expect("two independent columns");
    let estimate = &bread * x.transpose() * &inverse * &y;
    let e = &y - &x * &estimate;
    let expected = bread * (e.dot(&(&inverse * &e)) / 38.0);
    let covariance = found.covariance.expect("of weighted rows");
    // Round-off of normal equations of two well conditioned columns.
    assert!((DVector::from_vec(found.estimate) - estimate).norm() < 1e-12);
    assert!((&covariance - &expected).norm() < 1e-12 * expected.norm(), "{covariance} {expected}");
    assert!(found.freedom.iter().all(|f| (f - 38.0).abs() < 1e-14));
    for (c, v) in parts.iter().zip(&weights) {
        let (x, y) = whitened(c, v);
        for k in 0..c.len() {
            assert!((y[k] * v[k].sqrt() - c.response[k]).abs() < 1e-14);
            assert!((0..3).all(|j| (x[(k, j)] * v[k].sqrt() - c.regressors[j][k]).abs() < 1e-14));
        }
    }
}
