//! pid: least-squares splines. In: raw signals. Out: one spline of degree 7 per channel on common knots, with its derivatives.
//!
//! Why one knot interval for all channels: forces follow from accelerations, regressors from angles and velocities. When both
//! sides of a balance pass the same filter, what it takes away drops out to first order, and what bias is left is that of the
//! products alone (Klein and Morelli, Aircraft System Identification, 2006, ch. 7, the same idea in the frequency domain).
//! A spline needs nothing beyond a run's ends, and its rate is the derivative of its value everywhere.

use super::banded::{Banded, BandedFactor};
use super::bspline::{DEGREE, Knots, ORDER};
use super::{Fit, Signal};
use crate::PidError;
use crate::shared::Shared;
use std::sync::{Arc, OnceLock};
use windfall_model::{CHANNELS, PerChannel};

/// Shortest knot interval that the automatic choice tries, samples.
const SHORTEST: f64 = 2.0;
/// Longest, seconds: slower motion than this does not occur in the tunnel's 1 Hz pitch mode.
const LONGEST_S: f64 = 0.6;
/// Undersmoothing: cross-validation balances bias and noise of the values; second derivatives and intervals that must cover need
/// the bias well below the noise (Hall, Annals of Statistics 20(2), 1992). Bias of a second derivative falls with the sixth power
/// of the knot interval, here to 8 %, noise of a parameter hardly grows.
const UNDERSMOOTH: f64 = 0.65;
/// Ratio of neighbouring intervals that the automatic choice tries.
const RATIO: f64 = 0.72;

/// Smooths seven channels with a given knot interval (s), or with that of least generalised cross-validation.
pub(super) fn smooth(raw: PerChannel<&[f64]>, dt: f64, knot_s: Option<f64>) -> Result<Fit, PidError> {
    let samples = interleave(raw);
    let n = samples.len();
    let intervals = match knot_s {
        Some(h) if h.is_finite() && h >= SHORTEST * dt * 0.999 => intervals_of(h / dt, n),
        Some(value) => {
            return Err(PidError::Setting { setting: "knot interval, s", value, allowed: "at least two sample intervals" });
        }
        None => choose(&samples, dt),
    };
    let grid = Grid::shared(intervals, n);
    let factor = grid.factor.as_ref().ok_or(PidError::TooFewSamples {
        what: "spline through a run".to_owned(),
        samples: n,
        needed: intervals + ORDER,
    })?;
    let coefficients = grid.fit(&samples, factor);
    let (channels, rss) = grid.evaluate(&samples, &coefficients, dt);
    let free = (n - grid.knots.count()) as f64;
    let bandwidth = 0.5 / (grid.samples_per_interval() * dt);
    let weight = grid.weights.get_or_init(|| grid.weights(factor)).clone();
    Ok(Fit { channels, noise_std: rss.map(|r| (r / free).sqrt()), weight, bandwidth_hz: [bandwidth; CHANNELS] })
}

fn interleave(raw: PerChannel<&[f64]>) -> Vec<PerChannel<f64>> {
    (0..raw[0].len()).map(|i| raw.map(|x| x[i])).collect()
}

/// Number of intervals for a knot interval in samples: at least one, and more samples than coefficients.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
fn intervals_of(samples: f64, n: usize) -> usize {
    let last = (n - 1) as f64;
    ((last / samples).round() as usize).clamp(1, (n - ORDER).min(((n - 1) / 2).max(1)))
}

/// Number of intervals: cross-validation, then undersmoothing.
fn choose(samples: &[PerChannel<f64>], dt: f64) -> usize {
    let n = samples.len();
    let best = cross_validate(samples, dt);
    intervals_of(((n - 1) as f64 / best as f64 * UNDERSMOOTH).max(SHORTEST), n)
}

/// Knot interval of least Σ over channels of ln GCV, GCV = RSS/n / (1 − p/n)²: equal weight to a relative gain in any channel.
fn cross_validate(samples: &[PerChannel<f64>], dt: f64) -> usize {
    let n = samples.len();
    let size2 = sum_of_squares(samples);
    let mut best = (f64::INFINITY, 1);
    let mut knot = LONGEST_S / dt;
    while knot >= SHORTEST {
        let grid = Grid::shared(intervals_of(knot, n), n);
        if let Some(rss) = grid.residual(samples, size2) {
            let left = 1.0 - grid.knots.count() as f64 / n as f64;
            // A channel that is fitted to rounding error says nothing more.
            let score: f64 =
                rss.iter().zip(size2).filter(|(_, s)| *s > 0.0).map(|(r, s)| (r.max(1.0e-28 * s) / (left * left)).ln()).sum();
            if score < best.0 {
                best = (score, grid.knots.intervals);
            }
        }
        knot *= RATIO;
    }
    best.1
}

