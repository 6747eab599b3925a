//! likelihood tests: scores and steps of random members' numbers against dense algebra, brute-force integrals and passes of their
//! own.

use super::*;
use crate::flown::{flown, flown_by};
use windfall_model::{Constant, Use};

/// SAGE in gusts along and across the stream, one of its declared parameters the only number beside their sizes and lengths: a
/// constant of that standard deviation, declared too large by as much as is given. The model has the gusts that are given.
pub(crate) fn gusty(values: &[f64], (off, std): (f64, f64)) -> (Engine, Model) {
    let (mut engine, mut model) = flown(1.2, "turbulence", &[0.3, 0.25, 0.3, 0.4, 0.0]);
    engine.campaign.declared.fill(false);
    engine.campaign.knowledge.constants =
        vec![Constant { key: "drag", component: "", unit: "-", lens: |p| p.aero.values.first_mut(), std }];
    model.declared[0] += off;
    model.members[0].values.copy_from_slice(values);
    (engine, model)
}

/// Slopes of normal innovations by two numbers, against derivatives by hand: an innovation `ν` of variance `v` moves by `dν` and by
/// `v dl`.
#[test]
fn exact_slopes_of_innovations() {
    let (v, nu) = ([[0.4, 0.0, 2.3], [1.7, 0.9, 0.3]], [[0.7, 0.0, -1.1], [0.2, -0.6, 0.8]]);
    let (d, l) = ([[0.3, 0.0, -0.9], [1.2, 0.4, -0.5]], [[-0.8, 0.0, 0.6], [0.35, 1.4, -0.2]]);
    let by = -0.03;
    let at = |by: f64| {
        let mut all = NodeInnovations::default();
        for k in 0..2 {
            let (mut whitened, mut variances) = ([0.0; windfall_model::POSE], [0.0; windfall_model::POSE]);
            for c in (0..3).filter(|&c| v[k][c] > 0.0) {
                variances[c] = v[k][c] * f64::exp(l[k][c] * by);
                whitened[c] = (nu[k][c] + d[k][c] * by) / variances[c].sqrt();
            }
            all.whitened.push(whitened);
            all.variances.push(variances);
            all.nodes.push([2.0, -3.0][k] + [0.7, -1.9][k] * by);
        }
        all
    };
    let found = slopes(&at(0.0), &at(by), by);
    let taken: Vec<(usize, usize)> = [(0, 0), (0, 2), (1, 0), (1, 1), (1, 2)].to_vec();
    assert_eq!(found.innovations.len(), taken.len());
    for (i, (k, c)) in taken.into_iter().enumerate() {
        assert!((found.innovations[i] - d[k][c] / v[k][c].sqrt()).abs() < 1e-12);
        assert!((found.variances[i] - l[k][c]).abs() < 1e-12);
    }
    assert!((found.likelihood[0] - 0.7).abs() < 1e-12 && (found.likelihood[1] + 1.9).abs() < 1e-12);
}

/// Expected information is the mean product of scores: of independent normal numbers, by a sum over a grid of each, which for a
/// Gaussian is exact.
#[test]
fn exact_information_is_the_mean_product_of_scores() {
    let of = |innovations: [f64; 2], variances: [f64; 2]| Slopes {
        innovations: innovations.to_vec(),
        variances: variances.to_vec(),
        likelihood: Vec::new(),
    };
    let (one, two) = (of([0.3, -1.2], [0.8, 0.45]), of([1.4, 0.7], [-0.6, 1.7]));
    let expected: f64 = (0..2)
        .map(|i| {
            // ln N of x = ν/√v: slopes by the mean and by ln v.
            let score = |s: &Slopes, x: f64| s.innovations[i] * x + 0.5 * s.variances[i] * (x * x - 1.0);
            let density = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
            (-40..=40).map(|k| 0.25 * f64::from(k)).map(|x| 0.25 * density(x) * score(&one, x) * score(&two, x)).sum::<f64>()
        })
        .sum();
    assert!((one.information(&two) - expected).abs() < 1e-12, "{} {expected}", one.information(&two));
}

