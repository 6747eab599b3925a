//! pid: one run of an output-error problem, linearised. In: record, nominal trajectory in pieces, parameters, noise. Out: what the
//! run says about the parameters alone, and the trajectory's step once theirs is known.
//!
//! The run is cut into pieces (multiple shooting; Bock 1987): every node has its own state, and pieces must meet. Each piece's
//! measurements and the meeting condition go through a QR factorisation from the last piece to the first, which eliminates the
//! jerk of the tunnel speed and the node's state (square-root information, Bierman 1977, run backward so that the forward pass
//! needs no inverse of a damped motion). The work is linear in the length of the run.

use super::instruments::{Errors, Known, STATE_OF, VARIABLES, observe, variables};
use super::speed::liveliness;
use crate::PidError;
use crate::equations::{Air, Craft, Drive, Dual, Extra, INPUTS, STATES, Segment, Transition, origin, origin_slopes};
use crate::smooth::{Smoother, smooth};
use crate::states::states;
use nalgebra::{DMatrix, DVector};
use windfall_model::{Plant, Record};

/// Channels: X, Y, Z, R_x, R_y, R_z, V_W.
pub(crate) const CHANNELS: usize = 7;
/// Input states: tunnel speed and its first and second derivative.
pub(crate) const SPEED: usize = 3;
/// Numbers at a node.
pub(crate) const NODE: usize = STATES + SPEED;
/// Length of a piece, s: short against the pitch mode's 1 s, long against the sample.
const PIECE_S: f64 = 0.05;

/// A run made ready.
#[derive(Clone, Debug)]
pub(crate) struct Run<'a> {
    pub(crate) name: &'a str,
    pub(crate) record: &'a Record,
    pub(crate) craft: Craft<'a>,
    pub(crate) interval_s: f64,
    pub(crate) density: Vec<f64>,
    drive: Drive,
    /// Samples of a piece.
    piece: usize,
    /// Standard deviation of the jump of the second derivative of tunnel speed at a node, m/s³.
    jump_std: f64,
    /// Root of the intensity of that jump's process, m/s³ per root second.
    pub(crate) jerk_root: f64,
    /// Noise as smoothing sees it.
    pub(crate) noise_std: [f64; CHANNELS],
    /// The run's trajectory as smoothing sees it.
    pub(crate) smoothed: Nominal,
}

/// A trajectory in pieces: state and tunnel speed at each node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Nominal {
    pub(crate) nodes: Vec<[f64; NODE]>,
}

/// How parameters enter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Columns<'a> {
    /// Values of all the structure's parameters.
    pub(crate) parameters: &'a [f64],
    /// Column of each; none where held.
    pub(crate) columns: &'a [Option<usize>],
    /// Bias of each channel, SI.
    pub(crate) biases: [f64; CHANNELS],
    /// Column of each bias; none where held.
    pub(crate) bias_columns: [Option<usize>; CHANNELS],
    /// Other errors of the instruments; none where they are as the plant has them.
    pub(crate) errors: Option<Errors>,
    /// Number of columns.
    pub(crate) free: usize,
}

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

impl<'a> Run<'a> {
    pub(crate) fn new(name: &'a str, record: &'a Record, plant: &'a Plant) -> Result<Self, PidError> {
        let craft = Craft::new(plant)?;
        let smoothed = smooth(record, &Smoother::Auto)?;
        let seen = states(&smoothed, plant)?;
        let interval_s = record.interval_s();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let piece = ((PIECE_S / interval_s).round() as usize).max(1);
        let lively = liveliness(&record.vw_m_s, interval_s);
        let piece_s = piece as f64 * interval_s;
        let scale = 1.0 + plant.sensors.wind_scale;
        let node = |i: usize| {
            let (x, v) = (&seen[i], &smoothed.channels[6]);
            let [p, e, u, w] = [x.p_tunnel_cm, x.euler_rad, x.v_tunnel_cm, x.pqr];
            let mut z = [0.0; NODE];
            for k in 0..3 {
                (z[k], z[3 + k], z[6 + k], z[9 + k]) = (p[k], e[k], u[k], w[k]);
            }
            (z[12], z[13], z[14]) = (x.vw, x.vw_rate, v.second[i] / scale);
            z
        };
        let mut noise_std = smoothed.noise_std;
        noise_std[6] = lively.noise_std;
        Ok(Self {
            name,
            record,
            interval_s,
            density: record.ps_pa.iter().zip(&record.ts_k).map(|(p, t)| plant.environment.density_kg_m3(*p, *t)).collect(),
            drive: Drive { states: SPEED, at: (0..=2 * piece).map(|i| parabola(0.5 * interval_s * i as f64)).collect() },
            piece,
            jump_std: (lively.intensity * piece_s).sqrt().max(1e-12) / scale,
            jerk_root: lively.intensity.sqrt() / scale,
            noise_std,
            smoothed: Nominal { nodes: (0..record.len()).step_by(piece).map(node).collect() },
            craft,
        })
    }

