//! pid tests: least squares against closed forms and chance. In: made-up series. Out: estimates, accuracy, coverage.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use windfall_pid::PidError;
use windfall_pid::regress::{Colour, RegressionFit, RegressionOutcome, RegressionSeries, ols};

fn solved(series: &[RegressionSeries]) -> RegressionFit {
    match ols(series).expect("enough rows") {
        RegressionOutcome::Fit(fit) => *fit,
        other => panic!("rank is full, yet {other:?}"),
    }
}

fn normal(g: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(g)
}

/// Two series of 40 rows with three regressors, weights and noise.
fn example() -> Vec<RegressionSeries> {
    let mut g = ChaCha8Rng::seed_from_u64(5);
    let mut one = |offset: f64| {
        let x: Vec<Vec<f64>> =
            vec![vec![1.0; 40], (0..40).map(|i| offset + f64::from(i)).collect(), (0..40).map(|_| normal(&mut g)).collect()];
        let response = (0..40).map(|i| 2.0 - 0.5 * x[1][i] + 3.0 * x[2][i] + 0.3 * normal(&mut g)).collect();
        RegressionSeries {
            regressors: x,
            response,
            weight: (0..40).map(|i| 0.5 + 0.01 * f64::from(i)).collect(),
            residuals: Colour::White,
        }
    };
    vec![one(0.0), one(7.0)]
}

#[test]
fn exact_estimates_and_accuracy_equal_the_normal_equations_4_15_to_4_20() {
    let series = example();
    let fit = solved(&series);
    let rows: Vec<(f64, [f64; 3], f64)> = series
        .iter()
        .flat_map(|s| {
            (0..40).map(move |i| (s.weight[i], [s.regressors[0][i], s.regressors[1][i], s.regressors[2][i]], s.response[i]))
        })
        .collect();
    let x = DMatrix::from_fn(80, 3, |i, j| rows[i].0 * rows[i].1[j]);
    let y = DVector::from_fn(80, |i, _| rows[i].0 * rows[i].2);
    let inverse = (x.transpose() * &x).try_inverse().expect("three independent columns");
    let p = &inverse * x.transpose() * &y;
    let e = &y - &x * &p;
    let s2 = e.norm_squared() / 77.0;
    let bound = 1e-10; // condition number 40, squared by the normal equations, times rounding
    for i in 0..3 {
        assert!((fit.estimate[i] - p[i]).abs() < bound);
        for j in 0..3 {
            assert!((fit.covariance_white[(i, j)] - s2 * inverse[(i, j)]).abs() < bound);
        }
    }
    assert!((fit.s2 - s2).abs() < bound);
    let w2: f64 = rows.iter().map(|r| r.0 * r.0).sum();
    let mean = rows.iter().map(|r| r.0 * r.0 * r.2).sum::<f64>() / w2;
    // Eq. 4.18 as printed, weighted.
    let printed = ((&x * &p).dot(&y) - w2 * mean * mean) / (y.norm_squared() - w2 * mean * mean);
    assert!((fit.r2 - printed).abs() < 1e-9, "{} {printed}", fit.r2);
    assert_eq!((fit.rows, fit.covariance == fit.covariance_white), (80, true));
    assert!(fit.whiteness_p > 0.001);
}

#[test]
fn law_scale_of_a_regressor_scales_its_estimate_and_error_alone() {
    let fit = solved(&example());
    let mut scaled = example();
    scaled.iter_mut().for_each(|s| s.regressors[1].iter_mut().for_each(|v| *v *= 1e6));
    let other = solved(&scaled);
    assert!((other.estimate[1] * 1e6 / fit.estimate[1] - 1.0).abs() < 1e-12);
    assert!((other.estimate[2] / fit.estimate[2] - 1.0).abs() < 1e-12);
    assert!((other.covariance[(1, 1)] * 1e12 / fit.covariance[(1, 1)] - 1.0).abs() < 1e-9);
    assert!((other.condition / fit.condition - 1.0).abs() < 1e-9);
}