/// A random number's range: of a size five decades below its largest, of a shape three or what is plausible; a step of it for
/// differences leads away from the upper end.
#[test]
fn exact_ranges_of_logarithms() {
    let (_, mut model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.0, 1.0));
    let p = &mut model.members[0].parameters;
    (p[0].high, p[2].high, p[3].low, p[3].high) = (0.7, 60.0, 0.05, 20.0);
    let ranges = [0, 2, 3].map(|i| log_range(&model, 0, i).map(f64::exp));
    for (found, expected) in ranges.into_iter().zip([[0.7e-5, 0.7], [0.06, 60.0], [0.05, 20.0]]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{found:?}");
    }
    for (value, sign) in [(0.3, 1.0), (0.7 * (1.0 - 1e-4), -1.0), (0.7, -1.0)] {
        model.members[0].values[0] = value;
        let (other, by) = moved(&model, (0, 0));
        assert!((by - sign * 1e-3).abs() < 1e-15);
        assert!(
            (other.members[0].values[0] / value - f64::exp(by)).abs() < 1e-12
                && other.members[0].values[1..] == model.members[0].values[1..]
        );
    }
}

/// The price of random numbers is half the logarithm of the determinant of `I + 9 M`, by eigenvalues of the information M, and that
/// of bursts where gusts act; none without such numbers.
#[test]
fn exact_price_of_random_numbers() {
    let (mut engine, model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.0, 1.0));
    let information = engine.random_slopes(&model, &[]).expect("a pass").information;
    let expected: f64 = information.symmetric_eigen().eigenvalues.iter().map(|x| 0.5 * (9.0 * x).ln_1p()).sum();
    assert!((engine.random_price(&model) - expected).abs() < 1e-9 * expected, "{} {expected}", engine.random_price(&model));
    engine.bursts_price = 0.7;
    assert!((engine.random_price(&model) - expected - 0.7).abs() < 1e-9 * expected);
    assert!(engine.random_price(&Model { members: Vec::new(), ..model }).abs() < 1e-300);
}

/// Slopes by random numbers, and what they and a number tell of each other: against passes with each moved, to a hundredth of their
/// standard deviation and, as the filter's gain is held in a number's column, a tenth of the largest that it may be.
#[test]
fn law_slopes_are_those_of_passes() {
    let (mut engine, model) = gusty(&[0.2, 0.4, 0.5, 0.3, 0.0], (0.05, 0.05));
    engine.exact_gusts = true;
    let numbers = engine.free(&model, false);
    let RandomSlopes { information, gradient, .. } = engine.random_slopes(&model, &numbers).expect("a pass");
    let of = |model: &Model| engine.sum(model, &[], &[]).expect("a pass");
    let base = of(&model);
    let mut there = model.clone();
    there.change(&numbers[0], numbers[0].step);
    let by_number = slopes(&base.runs[0].innovations, &of(&there).runs[0].innovations, numbers[0].step);
    let mut largest = 0.0_f64;
    for (k, &(m, i)) in random_numbers(&model).iter().enumerate() {
        let by = 1e-4_f64;
        let scaled = |by: f64| {
            let mut there = model.clone();
            there.members[m].values[i] *= by.exp();
            of(&there)
        };
        let (up, down) = (scaled(by), scaled(-by));
        let (slope, own) = ((up.log_likelihood - down.log_likelihood) / (2.0 * by), information[(1 + k, 1 + k)]);
        assert!((gradient[1 + k] - slope).abs() < 0.01 * own.sqrt(), "{k}: {} {slope}", gradient[1 + k]);
        let own_slopes = slopes(&base.runs[0].innovations, &up.runs[0].innovations, by);
        let cross = own_slopes.innovations.iter().zip(&by_number.innovations).map(|(a, b)| a * b).sum::<f64>();
        let most = (information[(0, 0)] * own).sqrt();
        assert!((information[(0, 1 + k)] - cross).abs() < 0.1 * most, "{k}: {} {cross} {most}", information[(0, 1 + k)]);
        largest = largest.max(cross.abs() / most);
    }
    assert!(largest > 0.25, "{largest}");
}

