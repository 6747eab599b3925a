//! pid tests: the filter's parts by their definitions, and the whole against one written from the textbook with slopes by differences.

use super::*;
use crate::output_error::flown::{Shown, erring, flown, held, moved};
use nalgebra::{Complex, Matrix2, Vector2};
use windfall_model::{Plant, Record};

pub(in super::super) const RANDOM: Random = Random {
    turbulence: Turbulence {
        axial_rms_m_s: 0.11,
        lateral_rms_m_s: 0.17,
        axial_scale_m: 0.5,
        lateral_scale_m: 0.3,
        bandwidth: 0.0,
    },
    turning: [0.05, 0.3],
};
pub(in super::super) const NOISE: PerChannel<f64> = [7.5e-4, 8e-4, 9e-4, 1.1e-3, 1.9e-3, 2.1e-3, 2.6e-3];

fn filters() -> Vec<(usize, ShapingFilter<2>)> {
    let of = |d: &Disturbance| match (d.entry, d.filter()) {
        (Entry::AirVelocity(axis), StateForm::Two(filter)) => (axis, filter),
        other => panic!("{other:?}"),
    };
    RANDOM.turbulence.disturbances(7.4).iter().map(of).collect()
}

fn matrix(a: [[f64; 2]; 2]) -> Matrix2<f64> {
    Matrix2::new(a[0][0], a[0][1], a[1][0], a[1][1])
}

/// With its output as a state a filter passes noise as before: C (iω − A)⁻¹ B to rounding, at frequencies about its own.
#[test]
fn exact_own_output_passes_the_same() {
    for (_, f) in filters() {
        let other = own_output(f);
        let pass = |f: &ShapingFilter<2>, w: f64| {
            let a = matrix(f.a).map(|x| Complex::new(x, 0.0));
            let m = Matrix2::from_diagonal_element(Complex::new(0.0, w)) - a;
            let x = m.try_inverse().expect("no eigenvalue on the axis") * Vector2::from(f.b).map(|x| Complex::new(x, 0.0));
            x[0] * f.c[0] + x[1] * f.c[1]
        };
        for w in [0.0, 3.0, 20.0, 150.0] {
            assert!((pass(&f, w) - pass(&other, w)).norm() < 1e-12, "{w}");
        }
        assert_eq!(other.c.map(f64::to_bits), [1.0, 0.0].map(f64::to_bits));
    }
}

/// Any filter of second order passes noise as before, and its own output is the first state; one whose C is a left eigenvector of
/// A, which has no rate of its own, stays as it is.
#[test]
fn exact_own_output_of_any_filter() {
    let f = ShapingFilter { a: [[-3.0, 1.7], [-2.3, -0.9]], b: [0.7, -1.9], c: [1.3, 0.6] };
    let other = own_output(f);
    // Impulse response and its rate at the start, C B and C A B, and by Cayley and Hamilton all that follow.
    let (a, b, c) = (matrix(f.a), Vector2::from(f.b), Vector2::from(f.c).transpose());
    for (found, expected) in other.b.into_iter().zip([(c * b)[0], (c * a * b)[0]]) {
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }
    let characteristic = matrix(other.a);
    assert!((characteristic.trace() - a.trace()).abs() < 1e-14 && (characteristic.determinant() - a.determinant()).abs() < 1e-14);
    assert_eq!(characteristic.row(0).iter().map(|v| v.to_bits()).collect::<Vec<_>>(), [0.0, 1.0].map(f64::to_bits));
    // [2, 3] A = −5 [2, 3].
    let alone = ShapingFilter { a: [[-2.0, -9.0], [-2.0, 1.0]], b: [0.7, -1.9], c: [2.0, 3.0] };
    assert_eq!(own_output(alone), alone);
}

