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

/// Squares of four residuals and three columns, 400 times within a box: the step is the best of those with every choice of numbers at their ends, and
/// says which are at one. Now and then a number that went out first is not at its end in the last solution.
#[test]
fn exact_step_within_bounds_is_the_best_of_all_choices_of_ends() {
    let crooked = |i: usize, k: usize| (1.3 * (i * (k + 2)) as f64 + 0.7 * (i * i) as f64 + k as f64).sin();
    let mut let_go = 0;
    for case in 0..400 {
        let number = |k: usize| crooked(case + 7 * k, k);
        let z: Residual = (0..4).map(|i| 3.0 * number(i)).collect();
        // Alike but for a part of their own.
        let columns: Vec<Residual> =
            (0..3).map(|k| (0..4).map(|i| number(i + 5) + 0.4 * number(9 + 4 * k + i)).collect()).collect();
        let bounds: [[f64; 2]; 3] = std::array::from_fn(|k| [-0.05 - number(30 + k).abs(), 0.05 + number(40 + k).abs()]);
        let squares =
            |d: &[f64; 3]| (0..4).map(|i| (z[i] + (0..3).map(|k| columns[k][i] * d[k]).sum::<f64>()).powi(2)).sum::<f64>();
        let normal = NormalEquations::new(&z, &columns);
        let mut best = (f64::INFINITY, [0.0; 3], Vec::new());
        let mut first_out = None;
        for choice in 0..27 {
            let place = |k: usize| choice / 3_usize.pow(k as u32) % 3;
            let open: Vec<usize> = (0..3).filter(|k| place(*k) == 2).collect();
            let mut d: [f64; 3] = std::array::from_fn(|k| if place(k) < 2 { bounds[k][place(k)] } else { 0.0 });
            let rest = DVector::from_fn(4, |i, _| z[i] + (0..3).map(|k| columns[k][i] * d[k]).sum::<f64>());
            let own = DMatrix::from_fn(4, open.len(), |i, k| columns[open[k]][i]);
            if !open.is_empty() {
                let solved = (own.transpose() * &own).lu().solve(&(own.transpose() * -rest)).expect("regular");
                open.iter().zip(solved.iter()).for_each(|(k, x)| d[*k] = *x);
            }
            let out =
                |k: usize| (bounds[k][0] - d[k]).max(d[k] - bounds[k][1]) * columns[k].iter().map(|x| x * x).sum::<f64>().sqrt();
            if open.len() == 3 {
                first_out = (0..3).max_by(|i, k| out(*i).total_cmp(&out(*k))).filter(|k| out(*k) > 0.0);
            }
            if open.iter().all(|k| out(*k) <= 0.0) && squares(&d) < best.0 {
                best = (squares(&d), d, (0..3).filter(|k| place(*k) < 2).collect());
            }
        }
        let Ok(step) = normal.solve_within(&bounds, |_| false) else { panic!("{case}: determined") };
        for k in 0..3 {
            assert!((step.delta[k] - best.1[k]).abs() < 1e-9, "{case}: {} {:?}", step.delta, best.1);
        }
        assert_eq!(step.held, best.2, "{case}");
        let_go += usize::from(first_out.is_some_and(|k| !best.2.contains(&k)));
    }
    assert!(let_go > 0);
}