/// A step of scoring by a dense solve of the posterior's normal equations in the numbers' own units, and the gain that it promises.
fn dense(engine: &Engine, model: &Model, numbers: &[Number]) -> (DVector<f64>, f64) {
    let RandomSlopes { mut information, mut gradient, .. } = engine.random_slopes(model, numbers).expect("a pass");
    for i in 0..gradient.len() {
        let variance = numbers.get(i).map_or(9.0, |n| n.prior * n.prior);
        information[(i, i)] += 1.0 / variance;
        gradient[i] -= numbers.get(i).map_or(0.0, |n| n.value / variance);
    }
    let step = information.try_inverse().expect("positive definite") * &gradient;
    let expected = 0.5 * gradient.dot(&step);
    (step, expected)
}

/// How far a model has moved in its constants and the random numbers' logarithms.
fn departure(from: &Model, to: &Model) -> DVector<f64> {
    let logs = random_numbers(from).into_iter().map(|(m, i)| (to.members[m].values[i] / from.members[m].values[i]).ln());
    let all: Vec<f64> = to.constants.iter().zip(&from.constants).map(|(a, b)| a - b).chain(logs).collect();
    DVector::from_vec(all)
}

/// A step of scoring is that of a dense solve, whole near the top (where the prior takes more off than the step gains) and of 1.2
/// in the logarithm that moves most where far from it.
#[test]
fn exact_a_step_of_scoring() {
    for (values, constant, is_far) in [([0.25, 0.3, 0.3, 0.35, 0.0], -0.17, false), ([0.02, 0.02, 0.3, 0.35, 0.0], -0.1, true)] {
        let (engine, mut model) = gusty(&values, (0.2, 0.05));
        model.constants[0] = constant;
        let numbers = engine.free(&model, false);
        let (step, expected) = dense(&engine, &model, &numbers);
        let longest = step.rows(1, 4).amax();
        assert!(is_far == (longest > 1.2) && (is_far || expected < penalty(&numbers)), "{step} {expected}");
        let (next, found) = engine.scored_in(&model, &numbers).expect("a step");
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
        let whole = departure(&model, &next) - &step * (1.2 / longest).min(1.0);
        assert!(whole.amax() < 1e-9 * longest, "{whole} {step}");
    }
}

/// Random numbers that cannot move but for a hair's breadth down into their ranges.
fn held(model: &mut Model, above: f64) {
    for i in 0..4 {
        let value = model.members[0].values[i];
        let p = &mut model.members[0].parameters[i];
        (p.low, p.high) = (value, value);
        model.members[0].values[i] *= 1.0 + above;
    }
}

/// No step: where sizes that should grow stand above their ranges, a step takes them down and the likelihood with them, by less
/// than the prior of a number that stays where it is.
#[test]
fn law_no_step_lowers_the_posterior() {
    let (engine, mut model) = gusty(&[0.1, 0.1, 0.3, 0.4, 0.0], (0.05, 0.05));
    model.constants[0] = -0.2;
    let below = {
        let mut model = model.clone();
        held(&mut model, 0.0);
        model
    };
    held(&mut model, 1e-4);
    let of = |model: &Model| engine.sum(model, &[], &[]).expect("a pass").log_likelihood;
    let fall = of(&model) - of(&below);
    assert!(fall > 1e-3 && fall < penalty(&engine.free(&model, false)), "{fall}");
    assert!(engine.scored_in(&model, &[]).is_none());
}

/// A number that its prior draws far past the likelihood's top: the step is cut to 0.35 of itself, as often as passes of their own
/// say that the log posterior does not rise.
#[test]
fn law_a_step_is_cut_until_the_posterior_rises() {
    let (engine, mut model) = gusty(&[0.3, 0.25, 0.3, 0.4, 0.0], (0.0, 50.0));
    held(&mut model, 0.0);
    let top = engine.climb(&model, false, 6).expect("a fit");
    let std = top.covariance[(0, 0)].sqrt();
    model = top.model;
    model.constants[0] += 0.5 * std;
    let mut numbers = engine.free(&model, false);
    (numbers[0].value, numbers[0].prior) = (3.0 * std, std);
    let step = dense(&engine, &model, &numbers).0[0];
    let rises = |by: f64| {
        let mut next = model.clone();
        next.constants[0] += by;
        let of = |m: &Model| engine.sum(m, &[], &[]).expect("a pass").log_likelihood - penalty(&engine.free(m, false));
        of(&next) > of(&model)
    };
    assert!(!rises(step) && rises(0.35 * step));
    let (next, _) = engine.scored_in(&model, &numbers).expect("a step");
    assert!((departure(&model, &next)[0] / step - 0.35).abs() < 1e-3, "{} of {step}", departure(&model, &next)[0]);
}