/// `A P + P Aᵀ + B Bᵀ = 0`, to rounding of terms of order 10; `e^{At}` has the rate A e^{At} and is one at no time.
#[test]
fn exact_stationary_covariance_and_exponential() {
    for (_, f) in filters().into_iter().map(|(k, f)| (k, own_output(f))).chain(filters()) {
        let (a, b, p) = (matrix(f.a), Vector2::from(f.b), matrix(lyapunov(&f)));
        assert!((a * p + p * a.transpose() + b * b.transpose()).amax() < 1e-11, "{p}");
        let (t, h) = (0.013, 1e-5);
        let rate = (matrix(exponential(f.a, t + h)) - matrix(exponential(f.a, t - h))) / (2.0 * h);
        // Fifth power of 25/s in the rate's rate, times h²/6: 2e-4.
        assert!((rate - a * matrix(exponential(f.a, t))).amax() < 1e-3);
        assert!((matrix(exponential(f.a, 0.0)) - Matrix2::identity()).amax() < 1e-15);
    }
}

/// Values and rates by the states: at once those of the filter, and later each rate the value's own (differences: h² of third derivatives
/// of 1e5, 1e-4).
#[test]
fn exact_inputs_by_their_states() {
    let filters: Vec<_> = filters().into_iter().map(|(k, f)| (k, own_output(f))).collect();
    let ns = SPEED + GUSTS;
    let (t, h) = (0.011, 1e-5);
    let [before, here, after] = [t - h, t, t + h].map(|t| inputs_at(t, ns, &filters));
    for (value, rate) in [(0, 1), (2, 5), (3, 6), (4, 7)] {
        for k in 0..ns {
            let difference = (after[value * ns + k] - before[value * ns + k]) / (2.0 * h);
            assert!((here[rate * ns + k] - difference).abs() < 1e-4, "{value} {k}: {} {difference}", here[rate * ns + k]);
        }
    }
    let start = inputs_at(0.0, ns, &filters);
    for (axis, f) in &filters {
        for k in 0..ns {
            let own = k.checked_sub(SPEED + 2 * axis).filter(|k| *k < 2).map_or(0.0, |k| f.c[k]);
            assert!((start[(2 + axis) * ns + k] - own).abs() < 1e-15);
        }
    }
    for (found, expected) in here[..3].iter().chain(&here[ns..ns + 3]).zip([1.0, t, 0.5 * t * t, 0.0, 1.0, t]) {
        assert!((found - expected).abs() < 1e-18, "{found} {expected}");
    }
}

/// Gusts start from where they stay: with the whole filters' matrices A and B, `A P + P Aᵀ + B Bᵀ = 0`, to rounding of terms of
/// order 10, and each has the rms that it is declared to have.
#[test]
fn exact_gusts_start_stationary() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let filter = Filter::new(&run, NOISE);
    let g = filter.gusts(&RANDOM);
    let speed = record.vw_m_s.iter().sum::<f64>() / record.len() as f64;
    let mut a = DMatrix::<f64>::zeros(GUSTS, GUSTS);
    for d in RANDOM.turbulence.disturbances(speed) {
        let (Entry::AirVelocity(axis), StateForm::Two(f)) = (d.entry, d.filter()) else { panic!("{d:?}") };
        a.view_mut((2 * axis, 2 * axis), (2, 2)).copy_from(&matrix(own_output(f).a));
    }
    let (_, p) = filter.start(&g);
    let b = g.root.view((SPEED, 0), (GUSTS, 4)).into_owned();
    let gusts = dense(&p).view((STATES + SPEED, STATES + SPEED), (GUSTS, GUSTS)).into_owned();
    let left = &a * &gusts + &gusts * a.transpose() + &b * b.transpose();
    assert!(left.amax() < 1e-11, "{left}");
    let t = RANDOM.turbulence;
    for (axis, rms) in [t.axial_rms_m_s, t.lateral_rms_m_s, t.lateral_rms_m_s].into_iter().enumerate() {
        assert!((gusts[(2 * axis, 2 * axis)].sqrt() / rms - 1.0).abs() < 1e-12, "{axis}: {gusts}");
    }
    // Nothing else is known together with anything.
    for (i, row) in p.iter().enumerate() {
        assert!((0..ALL).all(|j| i == j || i.min(j) >= STATES + SPEED || row[j] == 0.0), "{i}");
    }
}

