//! pid: one run of an output-error problem, linearised. In: a run, nominal trajectory in pieces, parameters, noise. Out: what the
//! run says about the parameters alone, and the trajectory's step once theirs is known.
//!
//! Each piece's measurements and the meeting condition go through a QR factorisation from the last piece to the first, which
//! eliminates the jerk of the tunnel speed and the node's state (square-root information, Bierman 1977, run backward so that the
//! forward pass needs no inverse of a damped motion). The work is linear in the length of the run.

use super::{FreeColumns, NODE, Nominal, PreparedRun, SPEED, split};
use crate::equations::{STATES, Transition};
use nalgebra::{DMatrix, DVector};
use windfall_model::{CHANNELS, PerChannel};

/// A linearised run: pieces with their elimination, and what is left for the parameters.
#[derive(Clone, Debug)]
pub(crate) struct Linearised {
    pieces: Vec<Piece>,
    /// `[S | S_θ | s]` of the first node.
    start: DMatrix<f64>,
    /// `[R | r]` over the parameters, and the misfit in the corner.
    pub(crate) information: DMatrix<f64>,
}

#[derive(Clone, Debug)]
struct Piece {
    /// `[Φ | Γ | d]` to the next node.
    forward: DMatrix<f64>,
    /// `[ρ | a_z | a_θ | a]`: the jump given node and parameters.
    policy: DVector<f64>,
}

/// A step of nodes and jumps for a step of the parameters.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub(crate) nodes: Vec<DVector<f64>>,
}

impl PreparedRun<'_> {
    /// Linearises about a nominal trajectory; `None` where the flight cannot go on.
    pub(crate) fn linearise(
        &self,
        nominal: &Nominal,
        c: &FreeColumns,
        std: &PerChannel<f64>,
        work: &mut Transition,
    ) -> Option<Linearised> {
        let width = NODE + c.free + 1;
        let mut cost = DMatrix::<f64>::zeros(0, width);
        let mut information = DMatrix::<f64>::zeros(c.free + 1, c.free + 1);
        let mut pieces = Vec::with_capacity(nominal.nodes.len());
        for k in (0..nominal.nodes.len()).rev() {
            let (x, s) = split(&nominal.nodes[k]);
            if !self.segment(k, c).differentiate(x, &s, work) {
                return None;
            }
            let (_, samples) = self.span(k);
            let next = nominal.nodes.get(k + 1);
            let met = if next.is_some() { NODE + 1 } else { 0 };
            let rows = (met + c.free + 1 + CHANNELS * samples).max(width + 1);
            let mut a = DMatrix::<f64>::zeros(rows, width + 1);
            let forward = next.map(|next| self.forward(next, &s, c, work));
            if let Some(f) = &forward {
                // Cost to go of the next node, in terms of jump, this node and the parameters.
                let to_go = cost.columns(0, NODE);
                a.view_mut((0, 0), (NODE, 1)).copy_from(&(to_go.column(NODE - 1) * self.jump_std));
                a.view_mut((0, 1), (NODE, width)).copy_from(&(to_go * f));
                let mut right = a.view_mut((0, 1 + NODE), (NODE, c.free + 1));
                right.columns_mut(0, c.free).zip_apply(&cost.columns(NODE, c.free), |x, y| *x += y);
                right.column_mut(c.free).zip_apply(&cost.column(width - 1), |x, y| *x = y - *x);
                a[(NODE, 0)] = 1.0;
            }
            a.view_mut((met, 1 + NODE), (c.free + 1, c.free + 1)).copy_from(&information);
            self.measure(k, nominal, c, std, work, &mut a, met + c.free + 1);
            let r = a.qr().unpack_r();
            cost = r.view((1, 1), (NODE, width)).into_owned();
            information = r.view((1 + NODE, 1 + NODE), (c.free + 1, c.free + 1)).into_owned();
            if let Some(forward) = forward {
                pieces.push(Piece { forward, policy: r.row(0).transpose() });
            }
        }
        pieces.reverse();
        Some(Linearised { pieces, start: cost, information })
    }

    /// `[Φ | Γ | d]` of a piece to the next node.
    fn forward(&self, next: &[f64; NODE], s: &[f64; SPEED], c: &FreeColumns, work: &Transition) -> DMatrix<f64> {
        let width = NODE + c.free;
        let mut f = DMatrix::zeros(NODE, width + 1);
        let (states, slopes) = (&work.states[self.piece - 1], &work.slopes[self.piece - 1]);
        for (i, row) in slopes.chunks_exact(width).enumerate() {
            for (j, v) in row.iter().enumerate() {
                f[(i, j)] = *v;
            }
        }
        let t = self.piece as f64 * self.interval_s;
        for i in 0..SPEED {
            f[(STATES + i, STATES + i)] = 1.0;
        }
        f[(12, 13)] = t;
        f[(12, 14)] = 0.5 * t * t;
        f[(13, 14)] = t;
        let end = self.end(states, s);
        for i in 0..NODE {
            f[(i, width)] = end[i] - next[i];
        }
        f
    }

    /// Rows of the piece's measurements: slopes of the predicted outputs and residuals, over their noise.
    #[expect(clippy::too_many_arguments, reason = "the parts of one linearisation, each of its own type")]
    fn measure(
        &self,
        k: usize,
        nominal: &Nominal,
        c: &FreeColumns,
        std: &PerChannel<f64>,
        work: &Transition,
        a: &mut DMatrix<f64>,
        mut row: usize,
    ) {
        let (first, samples) = self.span(k);
        let (x, s) = split(&nominal.nodes[k]);
        let width = NODE + c.free;
        let mut buffer = vec![0.0; width];
        for i in 0..samples {
            let at = if i == 0 { &x } else { &work.states[i - 1] };
            let speed = self.speed(i, &s);
            let residual = self.left(first + i, at, speed, c);
            let outputs = self.outputs(first + i, at, speed, c);
            for channel in 0..CHANNELS {
                self.slopes(i, channel, &outputs, c, work, &mut buffer);
                let weight = 1.0 / std[channel];
                for (j, v) in buffer.iter().enumerate() {
                    a[(row, 1 + j)] = v * weight;
                }
                a[(row, 1 + width)] = residual[channel] * weight;
                row += 1;
            }
        }
    }

    /// Slopes of every output by the parameters when the trajectory and the tunnel speed follow as fits best: series by channel,
    /// then parameter.
    pub(crate) fn profiled_slopes(
        &self,
        nominal: &Nominal,
        linear: &Linearised,
        c: &FreeColumns,
        work: &mut Transition,
    ) -> Option<Vec<Vec<Vec<f64>>>> {
        let width = NODE + c.free;
        let steps: Vec<Step> = (0..c.free)
            .map(|j| {
                let mut unit = DVector::zeros(c.free);
                unit[j] = 1.0;
                linear.step(&unit, false, self.jump_std)
            })
            .collect::<Option<_>>()?;
        let mut series = vec![vec![Vec::with_capacity(self.record.len()); c.free]; CHANNELS];
        let mut buffer = vec![0.0; width];
        for (k, node) in nominal.nodes.iter().enumerate() {
            let (x, s) = split(node);
            if !self.segment(k, c).differentiate(x, &s, work) {
                return None;
            }
            for i in 0..self.span(k).1 {
                let at = if i == 0 { &x } else { &work.states[i - 1] };
                let outputs = self.outputs(self.span(k).0 + i, at, self.speed(i, &s), c);
                for (channel, series) in series.iter_mut().enumerate() {
                    self.slopes(i, channel, &outputs, c, work, &mut buffer);
                    for (j, (series, step)) in series.iter_mut().zip(&steps).enumerate() {
                        let through = step.nodes[k].iter().zip(&buffer).map(|(z, b)| z * b).sum::<f64>();
                        series.push(through + buffer[NODE + j]);
                    }
                }
            }
        }
        Some(series)
    }

    /// A step of the whole trajectory, given that of the parameters.
    pub(crate) fn step(&self, linear: &Linearised, parameters: &DVector<f64>) -> Option<Step> {
        linear.step(parameters, true, self.jump_std)
    }
}

