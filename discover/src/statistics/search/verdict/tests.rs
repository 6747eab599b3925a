//! discover tests: intervals, distributions and scores of what was found, by hand.

use super::super::tests::{gusts, with_search};
use super::*;
use crate::statistics::hypothesis::Hypothesis;
use crate::statistics::{FigureQuantity, Moment};
use windfall_model::Acts;
use windfall_model::effects::find;

/// Intervals are 1.96 standard errors of the place on either side within [0, 1], then values: four decades for a strength of either sign,
/// the logarithm for a scale. Wider than half the range is not decided; a shape that is held keeps its plausible range, a strength
/// that is off is no parameter.
#[test]
fn exact_intervals_of_parameters() {
    let effect = |family| find(family, Acts::Lander).expect("an effect of the catalogue");
    let mut h = Hypothesis::none(2.0).with(effect("turbulence")).with(effect("asymmetry"));
    let mut k = 0;
    while h.value(4, 1.0) > 0.0 {
        h.cover(4, k, &mut vec![0.0; 8]);
        k += 1;
    }
    let h = h.without(0).holding(3, 0.9).without(6).without(7);
    let f = Found { h, x: vec![0.0, 0.8, 0.35, 0.0, 0.45, 0.9, 0.0, 0.0], misfit: 0.0 };
    let found = parameters(&f, &[0.1, 0.1276, 0.05, 0.2]);
    let names: Vec<&str> = found.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["lateral_rms_m_s", "axial_scale_m", "lateral_scale_m", "Cm_0", "Cn_0"]);
    let strength = |end: f64, x: f64| end * 10.0_f64.powf(4.0 * (x - 1.0));
    let scale = |x: f64| 0.05 * 200.0_f64.powf(x);
    let sign = f.h.value(5, 1.0) / 0.5;
    let other = [strength(0.5 * sign, 0.9 - 0.2 * NORMAL_95), strength(0.5 * sign, 1.0)];
    let expected = [
        (strength(2.0, 0.8), [strength(2.0, 0.8 - 0.1 * NORMAL_95), strength(2.0, 0.8 + 0.1 * NORMAL_95)], true),
        (scale(0.35), [scale(0.35 - NORMAL_95 * 0.1276), scale(0.35 + NORMAL_95 * 0.1276)], false),
        (0.9, [0.05, 10.0], false),
        (strength(-0.5, 0.45), [strength(-0.5, 0.45 + 0.05 * NORMAL_95), strength(-0.5, 0.45 - 0.05 * NORMAL_95)], true),
        (strength(0.5 * sign, 0.9), if sign < 0.0 { [other[1], other[0]] } else { other }, true),
    ];
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    for (e, (estimate, [low, high], decided)) in found.iter().zip(expected) {
        assert!(near(e.estimate, estimate) && near(e.ci95[0], low) && near(e.ci95[1], high), "{e:?}");
        assert_eq!(e.decided, decided, "{}", e.name);
    }
}

/// Four runs: mean 3.5, variance 11/3; the 5 % quantile is 0.15 of the way from the least to the next.
#[test]
fn exact_distribution_over_runs() {
    let figure =
        |test| StatisticFigure { quantity: FigureQuantity::Theta, statistic: Moment::Mean, test, simulation: None, fitted: true };
    let rows = [[6.0, 1.2], [2.0, 1.2], [4.0, 1.2], [2.0, 1.3]].map(Vec::from).to_vec();
    let [one, two] = &over(&[figure(4.9), figure(1.5)], &rows)[..] else { panic!("two figures") };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-14;
    assert!(near(one.mean, 3.5) && near(one.std, (11.0_f64 / 3.0).sqrt()) && near(one.relative, 3.5 / 4.9 - 1.0), "{one:?}");
    assert!(near(one.central90[0], 2.0) && near(one.central90[1], 5.7) && one.inside && !two.inside, "{one:?} {two:?}");
    assert!(near(one.quantiles[0], 2.0) && near(one.quantiles[15], 4.5) && near(one.quantiles[20], 6.0));
}

/// The score is `dᵀ Σ⁻¹ d + ln |Σ|` of two figures, written out, and two for each direction that the parameters decide; what instruments
/// and smoothing change is the ratio of sums over runs.
#[test]
fn exact_score_and_processing() {
    with_search(|s| {
        let f = gusts();
        let judged = s.judge(&f).expect("flies");
        let n = judged.rows.len() as f64;
        let logs: Vec<[f64; 2]> = judged.rows.iter().map(|r| [r[0].ln(), r[1].ln()]).collect();
        let mean = [0, 1].map(|i| logs.iter().map(|l| l[i]).sum::<f64>() / n);
        let product = |i: usize, k: usize| {
            logs.iter().map(|l| (l[i] - mean[i]) * (l[k] - mean[k])).sum::<f64>() / (n - 1.0) + if i == k { 1e-8 } else { 0.0 }
        };
        let [xx, xy, yy] = [product(0, 0), product(0, 1), product(1, 1)];
        let [x, y] = [2.9_f64.ln() - mean[0], 14.0_f64.ln() - mean[1]];
        let determinant = xx * yy - xy * xy;
        let surprise = (yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant + determinant.ln();
        let e = &judged.explanation;
        let decided = (2 - e.degrees) as f64;
        assert!(decided > 0.0);
        assert!((e.score - surprise - 2.0 * decided).abs() < 1e-8 * surprise.abs().max(1.0), "{} {surprise} {decided}", e.score);

        let (rows, _) = s.fly(&f.h, &f.x, 0..4).expect("flies");
        let truth = true_runs(s.setup, &f.h.plant(&s.setup.plant, &f.x), 0..4).expect("flies");
        for (i, change) in s.processing(&f).expect("flies").into_iter().enumerate() {
            let [a, b] = [&rows, &truth].map(|rows| (0..4).map(|run| rows[run][i]).sum::<f64>());
            assert!((b * (1.0 + change) - a).abs() < 1e-12 * a && change.abs() < 0.5, "{i}: {change}");
        }
    });
}