/// A flight is measured as it is, sample by sample of a piece, from any of its nodes: residuals as in output error's test of the
/// same flight.
#[test]
fn exact_a_flight_leaves_no_innovation() {
    let plant = erring();
    let flight = flown(&plant, 0);
    let record = flight.record(&plant, &Shown::default());
    let run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
    let filter = Filter { piece: 5, ..Filter::new(&run, NOISE) };
    let (g, c, mut work) = (filter.gusts(&RANDOM), held(&plant), Transition::default());
    for k in [0, 3] {
        let mut z = [0.0; ALL];
        z[..STATES + SPEED].copy_from_slice(&flight.node(5 * k));
        let (x, inputs) = split(&z);
        assert!(filter.segment(k, &g, &c, [0.0; 3]).differentiate(x, &inputs, &mut work));
        let found = filter.measurements(k, &x, &inputs, &c, &work);
        assert_eq!(found.len(), 5 * CHANNELS);
        for (row, (residual, channel, ..)) in found.iter().enumerate() {
            assert!(*channel == row % CHANNELS && residual.abs() < 1e-6, "{row}: {residual}");
        }
    }
    // Of a record at 700 Hz a piece is 0.0067 s × 700 Hz = 4.69 samples, so five.
    let mut fast = record.clone();
    fast.t_s.iter_mut().for_each(|t| *t /= 7.0);
    let run = PreparedRun::new("fast", &fast, &plant).expect("it can be integrated");
    assert_eq!(Filter::new(&run, NOISE).piece, 5);
}

fn square(f: impl Fn(usize, usize) -> f64) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| f(i, j)))
}

fn dense(p: &Square) -> DMatrix<f64> {
    DMatrix::from_fn(ALL, ALL, |i, j| p[i][j])
}

/// One measurement adds h hᵀ/r to the inverse of the covariance; a prediction is Φ (P + Q) Φᵀ + Q.
#[test]
fn exact_update_and_prediction() {
    let mut p = square(|i, j| if i == j { 2.0 + i as f64 } else { 0.3 * ((i * j) as f64).cos() });
    (0..ALL).for_each(|i| (0..i).for_each(|j| p[i][j] = p[j][i]));
    let h: [f64; ALL] = std::array::from_fn(|i| if i % 3 == 1 { 0.0 } else { (1.0 + i as f64).sin() });
    let before = dense(&p);
    let (gain, variance) = update(&mut p, &h, 0.7);
    let row = DVector::from_row_slice(&h);
    let expected =
        (before.clone().try_inverse().expect("definite") + &row * row.transpose() / 0.7).try_inverse().expect("definite");
    // Numbers of order 20 through two inverses.
    assert!((dense(&p) - &expected).amax() < 1e-11);
    assert!((variance - ((row.transpose() * &before * &row)[0] + 0.7)).abs() < 1e-12);
    assert!((DVector::from_row_slice(&gain) - expected * &row / 0.7).amax() < 1e-12);
    let phi = square(|i, j| if i == j { 1.0 } else { 0.1 * ((3 * i + j) as f64).sin() });
    let q = square(|i, j| if i == j { 0.2 } else { 0.01 * ((i + j) as f64).cos() });
    assert!((dense(&times(&phi, &q)) - dense(&phi) * dense(&q)).amax() < 1e-14);
    let expected = dense(&phi) * (dense(&p) + dense(&q)) * dense(&phi).transpose() + dense(&q);
    predict(&mut p, &phi, &q);
    assert!((dense(&p) - (&expected + expected.transpose()) * 0.5).amax() < 1e-12);
    let pass = Pass { innovation: vec![0.5, -2.0], variance: vec![0.3, 4.0] };
    assert!((pass.log_likelihood2() + 0.25 / 0.3 + 1.0 + 0.3_f64.ln() + 4.0_f64.ln()).abs() < 1e-14);
}

