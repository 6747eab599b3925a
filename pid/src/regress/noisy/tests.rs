//! pid tests: noise in regressors against closed forms. In: few amplitudes, of which every weight is the same. Out: estimate, ratio, excess.

use super::*;
use crate::regress::spectral::solve;

fn amplitudes(n: usize, seed: f64) -> Vec<f64> {
    (0..n).map(|k| (seed + 1.7 * k as f64).sin() + 0.3 * (seed * k as f64).cos()).collect()
}

fn cosines(regressor: Vec<f64>, response: Vec<f64>) -> Cosines {
    Cosines { regressors: vec![regressor], response }
}

/// Twelve amplitudes have one mean square for a spectrum, so that weights fall out: `b = (Σxy − Σd_x d_y)/(Σxx − Σd_x d_x)`, means over
/// draws, and the ratio of powers `(Σxx − Σd_x d_x)/Σd_x d_x`. Rounding of a dozen products: 1e-12.
#[test]
fn exact_noise_is_taken_off_the_normal_equations() {
    let n = 12;
    let (x, y) = (amplitudes(n, 0.3), amplitudes(n, 0.9));
    let small = |seed| amplitudes(n, seed).into_iter().map(|v| 0.2 * v).collect::<Vec<_>>();
    let draws: Vec<Cosines> = [2.1, 3.3, 4.7].map(|s| cosines(small(s), small(s + 0.5))).into();
    let own = cosines(x.clone(), y.clone());
    let recorded = [Recorded { cosines: &own, draws: &draws }];
    let found = corrected(&recorded, &[0], |spectra| solve(&[&own], spectra, &[0])).expect("one column");
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mean = |of: &dyn Fn(&Cosines) -> f64| draws.iter().map(of).sum::<f64>() / 3.0;
    let (xx, xy) = (mean(&|d| sum(&d.regressors[0], &d.regressors[0])), mean(&|d| sum(&d.regressors[0], &d.response)));
    let b = (sum(&x, &y) - xy) / (sum(&x, &x) - xx);
    assert!((found.estimate[0] - b).abs() < 1e-12, "{} {b}", found.estimate[0]);
    assert!((found.signal_to_noise[0] - (sum(&x, &x) - xx) / xx).abs() < 1e-10, "{}", found.signal_to_noise[0]);
    // Scatter of Σ(x + d_x)(d_y − b d_x) over draws, over the square of what the estimate is divided by.
    let score = |d: &Cosines| (0..n).map(|k| (x[k] + d.regressors[0][k]) * (d.response[k] - b * d.regressors[0][k])).sum::<f64>();
    let middle = mean(&score);
    let variance = draws.iter().map(|d| (score(d) - middle).powi(2)).sum::<f64>() / 2.0 / (sum(&x, &x) - xx).powi(2);
    assert!((found.covariance[(0, 0)] / variance - 1.0).abs() < 1e-10);
    // Residuals far above what draws leave are no noise of theirs.
    assert!(found.excess > 5.0 && found.excess_p < 1e-3, "{} {}", found.excess, found.excess_p);
}

/// Without noise the estimate is that of exact regressors, every bit but rounding.
#[test]
fn exact_no_noise_changes_nothing() {
    let (x, y) = (amplitudes(40, 0.3), amplitudes(40, 0.9));
    let own = cosines(x, y);
    let none = vec![cosines(vec![0.0; 40], vec![0.0; 40]); 2];
    let fit = |spectra: &[Vec<f64>]| solve(&[&own], spectra, &[0]);
    let found = corrected(&[Recorded { cosines: &own, draws: &none }], &[0], fit).expect("one column");
    assert!(found.signal_to_noise[0].is_infinite());
    let mut estimate = fit(&[vec![1.0; 40]]).expect("one column").0;
    for _ in 0..ROUNDS {
        estimate = fit(&[spectrum(&residual(&own, &[0], &estimate))]).expect("one column").0;
    }
    assert!((found.estimate[0] - estimate[0]).abs() < 1e-14);
}