    /// A run still to be flown: record without noise and its first node, for a filter that starts there.
    pub(crate) fn planned(
        record: &'a Record,
        plant: &'a Plant,
        first: [f64; NODE],
        jerk_root: f64,
        noise_std: [f64; CHANNELS],
    ) -> Result<Self, PidError> {
        let interval_s = record.interval_s();
        Ok(Self {
            name: "planned",
            record,
            interval_s,
            density: record.ps_pa.iter().zip(&record.ts_k).map(|(p, t)| plant.environment.density_kg_m3(*p, *t)).collect(),
            drive: Drive { states: SPEED, at: vec![parabola(0.0), parabola(0.5 * interval_s), parabola(interval_s)] },
            piece: 1,
            jump_std: (jerk_root * interval_s.sqrt()).max(1e-12),
            jerk_root,
            noise_std,
            smoothed: Nominal { nodes: vec![first] },
            craft: Craft::new(plant)?,
        })
    }

    /// First sample and number of samples of a piece; all but the last reach to the next node.
    fn span(&self, k: usize) -> (usize, usize) {
        let first = k * self.piece;
        (first, self.piece.min(self.record.len() - first))
    }

    fn segment<'s>(&'s self, k: usize, c: &Columns<'s>) -> Segment<'s> {
        let (first, samples) = self.span(k);
        let last = first + samples == self.record.len();
        Segment {
            craft: &self.craft,
            drive: &self.drive,
            parameters: c.parameters,
            columns: c.columns,
            free: c.free,
            start_s: first as f64 * self.interval_s,
            interval_s: self.interval_s,
            density: &self.density[first..],
            steps: if last { samples - 1 } else { samples },
            spread_m_s: [0.0; 3],
        }
    }

    /// Residuals (measured less predicted) of one sample.
    pub(crate) fn residual(&self, sample: usize, x: &[f64; STATES], vw_m_s: f64, c: &Columns<'_>) -> [f64; CHANNELS] {
        let p = origin(x, self.craft.plant.vehicle.p_origin_cm.to_array());
        let scale = 1.0 + self.craft.plant.sensors.wind_scale;
        let predicted = [p[0], p[1], p[2], x[3], x[4], x[5], vw_m_s * scale];
        let measured = self.record.channels();
        std::array::from_fn(|k| measured[k][sample] - predicted[k] - c.biases[k])
    }

    /// Residuals of all samples, channel by channel, and what is left between pieces, in units of [`MEETING`], squared and summed
    /// with the jumps. `None` where the flight cannot go on.
    pub(crate) fn misfit(&self, nominal: &Nominal, c: &Columns<'_>, work: &mut Transition) -> Option<Misfit> {
        let mut residuals: [Vec<f64>; CHANNELS] = std::array::from_fn(|_| Vec::with_capacity(self.record.len()));
        let (mut gaps, mut jumps) = (0.0_f64, 0.0);
        for (k, node) in nominal.nodes.iter().enumerate() {
            let (first, samples) = self.span(k);
            let (x, s) = split(node);
            if !self.segment(k, c).fly(x, &s, work) {
                return None;
            }
            for i in 0..samples {
                let at = if i == 0 { &x } else { &work.states[i - 1] };
                let r = self.left(first + i, at, self.speed(i, &s), c);
                residuals.iter_mut().zip(r).for_each(|(series, r)| series.push(r));
            }
            if let Some(next) = nominal.nodes.get(k + 1) {
                let end = self.end(&work.states[samples - 1], &s);
                for (j, (a, b)) in end.iter().zip(next).enumerate() {
                    let gap = a - b;
                    if j == NODE - 1 {
                        jumps += (gap / self.jump_std).powi(2);
                    } else {
                        gaps += (gap / MEETING[j]).powi(2);
                    }
                }
            }
        }
        Some(Misfit { residuals, gaps, jumps })
    }

