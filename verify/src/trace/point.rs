//! verify: evidence from flights of a point mass. In: tracks and a plant. Out: residual positions in bins, their noise.
//!
//! A run's residual is its measured track less the simulated one, with the initial position and velocity along the measured axes
//! estimated inside (variable projection, Golub and Pereyra 1973). What is left is written in an orthonormal basis that is
//! orthogonal to a change of initial state and runs from slow to fast: cosines of time, orthogonalised in that order. Bins are
//! runs of twelve neighbouring basis functions, each with the full covariance of any noise in it.
//!
//! Sensor noise is white. The unmodelled residual has parts per axis whose sizes are fitted: more white noise; a random walk (what
//! a drifting tracker leaves: variance falls with the square of the order); and, where there are runs enough to tell, what a
//! random slow force leaves, different in every run. Without the second, tracks with correlated errors give intervals that are
//! several times too short; without the third, scatter between launches counts as an effect.

use super::evidence::{BIN, Cov, Evidence, LeadTable, Residual};
use super::fit::Fit;
use crate::VerifyError;
use crate::close::ChannelResidual;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use windfall_model::frames::Vec3;
use windfall_model::{Campaign, Data, Plant, PointRecord};
use windfall_sim::fly_point;

mod drift;

use drift::Own;

/// Smallest sensor noise assumed, m: simulated tracks may be free of it.
const FLOOR_M: f64 = 1e-6;
/// Largest last step of an initial state, m (velocities times the duration).
const TOLERANCE_M: f64 = 1e-11;
/// Runs from which the scatter of slow forces between runs is part of the unmodelled residual; fewer cannot tell it from an
/// effect.
const RUNS_FOR_SCATTER: usize = 5;
/// Steps of the search for an initial state.
const STEPS: usize = 40;