#[test]
fn exact_missing_rank_names_a_column_that_is_part_of_it() {
    let mut series = example();
    for s in &mut series {
        s.regressors.push(s.regressors[0].iter().zip(&s.regressors[2]).map(|(a, b)| 2.0 * a - b).collect());
    }
    let Ok(RegressionOutcome::Deficient { column, rank }) = ols(&series) else { panic!("four columns of rank three") };
    assert!([0, 2, 3].contains(&column) && rank == 3);
    let mut zero = example();
    zero.iter_mut().for_each(|s| s.regressors[1].fill(0.0));
    assert_eq!(ols(&zero), Ok(RegressionOutcome::Deficient { column: 1, rank: 2 }));
    let few = RegressionSeries { regressors: vec![vec![1.0], vec![2.0]], response: vec![1.0], ..RegressionSeries::default() };
    assert!(matches!(ols(&[few]), Err(PidError::TooFewSamples { samples: 1, needed: 3, .. })));
}

/// Two unit columns at a small angle have singular values of ratio tan(angle/2): of 1e-10 as the documents say, and no other.
#[test]
fn exact_rank_counts_singular_values_against_the_largest() {
    let outcome = |angle: f64| {
        let regressors = vec![vec![0.5; 4], [1.0, -1.0, 1.0, -1.0].map(|side| 0.5 + angle * 0.5 * side).to_vec()];
        ols(&[RegressionSeries { regressors, response: vec![0.3, 1.7, -0.4, 0.9], ..RegressionSeries::default() }])
    };
    assert!(matches!(outcome(1.9e-10), Ok(RegressionOutcome::Deficient { rank: 1, .. })));
    assert!(matches!(outcome(2.1e-10), Ok(RegressionOutcome::Fit(_))));
}

/// Slow regressor, residuals first-order autoregressive with coefficient 0.9: what smoothing does to noise.
fn coloured(seed: u64, residuals: Colour) -> RegressionSeries {
    let mut g = ChaCha8Rng::seed_from_u64(seed);
    let x: Vec<f64> = (0..1000).map(|i| (0.02 * f64::from(i)).sin()).collect();
    let mut e = normal(&mut g) / (1.0 - 0.81_f64).sqrt();
    let response = x
        .iter()
        .map(|x| {
            let y = 2.0 * x + 1.0 + e;
            e = 0.9 * e + normal(&mut g);
            y
        })
        .collect();
    RegressionSeries { regressors: vec![x, vec![1.0; 1000]], response, weight: Vec::new(), residuals }
}

fn coverage(residuals: Colour) -> f64 {
    let covers = |seed: u64| {
        let fit = solved(&[coloured(seed, residuals)]);
        let half = fit.t95() * RegressionFit::std_errors(&fit.covariance)[0];
        f64::from(u8::from((fit.estimate[0] - 2.0).abs() < half))
    };
    (0..300).map(covers).sum::<f64>() / 300.0
}

#[test]
fn recover_coloured_residuals_intervals_cover_where_white_ones_do_not() {
    // 300 draws: 95 % ± 1.3 %; the errata's white intervals cover 32-64 %.
    let (white, corrected, weighted) =
        (coverage(Colour::White), coverage(Colour::Corrected(100)), coverage(Colour::Weighted(1000)));
    assert!(white < 0.65, "{white}");
    assert!((0.88..=0.99).contains(&corrected), "{corrected}");
    assert!((0.88..=0.99).contains(&weighted), "{weighted}");
}

