//! replay tests: the least squares of an initial state, step by step.

use super::super::tests::flown;
use super::*;

/// A release moved by twelve numbers, without a turn: sums.
#[test]
fn exact_moved_release() {
    let r = Release {
        position_m: [1.0, -2.0, 3.0],
        velocity_m_s: [0.5, 0.25, -4.0],
        attitude_rad: [0.2, 0.1, -0.3],
        rates_rad_s: [7.0, -6.0, 5.0],
    };
    let m = moved(r, &[0.5, 1.5, -1.0, 2.0, -0.75, 1.0, 0.0, 0.0, 0.0, -3.0, 2.0, 0.5]);
    assert_eq!([m.position_m, m.velocity_m_s, m.rates_rad_s], [[1.5, -0.5, 2.0], [2.5, -0.5, -3.0], [4.0, -4.0, 5.5]]);
}

/// A model with thrice the drag does not follow the run beyond the shortest span, a quarter of a second: 38 samples at 150 Hz.
#[test]
fn exact_span_of_a_wrong_model() {
    let (mut plant, record) = flown(0.6, true);
    plant.aero.values[0] *= 3.0;
    let found = estimate_initial(&record, &plant).expect("estimates");
    assert!((found.span_s - 37.0 / 150.0).abs() < 1e-12 && found.misfit > LIKE_NOISE, "{found:?}");
}

/// From a release 6 rad/s and a metre a second off: the step goes as far as it is trusted and no further, gains what it says, and is then trusted
/// more. Recorded angles that are whole turns off make no difference.
#[test]
fn law_first_step_from_far_off() {
    let (plant, mut record) = flown(0.3, true);
    let replay = Replay::new(&record, &plant).expect("smooth");
    let far = moved(replay.first(), &[0.0, 0.2, 0.0, 1.0, -0.5, 0.0, 0.0, 0.1, 0.0, 0.3, 6.0, 1.0]);
    let problem = Problem { replay: &replay, record: &record, weights: weights(&plant.sensors), samples: 30 };
    let residual = problem.residual(far).expect("flies");
    let mut damping = 1e-6;
    let square = problem.square(far, &residual);
    let Stepped::Taken { release, residual: next, gain } = problem.step(far, &residual, &square, &mut damping) else {
        panic!("a step is taken")
    };
    let far_moved = |a: [f64; 3], b: [f64; 3], most: f64| {
        (0..3).map(|k| (a[k] - b[k]).abs() / most).max_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    let reach = far_moved(release.position_m, far.position_m, 0.3)
        .max(far_moved(release.velocity_m_s, far.velocity_m_s, 1.0))
        .max(far_moved(release.rates_rad_s, far.rates_rad_s, 1.5));
    assert!((reach - 1.0).abs() < 1e-12, "{reach}");
    assert!((gain - 1.0 + next.norm_squared() / residual.norm_squared()).abs() < 1e-12 && gain > 0.0, "{gain}");
    assert!((damping / 1e-7 - 1.0).abs() < 1e-12, "{damping}");
    record.attitude_rad[0].iter_mut().for_each(|a| *a += TAU);
    record.attitude_rad[2].iter_mut().for_each(|a| *a -= 2.0 * TAU);
    let turned = Problem { replay: &replay, record: &record, weights: weights(&plant.sensors), samples: 30 };
    let same = turned.residual(far).expect("flies");
    // Rounding of angles near 12 rad, over standard deviations of 1e-3.
    assert!((same - residual).amax() < 1e-10);
}

/// Estimated again without chance, over the same span: the same state as least squares over just these samples, of which the last one,
/// recorded a centimetre off, weighs.
#[test]
fn law_again_uses_the_same_span() {
    let (plant, mut record) = flown(0.3, true);
    record.position_m[1][29] += 0.01;
    let replay = Replay::new(&record, &plant).expect("smooth");
    let over = |samples| {
        let problem = Problem { replay: &replay, record: &record, weights: weights(&plant.sensors), samples };
        problem.solve(replay.first(), GAIN).expect("flies")
    };
    let (near, fewer) = (over(30), over(28));
    let found = again(&replay, &record, &plant.sensors, &near, [0.0; N]).expect("flies");
    let off = |a: Release, b: Release| {
        (0..3).map(|k| (a.velocity_m_s[k] - b.velocity_m_s[k]).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    assert!(off(found, near.release) < 0.01 * off(fewer.release, near.release), "{found:?} {near:?} {fewer:?}");
}

/// Of a record without noise nothing is left: smoothing of V_W leaves less than a hundredth of the noise that instruments would have.
#[test]
fn recover_the_release_of_an_exact_record() {
    let (plant, record) = flown(0.5, false);
    let found = estimate_initial(&record, &plant).expect("estimates");
    assert!(found.misfit < 1e-4 && (found.span_s - 0.5).abs() < 1e-12, "{found:?}");
}

/// Twelve equations apart, r x = rhs with x in units of its scale: half of the solution's step takes three quarters off the sum of squares,
/// and standard errors are scale over r.
#[test]
fn exact_gain_and_errors_of_equations_apart() {
    let of = |f: fn(f64) -> f64| SVector::<f64, N>::from_iterator((0..12).map(|k| f(f64::from(k))));
    let (diagonal, rhs, scale) = (of(|k| 0.5 + 0.3 * k), of(|k| 1.0 - 0.7 * k), of(|k| 0.02 + 0.01 * k));
    let square = Square { r: SMatrix::from_diagonal(&diagonal), rhs, scale };
    let half = scale.component_mul(&rhs).component_div(&diagonal) * 0.5;
    assert!((square.predicted_gain(&half) / (0.75 * rhs.norm_squared()) - 1.0).abs() < 1e-13);
    assert!((0..N).all(|k| (square.std_error()[k] * diagonal[k] / scale[k] - 1.0).abs() < 1e-13));
}
