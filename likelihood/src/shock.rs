//! likelihood: shocks. In: what a filter did along a run. Out: what a kick to velocities and rates would explain at each instant.
//!
//! A kick before a node changes all later innovations; its score and information follow from one pass backward over the run (the
//! disturbance smoother's auxiliary residuals: de Jong and Penzer 1998; Durbin and Koopman 2012, §4.5 and §7.5).

use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use windfall_model::POSE;

/// Velocities and body rates among the states.
const KICKED: [usize; 6] = [6, 7, 8, 9, 10, 11];
/// Plausible kicks, m/s and rad/s.
const PLAUSIBLE: [f64; 6] = [0.3, 0.3, 0.3, 2.0, 2.0, 2.0];

/// What a filter did: by node, the channels it took and the step to the next node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trace {
    pub(crate) nodes: Vec<Taken>,
}

/// One node.
#[derive(Clone, Debug, Default)]
pub(crate) struct Taken {
    pub(crate) t_s: f64,
    /// Channels in the order taken.
    pub(crate) channels: Vec<Innovation>,
    /// Transition to the next node, by rows; empty at the last.
    pub(crate) phi: Vec<f64>,
    /// What gusts add on the way to the next node, where asked for.
    pub(crate) gusts: Vec<GustNoise>,
    /// What was known of the gusts before the node, where asked for.
    pub(crate) blowing: Vec<Blowing>,
}

/// What a filter knew of one axis' gust before a node: its value, and its covariance with all states.
#[derive(Clone, Debug)]
pub(crate) struct Blowing {
    pub(crate) axis: usize,
    /// Its place among the states.
    pub(crate) place: usize,
    pub(crate) value: f64,
    pub(crate) covariance: Vec<f64>,
    /// Its variance in the long run at the node's time.
    pub(crate) expected: f64,
}

/// What one axis' gust adds to the states' covariance over a step.
#[derive(Clone, Debug)]
pub(crate) struct GustNoise {
    pub(crate) axis: usize,
    /// The states that it reaches, and the covariance that it adds to them, on and below the diagonal by rows.
    pub(crate) states: Vec<usize>,
    pub(crate) added: Vec<f64>,
}

/// One channel's innovation.
#[derive(Clone, Debug)]
pub(crate) struct Innovation {
    pub(crate) slope: Vec<f64>,
    /// Covariance of the states with the innovation.
    pub(crate) covariance: Vec<f64>,
    pub(crate) value: f64,
    pub(crate) variance: f64,
    /// Its slopes by the columns.
    pub(crate) columns: Vec<f64>,
}

/// An instant at which something struck the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shock {
    /// Time from the run's first sample, s.
    pub(crate) t_s: f64,
    /// Gain of log marginal likelihood.
    pub(crate) gain: f64,
}

/// Expected number of shocks of at least `gain` among the given, by their own tail: the excess of the largest fiftieth over the rest follows
/// a generalised Pareto distribution, its scale and shape by probability-weighted moments (Hosking and Wallis 1987). A tail lighter than
/// an exponential one, which the largest of few may feign, counts as that.
pub(crate) fn expected_beyond(gain: f64, all: &[Shock]) -> f64 {
    const LARGEST: usize = 50;
    let mut gains: Vec<f64> = all.iter().map(|s| s.gain).collect();
    gains.sort_by(|a, b| b.total_cmp(a));
    let many = gains.len() / LARGEST;
    if many < 2 {
        return 0.0;
    }
    let n = many as f64;
    let threshold = gains[many];
    let excess = || gains[..many].iter().map(|g| g - threshold);
    let mean = excess().sum::<f64>() / n;
    // The k-th largest of n has a share of about (k + 0.35)/n above it, k from 0.
    let weighted = excess().enumerate().map(|(k, x)| (k as f64 + 0.35) / n * x).sum::<f64>() / n;
    let shape = (2.0 - mean / (mean - 2.0 * weighted)).max(0.0);
    let scale = mean * (1.0 - shape);
    let beyond = gain - threshold;
    if !(beyond > 0.0 && scale > 0.0) {
        n
    } else if shape < 1e-9 {
        n * (-beyond / scale).exp()
    } else {
        n * (1.0 + shape * beyond / scale).powf(-1.0 / shape)
    }
}

/// Score and information of what might be added to the `n` states just before each node, last node first.
pub(crate) fn backward(trace: &Trace, n: usize, mut each: impl FnMut(usize, &DVector<f64>, &DMatrix<f64>)) {
    let mut score = DVector::<f64>::zeros(n);
    let mut information = DMatrix::<f64>::zeros(n, n);
    for (at, node) in trace.nodes.iter().enumerate().rev() {
        if node.phi.len() == n * n {
            let phi = DMatrix::from_row_slice(n, n, &node.phi);
            score = phi.tr_mul(&score);
            information = phi.tr_mul(&information) * &phi;
        }
        for c in node.channels.iter().rev().take(POSE) {
            let (h, m) = (DVector::from_column_slice(&c.slope), DVector::from_column_slice(&c.covariance));
            let gain = m / c.variance;
            let through = c.value / c.variance - gain.dot(&score);
            score.axpy(through, &h, 1.0);
            let kept = &information * &gain;
            let all = gain.dot(&kept) + 1.0 / c.variance;
            information.ger(-1.0, &h, &kept, 1.0);
            information.ger(-1.0, &kept, &h, 1.0);
            information.ger(all, &h, &h, 1.0);
        }
        each(at, &score, &information);
    }
}

/// The likeliest kick at each instant, of `n` states, last instant first.
pub(crate) fn shocks(trace: &Trace, n: usize) -> Vec<Shock> {
    let mut all = Vec::with_capacity(trace.nodes.len());
    backward(trace, n, |at, score, information| {
        let b = SVector::<f64, 6>::from_fn(|i, _| PLAUSIBLE[i] * score[KICKED[i]]);
        let whole = SMatrix::<f64, 6, 6>::from_fn(|i, k| {
            PLAUSIBLE[i] * PLAUSIBLE[k] * information[(KICKED[i], KICKED[k])] + if i == k { 1.0 } else { 0.0 }
        });
        let Some(factor) = whole.cholesky() else { return };
        let gain = 0.5 * b.dot(&factor.solve(&b)) - factor.l().diagonal().map(f64::ln).sum();
        all.push(Shock { t_s: trace.nodes[at].t_s, gain });
    });
    all
}

#[cfg(test)]
pub(crate) mod tests;
