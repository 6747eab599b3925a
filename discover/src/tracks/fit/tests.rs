//! discover tests: fits of a number that parabolas are linear in, against dense generalised least squares.

use super::super::bins::BIN;
use super::super::model::EffectInstance;
use super::super::tests::{ball, brick, campaign, close, thrown, times, wiggle};
use super::*;
use nalgebra::SVector;
use windfall_model::{CATALOGUE, Campaign, Constant, Effect, Measured, PointRecord};

fn gravity(std: f64) -> Constant {
    Constant { key: "g", component: "", unit: "m/s2", lens: |p| Some(&mut p.environment.gravity_m_s2), std }
}

fn model(std: f64, components: usize) -> TrackModel {
    TrackModel {
        declared: vec![0.0],
        priors: Vec::new(),
        constants: vec![(gravity(std), 0.0)],
        effects: Vec::new(),
        generic: vec![0.0; components],
        scatter: None,
    }
}

/// Throws where gravity is 0.4 m/s² more than declared, with errors.
fn throws() -> Campaign {
    let one = |k: usize| {
        let t_s = times(9 + k, 0.0, 1.3);
        let mut record = thrown(&t_s, &[0], [3.0, 0.0, 0.0], [-4.0, 0.0, 0.0]);
        let errors = wiggle(&t_s, 0.05, k as f64, true);
        let down = record.position_m[0].as_mut().expect("measured");
        down.iter_mut().zip(&t_s).zip(errors).for_each(|((x, t), e)| *x += 0.2 * t * t + e);
        (Vec::new(), record)
    };
    campaign(ball(0.0), &[], (0..3).map(one).collect())
}

fn evidence_of(c: &Campaign) -> TrackEvidence {
    TrackEvidence::new(c, &(0..c.runs.len()).collect::<Vec<_>>(), &c.plant).expect("flies")
}

/// One step of gravity from a model, and its variance.
fn stepped(problem: &Problem, h: &mut TrackModel) -> (Result<Moved, Undetermined>, f64) {
    let at = problem.weighed(h).expect("flies");
    let mut fit = TrackFit {
        hypothesis: h.clone(),
        free: Vec::new(),
        covariance: DMatrix::zeros(0, 0),
        log_likelihood: 0.0,
        residual: Vec::new(),
        stop: StopReason::Iterations,
    };
    let moved = problem.iterate(h, &[Free::Constant(0)], &at, &mut fit);
    (moved, fit.covariance[(0, 0)])
}

/// Slopes by gravity are what −½t² leaves of a place and a velocity; then one step to the optimum with the prior, its variance, and
/// whether it was a hundredth of a standard error.
#[test]
fn exact_step_of_gravity_is_generalised_least_squares() {
    let c = throws();
    let evidence = evidence_of(&c);
    let problem = Problem { evidence: &evidence, base: &c.plant, declared: &[false] };
    let free = [Free::Constant(0)];
    for std in [0.7, 0.05] {
        let mut h = model(std, evidence.components());
        let z = evidence.residual(&c.plant);
        let column = &problem.columns(&h, &free, &z)[0];
        // Without a basis: squares of both are those of what is left of ½t² and of the record in time.
        let mut dense = [0.0; 2];
        for k in 0..3 {
            let t_s = times(9 + k, 0.0, 1.3);
            let n = t_s.len();
            let lines = DMatrix::from_fn(n, 2, |i, j| if j == 0 { 1.0 } else { t_s[i] });
            let left = |x: DVector<f64>| -> DVector<f64> {
                &x - &lines * (lines.transpose() * &lines).try_inverse().expect("regular") * lines.transpose() * &x
            };
            let push = left(DVector::from_fn(n, |i, _| 0.5 * t_s[i] * t_s[i]));
            let record =
                left(DVector::from_fn(n, |i, _| 0.2 * t_s[i] * t_s[i]) + DVector::from_vec(wiggle(&t_s, 0.05, k as f64, true)));
            dense[0] += push.norm_squared();
            dense[1] -= push.dot(&record);
        }
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
        close(dot(column, column), dense[0], 1e-7);
        close(dot(column, &z), dense[1], 1e-7);
        let (_, sigma) = problem.fit_sizes(&mut h.clone(), &z);
        let mut normal = [std.powi(-2), 0.0];
        for (b, s) in sigma.iter().enumerate() {
            let of = |x: &[f64]| SVector::<f64, BIN>::from_column_slice(&x[b * BIN..(b + 1) * BIN]);
            let weighted = s.try_inverse().expect("positive") * of(column);
            normal[0] += weighted.dot(&of(column));
            normal[1] += weighted.dot(&of(&z));
        }
        let (moved, covariance) = stepped(&problem, &mut h);
        close(h.get(free[0]), -normal[1] / normal[0], 1e-9);
        close(covariance * normal[0], 1.0, 1e-9);
        assert!(matches!(moved, Ok(Moved::Further(_))), "{} of {}", h.get(free[0]), normal[0].powf(-0.5));
    }
}

