//! verify: evidence from flights of a point mass. In: tracks and a plant. Out: residual positions in bins, their noise.
//!
//! A run's residual is its measured track less the simulated one, with the initial position and velocity along the measured axes
//! estimated inside (variable projection, Golub and Pereyra 1973). What is left is written in an orthonormal basis that is
//! orthogonal to a change of initial state and runs from slow to fast: cosines of time, orthogonalised in that order, and before them
//! what a steady push leaves, where that is a part of the unmodelled residual. Bins are runs of twelve neighbouring basis functions, each with the full covariance of any noise in it.
//!
//! Sensor noise is white, of the stated standard deviation or what the fast half of the orders shows, if that is less: a stated
//! value that covers drift as well would hide the drift. The unmodelled residual has parts per axis whose sizes are fitted: more white noise; a random walk (what
//! a drifting tracker leaves: variance falls with the square of the order); and, where there are runs enough to tell, what a
//! steady push and a random slow force leave, different in every run. Without the second, tracks with correlated errors give intervals that are
//! several times too short; without the third, scatter between launches counts as an effect. What the tracker is
//! stated to err may be the same in every run: no repetition tells that from an effect, so an effect must take more than the
//! stated variance out of the tracks along some axis.

use super::evidence::{BIN, Cov, Evidence, LeadTable, Residual};
use super::fit::Fit;
use super::repeat::Witnesses;
use crate::VerifyError;
use crate::close::ChannelResidual;
use nalgebra::DVector;
use rayon::prelude::*;
use windfall_model::{Campaign, Data, Plant};
use windfall_sim::fly_point;

mod drift;
mod track;

use drift::Own;
use track::Track;

/// Smallest sensor noise assumed, m: simulated tracks may be free of it.
const FLOOR_M: f64 = 1e-6;
/// Runs from which the scatter of slow forces between runs is part of the unmodelled residual; fewer cannot tell it from an
/// effect.
const RUNS_FOR_SCATTER: usize = 5;

/// Residual positions of one run.
#[derive(Clone, Debug)]
pub struct TrackResidual {
    /// Index of the run in its campaign.
    pub run: usize,
    /// Times from the first sample, s.
    pub t_s: Vec<f64>,
    /// Measured less simulated position along tunnel X, Y, Z, m; absent for an axis that was not measured.
    pub residual_m: [Option<Vec<f64>>; 3],
    /// Estimated position at the first sample, m, tunnel axes (zero along an axis that was not measured).
    pub position_m: [f64; 3],
    /// Estimated velocity at the first sample, m/s, tunnel axes.
    pub velocity_m_s: [f64; 3],
}

/// Evidence of flights of a point mass.
pub struct PointEvidence {
    tracks: Vec<Track>,
    variance_m2: f64,
    inputs: Vec<String>,
    noise: Vec<Cov>,
    generic: Vec<Vec<Cov>>,
}

