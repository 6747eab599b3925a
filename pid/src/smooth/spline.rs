//! pid: least-squares splines. In: raw signals. Out: one spline of degree 7 per channel on common knots, with its derivatives.
//!
//! Why one knot interval for all channels: forces follow from accelerations, regressors from angles and velocities. When both
//! sides of a balance pass the same filter, what it takes away drops out to first order, and what bias is left is that of the
//! products alone (Klein and Morelli, Aircraft System Identification, 2006, ch. 7, the same idea in the frequency domain).
//! A spline needs nothing beyond a run's ends, and its rate is the derivative of its value everywhere.

use super::banded::{Banded, BandedFactor};
use super::bspline::{DEGREE, Knots, ORDER};
use super::wide::{WIDE, WideRow, gather, load, of_all, parts, scatter, store};
use super::{Fit, Signal};
use crate::PidError;
use crate::shared::Shared;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;
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
    let factor = grid.factor()?;
    let (orders, rss) = Arch::new().dispatch(Smoothing { grid: &grid, factor, samples: &samples, dt });
    let [values, rates, seconds] = orders.map(|rows| by_channel(&rows));
    let mut channels: PerChannel<Signal> = Default::default();
    for (channel, ((value, rate), second)) in channels.iter_mut().zip(values.into_iter().zip(rates).zip(seconds)) {
        *channel = Signal { value, rate, second };
    }
    let rss: PerChannel<f64> = std::array::from_fn(|k| rss[k]);
    let free = (n - grid.knots.count()) as f64;
    let bandwidth = 0.5 / (grid.samples_per_interval() * dt);
    let weight = grid.weights.get_or_init(|| grid.weights(factor)).clone();
    Ok(Fit { channels, noise_std: rss.map(|r| (r / free).sqrt()), weight, bandwidth_hz: [bandwidth; CHANNELS] })
}

/// A fit and what it gives at the samples, compiled for each vector unit.
struct Smoothing<'a> {
    grid: &'a Grid,
    factor: &'a BandedFactor,
    samples: &'a [WideRow],
    dt: f64,
}

impl WithSimd for Smoothing<'_> {
    type Output = ([Vec<WideRow>; 3], WideRow);
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.grid.evaluate(simd, self.samples, &self.grid.fit(simd, self.samples, self.factor), self.dt)
    }
}

/// The residual of a knot interval that is tried, compiled for each vector unit.
struct Trial<'a> {
    grid: &'a Grid,
    samples: &'a [WideRow],
    size2: WideRow,
}

impl WithSimd for Trial<'_> {
    type Output = Option<WideRow>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        self.grid.residual(simd, self.samples, self.size2)
    }
}

fn interleave(raw: PerChannel<&[f64]>) -> Vec<WideRow> {
    (0..raw[0].len()).map(|i| std::array::from_fn(|k| raw.get(k).map_or(0.0, |x| x[i]))).collect()
}

fn by_channel(rows: &[WideRow]) -> PerChannel<Vec<f64>> {
    let mut series = [(); CHANNELS].map(|()| vec![0.0; rows.len()]);
    for (i, row) in rows.iter().enumerate() {
        for (series, x) in series.iter_mut().zip(row) {
            series[i] = *x;
        }
    }
    series
}

/// Number of intervals for a knot interval in samples: at least one, and two samples to each, so that the shortest run that is
/// smoothed has more samples than coefficients.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
fn intervals_of(samples: f64, n: usize) -> usize {
    let last = (n - 1) as f64;
    ((last / samples).round() as usize).clamp(1, (n - 1) / 2)
}

/// Number of intervals: cross-validation, then undersmoothing.
fn choose(samples: &[WideRow], dt: f64) -> usize {
    let n = samples.len();
    let best = cross_validate(samples, dt);
    intervals_of(((n - 1) as f64 / best as f64 * UNDERSMOOTH).max(SHORTEST), n)
}

