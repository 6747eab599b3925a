//! likelihood tests: a step of the filter against matrix exponentials, an oscillator's textbook solution and differences.

use super::super::dense::slopes;
use super::super::tests::{noise, numbers, plant, run, state};
use super::super::{PassSetting, number_plants, ready};
use super::*;
use crate::columns::{Basis, SensitivityColumn};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
use std::f64::consts::TAU;
use windfall_model::{ApparentMass, DRIFT_TIME_S, Disturbance, Drift, LooseMass, RunScatter, Shape};
use windfall_pid::equations::Craft;

/// `∫ e^{Fs} W e^{Fᵀs} ds` and `e^{Fh}` (Van Loan 1978).
fn van_loan(f: &DMatrix<f64>, white: &DMatrix<f64>, h: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = f.nrows();
    let mut m = DMatrix::zeros(2 * n, 2 * n);
    m.view_mut((0, 0), (n, n)).copy_from(&-f);
    m.view_mut((0, n), (n, n)).copy_from(white);
    m.view_mut((n, n), (n, n)).copy_from(&f.transpose());
    let e = (m * h).exp();
    let phi = e.view((n, n), (n, n)).transpose();
    (&phi * e.view((0, n), (n, n)), phi)
}

/// Rates of an input's states and the size of the white noise that enters the last of them: a gust of Dryden's form behind a lag of a tenth of
/// its time, `x + ζ T ẋ` of the form's state, of variance `(1 + ζ²)/4T` per density of noise; an oscillator of the wake.
fn continuous(d: &Disturbance) -> (DMatrix<f64>, f64) {
    let gust = |t: f64, zeta: f64| {
        let fast = 10.0 / t;
        let rates = [-fast, fast, fast * zeta, 0.0, 0.0, 1.0 / t, 0.0, -1.0 / t, -2.0 / t];
        (DMatrix::from_row_slice(3, 3, &rates), d.rms * (4.0 / t / (1.0 + zeta * zeta)).sqrt())
    };
    match d.shape {
        Shape::DrydenLongitudinal { time_s } => gust(time_s, 1.0),
        Shape::DrydenLateral { time_s } => gust(time_s, 3.0_f64.sqrt()),
        Shape::Narrow { centre_rad_s: w, bandwidth_rad_s: b } => {
            (DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -w * w, -b]), d.rms * w * (2.0 * b).sqrt())
        }
        Shape::Constant => (DMatrix::zeros(1, 1), 0.0),
        Shape::Band { .. } => panic!("no band here"),
    }
}

/// Slopes of a motion whose transition ends with the third power and whose response to inputs ends with the second, to the tunnel speed with the
/// first, so that the filter's series are whole.
fn nilpotent() -> (Local, impl Fn(usize) -> usize) {
    let level = |i: usize| (i + 2) % 4;
    let mut next = numbers(3);
    let mut local = Local {
        rate: [0.0; MOTION],
        by_state: [[0.0; MOTION]; MOTION],
        by_added: [[0.0; ADDED]; MOTION],
        by_speed: [[0.0; 2]; MOTION],
    };
    for i in 0..MOTION {
        (0..MOTION).filter(|&k| level(k) > level(i)).for_each(|k| local.by_state[i][k] = 20.0 * next());
        if level(i) < 3 {
            local.by_added[i] = std::array::from_fn(|_| next());
        }
        if level(i) < 2 {
            local.by_speed[i] = [next(), next()];
        }
    }
    (local, level)
}