/// From two parts in a hundred of a standard error off the optimum a step leads further, from half a part it does not. Sizes of the
/// unmodelled residual are found to a gain of 0.02, so that the optimum itself moves by a thousandth of that error or so.
#[test]
fn exact_settled_is_a_hundredth_of_a_standard_error() {
    let c = throws();
    let evidence = evidence_of(&c);
    let problem = Problem { evidence: &evidence, base: &c.plant, declared: &[false] };
    let free = [Free::Constant(0)];
    let mut h = model(0.05, evidence.components());
    let step = |h: &mut TrackModel| {
        let (moved, variance) = stepped(&problem, h);
        (moved.map_err(|_| ()).expect("determined"), variance.sqrt())
    };
    (0..6).for_each(|_| drop(step(&mut h)));
    let (_, std) = step(&mut h);
    let best = h.get(free[0]);
    for (departure, settled) in [(0.02 * std, false), (0.005 * std, true)] {
        h.set(free[0], best + departure);
        let (moved, _) = step(&mut h);
        close(h.get(free[0]), best, 3e-3 * std);
        assert_eq!(matches!(moved, Moved::Settled), settled, "{departure}");
    }
}

/// A fit's log-likelihood is that of its evidence, as it is predicted, and that of the prior: gravity is found within the prior,
/// whose density falls by half a square of what it is off by.
#[test]
fn law_likelihood_of_a_fit_has_the_prior_in_it() {
    let c = throws();
    let evidence = evidence_of(&c);
    let problem = Problem { evidence: &evidence, base: &c.plant, declared: &[false] };
    let fit = problem.fit(&model(0.2, evidence.components()), false);
    let off = fit.hypothesis.get(Free::Constant(0));
    assert!((0.2..0.45).contains(&off) && fit.stop == StopReason::Converged, "{off} {:?}", fit.stop);
    // Sizes are found until a round gains 0.02.
    close(fit.log_likelihood, problem.predictive(&sure(&fit)) - 0.5 * (off / 0.2).powi(2), 0.05);
}

/// The same fit as if it knew all its numbers.
fn sure(fit: &TrackFit) -> TrackFit {
    TrackFit { covariance: fit.covariance.map(|_| 0.0), ..fit.clone() }
}

/// Throws that a fit of others has not seen, averaged over what it leaves of gravity: the same by quadrature, in steps of a fortieth of its error.
#[test]
fn exact_predictive_density() {
    let c = throws();
    let [seen, unseen] = [[0, 1].as_slice(), &[2]].map(|runs| TrackEvidence::new(&c, runs, &c.plant).expect("flies"));
    let of = |evidence| Problem { evidence, base: &c.plant, declared: &[false] };
    let fit = of(&seen).fit(&model(0.2, seen.components()), false);
    let problem = of(&unseen);
    for std in [fit.std_error(Free::Constant(0)), 2.0] {
        let fit = TrackFit { covariance: DMatrix::from_element(1, 1, std * std), ..fit.clone() };
        let at = |u: f64| {
            let mut moved = sure(&fit);
            moved.hypothesis.set(Free::Constant(0), fit.hypothesis.get(Free::Constant(0)) + std * u);
            problem.predictive(&moved) - 0.5 * u * u
        };
        let values: Vec<f64> = (-320..=320).map(|k| at(f64::from(k) / 40.0)).collect();
        let top = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = values.iter().map(|v| (v - top).exp()).sum();
        close(problem.predictive(&fit), top + (sum / 40.0 / std::f64::consts::TAU.sqrt()).ln(), 1e-3);
    }
}