/// Knot interval of least Σ over channels of ln GCV, GCV = RSS/n / (1 − p/n)²: equal weight to a relative gain in any channel.
fn cross_validate(samples: &[WideRow], dt: f64) -> usize {
    let n = samples.len();
    let size2 = sum_of_squares(samples);
    let mut best = (f64::INFINITY, 1);
    let mut knot = LONGEST_S / dt;
    while knot >= SHORTEST {
        let grid = Grid::shared(intervals_of(knot, n), n);
        if let Some(rss) = Arch::new().dispatch(Trial { grid: &grid, samples, size2 }) {
            let left = 1.0 - grid.knots.count() as f64 / n as f64;
            let score = log_gcv(rss, size2, left);
            if score < best.0 {
                best = (score, grid.knots.intervals);
            }
        }
        knot *= RATIO;
    }
    best.1
}

/// Of what is left of sums of squares, and the share of the samples that the coefficients leave; n is no matter.
fn log_gcv(rss: WideRow, size2: WideRow, left: f64) -> f64 {
    // A channel that is fitted to rounding error says nothing more.
    rss.iter().zip(size2).filter(|(_, s)| *s > 0.0).map(|(r, s)| (r.max(1.0e-28 * s) / (left * left)).ln()).sum()
}

fn sum_of_squares(samples: &[WideRow]) -> WideRow {
    let mut s = [0.0; WIDE];
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
    /// First sample of each interval, and the number of samples.
    starts: Vec<usize>,
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
        let (slopes, weights) = (OnceLock::new(), OnceLock::new());
        let mut grid = Self { knots, per_sample, n, starts: Vec::new(), values: Vec::new(), factor: None, slopes, weights };
        let mut gram = Banded::zeros(knots.count());
        let mut starts = Vec::new();
        grid.values = (0..n)
            .map(|i| {
                let (first, x) = grid.place(i);
                starts.resize((first + 1).max(starts.len()), i);
                let values = knots.values(first, x);
                gram.add_outer(first, &values);
                values
            })
            .collect();
        starts.resize(intervals + 1, n);
        grid.starts = starts;
        grid.factor = gram.factor();
        grid
    }
    fn factor(&self) -> Result<&BandedFactor, PidError> {
        self.factor.as_ref().ok_or_else(|| PidError::TooFewSamples {
            what: "spline through a run".to_owned(),
            samples: self.n,
            needed: self.knots.count() + 1,
        })
    }
    fn samples_per_interval(&self) -> f64 {
        1.0 / self.per_sample
    }
    fn place(&self, i: usize) -> (usize, f64) {
        let x = i as f64 * self.per_sample;
        (self.knots.interval(x), x)
    }
    /// Each interval's first coefficient and samples.
    fn spans(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        self.starts.windows(2).enumerate().map(|(first, ends)| (first, ends[0]..ends[1]))
    }
    /// Least-squares coefficients from normal equations, once more on the residual, which restores the digits that their squared
    /// condition number costs.
    #[inline(always)]
    fn fit<S: Simd>(&self, simd: S, samples: &[WideRow], factor: &BandedFactor) -> Vec<WideRow> {
        let mut c = self.projection(simd, samples);
        factor.solve(simd, &mut c);
        let mut more = vec![[0.0; WIDE]; c.len()];
        for (first, span) in self.spans() {
            scatter(simd, local_mut(&mut more, first), &self.values[span.clone()], &samples[span], Some(local(&c, first)));
        }
        factor.solve(simd, &mut more);
        for (c, m) in c.iter_mut().flatten().zip(more.iter().flatten()) {
            *c += m;
        }
        c
    }
    /// Sums of squared residuals. From the normal equations, yᵀy − cᵀBᵀy; where that has lost its digits, sample by sample.
    #[inline(always)]
    fn residual<S: Simd>(&self, simd: S, samples: &[WideRow], size2: WideRow) -> Option<WideRow> {
        let factor = self.factor.as_ref()?;
        let projection = self.projection(simd, samples);
        let mut c = projection.clone();
        factor.solve(simd, &mut c);
        let mut explained = [0.0; WIDE];
        for part in parts::<S>() {
            let mut sum = simd.splat_f64s(0.0);
            for (c, b) in c.iter().zip(&projection) {
                sum = simd.mul_add_f64s(load::<S>(c, part), load::<S>(b, part), sum);
            }
            store::<S>(&mut explained, part, sum);
        }
        let rss: WideRow = std::array::from_fn(|k| size2[k] - explained[k]);
        // Cancellation leaves 1e-16/1e-9: seven digits.
        if rss.iter().zip(size2).all(|(r, s)| *r > 1.0e-9 * s || s <= 0.0) {
            Some(rss)
        } else {
            Some(self.residual_by_sample(simd, samples, &c))
        }
    }
    #[inline(always)]
    fn residual_by_sample<S: Simd>(&self, simd: S, samples: &[WideRow], c: &[WideRow]) -> WideRow {
        let mut rss = [0.0; WIDE];
        for (first, span) in self.spans() {
            for part in parts::<S>() {
                let (near, mut sum) = (of_all(simd, local(c, first), part), load::<S>(&rss, part));
                for (y, b) in samples[span.clone()].iter().zip(&self.values[span.clone()]) {
                    sum = plus_square(simd, sum, simd.sub_f64s(load::<S>(y, part), gather(simd, &near, b)));
                }
                store::<S>(&mut rss, part, sum);
            }
        }
        rss
    }
    /// Right-hand sides of the normal equations.
    #[inline(always)]
    fn projection<S: Simd>(&self, simd: S, samples: &[WideRow]) -> Vec<WideRow> {
        let mut projection = vec![[0.0; WIDE]; self.knots.count()];
        for (first, span) in self.spans() {
            scatter(simd, local_mut(&mut projection, first), &self.values[span.clone()], &samples[span], None);
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
    /// Value, rate (per s) and second derivative (per s²) at each sample, and sums of squared residuals.
    #[inline(always)]
    fn evaluate<S: Simd>(&self, simd: S, samples: &[WideRow], c: &[WideRow], dt: f64) -> ([Vec<WideRow>; 3], WideRow) {
        let per_s = simd.splat_f64s(self.per_sample / dt);
        let mut out = [(); 3].map(|()| vec![[0.0; WIDE]; self.n]);
        let mut rss = [0.0; WIDE];
        let slopes = self.slopes();
        for (first, span) in self.spans() {
            for part in parts::<S>() {
                let (near, mut sum) = (of_all(simd, local(c, first), part), load::<S>(&rss, part));
                for i in span.clone() {
                    let value = gather(simd, &near, &self.values[i]);
                    sum = plus_square(simd, sum, simd.sub_f64s(load::<S>(&samples[i], part), value));
                    let [rate, second] = &slopes[i];
                    let (rate, second) = (gather(simd, &near, rate), gather(simd, &near, second));
                    store::<S>(&mut out[0][i], part, value);
                    store::<S>(&mut out[1][i], part, simd.mul_f64s(rate, per_s));
                    store::<S>(&mut out[2][i], part, simd.mul_f64s(simd.mul_f64s(second, per_s), per_s));
                }
                store::<S>(&mut rss, part, sum);
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
        // The forward solution fades geometrically: 42 coefficients past the last value the rest is below 1e-12 of the sum.
        let to = (first + ORDER + 6 * DEGREE).min(self.knots.count());
        let mut z = vec![0.0; to];
        for (z, b) in z[first..].iter_mut().zip(second) {
            *z = b;
        }
        factor.forward_to(&mut z, first);
        z[first..].iter().map(|v| v * v).sum::<f64>().sqrt()
    }
}

fn local(c: &[WideRow], first: usize) -> &[WideRow; ORDER] {
    c[first..].first_chunk().expect("an interval has as many coefficients")
}
fn local_mut(c: &mut [WideRow], first: usize) -> &mut [WideRow; ORDER] {
    c[first..].first_chunk_mut().expect("an interval has as many coefficients")
}

/// `sum + x²`.
#[inline(always)]
fn plus_square<S: Simd>(simd: S, sum: S::f64s, x: S::f64s) -> S::f64s {
    simd.mul_add_f64s(x, x, sum)
}

#[cfg(test)]
mod tests;