/// Transition and noise of motion, gusts, moments of the wake, drifts, a mass that differs between runs, the tunnel speed's record and coloured noise of means are those of the matrix
/// exponential of all of them together, with what gusts leave in each step and the free accelerations of a search's start. To the rounding of
/// an exponential.
#[test]
fn exact_transition_of_a_nilpotent_motion() {
    let (mut plant, noise, mut run) = (plant(), noise(), run());
    plant.drift = Drift { position_rms_m: [0.003, 0.004, 0.002], attitude_rms_rad: [0.002; 3], speed_rms_m_s: 0.05 };
    plant.scatter = RunScatter { mass: 0.02, ..RunScatter::default() };
    run.speed.density = 0.37;
    let logs = [[0.3, 0.5], [-0.4, 0.2], [0.7, -0.2]];
    run.intensity.logs = logs.map(|l| l.to_vec());
    let moved = number_plants(&plant);
    let slack = [0.3, 0.2, 0.25, 0.35, 0.15, 0.1];
    let setting = PassSetting { slack, keep: Keep::Gusts, numbers: &moved, ..PassSetting::plain(&plant, &noise) };
    let mut f = Filter::new(&run, &setting).expect("a whole model");
    f.random[1].broad = 0.2;
    let (n, h, k) = (f.states, f.step_s, 5);
    let (local, level) = nilpotent();
    let mut next = numbers(4);
    let by_number: [f64; MOTION] = std::array::from_fn(|i| if level(i) < 3 { next() } else { 0.0 });
    let mut rates = DMatrix::zeros(n, n);
    (0..MOTION).for_each(|i| (0..MOTION).for_each(|j| rates[(i, j)] = local.by_state[i][j]));
    let wind = DVector::from_fn(n, |i, _| if i < MOTION { local.by_speed[i][0] } else { 0.0 });
    let mut white = &wind * wind.transpose() * (0.37 / 1.03 / 1.03);
    let mut gusts = Vec::new();
    for ((at, input), d) in f.inputs().zip(&plant.disturbances(run.speed_m_s)) {
        let (a, b) = match d.entry {
            Entry::RecordedSpeed | Entry::RecordedPose(_) => {
                (DMatrix::from_element(1, 1, -1.0 / DRIFT_TIME_S), d.rms * (2.0 / DRIFT_TIME_S).sqrt())
            }
            _ => continuous(d),
        };
        let last = at + input.order - 1;
        rates.view_mut((at, at), (input.order, input.order)).copy_from(&a);
        for i in 0..MOTION {
            match d.entry {
                Entry::AirVelocity(axis) => {
                    rates[(i, at)] += local.by_added[i][axis];
                    (0..3).for_each(|c| rates[(i, at + c)] += local.by_added[i][3 + axis] * a[(0, c)]);
                }
                Entry::Coefficient(c) => rates[(i, at)] = local.by_added[i][6 + c],
                Entry::RecordedSpeed => rates[(i, at)] = local.by_added[i][0],
                Entry::RecordedPose(_) => {}
                Entry::Number(_) => rates[(i, at)] = by_number[i],
            }
        }
        // Knots half a second apart.
        let share = run.nodes[k].t_s / 0.5;
        let now = |axis: usize| (logs[axis][0] * (1.0 - share) + logs[axis][1] * share).exp();
        let mut own = DMatrix::zeros(n, n);
        own[(last, last)] = b * b * if let Entry::AirVelocity(axis) = d.entry { now(axis) } else { 1.0 };
        white += &own;
        if let Entry::AirVelocity(axis) = d.entry {
            let broad = if axis == 1 { now(axis).sqrt() * 0.2 * h } else { 0.0 };
            let by = DVector::from_fn(n, |i, _| if i < MOTION { broad * local.by_added[i][axis] } else { 0.0 });
            gusts.push((axis, own, &by * by.transpose()));
        }
    }
    let (mut q, mut phi) = van_loan(&rates, &white, h);
    gusts.iter().for_each(|(_, _, broad)| q += broad);
    for (i, a) in [2.0, 2.0, 2.0, 5.0, 10.0, 10.0].into_iter().enumerate() {
        q[(6 + i, 6 + i)] += (slack[i] * a * h).powi(2);
    }
    // Means of three samples and their last, by the last before and by what drives each sample.
    for (at, c) in [(n - 4, 1), (n - 2, 4)] {
        let r: f64 = noise[c].correlation;
        phi.view_mut((at, at), (2, 2)).copy_from_slice(&[0.0, 0.0, (r + r * r + r.powi(3)) / 3.0, r.powi(3)]);
        let (mean, last) = (Vector3::new(1.0 + r + r * r, 1.0 + r, 1.0) / 3.0, Vector3::new(r * r, r, 1.0));
        let covariances = [mean.dot(&mean), mean.dot(&last), mean.dot(&last), last.dot(&last)];
        q.view_mut((at, at), (2, 2)).copy_from_slice(&covariances.map(|x| x * noise[c].coloured * (1.0 - r * r)));
    }
    let mut work = Work::new(&f);
    work.by_number = vec![by_number];
    f.transition(k, &local, false, &mut work);
    for i in 0..n {
        for j in 0..n {
            let found = work.phi[i * f.n + j];
            assert!((found - phi[(i, j)]).abs() < 1e-10 * phi.row(i).amax(), "{i} {j}: {found} for {}", phi[(i, j)]);
            let (found, scale) = (work.q[i * f.n + j], (q[(i, i)] * q[(j, j)]).sqrt());
            assert!(j > i || (found - q[(i, j)]).abs() <= 1e-9 * scale, "{i} {j}: {found} for {}", q[(i, j)]);
        }
    }
    for ((axis, white, broad), found) in gusts.iter().zip(&work.gusts) {
        let q = van_loan(&rates, white, h).0 + broad;
        assert_eq!(found.axis, *axis);
        let mut all = found.added.iter();
        for (i, &r) in found.states.iter().enumerate() {
            for &c in &found.states[..=i] {
                let found = all.next().expect("as many as on and below the diagonal");
                // A difference of all that is added.
                assert!((found - q[(r, c)]).abs() <= 1e-9 * work.q[r * f.n + r].max(work.q[c * f.n + c]), "{axis} {r} {c}");
            }
        }
        assert!(all.next().is_none() && found.states.len() == MOTION + 3);
    }
    // ∫ e^{As} ds, without its third power, which columns of the last level have.
    let mut wide = DMatrix::zeros(2 * MOTION, 2 * MOTION);
    wide.view_mut((0, 0), (MOTION, MOTION)).copy_from(&rates.view((0, 0), (MOTION, MOTION)));
    wide.view_mut((0, MOTION), (MOTION, MOTION)).fill_with_identity();
    let gamma = (wide * h).exp().view((0, MOTION), (MOTION, MOTION)).into_owned();
    for i in 0..MOTION {
        for j in (0..MOTION).filter(|&j| level(j) < 3) {
            let found = work.gamma[i * MOTION + j];
            assert!((found - gamma[(i, j)]).abs() < 1e-12 * gamma.amax(), "{i} {j}: {found} for {}", gamma[(i, j)]);
        }
    }
}

