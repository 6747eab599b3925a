//! likelihood tests: the tunnel speed's filter and smoother against dense least squares.

use super::*;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// A slow wave in noise comes back within what a local fit over a third of a second leaves, a tenth of the samples missing.
#[test]
fn recover_a_slow_speed() {
    let (h, std) = (1.0 / 150.0, 2.57e-3);
    let truth = |t: f64| 7.4 + 0.1 * (2.0 * t).sin();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
    let y: Vec<f64> = (0..3000).map(|i| truth(f64::from(i) * h) + std * normal(&mut rng)).collect();
    let speed = Speed::new(&y, h, &ChannelNoise::white(std), &|i| i % 10 == 3);
    let error: f64 = (100..2900).map(|i| (speed.at((f64::from(i) + 0.3) * h)[0] - truth((f64::from(i) + 0.3) * h)).powi(2)).sum();
    let rms = (error / 2800.0).sqrt();
    assert!(rms < 0.4 * std, "{rms}");
    let ratio = speed.innovations[2] / speed.innovations[3];
    // Standard error of 2700 squares: 0.027.
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    let slope = speed.at(10.0)[1];
    assert!((slope - 0.2 * 20.0_f64.cos()).abs() < 0.05, "{slope}");
}

/// The model of a record as one normal law: speeds, their rates and the samples by the first state and by each step's change of the
/// second derivative, in closed form; coloured noise by its autocovariance.
struct Dense {
    /// Covariances of the measured samples, and of the speed and its rate at all instants with them.
    samples: DMatrix<f64>,
    speed: DMatrix<f64>,
    rate: DMatrix<f64>,
    /// The measured samples less the first one.
    beyond: DVector<f64>,
}

impl Dense {
    fn new(y: &[Option<f64>], h: f64, noise: &ChannelNoise, intensity: f64) -> Self {
        let at: Vec<usize> = (0..y.len()).filter(|&i| y[i].is_some()).collect();
        let first = y[at[0]].expect("measured");
        // Speed and rate by value, rate and second derivative at the start (variances 1, 1, 25), and by a change of the latter in
        // each step.
        let by = |[value, rate, second]: [fn(f64) -> f64; 3]| {
            DMatrix::from_fn(y.len(), y.len() + 2, |k, j| {
                let t = (k as f64 - j.saturating_sub(2) as f64).max(0.0) * h;
                match j {
                    0 => value(t),
                    1 => rate(t),
                    2 => 5.0 * second(t),
                    _ => (intensity * h).sqrt() * second(t),
                }
            })
        };
        let (speed, rate) = (by([|_| 1.0, |t| t, |t| 0.5 * t * t]), by([|_| 0.0, |_| 1.0, |t| t]));
        let seen = speed.select_rows(&at);
        let noise = |i: usize, k: usize| {
            let lag = i32::try_from(at[i].abs_diff(at[k])).expect("a short record");
            noise.coloured * noise.correlation.powi(lag) + if lag == 0 { noise.white } else { 0.0 }
        };
        Self {
            samples: &seen * seen.transpose() + DMatrix::from_fn(at.len(), at.len(), noise),
            speed: speed * seen.transpose(),
            rate: rate * seen.transpose(),
            beyond: DVector::from_iterator(at.len(), at.iter().map(|&i| y[i].expect("measured") - first)),
        }
    }

    fn factor(&self) -> Cholesky<f64, Dyn> {
        self.samples.clone().cholesky().expect("a covariance")
    }

    fn cost(&self) -> f64 {
        let factor = self.factor();
        self.beyond.dot(&factor.solve(&self.beyond)) + 2.0 * factor.l().diagonal().map(f64::ln).sum()
    }
}

/// A part of a wave in coloured noise, a seventh of the samples missing.
fn short_record(n: usize, h: f64) -> Vec<Option<f64>> {
    let y = |i: usize| 7.0 + 0.3 * (1.5 * i as f64 * h).sin() + 1e-3 * (997.0 * (i * i) as f64).sin();
    (0..n).map(|i| (i % 7 != 3).then(|| y(i))).collect()
}

const COLOURED: ChannelNoise = ChannelNoise { white: 2e-7, coloured: 7e-7, correlation: 0.6 };