#[test]
fn law_corrected_errors_of_white_residuals_are_the_white_ones() {
    let mut g = ChaCha8Rng::seed_from_u64(11);
    let x: Vec<f64> = (0..4000).map(|i| (0.02 * f64::from(i)).sin()).collect();
    let response = x.iter().map(|x| 2.0 * x + normal(&mut g)).collect();
    let series = |residuals| RegressionSeries {
        regressors: vec![x.clone()],
        response: Vec::clone(&response),
        weight: Vec::new(),
        residuals,
    };
    let white = RegressionFit::std_errors(&solved(&[series(Colour::White)]).covariance)[0];
    for colour in [Colour::Corrected(50), Colour::Weighted(4000)] {
        let fit = solved(&[series(colour)]);
        // Spectrum from 50 lags or 25 cosines of 4000 samples: its root is known to about 10 %.
        assert!((RegressionFit::std_errors(&fit.covariance)[0] / white - 1.0).abs() < 0.25);
        assert!(fit.whiteness_p > 0.001);
    }
    assert!(solved(&[coloured(1, Colour::White)]).whiteness_p < 1e-10);
}

#[test]
fn exact_weighting_by_spectrum_keeps_exact_data_exact() {
    let mut s = example();
    for s in &mut s {
        s.response = (0..40).map(|i| 2.0 - 0.5 * s.regressors[1][i] + 3.0 * s.regressors[2][i]).collect();
        s.residuals = Colour::Weighted(30);
    }
    let fit = solved(&s);
    for (found, truth) in fit.estimate.iter().zip([2.0, -0.5, 3.0]) {
        assert!((found - truth).abs() < 1e-9, "{found} {truth}");
    }
}

/// The double sum of Morelli and Klein and Parzen's window as they are written, for two weighted series; lags end with the series.
#[test]
fn exact_coloured_covariance_is_the_double_sum_over_lags() {
    double_sum(9, 9);
    double_sum(1000, 39);
}

fn double_sum(declared: usize, lags: usize) {
    let mut series = example();
    for s in &mut series {
        s.residuals = Colour::Corrected(declared);
    }
    let fit = solved(&series);
    let parzen = |x: f64| if x <= 0.5 { 1.0 - 6.0 * x.powi(2) + 6.0 * x.powi(3) } else { 2.0 * (1.0 - x).powi(3) };
    let (mut normal, mut meat, mut freedom) = (DMatrix::zeros(3, 3), DMatrix::zeros(3, 3), -3.0);
    for (s, e) in series.iter().zip(&fit.residuals) {
        let x = DMatrix::from_fn(40, 3, |i, j| s.weight[i] * s.regressors[j][i]);
        let r: Vec<f64> = (0..=lags)
            .map(|k| parzen(k as f64 / (lags + 1) as f64) * (0..40 - k).map(|i| e[i] * e[i + k]).sum::<f64>() / 40.0)
            .collect();
        let coloured = DMatrix::from_fn(40, 40, |i: usize, j: usize| r.get(i.abs_diff(j)).copied().unwrap_or(0.0));
        normal += x.transpose() * &x;
        meat += x.transpose() * coloured * &x;
        freedom += 40.0 * r[0] * r[0] / (r[0] * r[0] + 2.0 * r[1..].iter().map(|r| r * r).sum::<f64>());
    }
    let bread = normal.try_inverse().expect("three independent columns");
    let expected = &bread * meat * &bread;
    // Round-off of transforms over 50 numbers and of the normal equations, relative to the largest element.
    assert!((&fit.covariance - &expected).norm() < 1e-10 * expected.norm(), "{} {expected}", fit.covariance);
    assert!((fit.freedom - freedom).abs() < 1e-9, "{} {freedom}", fit.freedom);
    // Singular values of the columns at unit length.
    let x = DMatrix::from_fn(80, 3, |i, j| series[i / 40].weight[i % 40] * series[i / 40].regressors[j][i % 40]);
    let unit = DMatrix::from_fn(80, 3, |i, j| x[(i, j)] / x.column(j).norm());
    let singular = unit.singular_values();
    assert!((fit.condition - singular.max() / singular.min()).abs() < 1e-9);
}
