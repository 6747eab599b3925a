//! discover: evidence from tracks: flights of a body without attitude, or of a rigid one whose pose was recorded. In: tracks and a plant. Out: residuals in bins, their noise.
//!
//! A run's residual is its measured track (positions, specific forces or an angle) less the simulated one, with the initial position and velocity along the measured axes
//! estimated inside (variable projection, Golub and Pereyra 1973). What is left is written in an orthonormal basis that is
//! orthogonal to a change of initial state and runs from slow to fast: cosines of time, orthogonalised in that order, and before them
//! what a steady push leaves, where that is a part of the unmodelled residual. Bins are runs of twelve neighbouring basis functions, each with the full covariance of any noise in it.
//!
//! Sensor noise is white, of the stated standard deviation or what the fast half of the orders shows, if that is less: a stated
//! value that covers drift as well would hide the drift. The unmodelled residual has parts per axis whose sizes are fitted: more white noise; a random walk (what
//! a drifting tracker leaves: variance falls with the square of the order); and, where there are runs enough to tell, what a
//! steady push and a random slow force leave, different in every run. Without the second, tracks with correlated errors give intervals that are
//! several times too short; without the third, scatter between launches counts as an effect. An accelerometer beside positions has neither: it is
//! off by a constant in each run, and drifts in a flight by less than its noise; a walk of it could stand for any force. What the tracker is
//! stated to err may be the same in every run: no repetition tells that from an effect, so an effect must take more than the
//! stated variance out of the tracks along some axis.

use super::bins::{BIN, Cov};
use super::components::{parts, pushes, same, smooth};
use super::drift::AxisNoise;
use super::scatter;
use super::track::{FLOOR, Track, stated_std};
use super::witnesses::Witnesses;
use crate::DiscoverError;
use crate::residual::{ChannelResidual, LeadTable};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use windfall_model::{Campaign, Data, Measured, Plant};

/// Runs from which the scatter of slow forces between runs is part of the unmodelled residual; fewer cannot tell it from an
/// effect.
const RUNS_FOR_SCATTER: usize = 5;

/// Residual positions of one run.
#[derive(Clone, Debug)]
pub struct TrackResidual {
    /// Index of the run in its campaign.
    pub run: usize,
    /// What was measured: residuals are in its unit.
    pub measured: Measured,
    /// Times from the first sample, s.
    pub t_s: Vec<f64>,
    /// Measured less simulated, in the channels' units, in the order of [`Measured::names`]: along tunnel X, Y, Z, of poses rotations about
    /// the body's axes (rad) after them, of positions beside specific forces those; absent for a channel that was not measured.
    pub residual_m: [Option<Vec<f64>>; 6],
    /// Estimated position at the first sample, m, tunnel axes (zero along an axis that was not measured).
    pub position_m: [f64; 3],
    /// Estimated velocity at the first sample, m/s, tunnel axes.
    pub velocity_m_s: [f64; 3],
}

/// Evidence of tracks.
pub struct TrackEvidence {
    pub(super) tracks: Vec<Track>,
    pub(super) kind: Measured,
    /// Of one sample of each channel, as stated, in the unit of residuals.
    variances: [f64; 6],
    /// That unit over the channel's: one where all channels have the same unit.
    scales: [f64; 6],
    inputs: Vec<String>,
    pub(super) noise: Vec<Cov>,
    generic: Vec<Vec<Cov>>,
    /// Place in `generic` of the first component along each measured axis, which is more white noise.
    firsts: Vec<usize>,
    /// Unit covariances of a random walk along each measured axis: components of `generic` but for specific forces beside positions.
    walks: Vec<Vec<Cov>>,
}

