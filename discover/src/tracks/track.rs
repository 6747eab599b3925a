//! discover: one track of a body without attitude, or of poses of a rigid one (`pose`). In: a record and a plant. Out: residual with the initial state taken out, in a fixed basis.
//!
//! Long records are averaged over groups of neighbouring samples. What is predicted of a group is its value at the group's mean time and
//! half the second derivative times the scatter of the group's times; the next term is of fourth order, below 1e-8 of a swing of 1 Hz at
//! groups of 20 ms.

use super::bins::BIN;
use super::pose::{self, Poses};
use crate::DiscoverError;
use nalgebra::{DMatrix, DVector, Matrix2};
use windfall_model::frames::Vec3;
use windfall_model::{Acts, Campaign, Measured, Plant, PointRecord};
use windfall_sim::{PointState, fly_point_states};

/// Smallest sensor noise assumed, in the unit of what was measured: simulated tracks may be free of it.
pub(super) const FLOOR: f64 = 1e-6;
/// Fewest samples of a track: an initial state takes two per axis.
pub(super) const FEWEST: usize = 4;
/// Most samples of a track; longer records are averaged.
const MOST: usize = 256;
/// Steps for differences by the initial state and by pushes: of velocities a tenth of a millimetre at the end, of pushes a tenth of a m/s²;
/// of a slow rigid body a hundredth of that.
pub(super) const STATE_STEP: f64 = 1e-4;
const PUSH_STEP: f64 = 0.1;
const POSE_PUSH_STEP: f64 = 1e-3;

/// Why a run gives no track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TrackFault {
    /// Too few samples for an initial state.
    Short { samples: usize },
    /// The declared model cannot follow it.
    NotFlown,
}

impl TrackFault {
    /// With the run's name and the numbers that its flight depends on.
    pub(super) fn of_run(self, campaign: &Campaign, run: usize) -> DiscoverError {
        let numbers = match campaign.body() {
            Acts::FreeFlight => "mass, inertia, reference area, coefficients, air density, thrusts",
            Acts::Pivot => "mass, arm, inertia, friction",
            _ => "mass, diameter, air density, CD",
        };
        let run = campaign.runs[run].name.clone();
        match self {
            Self::Short { samples } => DiscoverError::ShortTrack { run, samples, needed: FEWEST },
            Self::NotFlown => DiscoverError::NotFlown { run, numbers },
        }
    }
}

/// One run ready for any plant.
pub(super) struct Track {
    pub(super) index: usize,
    pub(super) inputs: Vec<f64>,
    /// The record, averaged.
    record: PointRecord,
    /// Samples in a group.
    pub(super) group: f64,
    /// Variance of the times of a group, s², for each group.
    scatter_s2: Vec<f64>,
    /// Length of the track over a hundred units, one at least: what steps and tolerances grow with.
    pub(super) size: f64,
    /// Standard deviation of one sample as stated, of the first channel.
    pub(super) std: f64,
    /// What residuals of each channel are in units of: one where channels have one unit, else the channel's stated standard deviation.
    pub(super) scales: Vec<f64>,
    /// Attitudes of a rigid body.
    poses: Option<Poses>,
    /// Whether the initial state is the record's own (`pose`), under every plant; else it is estimated under each.
    pub(super) given: bool,
    /// Whether `basis` starts with what a steady push leaves.
    pushed: bool,
    /// Times from the first sample, s.
    pub(super) t_s: Vec<f64>,
    /// Measured channels: tunnel axes, the first alone for an angle; of poses the body's axes after them, of positions beside specific
    /// forces those.
    pub(super) axes: Vec<usize>,
    /// What was measured over `scales`: one channel after the other.
    pub(super) measured: DVector<f64>,
    /// Initial state under the plant that the evidence was made with: positions, then velocities times the duration, then offsets of
    /// specific forces beside them; for specific forces alone velocities times the duration, then offsets.
    pub(super) start: DVector<f64>,
    /// Orthonormal columns that a change of the initial state spans there.
    pub(super) state_basis: DMatrix<f64>,
    /// Orthonormal columns of what is left, slow to fast.
    pub(super) basis: DMatrix<f64>,
    /// What a steady push of 1 m/s² along each axis of motion leaves in the first columns of `basis`, a column per channel, if it starts so.
    pub(super) push: DMatrix<f64>,
    /// Residual in `basis` there.
    pub(super) laid: DVector<f64>,
    /// Inverse of the change of `state_basisᵀ · position` with the initial state.
    pub(super) state_inverse: DMatrix<f64>,
}

