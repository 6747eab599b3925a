//! pid tests: one run against its own equations flown in small steps, and its elimination against dense least squares.

use super::super::instruments::ERRORS;
use super::*;
use crate::equations::tests::plant;
use crate::equations::{ADDED, MOTION};
use nalgebra::{DMatrix, DVector};
use windfall_model::Contact;
use windfall_model::frames::{Body, EulerXyz, Rotation, Tunnel, Vec3};

const RATE_HZ: f64 = 100.0;
/// Five pieces of five samples and two samples more.
pub(crate) const SAMPLES: usize = 27;
/// Steps of a sample.
const FINE: usize = 20;
/// Tunnel speed (m/s) with its two derivatives at the first sample.
const SPEED_AT_START: [f64; 3] = [7.4, 0.3, -0.8];
const PS_PA: f64 = 101_000.0;
const TS_K: f64 = 295.0;

fn speed_at(t: f64) -> [f64; 3] {
    let [v, a, b] = SPEED_AT_START;
    [v + a * t + 0.5 * b * t * t, a + b * t, b]
}

/// States every twentieth of a sample from some samples before the first, by the classical method on the public rates.
pub(crate) struct Flown {
    states: Vec<[f64; STATES]>,
    before: usize,
}

pub(crate) fn flown(plant: &Plant, before: usize) -> Flown {
    flown_in(plant, before, |_| [0.0; ADDED])
}