impl TrackEvidence {
    /// Prepares the runs of a campaign whose indices are given. The basis is laid around the flights of `around`, usually the
    /// declared plant; intervals are sharpest when it is laid around the fitted one.
    ///
    /// # Errors
    /// Tunnel runs; tracks with fewer than four samples; tracks that `around` cannot fly.
    pub fn new(campaign: &Campaign, indices: &[usize], around: &Plant) -> Result<Self, DiscoverError> {
        let kind = campaign.measured();
        let pushed = recordings(campaign, indices) >= RUNS_FOR_SCATTER;
        let tracks = indices
            .par_iter()
            .map(|&i| match &campaign.runs[i].data {
                Data::Point(record) => {
                    let track = Track::new(record, &campaign.runs[i].inputs, i, around, pushed);
                    track.map_err(|fault| fault.of_run(campaign, i))
                }
                Data::Tunnel(_) => Err(DiscoverError::NotPoint { run: campaign.runs[i].name.clone() }),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let stated = std::array::from_fn(|c| stated_std(&campaign.plant, kind, c).max(FLOOR));
        let mixed = kind == Measured::PositionAndForce;
        let (scales, variances) = if mixed { (stated, [1.0; 6]) } else { ([1.0; 6], stated.map(|s: f64| s.powi(2))) };
        let inputs = campaign.inputs.clone();
        let (noise, generic, firsts, walks) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut evidence = Self { tracks, kind, variances, scales, inputs, noise, generic, firsts, walks };
        evidence.measure();
        Ok(evidence)
    }

    /// Covariances in the bases as they lie.
    fn measure(&mut self) {
        let tracks = &self.tracks;
        let white: [f64; 6] = std::array::from_fn(|axis| self.white_variance(axis));
        let noise =
            tracks.iter().flat_map(|t| t.blocks(|a, s, r| if same(s, r) { white[a] / t.group } else { 0.0 }, 1.0)).collect();
        let scatter = self.recordings() >= RUNS_FOR_SCATTER;
        // Of poses the scatter between runs is all of it.
        let axes = if self.kind == Measured::Pose { Vec::new() } else { self.axes() };
        let walk = |axis: usize| parts(tracks, white[axis], |a, s, r| if a == axis { s.min(r) } else { 0.0 });
        let walks: Vec<Vec<Cov>> = axes.iter().map(|a| walk(*a)).collect();
        let each: Vec<Vec<Vec<Cov>>> = axes
            .into_iter()
            .zip(&walks)
            .map(|(axis, walk)| {
                let variance = white[axis];
                let mut all = vec![parts(tracks, variance, |a, s, r| if a == axis && same(s, r) { 1.0 } else { 0.0 })];
                if self.kind == Measured::PositionAndForce && self.kind.is_force(axis) {
                    return all;
                }
                all.push(walk.clone());
                if scatter {
                    all.push(parts(tracks, variance, |a, s, r| if a == axis { smooth(s, r) } else { 0.0 }));
                }
                if scatter && matches!(self.kind, Measured::Position | Measured::PositionAndForce) {
                    all.push(pushes(tracks, variance, axis));
                }
                all
            })
            .collect();
        self.firsts = each.iter().scan(0, |next, parts| Some(std::mem::replace(next, *next + parts.len()))).collect();
        (self.noise, self.walks, self.generic) = (noise, walks, each.into_iter().flatten().collect());
    }

    /// Variance of one sample's white noise along an axis, in the unit of residuals: as stated, or the median square of the fast half of the orders over that of
    /// a unit normal (0.4549), if that is less.
    pub(crate) fn white_variance(&self, axis: usize) -> f64 {
        if self.kind == Measured::Pose {
            return self.variances[axis];
        }
        let fast = |t: &Track| -> Vec<f64> {
            let m = t.axes.len();
            let Some(k) = t.axes.iter().position(|a| *a == axis) else { return Vec::new() };
            t.laid.iter().skip(k).step_by(m).skip(t.laid.len() / m / 2).map(|z| t.group * z * z).collect()
        };
        let mut squares: Vec<f64> = self.tracks.iter().flat_map(fast).collect();
        squares.sort_by(f64::total_cmp);
        let median = squares.get(squares.len() / 2).map_or(f64::INFINITY, |m| m / 0.4549);
        self.variances[axis].min(median).max(FLOOR * FLOOR)
    }

    /// Standard deviation of one sample of a channel as the campaign states it, and that of its white noise as it was found, in the
    /// channel's unit.
    pub(crate) fn stds(&self, channel: usize) -> [f64; 2] {
        [self.variances[channel], self.white_variance(channel)].map(|v| self.scales[channel] * v.sqrt())
    }

    /// Recordings that its runs are of.
    pub(crate) fn recordings(&self) -> usize {
        let mut all: Vec<String> = self.tracks.iter().map(Track::recording).collect();
        all.sort();
        all.dedup();
        all.len()
    }

    /// Axes that any run has measured.
    pub(super) fn axes(&self) -> Vec<usize> {
        (0..6).filter(|axis| self.tracks.iter().any(|t| t.axes.contains(axis))).collect()
    }

    /// Where the numbers of an axis stand among all numbers of the bins: place, order from slow (0) to fast, and frequency, Hz.
    pub(super) fn places(&self, axis: usize) -> Vec<(usize, usize, f64)> {
        let mut all = Vec::new();
        let mut start = 0;
        for t in &self.tracks {
            let m = t.axes.len();
            if let Some(k) = t.axes.iter().position(|a| *a == axis) {
                let orders = t.basis.ncols() / m;
                all.extend((0..orders).map(|o| (start + o * m + k, o, 0.5 * (o + 2) as f64 / t.duration_s())));
            }
            start += t.bins() * BIN;
        }
        all
    }

    /// Root mean squares over all samples of the distance from measured to flown position, m, and of the angle between the attitudes, rad, of
    /// poses, with every run's initial state estimated from that run; NaN when a flight is not finite.
    #[must_use]
    pub fn pose_rms(&self, plant: &Plant) -> [f64; 2] {
        let squares = |t: &Track| {
            let n = t.t_s.len();
            self.least(t, plant).map(|(_, e)| [e.rows(0, 3 * n).norm_squared(), e.rows(3 * n, 3 * n).norm_squared(), n as f64])
        };
        let all: Vec<_> = self.tracks.par_iter().map(squares).collect();
        let sum = |k: usize| all.iter().map(|x| x.map_or(f64::NAN, |s| s[k])).sum::<f64>();
        [0, 1].map(|k| (sum(k) / sum(2)).sqrt())
    }

    /// Root mean square of the residual over all samples and measured axes, in the unit of what was measured (m of positions), with every
    /// run's initial state estimated from that run; NaN when a flight is not finite. Specific forces beside positions are not in it.
    #[must_use]
    pub fn rms_m(&self, plant: &Plant) -> f64 {
        self.rms(plant, false)
    }

    /// The same of specific forces beside positions, m/s².
    #[must_use]
    pub fn rms_m_s2(&self, plant: &Plant) -> f64 {
        self.rms(plant, true)
    }

    fn rms(&self, plant: &Plant, beside: bool) -> f64 {
        let square = |t: &Track| self.least(t, plant).map(|(_, e)| t.squares(&e, beside));
        let all: Vec<_> = self.tracks.par_iter().map(square).collect();
        let (sum, n) = all.iter().fold((0.0, 0.0), |(s, n), x| x.map_or((f64::NAN, n), |(q, m)| (s + q, n + m)));
        (sum / n).sqrt()
    }

    /// Residual series of every run, in the order of its indices; runs that the plant cannot fly are left out.
    #[must_use]
    pub fn series(&self, plant: &Plant) -> Vec<TrackResidual> {
        self.tracks.par_iter().filter_map(|t| self.series_of(t, plant)).collect()
    }

    fn series_of(&self, t: &Track, plant: &Plant) -> Option<TrackResidual> {
        let (theta, e) = self.least(t, plant)?;
        let mut residual_m = [const { None }; 6];
        for (k, &axis) in t.axes.iter().enumerate() {
            residual_m[axis] = Some(t.channel_of(&e, k));
        }
        let (position_m, velocity_m_s) = t.state(&theta);
        Some(TrackResidual { run: t.index, measured: t.kind(), t_s: t.t_s.clone(), residual_m, position_m, velocity_m_s })
    }

    /// Residual track with the initial state of least squares, what re-simulation is judged by.
    fn least(&self, t: &Track, plant: &Plant) -> Option<(DVector<f64>, DVector<f64>)> {
        let (start, _) = t.estimated(plant)?;
        t.least_squares(&t.own(plant), start)
    }

    fn residuals<T: Send>(&self, plant: &Plant, of: impl Fn(&Track, &DVector<f64>) -> T + Sync) -> Vec<Option<T>> {
        self.tracks.par_iter().map(|t| t.estimated(plant).map(|(_, e)| of(t, &e))).collect()
    }
}

impl TrackEvidence {
    /// Real numbers in use over all bins (the sample size of the likelihood).
    #[must_use]
    pub fn samples(&self) -> usize {
        self.tracks.iter().map(|t| t.basis.ncols()).sum()
    }
    /// Residual under a plant. A run whose state the plant makes non-finite gives NaN.
    #[must_use]
    pub fn residual(&self, plant: &Plant) -> Vec<f64> {
        let all = self.residuals(plant, Track::binned);
        let nan = |t: &Track| vec![f64::NAN; t.bins() * BIN];
        let mut z: Vec<f64> = all.into_iter().zip(&self.tracks).flat_map(|(z, t)| z.unwrap_or_else(|| nan(t))).collect();
        if let Some(used) = self.slow_numbers() {
            z.chunks_exact_mut(BIN).for_each(|run| run[used..].fill(0.0));
        }
        z
    }
    /// How many slow numbers a run is, of poses; none where every order counts.
    pub(crate) fn slow_numbers(&self) -> Option<usize> {
        (self.kind == Measured::Pose).then(|| scatter::numbers(self.recordings()))
    }
    /// Factor on variances of estimates, as few runs tell the covariance between runs; those of other tracks are fitted as they are.
    pub(crate) fn inflation(&self) -> f64 {
        if self.kind == Measured::Pose { scatter::widened(self.recordings()) } else { 1.0 }
    }
    /// Factor on twice a gain of log-likelihood by `tested` numbers over a fit with `known` ones, as few runs allow it.
    pub(crate) fn factor(&self, known: usize, tested: usize) -> f64 {
        match self.kind {
            Measured::Pose => scatter::share(self.recordings()),
            _ => self.witnesses().map_or(1.0, |w| w.factor(known, tested)),
        }
    }
    /// Covariance that sensor noise leaves, per bin.
    pub(crate) fn noise(&self) -> &[Cov] {
        &self.noise
    }
    /// Unit covariance components of an unmodelled residual, to be scaled: each a matrix per bin.
    pub(crate) fn generic(&self) -> &[Vec<Cov>] {
        &self.generic
    }
    /// How many components the unmodelled residual has.
    #[must_use]
    pub fn components(&self) -> usize {
        self.generic.len()
    }
    /// Measures noise again at a better plant. Bases of poses of a flight that keeps its start stay: that flight is as good as linear, and about a plant whose
    /// centre of mass was moved a push at the origin turns the body, each run's another way.
    pub fn settle(&mut self, plant: &Plant) {
        let laid: Vec<bool> = self.tracks.par_iter_mut().map(|t| !t.stays() && t.lay(plant).is_some()).collect();
        if laid.iter().any(|ok| *ok) {
            self.measure();
        }
    }
    /// Residual per measured channel against what noise leaves, with `fitted` parameters.
    #[must_use]
    pub fn channel_residuals(&self, z: &[f64], fitted: usize) -> Vec<ChannelResidual> {
        let axes = self.axes();
        let share = fitted as f64 / axes.len().max(1) as f64;
        if let Some(used) = self.slow_numbers() {
            return axes.iter().map(|&c| self.judged(c, z, used, share)).collect();
        }
        axes.iter()
            .enumerate()
            .map(|(c, &axis)| {
                let own = AxisNoise { noise: &self.noise, parts: [&self.generic[self.firsts[c]], &self.walks[c]], z };
                let mut judged = own.judge(self.kind.names()[axis], &self.places(axis), share);
                judged.rms *= self.scales[axis];
                judged.expected_rms *= self.scales[axis];
                judged
            })
            .collect()
    }
    /// Whether the slow numbers of a channel of poses repeat or follow the inputs.
    fn judged(&self, channel: usize, z: &[f64], used: usize, fitted: f64) -> ChannelResidual {
        let runs = self.tracks.len();
        let values = DMatrix::from_fn(runs, used / 6, |r, k| z[r * BIN + 6 * k + channel]);
        let inputs = DMatrix::from_fn(runs, self.inputs.len(), |r, k| self.tracks[r].inputs[k]);
        scatter::judge(self.kind.names()[channel], &values, &inputs, fitted)
    }
    /// Probability of as large slow numbers of poses from sensors' noise alone; none of other tracks, whose channels are judged against it.
    pub(crate) fn chance_of_noise(&self, z: &[f64]) -> Option<f64> {
        let used = self.slow_numbers()?;
        let square = |(noise, z): (&Cov, &[f64])| {
            let own = DMatrix::from_fn(used, used, |i, k| noise[(i, k)]);
            let z = DVector::from_column_slice(&z[..used]);
            own.cholesky().map_or(f64::INFINITY, |c| z.dot(&c.solve(&z)))
        };
        let sum: f64 = self.noise.iter().zip(z.chunks_exact(BIN)).map(square).sum();
        Some(ChiSquared::new((used * self.noise.len()) as f64).map_or(1.0, |c| c.sf(sum)))
    }
    /// Residual in time beside what it may vary with.
    pub(crate) fn lead_table(&self, plant: &Plant) -> LeadTable {
        let axes = self.axes();
        let names: &[&str] = match self.kind {
            Measured::Angle => &["time in the run (s)", "angle (rad)", "rate (rad/s)"],
            Measured::Pose => &["time in the run (s)", "speed (m/s)", "angle of attack (rad)", "sideslip (rad)"],
            _ => &["time in the run (s)", "velocity along X (m/s)", "speed (m/s)"],
        };
        let mut variables: Vec<(String, Vec<f64>)> =
            names.iter().map(|n| (*n).to_owned()).chain(self.inputs.clone()).map(|n| (n, Vec::new())).collect();
        let mut residuals = vec![Vec::new(); axes.len()];
        for t in &self.tracks {
            let Some((theta, e)) = self.least(t, plant) else { continue };
            let Some(varied) = t.varied(&t.own(plant), &theta) else { continue };
            let n = t.t_s.len();
            for (c, axis) in axes.iter().enumerate() {
                let place = t.axes.iter().position(|a| a == axis);
                residuals[c].extend(place.map_or_else(|| vec![0.0; n], |k| t.channel_of(&e, k)));
            }
            for (i, values) in varied.iter().enumerate() {
                let mut inputs = t.inputs.clone();
                t.recorded_inputs().iter().for_each(|(place, series)| inputs[*place] = series[i]);
                variables.iter_mut().zip(values.iter().chain(&inputs)).for_each(|((_, s), x)| s.push(*x));
            }
        }
        LeadTable { residuals, variables }
    }
    /// Frequency at which the residual along a measured axis stands highest over its noise, Hz.
    pub(crate) fn peak_hz(&self, residual: &[f64], channel: usize) -> Option<f64> {
        let axis = *self.axes().get(channel).filter(|_| self.slow_numbers().is_none())?;
        self.places(axis)
            .into_iter()
            .map(|(i, _, f)| (residual[i].powi(2) / self.noise[i / BIN][(i % BIN, i % BIN)], f))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, f)| f)
    }
    /// Whether one residual is smaller than another by more than an error of the tracker that all runs share could make.
    #[must_use]
    pub fn tells(&self, before: &[f64], after: &[f64]) -> bool {
        self.axes().into_iter().any(|axis| {
            let places = self.places(axis);
            let square = |z: &[f64]| places.iter().map(|(i, ..)| z[*i] * z[*i]).sum::<f64>();
            square(before) - square(after) > self.variances[axis] * places.len() as f64
        })
    }
    /// The runs as witnesses, where there are enough for an effect to repeat in them.
    #[must_use]
    pub fn witnesses(&self) -> Option<Witnesses> {
        let runs = self.recordings();
        (runs >= RUNS_FOR_SCATTER).then(|| Witnesses { runs, axes: self.axes().len() })
    }
}

/// Recordings that these runs are of.
fn recordings(campaign: &Campaign, indices: &[usize]) -> usize {
    let name = |i: &usize| match &campaign.runs[*i].data {
        Data::Point(record) => record.recording.clone().unwrap_or_else(|| format!("run {i}")),
        Data::Tunnel(_) => String::new(),
    };
    let mut all: Vec<String> = indices.iter().map(name).collect();
    all.sort();
    all.dedup();
    all.len()
}

#[cfg(test)]
mod tests;
