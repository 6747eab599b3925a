//! pid tests: instruments of a while ago on a swinging body that gusts drive. In: a recursion whose numbers are known. Out: estimates.

use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Numbers of `y = −4 x − 0.4 v + e`, x and v the place and speed of an oscillator that y drives, e a gust of a memory of 0.3 diameters.
const TRUTH: [f64; 2] = [-4.0, -0.4];
const STEP: f64 = 0.2;

fn swinging(seed: u64) -> RegressionSeries {
    let mut g = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let (mut x, mut v, mut e, h) = (0.0, 0.0, 0.0, 0.03);
    let mut rows = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..8000 {
        let n: f64 = StandardNormal.sample(&mut g);
        e = 0.5 * e + n;
        let y = TRUTH[0] * x + TRUTH[1] * v + e;
        rows.0.push(x);
        rows.1.push(v);
        rows.2.push(y);
        v += h * y;
        x += h * v;
    }
    RegressionSeries { regressors: vec![rows.0, rows.1], response: rows.2, ..RegressionSeries::default() }
}

/// Sixteen runs: intervals of 95 % hold the truth in as many as 1 in 1000 studies or more would have, 12 (binomial); the mean over runs is
/// within 3.5 of its standard errors. Least squares is off by more: the gust of now has already moved the body.
#[test]
fn recover_a_body_that_gusts_drive() {
    let runs: Vec<RegressionSeries> = (0..16).map(swinging).collect();
    let (mut covered, mut off, mut variance) = ([0, 0], [0.0; 2], [0.0; 2]);
    for run in &runs {
        let found = lagged(&[Timed { series: run, step: STEP }], &[0, 1]).expect("long enough");
        assert!(LAGS.contains(&found.lag) && found.strength.iter().all(|f| *f > 10.0), "{:?}", found.strength);
        for j in 0..2 {
            let std = found.covariance[(j, j)].sqrt();
            let half = crate::regress::student_95(found.freedom[j]) * std;
            covered[j] += usize::from((found.estimate[j] - TRUTH[j]).abs() < half);
            off[j] += (found.estimate[j] - TRUTH[j]) / 16.0;
            variance[j] += std * std / 256.0;
        }
    }
    for j in 0..2 {
        assert!(covered[j] >= 12 && off[j].abs() < 3.5 * variance[j].sqrt(), "{covered:?} {off:?} {variance:?}");
    }
}

/// Too short for any lag, or of unknown flow: nothing is told.
#[test]
fn exact_short_runs_have_no_instruments() {
    let mut run = swinging(1);
    assert!(lagged(&[Timed { series: &run, step: 0.0 }], &[0, 1]).is_none());
    run.regressors.iter_mut().for_each(|x| x.truncate(20));
    run.response.truncate(20);
    assert!(lagged(&[Timed { series: &run, step: STEP }], &[0, 1]).is_none());
}
