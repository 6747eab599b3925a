//! verify tests: what the loop compares, by hand.

use super::*;
use crate::tests::scenarios;
use windfall_pid::Estimate;

/// Estimates with these 95 % intervals.
fn set(intervals: &[(&str, [f64; 2])]) -> DataSet {
    let one = |&(name, ci95): &(&str, [f64; 2])| Estimate {
        coefficient: String::new(),
        name: name.to_owned(),
        estimate: 0.0,
        std_error: 0.0,
        rse_percent: None,
        ci95,
        std_error_white: 0.0,
    };
    DataSet {
        refused: Vec::new(),
        envelope: None,
        name: "combined".to_owned(),
        runs: Vec::new(),
        parameters: intervals.iter().map(one).collect(),
        fits: Vec::new(),
        condition_number: 1.0,
        n_samples: 0,
        covariance: Vec::new(),
        curves: Vec::new(),
        held: Vec::new(),
        constants: Vec::new(),
        effects: Vec::new(),
    }
}

/// Plants whose parameters differ by known amounts, in units of half of their intervals: C_A by one number, so that its cosine falls out;
/// `(a s + b s³)/(c s + d s³)` of the others, largest at the one end or at the other.
#[test]
fn exact_static_curves() {
    let [appendix_c, ..] = scenarios();
    let truth = appendix_c.plant;
    let mut found = truth.clone();
    for (name, by) in [("CA_T0", -0.03), ("CN_sin", 0.02), ("CN_sin3", 0.5), ("Cm_sin", -0.04), ("Cm_sin3", 0.1)] {
        let i = found.aero.structure.index(name).expect("there");
        found.aero.values[i] += by;
    }
    let set = set(&[
        ("CA_T0", [6.6, 6.72]),
        ("CN_sin", [3.4, 3.5]),
        ("CN_sin3", [-2.5, -1.9]),
        ("Cm_sin", [-2.1, -2.0]),
        ("Cm_sin", [-2.3, -2.0]),
        ("Cm_sin3", [2.4, 2.7]),
    ]);
    let checks = static_curves(&truth, &found, &set);
    let s2 = |degrees: f64| degrees.to_radians().sin().powi(2);
    let expected = [0.5, (0.02 + 0.5 * s2(25.0)) / (0.05 + 0.3 * s2(25.0)), (0.04 - 0.1 * s2(1.0)) / (0.05 + 0.15 * s2(1.0))];
    for (check, expected) in checks.iter().zip(expected) {
        assert!((check.figure - expected).abs() < 1e-12, "{}: {} {expected}", check.id, check.figure);
    }
    assert_eq!(checks.len(), 3);
}

/// Rows that lie beside a plant's coefficients by known amounts: their root mean square over rows and members; and, of two plants, the
/// ratio of theirs.
#[test]
fn exact_residuals() {
    let [appendix_c, ..] = scenarios();
    let (plant, flight) = (&appendix_c.plant, &appendix_c.flights[0]);
    let flight = Flight { duration_s: 1.0, ..flight.clone() };
    let record = fly(plant, &flight, Seed::default()).expect("flies").record;
    let smoother = Method::EquationError.smoother();
    let mut rows = process("one", "k", &record, plant, &smoother).expect("smooth").rows;
    rows.truncate(2);
    for (row, off) in rows.iter_mut().zip([[0.3, -0.5], [0.1, 0.7]]) {
        row.exp_origin = plant.aero.coefficients(&row.flow);
        row.exp_origin[1] += off[0];
        row.exp_origin[4] += off[1];
    }
    let expected = f64::sqrt((0.09 + 0.25 + 0.01 + 0.49) / 4.0);
    assert!((residual_std(&rows, plant, &[1, 4]) - expected).abs() < 1e-14);

    let campaign = campaign_of(plant, &[(&flight, record)]);
    let mut other = plant.clone();
    other.aero.values.iter_mut().for_each(|x| *x *= 1.1);
    let of = |found: &Plant| prediction(&campaign, plant, found, &[0]).expect("smooth");
    let own = |c: &Check| -> f64 {
        c.what.split_once("residual std ").and_then(|(_, w)| w.split(',').next()?.parse().ok()).expect("a number")
    };
    for (a, b) in of(&other).iter().zip(&of(plant)) {
        assert!((b.figure - 1.0).abs() < 1e-15 && a.figure > 2.0, "{}", a.figure);
        // Words have four digits.
        assert!((a.figure * own(b) / own(a) - 1.0).abs() < 2e-3, "{}: {} {}", a.id, own(a), own(b));
    }
}

/// Ratio to the test within 1 % and four relative deviations; noise of three angles and three axes, and the drift by an error of C_A.
#[test]
fn exact_bounds() {
    let line = |simulation_std| Statistic {
        quantity: String::new(),
        statistic: String::new(),
        test: 2.5,
        simulation: 2.2,
        simulation_std,
        draws_ci95: None,
    };
    let (ratio, bound) = simulated_over_test(&line(Some(0.055)));
    assert!((ratio - 0.88).abs() < 1e-15);
    let ends = [bound.at_least, bound.at_most].map(|x| x.expect("both"));
    assert!((ends[0] - 0.89).abs() < 1e-14 && (ends[1] - 1.11).abs() < 1e-14, "{ends:?}");

    let [appendix_c, ..] = scenarios();
    let (roll_std_rad, pitch_yaw_std_rad) = (0.7_f64.to_radians(), 0.6_f64.to_radians());
    let sensors = Sensors { roll_std_rad, pitch_yaw_std_rad, position_std_m: 0.02, ..appendix_c.plant.sensors };
    let [attitude_deg, position_m] = allowed(&sensors, [0.0195, -6.5], 12.0);
    assert!((attitude_deg - 1.2 * 1.1).abs() < 1e-14, "{attitude_deg}");
    let drift = 0.003 / 2.0 * 7.43 * 12.0;
    assert!((position_m - f64::sqrt(3.0 * 0.0004 + drift * drift)).abs() < 1e-15, "{position_m}");
}
