//! pid tests: the tether's line against dense least squares.

use super::*;
use nalgebra::{DMatrix, DVector};

/// Normal equations `(XᵀX) b = Xᵀ f` of f = q a − w with X = [q | −1], q = ½ρV²; covariance s² (XᵀX)⁻¹, s² over n − 2. Their condition of
/// 1e3 leaves twelve digits.
#[test]
fn exact_line_of_least_squares() {
    let measured: [(f64, f64); 6] = [(0.7, 1.3), (1.9, 2.1), (2.4, 2.4), (5.1, 3.2), (6.0, 3.7), (9.3, 4.1)];
    let density = 1.7;
    let x = DMatrix::from_fn(6, 2, |i, j| if j == 0 { density / 2.0 * measured[i].1.powi(2) } else { -1.0 });
    let f = DVector::from_iterator(6, measured.iter().map(|m| m.0));
    let inverse = x.tr_mul(&x).try_inverse().expect("speeds differ");
    let b = &inverse * x.tr_mul(&f);
    let covariance = &inverse * ((f - x * &b).norm_squared() / 4.0);
    let found = fit(&measured, density).expect("six");
    let std = |i: usize| covariance[(i, i)].sqrt();
    let pairs = [
        (found.drag_area_ft2, b[0]),
        (found.weight_lbf, b[1]),
        (found.drag_area_std_ft2, std(0)),
        (found.weight_std_lbf, std(1)),
    ];
    for (found, expected) in pairs {
        assert!((found - expected).abs() < 1e-11, "{found} {expected}");
    }
    assert!(fit(&measured[..2], density).is_none());
}