/// In gusts, or with increments of coefficients, by time.
pub(crate) fn flown_in(plant: &Plant, before: usize, added: impl Fn(f64) -> [f64; ADDED]) -> Flown {
    let craft = Craft::complete(plant).expect("an inertia that has an inverse");
    let density_kg_m3 = plant.environment.density_kg_m3(PS_PA, TS_K);
    let h = 1.0 / (RATE_HZ * FINE as f64);
    let mut terms = Vec::new();
    let mut rate = |x: &[f64; MOTION], t: f64| {
        let [vw_m_s, vw_rate_m_s2, _] = speed_at(t);
        let air = TunnelAir { t_s: t, density_kg_m3, vw_m_s, vw_rate_m_s2 };
        craft.rates(x, air, &added(t), &mut terms).expect("the nose points down")
    };
    let along = |x: &[f64; MOTION], k: &[f64; MOTION], h: f64| -> [f64; MOTION] { std::array::from_fn(|i| x[i] + h * k[i]) };
    let mut x = [0.0; MOTION];
    x[..STATES].copy_from_slice(&[0.1, -0.2, 0.3, 3.0, 0.15, -0.2, 0.2, 0.4, -0.3, 1.2, 0.9, -1.1]);
    let mut states = Vec::new();
    for n in 0..(before + SAMPLES) * FINE {
        states.push(std::array::from_fn(|i| x[i]));
        let t = n as f64 * h - before as f64 / RATE_HZ;
        let a = rate(&x, t);
        let b = rate(&along(&x, &a, 0.5 * h), t + 0.5 * h);
        let c = rate(&along(&x, &b, 0.5 * h), t + 0.5 * h);
        let d = rate(&along(&x, &c, h), t + h);
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    Flown { states, before }
}

impl Flown {
    /// State some fine steps after a sample.
    fn at(&self, sample: usize, later: isize) -> &[f64; STATES] {
        let place = ((self.before + sample) * FINE).checked_add_signed(later).expect("within the flight");
        &self.states[place]
    }
    pub(crate) fn node(&self, sample: usize) -> [f64; NODE] {
        let mut z = [0.0; NODE];
        z[..STATES].copy_from_slice(self.at(sample, 0));
        z[STATES..].copy_from_slice(&speed_at(sample as f64 / RATE_HZ));
        z
    }
    /// What the instruments of a plant show, with errors beside: those of the wind as scale and delay, of angles late by some fine steps,
    /// turned by Euler angles, of a reported origin off its place.
    pub(crate) fn record(&self, plant: &Plant, shown: &Shown) -> Record {
        let turn = |e: [f64; 3]| EulerXyz { rx_rad: e[0], ry_rad: e[1], rz_rad: e[2] }.r_tunnel_body().matrix;
        let (mut position, mut attitude, mut wind) = ([(); 3].map(|()| vec![]), [(); 3].map(|()| vec![]), vec![]);
        for sample in 0..SAMPLES {
            let x = self.at(sample, 0);
            let arm = Vec3::<Body>::from_array(shown.lever_m) - plant.vehicle.p_origin_cm;
            let p = turn([x[3], x[4], x[5]]) * arm.xyz;
            let late = self.at(sample, -shown.angles_late);
            let matrix = turn([late[3], late[4], late[5]]) * turn(shown.misalignment_rad);
            let e = EulerXyz::from_rotation(Rotation::<Tunnel, Body>::from_matrix(matrix));
            let turns = std::f64::consts::TAU * ((late[3] - e.rx_rad) / std::f64::consts::TAU).round();
            for (k, (series, angle)) in position.iter_mut().zip([e.rx_rad + turns, e.ry_rad, e.rz_rad]).enumerate() {
                series.push(x[k] + p[k]);
                attitude[k].push(angle);
            }
            let t = sample as f64 / RATE_HZ - shown.wind_late as f64 / (RATE_HZ * FINE as f64);
            wind.push(speed_at(t)[0] * (1.0 + plant.sensors.wind_scale + shown.wind_scale));
        }
        Record {
            t_s: (0..SAMPLES).map(|i| i as f64 / RATE_HZ).collect(),
            position_m: position,
            attitude_rad: attitude,
            vw_m_s: wind,
            ps_pa: vec![PS_PA; SAMPLES],
            ts_k: vec![TS_K; SAMPLES],
            ..Record::default()
        }
    }
    fn nominal(&self, run: &PreparedRun<'_>) -> Nominal {
        Nominal { nodes: (0..SAMPLES).step_by(run.piece).map(|i| self.node(i)).collect() }
    }
}

/// Errors of the instruments, delays in fine steps.
#[derive(Default)]
pub(crate) struct Shown {
    wind_scale: f64,
    wind_late: isize,
    angles_late: isize,
    misalignment_rad: [f64; 3],
    lever_m: [f64; 3],
}

pub(crate) fn erring() -> Plant {
    let mut plant = plant();
    plant.sensors.wind_scale = 0.02;
    plant
}

/// The same, struck gently once: so the time of a sample counts.
fn struck() -> Plant {
    let mut plant = erring();
    let (impulse, angular_impulse) = (Vec3::new(0.04, 0.1, -0.06), Vec3::new(0.002, -0.01, 0.007));
    plant.contacts.push(Contact { run: 0, start_s: 0.03, duration_s: 0.31, impulse, angular_impulse });
    plant
}

/// Nothing free, parameters as the plant has them.
pub(crate) fn held(plant: &Plant) -> FreeColumns {
    FreeColumns {
        parameters: plant.aero.values.clone(),
        columns: vec![None; plant.aero.values.len()],
        biases: [0.0; CHANNELS],
        bias_columns: [None; CHANNELS],
        errors: None,
        free: 0,
    }
}

fn sizes(residuals: &PerChannel<Vec<f64>>) -> PerChannel<f64> {
    residuals.each_ref().map(|r| r.iter().fold(0.0, |m, v| v.abs().max(m)))
}

/// A flight of the equations leaves nothing, but for what their steps of 10 ms err: the fastest motion, 10 rad/s, by (0.1)⁵/120 of a rad or a
/// metre a step, in pieces of five. Then a piece that does not meet the next, and a jump, each by hand.
#[test]
fn exact_a_flight_leaves_nothing() {
    let plant = struck();
    let flight = flown(&plant, 0);
    let record = flight.record(&plant, &Shown::default());
    let mut run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
    assert_eq!((run.piece, run.smoothed.nodes.len()), (5, 6));
    // A tunnel speed without noise is taken for one that hardly changes.
    run.jump_std = 0.4;
    let (mut nominal, mut c, mut work) = (flight.nominal(&run), held(&plant), Transition::default());
    let misfit = run.misfit(&nominal, &c, &mut work).expect("flies");
    assert!(sizes(&misfit.residuals).iter().all(|r| *r < 1e-6), "{:?}", sizes(&misfit.residuals));
    assert!(misfit.gaps < 0.1 && misfit.jumps < 1e-9, "{} {}", misfit.gaps, misfit.jumps);
    assert!(misfit.residuals.iter().all(|r| r.len() == SAMPLES));
    // A bias is what is measured less what is predicted.
    c.biases[4] = 0.01;
    let biased = run.misfit(&nominal, &c, &mut work).expect("flies");
    assert!(biased.residuals[4].iter().zip(&misfit.residuals[4]).all(|(b, r)| (b - (r - 0.01)).abs() < 1e-15));
    c.biases[4] = 0.0;
    // The last node is met by one piece alone and followed by none.
    let last = nominal.nodes.len() - 1;
    nominal.nodes[last][1] += 3.0 * 7.5e-6;
    nominal.nodes[last][NODE - 1] += 2.0 * run.jump_std;
    let moved = run.misfit(&nominal, &c, &mut work).expect("flies");
    assert!((moved.jumps - 4.0).abs() < 1e-6 && (moved.gaps - 9.0).abs() < 3.0, "{} {}", moved.gaps, moved.jumps);
    // Two residuals of Y at and after it.
    let y: Vec<f64> = moved.residuals[1].iter().zip(&misfit.residuals[1]).map(|(a, b)| a - b).collect();
    assert!(y[..SAMPLES - 2].iter().all(|d| d.abs() < 1e-15) && (y[SAMPLES - 2] + 3.0 * 7.5e-6).abs() < 1e-12, "{y:?}");
}

/// Each error of the instruments, and all of them, as a record of a flight shows it: what is left is of third order in under half a sample
/// (rates of 20 rad/s² times (5 ms)³) and of the record's ends, where a delay leaves it.
#[test]
fn exact_errors_of_the_instruments_leave_nothing() {
    let plant = struck();
    let flight = flown(&plant, 3);
    let step_s = 1.0 / (RATE_HZ * FINE as f64);
    let all = || Shown {
        wind_scale: -0.03,
        wind_late: 27,
        angles_late: 33,
        misalignment_rad: [0.02, -0.03, 0.04],
        lever_m: [0.01, -0.02, 0.03],
    };
    for shown in [
        Shown { wind_scale: 0.05, ..Shown::default() },
        Shown { wind_late: 48, ..Shown::default() },
        Shown { wind_late: -13, ..Shown::default() },
        Shown { angles_late: 9, ..Shown::default() },
        Shown { angles_late: 31, ..Shown::default() },
        Shown { misalignment_rad: [0.05, 0.1, -0.07], ..Shown::default() },
        Shown { lever_m: [0.05, 0.03, -0.02], ..Shown::default() },
        all(),
    ] {
        let mut record = flight.record(&plant, &shown);
        // A bias beside them.
        record.attitude_rad[1].iter_mut().for_each(|ry| *ry += 0.012);
        let run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
        let mut c = held(&plant);
        c.biases[4] = 0.012;
        let ([mx, my, mz], [lx, ly, lz]) = (shown.misalignment_rad, shown.lever_m);
        let delays = [shown.wind_late, shown.angles_late].map(|n| n as f64 * step_s);
        c.errors =
            Some(Errors { values: [shown.wind_scale, delays[0], delays[1], mx, my, mz, lx, ly, lz], columns: [None; ERRORS] });
        let misfit = run.misfit(&flight.nominal(&run), &c, &mut Transition::default()).expect("flies");
        let sizes = sizes(&misfit.residuals);
        assert!(sizes[..3].iter().all(|r| *r < 1e-6) && sizes[6] < 1e-9, "{sizes:?}");
        assert!(sizes[3..6].iter().all(|r| *r < 2e-6), "{sizes:?}");
        // A delay takes the last samples' instants out of the record, an early channel the first.
        let lost = |delay: f64| (delay * RATE_HZ).round().abs() as usize;
        for (channel, delay) in [(6, delays[0]), (3, delays[1])] {
            let r = &misfit.residuals[channel];
            let out = if delay > 0.0 { &r[SAMPLES - lost(delay)..] } else { &r[..lost(delay)] };
            assert!(out.iter().all(|r| *r == 0.0), "{channel}: {out:?}");
        }
    }
}

/// Free unknowns moved by `h` times a direction.
pub(crate) fn moved(c: &FreeColumns, column: usize, h: f64) -> FreeColumns {
    let mut c = c.clone();
    let at = |k: &Option<usize>| *k == Some(column);
    c.parameters.iter_mut().zip(&c.columns).filter(|(_, k)| at(k)).for_each(|(x, _)| *x += h);
    c.biases.iter_mut().zip(&c.bias_columns).filter(|(_, k)| at(k)).for_each(|(x, _)| *x += h);
    if let Some(e) = &mut c.errors {
        e.values.iter_mut().zip(&e.columns).filter(|(_, k)| at(k)).for_each(|(x, _)| *x += h);
    }
    c
}

/// All of a run as one dense problem in the first node, the jumps and the free unknowns: rows, and how each node's step follows from them.
struct Dense {
    a: DMatrix<f64>,
    b: DVector<f64>,
    nodes: Vec<(DMatrix<f64>, DVector<f64>)>,
    own: usize,
}

fn dense(run: &PreparedRun<'_>, nominal: &Nominal, c: &FreeColumns, std: &PerChannel<f64>) -> Dense {
    let count = nominal.nodes.len();
    let own = NODE + count - 1;
    let all = own + c.free;
    let mut work = Transition::default();
    // Weighted residuals of a piece, and the node that it reaches.
    let mut piece = |k: usize, z: &[f64; NODE], c: &FreeColumns| -> (Vec<f64>, [f64; NODE]) {
        let mut nominal = nominal.clone();
        nominal.nodes[k] = *z;
        let misfit = run.misfit(&nominal, c, &mut work).expect("flies");
        let (first, samples) = run.span(k);
        let rows = (first..first + samples).flat_map(|i| (0..CHANNELS).map(move |ch| (i, ch)));
        let residuals = rows.map(|(i, ch)| misfit.residuals[ch][i] / std[ch]).collect();
        let (x, s) = split(z);
        assert!(run.segment(k, c).fly(x, &s, &mut work));
        let end = if k + 1 < count { run.end(&work.states[samples - 1], &s) } else { [0.0; NODE] };
        (residuals, end)
    };
    let (mut rows, mut right): (Vec<Vec<f64>>, Vec<f64>) = (Vec::new(), Vec::new());
    let (mut step, mut off) = (DMatrix::zeros(NODE, all), DVector::zeros(NODE));
    step.view_mut((0, 0), (NODE, NODE)).fill_with_identity();
    let mut nodes = Vec::new();
    for k in 0..count {
        nodes.push((step.clone(), off.clone()));
        let z = nominal.nodes[k];
        let (here, end) = piece(k, &z, c);
        let mut slopes = DMatrix::zeros(here.len(), NODE + c.free);
        let mut forward = DMatrix::zeros(NODE, NODE + c.free);
        for column in 0..NODE + c.free {
            let h = 1e-5;
            let mut at = |h: f64| {
                let mut z = z;
                if column < NODE {
                    z[column] += h;
                    return piece(k, &z, c);
                }
                piece(k, &z, &moved(c, column - NODE, h))
            };
            let (up, down) = (at(h), at(-h));
            // Predictions' slopes: what is measured does not move.
            (0..here.len()).for_each(|i| slopes[(i, column)] = (down.0[i] - up.0[i]) / (2.0 * h));
            (0..NODE).for_each(|i| forward[(i, column)] = (up.1[i] - down.1[i]) / (2.0 * h));
        }
        let mut a = slopes.columns(0, NODE) * &step;
        a.columns_mut(own, c.free).zip_apply(&slopes.columns(NODE, c.free), |x, y| *x += y);
        let b = DVector::from_vec(here) - slopes.columns(0, NODE) * &off;
        rows.extend(a.row_iter().map(|r| r.iter().copied().collect()));
        right.extend(b.iter());
        if k + 1 < count {
            let mut next = forward.columns(0, NODE) * &step;
            next.columns_mut(own, c.free).zip_apply(&forward.columns(NODE, c.free), |x, y| *x += y);
            next[(NODE - 1, NODE + k)] += run.jump_std;
            off = forward.columns(0, NODE) * &off;
            (0..NODE).for_each(|i| off[i] += end[i] - nominal.nodes[k + 1][i]);
            step = next;
            // A jump is as likely as its square is small.
            rows.push((0..all).map(|j| if j == NODE + k { 1.0 } else { 0.0 }).collect());
            right.push(0.0);
        }
    }
    let a = DMatrix::from_fn(rows.len(), all, |i, j| rows[i][j]);
    Dense { a, b: DVector::from_vec(right), nodes, own }
}

/// Parameters free, held and tied, biases, and errors of the instruments: what is left for the unknowns, the trajectory's step, and the
/// outputs' slopes when it follows, all of them against dense least squares with slopes by differences (rounding 1e-16/1e-5 of numbers of
/// order 1 over noise of 1e-3, so 1e-8 of a row; variational equations to (0.1)⁵/120 a step; a late angle by its delay's square, 6e-6; together,
/// through sums of which elimination leaves a small part, 1e-2; 3e-4 measured where the runs alone are asked).
#[test]
fn exact_elimination_is_dense_least_squares() {
    let plant = erring();
    let flight = flown(&plant, 3);
    // Late by a sample and a little: of second order in what is left.
    let shown = Shown { angles_late: 21, wind_late: -19, ..Shown::default() };
    let std = [7.5e-4, 8e-4, 9e-4, 1.1e-3, 1.9e-3, 2.1e-3, 2.6e-3];
    let mut plain = held(&plant);
    // C_A0, C_N,sin, C_m,sin, and C_m1 tied to C_n1.
    for (i, column) in [(0, 0), (1, 1), (5, 2), (7, 3), (9, 3)] {
        plain.columns[i] = Some(column);
    }
    (plain.bias_columns[4], plain.bias_columns[5], plain.free) = (Some(4), Some(5), 6);
    let mut with_errors = held(&plant);
    with_errors.columns[1] = Some(0);
    let values = [0.01, -0.0095, 0.0105, 0.01, -0.02, 0.015, 0.002, -0.001, 0.003];
    with_errors.errors = Some(Errors { values, columns: std::array::from_fn(|k| Some(1 + k)) });
    with_errors.free = 1 + ERRORS;
    for (n, c) in [plain, with_errors].iter().enumerate() {
        let none = Shown::default();
        let record = flight.record(&plant, if n == 0 { &none } else { &shown });
        let mut run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
        run.jump_std = 0.4;
        // Near the flight, with pieces that do not meet.
        let mut nominal = flight.nominal(&run);
        for (k, z) in nominal.nodes.iter_mut().enumerate() {
            z.iter_mut().enumerate().for_each(|(j, x)| *x += 1e-3 * ((5 * k + 3 * j) as f64).sin());
        }
        let mut work = Transition::default();
        let linear = run.linearise(&nominal, c, &std, &mut work).expect("flies");
        let d = dense(&run, &nominal, c, &std);
        let (rows, free) = (d.a.nrows(), c.free);
        let mut whole = DMatrix::zeros(rows, d.own + free + 1);
        whole.columns_mut(0, d.own + free).copy_from(&d.a);
        whole.column_mut(d.own + free).copy_from(&d.b);
        let r = whole.qr().unpack_r();
        let r = r.view((d.own, d.own), (free + 1, free + 1)).into_owned();
        let (expected, found) = (r.transpose() * &r, linear.information.transpose() * &linear.information);
        for i in 0..=free {
            for j in 0..=free {
                let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
                let off = (found[(i, j)] - expected[(i, j)]).abs() / scale;
                assert!(off < 1e-2, "case {n}, {i} {j}: {} {}", found[(i, j)], expected[(i, j)]);
            }
        }
        // A step of the parameters, and what the rest does then.
        let theta = DVector::from_fn(free, |j, _| 0.01 * (1.0 + j as f64).sin());
        let svd = d.a.columns(0, d.own).into_owned().svd(true, true);
        let own = |right: &DVector<f64>| svd.solve(right, 0.0).expect("both sides are there");
        let follow = own(&(&d.b - d.a.columns(d.own, free) * &theta));
        let mut u = DVector::zeros(d.own + free);
        u.rows_mut(0, d.own).copy_from(&follow);
        u.rows_mut(d.own, free).copy_from(&theta);
        let step = run.step(&linear, &theta).expect("a full first node");
        for ((a, b), z) in d.nodes.iter().zip(&step.nodes) {
            let expected = a * &u + b;
            // Of the largest: one step brings speeds by some 0.1 m/s.
            assert!((z - &expected).amax() < 1e-2 * (1.0 + expected.amax()), "case {n}: {z} {expected}");
            // Jumps of some 1e-3, through slopes that are polynomials.
            assert!((z[NODE - 1] - expected[NODE - 1]).abs() < 1e-5, "case {n}: {z} {expected}");
        }
        let next = nominal.moved(&step, 0.5);
        assert!((next.nodes[2][7] - (nominal.nodes[2][7] + 0.5 * step.nodes[2][7])).abs() < 1e-15);
        // Slopes of the outputs, all else following.
        let profiled = run.profiled_slopes(&nominal, &linear, c, &mut work).expect("flies");
        for j in 0..free {
            let follow = own(&-d.a.column(d.own + j));
            let mut u = DVector::zeros(d.own + free);
            u.rows_mut(0, d.own).copy_from(&follow);
            u[d.own + j] = 1.0;
            let slopes = &d.a * u;
            let mut row = 0;
            for k in 0..nominal.nodes.len() {
                let (first, samples) = run.span(k);
                for i in first..first + samples {
                    for (channel, profiled) in profiled.iter().enumerate() {
                        let (expected, found) = (slopes[row] * std[channel], profiled[j][i]);
                        assert!(
                            (expected - found).abs() < 1e-2 * (1.0 + expected.abs()),
                            "case {n}, {j} {i} {channel}: {found} {expected}"
                        );
                        row += 1;
                    }
                }
                row += 1;
            }
        }
    }
}

/// Slopes of the tunnel speed as it is shown, `S (v + t v' + t²/2 v'')` at the time t from the node to the instant whose speed the
/// record shows with this sample: whole samples of a delay are in the record's index.
#[test]
fn exact_slopes_of_a_late_wind() {
    let plant = erring();
    let record = flown(&plant, 0).record(&plant, &Shown::default());
    let run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
    let mut c = held(&plant);
    let mut values = [0.0; ERRORS];
    // A delay of 2.3 samples: two in the index.
    (values[0], values[1]) = (-0.05, 0.023);
    c.errors = Some(Errors { values, columns: [None; ERRORS] });
    let mut work = Transition::default();
    let (x, s) = split(&run.smoothed.nodes[1]);
    assert!(run.segment(1, &c).differentiate(x, &s, &mut work));
    for i in [1, 4] {
        let outputs = run.outputs(run.piece + i, &work.states[i - 1], run.speed(i, &s), &c);
        let mut out = [7.0; NODE];
        run.slopes(i, RunChannel::Wind.at(), &outputs, &c, &work, &mut out);
        let (scale, t) = (1.0 + 0.02 - 0.05, 0.01 * (i as f64 + 2.0) - 0.023);
        for (j, found) in out.into_iter().enumerate() {
            let expected = if j < STATES { 0.0 } else { [scale, scale * t, scale * 0.5 * t * t][j - STATES] };
            assert!((found - expected).abs() < 1e-15, "{i} {j}: {found} {expected}");
        }
    }
}

/// Nodes of a record without noise are the flight's own (a spline through the samples: derivatives to 3e-7 at its ends, measured),
/// the second derivative of tunnel speed among them; its jump over five samples of 10 ms is that of Brownian motion. Both in units
/// of the true speed, of which the record shows 1.02.
#[test]
fn exact_runs_made_ready() {
    let plant = erring();
    let flight = flown(&plant, 0);
    let mut record = flight.record(&plant, &Shown::default());
    let run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
    for (node, expected) in run.smoothed.nodes.iter().zip((0..).step_by(5).map(|i| flight.node(i))) {
        assert!(node.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{node:?} {expected:?}");
    }
    record
        .vw_m_s
        .iter_mut()
        .enumerate()
        .for_each(|(i, v)| *v += 0.01 * ((3 * i * i) as f64).sin() + 0.02 * (0.9 * i as f64).cos());
    let run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
    let root = liveliness(&record.vw_m_s, 0.01).intensity.sqrt() / 1.02;
    assert!(root > 1.0 && (run.jerk_root / root - 1.0).abs() < 1e-9, "{} {root}", run.jerk_root);
    assert!((run.jump_std / (root * 0.05_f64.sqrt()) - 1.0).abs() < 1e-9, "{} {root}", run.jump_std);
}

/// A run still to be flown has a node at every sample: a flight of the equations leaves nothing there either, and a step's jump is
/// that of Brownian motion.
#[test]
fn exact_a_planned_run_is_flown_sample_by_sample() {
    let plant = struck();
    let flight = flown(&plant, 0);
    let record = flight.record(&plant, &Shown::default());
    let run = PreparedRun::planned(&record, &plant, flight.node(0), 0.7, [1e-3; CHANNELS]).expect("it can be integrated");
    let nominal = flight.nominal(&run);
    assert_eq!((nominal.nodes.len(), run.smoothed.nodes.as_slice()), (SAMPLES, &nominal.nodes[..1]));
    let misfit = run.misfit(&nominal, &held(&plant), &mut Transition::default()).expect("flies");
    // Errors of a step as above.
    assert!(sizes(&misfit.residuals).iter().all(|r| *r < 1e-12) && misfit.gaps < 0.1, "{misfit:?}");
    // 0.7 m/s³ in the square root of a second, over 10 ms.
    assert!((run.jump_std - 0.07).abs() < 1e-15);
}

/// Nobody flies on from the last sample: whether that could be done does not matter (past a nose that points across, it cannot).
#[test]
fn law_a_flight_ends_at_the_last_sample() {
    let plant = erring();
    let flight = flown(&plant, 0);
    let mut record = flight.record(&plant, &Shown::default());
    let keep = SAMPLES - 1;
    let series = record.position_m.iter_mut().chain(&mut record.attitude_rad);
    series.chain([&mut record.t_s, &mut record.vw_m_s, &mut record.ps_pa, &mut record.ts_k]).for_each(|x| x.truncate(keep));
    let run = PreparedRun::new("flown", &record, &plant).expect("it can be integrated");
    let (mut nominal, c, mut work) = (flight.nominal(&run), held(&plant), Transition::default());
    assert_eq!(run.span(5), (25, 1));
    nominal.nodes[5][4] = 1.6;
    assert!(run.misfit(&nominal, &c, &mut work).is_some());
    nominal.nodes[4][4] = 1.6;
    assert!(run.misfit(&nominal, &c, &mut work).is_none());
}