impl Linearised {
    /// Rolls a step out from the first node; `whole` adds what residuals and gaps ask for, otherwise only what the parameters do.
    fn step(&self, parameters: &DVector<f64>, whole: bool, jump_std: f64) -> Option<Step> {
        let free = parameters.len();
        let on = if whole { 1.0 } else { 0.0 };
        let right = self.start.column(NODE + free) * on - self.start.columns(NODE, free) * parameters;
        let mut node = self.start.view((0, 0), (NODE, NODE)).into_owned().solve_upper_triangular(&right)?;
        let mut nodes = Vec::with_capacity(self.pieces.len() + 1);
        for piece in &self.pieces {
            let p = &piece.policy;
            let known = p.rows(1, NODE).dot(&node) + p.rows(1 + NODE, free).dot(parameters);
            let jump = if p[0] == 0.0 { 0.0 } else { (on * p[1 + NODE + free] - known) / p[0] };
            let f = &piece.forward;
            let mut next = f.columns(0, NODE) * &node + f.columns(NODE, free) * parameters + f.column(NODE + free) * on;
            next[NODE - 1] += jump_std * jump;
            nodes.push(std::mem::replace(&mut node, next));
        }
        nodes.push(node);
        Some(Step { nodes })
    }
}

impl Nominal {
    /// Moved by a fraction of a step.
    pub(crate) fn moved(&self, step: &Step, fraction: f64) -> Self {
        let one = |(z, d): (&[f64; NODE], &DVector<f64>)| std::array::from_fn(|j| z[j] + fraction * d[j]);
        Self { nodes: self.nodes.iter().zip(&step.nodes).map(one).collect() }
    }
}

#[cfg(test)]
impl Linearised {
    /// What a run says about the parameters, `[R | r]`, without a trajectory.
    pub(crate) fn only(information: DMatrix<f64>) -> Self {
        Self { pieces: Vec::new(), start: DMatrix::default(), information }
    }
}
