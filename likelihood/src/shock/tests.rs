//! likelihood tests: passes backward against one Gaussian of a short motion written out, tails by their formulas.

use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// States, nodes, and channels of a node.
pub(crate) const STATES: usize = 12;
const NODES: usize = 5;
const EACH: usize = 3;
const TIMES_S: [f64; NODES] = [0.0, 0.3, 0.6, 0.8, 1.2];
/// Variances of a channel, and of what is added to every state on the way to the next node.
const NOISE: f64 = 0.3;
const ADDED: f64 = 0.07;
/// Gusts whose smoothed values are looked at: a state, and its variance in the long run.
pub(crate) const GUSTS: [(usize, f64); 2] = [(3, 0.9), (10, 1.7)];

/// A linear motion, measured: what a filter did along it, and the same without a filter.
pub(crate) struct Linear {
    pub(crate) trace: Trace,
    y: DVector<f64>,
    h: Vec<DMatrix<f64>>,
    phi: Vec<DMatrix<f64>>,
    start: DMatrix<f64>,
}

impl Linear {
    pub(crate) fn new() -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut draw = |rows, columns, size: f64| {
            DMatrix::from_fn(rows, columns, |_, _| {
                size * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng)
            })
        };
        let phi: Vec<_> = (0..NODES).map(|_| DMatrix::identity(STATES, STATES) + draw(STATES, STATES, 0.2)).collect();
        let h: Vec<_> = (0..NODES).map(|_| draw(EACH, STATES, 1.0)).collect();
        let y = DVector::from_column_slice(draw(NODES * EACH, 1, 3.0).as_slice());
        let root = draw(STATES, STATES, 0.5);
        let start = &root * root.transpose();
        // Kalman's filter, a channel at a time.
        let (mut x, mut p, mut trace) = (DVector::zeros(STATES), start.clone(), Trace::default());
        for k in 0..NODES {
            let mut node = Taken { t_s: TIMES_S[k], ..Taken::default() };
            let row = |i: usize| p.row(i).iter().copied().collect();
            let of = |(i, (place, expected)): (usize, (usize, f64))| Blowing {
                axis: i,
                place,
                value: x[place],
                covariance: row(place),
                expected,
            };
            node.blowing = GUSTS.into_iter().enumerate().map(of).collect();
            for c in 0..EACH {
                let slope = h[k].row(c).transpose();
                let (covariance, value) = (&p * &slope, y[EACH * k + c] - slope.dot(&x));
                let variance = slope.dot(&covariance) + NOISE;
                x += &covariance * (value / variance);
                p -= &covariance * covariance.transpose() / variance;
                let [slope, covariance] = [slope, covariance].map(|v| v.as_slice().to_vec());
                node.channels.push(Innovation { slope, covariance, value, variance, columns: Vec::new() });
            }
            if k + 1 < NODES {
                node.phi = phi[k].transpose().as_slice().to_vec();
                x = &phi[k] * x;
                p = &phi[k] * p * phi[k].transpose() + DMatrix::identity(STATES, STATES) * ADDED;
            }
            trace.nodes.push(node);
        }
        Self { trace, y, h, phi, start }
    }

    /// State at a node by what is added to the state just before another.
    fn between(&self, from: usize, to: usize) -> DMatrix<f64> {
        if to < from {
            return DMatrix::zeros(STATES, STATES);
        }
        (from..to).fold(DMatrix::identity(STATES, STATES), |all, k| &self.phi[k] * all)
    }

    /// Measurements by what is added to the state just before a node.
    fn shown(&self, from: usize) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(NODES * EACH, STATES);
        (0..NODES).for_each(|k| all.rows_mut(k * EACH, EACH).copy_from(&(&self.h[k] * self.between(from, k))));
        all
    }

    /// Covariance of what is added to the state before a node.
    fn source(&self, k: usize) -> DMatrix<f64> {
        if k == 0 { self.start.clone() } else { DMatrix::identity(STATES, STATES) * ADDED }
    }

    /// Covariance of the measurements.
    fn covariance(&self) -> DMatrix<f64> {
        let white = DMatrix::identity(NODES * EACH, NODES * EACH) * NOISE;
        (0..NODES).fold(white, |all, k| all + self.shown(k) * self.source(k) * self.shown(k).transpose())
    }

    /// Mean and covariance of the state at a node by all measurements.
    pub(crate) fn smoothed(&self, at: usize) -> (DVector<f64>, DMatrix<f64>) {
        let zero = || DMatrix::zeros(STATES, STATES);
        let own = (0..=at).fold(zero(), |all, k| all + self.between(k, at) * self.source(k) * self.between(k, at).transpose());
        let with = (0..=at).fold(DMatrix::zeros(STATES, NODES * EACH), |all, k| {
            all + self.between(k, at) * self.source(k) * self.shown(k).transpose()
        });
        let factor = self.covariance().cholesky().expect("a covariance");
        (&with * factor.solve(&self.y), own - &with * factor.solve(&with.transpose()))
    }
}