impl Track {
    pub(super) fn new(
        record: &PointRecord,
        inputs: &[f64],
        index: usize,
        around: &Plant,
        pushed: bool,
    ) -> Result<Self, TrackFault> {
        let rigid = record.measured == Measured::Pose;
        let present = |a: &usize| if rigid && *a > 2 { true } else { record.channel(*a).is_some() };
        let axes: Vec<usize> = (0..6).filter(present).collect();
        let samples = record.t_s.len();
        if axes.is_empty() || samples < FEWEST {
            return Err(TrackFault::Short { samples: if axes.is_empty() { 0 } else { samples } });
        }
        let group = if rigid { 1 } else { samples.div_ceil(MOST) };
        let whole = record;
        let (record, scatter_s2) = if rigid { averaged(&pose::thinned(record), 1) } else { averaged(record, group) };
        let poses = if rigid { Some(Poses::of(whole, &record).ok_or(TrackFault::NotFlown)?) } else { None };
        let n = record.t_s.len();
        let t0 = record.t_s[0];
        let mixed = record.measured == Measured::PositionAndForce;
        let scale = |a: &usize| if mixed { stated_std(around, record.measured, *a).max(FLOOR) } else { 1.0 };
        let scales: Vec<f64> = axes.iter().map(scale).collect();
        let series = axes.iter().zip(&scales).filter_map(|(a, s)| Some(record.channel(*a)?.iter().map(move |x| x / s)));
        let measured =
            DVector::from_iterator(axes.len() * n, series.flatten().chain(std::iter::repeat(0.0)).take(axes.len() * n));
        let places = n * axes.iter().filter(|a| !(mixed && **a > 2)).count();
        let reach = scales[0] * measured.iter().take(places).map(|x| (x - measured[0]).abs()).fold(0.0, f64::max);
        let empty = DMatrix::zeros(0, 0);
        let mut track = Self {
            index,
            group: group as f64,
            scatter_s2,
            size: (reach / 100.0).max(1.0),
            std: stated_std(around, record.measured, 0),
            given: poses.is_some(),
            poses,
            pushed: pushed && matches!(record.measured, Measured::Position | Measured::Pose | Measured::PositionAndForce),
            scales,
            inputs: inputs.to_vec(),
            t_s: record.t_s.iter().map(|t| t - t0).collect(),
            start: DVector::zeros(0),
            record,
            axes,
            measured,
            state_basis: empty.clone(),
            basis: empty.clone(),
            laid: DVector::zeros(0),
            push: empty.clone(),
            state_inverse: empty,
        };
        if let Some(poses) = &track.poses {
            let own = track.own(around);
            track.given = !track.keeps_its_start(poses, &own).ok_or(TrackFault::NotFlown)?;
        }
        track.lay(around).ok_or(TrackFault::NotFlown)?;
        Ok(track)
    }

    /// What it is a series of.
    pub(super) fn kind(&self) -> Measured {
        self.record.measured
    }

    /// Whether its bases stay as they were first laid.
    pub(super) fn stays(&self) -> bool {
        self.poses.is_some() && !self.given
    }

    /// The record's own initial state, of poses, and the covariance of a channel's place and rate in it over the variance of a sample's noise.
    pub(super) fn given_start(&self) -> Option<(DVector<f64>, Matrix2<f64>)> {
        let (poses, duration_s) = (self.poses.as_ref()?, self.duration_s());
        Some((poses.start(duration_s), poses.start_of_noise(duration_s)))
    }