fn sum_of_squares(samples: &[PerChannel<f64>]) -> PerChannel<f64> {
    let mut s = [0.0; CHANNELS];
    for x in samples {
        for (s, x) in s.iter_mut().zip(x) {
            *s += x * x;
        }
    }
    s
}

/// Knots laid over n samples from the first to the last, with what follows from them alone.
struct Grid {
    knots: Knots,
    per_sample: f64,
    n: usize,
    /// Values of the eight functions at each sample.
    values: Vec<[f64; ORDER]>,
    /// Of the normal matrix; none when that is not positive definite.
    factor: Option<BandedFactor>,
    /// First and second derivatives of the eight functions at each sample, and factors of the rows: of the grid that is chosen.
    slopes: OnceLock<Vec<[[f64; ORDER]; 2]>>,
    weights: OnceLock<Vec<f64>>,
}

/// Grids of the runs smoothed last: those of the search, and those that it chose. At most 1.6 MB each.
static GRIDS: Shared<(usize, usize), Grid> = Shared::new(24);
/// Longest run whose grids are kept, samples.
const LONGEST_KEPT: usize = 8192;

impl Grid {
    fn shared(intervals: usize, n: usize) -> Arc<Self> {
        if n > LONGEST_KEPT { Arc::new(Self::new(intervals, n)) } else { GRIDS.get((intervals, n), || Self::new(intervals, n)) }
    }
    fn new(intervals: usize, n: usize) -> Self {
        let (knots, per_sample) = (Knots { intervals }, intervals as f64 / (n - 1) as f64);
        let mut grid =
            Self { knots, per_sample, n, values: Vec::new(), factor: None, slopes: OnceLock::new(), weights: OnceLock::new() };
        let mut gram = Banded::zeros(knots.count());
        grid.values = (0..n)
            .map(|i| {
                let (first, x) = grid.place(i);
                let values = knots.values(first, x);
                gram.add_outer(first, &values);
                values
            })
            .collect();
        grid.factor = gram.factor();
        grid
    }
    fn samples_per_interval(&self) -> f64 {
        1.0 / self.per_sample
    }
    fn place(&self, i: usize) -> (usize, f64) {
        let x = i as f64 * self.per_sample;
        (self.knots.interval(x), x)
    }
    /// Each sample with the first coefficient that acts there and the values of the functions.
    fn rows<'a>(
        &'a self,
        samples: &'a [PerChannel<f64>],
    ) -> impl Iterator<Item = (&'a PerChannel<f64>, usize, &'a [f64; ORDER])> {
        samples.iter().zip(&self.values).enumerate().map(|(i, (y, b))| (y, self.place(i).0, b))
    }
    /// Least-squares coefficients from normal equations, once more on the residual, which restores the digits that their squared
    /// condition number costs.
    fn fit(&self, samples: &[PerChannel<f64>], factor: &BandedFactor) -> Vec<PerChannel<f64>> {
        let mut c = self.projection(samples);
        factor.solve(&mut c);
        let mut more = vec![[0.0; CHANNELS]; c.len()];
        for (y, first, b) in self.rows(samples) {
            let fit = gather(&c[first..first + ORDER], b);
            scatter(&mut more[first..first + ORDER], b, &std::array::from_fn(|k| y[k] - fit[k]));
        }
        factor.solve(&mut more);
        for (c, m) in c.iter_mut().flatten().zip(more.iter().flatten()) {
            *c += m;
        }
        c
    }
    /// Sums of squared residuals. From the normal equations, yᵀy − cᵀBᵀy; where that has lost its digits, sample by sample.
    fn residual(&self, samples: &[PerChannel<f64>], size2: PerChannel<f64>) -> Option<PerChannel<f64>> {
        let factor = self.factor.as_ref()?;
        let projection = self.projection(samples);
        let mut c = projection.clone();
        factor.solve(&mut c);
        let mut explained = [0.0; CHANNELS];
        for (c, b) in c.iter().zip(&projection) {
            for k in 0..7 {
                explained[k] += c[k] * b[k];
            }
        }
        let rss: PerChannel<f64> = std::array::from_fn(|k| size2[k] - explained[k]);
        // Cancellation leaves 1e-16/1e-9: seven digits.
        if rss.iter().zip(size2).all(|(r, s)| *r > 1.0e-9 * s || s <= 0.0) {
            Some(rss)
        } else {
            Some(self.residual_by_sample(samples, &c))
        }
    }
    fn residual_by_sample(&self, samples: &[PerChannel<f64>], c: &[PerChannel<f64>]) -> PerChannel<f64> {
        let mut rss = [0.0; CHANNELS];
        for (y, first, b) in self.rows(samples) {
            let fit = gather(&c[first..first + ORDER], b);
            for k in 0..7 {
                rss[k] += (y[k] - fit[k]) * (y[k] - fit[k]);
            }
        }
        rss
    }
    /// Right-hand sides of the normal equations.
    fn projection(&self, samples: &[PerChannel<f64>]) -> Vec<PerChannel<f64>> {
        let mut projection = vec![[0.0; CHANNELS]; self.knots.count()];
        for (y, first, b) in self.rows(samples) {
            scatter(&mut projection[first..first + ORDER], b, y);
        }
        projection
    }
    fn slopes(&self) -> &[[[f64; ORDER]; 2]] {
        let at = |i| {
            let (first, x) = self.place(i);
            self.knots.slopes(first, x)
        };
        self.slopes.get_or_init(|| (0..self.n).map(at).collect())
    }
    fn evaluate(&self, samples: &[PerChannel<f64>], c: &[PerChannel<f64>], dt: f64) -> (PerChannel<Signal>, PerChannel<f64>) {
        let per_s = self.per_sample / dt;
        let mut out: PerChannel<Signal> = std::array::from_fn(|_| Signal {
            value: Vec::with_capacity(self.n),
            rate: Vec::with_capacity(self.n),
            second: Vec::with_capacity(self.n),
        });
        let mut rss = [0.0; CHANNELS];
        for ((y, first, b), [rate, second]) in self.rows(samples).zip(self.slopes()) {
            let local = &c[first..first + ORDER];
            let [value, rate, second] = [b, rate, second].map(|b| gather(local, b));
            for (k, signal) in out.iter_mut().enumerate() {
                signal.value.push(value[k]);
                signal.rate.push(rate[k] * per_s);
                signal.second.push(second[k] * per_s * per_s);
                rss[k] += (y[k] - value[k]) * (y[k] - value[k]);
            }
        }
        (out, rss)
    }
    /// Standard deviation of the second derivative in the middle over that at each sample, at most 1.
    fn weights(&self, factor: &BandedFactor) -> Vec<f64> {
        // What an end does fades over a few intervals; both ends are alike.
        let reach = self.knots.intervals.min(2 * ORDER);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sample count")]
        let near = ((reach as f64 * self.samples_per_interval()) as usize).clamp(1, self.n.div_ceil(2));
        let deviation: Vec<f64> = (0..near).map(|i| self.second_deviation(factor, i)).collect();
        let tail = &deviation[near - near.div_ceil(4)..];
        let middle = tail.iter().sum::<f64>() / tail.len() as f64;
        let mut w = vec![1.0; self.n];
        for (i, d) in deviation.iter().enumerate() {
            w[i] = (middle / d).min(1.0);
            w[self.n - 1 - i] = w[i];
        }
        w
    }
    /// Standard deviation of the second derivative at sample i for noise of unit standard deviation, per interval².
    fn second_deviation(&self, factor: &BandedFactor, i: usize) -> f64 {
        let (first, x) = self.place(i);
        let second = self.knots.slopes(first, x)[1];
        // The forward solution fades geometrically: 6 orders past the last value it is below rounding of the sum.
        let to = (first + ORDER + 6 * DEGREE).min(self.knots.count());
        let mut z = vec![[0.0]; to];
        for (z, b) in z[first..].iter_mut().zip(second) {
            z[0] = b;
        }
        factor.forward_to(&mut z, first);
        z[first..].iter().map(|v| v[0] * v[0]).sum::<f64>().sqrt()
    }
}

fn scatter(c: &mut [PerChannel<f64>], b: &[f64; ORDER], y: &PerChannel<f64>) {
    for (c, b) in c.iter_mut().zip(b) {
        for (c, y) in c.iter_mut().zip(y) {
            *c += b * y;
        }
    }
}

fn gather(c: &[PerChannel<f64>], b: &[f64; ORDER]) -> PerChannel<f64> {
    let mut sum = [0.0; CHANNELS];
    for (c, b) in c.iter().zip(b) {
        for (s, c) in sum.iter_mut().zip(c) {
            *s += b * c;
        }
    }
    sum
}