/// Runs of SAGE, each of another seed, in which an effect of those strengths acts; and the model at half of them.
fn several(family: &str, values: &[f64]) -> (Engine, Model) {
    let flights = [(Use::Identify, 6.0, values); 4];
    let (engine, mut model) = flown_by(family, &flights);
    let engine = Engine::new(engine.campaign(), &[0, 1, 2, 3]).expect("tunnel runs");
    let member = &mut model.members[0];
    member.strengths().collect::<Vec<_>>().into_iter().for_each(|i| member.values[i] *= 0.5);
    (engine, model)
}

/// Drift of the instruments, and numbers that differ between four runs, are found from half their size, and runs without them are far less likely. Four
/// draws tell a standard deviation to 35 % a sigma, and drift of 30 s in 24 s has not many more: within a factor of three.
#[test]
fn recover_drift_and_what_differs_between_runs() {
    for (family, values) in [
        ("pose-drift", &[4e-3, 4e-3, 8e-3, 6e-3, 3e-3, 6e-3][..]),
        ("speed-drift", &[0.2]),
        ("mass-scatter", &[0.04]),
        ("attachment-scatter", &[0.02]),
        ("aero-scatter", &[0.1, 0.0]),
    ] {
        let (engine, model) = several(family, values);
        let none = engine.climb(&model.clone().calm(), false, 8).expect("a model that flies");
        let start = engine.climb(&model, false, 6).expect("a model that flies");
        let fit = engine.settle_random(&start, 12);
        let member = &fit.model.members[0];
        for i in member.strengths() {
            let ratio = member.values[i] / values[i];
            assert!((1.0 / 3.0..3.0).contains(&ratio), "{family} {i}: {ratio}");
        }
        assert!(fit.total > none.total + 10.0, "{family}: {} {}", fit.total, none.total);
        assert!(fit.chi < 1.1, "{family}: {}", fit.chi);
        let found = engine.by_run(&fit);
        if family == "mass-scatter" {
            assert_eq!(found.iter().map(|of| of.run).collect::<Vec<_>>(), [0, 1, 2, 3]);
            for of in found {
                let seed = windfall_sim::Seed { campaign: 8, run: of.run as u64 };
                let drawn = values[0] * seed.normals(windfall_sim::Channel::Number(0)).next().unwrap_or(0.0);
                assert!((of.value - drawn).abs() < 4.0 * of.std && of.std < 0.02, "{of:?} for {drawn}");
            }
        } else {
            assert_eq!(found.is_empty(), family.ends_with("drift"), "{family}");
        }
    }
}

/// A run's number is known as the filter knows it within the run, and by what the fit leaves of its own numbers: each moves the number's mean by
/// its slope. The filter's gain is held in a slope: a tenth of it.
#[test]
fn law_a_number_of_a_run_has_the_errors_of_the_fit() {
    let (engine, model) = flown_by("mass-scatter", &[(Use::Identify, 3.0, &[0.04])]);
    let mut fit = engine.climb(&model, false, 3).expect("a model that flies");
    let of = |fit: &Fit| engine.by_run(fit).remove(0);
    fit.covariance.fill(0.0);
    let alone = of(&fit);
    let mut largest = 0.0_f64;
    for (i, number) in fit.numbers.clone().iter().enumerate() {
        let std = number.step;
        let mut there = fit.clone();
        there.model.change(number, std);
        let moved = of(&there).value - alone.value;
        fit.covariance[(i, i)] = std * std;
        let added = of(&fit).std.powi(2) - alone.std.powi(2);
        fit.covariance[(i, i)] = 0.0;
        let (by_fit, by_model) = (added.max(0.0).sqrt(), moved.abs());
        let near = 0.1 * by_model + 1e-3 * alone.std;
        assert!((by_fit - by_model).abs() < near, "{i}: {by_fit} for {by_model} beside {}", alone.std);
        largest = largest.max(by_model / alone.std);
    }
    assert!(largest > 0.1, "{largest}");
}
