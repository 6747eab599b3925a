//! discover tests: the initial state that flies nearest, against falls with drag in closed form.

use super::super::tests::{GRAVITY_M_S2, ball, brick, close, fall, thrown, times, unturned, wiggle};
use super::*;
use windfall_model::PointRecord;

/// A fall with drag and a sideways place, with what no initial state makes.
fn falling(cd: f64, v0: f64, t_s: &[f64], errors: f64) -> PointRecord {
    let down: Vec<f64> = t_s.iter().zip(wiggle(t_s, errors, 0.3, true)).map(|(t, e)| 5.0 + fall(cd, v0, *t)[0] + e).collect();
    PointRecord { t_s: t_s.to_vec(), position_m: [Some(down), None, Some(vec![-2.0; t_s.len()])], ..PointRecord::default() }
}

/// The same with an accelerometer.
fn felt(cd: f64, v0: f64, t_s: &[f64]) -> PointRecord {
    let force = Some(t_s.iter().map(|t| fall(cd, v0, *t)[2] - GRAVITY_M_S2 + 0.3).collect());
    PointRecord { measured: Measured::PositionAndForce, specific_force_m_s2: [force, None, None], ..falling(cd, v0, t_s, 0.0) }
}

/// Slope by the speed at the start, of fourth order.
fn slope(f: impl Fn(f64) -> f64, v0: f64) -> f64 {
    let h = 1e-3;
    (8.0 * (f(v0 + h) - f(v0 - h)) - f(v0 + 2.0 * h) + f(v0 - 2.0 * h)) / (12.0 * h)
}

/// A parabola is its own guess, in metres whatever residuals are in units of.
#[test]
fn exact_guess_of_a_parabola() {
    let t_s = times(7, 0.0, 1.3);
    let force = Some(wiggle(&t_s, 0.1, 0.0, false));
    let record = PointRecord {
        measured: Measured::PositionAndForce,
        specific_force_m_s2: [force, None, None],
        ..thrown(&t_s, &[0, 2], [3.0, 0.0, -2.0], [-4.0, 0.0, 5.0])
    };
    let track = Track::new(&record, &[], 0, &ball(0.0), false).expect("flies");
    let guess = track.guess().expect("samples");
    [3.0, -2.0, -4.0 * 1.3, 5.0 * 1.3, 0.0].iter().zip(guess.iter()).for_each(|(a, b)| close(*a, *b, 1e-11));
    assert_eq!(guess.len(), 5);
}

/// Slopes by the place, the speed times the duration and the offset, against differences of the closed form; a step of 1e-4 leaves
/// 1e-8 of curvature, the integrator 1e-7. A fall of 3 km has steps of 3 mm, and the integrator's error of 1e-8 m leaves 1e-5.
#[test]
fn order_two_slopes_by_the_initial_state() {
    for (cd, v0, end_s, by) in [(30.0, 1.1, 0.8, 1e-6), (0.02, 40.0, 30.0, 2e-5)] {
        let t_s = times(9, 0.0, end_s);
        let mut plant = ball(cd);
        plant.sensors.length_scale = 0.03;
        let (plain, both) = (falling(cd, v0, &t_s, 0.0), felt(cd, v0, &t_s));
        for record in [plain, both] {
            let track = Track::new(&record, &[], 0, &plant, false).expect("flies");
            let (m, n) = (track.axes.len(), 9);
            let mut theta = DVector::zeros(2 + m);
            (theta[0], theta[1], theta[2]) = (5.0, -2.0, v0 * end_s);
            let (flown, jacobian) = track.linearised(&track.own(&plant), &theta).expect("flies");
            assert_eq!(jacobian.shape(), (n * m, 2 + m));
            for (i, t) in t_s.iter().enumerate() {
                close(flown[i] * track.scales[0], 1.03 * (5.0 + fall(cd, v0, *t)[0]), 1e-7);
                let [depth, speed] = [0, 2].map(|k| slope(|v| fall(cd, v, *t)[k], v0) / end_s);
                let mut expected = vec![1.03, 0.0, 1.03 * depth, 0.0, 0.0];
                expected.truncate(2 + m);
                (0..2 + m).filter(|k| *k != 3).for_each(|k| close(jacobian[(i, k)] * track.scales[0], expected[k], by));
                if m == 3 {
                    let of_force = [0.0, 0.0, speed, 0.0, 1.0];
                    (0..5).filter(|k| *k != 3).for_each(|k| close(jacobian[(18 + i, k)] * 0.2, of_force[k], by));
                }
            }
        }
    }
}

/// Steps and tolerances grow with the track. Of a size of 10⁴ units differences in a vacuum are over a step of one, and right to
/// rounding; of 10⁹ a start is looked for until a step is below a hundredth, and not as far as round-off.
#[test]
fn exact_steps_and_tolerances_are_of_a_tracks_size() {
    let t_s = times(9, 0.0, 1.3);
    let mut track = Track::new(&felt(0.02, 1.1, &t_s), &[], 0, &ball(0.0), false).expect("flies");
    track.size = 1e4;
    let (_, jacobian) = track.linearised(&track.own(&ball(0.0)), &track.start).expect("flies");
    for (i, t) in t_s.iter().enumerate() {
        let expected = [(0, 1.0), (1, 0.0), (2, t / 1.3), (4, 0.0)];
        expected.into_iter().for_each(|(k, slope)| close(jacobian[(i, k)], slope / 0.5, 1e-11));
        close(jacobian[(18 + i, 4)], 1.0 / 0.2, 1e-11);
    }
    let mut track = Track::new(&falling(30.0, 2.3, &t_s, 0.02), &[], 0, &ball(30.0), false).expect("flies");
    track.size = 1e9;
    let (_, e) = track.estimated(&ball(15.0)).expect("settles");
    let along = track.state_basis.tr_mul(&e).amax();
    assert!((1e-9..1e-2).contains(&along), "{along}");
}