    /// Channels that are a motion, with a place and a velocity in the initial state; the others have an offset in it.
    pub(super) fn motions(&self) -> usize {
        self.axes.iter().filter(|a| !self.is_beside(**a)).count()
    }

    /// Whether a channel is a specific force beside positions.
    fn is_beside(&self, axis: usize) -> bool {
        self.kind() == Measured::PositionAndForce && axis > 2
    }

    /// Residual of its `k`-th channel in the channel's unit.
    pub(super) fn channel_of(&self, e: &DVector<f64>, k: usize) -> Vec<f64> {
        let n = self.t_s.len();
        e.as_slice()[k * n..(k + 1) * n].iter().map(|x| x * self.scales[k]).collect()
    }

    /// Sum of squares of a residual over all positions and angles, or over the specific forces beside them, in the channels' units, and how
    /// many there are.
    pub(super) fn squares(&self, e: &DVector<f64>, beside: bool) -> (f64, f64) {
        let places = self.motions() * self.t_s.len();
        let (from, count) = if beside { (places, e.len() - places) } else { (0, places) };
        let scale = if beside { self.scales.last() } else { self.scales.first() }.copied().unwrap_or(1.0);
        (scale * scale * e.rows(from, count).norm_squared(), count as f64)
    }

    /// Run inputs that were recorded row by row, averaged.
    pub(super) fn recorded_inputs(&self) -> &[(usize, Vec<f64>)] {
        &self.record.recorded_inputs
    }

    /// Recording that it is a window of; its own where it is not.
    pub(super) fn recording(&self) -> String {
        self.record.recording.clone().unwrap_or_else(|| format!("run {}", self.index))
    }

    /// The plant in this run, flying along the measured axes: what is not measured stays still.
    pub(super) fn own(&self, plant: &Plant) -> Plant {
        let mut own = self.record.plant(plant, self.index, &self.inputs);
        let a = own.point.acceleration.to_array();
        if self.motions() < 3 {
            own.point.side_per_input.clear();
            own.point.side_constant = 0.0;
        }
        own.point.acceleration = Vec3::from_array(std::array::from_fn(|i| if self.axes.contains(&i) { a[i] } else { 0.0 }));
        own
    }

    pub(super) fn duration_s(&self) -> f64 {
        self.t_s.last().copied().unwrap_or(0.0)
    }

    /// Finds the initial state under a plant by Gauss-Newton, and lays the bases there.
    pub(super) fn lay(&mut self, around: &Plant) -> Option<()> {
        let own = self.own(around);
        if self.kind() == Measured::SpecificForce {
            return self.lay_forces(&own);
        }
        let guess = match &self.poses {
            Some(poses) => poses.start(self.duration_s()),
            None => self.guess()?,
        };
        let (theta, e) = self.least_squares(&own, guess)?;
        let (_, jacobian) = self.linearised(&own, &theta)?;
        let pushed = self.push_columns(&own, &theta)?;
        self.lay_bases(&jacobian, self.pushed.then_some(&pushed));
        self.state_inverse = (self.state_basis.transpose() * jacobian).try_inverse()?;
        self.start = theta;
        self.laid = self.basis.tr_mul(&e);
        self.push = self.basis.columns(0, self.axes.len()).tr_mul(&pushed);
        Some(())
    }

