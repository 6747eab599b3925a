//! verify: one track of a point mass. In: a record and a plant. Out: residual with the initial state taken out, in a fixed basis.

use super::super::evidence::{BIN, Cov, Residual};
use crate::VerifyError;
use nalgebra::{DMatrix, DVector};
use windfall_model::frames::Vec3;
use windfall_model::{Plant, PointRecord};
use windfall_sim::fly_point;

/// Largest last step of an initial state, m (velocities times the duration).
const TOLERANCE_M: f64 = 1e-11;
/// Steps of the search for an initial state.
const STEPS: usize = 40;

/// One run ready for any plant.
pub(super) struct Track {
    pub(super) index: usize,
    pub(super) inputs: Vec<f64>,
    /// Whether `basis` starts with what a steady push leaves.
    pushed: bool,
    /// Times from the first sample, s.
    pub(super) t_s: Vec<f64>,
    /// Measured tunnel axes.
    pub(super) axes: Vec<usize>,
    /// Measured positions, m: one axis after the other.
    pub(super) measured: DVector<f64>,
    /// Initial state under the plant that the evidence was made with: positions, then velocities times the duration, m.
    pub(super) start: DVector<f64>,
    /// Orthonormal columns that a change of the initial state spans there.
    pub(super) state_basis: DMatrix<f64>,
    /// Orthonormal columns of what is left, slow to fast.
    pub(super) basis: DMatrix<f64>,
    /// What a steady push of 1 m/s² along each measured axis leaves in as many first columns of `basis`, m, if it starts so.
    pub(super) push: DMatrix<f64>,
    /// Residual in `basis` there, m.
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
    ) -> Result<Self, VerifyError> {
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
            pushed,
            inputs: inputs.to_vec(),
            t_s: record.t_s.iter().map(|t| t - t0).collect(),
            start: DVector::zeros(2 * axes.len()),
            axes,
            measured,
            state_basis: empty.clone(),
            basis: empty.clone(),
            laid: DVector::zeros(0),
            push: empty.clone(),
            state_inverse: empty,
        };
        track.lay(around).ok_or(VerifyError::NotFlown { run: index })?;
        Ok(track)
    }

    /// The plant in this run, flying along the measured axes: what is not measured stays still.
    pub(super) fn own(&self, plant: &Plant) -> Plant {
        let mut own = plant.for_run(self.index, &self.inputs);
        let a = own.point.acceleration.to_array();
        if self.axes.len() < 3 {
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
        let (theta, e) = self.least_squares(&own, self.guess()?)?;
        let (_, jacobian) = self.linearised(&own, &theta)?;
        let states = jacobian.ncols();
        let pushed = self.push_columns(&own, &theta)?;
        let mut columns = DMatrix::zeros(self.measured.len(), self.measured.len());
        columns.columns_mut(0, states).copy_from(&jacobian);
        let (n, end) = (self.t_s.len(), self.duration_s());
        let first = usize::from(self.pushed);
        if self.pushed {
            columns.columns_mut(states, self.axes.len()).copy_from(&pushed);
        }
        for k in 2..n - first {
            for a in 0..self.axes.len() {
                let mut column = columns.column_mut(states + (k - 2 + first) * self.axes.len() + a);
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
        self.laid = self.basis.tr_mul(&e);
        self.push = self.basis.columns(0, self.axes.len()).tr_mul(&pushed);
        Some(())
    }

    /// Initial state of least squares by Gauss-Newton from a start, and its residual.
    pub(super) fn least_squares(&self, own: &Plant, start: DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
        let mut theta = start;
        for _ in 0..STEPS {
            let (flown, jacobian) = self.linearised(own, &theta)?;
            let step = jacobian.svd(true, true).solve(&(&self.measured - flown), 1e-12).ok()?;
            theta += &step;
            if step.amax() < 1e-9 {
                break;
            }
        }
        let e = &self.measured - self.flown(own, &theta)?;
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
    pub(super) fn state(&self, theta: &DVector<f64>) -> ([f64; 3], [f64; 3]) {
        let (mut p, mut v) = ([0.0; 3], [0.0; 3]);
        for (k, &axis) in self.axes.iter().enumerate() {
            p[axis] = theta[k];
            v[axis] = theta[self.axes.len() + k] / self.duration_s();
        }
        (p, v)
    }

    /// Recorded positions along the measured axes, one axis after the other, from an initial state.
    fn flown(&self, own: &Plant, theta: &DVector<f64>) -> Option<DVector<f64>> {
        let (p, v) = self.state(theta);
        let (ticks, longer) = (1.0 + own.sensors.time_base, 1.0 + own.sensors.length_scale);
        let t_s: Vec<f64> = self.t_s.iter().map(|t| t / ticks).collect();
        let flown = fly_point(own, own.point.air_density_kg_m3, &t_s, p, v).ok()?;
        let recorded = self.axes.iter().flat_map(|&a| flown.iter().map(move |r| longer * r[a]));
        Some(DVector::from_iterator(self.measured.len(), recorded))
    }

    /// Positions and their change with the initial state: exact for positions (nothing depends on place), central differences
    /// of a tenth of a millimetre at the end for velocities.
    pub(super) fn linearised(&self, own: &Plant, theta: &DVector<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let (n, m) = (self.t_s.len(), self.axes.len());
        let mut jacobian = DMatrix::zeros(self.measured.len(), 2 * m);
        for a in 0..m {
            jacobian.column_mut(a).rows_mut(a * n, n).fill(1.0 + own.sensors.length_scale);
            let h = 1e-4;
            let mut moved = theta.clone();
            moved[m + a] += h;
            let up = self.flown(own, &moved)?;
            moved[m + a] -= 2.0 * h;
            let down = self.flown(own, &moved)?;
            jacobian.set_column(m + a, &((up - down) / (2.0 * h)));
        }
        Some((self.flown(own, theta)?, jacobian))
    }

    /// Change of positions with a steady push along each measured axis, per m/s²: central differences of a tenth.
    fn push_columns(&self, own: &Plant, theta: &DVector<f64>) -> Option<DMatrix<f64>> {
        let at = |axis: usize, by: f64| {
            let mut moved = own.clone();
            moved.point.acceleration += Vec3::from_array(std::array::from_fn(|a| if a == axis { by } else { 0.0 }));
            self.flown(&moved, theta)
        };
        let columns = self.axes.iter().map(|&axis| Some((at(axis, 0.1)? - at(axis, -0.1)?) / 0.2)).collect::<Option<Vec<_>>>()?;
        Some(DMatrix::from_columns(&columns))
    }

    /// Initial state under a plant, and the residual that it leaves, orthogonal to the state basis; Broyden's (1965) method
    /// from the state under the plant of the bases, so that the answer depends on the plant alone.
    pub(super) fn estimated(&self, plant: &Plant) -> Option<(DVector<f64>, DVector<f64>)> {
        let own = self.own(plant);
        let mut theta = self.start.clone();
        let mut inverse = self.state_inverse.clone();
        let mut e = &self.measured - self.flown(&own, &theta)?;
        let mut g = self.state_basis.tr_mul(&e);
        for _ in 0..STEPS {
            let step = &inverse * &g;
            theta += &step;
            e = &self.measured - self.flown(&own, &theta)?;
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

    pub(super) fn bins(&self) -> usize {
        self.basis.ncols().div_ceil(BIN)
    }

    /// A residual track in the basis, padded to whole bins.
    pub(super) fn binned(&self, e: &DVector<f64>) -> Residual {
        let mut z = self.basis.tr_mul(e).as_slice().to_vec();
        z.resize(self.bins() * BIN, 0.0);
        z
    }

    /// Covariance per bin of a steady push of 1 m/s² (standard deviation) along an axis.
    pub(super) fn push_blocks(&self, axis: usize) -> Vec<Cov> {
        let mut all = vec![Cov::zeros(); self.bins()];
        if let Some(k) = self.axes.iter().position(|a| *a == axis) {
            let c = self.push.column(k);
            let m = c.len();
            all[0].view_mut((0, 0), (m, m)).copy_from(&(c * c.transpose()));
        }
        all
    }

    /// Covariance per bin of noise that is independent between axes, from its kernel (axis, time, time) in time; entries that
    /// pad the last bin get `unused` on the diagonal.
    pub(super) fn blocks(&self, kernel: impl Fn(usize, f64, f64) -> f64, unused: f64) -> Vec<Cov> {
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