    fn speed(&self, samples: usize, s: &[f64; SPEED]) -> [f64; SPEED] {
        let t = samples as f64 * self.interval_s;
        [s[0] + t * (s[1] + 0.5 * t * s[2]), s[1] + t * s[2], s[2]]
    }

    /// The node that a piece reaches.
    fn end(&self, x: &[f64; STATES], s: &[f64; SPEED]) -> [f64; NODE] {
        let s = self.speed(self.piece, s);
        std::array::from_fn(|j| if j < STATES { x[j] } else { s[j - STATES] })
    }

    /// Linearises about a nominal trajectory; `None` where the flight cannot go on.
    pub(crate) fn linearise(
        &self,
        nominal: &Nominal,
        c: &Columns<'_>,
        std: &[f64; CHANNELS],
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
    fn forward(&self, next: &[f64; NODE], s: &[f64; SPEED], c: &Columns<'_>, work: &Transition) -> DMatrix<f64> {
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
        c: &Columns<'_>,
        std: &[f64; CHANNELS],
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

    /// Slopes of one output at sample `i` of a piece by node and parameters.
    pub(crate) fn output_slopes(
        &self,
        i: usize,
        channel: usize,
        turned: &[[f64; 3]; 3],
        work: &Transition,
        width: usize,
        out: &mut [f64],
    ) {
        if channel == 6 {
            let t = i as f64 * self.interval_s;
            let scale = 1.0 + self.craft.plant.sensors.wind_scale;
            (out[12], out[13], out[14]) = (scale, scale * t, scale * 0.5 * t * t);
            return;
        }
        let mut add = |state: usize, factor: f64| {
            if factor == 0.0 {
                return;
            }
            if i == 0 {
                out[state] += factor;
            } else {
                let row = &work.slopes[i - 1][state * width..(state + 1) * width];
                out.iter_mut().zip(row).for_each(|(o, v)| *o += factor * v);
            }
        };
        add(channel, 1.0);
        if channel < 3 {
            (0..3).for_each(|e| add(3 + e, turned[channel][e]));
        }
    }

    /// [`Run::residual`], with errors of the instruments where there are such; zero where a delay leaves the record.
    fn left(&self, sample: usize, x: &[f64; STATES], speed: [f64; SPEED], c: &Columns<'_>) -> [f64; CHANNELS] {
        let Some(errors) = &c.errors else { return self.residual(sample, x, speed[0], c) };
        let seen = observe(&variables(x, speed, errors), &self.known(sample, x, speed, errors, c));
        let measured = self.record.channels();
        std::array::from_fn(|k| self.recorded(sample, k, errors).map_or(0.0, |i| measured[k][i] - seen[k] - c.biases[k]))
    }

    /// Index in the record of what a channel shows of this sample's instant, but for under half a sample.
    fn recorded(&self, sample: usize, channel: usize, errors: &Errors) -> Option<usize> {
        sample.checked_add_signed(errors.shift(channel, self.interval_s)).filter(|i| *i < self.record.len())
    }

    fn known(&self, sample: usize, x: &[f64; STATES], speed: [f64; SPEED], errors: &Errors, c: &Columns<'_>) -> Known {
        let taken_s = [3, 6].map(|channel| errors.shift(channel, self.interval_s) as f64 * self.interval_s);
        let air = Air {
            t_s: sample as f64 * self.interval_s,
            density_kg_m3: self.density[sample],
            vw_m_s: speed[0],
            vw_rate_m_s2: speed[1],
        };
        let mut terms = vec![0.0; self.craft.terms.acts.len()];
        // Where the flow is not defined the trajectory has failed already.
        let rate = self.craft.rate(x, air, &Extra::default(), c.parameters, &mut terms).unwrap_or([0.0; STATES]);
        Known {
            p_cm: [x[0], x[1], x[2]],
            w_rate: [rate[9], rate[10], rate[11]],
            p_origin_cm: self.craft.plant.vehicle.p_origin_cm.to_array(),
            wind_scale: self.craft.plant.sensors.wind_scale,
            taken_s,
        }
    }

    /// What outputs depend on at one sample.
    fn outputs(&self, sample: usize, x: &[f64; STATES], speed: [f64; SPEED], c: &Columns<'_>) -> Outputs {
        let Some(errors) = &c.errors else {
            return Outputs::Plain(origin_slopes(x, self.craft.plant.vehicle.p_origin_cm.to_array()));
        };
        let values = variables(x, speed, errors);
        let seen = observe(&std::array::from_fn(|k| Dual::variable(values[k], k)), &self.known(sample, x, speed, errors, c));
        let there = |k: usize| self.recorded(sample, k, errors).is_some();
        Outputs::WithErrors(Box::new(std::array::from_fn(|k| if there(k) { seen[k].slopes } else { [f64::NAN; VARIABLES] })))
    }

    /// Slopes of one output at sample `i` of a piece by node and parameters, into `out`.
    fn slopes(&self, i: usize, channel: usize, outputs: &Outputs, c: &Columns<'_>, work: &Transition, out: &mut [f64]) {
        out.fill(0.0);
        match outputs {
            Outputs::Plain(turned) => self.output_slopes(i, channel, turned, work, NODE + c.free, out),
            Outputs::WithErrors(slopes) => {
                let slopes = &slopes[channel];
                if slopes[0].is_nan() {
                    return;
                }
                let place = (channel < 3).then_some((channel, 1.0));
                for (state, factor) in STATE_OF.into_iter().zip(*slopes).chain(place).filter(|(_, f)| *f != 0.0) {
                    if i == 0 {
                        out[state] += factor;
                    } else {
                        let width = NODE + c.free;
                        let row = &work.slopes[i - 1][state * width..(state + 1) * width];
                        out.iter_mut().zip(row).for_each(|(o, v)| *o += factor * v);
                    }
                }
                let t = i as f64 * self.interval_s;
                let [value, rate, second] = [slopes[6], slopes[7], slopes[8]];
                out[STATES] += value;
                out[STATES + 1] += value * t + rate;
                out[STATES + 2] += 0.5 * value * t * t + rate * t + second;
                let columns = c.errors.iter().flat_map(|e| e.columns).zip(&slopes[9..]);
                columns.filter_map(|(column, s)| Some((column?, s))).for_each(|(column, s)| out[NODE + column] += s);
            }
        }
        if let Some(column) = c.bias_columns[channel] {
            out[NODE + column] += 1.0;
        }
    }

    /// Slopes of every output by the parameters when the trajectory and the tunnel speed follow as fits best: series by channel,
    /// then parameter.
    pub(crate) fn profiled_slopes(
        &self,
        nominal: &Nominal,
        linear: &Linearised,
        c: &Columns<'_>,
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

/// Slopes of the outputs at one sample.
enum Outputs {
    /// Of the origin's position by the Euler angles; the rest are ones.
    Plain([[f64; 3]; 3]),
    /// Of every channel by its variables; NaN where the record has no sample of it.
    WithErrors(Box<[[f64; VARIABLES]; CHANNELS]>),
}

/// What a trajectory leaves.
#[derive(Clone, Debug)]
pub(crate) struct Misfit {
    pub(crate) residuals: [Vec<f64>; CHANNELS],
    pub(crate) gaps: f64,
    pub(crate) jumps: f64,
}

/// Gaps between pieces in these units (m, rad, m/s, rad/s; tunnel speed m/s, m/s²) weigh like a residual of one standard deviation
/// in the merit function: a hundredth of the sensors' noise, and ten times that per second. The last number, which may jump, is
/// not a gap.
const MEETING: [f64; NODE] =
    [7.5e-6, 7.5e-6, 7.5e-6, 2e-5, 2e-5, 2e-5, 7.5e-5, 7.5e-5, 7.5e-5, 2e-4, 2e-4, 2e-4, 3e-5, 3e-4, f64::INFINITY];

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

fn split(z: &[f64; NODE]) -> ([f64; STATES], [f64; SPEED]) {
    (std::array::from_fn(|i| z[i]), std::array::from_fn(|i| z[STATES + i]))
}

/// Tunnel speed and its rate from value and two derivatives, `t` later.
fn parabola(t: f64) -> Vec<f64> {
    let mut m = vec![0.0; INPUTS * SPEED];
    m[..6].copy_from_slice(&[1.0, t, 0.5 * t * t, 0.0, 1.0, t]);
    m
}
