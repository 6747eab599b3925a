//! likelihood tests: a changing variance of gusts against dense matrices and differences.

use super::*;
use crate::filter::{Keep, PassSetting, pass};
use crate::flown::flown;
use crate::noise::declared;
use crate::run::Prepared;
use crate::shock::{Innovation, Taken};
use nalgebra::{DMatrix, DVector};
use windfall_model::{CATALOGUE, Flight, POSE};
use windfall_sim::Seed;

/// Slopes by the logarithms are those of the filter's log-likelihood by central differences, of both forms of gusts, where their
/// variance changes already, within 0.03 of what the data leave of them: a gust that is not known bends the motion by the square of
/// its size.
#[test]
fn exact_slopes() {
    let file = windfall_scenarios::read_bundled("sage-unperturbed").expect("a bundled scenario");
    let turbulence = CATALOGUE.iter().find(|e| e.family == "turbulence").expect("an effect of the catalogue");
    for bandwidth in [0.0, 1.5] {
        let mut plant = file.declared_plant.clone();
        (turbulence.apply)(&mut plant, &[0.01, 0.01, 0.4, 0.4, bandwidth]);
        let flight = Flight { duration_s: 4.0, ..file.scenario.flights[0].clone() };
        let record = windfall_sim::fly(&plant, &flight, Seed { campaign: 5, run: 0 }).expect("a flight").record;
        let noise = declared(&plant.sensors);
        let mut run = Prepared::new(0, "short", &record, plant.environment.gas_constant_j_kg_k, 0.02, &noise[POSE]);
        for logs in &mut run.intensity.logs {
            *logs = (0..9).map(|k| 0.5 * f64::from(k).sin()).collect();
        }
        let passed =
            |run: &Prepared, keep: Keep| pass(run, &PassSetting { keep, ..PassSetting::plain(&plant, &noise) }).expect("a pass");
        let seen = passed(&run, Keep::Gusts);
        let found = slopes(run.duration_s(), &seen.trace, seen.states);
        for (axis, found) in found.iter().enumerate() {
            let found = found.as_ref().expect("a gust");
            // The first knot's logarithm is also that of the start, whose slope is not the step's.
            for knot in 1..8 {
                let at = |by: f64| {
                    let mut moved = run.clone();
                    moved.intensity.logs[axis][knot] += by;
                    passed(&moved, Keep::Nothing).log_likelihood
                };
                let expected = (at(1e-3) - at(-1e-3)) / 2e-3;
                let (slope, std) = (found.gradient[knot], found.own[knot].sqrt());
                assert!((slope - expected).abs() < 0.03 * std, "{bandwidth} {axis} {knot}: {slope} for {expected}, {std}");
            }
        }
    }
}

/// Likeliest logarithms, gain and price are those of full matrices.
#[test]
fn exact_posterior() {
    let (std, memory_s) = (0.8, 0.7);
    let slopes = Slopes { gradient: vec![1.0, -2.0, 4.0, 0.5], own: vec![2.0, 3.0, 1.5, 1.0], next: vec![0.5, 0.4, 0.3] };
    let local = Local { run: 0, axis: 0, logs: vec![0.1, -0.2, 0.5, 0.0], slopes };
    let information = DMatrix::from_fn(4, 4, |i, k| match i.abs_diff(k) {
        0 => local.slopes.own[i],
        1 => local.slopes.next[i.min(k)],
        _ => 0.0,
    });
    let prior = DMatrix::from_fn(4, 4, |i, k| std * std * (-KNOT_S * i.abs_diff(k) as f64 / memory_s).exp());
    let linear = DVector::from_column_slice(&local.slopes.gradient) + &information * DVector::from_column_slice(&local.logs);
    let inverse = prior.clone().try_inverse().expect("a covariance");
    let expected = (&information + &inverse).lu().solve(&linear).expect("a posterior");
    let volume = 0.5 * (&information * &prior + DMatrix::identity(4, 4)).determinant().ln();
    let found = local.posterior(Process::new(std, memory_s));
    assert!((DVector::from_vec(found.logs) - &expected).amax() < 1e-12);
    assert!((found.gain - (0.5 * linear.dot(&expected) - volume)).abs() < 1e-12);
    // The root of the mean variance, by the whole covariance.
    let weights = DVector::from_iterator(4, local.logs.iter().map(|x| x.exp()));
    let covariance = (&information + &inverse).try_inverse().expect("a posterior");
    let expected_std = 0.5 * (weights.dot(&(covariance * &weights))).sqrt() / weights.sum();
    assert!((mean_std(&[local], Process::new(std, memory_s), &[0]) - expected_std).abs() < 1e-12);
    assert!((found.price - (0.5 * expected.dot(&(&inverse * &expected)) + volume)).abs() < 1e-12);
}