/// States of inputs and coloured noise go on by the step's transition.
#[test]
fn exact_inputs_go_on_by_their_transition() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting::plain(&plant, &noise)).expect("a whole model");
    let z = state(&f, &mut numbers(5));
    let (mut next, mut work) = (z.clone(), Work::new(&f));
    let (view, mut p) = (f.view(&z, 3), vec![0.0; f.n * f.n]);
    f.predict(3, &mut next, &mut p, &mut Vec::new(), &mut [], &view, &mut [], &mut work).expect("a state that flies");
    for (i, next) in next.iter().enumerate().take(f.states).skip(MOTION) {
        let expected: f64 = work.phi[i * f.n..(i + 1) * f.n].iter().zip(&z).map(|(a, z)| a * z).sum();
        assert!((next - expected).abs() < 1e-14, "{i}: {next} for {expected}");
    }
}

/// `S⁻ = Φ S⁺ + Γ B + (∂h/∂clock) ẋ`: any matrices, the step's slope by its clock by central differences (1e-6: rounding over that, 1e-10).
#[test]
fn exact_sensitivities_are_carried() {
    let (plant, noise, run) = (plant(), noise(), run());
    let clocked = |by: f64| {
        let mut other = plant.clone();
        other.sensors.time_base += by;
        other
    };
    let step_s = |by: f64| Filter::new(&run, &PassSetting::plain(&clocked(by), &noise)).expect("a whole model").step_s;
    let by_clock = (step_s(1e-6) - step_s(-1e-6)) / 2e-6;
    // A number that moves the clock by 0.7 of itself.
    let columns = [
        SensitivityColumn::Declared(2),
        SensitivityColumn::Plant(Box::new(clocked(0.0021)), 0.003),
        SensitivityColumn::Declared(0),
    ];
    let f = Filter::new(&run, &PassSetting { columns: &columns, ..PassSetting::plain(&plant, &noise) }).expect("a whole model");
    let ready: Vec<Ready<'_>> = columns.iter().map(|c| ready(c, &plant).expect("a column")).collect();
    let (mut next, mut work) = (numbers(7), Work::new(&f));
    let (n, nm, nc) = (f.n, f.nm, f.nc);
    (0..f.states).for_each(|i| (0..f.states).for_each(|j| work.phi[i * n + j] = next()));
    work.gamma.iter_mut().for_each(|x| *x = next());
    // Positions and angles are not pushed.
    (6..nm).for_each(|i| (0..3).for_each(|j| work.push[i * nc + j] = next()));
    let rate: [f64; MOTION] = std::array::from_fn(|_| 10.0 * next());
    let mut s = vec![0.0; n * nc];
    (0..f.states).for_each(|i| (0..3).for_each(|j| s[i * nc + j] = next()));
    let of = |rows: usize, columns: usize, all: &[f64]| DMatrix::from_row_slice(rows, columns, all);
    let mut expected = of(n, n, &work.phi) * of(n, nc, &s);
    let pushed = of(nm, nm, &work.gamma) * of(MOTION, nc, &work.push).rows(0, nm);
    (0..nm).for_each(|i| (0..nc).for_each(|j| expected[(i, j)] += pushed[(i, j)]));
    (0..nm).for_each(|i| expected[(i, 1)] += by_clock * 0.7 * rate[i]);
    f.carry(&mut s, &ready, &rate, &mut work);
    let off = (of(n, nc, &s) - expected).amax();
    assert!(off < 1e-8, "{off}");
}