fn log_density(covariance: DMatrix<f64>, y: &DVector<f64>) -> f64 {
    let factor = covariance.cholesky().expect("a covariance");
    -0.5 * y.dot(&factor.solve(y)) - factor.l().diagonal().map(f64::ln).sum()
}

/// A state with score and information: `x + P r` and `P − P N P` are those of all measurements (rounding).
#[test]
fn exact_smoothed_states() {
    let linear = Linear::new();
    backward(&linear.trace, STATES, |at, score, information| {
        let (mean, covariance) = linear.smoothed(at);
        for gust in &linear.trace.nodes[at].blowing {
            let p = DVector::from_column_slice(&gust.covariance);
            let (m, v) = (gust.value + p.dot(score), p[gust.place] - p.dot(&(information * &p)));
            assert!((m - mean[gust.place]).abs() < 1e-9 && (v - covariance[(gust.place, gust.place)]).abs() < 1e-9, "{at}");
        }
    });
}

/// What a kick of plausible size, 0.3 m/s and 2 rad/s, adds to the log-likelihood: that of all measurements as one Gaussian with it
/// less that without, at every node from the first to the last.
#[test]
fn exact_gain_of_a_kick() {
    let linear = Linear::new();
    let found = shocks(&linear.trace, STATES);
    assert_eq!(found.iter().rev().map(|s| s.t_s).collect::<Vec<_>>(), TIMES_S);
    let sizes = DVector::from_fn(STATES, |i, _| [0.0, 0.0, 0.09, 4.0][i / 3]);
    let plain = linear.covariance();
    for (at, shock) in found.iter().rev().enumerate() {
        let shown = linear.shown(at);
        let kicked = &plain + &shown * DMatrix::from_diagonal(&sizes) * shown.transpose();
        let gain = log_density(kicked, &linear.y) - log_density(plain.clone(), &linear.y);
        assert!((shock.gain - gain).abs() < 1e-9, "{at}: {} {gain}", shock.gain);
    }
}

/// The three largest of 150 by Hosking and Wallis (1987): a_s the mean of (1 − p)^s x over plotting positions p = (j − 0.35)/n,
/// `α = 2 a₀ a₁/(a₀ − 2 a₁)`, `k = a₀/(a₀ − 2 a₁) − 2`; of a k above none, an exponential.
#[test]
fn exact_tail_by_weighted_moments() {
    for (largest, beyond) in [([1.0, 2.5, 20.0], 30.0), ([1.0, 2.5, 6.0], 11.0)] {
        let tail = largest.iter().map(|x| x + 3.0);
        let all: Vec<Shock> = (0..147).map(|_| 3.0).chain(tail).map(|gain| Shock { t_s: 0.0, gain }).collect();
        let a0 = largest.iter().sum::<f64>() / 3.0;
        let a1 = (1..).zip(largest).map(|(j, x)| (1.0 - (f64::from(j) - 0.35) / 3.0) * x).sum::<f64>() / 3.0;
        let (scale, k) = (2.0 * a0 * a1 / (a0 - 2.0 * a1), a0 / (a0 - 2.0 * a1) - 2.0);
        let share = if k < 0.0 { (1.0 - k * beyond / scale).powf(1.0 / k) } else { (-beyond / a0).exp() };
        let found = expected_beyond(3.0 + beyond, &all);
        assert!((found - 3.0 * share).abs() < 1e-12, "{found} {}", 3.0 * share);
    }
}

/// Gains that are distributed as a generalised Pareto law says: those beyond a size are as many as it says, within what 200 of the
/// tail leave of its shape.
#[test]
fn recover_tail() {
    for shape in [1e-3_f64, 0.4] {
        let one = |share: f64| (share.powf(-shape) - 1.0) / shape;
        let all: Vec<Shock> = (0..10_000).map(|i| Shock { t_s: 0.0, gain: one((f64::from(i) + 0.5) / 10_000.0) }).collect();
        let found = expected_beyond(one(20.0 / 10_000.0), &all);
        assert!((found / 20.0 - 1.0).abs() < 0.05, "{shape} {found}");
        let found = expected_beyond(one(1e-6), &all);
        assert!((1e-3..0.1).contains(&found), "{shape} {found} of 0.01");
    }
}