/// A state that decays, driven at each step and seen in noise: slopes by the logarithms of the driving variances and their
/// information, `½ tr V⁻¹ V_k` each, by one normal law of all samples; a step's share of a knot falls linearly to the next.
#[test]
fn exact_slopes_and_information_of_one_state() {
    let (kept, seen, noise, driven, first) = (0.8, 1.3, 0.4, 0.7, 0.9);
    let (t_s, y) = ([0.05, 0.3, 0.65, 0.95, 1.2], [0.9, -1.4, 0.8, 2.3, -0.6]);
    let (mut x, mut p, mut nodes) = (0.0, first, Vec::new());
    for k in 0..5 {
        let (ph, value) = (p * seen, y[k] - seen * x);
        let variance = seen * ph + noise;
        let channels = vec![Innovation { slope: vec![seen], covariance: vec![ph], value, variance, columns: Vec::new() }];
        let gusts = vec![GustNoise { axis: 2, states: vec![0], added: vec![driven] }];
        let (phi, gusts) = if k < 4 { (vec![kept], gusts) } else { (Vec::new(), Vec::new()) };
        nodes.push(Taken { t_s: t_s[k], channels, phi, gusts, blowing: Vec::new() });
        (x, p) = (kept * (x + ph * value / variance), kept * kept * (p - ph * ph / variance) + driven);
    }
    let found = slopes(1.2, &Trace { nodes }, 1);
    assert!(found[0].is_none() && found[1].is_none());
    let found = found[2].as_ref().expect("a gust");

    let power = |k: usize| kept.powi(i32::try_from(k).expect("few"));
    let by = |k: usize| DVector::from_fn(5, |j, _| if j > k { seen * power(j - k - 1) } else { 0.0 });
    let start = DVector::from_fn(5, |j, _| seen * power(j));
    let steps: Vec<DMatrix<f64>> = (0..4).map(|k| by(k) * by(k).transpose() * driven).collect();
    let whole = &start * start.transpose() * first + DMatrix::identity(5, 5) * noise + steps.iter().sum::<DMatrix<f64>>();
    let inverse = whole.try_inverse().expect("a covariance");
    let u = &inverse * DVector::from_column_slice(&y);
    let share = |k: usize, knot: usize| (1.0 - (t_s[k] / KNOT_S - knot as f64).abs()).max(0.0);
    let information = |k: usize| 0.5 * SEEN_TWICE * (&inverse * &steps[k]).trace();
    assert_eq!((found.gradient.len(), found.own.len(), found.next.len()), (4, 4, 3));
    for knot in 0..4 {
        let sum = |of: &dyn Fn(usize) -> f64| (0..4).map(|k| share(k, knot) * of(k)).sum::<f64>();
        let slope = sum(&|k| 0.5 * ((&steps[k] * &u).dot(&u) - (&inverse * &steps[k]).trace()));
        let own = sum(&|k| share(k, knot) * information(k));
        let next = sum(&|k| share(k, knot + 1) * information(k));
        assert!((found.gradient[knot] - slope).abs() < 1e-13 && (found.own[knot] - own).abs() < 1e-13, "{knot}");
        assert!((found.next.get(knot).copied().unwrap_or(0.0) - next).abs() < 1e-13, "{knot}");
    }
}

