//! discover tests: distances, p-values and errors against dense algebra written out.

use super::*;

/// Figures of seven runs; the second is not used.
fn rows() -> Rows {
    [
        [1.2, 0.3, 5.0, 0.7],
        [1.5, 9.0, 4.1, 0.9],
        [0.8, 2.0, 6.3, 0.6],
        [1.9, 0.1, 3.7, 1.4],
        [1.1, 4.0, 7.2, 0.8],
        [1.4, 5.5, 2.9, 1.3],
        [2.3, 0.6, 4.4, 0.5],
    ]
    .map(Vec::from)
    .to_vec()
}
const USED: [usize; 3] = [2, 0, 3];

/// Logarithms by rows, their mean, and `Xᵀ X / (n − 1)` of what is left with `floor²` on its diagonal.
fn dense(floor: f64) -> (DMatrix<f64>, DVector<f64>, DMatrix<f64>) {
    let all = DMatrix::from_fn(7, 3, |run, i| rows()[run][USED[i]].ln());
    let mean = all.row_mean().transpose();
    let centred = DMatrix::from_fn(7, 3, |run, i| all[(run, i)] - mean[i]);
    let covariance = centred.transpose() * &centred / 6.0 + DMatrix::identity(3, 3) * floor.powi(2);
    (all, mean, covariance)
}

/// Mean, covariance and minus twice the log-likelihood, `dᵀ Σ⁻¹ d + ln |Σ|`, to rounding.
#[test]
fn exact_spread() {
    let floor = 0.3;
    let (_, mean, covariance) = dense(floor);
    let spread = Spread::with_floor(&rows(), &USED, floor).expect("a covariance");
    assert!((&spread.mean - &mean).amax() < 1e-14 && (&spread.covariance - &covariance).amax() < 1e-14);
    let test = DVector::from_column_slice(&[1.1, 0.9, -0.4]);
    let d = &test - &mean;
    let inverse = covariance.clone().try_inverse().expect("positive");
    let surprise = d.dot(&(inverse * &d)) + covariance.determinant().ln();
    assert!((spread.surprise(&test) - surprise).abs() < 1e-12 * surprise.abs());
}

/// Of three parameters two move the figures by more than a standard deviation of one run; what is left of a difference is its part
/// outside their directions, errors are those of `(DᵀΣ⁻¹D / (1 + 1/n) + 12)⁻¹`.
#[test]
fn exact_tangent() {
    let spread = Spread::with_floor(&rows(), &USED, 0.1).expect("a covariance");
    let (_, mean, covariance) = dense(0.1);
    let inverse = covariance.try_inverse().expect("positive");
    let first = DVector::from_column_slice(&[0.9, -1.4, 2.0]);
    let second = DVector::from_column_slice(&[-1.1, 0.3, 0.8]);
    let third = &first * 0.01 + &second * 0.02;
    let derivative = DMatrix::from_columns(&[first.clone(), second.clone(), third]);
    let tangent = Tangent::new(&spread, &derivative);
    assert_eq!((tangent.rank(), tangent.degrees()), (2, 1));

    // Least squares of the difference by the two that are decided, weighted.
    let d = DVector::from_column_slice(&[1.9, 0.2, 0.6]) - mean;
    let part = DMatrix::from_columns(&[first, second]);
    let weighed = part.transpose() * &inverse;
    let share = (&weighed * &part).try_inverse().expect("two directions") * (&weighed * &d);
    let left = &d - part * share;
    let expected = left.dot(&(&inverse * &left));
    assert!((tangent.left(&spread.whiten(&d)) - expected).abs() < 1e-9 * expected, "{expected}");

    let information = derivative.transpose() * inverse * &derivative / (1.0 + 1.0 / 5.0) + DMatrix::identity(3, 3) * 12.0;
    let expected = information.try_inverse().expect("a prior").diagonal().map(f64::sqrt);
    let found = DVector::from_vec(tangent.std_errors(5));
    assert!((&found - &expected).amax() < 1e-12, "{found} {expected}");
}

/// Runs at least as far out as the test by `dᵀ Σ⁻¹ d`, both counted with the test itself; and the share of others' runs beyond the
/// 95 % quantile of their own, of seven: 0.7 of the way from the sixth to the seventh.
#[test]
fn exact_shares() {
    let (all, mean, covariance) = dense(PRINTED);
    let inverse = covariance.try_inverse().expect("positive");
    let distance = |y: &DVector<f64>| (y - &mean).dot(&(&inverse * (y - &mean)));
    let own: Vec<f64> = (0..7).map(|run| distance(&all.row(run).transpose())).collect();
    let mut sorted = own.clone();
    sorted.sort_by(f64::total_cmp);

    let spread = Spread::of(&rows(), &USED).expect("a covariance");
    let nothing = Tangent::new(&spread, &DMatrix::zeros(3, 0));
    // Along one axis to just beyond the third nearest run: four are farther out.
    let axis = DVector::from_column_slice(&[1.0, 0.0, 0.0]);
    let test = &mean + &axis * (1.001 * sorted[2] / inverse[(0, 0)]).sqrt();
    assert!((p_value(&spread, &nothing, &rows(), &test, &USED) - 5.0 / 8.0).abs() < 1e-15);

    let limit = sorted[5] + 0.7 * (sorted[6] - sorted[5]);
    let others: Rows = [0.99, 1.01, 1.3, 4.0]
        .map(|out: f64| {
            let y = &mean + &axis * (out * limit / inverse[(0, 0)]).sqrt();
            vec![y[1].exp(), 77.0, y[0].exp(), y[2].exp()]
        })
        .to_vec();
    assert!((rejected(&spread, &nothing, &rows(), &others, &USED) - 0.75).abs() < 1e-15);
}