    /// Orthonormal bases: of the initial state, and of what is left, first what a push leaves and then cosines from slow to fast. Of a
    /// specific force beside positions a constant alone is the initial state's, so that its cosines begin an order earlier.
    pub(super) fn lay_bases(&mut self, of_state: &DMatrix<f64>, of_push: Option<&DMatrix<f64>>) {
        let states = of_state.ncols();
        let (n, end) = (self.t_s.len(), self.duration_s());
        let first = usize::from(of_push.is_some());
        // Of poses a few slow numbers are all that counts (`scatter`).
        let orders = if self.poses.is_some() { BIN / self.axes.len() } else { n - 2 };
        let mut columns = DMatrix::zeros(self.measured.len(), states + orders * self.axes.len());
        columns.columns_mut(0, states).copy_from(of_state);
        for order in 0..orders {
            for (a, &axis) in self.axes.iter().enumerate() {
                let mut column = columns.column_mut(states + order * self.axes.len() + a);
                let beside = self.is_beside(axis);
                if let Some(pushed) = of_push.filter(|_| order == 0 && !beside) {
                    column.copy_from(&pushed.column(a));
                    continue;
                }
                let k = order + if beside { 1 } else { 2 - first };
                for (i, t) in self.t_s.iter().enumerate() {
                    column[a * n + i] = (std::f64::consts::PI * k as f64 * t / end).cos();
                }
            }
        }
        let q = columns.qr().q();
        self.state_basis = q.columns(0, states).into_owned();
        self.basis = q.columns(states, q.ncols() - states).into_owned();
    }

    /// Position and velocity (tunnel axes, or angle and rate) of an initial state.
    pub(super) fn state(&self, theta: &DVector<f64>) -> ([f64; 3], [f64; 3]) {
        let (mut p, mut v) = ([0.0; 3], [0.0; 3]);
        let m = self.motions();
        let of_force = self.kind() == Measured::SpecificForce;
        for (k, &axis) in self.axes.iter().enumerate().take(m.min(3)) {
            p[axis] = if of_force { 0.0 } else { theta[k] };
            v[axis] = theta[if of_force { k } else { m + k }] / self.duration_s();
        }
        (p, v)
    }

    /// States at the samples from an initial state.
    pub(super) fn states(&self, own: &Plant, theta: &DVector<f64>) -> Option<Vec<PointState>> {
        let (p, mut v) = self.state(theta);
        if self.motions() == 1 {
            v[1] = v[0].abs() * own.point.slope_squared.max(0.0).sqrt();
        }
        let ticks = 1.0 + own.sensors.time_base;
        let t_s: Vec<f64> = self.t_s.iter().map(|t| t / ticks).collect();
        fly_point_states(own, &t_s, self.recorded_inputs(), p, v).ok()
    }

    /// What would be recorded along the measured axes, one axis after the other, from an initial state.
    pub(super) fn flown(&self, own: &Plant, theta: &DVector<f64>) -> Option<DVector<f64>> {
        if let Some(poses) = &self.poses {
            return self.pose_flown(poses, own, theta);
        }
        let states = self.states(own, theta)?;
        let longer = 1.0 + own.sensors.length_scale;
        let m = self.motions();
        let mut out = DVector::zeros(self.measured.len());
        let mut own = own.clone();
        for (k, &channel) in self.axes.iter().enumerate() {
            let axis = channel % 3;
            let force = self.kind().is_force(channel);
            for (i, s) in states.iter().enumerate() {
                let mean = s.position[axis] + 0.5 * s.acceleration[axis] * self.scatter_s2[i];
                let value = match self.kind() {
                    _ if force => {
                        let gravity = if axis == 0 { own.environment.gravity_m_s2 } else { 0.0 };
                        s.acceleration[axis] - gravity + theta[m + k]
                    }
                    Measured::Angle => mean,
                    _ if axis == 0 && own.point.altimeter => {
                        for (place, series) in self.recorded_inputs() {
                            own.point.inputs[*place] = series[i];
                        }
                        longer * mean - own.altimeter_error_m(Vec3::from_array(s.velocity))
                    }
                    _ => longer * mean,
                };
                out[k * states.len() + i] = value / self.scales[k];
            }
        }
        Some(out)
    }