/// What columns push is what rates change by: a parameter, the tunnel speed and its instruments by differences of the rates; loads over a
/// variable by Newton's and Euler's laws, a body with apparent mass. Differences: 1e-5 squared, or 1e-6 of one to one side.
#[test]
fn exact_pushes_of_columns() {
    let (mut plant, noise, run) = (plant(), noise(), run());
    plant.vehicle.loose = None;
    plant.vehicle.apparent =
        ApparentMass { axial_kg: 0.1, radial_kg: 0.2, transverse_kg_m2: 0.003, unturned: 0.3, in_gusts: 0.6 };
    let mut scaled = plant.clone();
    (scaled.sensors.wind_scale, scaled.sensors.wind_delay_s) = (0.03 + 1e-6, 0.011 + 1e-6);
    let bases = [Basis::Height(3), Basis::Speed(2), Basis::Roll(3, true)];
    let columns = [
        SensitivityColumn::Generic(Site::Load(0), bases[0]),
        SensitivityColumn::Declared(1),
        SensitivityColumn::Generic(Site::Load(2), bases[1]),
        SensitivityColumn::Generic(Site::Load(4), bases[2]),
        SensitivityColumn::Generic(Site::Speed, bases[0]),
        SensitivityColumn::Plant(Box::new(scaled.clone()), 0.7e-6),
    ];
    let f = Filter::new(&run, &PassSetting { columns: &columns, ..PassSetting::plain(&plant, &noise) }).expect("a whole model");
    let mut ready: Vec<Ready<'_>> = columns.iter().map(|c| ready(c, &plant).expect("a column")).collect();
    let (k, mut work) = (4, Work::new(&f));
    let z = state(&f, &mut numbers(11));
    let (x, view) = (f.motion(&z), f.view(&z, k));
    let (air, added) = f.air(&z, k, Stage::Now, [0.0; 3]);
    let local = f.craft.local(&x, air, &added, &mut work.terms).expect("a state that flies");
    work.values.clone_from(&work.terms);
    f.push(&At { middle: x, air, added, local }, &mut ready, &view, &mut work).expect("a state that flies");
    let rates = |plant: &Plant, air: TunnelAir| {
        let craft = Craft::complete(plant).expect("a whole model");
        DVector::from_column_slice(&craft.rates(&x, air, &added, &mut Vec::new()).expect("a state that flies")[..STATES])
    };
    let by_value = slopes(&[0.0], |by| {
        let mut other = plant.clone();
        other.aero.values[1] += by[0];
        rates(&other, air)
    });
    let by_speed = slopes(&[0.0], |by| rates(&plant, TunnelAir { vw_m_s: air.vw_m_s + by[0], ..air }));
    let [speed, rate] = f.speed(&scaled, air.t_s);
    let by_scale = (rates(&plant, TunnelAir { vw_m_s: speed, vw_rate_m_s2: rate, ..air }) - rates(&plant, air)) / 0.7e-6;
    // Newton and Euler, forces and moments of dynamic pressure in body axes.
    let v = &plant.vehicle;
    let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), z[3])
        * Rotation3::from_axis_angle(&Vector3::y_axis(), z[4])
        * Rotation3::from_axis_angle(&Vector3::z_axis(), z[5]);
    let qs = 0.5 * air.density_kg_m3 * view.speed_m_s.powi(2) * TAU / 8.0 * v.diameter_m.powi(2);
    let values = bases.map(|b| b.value(&view));
    let inertia = v.inertia.matrix() + Matrix3::from_diagonal(&Vector3::new(0.0, 0.003, 0.003));
    let pushed = |force: Vector3<f64>, moment: Vector3<f64>| {
        let a = turned * force.component_div(&Vector3::new(v.mass_kg + 0.1, v.mass_kg + 0.2, v.mass_kg + 0.2));
        let w = inertia.try_inverse().expect("an inertia") * moment;
        DVector::from_fn(STATES, |i, _| {
            if i < 6 {
                0.0
            } else if i < 9 {
                a[i - 6]
            } else {
                w[i - 9]
            }
        })
    };
    let none = Vector3::zeros();
    let expected = [
        pushed(Vector3::new(qs * values[0], 0.0, 0.0), none),
        by_value.column(0).into_owned(),
        pushed(Vector3::new(0.0, 0.0, qs * values[1]), none),
        pushed(none, Vector3::new(0.0, qs * v.diameter_m * values[2], 0.0)),
        by_speed.column(0) * values[0],
        by_scale,
    ];
    for (j, expected) in expected.iter().enumerate() {
        for i in 0..STATES {
            let found = work.push[i * f.nc + j];
            assert!((found - expected[i]).abs() < 1e-5 * expected.amax(), "column {j}, {i}: {found} for {}", expected[i]);
        }
    }
}

