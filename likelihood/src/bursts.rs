//! likelihood: gusts that come in bursts. In: a fitted model with gusts. Out: how their variance changes along each run, and what knowing so costs.
//!
//! The logarithm of each axis' variance over its mean is a first-order Gaussian process, given at knots. Its slope by the noise that drives the
//! gusts follows from one pass backward over a run (Koopman 1993, the disturbance smoother; its expected information is the share of the
//! driving noise that is seen), its size and memory from the marginal likelihood by Laplace's approximation (Kass and Raftery 1995).

use crate::engine::Engine;
use crate::intensity::{Intensity, KNOT_S, place};
use crate::model::Model;
use crate::run::whole;
use crate::shock::{GustNoise, Trace, backward};

/// Memories of the process that are tried, s.
const MEMORIES_S: [f64; 4] = [0.4, 1.0, 2.5, 6.0];
/// Standard deviations of the process that are tried.
const SIZES: [f64; 5] = [0.2, 0.4, 0.8, 1.5, 2.5];
/// Information over half the share of the driving noise that is seen: spectra that fall with a high power of frequency (a sixth: 5/6).
const SEEN_TWICE: f64 = 5.0 / 6.0;
/// Most steps, longest step of a logarithm, and the step that ends them.
const STEPS: usize = 12;
const LONGEST: f64 = 1.0;
const SMALL: f64 = 0.05;
/// Standard errors of the score for a changing variance from which it is looked at.
const LOOKED_AT: f64 = 3.0;
/// Axes that share a size: along the stream, across it.
const AXES: [&[usize]; 2] = [&[0], &[1, 2]];
/// Farthest logarithm: what is calmer is not told from calm.
const FARTHEST: f64 = 6.0;

/// Slopes of the log-likelihood by an axis' logarithms in a run, and their expected information: its diagonal and the one beside it.
struct Slopes {
    gradient: Vec<f64>,
    own: Vec<f64>,
    next: Vec<f64>,
}

/// Slopes of a run of which a filter with so many states kept what it did, by axis; none where no gust acts along it.
fn slopes(duration_s: f64, trace: &Trace, states: usize) -> [Option<Slopes>; 3] {
    let knots = whole((duration_s / KNOT_S).ceil()) + 1;
    let mut all: [Option<Slopes>; 3] = Default::default();
    if knots < 3 {
        return all;
    }
    backward(trace, states, |to, score, information| {
        let Some(from) = to.checked_sub(1).map(|k| &trace.nodes[k]) else { return };
        let (k, by) = place(from.t_s, knots);
        for GustNoise { axis, states, added } in &from.gusts {
            let (mut squares, mut share, mut entries) = (0.0, 0.0, added.iter());
            for (i, a) in states.iter().enumerate() {
                for (b, q) in states[..=i].iter().zip(&mut entries) {
                    let both = if a == b { *q } else { 2.0 * q };
                    squares += both * score[*a] * score[*b];
                    share += both * information[(*a, *b)];
                }
            }
            let empty = || Slopes { gradient: vec![0.0; knots], own: vec![0.0; knots], next: vec![0.0; knots - 1] };
            let slopes = all[*axis].get_or_insert_with(empty);
            let (slope, information) = (0.5 * (squares - share), 0.5 * SEEN_TWICE * share);
            for (knot, weight) in [(k, 1.0 - by), (k + 1, by)] {
                slopes.gradient[knot] += weight * slope;
                slopes.own[knot] += weight * weight * information;
            }
            slopes.next[k] += by * (1.0 - by) * information;
        }
    });
    all
}

/// One axis of one run about where its logarithms are: what the likelihood is there, to second order.
struct Local {
    run: usize,
    axis: usize,
    logs: Vec<f64>,
    slopes: Slopes,
}

/// Likeliest logarithms with a process.
struct Posterior {
    logs: Vec<f64>,
    /// What the process brings over a constant variance, in log marginal likelihood.
    gain: f64,
    /// What it takes off the log-likelihood at its top.
    price: f64,
}

/// A first-order process at knots: its standard deviation, the share of a value that is kept to the next knot, the variance that is added there.
#[derive(Clone, Copy, Debug)]
struct Process {
    std: f64,
    kept: f64,
    fresh: f64,
}