/// Likelihood, smoothed speed and rate, and the innovations' sums are those of one normal law of all samples: its determinant and
/// square, its regression, and its Cholesky factor, which whitens one sample after the other.
#[test]
fn exact_filter_and_smoother() {
    let (n, h, intensity) = (70, 0.02, 0.3);
    let y = short_record(n, h);
    let dense = Dense::new(&y, h, &COLOURED, intensity);
    let filter = Filter::new(h, &COLOURED, intensity);
    // The covariance's condition, 1e8, times rounding.
    assert!((filter.cost(&y) - dense.cost()).abs() < 1e-6 * dense.cost().abs(), "{} {}", filter.cost(&y), dense.cost());
    let (smoothed, sums) = filter.smooth(&y);
    let weights = dense.factor().solve(&dense.beyond);
    let (speed, rate) = (&dense.speed * &weights, &dense.rate * &weights);
    for (k, [v, a]) in smoothed.iter().enumerate() {
        assert!((v - 7.0 - speed[k]).abs() < 1e-6 && (a - rate[k]).abs() < 1e-6, "{k}: {v} {a} for {} {}", speed[k], rate[k]);
    }
    let lower = dense.factor().l();
    let white = lower.solve_lower_triangular(&dense.beyond).expect("a triangle");
    let late = (0..n).filter(|&i| y[i].is_some()).enumerate().filter(|(_, i)| *i >= SETTLED);
    let mut expected = [0.0; 4];
    for (row, _) in late {
        let (nu, s) = (white[row] * lower[(row, row)], lower[(row, row)].powi(2));
        expected = [expected[0] + nu * nu, expected[1] + s, expected[2] + white[row].powi(2), expected[3] + 1.0];
    }
    for (found, expected) in sums.iter().zip(expected) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{sums:?} {expected}");
    }
}

/// The intensity is the likeliest one within the width at which the search ends: what is smoothed is the regression there, far
/// closer than a decade of intensity would leave it.
#[test]
fn exact_intensity_is_the_likeliest() {
    let (n, h) = (70, 0.02);
    let y = short_record(n, h);
    let series: Vec<f64> = y.iter().map(|y| y.unwrap_or(0.0)).collect();
    let found = Speed::new(&series, h, &COLOURED, &|i| y[i].is_none());
    let of = |decade: i32| Dense::new(&y, h, &COLOURED, 10.0_f64.powf(0.1 * f64::from(decade)));
    let best = (-30..15).min_by(|a, b| of(*a).cost().total_cmp(&of(*b).cost())).expect("a decade");
    assert!((-25..10).contains(&best), "{best}");
    let apart = |decade: i32| {
        let dense = of(decade);
        let speed = &dense.speed * dense.factor().solve(&dense.beyond);
        found.smoothed.iter().zip(speed.iter()).map(|(f, v)| (f[0] - 7.0 - v).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN)
    };
    assert!(apart(best) < 0.2 * apart(best + 10).min(apart(best - 10)));
}

/// Density of what is left: the sum of the noise's autocovariance over all lags, per time of a measured sample.
#[test]
fn exact_density() {
    let (h, y) = (0.02, vec![7.0; 70]);
    let found = Speed::new(&y, h, &COLOURED, &|i| i % 7 == 3).density;
    let lags: f64 = (1..200).map(|lag| 2.0 * COLOURED.correlation.powi(lag)).sum();
    let expected = (COLOURED.white + COLOURED.coloured * (1.0 + lags)) * h * 7.0 / 6.0;
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

/// Between samples of a cubic the speed and its rate are the cubic's.
#[test]
fn exact_cubic_between_samples() {
    let (h, c) = (0.3, [7.0, 0.4, -1.3, 2.1]);
    let cubic = |t: f64| [c[0] + t * (c[1] + t * (c[2] + t * c[3])), c[1] + t * (2.0 * c[2] + t * 3.0 * c[3])];
    let smoothed = (0..4).map(|i| cubic(f64::from(i) * h)).collect();
    let speed = Speed { start_s: 0.0, interval_s: h, smoothed, density: 0.0, innovations: [0.0; 4] };
    for t in [0.07, 0.38, 0.71] {
        let (found, expected) = (speed.at(t), cubic(t));
        assert!((found[0] - expected[0]).abs() < 1e-13 && (found[1] - expected[1]).abs() < 1e-13, "{t}: {found:?} {expected:?}");
    }
}