    /// Change of what is recorded with a steady push along each tunnel axis whose position was measured, per m/s², and of poses with a steady
    /// turn about each body axis, per rad/s²: central differences.
    fn push_columns(&self, own: &Plant, theta: &DVector<f64>) -> Option<DMatrix<f64>> {
        let step = if self.poses.is_some() { POSE_PUSH_STEP } else { PUSH_STEP };
        let at = |axis: usize, by: f64| {
            let mut moved = own.clone();
            let along = |first: usize| std::array::from_fn(|a| if first + a == axis { by } else { 0.0 });
            match moved.free_flight.as_mut() {
                Some(free) => {
                    free.push += Vec3::from_array(along(0));
                    free.turn += Vec3::from_array(along(3));
                }
                None => moved.point.acceleration += Vec3::from_array(along(0)),
            }
            self.flown(&moved, theta)
        };
        let slope = |axis: &usize| Some((at(*axis, step)? - at(*axis, -step)?) / (2.0 * step));
        Some(DMatrix::from_columns(&self.axes.iter().take(self.motions()).map(slope).collect::<Option<Vec<_>>>()?))
    }

    /// Time, speed and what else residuals may vary with, at every sample; `evidence` names them.
    pub(super) fn varied(&self, own: &Plant, theta: &DVector<f64>) -> Option<Vec<Vec<f64>>> {
        if let Some(poses) = &self.poses {
            let flow = self.pose_flow(poses, own, theta)?;
            return Some(flow.iter().zip(&self.t_s).map(|([v, a, b], t)| vec![*t, *v, *a, *b]).collect());
        }
        let states = self.states(own, theta)?;
        let of = |(i, s): (usize, &PointState)| {
            let v = s.velocity;
            match self.kind() {
                Measured::Angle => vec![self.t_s[i], s.position[0], v[0]],
                _ => vec![self.t_s[i], v[0], v[0].hypot(v[1]).hypot(v[2])],
            }
        };
        Some(states.iter().enumerate().map(of).collect())
    }
}

/// Standard deviation of one sample of a channel as the campaign states it, in the channel's unit.
pub(crate) fn stated_std(plant: &Plant, kind: Measured, channel: usize) -> f64 {
    match kind {
        Measured::Pose if channel == 3 => plant.sensors.roll_std_rad,
        Measured::Pose if channel > 3 => plant.sensors.pitch_yaw_std_rad,
        Measured::PositionAndForce if channel > 2 => plant.sensors.specific_force_std_m_s2,
        Measured::Position | Measured::Pose | Measured::PositionAndForce => plant.sensors.position_std_m,
        Measured::SpecificForce => plant.sensors.specific_force_std_m_s2,
        Measured::Angle => plant.sensors.angle_std_rad,
    }
}

/// Means over groups of so many neighbouring samples, and the variance of each group's times, s²; samples that fill no group at the end
/// are left out.
fn averaged(record: &PointRecord, group: usize) -> (PointRecord, Vec<f64>) {
    if group < 2 {
        return (record.clone(), vec![0.0; record.t_s.len()]);
    }
    let mean = |x: &[f64]| x.chunks_exact(group).map(|c| c.iter().sum::<f64>() / group as f64).collect::<Vec<f64>>();
    let t_s = mean(&record.t_s);
    let scatter = |(c, m): (&[f64], &f64)| c.iter().map(|t| (t - m).powi(2)).sum::<f64>() / group as f64;
    let scatter_s2 = record.t_s.chunks_exact(group).zip(&t_s).map(scatter).collect();
    let position_m = record.series().each_ref().map(|s| s.as_deref().map(mean));
    let specific_force_m_s2 = record.specific_force_m_s2.each_ref().map(|s| s.as_deref().map(mean));
    let recorded_inputs = record.recorded_inputs.iter().map(|(i, u)| (*i, mean(u))).collect();
    (PointRecord { t_s, position_m, specific_force_m_s2, recorded_inputs, ..record.clone() }, scatter_s2)
}

#[cfg(test)]
mod tests;