/// The score for a changing variance is the slope by the process' variance s, at zero, of the marginal likelihood, by differences:
/// `½ s gᵀ K (1 + s I K)⁻¹ g - ½ ln |1 + s I K|` with the information I lumped on its diagonal; its variance is `½ tr (K I)²`. Runs
/// add up, and the memory counts at which it stands out more.
#[test]
fn exact_score_of_a_changing_variance() {
    let local = |gradient: &[f64], own: &[f64], next: &[f64]| Local {
        run: 0,
        axis: 0,
        logs: vec![0.0; own.len()],
        slopes: Slopes { gradient: gradient.to_vec(), own: own.to_vec(), next: next.to_vec() },
    };
    let locals = [
        local(&[1.0, -2.0, 4.0, 3.5], &[2.0, 3.0, 1.5, 1.2], &[0.5, 0.4, 0.3]),
        local(&[-3.0, -2.5, 0.7], &[1.3, 2.2, 1.7], &[0.2, 0.6]),
    ];
    let expected = |l: &Local, memory_s: f64| {
        let Slopes { gradient, own, next } = &l.slopes;
        let n = own.len();
        let full = DMatrix::from_fn(n, n, |i, k| match i.abs_diff(k) {
            0 => own[i],
            1 => next[i.min(k)],
            _ => 0.0,
        });
        let lumped = DMatrix::from_diagonal(&(full * DVector::from_element(n, 1.0)));
        let k = DMatrix::from_fn(n, n, |i, k| (-(i.abs_diff(k) as f64) * KNOT_S / memory_s).exp());
        let g = DVector::from_column_slice(gradient);
        let marginal = |s: f64| {
            let whole = DMatrix::identity(n, n) + &lumped * &k * s;
            let solved = whole.clone().lu().solve(&g).expect("near one");
            0.5 * (s * g.dot(&(&k * solved)) - whole.determinant().ln())
        };
        let both = &k * &lumped;
        ((marginal(1e-5) - marginal(-1e-5)) / 2e-5, 0.5 * (&both * &both).trace())
    };
    let mut largest = f64::NEG_INFINITY;
    for memory_s in [1.0, 2.5] {
        let (mut score, mut variance) = (0.0, 0.0);
        for l in &locals {
            let (found, expected) = (l.score(memory_s), expected(l, memory_s));
            // Third derivatives of order 1e4 times h²/6; rounding over h.
            assert!((found.0 - expected.0).abs() < 1e-5 && (found.1 - expected.1).abs() < 1e-12, "{found:?} {expected:?}");
            (score, variance) = (score + expected.0, variance + expected.1);
        }
        largest = largest.max(score / variance.sqrt());
    }
    assert!((standing_out(&locals).expect("memories") - largest).abs() < 1e-5);
}

/// A step ends where it leads unless that is farther than the longest step, or than the farthest logarithm.
#[test]
fn exact_steps_of_a_logarithm() {
    for (from, to, by, next) in
        [(0.3, 0.7, 0.4, 0.7), (0.3, -4.0, -1.0, -0.7), (0.3, 4.0, 1.0, 1.3), (-5.8, -9.0, -1.0, -6.0), (5.8, 9.0, 1.0, 6.0)]
    {
        let found = towards(from, to);
        assert!((found.0 - by).abs() < 1e-15 && (found.1 - next).abs() < 1e-15, "{found:?}");
    }
}

/// Sizes of gusts, the square root of their variance: of 1 to 101 a twentieth lies below 6, nineteen twentieths below 96. About
/// their mean the axial variances have the mean one, and so have the lateral ones of all runs together; their ratios stay.
#[test]
fn exact_sizes_and_their_mean() {
    let (mut engine, _) = flown(0.5, "turbulence", &[0.3, 0.3, 0.6, 0.6, 0.0]);
    assert!(engine.bursts().is_none());
    engine.runs.push(engine.runs[0].clone());
    let size = |k: usize| 2.0 * ((37 * k % 101 + 1) as f64).ln();
    engine.runs[0].intensity.logs = [(0..10).map(size).collect(), (10..40).map(size).collect(), (40..60).map(size).collect()];
    engine.runs[1].intensity.logs = [(60..75).map(size).collect(), (75..80).map(size).collect(), (80..101).map(size).collect()];
    let [low, high] = engine.bursts().expect("sizes");
    assert!((low - 6.0).abs() < 1e-12 && (high - 96.0).abs() < 1e-12, "{low} {high}");
    let before = engine.clone();
    engine.about_their_mean();
    for axes in AXES {
        let logs = |e: &Engine| -> Vec<f64> {
            e.runs.iter().flat_map(|r| axes.iter().flat_map(|a| r.intensity.logs[*a].clone())).collect()
        };
        let (found, given) = (logs(&engine), logs(&before));
        let mean = found.iter().map(|log| log.exp()).sum::<f64>() / found.len() as f64;
        assert!((mean - 1.0).abs() < 1e-12, "{mean}");
        assert!(found.iter().zip(&given).all(|(f, g)| (f - found[0] - (g - given[0])).abs() < 1e-12));
    }
}
