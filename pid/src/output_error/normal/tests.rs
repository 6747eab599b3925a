//! pid tests: the parameters' least squares against dense normal equations, and the length of steps against their geometric series.

use super::*;
use windfall_model::{Freedom, Unknown, UnknownId};

fn free(count: usize) -> Unknowns {
    let one = |i: usize| Unknown::linear(UnknownId::Parameter(i), "x", 0.3 - 0.7 * i as f64, Freedom::Free(i));
    Unknowns::from((0..count).map(one).collect::<Vec<_>>())
}

/// Upper triangles `[R | r]` of two runs, columns of unlike size.
fn runs(count: usize) -> Vec<Linearised> {
    let entry =
        |n: usize, i: usize, j: usize| if i > j { 0.0 } else { 3.0_f64.powi(j as i32) * ((7 * n + 3 * i + 5 * j) as f64).cos() };
    (0..2).map(|n| Linearised::only(DMatrix::from_fn(count + 1, count + 1, |i, j| entry(n, i, j)))).collect()
}

/// Two runs and three priors: `(Σ RᵀR + Σ e eᵀ/s²) step = Σ Rᵀr + Σ e off/s²`, the inverse of that matrix, and the condition number
/// from its eigenvalues with a diagonal of ones. Rounding 1e-16 times a condition of order 100.
#[test]
fn exact_least_squares_are_the_normal_equations() {
    let (linear, mut unknowns) = (runs(3), free(3));
    // Off by 1.7, -0.45 and -0.5.
    unknowns.know(1, 1.3, 0.6);
    unknowns.know(2, -1.55, 0.35);
    unknowns.know(1, -0.9, 0.8);
    let (mut information, mut right) = (DMatrix::zeros(3, 3), DVector::zeros(3));
    for l in &linear {
        let (r, b) = (l.information.columns(0, 3), l.information.column(3));
        information += r.transpose() * r;
        right += r.transpose() * b;
    }
    for (column, off, std) in [(1, 1.7, 0.6), (2, -0.45, 0.35), (1, -0.5, 0.8)] {
        information[(column, column)] += 1.0 / (std * std);
        right[column] += off / (std * std);
    }
    let scaled = DMatrix::from_fn(3, 3, |i, j| information[(i, j)] / (information[(i, i)] * information[(j, j)]).sqrt());
    let eigenvalues = scaled.symmetric_eigenvalues();
    let covariance = information.try_inverse().expect("definite");
    let normal = Normal::new(&linear, &unknowns).expect("determined");
    assert!((&normal.covariance - &covariance).amax() < 1e-12 * covariance.amax(), "{} {covariance}", normal.covariance);
    let step = &covariance * right;
    assert!((&normal.step - &step).amax() < 1e-12 * step.amax(), "{} {step}", normal.step);
    let condition = (eigenvalues.max() / eigenvalues.min()).sqrt();
    assert!((normal.condition / condition - 1.0).abs() < 1e-10, "{} {condition}", normal.condition);
    let in_errors = (0..3).map(|i| (step[i] / covariance[(i, i)].sqrt()).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    assert!((normal.largest_step() / in_errors - 1.0).abs() < 1e-12, "{} {in_errors}", normal.largest_step());
}

/// Columns `(1, ε)` and `(1, -ε)` have singular values √2 and √2 ε: undetermined below a ratio of 1e-10, on either side by a half;
/// which of a column's unit does not matter. A column of zeros is named at once.
#[test]
fn exact_rank_is_by_the_ratio_of_singular_values() {
    let of = |e: f64| vec![Linearised::only(DMatrix::from_row_slice(3, 3, &[1.0, 7.0, 0.1, e, -7.0 * e, 0.2, 0.0, 0.0, 0.0]))];
    let normal = Normal::new(&of(1.5e-10), &free(2)).expect("determined");
    assert!((normal.condition * 1.5e-10 - 1.0).abs() < 1e-4, "{}", normal.condition);
    assert_eq!(Normal::new(&of(0.7e-10), &free(2)).err().map(|(_, rank)| rank), Some(1));
    let mut nothing = runs(3);
    nothing.iter_mut().for_each(|l| l.information.column_mut(1).fill(0.0));
    assert_eq!(Normal::new(&nothing, &free(3)).err(), Some((1, 2)));
}

fn step(x: &[f64]) -> Normal {
    // Standard errors of 2, 0.5 and 4: steps are measured in them.
    let std = DVector::from_row_slice(&[2.0, 0.5, 4.0]);
    Normal {
        step: DVector::from_row_slice(x).component_mul(&std),
        covariance: DMatrix::from_diagonal(&std.component_mul(&std)),
        condition: 1.0,
    }
}

/// Where whole steps shrink by a ratio ρ, a part p of one leaves `(1 - p) + p ρ` of it for the next, and all that is left is as long
/// as `1/(1 - ρ)` of them; from a quarter to ten. Steps at more than acos 0.9 to each other tell nothing.
#[test]
fn exact_pace_is_the_sum_of_a_geometric_series() {
    let first = [3.0, -1.2, 0.7];
    let length = |part: f64, ratio: f64, turn: [f64; 3]| {
        let mut pace = Pace::default();
        assert!((pace.next(&step(&first)) - 1.0).abs() < 1e-15, "nothing known: Gauss-Newton's own");
        pace.took(part);
        let left = 1.0 - part + part * ratio;
        pace.next(&step(&std::array::from_fn::<f64, 3, _>(|k| left * first[k] + turn[k])))
    };
    for (part, ratio, expected) in [
        (1.0, 0.6, 2.5),
        (0.7, 0.6, 2.5),
        (1.6, 0.3, 1.0 / 0.7),
        (1.6, -0.8, 1.0 / 1.8),
        (0.4, 0.99, 10.0),
        (0.4, 1.3, 10.0),
        (1.0, -9.0, 0.25),
    ] {
        let found = length(part, ratio, [0.0; 3]);
        assert!((found / expected - 1.0).abs() < 1e-12, "{part} {ratio}: {found} {expected}");
    }
    // Across a last step of length 3.306, whose 0.6 is 1.983: a cosine of 0.9 at 0.961 across.
    let across = |size: f64| [0.7 * size / 3.080_584_36, 0.0, -3.0 * size / 3.080_584_36];
    let (near, far) = (length(1.0, 0.6, across(0.93)), length(1.0, 0.6, across(0.99)));
    assert!((near - 2.5).abs() < 1e-6 && (far - 1.0).abs() < 1e-15, "{near} {far}");
}
