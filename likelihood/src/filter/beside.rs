//! likelihood: other sizes and shapes of the random inputs, beside a pass. In: a filter's steps and the inputs of other plants. Out: the
//! innovations that a filter with those inputs has.
//!
//! The filter of a plant whose random inputs alone differ goes through the same nodes with a covariance of its own; its states depart from
//! the filter's by a first-order difference, so that the equations of motion need not be flown again. Its scores and its information are
//! those of the innovations' slopes by hyperparameters (Gupta and Mehra 1974, IEEE Trans. Automatic Control 19, 774).

use super::rows::{add_rows, axpy};
use super::{Filter, Work};
use crate::random::Input;
use windfall_model::POSE;
use windfall_pid::equations::Local;

/// Innovations of a run's filter, a row a node.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeInnovations {
    /// Whitened innovations of the pose (zero where nothing was measured).
    pub(crate) whitened: Vec<[f64; POSE]>,
    /// Their variances, as those.
    pub(crate) variances: Vec<[f64; POSE]>,
    /// Log-likelihood of each node.
    pub(crate) nodes: Vec<f64>,
}

impl NodeInnovations {
    pub(super) fn with_capacity(nodes: usize) -> Self {
        Self { whitened: Vec::with_capacity(nodes), variances: Vec::with_capacity(nodes), nodes: Vec::with_capacity(nodes) }
    }
}

/// A filter with other random inputs.
pub(super) struct Beside {
    inputs: Vec<Input>,
    /// What its states are more than the filter's, and their covariance.
    dz: Vec<f64>,
    next: Vec<f64>,
    p: Vec<f64>,
    phi: Vec<f64>,
    q: Vec<f64>,
    ph: Vec<f64>,
    pub(super) seen: NodeInnovations,
}

impl Beside {
    /// At the start of a run; `None` where its inputs are not of the filter's kinds and orders.
    pub(super) fn new(filter: &Filter<'_>, inputs: Vec<Input>) -> Option<Self> {
        let n = filter.n;
        let alike = |(a, b): (&Input, &Input)| a.entry == b.entry && a.order == b.order;
        if inputs.len() != filter.random.len() || !inputs.iter().zip(&filter.random).all(alike) {
            return None;
        }
        let (p, seen) = (filter.start_covariance(&inputs), NodeInnovations::with_capacity(filter.run.nodes.len()));
        Some(Self {
            inputs,
            dz: vec![0.0; n],
            next: vec![0.0; n],
            p,
            phi: vec![0.0; n * n],
            q: vec![0.0; n * n],
            ph: vec![0.0; n],
            seen,
        })
    }

    /// A node begins.
    pub(super) fn begin(&mut self) {
        self.seen.whitened.push([0.0; POSE]);
        self.seen.variances.push([0.0; POSE]);
        self.seen.nodes.push(0.0);
    }

    /// Takes a channel of the node: `slope` by the states, noise of the measurement, and the filter's own innovation with its gain on the
    /// states (covariance over variance), not yet taken.
    #[inline(always)]
    pub(super) fn take(&mut self, channel: usize, slope: &[f64], noise: f64, innovation: f64, own: (&[f64], f64)) {
        let n = self.ph.len();
        self.ph.fill(0.0);
        add_rows(slope, &self.p, n, &mut self.ph);
        let dot = |a: &[f64]| slope.iter().zip(a).map(|(s, a)| s * a).sum::<f64>();
        let variance = dot(&self.ph) + noise;
        let root = variance.sqrt();
        let other = innovation - dot(&self.dz);
        let whitened = other / root;
        if let (Some(w), Some(v), Some(l)) =
            (self.seen.whitened.last_mut(), self.seen.variances.last_mut(), self.seen.nodes.last_mut())
        {
            (w[channel], v[channel]) = (whitened, variance);
            *l -= 0.5 * whitened * whitened + root.ln();
        }
        let (by, own_by) = (other / variance, innovation / own.1);
        for (i, row) in self.p.chunks_exact_mut(n).enumerate() {
            self.dz[i] += self.ph[i] * by - own.0[i] * own_by;
            if self.ph[i] != 0.0 {
                axpy(-self.ph[i] / variance, &self.ph, row);
            }
        }
    }
}

