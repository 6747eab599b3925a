//! discover tests: judging poses by the scatter between runs.

use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use statrs::distribution::Continuous;

/// Noise alone is called systematic at the rate that is asked for, over 400 draws of 30 runs (5 % ± three standard errors); a shift
/// of a standard deviation and a slope of one over an input are found.
#[test]
fn law_noise_is_called_systematic_at_the_rate_asked_for() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(5);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    let inputs = DMatrix::from_fn(30, 2, |i, k| if k == 0 { (i % 5) as f64 } else { 7.0 });
    let mut called = 0;
    for _ in 0..400 {
        let z = DMatrix::from_fn(30, 2, |_, _| draw());
        called += usize::from(judge("X", &z, &inputs, 0.0).p_value < 0.05);
    }
    assert!((0.017..0.083).contains(&(f64::from(u32::try_from(called).expect("few")) / 400.0)), "{called}");
    let shifted = DMatrix::from_fn(30, 2, |_, k| draw() + if k == 0 { 1.0 } else { 0.0 });
    assert!(judge("X", &shifted, &inputs, 0.0).p_value < 1e-2);
    let followed = DMatrix::from_fn(30, 2, |i, k| draw() + if k == 1 { inputs[(i, 0)] - 2.0 } else { 0.0 });
    assert!(judge("X", &followed, &inputs, 0.0).p_value < 1e-4);
}

/// A mean common to all runs, estimated with the covariance of the runs themselves: its true scatter in 2000 draws of 30 runs of 12 numbers over its
/// stated variance is at the most what that is widened by, within four standard errors of 2000 draws. Shrunk correlations make
/// stated variances too wide, most where numbers are all but the same.
#[test]
fn law_intervals_are_at_least_as_wide_as_estimates_scatter() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(8);
    let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
    let (runs, draws) = (30, 2000);
    let pattern = SVector::<f64, BIN>::from_fn(|i, _| 1.0 / (1.0 + i as f64));
    for (own, least) in [(3.0, 0.4), (1.0, 0.4), (0.1, 0.04)] {
        let (mut stated, mut scatter) = (0.0, 0.0);
        for _ in 0..draws {
            let mut z = Vec::new();
            for _ in 0..runs {
                let common = draw();
                (0..BIN).for_each(|_| z.push(own * draw() + common));
            }
            // Estimate and covariance of what it leaves by turns, as a fit does.
            let mut estimate = 0.0;
            let mut information = 0.0;
            for _ in 0..20 {
                let left: Vec<f64> = z.iter().enumerate().map(|(i, z)| z - estimate * pattern[i % BIN]).collect();
                let inverse = Between::of(&left, BIN).covariance.try_inverse().expect("more runs than numbers");
                information = pattern.dot(&(inverse * pattern)) * f64::from(runs);
                let sum: SVector<f64, BIN> = z.chunks_exact(BIN).map(SVector::<f64, BIN>::from_column_slice).sum();
                estimate = pattern.dot(&(inverse * sum)) / information;
            }
            stated += 1.0 / information;
            scatter += estimate * estimate;
        }
        let ratio = scatter / stated / widened(usize::try_from(runs).expect("few"));
        assert!((least..1.13).contains(&ratio), "{own}: {ratio}");
    }
}

/// Three numbers of five runs, of sizes apart by a hundred: correlations shrink by the errors of all means over their squares, both by hand, and
/// variances stay; sensor noise is added to each run.
#[test]
fn exact_correlations_are_shrunk_by_their_errors() {
    let number = |r: usize, k: usize| [1.0, 10.0, 0.1][k] * (crooked(r, 2) + 0.6 * crooked(r, 3 + k));
    let z: Vec<f64> = (0..5).flat_map(|r| (0..BIN).map(move |k| if k < 3 { number(r, k) } else { 0.0 })).collect();
    let mean = |i: usize, k: usize| (0..5).map(|r| number(r, i) * number(r, k)).sum::<f64>() / 5.0;
    let unit = |i: usize, k: usize| mean(i, i).sqrt() * mean(k, k).sqrt();
    let pairs = [(0, 1), (0, 2), (1, 2)];
    let square = |(i, k): (usize, usize)| (mean(i, k) / unit(i, k)).powi(2);
    let error = |(i, k): (usize, usize)| {
        (0..5).map(|r| ((number(r, i) * number(r, k) - mean(i, k)) / unit(i, k)).powi(2)).sum::<f64>() / 20.0
    };
    let kept = 1.0 - pairs.map(error).iter().sum::<f64>() / pairs.map(square).iter().sum::<f64>();
    assert!((0.2..0.95).contains(&kept), "{kept}");
    let found = Between::of(&z, 3).with_noise(&[Cov::from_diagonal_element(0.04)]);
    for i in 0..3 {
        assert!((found[0][(i, i)] / (mean(i, i) + 0.04) - 1.0).abs() < 1e-12);
        (0..i).for_each(|k| assert!((found[0][(i, k)] / (mean(i, k) * kept) - 1.0).abs() < 1e-12, "{i} {k}"));
    }
}

