//! discover tests: what a track would record against closed forms, its bases against Gram and Schmidt.

use super::super::tests::{GRAVITY_M_S2, ball, brick, close, fall, thrown, times, unturned, wiggle};
use super::*;

fn all_close(a: &[f64], b: &[f64], by: f64) {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).for_each(|(a, b)| close(*a, *b, by));
}

/// Positions along X and Y and specific forces along both.
fn mixed(t_s: &[f64]) -> PointRecord {
    let force = |k: usize| Some(wiggle(t_s, 0.1, k as f64, false));
    PointRecord {
        measured: Measured::PositionAndForce,
        specific_force_m_s2: [force(0), force(1), None],
        ..thrown(t_s, &[0, 1], [250.0, -3.0, 0.0], [7.0, 2.0, 0.0])
    }
}

/// Means and variances of groups of three of eleven samples by hand.
#[test]
fn exact_groups_are_means() {
    let t_s = times(11, 0.4, 1.7);
    let record = PointRecord { recorded_inputs: vec![(4, wiggle(&t_s, 2.0, 0.1, false))], ..mixed(&t_s) };
    let (means, scatter) = averaged(&record, 3);
    let mean = |x: &[f64]| -> Vec<f64> { (0..3).map(|k| (x[3 * k] + x[3 * k + 1] + x[3 * k + 2]) / 3.0).collect() };
    all_close(&means.t_s, &mean(&t_s), 1e-15);
    for c in [0, 1, 3, 4] {
        all_close(means.channel(c).expect("measured"), &mean(record.channel(c).expect("measured")), 1e-12);
    }
    all_close(&means.recorded_inputs[0].1, &mean(&record.recorded_inputs[0].1), 1e-15);
    // The mean of the squares less the square of the mean.
    let squares = mean(&t_s.iter().map(|t| t * t).collect::<Vec<f64>>());
    let expected: Vec<f64> = squares.iter().zip(&means.t_s).map(|(s, m)| s - m * m).collect();
    all_close(&scatter, &expected, 1e-14);
}

/// Of a parabola the mean over a group is what it is at the mean time and half the acceleration times the variance of the times:
/// 129 groups of two samples at crooked times leave nothing.
#[test]
fn exact_groups_of_a_parabola_leave_nothing() {
    let t_s: Vec<f64> = times(258, 0.4, 7.9).iter().enumerate().map(|(i, t)| t + 0.01 * (1.7 * i as f64).sin()).collect();
    let track = Track::new(&thrown(&t_s, &[0], [3.0, 0.0, 0.0], [-20.0, 0.0, 0.0]), &[], 0, &ball(0.0), false).expect("flies");
    close(track.group, 2.0, 0.0);
    assert!(track.laid.norm() < 1e-9, "{}", track.laid.norm());
}

/// A clock that is fast by 2 % and a scale that is long by 3 %: a parabola in true time and true metres, from its true place and
/// velocity times the recorded duration; along two axes of three.
#[test]
fn exact_start_of_a_throw_with_clock_and_scale() {
    let mut plant = ball(0.0);
    (plant.sensors.time_base, plant.sensors.length_scale) = (0.02, 0.03);
    let t_s = times(9, 0.0, 1.3);
    let true_s: Vec<f64> = t_s.iter().map(|t| t / 1.02).collect();
    let mut record = thrown(&true_s, &[0, 2], [3.0, 0.0, -2.0], [-4.0, 0.0, 5.0]);
    record.position_m.iter_mut().flatten().flatten().for_each(|x| *x *= 1.03);
    record.t_s = t_s.iter().map(|t| t + 40.0).collect();
    let track = Track::new(&record, &[], 0, &plant, false).expect("flies");
    all_close(&track.t_s, &t_s, 1e-14);
    all_close(track.start.as_slice(), &[3.0, -2.0, -4.0 * 1.3, 5.0 * 1.3], 1e-9);
    let (place_m, v_m_s) = track.state(&track.start);
    all_close(&place_m, &[3.0, 0.0, -2.0], 1e-9);
    all_close(&v_m_s, &[-4.0, 0.0, 5.0], 1e-9);
    assert!(track.laid.amax() < 1e-9);
    // A parabola is 100 units long or less.
    close(track.size, 1.0, 0.0);
}

/// A pressure altimeter and an accelerometer falling with drag: depth by its closed form, scale and the height of a static pressure
/// that is off by a coefficient of the dynamic one, `C_p v²/2g` with a coefficient that follows a recorded input; specific force `a
/// − g` with an offset along each axis.
#[test]
fn exact_height_and_force_of_a_fall_with_drag() {
    let (cd, v0) = (9.0, 1.7);
    let mut plant = ball(cd);
    plant.sensors.length_scale = 0.03;
    plant.point.altimeter = true;
    (plant.point.pressure_coefficient, plant.point.pressure_per_input) = (0.4, vec![0.3]);
    let t_s = times(9, 0.0, 1.3);
    let input = wiggle(&t_s, 1.0, 0.7, false);
    let record = PointRecord { recorded_inputs: vec![(0, input.clone())], ..mixed(&t_s) };
    let track = Track::new(&record, &[0.0], 0, &plant, false).expect("flies");
    let own = track.own(&plant);
    let flown = track.flown(&own, &DVector::from_vec(vec![5.0, -2.0, v0 * 1.3, 0.0, 0.11, 0.13])).expect("flies");
    for (i, t) in t_s.iter().enumerate() {
        let [depth, v, a] = fall(cd, v0, *t);
        let height = 1.03 * (5.0 + depth) + (0.4 + 0.3 * input[i]) * v * v / (2.0 * GRAVITY_M_S2);
        let expected = [height / 0.5, 1.03 * -2.0 / 0.5, (a - GRAVITY_M_S2 + 0.11) / 0.2, 0.13 / 0.2];
        (0..4).for_each(|k| close(flown[k * 9 + i], expected[k], 1e-9));
    }
    // In metres and m/s²: of positions and of forces, and channel by channel.
    let e = DVector::from_fn(36, |i, _| (i * i) as f64 + 0.3);
    let sum = |of: std::ops::Range<usize>, scale: f64| of.map(|i| (scale * e[i]).powi(2)).sum::<f64>();
    for (beside, expected) in [(false, sum(0..18, 0.5)), (true, sum(18..36, 0.2))] {
        let (squares, count) = track.squares(&e, beside);
        assert!((squares / expected - 1.0).abs() < 1e-14 && (count - 18.0).abs() < 1e-15, "{squares} {expected} {count}");
    }
    all_close(&track.channel_of(&e, 2), &(18..27).map(|i| 0.2 * e[i]).collect::<Vec<f64>>(), 1e-12);
}