impl Process {
    fn new(std: f64, memory_s: f64) -> Self {
        let kept = (-KNOT_S / memory_s).exp();
        Self { std, kept, fresh: std * std * (1.0 - kept * kept) }
    }
}

impl Local {
    /// Logarithms that information and a process' precision, both of two diagonals, make `right`, and the pivots of their sum.
    fn solved(&self, process: Process, right: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let Process { kept, fresh, .. } = process;
        let n = right.len();
        let precision = |k: usize| if k == 0 || k + 1 == n { 1.0 / fresh } else { (1.0 + kept * kept) / fresh };
        let beside = |k: usize| self.slopes.next[k] - kept / fresh;
        let (mut pivots, mut logs) = (Vec::with_capacity(n), right.to_vec());
        for k in 0..n {
            let mut pivot = self.slopes.own[k] + precision(k);
            if k > 0 {
                let by = beside(k - 1) / pivots[k - 1];
                pivot -= by * beside(k - 1);
                logs[k] -= by * logs[k - 1];
            }
            pivots.push(pivot);
        }
        for k in (0..n).rev() {
            let after = if k + 1 < n { beside(k) * logs[k + 1] } else { 0.0 };
            logs[k] = (logs[k] - after) / pivots[k];
        }
        (logs, pivots)
    }

    fn posterior(&self, process: Process) -> Posterior {
        let Slopes { gradient, own, next } = &self.slopes;
        let n = self.logs.len();
        // gᵀ(c - c₀) - ½ (c - c₀)ᵀ I (c - c₀) is linear in c by g + I c₀.
        let of = |v: &[f64], k: usize| {
            let before = if k > 0 { next[k - 1] * v[k - 1] } else { 0.0 };
            let after = if k + 1 < n { next[k] * v[k + 1] } else { 0.0 };
            before + own[k] * v[k] + after
        };
        let linear: Vec<f64> = (0..n).map(|k| gradient[k] + of(&self.logs, k)).collect();
        let (logs, pivots) = self.solved(process, &linear);
        // ½ ln det(I Σ + 1).
        let spread = 2.0 * process.std.ln() + (n as f64 - 1.0) * process.fresh.ln();
        let volume = 0.5 * (pivots.iter().map(|p| p.ln()).sum::<f64>() + spread);
        let curved: f64 = (0..n).map(|k| logs[k] * of(&logs, k)).sum();
        let fit = product(&linear, &logs);
        Posterior { gain: 0.5 * fit - volume, price: 0.5 * (fit - curved) + volume, logs }
    }

    /// Score of the process' variance where that is zero, and its own variance.
    fn score(&self, memory_s: f64) -> (f64, f64) {
        let Slopes { gradient, own, next } = &self.slopes;
        let n = own.len();
        let seen: Vec<f64> =
            (0..n).map(|k| own[k] + if k > 0 { next[k - 1] } else { 0.0 } + next.get(k).copied().unwrap_or(0.0)).collect();
        let (mut score, mut variance) = (0.0, 0.0);
        for i in 0..n {
            for k in 0..n {
                let together = (-KNOT_S * i.abs_diff(k) as f64 / memory_s).exp();
                score += 0.5 * together * gradient[i] * gradient[k];
                variance += 0.5 * together * together * seen[i] * seen[k];
            }
            score -= 0.5 * seen[i];
        }
        (score, variance)
    }
}

impl Engine {
    /// Sizes of the gusts over their mean that a twentieth and nineteen twentieths of the time are below; none where they are steady.
    #[must_use]
    pub fn bursts(&self) -> Option<[f64; 2]> {
        let mut all: Vec<f64> =
            self.runs.iter().flat_map(|r| r.intensity.logs.iter().flatten()).map(|log| (0.5 * log).exp()).collect();
        all.sort_by(f64::total_cmp);
        let at = |share: f64| all.get(whole(share * (all.len().max(1) - 1) as f64)).copied();
        Some([at(0.05)?, at(0.95)?])
    }

