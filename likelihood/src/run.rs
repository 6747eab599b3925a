//! likelihood: a run made ready for the filter. In: a record. Out: nodes, each the mean of a few neighbouring samples, and a start.
//!
//! A node stands for a block of samples: the mean of what was measured less what motion over the block explains carries all that a filter
//! can use below the block's own rate, at a fraction of its cost. Missing samples leave a node with fewer, or none.

use crate::intensity::Intensity;
use crate::noise::ChannelNoise;
use crate::wind::Speed;
use windfall_model::{CHANNELS, POSE, PerChannel, Record};

/// Mean over the samples of a block that were measured.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mean {
    /// How many samples.
    pub(crate) count: f64,
    /// Mean of their times from the node, and of the squares, s and s².
    pub(crate) tau_s: f64,
    pub(crate) tau2_s2: f64,
}

/// One instant of the filter.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// Time from the run's first sample, s.
    pub(crate) t_s: f64,
    /// Density, kg/m³.
    pub(crate) density_kg_m3: f64,
    pub(crate) pose: Mean,
    /// Means of the channels.
    pub(crate) y: [f64; POSE],
}

/// A run ready for the filter.
#[derive(Clone, Debug)]
pub(crate) struct Prepared {
    /// Index in the campaign.
    pub(crate) index: usize,
    pub(crate) name: String,
    /// Sample interval, samples a node.
    pub(crate) interval_s: f64,
    pub(crate) block: usize,
    pub(crate) nodes: Vec<Node>,
    /// Position of the origin (m), Euler angles (rad) and their rates at the first node.
    pub(crate) start: [[f64; 2]; POSE],
    /// Tunnel speed along the run.
    pub(crate) speed: Speed,
    /// Mean airspeed, m/s.
    pub(crate) speed_m_s: f64,
    /// Variance of its noise over that of all runs together, by channel.
    pub(crate) noise_ratio: PerChannel<f64>,
    /// Variance of the gusts along the run over its mean.
    pub(crate) intensity: Intensity,
}

impl Prepared {
    /// Blocks of about `node_s`; `noise` is the tunnel speed's.
    pub(crate) fn new(index: usize, name: &str, record: &Record, gas_constant: f64, node_s: f64, noise: &ChannelNoise) -> Self {
        let (series, dt) = (&record.vw_m_s, record.interval_s());
        let (first, every) = record.wind_rows.map_or((0, 1), |rows| (rows.first, rows.every));
        let missing = |i: usize| record.bridged.get(first + every * i).copied().unwrap_or(false);
        let sampled: Vec<f64> = series.iter().skip(first).step_by(every).copied().collect();
        Self {
            index,
            name: name.to_owned(),
            interval_s: dt,
            block: 0,
            nodes: Vec::new(),
            start: [[0.0; 2]; POSE],
            speed: Speed::new(&sampled, every as f64 * dt, noise, &missing).from(first as f64 * dt),
            speed_m_s: record.mean_airspeed_m_s(),
            noise_ratio: [1.0; CHANNELS],
            intensity: Intensity::default(),
        }
        .in_nodes(record, gas_constant, node_s)
    }

    /// The same run in blocks of about `node_s`.
    pub(crate) fn in_nodes(self, record: &Record, gas_constant: f64, node_s: f64) -> Self {
        let (n, dt) = (record.len(), record.interval_s());
        let block = whole(node_s / dt).max(1);
        let channels = record.channels();
        let missing = |i: usize| record.bridged.get(i).copied().unwrap_or(false);
        let nodes: Vec<Node> = (0..n / block)
            .map(|k| {
                let first = k * block;
                let centre = first as f64 + 0.5 * (block as f64 - 1.0);
                let mut node = Node { t_s: centre * dt, density_kg_m3: 0.0, pose: Mean::default(), y: [0.0; POSE] };
                for i in first..first + block {
                    node.density_kg_m3 += record.ps_pa[i] / (gas_constant * record.ts_k[i]) / block as f64;
                    if missing(i) {
                        continue;
                    }
                    let tau = (i as f64 - centre) * dt;
                    node.pose.add(tau);
                    node.y.iter_mut().zip(&channels).for_each(|(y, series)| *y += series[i]);
                }
                (0..POSE).for_each(|c| node.y[c] /= node.pose.count.max(1.0));
                node.pose.close();
                node
            })
            .collect();
        let at_s = nodes.first().map_or(0.0, |k| k.t_s);
        let start = std::array::from_fn(|c| start_of(channels[c], dt, at_s, &missing));
        Self { block, start, nodes, ..self }
    }

    /// Time between nodes as the record's clock has it, s.
    pub(crate) fn step_s(&self) -> f64 {
        self.block as f64 * self.interval_s
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.nodes.last().map_or(0.0, |n| n.t_s)
    }
}

impl Mean {
    fn add(&mut self, tau: f64) {
        self.count += 1.0;
        self.tau_s += tau;
        self.tau2_s2 += tau * tau;
    }
    fn close(&mut self) {
        if self.count > 0.0 {
            self.tau_s /= self.count;
            self.tau2_s2 /= self.count;
        }
    }
}

/// A whole number that is not negative.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small numbers of samples")]
pub(crate) fn whole(x: f64) -> usize {
    x.round().max(0.0) as usize
}

/// Time over which the start is fitted, s.
const START_S: f64 = 0.25;

/// Value and rate at time `at_s` of a cubic through the first quarter of a second.
fn start_of(series: &[f64], dt: f64, at_s: f64, missing: &dyn Fn(usize) -> bool) -> [f64; 2] {
    let many = whole(START_S / dt).clamp(8, series.len().max(8)).min(series.len());
    let used: Vec<usize> = (0..many).filter(|&i| !missing(i)).collect();
    let a = nalgebra::DMatrix::from_fn(used.len(), 4, |r, c| {
        ((used[r] as f64 * dt - at_s) / START_S).powi(i32::try_from(c).unwrap_or(0))
    });
    let y = nalgebra::DVector::from_fn(used.len(), |r, _| series[used[r]]);
    a.svd(true, true).solve(&y, 1e-12).map_or([series.first().copied().unwrap_or(0.0), 0.0], |p| [p[0], p[1] / START_S])
}

#[cfg(test)]
mod tests;