/// A hundredth of the way, from where it began.
#[test]
fn exact_size_of_a_long_track() {
    let track = Track::new(&mixed(&times(7, 0.0, 12.0)), &[], 0, &ball(0.0), false).expect("flies");
    close(track.size, (7.0 * 12.0 + 0.5 * GRAVITY_M_S2 * 144.0) / 100.0, 1e-12);
    assert_eq!(track.basis.ncols(), 5 * 4);
}

/// What Gram and Schmidt leave of columns, in their order, over its length; twice, so that they are at right angles to rounding.
fn orthonormal(columns: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let mut all: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let mut left = column.normalize();
        for _ in 0..2 {
            all.iter().for_each(|q| left -= q * q.dot(&left));
        }
        all.push(left.normalize());
    }
    all
}

/// Columns by hand in a vacuum: constants and slopes of positions, constants of forces; then order by order what a steady push
/// leaves, ½t² along its axis and, of the force, its own size, and cosines of as many half periods as the order says: of positions
/// two more, or one after a push, of forces one.
#[test]
fn exact_bases_are_gram_schmidt_of_push_and_cosines() {
    let t_s = times(8, 0.0, 1.3);
    let n = t_s.len();
    let column = |f: &dyn Fn(usize, f64) -> f64, channels: usize| DVector::from_fn(n * channels, |i, _| f(i / n, t_s[i % n]));
    let cosine = |channel: usize, k: f64, channels: usize| {
        column(&|c, t| if c == channel { (std::f64::consts::PI * k * t / 1.3).cos() } else { 0.0 }, channels)
    };
    for (record, pushed) in [
        (thrown(&t_s, &[0, 2], [1.0; 3], [2.0; 3]), false),
        (thrown(&t_s, &[0, 2], [1.0; 3], [2.0; 3]), true),
        (mixed(&t_s), true),
    ] {
        let track = Track::new(&record, &[], 0, &ball(0.0), pushed).expect("flies");
        let m = track.axes.len();
        let (places, both) = (2, m == 4);
        let mut columns: Vec<DVector<f64>> = Vec::new();
        for channel in 0..m {
            columns.push(column(&|c, _| f64::from(u8::from(c == channel)), m));
        }
        for channel in 0..places {
            columns.push(column(&|c, t| if c == channel { t } else { 0.0 }, m));
        }
        let push = |channel: usize| {
            column(
                &|c, t| {
                    if c == channel {
                        0.5 * t * t / track.scales[c]
                    } else if c == channel + 2 {
                        1.0 / 0.2
                    } else {
                        0.0
                    }
                },
                m,
            )
        };
        let states = columns.len();
        for order in 0..n - 2 {
            for channel in 0..m {
                columns.push(match (channel < places, pushed) {
                    (true, true) if order == 0 => push(channel),
                    (true, true) => cosine(channel, order as f64 + 1.0, m),
                    (true, false) => cosine(channel, order as f64 + 2.0, m),
                    (false, _) => cosine(channel, order as f64 + 1.0, m),
                });
            }
        }
        let expected = orthonormal(&columns);
        assert_eq!((track.state_basis.ncols(), track.basis.ncols(), both), (states, expected.len() - states, states == 6));
        for (k, q) in expected.iter().skip(states).enumerate() {
            // Columns of cosines lose digits to one another as their number nears that of the samples.
            close(track.basis.column(k).dot(q).abs(), 1.0, 1e-8);
        }
        for channel in 0..places {
            let pushes = track.basis.columns(0, m).tr_mul(&push(channel));
            (0..m).for_each(|k| close(track.push[(k, channel)], pushes[k], 1e-8));
        }
    }
}

/// A steady push and a steady turn of a body at rest about a principal axis: ½t² along and about their axes.
#[test]
fn exact_push_and_turn_of_a_rigid_body() {
    let t_s = times(9, 0.0, 1.3);
    let record = unturned(&t_s);
    let track = Track::new(&record, &[], 0, &brick(), true).expect("flies");
    let pushed = track.push_columns(&track.own(&brick()), &track.start).expect("flies");
    assert_eq!(pushed.shape(), (54, 6));
    for (k, column) in pushed.column_iter().enumerate() {
        column.iter().enumerate().for_each(|(i, x)| close(*x, if i / 9 == k { 0.5 * t_s[i % 9].powi(2) } else { 0.0 }, 1e-7));
    }
}
