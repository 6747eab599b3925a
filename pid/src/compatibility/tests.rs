//! pid tests: errors of instruments as a quadratic likelihood, by hand.

use super::*;

/// Two errors with estimates correlated by r: alone, the first's is the regression of the other's pull on it, a known formula.
#[test]
fn exact_alone_and_left() {
    let r = 0.8;
    let joint = Joint::new(DVector::from_vec(vec![2.0, 1.0]), DMatrix::from_row_slice(2, 2, &[1.0, r, r, 1.0]));
    let (alone, variance) = joint.alone(&[0]);
    assert!((alone[0] - (2.0 - r)).abs() < 1e-12 && (variance[(0, 0)] - (1.0 - r * r)).abs() < 1e-12);
    // What is left is the other's own square: zero but for 1.0 with variance 1.
    assert!((joint.square_left(&[0]) - 1.0).abs() < 1e-12, "{}", joint.square_left(&[0]));
    assert!((joint.left(&[0, 1]) - 1.0).abs() < 1e-12);
}

/// Probability of as much by chance: e^(−x/2) of two errors, erfc √(x/2) of one.
#[test]
fn exact_probability_of_what_is_left() {
    let joint = Joint::new(DVector::from_vec(vec![2.0, 1.0]), DMatrix::from_row_slice(2, 2, &[1.0, 0.8, 0.8, 1.0]));
    assert!((joint.left(&[]) - (-2.5_f64).exp()).abs() < 1e-12, "square 1.8/0.36");
    assert!((joint.left(&[0]) - statrs::function::erf::erfc(0.5_f64.sqrt())).abs() < 1e-9);
}

/// Standard errors of 1e-6 and 1e3, correlated by 0.6: information 1/(1 − r²) of each variance's inverse, to rounding.
#[test]
fn exact_information_of_errors_decades_apart() {
    let (a, b, r) = (1e-6, 1e3, 0.6);
    let joint = Joint::new(DVector::from_vec(vec![a, b]), DMatrix::from_row_slice(2, 2, &[a * a, r * a * b, r * a * b, b * b]));
    let expected = [1.0 / (a * a), -r / (a * b), -r / (a * b), 1.0 / (b * b)].map(|x| x / (1.0 - r * r));
    for (found, expected) in joint.information.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// A wind's delay known to 0.7 s of at most 2 s, a scale to 0.1 of at most 0.3: 1.96 σ over each, 0.69 and 0.65. Near is a step of three
/// standard errors.
#[test]
fn exact_what_is_told_worst_and_what_is_far() {
    let covariance = DMatrix::from_row_slice(2, 2, &[0.49, 0.02, 0.02, 0.01]);
    let (ratio, column) = worst(&[(0, 1), (1, 0)], &covariance).expect("two");
    assert!(column == 0 && (ratio - 1.959_963_985 * 0.7 / 2.0).abs() < 1e-12, "{ratio}");
    assert_eq!(worst(&[], &covariance), None);
    for (second, far) in [(0.29, false), (-0.31, true)] {
        assert_eq!(is_far(&DVector::from_vec(vec![2.0, second]), &covariance), far);
    }
}

/// Two errors beside two parameters, each correlated with one of these, not with each other. At 2.5 and 0.3 standard errors nothing is
/// inconsistent at half of one per cent: e^(−3.2) = 0.04. At 3.6 it is, 0.0015, and the first accounts for it; the second does not.
#[test]
fn exact_account_and_correlations() {
    let std = [0.3, 5.0, 0.02, 0.7];
    let mut covariance = DMatrix::from_fn(4, 4, |i, j| if i == j { std[i] * std[i] } else { 0.0 });
    for (i, j, r) in [(0, 2, 0.93), (1, 3, -0.95)] {
        covariance[(i, j)] = r * std[i] * std[j];
        covariance[(j, i)] = covariance[(i, j)];
    }
    let names = ["first", "second", "delay", "turned"].map(str::to_owned);
    let of = |large: f64| {
        let values = [large * std[2], 0.3 * std[3]];
        judged(&[(1, 2), (4, 3)], &values, &covariance, &names, Vec::new(), Vec::new())
    };
    let found = of(2.5);
    assert!((found.p_value - (-0.5_f64 * (2.5 * 2.5 + 0.09)).exp()).abs() < 1e-12);
    assert!(found.account.is_empty() && (found.account_p_value - found.p_value).abs() < 1e-15);
    let [a, b] = &found.correlations[..] else { panic!("{:?}", found.correlations) };
    assert_eq!([&a.first, &a.second, &b.first, &b.second], [&names[1], &names[3], &names[0], &names[2]]);
    assert!((a.correlation + 0.95).abs() < 1e-14 && (b.correlation - 0.93).abs() < 1e-14);
    let found = of(3.6);
    let [account] = &found.account[..] else { panic!("{found:?}") };
    assert!(account.name == KINDS[1].0 && (account.estimate - 3.6 * std[2]).abs() < 1e-14, "{account:?}");
    assert!((account.std_error - std[2]).abs() < 1e-14 && found.rivals.is_empty());
    assert!((found.account_p_value - statrs::function::erf::erfc(0.3 * 0.5_f64.sqrt())).abs() < 1e-9);
}

/// Half of one per cent for each test: of dynamic pressure, of trajectories whose residual is noise.
#[test]
fn exact_verdict_on_both_sides_of_the_level() {
    let covariance = DMatrix::from_element(1, 1, 1.0);
    let of = |p_value: f64, residual: &[&str]| {
        let residual = residual.iter().map(|s| (*s).to_owned()).collect();
        Instruments { p_value, ..judged(&[(0, 0)], &[0.0], &covariance, &[], Vec::new(), residual) }
    };
    let pressure = |p_value: f64| Pressure {
        computed_from_speed: false,
        speed_scale: 1.0,
        speed_scale_ci95: [1.0; 2],
        pressure_scale: 1.0,
        pressure_scale_ci95: [1.0; 2],
        delay_s: None,
        delay_ci95_s: None,
        p_value,
        whiteness_p: 1.0,
    };
    let verdict = |p: Option<f64>, i: Option<Instruments>| join(p.map(pressure), i.ok_or(NotExamined::NoAnswer)).verdict;
    assert_eq!([0.0049, 0.0051].map(|p| verdict(None, Some(of(p, &[])))), [Agreement::Inconsistent, Agreement::Consistent]);
    assert_eq!([0.0049, 0.0051].map(|p| verdict(Some(p), Some(of(0.5, &[])))), [Agreement::Inconsistent, Agreement::Consistent]);
    assert_eq!(verdict(Some(0.0051), Some(of(0.0, &["z_m"]))), Agreement::Undecided);
    assert_eq!(verdict(Some(0.0049), None), Agreement::Inconsistent);
}