/// Least squares over metres of a noisy fall: the residual is measured less the closed form, and at right angles to its slopes.
#[test]
fn law_least_squares_leaves_nothing_along_the_state() {
    let (cd, t_s) = (30.0, times(9, 0.0, 0.8));
    let track = Track::new(&falling(cd, 1.1, &t_s, 0.02), &[], 0, &ball(cd), false).expect("flies");
    let (theta, e) = track.least_squares(&track.own(&ball(cd)), track.guess().expect("samples")).expect("flies");
    let (place, v0) = (theta[0], theta[2] / 0.8);
    let at = |i: usize, v: f64| place + fall(cd, v, t_s[i])[0];
    (0..9).for_each(|i| close(e[i], track.measured[i] - at(i, v0), 1e-10));
    close(e.rows(0, 9).sum(), 0.0, 1e-9);
    let along: f64 = (0..9).map(|i| e[i] * slope(|v| at(i, v), v0)).sum();
    // The residual of 0.02 times the slopes' error.
    close(along, 0.0, 1e-8);
    assert!(e.rows(0, 9).amax() > 5e-3);
}

/// Under a plant with another drag: the residual is measured less the closed form, and at right angles to the state's columns under
/// the first one; by Broyden's method, by Newton's, and of a fall of kilometres, whose places have round-off of 1e-12 m.
#[test]
fn law_estimated_state_leaves_nothing_in_the_basis() {
    for (cd, other, v0, end_s, by) in [(30.0, 15.0, 2.3, 0.8, 1e-10), (0.02, 0.022, 40.0, 30.0, 1e-7)] {
        let t_s = times(9, 0.0, end_s);
        let track = Track::new(&falling(cd, v0, &t_s, 0.02), &[], 0, &ball(cd), false).expect("flies");
        let newton = track.estimated_by_newton(&track.own(&ball(other)));
        for found in [track.estimated(&ball(other)), newton] {
            let (theta, e) = found.expect("settles");
            for (i, t) in t_s.iter().enumerate() {
                close(e[i], track.measured[i] - theta[0] - fall(other, theta[2] / end_s, *t)[0], by);
            }
            close(track.state_basis.tr_mul(&e).amax(), 0.0, by);
        }
    }
}

/// The start of a rigid body that air damps is the record's own, here exact: nothing is left of a parabola without a turn.
#[test]
fn exact_residual_from_the_records_own_start() {
    let t_s = times(12, 0.0, 1.3);
    let record = unturned(&t_s);
    let mut plant = brick();
    plant.free_flight.as_mut().expect("rigid").rate_damping_n_m_s = [-0.5; 3];
    let track = Track::new(&record, &[], 0, &plant, true).expect("flies");
    assert!(track.given);
    let (theta, e) = track.estimated(&plant).expect("flies");
    close((theta - &track.start).amax(), 0.0, 0.0);
    close(e.amax(), 0.0, 1e-9);
}

/// The secant condition, and no change across: of a vector that the row `stepᵀ·inverse` does not see.
#[test]
fn exact_broyden_takes_the_change_to_the_step() {
    let before = DMatrix::from_fn(4, 4, |i, j| if i == j { 1.3 } else { 0.2 * ((i * 3 + j * 2) as f64).sin() });
    let [step, y] = [0.4, 1.9].map(|phase| DVector::from_fn(4, |i, _| (phase + 1.7 * i as f64).cos()));
    let mut after = before.clone();
    improve(&mut after, &step, &y);
    close((&after * &y - &step).amax(), 0.0, 1e-13);
    let row = before.tr_mul(&step);
    let other = DVector::from_fn(4, |i, _| (2.9 + 0.8 * i as f64).sin());
    let across = &other - &row * (row.dot(&other) / row.norm_squared());
    close(((&after - &before) * across).amax(), 0.0, 1e-13);
    assert!((after - before).amax() > 0.1);
}

/// Both sides of every threshold, of a track of 400 units and a noise of 0.03.
#[test]
fn exact_end_of_a_search() {
    let mut track = Track::new(&thrown(&times(7, 0.0, 1.3), &[0], [0.0; 3], [1.0; 3]), &[], 0, &ball(0.0), false).expect("flies");
    (track.size, track.std) = (4.0, 0.03);
    let all = [
        (3.9e-9, 1.0, true),
        (4.1e-9, 1.0, false),
        (2.9e-6, 5.7e-6, true),
        (3.1e-6, 3.1e-6, false),
        (2.9e-6, 5.9e-6, false),
        (2.9e-6, f64::INFINITY, false),
    ];
    all.into_iter().for_each(|(size, last, done)| assert_eq!(track.is_last(size, last), done, "{size} after {last}"));
}