impl PointEvidence {
    /// Prepares the runs of a campaign whose indices are given. The basis is laid around the flights of `around`, usually the
    /// declared plant; intervals are sharpest when it is laid around the fitted one.
    ///
    /// # Errors
    /// Tunnel runs; tracks with fewer than four samples; tracks that `around` cannot fly.
    pub fn new(campaign: &Campaign, indices: &[usize], around: &Plant) -> Result<Self, VerifyError> {
        let pushed = indices.len() >= RUNS_FOR_SCATTER;
        let tracks = indices
            .par_iter()
            .map(|&i| match &campaign.runs[i].data {
                Data::Point(record) => Track::new(record, &campaign.runs[i].inputs, i, around, pushed),
                Data::Tunnel(_) => Err(VerifyError::NotPoint { run: campaign.runs[i].name.clone() }),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let variance_m2 = campaign.plant.sensors.position_std_m.max(FLOOR_M).powi(2);
        let inputs = campaign.inputs.clone();
        let mut evidence = Self { tracks, variance_m2, inputs, noise: Vec::new(), generic: Vec::new() };
        evidence.measure();
        Ok(evidence)
    }

    /// Covariances in the bases as they lie.
    fn measure(&mut self) {
        let tracks = &self.tracks;
        let white: [f64; 3] = std::array::from_fn(|axis| self.white_m2(axis));
        let noise = tracks.iter().flat_map(|t| t.blocks(|a, s, r| if same(s, r) { white[a] } else { 0.0 }, 1.0)).collect();
        let generic = self
            .axes()
            .into_iter()
            .flat_map(|axis| {
                let variance = white[axis];
                let extra = parts(tracks, variance, |a, s, r| if a == axis && same(s, r) { 1.0 } else { 0.0 });
                let walk = parts(tracks, variance, |a, s, r| if a == axis { s.min(r) } else { 0.0 });
                let force = parts(tracks, variance, |a, s, r| if a == axis { smooth(s, r) } else { 0.0 });
                let mut all = vec![extra, walk];
                if tracks.len() >= RUNS_FOR_SCATTER {
                    all.extend([force, pushes(tracks, variance, axis)]);
                }
                all
            })
            .collect();
        (self.noise, self.generic) = (noise, generic);
    }

    /// Variance of white noise along an axis, m²: as stated, or the median square of the fast half of the orders over that of a
    /// unit normal (0.4549), if that is less.
    fn white_m2(&self, axis: usize) -> f64 {
        let fast = |t: &Track| -> Vec<f64> {
            let m = t.axes.len();
            let Some(k) = t.axes.iter().position(|a| *a == axis) else { return Vec::new() };
            t.laid.iter().skip(k).step_by(m).skip(t.laid.len() / m / 2).map(|z| z * z).collect()
        };
        let mut squares: Vec<f64> = self.tracks.iter().flat_map(fast).collect();
        squares.sort_by(f64::total_cmp);
        let median = squares.get(squares.len() / 2).map_or(f64::INFINITY, |m| m / 0.4549);
        self.variance_m2.min(median).max(FLOOR_M * FLOOR_M)
    }

    /// White noise along an axis, m: see [`Self::white_m2`].
    pub(crate) fn white_m(&self, axis: usize) -> f64 {
        self.white_m2(axis).sqrt()
    }

    /// Axes that any run has measured.
    fn axes(&self) -> Vec<usize> {
        (0..3).filter(|axis| self.tracks.iter().any(|t| t.axes.contains(axis))).collect()
    }

    /// Where the numbers of an axis stand among all numbers of the bins: place, order from slow (0) to fast, and frequency, Hz.
    fn places(&self, axis: usize) -> Vec<(usize, usize, f64)> {
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

    /// Root mean square of the residual positions over all samples and measured axes, m, with every run's initial state
    /// estimated from that run; NaN when a flight is not finite.
    #[must_use]
    pub fn rms_m(&self, plant: &Plant) -> f64 {
        let square = |t: &Track| self.least(t, plant).map(|(_, e)| (e.norm_squared(), t.measured.len() as f64));
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
        let n = t.t_s.len();
        let mut residual_m = [None, None, None];
        for (k, &axis) in t.axes.iter().enumerate() {
            residual_m[axis] = Some(e.as_slice()[k * n..(k + 1) * n].to_vec());
        }
        let (position_m, velocity_m_s) = t.state(&theta);
        Some(TrackResidual { run: t.index, t_s: t.t_s.clone(), residual_m, position_m, velocity_m_s })
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

impl Evidence for PointEvidence {
    fn bins(&self) -> usize {
        self.noise.len()
    }
    fn samples(&self) -> usize {
        self.tracks.iter().map(|t| t.basis.ncols()).sum()
    }
    fn copies(&self) -> usize {
        0
    }
    fn residual(&self, plant: &Plant, _copy: usize) -> Residual {
        let all = self.residuals(plant, Track::binned);
        let nan = |t: &Track| vec![f64::NAN; t.bins() * BIN];
        all.into_iter().zip(&self.tracks).flat_map(|(z, t)| z.unwrap_or_else(|| nan(t))).collect()
    }
    fn noise(&self) -> &[Cov] {
        &self.noise
    }
    fn generic(&self) -> &[Vec<Cov>] {
        &self.generic
    }
    fn random(&self, _plant: &Plant) -> Vec<Cov> {
        vec![Cov::zeros(); self.bins()]
    }
    fn settle(&mut self, plant: &Plant) {
        let laid: Vec<bool> = self.tracks.par_iter_mut().map(|t| t.lay(plant).is_some()).collect();
        if laid.iter().any(|ok| *ok) {
            self.measure();
        }
    }
    fn channel_residuals(&self, z: &[f64], expected: &[Cov], fitted: usize) -> Vec<ChannelResidual> {
        let axes = self.axes();
        let share = fitted as f64 / axes.len().max(1) as f64;
        axes.iter()
            .enumerate()
            .map(|(c, &axis)| {
                let per_axis = self.generic.len() / axes.len();
                let own = Own { noise: expected, parts: [&self.generic[per_axis * c], &self.generic[per_axis * c + 1]], z };
                own.judge(["X", "Y", "Z"][axis], &self.places(axis), share)
            })
            .collect()
    }
    fn rms_m(&self, plant: &Plant) -> Option<f64> {
        Some(Self::rms_m(self, plant))
    }
    fn lead_table(&self, plant: &Plant) -> LeadTable {
        let axes = self.axes();
        let names = ["time in the run (s)", "velocity along X (m/s)", "speed (m/s)"].map(str::to_owned);
        let mut variables: Vec<(String, Vec<f64>)> =
            names.into_iter().chain(self.inputs.clone()).map(|n| (n, Vec::new())).collect();
        let mut residuals = vec![Vec::new(); axes.len()];
        for (t, track) in self.tracks.iter().filter_map(|t| Some((t, self.series_of(t, plant)?))) {
            let n = track.t_s.len();
            for (c, &axis) in axes.iter().enumerate() {
                residuals[c].extend(track.residual_m[axis].clone().unwrap_or_else(|| vec![0.0; n]));
            }
            let own = t.own(plant);
            let steps = fly_point(&own, own.point.air_density_kg_m3, &track.t_s, track.position_m, track.velocity_m_s)
                .unwrap_or_default();
            for (i, time) in track.t_s.iter().enumerate() {
                let v = slope(&track.t_s, &steps, i);
                let values = [*time, v[0], v[0].hypot(v[1]).hypot(v[2])];
                variables.iter_mut().zip(values.iter().chain(&t.inputs)).for_each(|((_, s), x)| s.push(*x));
            }
        }
        LeadTable { residuals, variables }
    }
    fn peak_hz(&self, fit: &Fit, channel: usize) -> Option<f64> {
        let axis = *self.axes().get(channel)?;
        self.places(axis)
            .into_iter()
            .map(|(i, _, f)| (fit.residual[i].powi(2) / self.noise[i / BIN][(i % BIN, i % BIN)], f))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, f)| f)
    }
    fn residual_of(&self, plant: &Plant, run: usize) -> Residual {
        let mut out = Vec::with_capacity(self.bins() * BIN);
        for (k, t) in self.tracks.iter().enumerate() {
            if k == run {
                let z = t.estimated(plant).map(|(_, e)| t.binned(&e));
                out.extend(z.unwrap_or_else(|| vec![f64::NAN; t.bins() * BIN]));
            } else {
                out.resize(out.len() + t.bins() * BIN, 0.0);
            }
        }
        out
    }
    fn durations_s(&self) -> Vec<f64> {
        self.tracks.iter().map(Track::duration_s).collect()
    }
    fn known_causes(&self) -> usize {
        self.generic.len()
    }
    fn tells(&self, before: &[f64], after: &[f64]) -> bool {
        self.axes().into_iter().any(|axis| {
            let places = self.places(axis);
            let square = |z: &[f64]| places.iter().map(|(i, ..)| z[*i] * z[*i]).sum::<f64>();
            square(before) - square(after) > self.variance_m2 * places.len() as f64
        })
    }
    fn witnesses(&self) -> Option<Witnesses> {
        let runs = self.tracks.len();
        (runs >= RUNS_FOR_SCATTER).then(|| Witnesses { runs, axes: self.axes().len() })
    }
    fn run_indices(&self) -> Vec<usize> {
        self.tracks.iter().map(|t| t.index).collect()
    }
}

/// One component of the unmodelled residual over all runs, scaled so that its mean variance where it acts is `variance`.
fn parts(tracks: &[Track], variance: f64, kernel: impl Fn(usize, f64, f64) -> f64) -> Vec<Cov> {
    let all: Vec<Cov> = tracks.iter().flat_map(|t| t.blocks(&kernel, 0.0)).collect();
    scaled(all, tracks, variance, |a, end| kernel(a, end, end) > 0.0)
}

/// The component of a steady push along `axis`, different in every run, scaled likewise.
fn pushes(tracks: &[Track], variance: f64, axis: usize) -> Vec<Cov> {
    let all: Vec<Cov> = tracks.iter().flat_map(|t| t.push_blocks(axis)).collect();
    scaled(all, tracks, variance, |a, _| a == axis)
}

fn scaled(mut all: Vec<Cov>, tracks: &[Track], variance: f64, acts: impl Fn(usize, f64) -> bool) -> Vec<Cov> {
    let trace: f64 = all.iter().map(nalgebra::Matrix::trace).sum();
    let used: f64 = tracks
        .iter()
        .flat_map(|t| t.axes.iter().map(move |&a| (t, a)))
        .filter(|(t, a)| acts(*a, t.duration_s()))
        .map(|(t, _)| t.t_s.len() as f64 - 2.0)
        .sum();
    let scale = variance * used / trace.max(f64::MIN_POSITIVE);
    all.iter_mut().for_each(|m| *m *= scale);
    all
}

/// One sample.
fn same(s: f64, r: f64) -> bool {
    s.total_cmp(&r).is_eq()
}

/// Covariance of the position that a force of white noise leaves (the prior of cubic splines, Wahba 1978).
fn smooth(s: f64, r: f64) -> f64 {
    let (low, high) = (s.min(r), s.max(r));
    low * low * (3.0 * high - low) / 6.0
}

/// Velocity between a sample and its neighbour, m/s.
fn slope(t_s: &[f64], positions_m: &[[f64; 3]], i: usize) -> [f64; 3] {
    let k = i.clamp(1, t_s.len() - 1);
    let dt = t_s[k] - t_s[k - 1];
    std::array::from_fn(|a| positions_m.get(k).map_or(f64::NAN, |p| (p[a] - positions_m[k - 1][a]) / dt))
}