    /// The same runs with the variance of the gusts along each as it is likeliest with a model's gusts; none where there are no gusts or
    /// their variance does not change.
    pub(crate) fn in_bursts(&self, model: &Model) -> Option<Self> {
        let mut engine = self.clone();
        engine.bursts_price = 0.0;
        engine.runs.iter_mut().for_each(|r| r.intensity = Intensity::default());
        for step in 0..STEPS {
            let locals = engine.locals(model)?;
            if step == 0 {
                standing_out(&locals).filter(|score| *score > LOOKED_AT)?;
            }
            let processes = SIZES.iter().flat_map(|std| MEMORIES_S.map(|memory_s| Process::new(*std, memory_s)));
            let (process, likeliest) = processes
                .map(|process| (process, locals.iter().map(|l| l.posterior(process)).collect::<Vec<_>>()))
                .max_by(|a, b| sum(&a.1, |p| p.gain).total_cmp(&sum(&b.1, |p| p.gain)))?;
            engine.bursts_std = AXES.map(|axes| mean_std(&locals, process, axes));
            engine.bursts_price = sum(&likeliest, |p| p.price);
            let mut largest: f64 = 0.0;
            for (local, posterior) in locals.iter().zip(&likeliest) {
                let further = |(from, to): (&f64, &f64)| {
                    let (by, next) = towards(*from, *to);
                    largest = largest.max(by.abs());
                    next
                };
                let logs = local.logs.iter().zip(&posterior.logs).map(further).collect();
                engine.runs[local.run].intensity.logs[local.axis] = logs;
            }
            if largest < SMALL {
                break;
            }
        }
        engine.about_their_mean();
        Some(engine)
    }

    fn locals(&self, model: &Model) -> Option<Vec<Local>> {
        let seen = self.traced_with_gusts(model).ok()?;
        let mut all = Vec::new();
        for (i, (run, seen)) in self.runs.iter().zip(&seen).enumerate() {
            for (axis, slopes) in slopes(run.duration_s(), &seen.trace, seen.states).into_iter().enumerate() {
                let Some(slopes) = slopes else { continue };
                let logs = match &run.intensity.logs[axis] {
                    logs if logs.is_empty() => vec![0.0; slopes.gradient.len()],
                    logs => logs.clone(),
                };
                all.push(Local { run: i, axis, logs, slopes });
            }
        }
        (!all.is_empty()).then_some(all)
    }

    /// Takes the mean variance out, of axial and of lateral gusts: that is their size.
    fn about_their_mean(&mut self) {
        for axes in AXES {
            let all = || axes.iter().flat_map(|axis| self.runs.iter().flat_map(|run| &run.intensity.logs[*axis]));
            let count = all().count().max(1) as f64;
            let mean = (all().map(|log| log.exp()).sum::<f64>() / count).max(f64::MIN_POSITIVE).ln();
            for run in &mut self.runs {
                axes.iter().for_each(|axis| run.intensity.logs[*axis].iter_mut().for_each(|log| *log -= mean));
            }
        }
    }
}

/// Score for a changing variance in all runs, over its standard error: the larger one of two memories.
fn standing_out(locals: &[Local]) -> Option<f64> {
    let scored = |memory: &f64| locals.iter().map(|l| l.score(*memory)).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    MEMORIES_S[1..3].iter().map(scored).map(|(score, variance)| score / variance.sqrt()).max_by(f64::total_cmp)
}

/// Step towards a logarithm, none longer than the longest, and where it ends, no farther than the farthest.
fn towards(from: f64, to: f64) -> (f64, f64) {
    let by = (to - from).clamp(-LONGEST, LONGEST);
    (by, (from + by).clamp(-FARTHEST, FARTHEST))
}

/// Standard deviation of the logarithm of the gusts' size, the root of their mean variance, that bursts leave.
fn mean_std(locals: &[Local], process: Process, axes: &[usize]) -> f64 {
    let (mut variance, mut sum) = (0.0, 0.0);
    for local in locals.iter().filter(|l| axes.contains(&l.axis)) {
        let weights: Vec<f64> = local.logs.iter().map(|log| log.exp()).collect();
        variance += product(&weights, &local.solved(process, &weights).0);
        sum += weights.iter().sum::<f64>();
    }
    if sum > 0.0 { 0.5 * variance.sqrt() / sum } else { 0.0 }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn sum(all: &[Posterior], of: impl Fn(&Posterior) -> f64) -> f64 {
    all.iter().map(of).sum()
}

#[cfg(test)]
mod tests;
