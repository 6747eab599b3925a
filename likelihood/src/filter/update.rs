//! likelihood: what a measurement does to the filter. In: state, covariance and sensitivities before a node. Out: the same after it.

use super::beside::Beside;
use super::rows::axpy;
use super::{Filter, Ready, SETTLED_S, Seen, Work};
use crate::columns::{Shown, Site, View, shown};
use crate::run::Node;
use crate::shock::Innovation;
use windfall_model::{Entry, POSE};
use windfall_pid::equations::{Dual, MOTION, STATES};

impl Filter<'_> {
    /// Measurement update at a node, channel by channel (their white noise is independent).
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    #[inline(always)]
    pub(super) fn update(
        &self,
        k: usize,
        z: &mut [f64],
        p: &mut [f64],
        s: &mut [f64],
        rate: &[f64; MOTION],
        columns: &[Ready<'_>],
        view: &View,
        seen: &mut Seen,
        rows: &mut Vec<f64>,
        beside: &mut [Beside],
        work: &mut Work,
    ) {
        let (n, node) = (self.n, &self.run.nodes[k]);
        let predicted = self.slopes_by_states(k, z, rate, work);
        self.slopes_by_columns(k, z, rate, &predicted, columns, view, work);
        let (mut whitened, mut variances) = ([0.0; POSE], [0.0; POSE]);
        let so_far = seen.log_likelihood;
        let before = z.to_vec();
        beside.iter_mut().for_each(Beside::begin);
        for c in 0..if node.pose.count > 0.0 { POSE } else { 0 } {
            let (innovation, variance) = self.innovation(c, node, predicted[c], z, &before, p, s, work);
            let root = variance.sqrt();
            let w = innovation / root;
            seen.log_likelihood -= 0.5 * w * w + root.ln();
            if node.t_s > SETTLED_S {
                let sums = &mut seen.channels[c];
                *sums = [sums[0] + innovation * innovation, sums[1] + variance, sums[2] + w * w, sums[3] + 1.0];
            }
            (whitened[c], variances[c]) = (w, variance);
            rows.extend(work.d[..self.columns].iter().map(|x| x / root));
            rows.push(w);
            if let Some(node) = seen.trace.nodes.last_mut() {
                let slope = work.h[c * n..(c + 1) * n].to_vec();
                node.channels.push(Innovation {
                    slope,
                    covariance: work.ph.clone(),
                    value: innovation,
                    variance,
                    columns: work.d[..self.columns].to_vec(),
                });
            }
            let (slope, noise) = (&work.h[c * n..(c + 1) * n], self.white[c] / node.pose.count);
            for other in &mut *beside {
                other.take(c, slope, noise, innovation, (&work.ph, variance));
            }
            self.correct(z, p, s, innovation, variance, work);
        }
        seen.innovations.whitened.push(whitened);
        seen.innovations.variances.push(variances);
        seen.innovations.nodes.push(seen.log_likelihood - so_far);
    }

    /// What the channels show, and their slopes by the states.
    #[inline(always)]
    fn slopes_by_states(&self, k: usize, z: &[f64], rate: &[f64; MOTION], work: &mut Work) -> Shown {
        let n = self.n;
        let samples = &self.run.nodes[k].pose;
        let mut x = [Dual::<STATES>::default(); STATES];
        x.iter_mut().zip(z).enumerate().for_each(|(i, (x, z))| *x = Dual::variable(*z, i));
        let arm = self.plant.vehicle.p_origin_cm.to_array();
        let all = shown(&self.plant.sensors, arm, &x, rate, [samples.tau_s, samples.tau2_s2]);
        let h = &mut work.h;
        h.fill(0.0);
        for (c, channel) in all.iter().enumerate() {
            h[c * n..c * n + STATES].copy_from_slice(&channel.slopes);
        }
        for (at, channel, _) in self.colours() {
            h[channel * n + at] = 1.0;
        }
        for (at, input) in self.inputs() {
            if let Entry::RecordedPose(channel) = input.entry {
                h[channel * n + at] = 1.0;
            }
        }
        all.map(|channel| channel.value)
    }

    /// What columns do to the channels at once.
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    #[inline(always)]
    fn slopes_by_columns(
        &self,
        k: usize,
        z: &[f64],
        rate: &[f64; MOTION],
        predicted: &Shown,
        columns: &[Ready<'_>],
        view: &View,
        work: &mut Work,
    ) {
        let nc = self.nc;
        let direct = &mut work.direct;
        direct.fill(0.0);
        for (j, column) in columns.iter().enumerate() {
            match column {
                Ready::Plant { plant, step, shows: true, .. } => {
                    let moved = self.shown(plant, z, rate, k);
                    (0..POSE).for_each(|c| direct[c * nc + j] = (moved[c] - predicted[c]) / step);
                }
                Ready::Generic(Site::Channel(channel), basis) => direct[channel * nc + j] = basis.value(view),
                _ => {}
            }
        }
    }

    /// Innovation of a channel and its variance; the channel's covariance with the states and its slopes by the columns stay in `work`.
    #[expect(clippy::too_many_arguments, reason = "the state of one filter, borrowed in parts")]
    #[inline(always)]
    fn innovation(
        &self,
        c: usize,
        node: &Node,
        predicted: f64,
        z: &[f64],
        before: &[f64],
        p: &[f64],
        s: &[f64],
        work: &mut Work,
    ) -> (f64, f64) {
        let (n, nc) = (self.n, self.nc);
        let noise = self.white[c] / node.pose.count;
        let hc = &work.h[c * n..(c + 1) * n];
        let ph = &mut work.ph;
        ph.fill(0.0);
        let mut noise_state = 0.0;
        let mut carried = 0.0;
        let d = &mut work.d;
        d.copy_from_slice(&work.direct[c * nc..(c + 1) * nc]);
        for i in (0..n).filter(|&i| hc[i] != 0.0) {
            axpy(hc[i], &p[i * n..(i + 1) * n], ph);
            axpy(hc[i], &s[i * nc..(i + 1) * nc], d);
            carried += hc[i] * (z[i] - before[i]);
            // Noise and drift, which the channels show beside the motion.
            if i >= self.nm {
                noise_state += hc[i] * before[i];
            }
        }
        let variance = hc.iter().zip(ph.iter()).map(|(a, b)| a * b).sum::<f64>() + noise;
        (node.y[c] - predicted - noise_state - carried, variance)
    }

    /// State, covariance and sensitivities after an innovation.
    #[inline(always)]
    fn correct(&self, z: &mut [f64], p: &mut [f64], s: &mut [f64], innovation: f64, variance: f64, work: &Work) {
        let (n, nc) = (self.n, self.nc);
        let (ph, d) = (&work.ph, &work.d);
        for i in 0..self.states {
            let gain = ph[i] / variance;
            if gain == 0.0 {
                continue;
            }
            z[i] += gain * innovation;
            axpy(-gain, d, &mut s[i * nc..(i + 1) * nc]);
            axpy(-gain, ph, &mut p[i * n..(i + 1) * n]);
        }
    }
}

#[cfg(test)]
mod tests;
