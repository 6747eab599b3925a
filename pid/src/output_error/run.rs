//! pid: one run of an output-error problem. In: record, nominal trajectory in pieces, parameters. Out: residuals, what is left
//! between pieces, slopes of the outputs.
//!
//! The run is cut into pieces (multiple shooting; Bock 1987): every node has its own state, and pieces must meet. What belongs to
//! the run alone is eliminated in [`linear`].

mod linear;

use super::instruments::{Errors, KINDS, Known, STATE_OF, VARIABLES, observe, variables};
use super::speed::liveliness;
use super::unknowns::ANGLE_BIASES;
use crate::PidError;
use crate::equations::{
    Craft, Drive, Dual, Extra, INPUTS, STATES, Segment, Transition, TunnelAir, origin, origin_slopes, splits,
};
use crate::smooth::{Smoother, smooth};
use crate::states::states;
pub(crate) use linear::Linearised;
use windfall_model::{CHANNELS, PerChannel, Plant, Record, RunChannel, Unknown, UnknownId, Unknowns};

/// Input states: tunnel speed and its first and second derivative.
pub(crate) const SPEED: usize = 3;
/// Numbers at a node.
pub(crate) const NODE: usize = STATES + SPEED;
/// Length of a piece, s: short against the pitch mode's 1 s, long against the sample.
const PIECE_S: f64 = 0.05;

/// A run made ready.
#[derive(Clone, Debug)]
pub(crate) struct PreparedRun<'a> {
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
    pub(crate) noise_std: PerChannel<f64>,
    /// The run's trajectory as smoothing sees it.
    pub(crate) smoothed: Nominal,
}

/// A trajectory in pieces: state and tunnel speed at each node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Nominal {
    pub(crate) nodes: Vec<[f64; NODE]>,
}

/// How the unknowns enter a flight: they by place instead of by name.
#[derive(Clone, Debug)]
pub(crate) struct FreeColumns {
    /// Values of all the structure's parameters.
    pub(crate) parameters: Vec<f64>,
    /// Column of each; none where held.
    pub(crate) columns: Vec<Option<usize>>,
    /// Bias of each channel, SI.
    pub(crate) biases: PerChannel<f64>,
    /// Column of each bias; none where held.
    pub(crate) bias_columns: PerChannel<Option<usize>>,
    /// Other errors of the instruments; none where they are as the plant has them.
    pub(crate) errors: Option<Errors>,
    /// Number of columns.
    pub(crate) free: usize,
}

impl FreeColumns {
    pub(crate) fn of(unknowns: &Unknowns) -> Self {
        let (mut biases, mut bias_columns) = ([0.0; CHANNELS], [None; CHANNELS]);
        let nuisance = |name| unknowns.position(UnknownId::Nuisance(name)).map(|at| &unknowns.all[at]);
        for (channel, name) in ANGLE_BIASES {
            if let Some(u) = nuisance(name) {
                (biases[channel], bias_columns[channel]) = (u.value(), u.column());
            }
        }
        let errors = KINDS.map(|k| nuisance(k.0));
        let looked_for = errors.iter().any(Option::is_some);
        Self {
            parameters: unknowns.parameters(),
            columns: unknowns.of_parameters().map(Unknown::column).collect(),
            biases,
            bias_columns,
            errors: looked_for.then(|| Errors {
                values: errors.map(|u| u.map_or(0.0, Unknown::value)),
                columns: errors.map(|u| u.and_then(Unknown::column)),
            }),
            free: unknowns.free(),
        }
    }
    /// The same flight with nothing free.
    pub(crate) fn held(&self) -> Self {
        Self { columns: vec![None; self.columns.len()], bias_columns: [None; CHANNELS], free: 0, ..self.clone() }
    }
}

/// Tunnel speed over the half parts of a piece of so many samples.
fn drive(piece: usize, splits: usize, interval_s: f64) -> Drive {
    let half_s = 0.5 * interval_s / splits as f64;
    Drive { states: SPEED, splits, at: (0..=2 * piece * splits).map(|i| parabola(half_s * i as f64)).collect() }
}