/// A loose part swings as a damped oscillator under a constant force does (any textbook: about its rest, `e^{-ζωt}` times cosine and sine).
#[test]
fn exact_swing_of_a_loose_part() {
    let mut plant = plant();
    let l = LooseMass { mass_kg: 0.05, frequency_hz: 2.3, damping_ratio: 0.31, x_cm_m: 0.04, in_full: 1.0 };
    plant.vehicle.loose = Some(l);
    let (w, zeta, h) = (TAU * 2.3, 0.31, 0.037);
    let (x, v, force) = ([0.013, -0.021], [0.17, 0.4], [1.9, -3.1]);
    let mut part = [x[0], x[1], v[0], v[1]];
    let mut moved = [f64::NAN; MOTION];
    for k in 0..2 {
        moved[STATES + 2 + k] = force[k] - w * w * x[k] - 2.0 * zeta * w * v[k];
    }
    swing(&mut part, &moved, &plant, h);
    let damped = w * (1.0 - zeta * zeta).sqrt();
    let (decay, (sin, cos)) = ((-zeta * w * h).exp(), (damped * h).sin_cos());
    for k in 0..2 {
        let rest = force[k] / (w * w);
        let off = x[k] - rest;
        let place = rest + decay * (off * cos + (v[k] + zeta * w * off) / damped * sin);
        let rate = decay * (v[k] * cos - (zeta * w * v[k] + w * w * off) / damped * sin);
        assert!((part[k] - place).abs() < 1e-14 && (part[2 + k] - rate).abs() < 1e-12, "{k}: {part:?} for {place} {rate}");
    }
}

/// Unresolved gusts are as large as their part of the variance, and their signs over four nodes do not let axes mix.
#[test]
fn law_spread_does_not_mix_axes() {
    let (plant, noise, run) = (plant(), noise(), run());
    let f = Filter::new(&run, &PassSetting { unseen: 0.7, ..PassSetting::plain(&plant, &noise) }).expect("a whole model");
    let mut p = vec![0.0; f.n * f.n];
    for (axis, at) in [MOTION, MOTION + 3, MOTION + 6].into_iter().enumerate() {
        p[at * f.n + at] = [0.3, 0.5, 0.2][axis];
    }
    let all: Vec<Vector3<f64>> = (0..4).map(|k| Vector3::from(f.spread(&p, k))).collect();
    let mean = all.iter().map(|s| s * s.transpose()).sum::<Matrix3<f64>>() / 4.0;
    assert!((mean - Matrix3::from_diagonal(&Vector3::new(0.21, 0.35, 0.14))).amax() < 1e-15, "{mean}");
}

/// A number that differs from run to run moves the motion over a step as a plant with that number does: to the second order in the number, 0.01.
#[test]
fn law_a_number_moves_the_motion_as_its_plant_does() {
    let none = RunScatter::default();
    for scatter in
        [RunScatter { mass: 0.02, ..none }, RunScatter { attachment_m: 0.01, ..none }, RunScatter { aero: 0.1, ..none }]
    {
        let (mut plant, noise, run) = (plant(), noise(), run());
        plant.scatter = scatter;
        let moved = number_plants(&plant);
        let step = |plant: &Plant, by: f64| {
            let setting = PassSetting { numbers: &moved, ..PassSetting::plain(plant, &noise) };
            let f = Filter::new(&run, &setting).expect("a whole model");
            let (mut z, view) = (f.start(), f.view(&f.start(), 3));
            z[f.numbers[0].0] = by;
            f.predict(3, &mut z, &mut vec![0.0; f.n * f.n], &mut Vec::new(), &mut [], &view, &mut [], &mut Work::new(&f))
                .expect("a state that flies");
            DVector::from_column_slice(&z[..f.nm])
        };
        let mut other = plant.clone();
        other.change(plant.scatter.numbers()[0].0, 0.01);
        let still = step(&plant, 0.0);
        let (by_state, by_plant) = (step(&plant, 0.01) - &still, step(&other, 0.0) - &still);
        assert!((&by_state - &by_plant).amax() < 0.03 * by_plant.amax(), "{by_state} {by_plant}");
    }
}