/// Nine falls of a brick whose pushes differ, six numbers of each: weights are their own covariance about none, and a variance is
/// that of generalised least squares by Rao's factor of nine runs, `9·7/(3·2)`.
#[test]
fn exact_variance_of_poses_is_held_back_by_few_runs() {
    let one = |r: usize| {
        let t_s = times(9, 0.0, 1.3);
        let mut record = PointRecord {
            measured: Measured::Pose,
            attitude: vec![[1.0, 0.0, 0.0, 0.0]; 9],
            ..thrown(&t_s, &[0, 1, 2], [3.0, 1.0, -2.0], [-4.0, 0.0, 5.0])
        };
        for (k, series) in record.position_m.iter_mut().flatten().enumerate() {
            series.iter_mut().zip(&t_s).for_each(|(x, t)| *x += 0.3 * (1.0 + 2.3 * r as f64 + k as f64).sin() * t * t);
        }
        (Vec::new(), record)
    };
    let c = campaign(brick(), &[], (0..9).map(one).collect());
    let evidence = evidence_of(&c);
    let problem = Problem { evidence: &evidence, base: &c.plant, declared: &[false] };
    let (mut h, free) = (model(50.0, 0), [Free::Constant(0)]);
    let z = evidence.residual(&c.plant);
    let columns = problem.columns(&h, &free, &z);
    let (moved, variance) = stepped(&problem, &mut h);
    assert!(moved.is_ok());
    let bin = |x: &[f64], r: usize| SVector::<f64, BIN>::from_column_slice(&x[r * BIN..(r + 1) * BIN]);
    let scatter = Between::of(&z, evidence.slow_numbers().expect("poses")).with_noise(evidence.noise());
    let information: f64 = (0..9)
        .map(|r| {
            let a = bin(&columns[0], r);
            a.dot(&(scatter[r].try_inverse().expect("positive") * a))
        })
        .sum();
    let expected = 10.5 / (information + 50.0_f64.powi(-2));
    close(variance / expected, 1.0, 1e-6);
}

/// Any number moves by delta; a shape by two fifths of itself at the most, and within its range.
#[test]
fn exact_steps_of_shapes_are_held_back() {
    let shaped = |e: &&Effect| (e.parameters)(&[]).iter().any(|p| matches!(p.role, Role::Shape(_)));
    let mut effect = EffectInstance::null(CATALOGUE.into_iter().find(shaped).expect("some effect has a shape"), &[]);
    let shape = effect.parameters.iter().position(|p| matches!(p.role, Role::Shape(_))).expect("a shape");
    (effect.parameters[shape].low, effect.parameters[shape].high) = (-10.0, 3.9);
    effect.values[shape] = 3.0;
    let mut h = model(0.7, 0);
    h.effects.push(effect);
    h.constants[0].1 = 0.3;
    let free = [Free::Constant(0), Free::Effect(0, shape)];
    for (delta, to) in [([0.2, 0.25], [0.5, 3.25]), ([0.2, 5.0], [0.5, 3.9]), ([-0.7, -5.0], [-0.4, 1.8])] {
        let mut moved = h.clone();
        let by = apply(&mut moved, &free, &DVector::from_row_slice(&delta));
        for k in 0..2 {
            close(moved.get(free[k]), to[k], 1e-15);
            close(by[k], to[k] - h.get(free[k]), 1e-15);
        }
    }
}

/// A strength whose best value is beyond its range is held at that end of it, from wherever the fit starts.
#[test]
fn exact_strengths_are_held_at_the_end_they_went_beyond() {
    let c = throws();
    let evidence = evidence_of(&c);
    let problem = Problem { evidence: &evidence, base: &c.plant, declared: &[false] };
    let push = CATALOGUE.into_iter().find(|e| e.family == "constant-acceleration").expect("in the catalogue");
    for start in [0.0, 0.05, -0.2] {
        let mut effect = EffectInstance::null(push, &[]);
        for p in &mut effect.parameters {
            (p.low, p.high) = (-0.3, 0.1);
        }
        effect.values[0] = start;
        let mut h = model(1e-6, evidence.components());
        h.effects.push(effect);
        let fit = problem.fit(&h, false);
        assert!(!fit.free.contains(&Free::Effect(0, 0)), "{start}");
        close(fit.hypothesis.effects[0].values[0], 0.1, 1e-15);
    }
}