/// Of three runs of another campaign, one number each, the density is that of Student's t by hand, and its slope a difference of it; runs
/// hundreds of standard deviations off cost the logarithm of that and no square.
#[test]
fn exact_density_of_runs_that_no_fit_has_seen() {
    let numbers = 1;
    let z: Vec<f64> = (0..9).flat_map(|r| (0..BIN).map(move |k| if k == 0 { crooked(r, 2) } else { 0.0 })).collect();
    let between = Between::of(&z, numbers);
    let variance = (0..9).map(|r| crooked(r, 2).powi(2)).sum::<f64>() / 9.0;
    let noise = vec![Cov::from_diagonal_element(0.04); 3];
    let column: Residual = (0..3 * BIN).map(|i| if i.is_multiple_of(BIN) { 0.5 + (i / BIN) as f64 } else { 0.0 }).collect();
    let others = |by: f64| -> Vec<f64> {
        let at = |i: usize| if i.is_multiple_of(BIN) { crooked(i / BIN, 5) + by * column[i] } else { 0.0 };
        (0..3 * BIN).map(at).collect()
    };
    let t = statrs::distribution::StudentsT::new(0.0, (variance + 0.04).sqrt(), 9.0).expect("a scale");
    // What a Gaussian likelihood leaves out.
    let constant = 3.0 * 0.5 * std::f64::consts::TAU.ln();
    let by_hand = |by: f64| (0..3).map(|r| t.ln_pdf(others(by)[r * BIN])).sum::<f64>() + constant;
    let of = |by: f64| between.of_others(&noise, &others(by), std::slice::from_ref(&column), BIN).expect("positive");
    for by in [0.0, 0.3, -2.0] {
        assert!((of(by).log_likelihood - by_hand(by)).abs() < 1e-12, "{by}");
        let slope = (by_hand(by + 1e-5) - by_hand(by - 1e-5)) / 2e-5;
        assert!((of(by).slopes[0] - slope).abs() < 1e-7, "{by}");
    }
    assert!(of(100.0).log_likelihood > -160.0 && of(0.0).information[(0, 0)] > 0.0);
}

/// Rao's factors by hand, with twelve numbers of each of thirty runs and six of nine.
#[test]
fn pub_factors_of_few_runs() {
    for (runs, kept, wide) in [(30, 17.0 / 30.0, 30.0 * 28.0 / (18.0 * 17.0)), (9, 2.0 / 9.0, 9.0 * 7.0 / (3.0 * 2.0))] {
        assert!((share(runs) - kept).abs() < 1e-15 && (widened(runs) - wide).abs() < 1e-13, "{runs} runs");
    }
}

/// p-value by hand: both sums of squares of a regression by its normal equations, summed over the numbers, and degrees of freedom
/// for numbers of unequal size.
fn by_hand(z: &DMatrix<f64>, regressors: &DMatrix<f64>, fitted: f64) -> f64 {
    let rank = regressors.ncols() as f64;
    let spare = z.nrows() as f64 - rank - fitted;
    let hat = regressors * (regressors.transpose() * regressors).lu().try_inverse().expect("regular") * regressors.transpose();
    let taken: Vec<f64> = z.column_iter().map(|c| c.dot(&(&hat * c))).collect();
    let left: Vec<f64> = z.column_iter().zip(&taken).map(|(c, t)| (c.norm_squared() - t) / spare).collect();
    let [sum, squares] = [left.iter().sum::<f64>(), left.iter().map(|x| x * x).sum()];
    let numbers = sum * sum / squares;
    FisherSnedecor::new(rank * numbers, spare * numbers).expect("positive").sf(taken.iter().sum::<f64>() / rank / sum)
}

/// By run.
type Input<'a> = &'a dyn Fn(usize) -> f64;

fn crooked(i: usize, k: usize) -> f64 {
    (1.3 * (i * (k + 2)) as f64 + 0.7 * (i * i) as f64 + k as f64).sin()
}

/// An input in small units, one that varies by a ten millionth of itself, and two that are apart by little more or less than a
/// millionth: each in whose differences are above its threshold is a regressor, and no other.
#[test]
fn exact_test_is_that_of_a_dense_regression() {
    let runs = 14;
    let z = DMatrix::from_fn(runs, 2, |i, k| crooked(i, k) * if k == 0 { 1.0 } else { 3.0 } + 0.2);
    let (u, v) = (|i| crooked(i, 3), |i| crooked(i, 4));
    let judged =
        |columns: &[&dyn Fn(usize) -> f64]| judge("X", &z, &DMatrix::from_fn(runs, columns.len(), |i, k| columns[k](i)), 1.6);
    let one = by_hand(&z, &DMatrix::from_element(runs, 1, 1.0), 1.6);
    let two = by_hand(&z, &DMatrix::from_fn(runs, 2, |i, k| if k == 0 { 1.0 } else { u(i) }), 1.6);
    let three = by_hand(&z, &DMatrix::from_fn(runs, 3, |i, k| [1.0, u(i), v(i)][k]), 1.6);
    assert!((one - two).abs() > 0.01 && (two - three).abs() > 0.01 && (one - three).abs() > 0.01, "{one} {two} {three}");
    // Over their norms the columns of two that are alike have a sum and a difference; the latter is v's share of u, over √2 of both.
    let apart = |x: f64| move |i: usize| u(i) + x * v(i);
    let all: [(&[Input], f64, f64); 6] = [
        (&[&|i| 3e-5 * u(i)], two, 1e-9),
        (&[&|i| 1e3 + 2e-4 * u(i)], two, 1e-6),
        (&[&|i| 1e6 + 1e-4 * u(i)], one, 1e-9),
        (&[&|i| 3e-5 * u(i), &|i| 40.0 + 7.0 * v(i)], three, 1e-9),
        (&[&u, &apart(6e-6)], three, 1e-6),
        (&[&u, &apart(2e-7)], two, 1e-6),
    ];
    for (columns, p, by) in all {
        let found = judged(columns);
        assert!((found.p_value - p).abs() < by, "{found:?} {p}");
        assert!((found.rms - (z.norm_squared() / 28.0).sqrt()).abs() < 1e-14);
    }
}