/// A flight of two tenths of a second in made-up gusts: its record is that of the flight without, shaken.
pub(in super::super) fn shaken(plant: &Plant) -> Record {
    let mut record = flown(plant, 0).record(plant, &Shown::default());
    for (c, series) in record.position_m.iter_mut().chain(&mut record.attitude_rad).enumerate() {
        for (i, x) in series.iter_mut().enumerate() {
            *x += 3e-3 * ((0.4 * i as f64 + c as f64).sin() + 0.3 * ((7 * i * i + 3 * c) as f64).sin());
        }
    }
    record
}

/// Some parameters free, one of them tied, and an error of an angle.
pub(in super::super) fn free(plant: &Plant) -> FreeColumns {
    let mut c = held(plant);
    for (i, column) in [(0, 0), (1, 1), (7, 2), (9, 2)] {
        c.columns[i] = Some(column);
    }
    (c.bias_columns[4], c.free) = (Some(3), 4);
    c
}

/// Innovations, variances and slopes, from the textbook: P by (I − K h) P (I − K h)ᵀ + K r Kᵀ, slopes of flights and outputs by differences.
fn textbook(filter: &Filter<'_, '_>, plant: &Plant, c: &FreeColumns) -> (Vec<f64>, Vec<f64>, Vec<Vec<f64>>) {
    let (run, g) = (filter.run, filter.gusts(&RANDOM));
    let (h, tau) = (run.interval_s, run.interval_s * filter.piece as f64);
    let mean = run.record.vw_m_s.iter().sum::<f64>() / run.record.len() as f64;
    // Speed as a chain that jerk drives, a filter for each gust.
    let mut a = DMatrix::<f64>::zeros(SPEED + GUSTS, SPEED + GUSTS);
    let mut b = DMatrix::<f64>::zeros(ALL, 4);
    (a[(0, 1)], a[(1, 2)]) = (1.0, 1.0);
    b[(STATES + 2, 0)] = run.jerk_root;
    let mut p = DMatrix::<f64>::zeros(ALL, ALL);
    (0..STATES + SPEED).for_each(|i| p[(i, i)] = START_STD[i].powi(2));
    let mut white = [0.0; 3];
    for d in RANDOM.turbulence.disturbances(mean) {
        let (Entry::AirVelocity(axis), StateForm::Two(f)) = (d.entry, d.filter()) else { panic!("{d:?}") };
        let (f, at) = (own_output(f), SPEED + 2 * axis);
        a.view_mut((at, at), (2, 2)).copy_from(&matrix(f.a));
        p.view_mut((STATES + at, STATES + at), (2, 2)).copy_from(&matrix(lyapunov(&f)));
        (b[(STATES + at, 1 + axis)], b[(STATES + at + 1, 1 + axis)]) = (f.b[0], f.b[1]);
        white[axis] = f.c[0] * f.b[0] + f.c[1] * f.b[1];
    }
    let later = (&a * tau).exp();
    let mut work = Transition::default();
    let mut z = DVector::<f64>::zeros(ALL);
    z.rows_mut(0, STATES + SPEED).copy_from_slice(&run.smoothed.nodes[0]);
    let mut s = DMatrix::<f64>::zeros(ALL, c.free);
    let (mut innovations, mut variances, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..filter.pieces() {
        let spread = [0, 1, 2].map(|axis| p[(STATES + SPEED + 2 * axis, STATES + SPEED + 2 * axis)].sqrt());
        // Predictions of the piece's measurements, and the state at its end.
        let mut predicted = |z: &DVector<f64>, c: &FreeColumns| -> (Vec<f64>, DVector<f64>) {
            let all: [f64; ALL] = std::array::from_fn(|i| z[i]);
            let (x, inputs) = split(&all);
            assert!(filter.segment(k, &g, c, spread).fly(x, &inputs, &mut work));
            let mut out = Vec::new();
            for i in 0..filter.piece {
                let at = if i == 0 { x } else { work.states[i - 1] };
                let t = i as f64 * h;
                let vw = inputs[0] + inputs[1] * t + inputs[2] * t * t / 2.0;
                let left = run.residual(k * filter.piece + i, &at, vw, c);
                let measured = run.record.channels();
                out.extend((0..CHANNELS).map(|ch| measured[ch][k * filter.piece + i] - left[ch]));
            }
            let mut end = DVector::zeros(ALL);
            end.rows_mut(0, STATES).copy_from_slice(&work.states[filter.piece - 1]);
            end.rows_mut(STATES, SPEED + GUSTS).copy_from(&(&later * DVector::from_row_slice(&inputs)));
            (out, end)
        };
        let before = z.clone();
        let (here, _) = predicted(&before, c);
        let (mut out_by, mut end_by) = (DMatrix::zeros(here.len(), ALL + c.free), DMatrix::zeros(ALL, ALL + c.free));
        for column in 0..ALL + c.free {
            let step = 1e-5;
            let mut at = |step: f64| {
                let mut z = before.clone();
                if column < ALL {
                    z[column] += step;
                    return predicted(&z, c);
                }
                predicted(&z, &moved(c, column - ALL, step))
            };
            let (up, down) = (at(step), at(-step));
            (0..here.len()).for_each(|i| out_by[(i, column)] = (up.0[i] - down.0[i]) / (2.0 * step));
            end_by.column_mut(column).copy_from(&((up.1 - down.1) / (2.0 * step)));
        }
        let measured = run.record.channels();
        for (row, predicted) in here.iter().enumerate() {
            let (sample, ch) = (k * filter.piece + row / CHANNELS, row % CHANNELS);
            let out = out_by.row(row).columns(0, ALL).transpose();
            let variance = out.dot(&(&p * &out)) + NOISE[ch].powi(2);
            let gain = &p * &out / variance;
            let innovation = measured[ch][sample] - predicted - out.dot(&(&z - &before));
            let slope = -(out_by.row(row).columns(ALL, c.free).transpose() + s.transpose() * &out);
            z += &gain * innovation;
            s += &gain * slope.transpose();
            let left = DMatrix::identity(ALL, ALL) - &gain * out.transpose();
            p = &left * &p * left.transpose() + &gain * gain.transpose() * NOISE[ch].powi(2);
            innovations.push(innovation);
            variances.push(variance);
            slopes.push(slope.as_slice().to_vec());
        }
        // What a gust's white rate does to the body rates: by differences of the rates where the piece began.
        let craft = crate::equations::Craft::complete(plant).expect("an inertia that has an inverse");
        let mut x = [0.0; crate::equations::MOTION];
        (0..STATES).for_each(|i| x[i] = before[i]);
        let air = crate::equations::TunnelAir {
            t_s: k as f64 * tau,
            density_kg_m3: run.density[k * filter.piece],
            vw_m_s: before[STATES],
            vw_rate_m_s2: before[STATES + 1],
        };
        for axis in 0..3 {
            let rate = |by: f64| {
                let mut added = [0.0; crate::equations::ADDED];
                (0..3).for_each(|k| added[k] = before[STATES + SPEED + 2 * k]);
                added[3 + axis] = by;
                craft.rates(&x, air, &added, &mut Vec::new()).expect("there is flow")
            };
            let (up, down) = (rate(1.0), rate(-1.0));
            (9..12).for_each(|i| b[(i, 1 + axis)] = 0.5 * (up[i] - down[i]) * white[axis]);
        }
        let mut q = &b * b.transpose() * (0.5 * tau);
        let [roll, across] = RANDOM.turning;
        (q[(9, 9)], q[(10, 10)], q[(11, 11)]) = (
            q[(9, 9)] + 0.5 * tau * roll * roll,
            q[(10, 10)] + 0.5 * tau * across * across,
            q[(11, 11)] + 0.5 * tau * across * across,
        );
        let phi = end_by.columns(0, ALL).into_owned();
        s = &phi * &s + end_by.columns(ALL, c.free);
        z = predicted(&z, c).1;
        p = &phi * (&p + &q) * phi.transpose() + &q;
    }
    (innovations, variances, slopes)
}

/// The filter over twelve pieces of two samples: slopes by differences (1e-8) and by the variational equations to (0.1)⁵/120, white rates at
/// the mean instead of over the unknown gust. What that leaves adds up from piece to piece: to a hundredth of a standard deviation there, and
/// to 0.012 in the thirteenth piece.
#[test]
fn exact_filter_is_that_of_the_textbook() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let filter = Filter { piece: 2, ..Filter::new(&run, NOISE) };
    assert_eq!((Filter::new(&run, NOISE).piece, filter.pieces()), (1, record.len() / 2));
    let c = free(&plant);
    let seen = filter.run(&RANDOM, &c, &mut Transition::default()).expect("flies");
    let (innovations, variances, slopes) = textbook(&filter, &plant, &c);
    assert_eq!(seen.pass.innovation.len(), innovations.len());
    // Of an error of an angle slopes begin at one and fall to thousandths.
    let largest = |j: usize| slopes.iter().map(|s| s[j].abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    let largest: Vec<f64> = (0..c.free).map(largest).collect();
    for (row, innovation) in innovations.iter().enumerate().take(12 * 2 * CHANNELS) {
        let std = variances[row].sqrt();
        let off = (seen.pass.innovation[row] - innovation).abs() / std;
        let wide = (seen.pass.variance[row] / variances[row] - 1.0).abs();
        assert!(off < 1e-2 * (1.0 + innovation.abs() / std) && wide < 1e-2, "row {row}: {off} {wide}");
        for j in 0..c.free {
            let (found, expected) = (seen.by_parameter[row * c.free + j], slopes[row][j]);
            assert!(
                (found - expected).abs() < 1e-2 * (expected.abs() + std) + 2e-3 * largest[j],
                "row {row} {j}: {found} {expected}"
            );
        }
    }
}

/// A pass with other sizes, linear about the first one: the same again with the same sizes, and with others what the filter itself then
/// finds but for a small part of the difference (a few hundredths: flow angles change by that).
#[test]
fn law_another_pass_is_the_filter_with_other_sizes() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let filter = Filter { piece: 2, ..Filter::new(&run, NOISE) };
    let c = free(&plant).held();
    let mut work = Transition::default();
    let seen = filter.run(&RANDOM, &c, &mut work).expect("flies");
    let same = filter.again(&RANDOM, &seen);
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
    assert!(near(&same.innovation, &seen.pass.innovation) < 1e-12);
    let mut other = RANDOM;
    (other.turbulence.axial_rms_m_s, other.turbulence.lateral_rms_m_s, other.turning) = (0.06, 0.1, [0.1, 0.1]);
    let (again, new) = (filter.again(&other, &seen), filter.run(&other, &c, &mut work).expect("flies"));
    let whole = near(&new.pass.innovation, &seen.pass.innovation);
    let part = near(&new.pass.innovation, &again.innovation) / whole;
    let ratios = again
        .variance
        .iter()
        .zip(&new.pass.variance)
        .map(|(a, b)| (a / b - 1.0).abs())
        .max_by(f64::total_cmp)
        .unwrap_or(f64::NAN);
    assert!(part < 0.05 && ratios < 0.02, "{part} of {whole}, {ratios}");
}