impl<'a> PreparedRun<'a> {
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
            let (x, v) = (&seen[i], &smoothed.channels[RunChannel::Wind.at()]);
            let [p, e, u, w] = [x.p_tunnel_cm, x.euler_rad, x.v_tunnel_cm, x.pqr];
            let mut z = [0.0; NODE];
            for k in 0..3 {
                (z[k], z[3 + k], z[6 + k], z[9 + k]) = (p[k], e[k], u[k], w[k]);
            }
            (z[12], z[13], z[14]) = (x.vw, x.vw_rate, v.second[i] / scale);
            z
        };
        let mut noise_std = smoothed.noise_std;
        noise_std[RunChannel::Wind.at()] = lively.noise_std;
        Ok(Self {
            name,
            record,
            interval_s,
            density: record.ps_pa.iter().zip(&record.ts_k).map(|(p, t)| plant.environment.density_kg_m3(*p, *t)).collect(),
            drive: drive(piece, splits(record), interval_s),
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
        noise_std: PerChannel<f64>,
    ) -> Result<Self, PidError> {
        let interval_s = record.interval_s();
        Ok(Self {
            name: "planned",
            record,
            interval_s,
            density: record.ps_pa.iter().zip(&record.ts_k).map(|(p, t)| plant.environment.density_kg_m3(*p, *t)).collect(),
            drive: drive(1, splits(record), interval_s),
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

    fn segment<'s>(&'s self, k: usize, c: &'s FreeColumns) -> Segment<'s> {
        let (first, samples) = self.span(k);
        let last = first + samples == self.record.len();
        Segment {
            craft: &self.craft,
            drive: &self.drive,
            parameters: &c.parameters,
            columns: &c.columns,
            free: c.free,
            start_s: first as f64 * self.interval_s,
            interval_s: self.interval_s,
            density: &self.density[first..],
            steps: if last { samples - 1 } else { samples },
            spread_m_s: [0.0; 3],
        }
    }

    /// Residuals (measured less predicted) of one sample.
    pub(crate) fn residual(&self, sample: usize, x: &[f64; STATES], vw_m_s: f64, c: &FreeColumns) -> PerChannel<f64> {
        let p = origin(x, self.craft.plant.vehicle.p_origin_cm.to_array());
        let scale = 1.0 + self.craft.plant.sensors.wind_scale;
        let predicted = [p[0], p[1], p[2], x[3], x[4], x[5], vw_m_s * scale];
        let measured = self.record.channels();
        std::array::from_fn(|k| measured[k][sample] - predicted[k] - c.biases[k])
    }

    /// Residuals of all samples, channel by channel, and what is left between pieces, in units of [`MEETING`], squared and summed
    /// with the jumps. `None` where the flight cannot go on.
    pub(crate) fn misfit(&self, nominal: &Nominal, c: &FreeColumns, work: &mut Transition) -> Option<Misfit> {
        let mut residuals: PerChannel<Vec<f64>> = std::array::from_fn(|_| Vec::with_capacity(self.record.len()));
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
        if channel == RunChannel::Wind.at() {
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

    /// [`PreparedRun::residual`], with errors of the instruments where there are such; zero where a delay leaves the record.
    fn left(&self, sample: usize, x: &[f64; STATES], speed: [f64; SPEED], c: &FreeColumns) -> PerChannel<f64> {
        let Some(errors) = &c.errors else { return self.residual(sample, x, speed[0], c) };
        let seen = observe(&variables(x, speed, errors), &self.known(sample, x, speed, errors, c));
        let measured = self.record.channels();
        std::array::from_fn(|k| self.recorded(sample, k, errors).map_or(0.0, |i| measured[k][i] - seen[k] - c.biases[k]))
    }

    /// Index in the record of what a channel shows of this sample's instant, but for under half a sample.
    fn recorded(&self, sample: usize, channel: usize, errors: &Errors) -> Option<usize> {
        sample.checked_add_signed(errors.shift(channel, self.interval_s)).filter(|i| *i < self.record.len())
    }

    fn known(&self, sample: usize, x: &[f64; STATES], speed: [f64; SPEED], errors: &Errors, c: &FreeColumns) -> Known {
        let taken_s = [3, 6].map(|channel| errors.shift(channel, self.interval_s) as f64 * self.interval_s);
        let air = TunnelAir {
            t_s: sample as f64 * self.interval_s,
            density_kg_m3: self.density[sample],
            vw_m_s: speed[0],
            vw_rate_m_s2: speed[1],
        };
        let mut terms = vec![0.0; self.craft.terms.acts.len()];
        // Where the flow is not defined the trajectory has failed already.
        let rate = self.craft.rate(x, air, &Extra::default(), &c.parameters, &mut terms).unwrap_or([0.0; STATES]);
        Known {
            p_cm: [x[0], x[1], x[2]],
            w_rate: [rate[9], rate[10], rate[11]],
            p_origin_cm: self.craft.plant.vehicle.p_origin_cm.to_array(),
            wind_scale: self.craft.plant.sensors.wind_scale,
            taken_s,
        }
    }

    /// What outputs depend on at one sample.
    fn outputs(&self, sample: usize, x: &[f64; STATES], speed: [f64; SPEED], c: &FreeColumns) -> Outputs {
        let Some(errors) = &c.errors else {
            return Outputs::Plain(origin_slopes(x, self.craft.plant.vehicle.p_origin_cm.to_array()));
        };
        let values = variables(x, speed, errors);
        let seen = observe(&std::array::from_fn(|k| Dual::variable(values[k], k)), &self.known(sample, x, speed, errors, c));
        let there = |k: usize| self.recorded(sample, k, errors).is_some();
        Outputs::WithErrors(Box::new(std::array::from_fn(|k| if there(k) { seen[k].slopes } else { [f64::NAN; VARIABLES] })))
    }

    /// Slopes of one output at sample `i` of a piece by node and parameters, into `out`.
    fn slopes(&self, i: usize, channel: usize, outputs: &Outputs, c: &FreeColumns, work: &Transition, out: &mut [f64]) {
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
}

/// Slopes of the outputs at one sample.
enum Outputs {
    /// Of the origin's position by the Euler angles; the rest are ones.
    Plain([[f64; 3]; 3]),
    /// Of every channel by its variables; NaN where the record has no sample of it.
    WithErrors(Box<PerChannel<[f64; VARIABLES]>>),
}

/// What a trajectory leaves.
#[derive(Clone, Debug)]
pub(crate) struct Misfit {
    pub(crate) residuals: PerChannel<Vec<f64>>,
    pub(crate) gaps: f64,
    pub(crate) jumps: f64,
}

/// Gaps between pieces in these units (m, rad, m/s, rad/s; tunnel speed m/s, m/s²) weigh like a residual of one standard deviation
/// in the merit function: a hundredth of the sensors' noise, and ten times that per second. The last number, which may jump, is
/// not a gap.
const MEETING: [f64; NODE] =
    [7.5e-6, 7.5e-6, 7.5e-6, 2e-5, 2e-5, 2e-5, 7.5e-5, 7.5e-5, 7.5e-5, 2e-4, 2e-4, 2e-4, 3e-5, 3e-4, f64::INFINITY];

fn split(z: &[f64; NODE]) -> ([f64; STATES], [f64; SPEED]) {
    (std::array::from_fn(|i| z[i]), std::array::from_fn(|i| z[STATES + i]))
}

/// Tunnel speed and its rate from value and two derivatives, `t` later.
fn parabola(t: f64) -> Vec<f64> {
    let mut m = vec![0.0; INPUTS * SPEED];
    m[..6].copy_from_slice(&[1.0, t, 0.5 * t * t, 0.0, 1.0, t]);
    m
}

#[cfg(test)]
pub(crate) mod tests;
