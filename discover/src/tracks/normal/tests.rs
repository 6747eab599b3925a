//! discover tests: normal equations against dense ones.

use super::super::tests::close;
use super::*;
use windfall_model::Constant;

/// Of a number that may have any value.
const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const SIZES: [f64; 3] = [1e3, 0.7, 1e-3];

/// Nineteen rows, of which three are beyond the last whole eight; columns of sizes apart by six orders.
fn columns() -> (Residual, Vec<Residual>) {
    let at = |i: usize, k: usize| (1.3 * (i * (k + 2)) as f64 + 0.7 * (i * i) as f64 + k as f64).sin();
    let column = |(k, size): (usize, f64)| (0..19).map(|i| size * at(i, k)).collect();
    ((0..19).map(|i| 2.0 * at(i, 5)).collect(), SIZES.into_iter().enumerate().map(column).collect())
}

/// Of the rows and of one more for each number with a prior: `−J⁻¹ g` and `J⁻¹` by an LU decomposition in units of the columns'
/// sizes.
#[test]
fn exact_step_is_that_of_dense_least_squares() {
    let (z, columns) = columns();
    let constant = Constant { key: "k", component: "", unit: "-", lens: |_| None, std: 2e-3 };
    let h = TrackModel {
        declared: vec![0.37, 5.0],
        priors: vec![(1, 2.0, 0.8)],
        constants: vec![(constant, 3e-4)],
        effects: Vec::new(),
        generic: Vec::new(),
        scatter: None,
    };
    let mut normal = NormalEquations::new(&z, &columns);
    normal.add_prior(&h, &[Free::Constant(0), Free::Declared(1), Free::Declared(0)]);
    let step = normal.solve_within(&[ANY; 3], |_| false).map_err(|_| ()).expect("determined");
    assert!(step.held.is_empty());
    let prior = [[3e-4, 2e-3], [3.0, 0.8]];
    let rows = DMatrix::from_fn(21, 3, |i, k| match i {
        0..19 => columns[k][i] / SIZES[k],
        _ if i - 19 == k => 1.0 / prior[k][1] / SIZES[k],
        _ => 0.0,
    });
    let right = DVector::from_fn(21, |i, _| if i < 19 { z[i] } else { prior[i - 19][0] / prior[i - 19][1] });
    let inverse = (rows.transpose() * &rows).lu().try_inverse().expect("regular");
    let delta = -&inverse * rows.transpose() * right;
    for i in 0..3 {
        close(step.delta[i] * SIZES[i], delta[i], 1e-11);
        (0..3).for_each(|k| close(step.covariance[(i, k)] * SIZES[i] * SIZES[k], inverse[(i, k)], 1e-11));
    }
}

/// A column that is three parts of one unit column and four of another, sizes aside, and a small part of its own: determined above
/// a thousandth, and below it not, where it is itself what weighs most, then the larger part; a short column that stands apart
/// weighs nothing.
#[test]
fn exact_undetermined_is_the_number_of_the_null_direction() {
    let equations = |own: f64| {
        let unit = |k: usize, size: f64| -> Residual { (0..9).map(|i| if i == k { size } else { 0.0 }).collect() };
        let mixed = [0.6 * 500.0, 0.8 * 500.0, 0.0, own * 500.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        NormalEquations::new(&vec![1.0; 9], &[unit(0, 7.0), unit(1, 0.02), unit(2, 1e-4), mixed.to_vec()])
    };
    assert!(equations(1.2e-3).solve().is_some() && equations(0.8e-3).solve().is_none());
    let singular = equations(0.8e-3);
    assert_eq!(singular.undetermined(|_| true), Some(3));
    assert_eq!(singular.undetermined(|i| i != 3), Some(1));
    assert_eq!(singular.undetermined(|_| false), None);
}

/// Every end of a box about columns that are much alike: the step is as good as the best point of a fine grid, and says which numbers are
/// at an end.
#[test]
fn law_a_step_within_bounds_is_the_least_of_all_within() {
    let z: Residual = vec![1.0, -2.0, 0.5, 0.3];
    let columns = [vec![1.0, 0.9, 0.1, 0.0], vec![0.9, 1.1, 0.0, 0.2], vec![-0.5, 0.8, 1.0, 0.1]];
    let normal = NormalEquations::new(&z, &columns);
    let squares = |d: [f64; 3]| (0..4).map(|i| (z[i] + (0..3).map(|k| columns[k][i] * d[k]).sum::<f64>()).powi(2)).sum::<f64>();
    let mut free_of_all = 0;
    for low in [-0.1, -1.0, -40.0] {
        for high in [0.0, 0.4, 40.0] {
            for other in [-4.0_f64, 0.0, 40.0] {
                let bounds = [[low, high], [10.0 * other.min(0.0), high + 1.0], [low, other.max(0.0)]];
                let step = normal.solve_within(&bounds, |_| false).map_err(|_| ()).expect("determined");
                let of = |k: usize, i: usize| bounds[k][0] + (bounds[k][1] - bounds[k][0]) * i as f64 / 40.0;
                let grid = (0..41_usize.pow(3)).map(|n| squares([of(0, n % 41), of(1, n / 41 % 41), of(2, n / 1681)]));
                let found = squares([step.delta[0], step.delta[1], step.delta[2]]);
                let least = grid.fold(f64::INFINITY, f64::min);
                assert!(found <= least + 1e-12, "{bounds:?}: {found} {least}");
                for k in 0..3 {
                    assert!(step.delta[k] >= bounds[k][0] && step.delta[k] <= bounds[k][1], "{bounds:?}: {}", step.delta);
                    let at_end = bounds[k].iter().any(|end| (step.delta[k] - end).abs() < 1e-15);
                    assert_eq!(step.held.contains(&k), at_end, "{bounds:?}: {}", step.delta);
                }
                free_of_all += usize::from(step.held.is_empty());
            }
        }
    }
    assert!(free_of_all > 0);
}