impl Filter<'_> {
    /// Other filters to the next node: `z` are the filter's states before its own step, `work` has the step's transition.
    #[inline(always)]
    pub(super) fn step_beside(&self, k: usize, z: &[f64], beside: &mut [Beside], local: &Local, work: &mut Work) {
        let (n, nm) = (self.n, self.nm);
        for other in beside {
            let Beside { inputs, dz, next, p, phi, q, .. } = other;
            // What does not come from the inputs is the same.
            phi.copy_from_slice(&work.undriven[0]);
            q.copy_from_slice(&work.undriven[1]);
            for (at, input) in self.placed(inputs) {
                let slopes = [&local.by_added, &work.pushed[0], &work.pushed[1]];
                self.driven((at, self.intensity(input, k)), input, slopes, phi, q);
            }
            // Φ' (z + dz) − Φ z, the motion of both by the same slopes.
            next.fill(0.0);
            for (i, next) in next.iter_mut().enumerate().take(self.states) {
                let (row, own) = (&phi[i * n..(i + 1) * n], &work.phi[i * n..(i + 1) * n]);
                *next = row.iter().zip(dz.iter()).map(|(a, d)| a * d).sum::<f64>();
                *next += (nm..self.states).map(|j| (row[j] - own[j]) * z[j]).sum::<f64>();
            }
            std::mem::swap(dz, next);
            self.spread_on(p, phi, q, [&mut work.half, &mut work.turned]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::filter::{PassSetting, pass};
    use crate::noise::declared;
    use crate::random_fit::slopes;
    use crate::run::Prepared;
    use windfall_model::{CATALOGUE, Flight, POSE};
    use windfall_sim::Seed;

    const BY: f64 = 1e-3;

    /// Innovations and variances beside a pass change as those of passes of their own do, by each size and length and in both forms of gusts:
    /// in gusts of 0.01 m/s within a hundredth of what all of them change by. Strong ones bend the motion: innovations within a half, variances
    /// within a twentieth, scores within a quarter of their standard deviation.
    #[test]
    fn exact_slopes_are_those_of_passes() {
        let file = windfall_scenarios::read_bundled("sage-perturbed").expect("a bundled scenario");
        let turbulence = CATALOGUE.iter().find(|e| e.family == "turbulence").expect("an effect of the catalogue");
        let with = |values: &[f64]| {
            let mut plant = file.declared_plant.clone();
            (turbulence.apply)(&mut plant, values);
            plant
        };
        for (size, bandwidth, most) in
            [(0.01, 0.0, [0.01, 0.01, 0.01]), (0.1, 0.0, [0.5, 0.05, 0.25]), (0.1, 1.5, [0.5, 0.05, 0.25])]
        {
            let values = [size, 0.7 * size, 0.4, 0.3, bandwidth];
            let moved = |i: usize| std::array::from_fn::<f64, 5, _>(|k| if k == i { values[k] * (1.0 + BY) } else { values[k] });
            let others: Vec<_> = (0..values.len()).filter(|&i| values[i] > 0.0).map(|i| with(&moved(i))).collect();
            let plant = with(&values);
            let flight = Flight { duration_s: 6.0, ..file.scenario.flights[0].clone() };
            let record = windfall_sim::fly(&plant, &flight, Seed { campaign: 5, run: 0 }).expect("a flight").record;
            let noise = declared(&plant.sensors);
            let run = Prepared::new(0, "short", &record, plant.environment.gas_constant_j_kg_k, 0.02, &noise[POSE]);
            let setting = PassSetting { beside: &others, ..PassSetting::plain(&plant, &noise) };
            let seen = pass(&run, &setting).expect("a pass");
            for (k, other) in others.iter().enumerate() {
                let own = pass(&run, &PassSetting { plant: other, beside: &[], ..setting }).expect("a pass").innovations;
                let (found, expected) = (slopes(&seen.innovations, &seen.beside[k], BY), slopes(&seen.innovations, &own, BY));
                let [score, its_score] = [&found, &expected].map(|s| s.likelihood.iter().sum::<f64>());
                let square = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>();
                for (found, expected, most) in
                    [(&found.innovations, &expected.innovations, most[0]), (&found.variances, &expected.variances, most[1])]
                {
                    let off: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
                    assert!(square(&off) < most * most * square(expected), "{size} {bandwidth} {k}");
                }
                let std = (square(&expected.innovations) + 0.5 * square(&expected.variances)).sqrt();
                assert!((score - its_score).abs() < most[2] * std, "{size} {bandwidth} {k}: {score} for {its_score}, {std}");
            }
        }
    }
}
