//! pid tests: rows of a regression against the model's own terms, and their fade by hand.

use super::*;
use windfall_model::frames::Vec3;
use windfall_model::{FlowState, Structure};

/// Rows in crooked flows, their coefficients left at zero.
pub(crate) fn run(n: usize) -> RunRows {
    let row = |i: usize| {
        let t = 0.37 * i as f64;
        let v = Vec3::new(7.0 + t.sin(), 2.0 * (1.3 * t).cos(), -1.5 * (0.8 * t).sin());
        let rate = Vec3::new(t.cos(), -2.6 * (1.3 * t).sin(), -1.2 * (0.8 * t).cos());
        let turning = Vec3::new(0.4 - 0.3 * t.sin(), (1.1 * t).sin(), 0.9 * (0.7 * t).cos());
        CoefficientRow {
            t_s: 0.013 * i as f64,
            flow: FlowState::new(v, rate, turning, 0.21),
            exp_cm: [0.0; 6],
            exp_origin: [0.0; 6],
            q_pa: 30.0,
        }
    };
    RunRows {
        name: String::new(),
        kind: String::new(),
        rows: (0..n).map(row).collect(),
        weight: (0..n).map(|i| 1.0 - 0.01 * i as f64).collect(),
        interval_s: 0.013,
        bandwidth_hz: 4.1,
    }
}

/// Two cosines for each hertz of bandwidth and second: 2 · 37 · 0.013 s · 4.1 Hz = 3.94; at least one, at most the rows.
#[test]
fn exact_number_of_cosines() {
    let of = |bandwidth_hz: f64| cosines(&RunRows { bandwidth_hz, ..run(37) });
    assert_eq!([4.1, 0.3, 90.0].map(of), [3, 1, 37]);
}

/// Faded over 3/(0.013 s · 57.7 Hz) = 4 rows at both ends: sin² x = (1 − cos 2x)/2 at eighths of the way; or over half of the rows where
/// these are fewer.
#[test]
fn exact_fade_at_both_ends() {
    let sin2 = |share: f64| (1.0 - (std::f64::consts::PI * share).cos()) / 2.0;
    for (n, bandwidth_hz, over) in [(11, 3.0 / 0.052, 4.0), (6, 1.0, 3.0)] {
        let run = RunRows { bandwidth_hz, ..run(n) };
        for (i, found) in faded(&run).into_iter().enumerate() {
            let from_end = i.min(n - 1 - i) as f64 + 0.5;
            let expected = run.weight[i] * if from_end < over { sin2(from_end / over) } else { 1.0 };
            assert!((found - expected).abs() < 1e-14, "{n} {i}: {found} {expected}");
        }
    }
}

/// A term over a run is its value at every row; sums are sums.
#[test]
fn exact_terms_at_every_row() {
    let run = run(9);
    let flow = FlowSeries::new(&run);
    let power = |n: u8| Factor::Power(Variable::SinAlphaT, n);
    let terms = [
        Term::new(-1.7, &[power(1), Factor::Power(Variable::PitchRate, 2)]),
        Term::new(0.6, &[power(3), Factor::CosClock(3)]),
        Term::new(2.3, &[power(5), Factor::Bump(Variable::AlphaT, 0.3), Factor::Power(Variable::YawDamping, 1)]),
    ];
    let sums = flow.sum([2.1, -0.4, 0.9].into_iter().zip(&terms));
    for (row, sum) in run.rows.iter().zip(sums) {
        let [a, b, c] = [0, 1, 2].map(|k| terms[k].value(&row.flow));
        assert!((sum - (2.1 * a - 0.4 * b + 0.9 * c)).abs() < 1e-14);
    }
}

/// Of coefficients that a plant makes itself, what it holds and what effects add are taken off: left is what the declared
/// parameters give, regressors times values.
#[test]
fn exact_response_is_what_the_declared_parameters_give() {
    let values = vec![6.6, 1.7, 2.9, -0.3, 0.2, -1.4, 0.8, -3.1, 2.2, 1.1];
    let mut aero = Aero::new(Structure::axisymmetric(), values);
    aero.values.resize(aero.structure.parameters.len(), 0.7);
    aero.add(Coefficient::CN, -0.8, 1.3, &[Factor::Power(Variable::Speed, 1)]);
    aero.add(Coefficient::CA, 0.3, -1.1, &[]);
    let mut run = run(9);
    for row in &mut run.rows {
        row.exp_origin = aero.coefficients(&row.flow);
    }
    let flow = FlowSeries::new(&run);
    let declared: Vec<bool> = (0..aero.values.len()).map(|i| i % 3 != 1).collect();
    let parameters: Vec<usize> = (0..aero.values.len()).filter(|i| declared[*i]).collect();
    for coefficient in Coefficient::ALL {
        let s = series(&parameters, &flow, &aero, &declared, coefficient);
        for (i, response) in s.response.iter().enumerate() {
            let given: f64 = parameters.iter().zip(&s.regressors).map(|(p, x)| aero.values[*p] * x[i]).sum();
            assert!((response - given).abs() < 1e-13, "{coefficient:?} {i}: {response} {given}");
        }
    }
}

/// Of two coefficients the root of the sum of squares, row by row (eqs 4.2, 4.5): 3, 4 and 5, 12 make 5 and 13. One alone keeps its sign.
#[test]
fn exact_root_of_the_sum_of_squares() {
    let one = RegressionSeries {
        regressors: vec![vec![3.0, -5.0], vec![0.9, 0.0]],
        response: vec![-8.0, 7.0],
        ..RegressionSeries::default()
    };
    let other = RegressionSeries {
        regressors: vec![vec![-4.0, 12.0], vec![-1.2, -0.3]],
        response: vec![15.0, 24.0],
        ..RegressionSeries::default()
    };
    assert_eq!(total(std::slice::from_ref(&one)), one);
    let both = total(&[one, other]);
    let found = [&both.regressors[0], &both.regressors[1], &both.response];
    for (found, expected) in found.into_iter().zip([[5.0, 13.0], [1.5, 0.3], [17.0, 25.0]]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
    }
}
