//! pid tests: a shape sought among linear terms, on problems with a known answer.

use super::*;

/// Exact data: a line plus a bump of known width; both searches find it, Gauss-Newton to rounding, the simplex to its last size
/// (a thousandth of the range in ln θ).
#[test]
fn exact_planted_width() {
    let n = 400;
    let t = |i: usize| (i as f64 / n as f64 - 0.5) * 2.0;
    let linear = DMatrix::from_fn(n, 2, |i, j| t(i).powi(j as i32));
    let bump = |w: f64| DVector::from_fn(n, |i, _| (t(i) / w).cosh().powi(-2));
    let slope = |w: f64| DVector::from_fn(n, |i, _| 2.0 * t(i) / (w * w) * (t(i) / w).tanh() * (t(i) / w).cosh().powi(-2));
    let response = &linear * DVector::from_vec(vec![0.3, -2.0]) + bump(0.17) * 1.5;
    let column = |w: f64| Some([bump(w), slope(w)]);
    let problem = Shaped { linear: &linear, response: &response, column: &column, range: [0.02, 1.0] };
    for (search, tolerance) in [(ShapeSearch::GaussNewton, 1e-9), (ShapeSearch::Simplex, 4e-3)] {
        let found = problem.fit(search).expect("fits");
        assert!(found.inside && (found.shape / 0.17 - 1.0).abs() < tolerance, "{search:?}: {found:?}");
        assert!((found.estimate[2] - 1.5).abs() < 10.0 * tolerance, "{search:?}: {found:?}");
    }
}

/// Errors are those of the curvature: the width's own from the slope orthogonal to all columns.
#[test]
fn exact_standard_error_of_one_shape() {
    let n = 50;
    let linear = DMatrix::zeros(n, 0);
    let x = DVector::from_fn(n, |i, _| i as f64 / n as f64);
    let column = |k: f64| Some([x.map(|v| (-k * v).exp()), x.map(|v| -v * (-k * v).exp())]);
    let noise = DVector::from_fn(n, |i, _| if i % 2 == 0 { 0.01 } else { -0.01 });
    let response = x.map(|v| 2.0 * (-3.0 * v).exp()) + noise;
    let found =
        Shaped { linear: &linear, response: &response, column: &column, range: [0.1, 10.0] }.fit(ShapeSearch::GaussNewton);
    let found = found.expect("fits");
    let (k, b) = (found.shape, found.estimate[0]);
    let (f, s) = (x.map(|v| (-k * v).exp()), x.map(|v| -v * b * (-k * v).exp()));
    let own = s.norm_squared() - s.dot(&f).powi(2) / f.norm_squared();
    let expected = (found.rss / (n - 2) as f64 / own).sqrt();
    assert!((found.shape_std_error / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
}

#[test]
fn exact_starts_in_the_middle_of_equal_parts() {
    for (found, expected) in starts([-3.0, 6.0]).into_iter().zip([-2.25, -0.75, 0.75, 2.25, 3.75, 5.25]) {
        assert!((found - expected).abs() < 1e-15);
    }
}

/// One decay, exact data. From one that is too slow the whole step leads too far, where more is left: halved, each search ends at the
/// planted one, and soon.
#[test]
fn recover_a_decay_from_where_whole_steps_overshoot() {
    let linear = DMatrix::zeros(50, 0);
    let x = DVector::from_fn(50, |i, _| i as f64 / 50.0);
    let calls = std::cell::Cell::new(0);
    let column = |k: f64| {
        calls.set(calls.get() + 1);
        Some([x.map(|v| (-k * v).exp()), x.map(|v| -v * (-k * v).exp())])
    };
    let response = x.map(|v| 2.0 * (-3.0 * v).exp());
    let problem = Shaped { linear: &linear, response: &response, column: &column, range: [1e-3, 1e3] };
    let range = problem.range.map(f64::ln);
    let mut overshot = 0;
    for start in [0.3_f64, 1.0, 8.0, 15.0, 30.0] {
        let now = problem.at(start.ln().exp()).expect("a column");
        let step = now.projected.dot(&now.residual) / now.projected.norm_squared();
        let whole = problem.at((start.ln() + step).clamp(range[0], range[1]).exp()).expect("a column");
        overshot += usize::from(whole.rss >= now.rss);
        calls.set(0);
        let found = problem.descend(start.ln(), range).expect("a column");
        assert!((found.exp() / 3.0 - 1.0).abs() < 1e-9, "{start}: {}", found.exp());
        assert!(calls.get() < 12, "{start}: {} evaluations", calls.get());
    }
    assert!(overshot > 0);
}

/// A width beyond either end of the range ends there, and is not told.
#[test]
fn exact_a_shape_beyond_the_range_is_not_inside() {
    let linear = DMatrix::zeros(50, 0);
    let x = DVector::from_fn(50, |i, _| i as f64 / 50.0);
    let column = |k: f64| Some([x.map(|v| (-k * v).exp()), x.map(|v| -v * (-k * v).exp())]);
    let response = x.map(|v| 2.0 * (-3.0 * v).exp());
    for (range, inside, expected) in [([0.5, 2.0], false, 2.0), ([4.0, 9.0], false, 4.0), ([2.0, 4.0], true, 3.0)] {
        let problem = Shaped { linear: &linear, response: &response, column: &column, range };
        let found = problem.fit(ShapeSearch::GaussNewton).expect("fits");
        assert!(found.inside == inside && (found.shape / expected - 1.0).abs() < 1e-9, "{found:?}");
    }
}