/// One run ready for any plant.
struct Track {
    index: usize,
    inputs: Vec<f64>,
    /// Times from the first sample, s.
    t_s: Vec<f64>,
    /// Measured tunnel axes.
    axes: Vec<usize>,
    /// Measured positions, m: one axis after the other.
    measured: DVector<f64>,
    /// Initial state under the plant that the evidence was made with: positions, then velocities times the duration, m.
    start: DVector<f64>,
    /// Orthonormal columns that a change of the initial state spans there.
    state_basis: DMatrix<f64>,
    /// Orthonormal columns of what is left, slow to fast.
    basis: DMatrix<f64>,
    /// Inverse of the change of `state_basisᵀ · position` with the initial state.
    state_inverse: DMatrix<f64>,
}

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
    density_kg_m3: f64,
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
        let density_kg_m3 = campaign.plant.point.air_density_kg_m3;
        let tracks = indices
            .par_iter()
            .map(|&i| match &campaign.runs[i].data {
                Data::Point(record) => Track::new(record, &campaign.runs[i].inputs, i, around, density_kg_m3),
                Data::Tunnel(_) => Err(VerifyError::NotPoint { run: campaign.runs[i].name.clone() }),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let variance_m2 = campaign.plant.sensors.position_std_m.max(FLOOR_M).powi(2);
        let inputs = campaign.inputs.clone();
        let mut evidence = Self { tracks, density_kg_m3, variance_m2, inputs, noise: Vec::new(), generic: Vec::new() };
        evidence.measure();
        Ok(evidence)
    }

    /// Covariances in the bases as they lie.
    fn measure(&mut self) {
        let (tracks, variance) = (&self.tracks, self.variance_m2);
        let noise = tracks.iter().flat_map(|t| t.blocks(|_, s, r| if s == r { variance } else { 0.0 }, 1.0)).collect();
        let generic = self
            .axes()
            .into_iter()
            .flat_map(|axis| {
                let white = parts(tracks, variance, |a, s, r| if a == axis && s == r { 1.0 } else { 0.0 });
                let walk = parts(tracks, variance, |a, s, r| if a == axis { s.min(r) } else { 0.0 });
                let force = parts(tracks, variance, |a, s, r| if a == axis { smooth(s, r) } else { 0.0 });
                if tracks.len() < RUNS_FOR_SCATTER { vec![white, walk] } else { vec![white, walk, force] }
            })
            .collect();
        (self.noise, self.generic) = (noise, generic);
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
        let (start, _) = t.estimated(plant, self.density_kg_m3)?;
        t.least_squares(&t.own(plant), self.density_kg_m3, start)
    }

    fn residuals<T: Send>(&self, plant: &Plant, of: impl Fn(&Track, &DVector<f64>) -> T + Sync) -> Vec<Option<T>> {
        self.tracks.par_iter().map(|t| t.estimated(plant, self.density_kg_m3).map(|(_, e)| of(t, &e))).collect()
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
        let density = self.density_kg_m3;
        let laid: Vec<bool> = self.tracks.par_iter_mut().map(|t| t.lay(plant, density).is_some()).collect();
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
            let steps = fly_point(&own, self.density_kg_m3, &track.t_s, track.position_m, track.velocity_m_s).unwrap_or_default();
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
                let z = t.estimated(plant, self.density_kg_m3).map(|(_, e)| t.binned(&e));
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
    fn run_indices(&self) -> Vec<usize> {
        self.tracks.iter().map(|t| t.index).collect()
    }
}

/// One component of the unmodelled residual over all runs, scaled so that its mean variance where it acts is `variance`.
fn parts(tracks: &[Track], variance: f64, kernel: impl Fn(usize, f64, f64) -> f64) -> Vec<Cov> {
    let mut all: Vec<Cov> = tracks.iter().flat_map(|t| t.blocks(&kernel, 0.0)).collect();
    let trace: f64 = all.iter().map(nalgebra::Matrix::trace).sum();
    let used: f64 = tracks
        .iter()
        .flat_map(|t| t.axes.iter().map(move |&a| (t, a)))
        .filter(|(t, a)| kernel(*a, t.duration_s(), t.duration_s()) > 0.0)
        .map(|(t, _)| t.t_s.len() as f64 - 2.0)
        .sum();
    let scale = variance * used / trace.max(f64::MIN_POSITIVE);
    all.iter_mut().for_each(|m| *m *= scale);
    all
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

impl Track {
    fn new(record: &PointRecord, inputs: &[f64], index: usize, around: &Plant, density: f64) -> Result<Self, VerifyError> {
        let axes: Vec<usize> = (0..3).filter(|&a| record.position_m[a].is_some()).collect();
        let n = record.t_s.len();
        if axes.is_empty() || n < 4 {
            return Err(VerifyError::ShortTrack { run: index, samples: if axes.is_empty() { 0 } else { n }, needed: 4 });
        }
        let t0 = record.t_s[0];
        let measured = DVector::from_iterator(axes.len() * n, record.position_m.iter().flatten().flatten().copied());
        let empty = DMatrix::zeros(0, 0);
        let mut track = Self {
            index,
            inputs: inputs.to_vec(),
            t_s: record.t_s.iter().map(|t| t - t0).collect(),
            start: DVector::zeros(2 * axes.len()),
            axes,
            measured,
            state_basis: empty.clone(),
            basis: empty.clone(),
            state_inverse: empty,
        };
        track.lay(around, density).ok_or(VerifyError::NotFlown { run: index })?;
        Ok(track)
    }

    /// The plant in this run, flying along the measured axes: what is not measured stays still.
    fn own(&self, plant: &Plant) -> Plant {
        let mut own = plant.for_run(self.index, &self.inputs);
        let a = own.point.acceleration.to_array();
        if self.axes.len() < 3 {
            own.point.side_per_input.clear();
            own.point.side_constant = 0.0;
        }
        own.point.acceleration = Vec3::from_array(std::array::from_fn(|i| if self.axes.contains(&i) { a[i] } else { 0.0 }));
        own
    }

    fn duration_s(&self) -> f64 {
        self.t_s.last().copied().unwrap_or(0.0)
    }

    /// Finds the initial state under a plant by Gauss-Newton, and lays the bases there.
    fn lay(&mut self, around: &Plant, density: f64) -> Option<()> {
        let own = self.own(around);
        let (theta, _) = self.least_squares(&own, density, self.guess()?)?;
        let (_, jacobian) = self.linearised(&own, density, &theta)?;
        let states = jacobian.ncols();
        let mut columns = DMatrix::zeros(self.measured.len(), self.measured.len());
        columns.columns_mut(0, states).copy_from(&jacobian);
        let (n, end) = (self.t_s.len(), self.duration_s());
        for k in 2..n {
            for a in 0..self.axes.len() {
                let mut column = columns.column_mut(states + (k - 2) * self.axes.len() + a);
                for (i, t) in self.t_s.iter().enumerate() {
                    column[a * n + i] = (std::f64::consts::PI * k as f64 * t / end).cos();
                }
            }
        }
        let q = columns.qr().q();
        self.state_basis = q.columns(0, states).into_owned();
        self.basis = q.columns(states, q.ncols() - states).into_owned();
        self.state_inverse = (self.state_basis.transpose() * jacobian).try_inverse()?;
        self.start = theta;
        Some(())
    }

    /// Initial state of least squares by Gauss-Newton from a start, and its residual.
    fn least_squares(&self, own: &Plant, density: f64, start: DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
        let mut theta = start;
        for _ in 0..STEPS {
            let (flown, jacobian) = self.linearised(own, density, &theta)?;
            let step = jacobian.svd(true, true).solve(&(&self.measured - flown), 1e-12).ok()?;
            theta += &step;
            if step.amax() < 1e-9 {
                break;
            }
        }
        let e = &self.measured - self.flown(own, density, &theta)?;
        Some((theta, e))
    }

    /// Initial state of the best parabola per axis.
    fn guess(&self) -> Option<DVector<f64>> {
        let (n, end) = (self.t_s.len(), self.duration_s());
        let powers = DMatrix::from_fn(n, 3, |i, k| (self.t_s[i] / end).powi(k as i32));
        let svd = powers.svd(true, true);
        let mut theta = DVector::zeros(2 * self.axes.len());
        for a in 0..self.axes.len() {
            let c = svd.solve(&self.measured.rows(a * n, n), 1e-12).ok()?;
            theta[a] = c[0];
            theta[self.axes.len() + a] = c[1];
        }
        Some(theta)
    }

    /// Position and velocity (m, m/s, tunnel axes) of an initial state.
    fn state(&self, theta: &DVector<f64>) -> ([f64; 3], [f64; 3]) {
        let (mut p, mut v) = ([0.0; 3], [0.0; 3]);
        for (k, &axis) in self.axes.iter().enumerate() {
            p[axis] = theta[k];
            v[axis] = theta[self.axes.len() + k] / self.duration_s();
        }
        (p, v)
    }

    /// Positions along the measured axes, one axis after the other, from an initial state.
    fn flown(&self, own: &Plant, density: f64, theta: &DVector<f64>) -> Option<DVector<f64>> {
        let (p, v) = self.state(theta);
        let flown = fly_point(own, density, &self.t_s, p, v).ok()?;
        Some(DVector::from_iterator(self.measured.len(), self.axes.iter().flat_map(|&a| flown.iter().map(move |r| r[a]))))
    }

    /// Positions and their change with the initial state: exact for positions (nothing depends on place), central differences
    /// of a tenth of a millimetre at the end for velocities.
    fn linearised(&self, own: &Plant, density: f64, theta: &DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let (n, m) = (self.t_s.len(), self.axes.len());
        let mut jacobian = DMatrix::zeros(self.measured.len(), 2 * m);
        for a in 0..m {
            jacobian.column_mut(a).rows_mut(a * n, n).fill(1.0);
            let h = 1e-4;
            let mut moved = theta.clone();
            moved[m + a] += h;
            let up = self.flown(own, density, &moved)?;
            moved[m + a] -= 2.0 * h;
            let down = self.flown(own, density, &moved)?;
            jacobian.set_column(m + a, &((up - down) / (2.0 * h)));
        }
        Some((self.flown(own, density, theta)?, jacobian))
    }

    /// Initial state under a plant, and the residual that it leaves, orthogonal to the state basis; Broyden's (1965) method
    /// from the state under the plant of the bases, so that the answer depends on the plant alone.
    fn estimated(&self, plant: &Plant, density: f64) -> Option<(DVector<f64>, DVector<f64>)> {
        let own = self.own(plant);
        let mut theta = self.start.clone();
        let mut inverse = self.state_inverse.clone();
        let mut e = &self.measured - self.flown(&own, density, &theta)?;
        let mut g = self.state_basis.tr_mul(&e);
        for _ in 0..STEPS {
            let step = &inverse * &g;
            theta += &step;
            e = &self.measured - self.flown(&own, density, &theta)?;
            if step.amax() < TOLERANCE_M {
                return Some((theta, e));
            }
            let next = self.state_basis.tr_mul(&e);
            // inverse += (step − inverse·y) stepᵀ·inverse / (stepᵀ·inverse·y), y the change of position along the basis.
            let by = &inverse * (&g - &next);
            let scale = step.dot(&by);
            if scale.abs() > 0.0 {
                let row = inverse.tr_mul(&step);
                inverse += (&step - by) * row.transpose() / scale;
            }
            g = next;
        }
        None
    }

    fn bins(&self) -> usize {
        self.basis.ncols().div_ceil(BIN)
    }

    /// A residual track in the basis, padded to whole bins.
    fn binned(&self, e: &DVector<f64>) -> Residual {
        let mut z = self.basis.tr_mul(e).as_slice().to_vec();
        z.resize(self.bins() * BIN, 0.0);
        z
    }

    /// Covariance per bin of noise that is independent between axes, from its kernel (axis, time, time) in time; entries that
    /// pad the last bin get `unused` on the diagonal.
    fn blocks(&self, kernel: impl Fn(usize, f64, f64) -> f64, unused: f64) -> Vec<Cov> {
        let n = self.t_s.len();
        let mut time = DMatrix::zeros(self.measured.len(), self.measured.len());
        for (k, &axis) in self.axes.iter().enumerate() {
            time.view_mut((k * n, k * n), (n, n))
                .copy_from(&DMatrix::from_fn(n, n, |i, j| kernel(axis, self.t_s[i], self.t_s[j])));
        }
        let right = time * &self.basis;
        (0..self.bins())
            .map(|bin| {
                let used = (self.basis.ncols() - bin * BIN).min(BIN);
                let (b, r) = (self.basis.columns(bin * BIN, used), right.columns(bin * BIN, used));
                let block = b.tr_mul(&r);
                let mut m = Cov::identity() * unused;
                for i in 0..used {
                    for j in 0..used {
                        m[(i, j)] = 0.5 * (block[(i, j)] + block[(j, i)]);
                    }
                }
                m
            })
            .collect()
    }
}
