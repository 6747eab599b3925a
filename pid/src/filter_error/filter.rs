//! pid: the extended Kalman filter of one run in gusts. In: run, parameters, turbulence, noise. Out: innovations with their
//! covariance, and how both depend on what is estimated.
//!
//! States: motion (12), tunnel speed and two derivatives (3), gusts of Dryden form (1 axial, 2 for each lateral axis). Driving noise
//! enters by the trapezoidal rule, half before and half after each sample's transition: errors of second order in the sample interval over
//! the gust's time scale (0.1 % of a gust's rms at 150 Hz, 0.6 m and 7.4 m/s). The white part of a gust's rate acts on the wind-angle
//! rates, through them on the body rates.
//!
//! Gusts are known only in part. Where forces are not linear in the flow angles, the unknown part acts on average: in 0.1 m/s of gusts
//! the damping C_m,2 α² has C_m,2 × 1.8e-4 = −0.037 of C_m,1 more than at the mean angle, a standard error of it. Rates and slopes are
//! therefore means over two opposite points of that part (statistical linearisation; Gelb 1974, §6.2).

use crate::equations::{Drive, INPUTS, STATES, Segment, Transition, origin_slopes, splits};
use crate::output_error::{FreeColumns, PreparedRun, SPEED};
use nalgebra::{DMatrix, DVector};
use windfall_model::{CHANNELS, Disturbance, Entry, PerChannel, ShapingFilter, StateForm, Turbulence};

/// Gust states, and all states.
const GUSTS: usize = 6;
pub(crate) const ALL: usize = STATES + SPEED + GUSTS;
/// Nodes this far apart, s, or a sample where that is longer: a twelfth of the time in which a gust of 0.6 m passes at 7.4 m/s.
const PIECE_S: f64 = 0.0067;
/// Spread of the first state about the smoothed one: wide against its error, so that the data decide (m, rad, m/s, rad/s, and
/// tunnel speed with its derivatives).
const START_STD: [f64; STATES + SPEED] = [0.02, 0.02, 0.02, 0.05, 0.05, 0.05, 0.2, 0.2, 0.2, 0.4, 0.4, 0.4, 0.05, 1.0, 5.0];

/// A square matrix over the states, row by row.
type Square = [[f64; ALL]; ALL];

/// What a later pass with other gusts needs of one piece.
struct Piece {
    /// Transition to the next node.
    phi: Square,
    /// White part of the gusts' rates into the body rates, per unit of each gust's white noise.
    kick: [[f64; 3]; 3],
}

/// A run as the filter saw it, measurement by measurement: samples in order of time, channels within.
pub(crate) struct FilteredRun {
    /// Slopes of the innovations by the parameters, parameters within.
    pub(crate) by_parameter: Vec<f64>,
    pub(crate) pass: Pass,
    /// Slopes of the predicted outputs by the states at the piece's first sample.
    h: Vec<[f64; ALL]>,
    gain: Vec<[f64; ALL]>,
    pieces: Vec<Piece>,
}

/// A filter ready for one run.
pub(crate) struct Filter<'r, 'a> {
    pub(crate) run: &'r PreparedRun<'a>,
    piece: usize,
    noise: PerChannel<f64>,
}

/// What drives a run at random.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Random {
    pub(crate) turbulence: Turbulence,
    /// White angular acceleration about x and across it, as the root of its intensity, rad/s per root second: moments that neither
    /// the declared model nor gusts make.
    pub(crate) turning: [f64; 2],
}

/// The random side: gust matrices at the run's speed.
struct Gusts {
    drive: Drive,
    /// Transition of input states over a piece.
    end: DMatrix<f64>,
    /// Intensity of white noise on input states, as its root: columns jerk, gusts.
    root: DMatrix<f64>,
    /// White part of each gust's rate, m/s² per unit of noise.
    rate: [f64; 3],
    stationary: DMatrix<f64>,
    turning: [f64; 2],
}

/// Innovations and their variances along a pass, each given all measurements before it.
#[derive(Default)]
pub(crate) struct Pass {
    pub(crate) innovation: Vec<f64>,
    pub(crate) variance: Vec<f64>,
}

impl Pass {
    /// Twice the log-likelihood, up to a constant.
    pub(crate) fn log_likelihood2(&self) -> f64 {
        -self.innovation.iter().zip(&self.variance).map(|(e, s)| e * e / s + s.ln()).sum::<f64>()
    }
}

/// Inputs (tunnel speed and gusts with their rates) by the input states a time before, one row each; a gust is its filter's first
/// state.
fn inputs_at(tau: f64, ns: usize, filters: &[(usize, ShapingFilter<2>)]) -> Vec<f64> {
    let mut m = vec![0.0; INPUTS * ns];
    m[..3].copy_from_slice(&[1.0, tau, 0.5 * tau * tau]);
    m[ns + 1] = 1.0;
    m[ns + 2] = tau;
    for (axis, f) in filters {
        let e = exponential(f.a, tau);
        let column = SPEED + 2 * axis;
        for k in 0..2 {
            m[(2 + axis) * ns + column + k] = e[0][k];
            m[(5 + axis) * ns + column + k] = f.a[0][0] * e[0][k] + f.a[0][1] * e[1][k];
        }
    }
    m
}

impl<'r, 'a> Filter<'r, 'a> {
    pub(crate) fn new(run: &'r PreparedRun<'a>, noise: PerChannel<f64>) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let piece = ((PIECE_S / run.interval_s).round() as usize).max(1);
        Self { run, piece, noise }
    }

    fn pieces(&self) -> usize {
        // The last samples that fill no piece are left out.
        self.run.record.len() / self.piece
    }

    fn gusts(&self, Random { turbulence: t, turning }: &Random) -> Gusts {
        let speed = self.run.record.mean_airspeed_m_s();
        let ns = SPEED + GUSTS;
        // A gust of no size at all keeps its states: rms of a micrometre per second.
        let small = |rms: f64| rms.max(1e-6);
        // Of a band's form the filter knows nothing: it takes all gusts for Dryden's.
        let (axial_rms_m_s, lateral_rms_m_s) = (small(t.axial_rms_m_s), small(t.lateral_rms_m_s));
        let t = Turbulence { axial_rms_m_s, lateral_rms_m_s, bandwidth: 0.0, ..*t };
        let filters: Vec<(usize, ShapingFilter<2>)> = t
            .disturbances(speed)
            .iter()
            .filter_map(|d: &Disturbance| match (d.entry, d.filter()) {
                (Entry::AirVelocity(axis), StateForm::Two(filter)) => Some((axis, own_output(filter))),
                _ => None,
            })
            .collect();
        let (h, parts) = (self.run.interval_s, splits(self.run.record));
        let tau = h * self.piece as f64;
        let mut end = DMatrix::identity(ns, ns);
        end[(0, 1)] = tau;
        end[(0, 2)] = 0.5 * tau * tau;
        end[(1, 2)] = tau;
        let mut root = DMatrix::zeros(ns, 4);
        root[(2, 0)] = self.run.jerk_root;
        let mut stationary = DMatrix::zeros(ns, ns);
        let mut rate = [0.0; 3];
        for (axis, f) in &filters {
            let (e, column) = (exponential(f.a, tau), SPEED + 2 * axis);
            for i in 0..2 {
                for k in 0..2 {
                    end[(column + i, column + k)] = e[i][k];
                }
                root[(column + i, 1 + axis)] = f.b[i];
            }
            rate[*axis] = f.b[0];
            let p = lyapunov(f);
            for i in 0..2 {
                for k in 0..2 {
                    stationary[(column + i, column + k)] = p[i][k];
                }
            }
        }
        Gusts {
            drive: Drive {
                states: ns,
                splits: parts,
                at: (0..=2 * self.piece * parts).map(|i| inputs_at(0.5 * h / parts as f64 * i as f64, ns, &filters)).collect(),
            },
            end,
            root,
            rate,
            stationary,
            turning: *turning,
        }
    }

    fn start(&self, g: &Gusts) -> ([f64; ALL], Square) {
        let mut z = [0.0; ALL];
        z[..STATES + SPEED].copy_from_slice(&self.run.smoothed.nodes[0]);
        let mut p = [[0.0; ALL]; ALL];
        for i in 0..SPEED + GUSTS {
            (0..SPEED + GUSTS).for_each(|k| p[STATES + i][STATES + k] = g.stationary[(i, k)]);
        }
        (0..STATES + SPEED).for_each(|i| p[i][i] = START_STD[i] * START_STD[i]);
        (z, p)
    }

    /// Covariance of the driving noise over half a piece.
    fn driving(&self, g: &Gusts, kick: &[[f64; 3]; 3]) -> Square {
        let mut root = [[0.0; ALL]; 4];
        for (k, root) in root.iter_mut().enumerate() {
            (0..SPEED + GUSTS).for_each(|i| root[STATES + i] = g.root[(i, k)]);
            if k > 0 {
                (0..3).for_each(|i| root[9 + i] = kick[i][k - 1] * g.rate[k - 1]);
            }
        }
        let half_s = 0.5 * self.run.interval_s * self.piece as f64;
        let mut q: Square =
            std::array::from_fn(|i| std::array::from_fn(|j| half_s * root.iter().map(|r| r[i] * r[j]).sum::<f64>()));
        let [roll, across] = g.turning.map(|t| half_s * t * t);
        (9..12).for_each(|i| q[i][i] += if i == 9 { roll } else { across });
        q
    }

    /// Filters the run, the model linearised about its own predictions; `None` where the flight cannot go on. Measurements are
    /// taken one by one (their noise is independent; Durbin and Koopman 2012, §6.4).
    pub(crate) fn run(&self, random: &Random, c: &FreeColumns, work: &mut Transition) -> Option<FilteredRun> {
        let g = self.gusts(random);
        let (mut z, mut p) = self.start(&g);
        let mut s = DMatrix::<f64>::zeros(c.free, ALL);
        let rows = self.pieces() * self.piece * CHANNELS;
        let mut seen = FilteredRun {
            by_parameter: Vec::with_capacity(rows * c.free),
            pass: Pass::default(),
            h: Vec::with_capacity(rows),
            gain: Vec::with_capacity(rows),
            pieces: Vec::with_capacity(self.pieces()),
        };
        let mut slopes = DVector::zeros(c.free);
        for k in 0..self.pieces() {
            let (x, inputs) = split(&z);
            let unknown = |axis: usize| p[STATES + SPEED + 2 * axis][STATES + SPEED + 2 * axis].max(0.0).sqrt();
            let segment = self.segment(k, &g, c, [0, 1, 2].map(unknown));
            if !segment.differentiate(x, &inputs, work) {
                return None;
            }
            let before = z;
            for (residual, channel, h, h_parameters) in self.measurements(k, &x, &inputs, c, work) {
                let (gain, variance) = update(&mut p, &h, self.noise[channel].powi(2));
                let innovation = residual - h.iter().zip(z.iter().zip(&before)).map(|(h, (z, b))| h * (z - b)).sum::<f64>();
                for (j, slope) in slopes.iter_mut().enumerate() {
                    *slope = -h_parameters[j] - h.iter().enumerate().map(|(i, h)| h * s[(j, i)]).sum::<f64>();
                }
                for i in 0..ALL {
                    z[i] += gain[i] * innovation;
                    s.column_mut(i).axpy(gain[i], &slopes, 1.0);
                }
                seen.pass.innovation.push(innovation);
                seen.pass.variance.push(variance);
                seen.by_parameter.extend(slopes.iter());
                seen.h.push(h);
                seen.gain.push(gain);
            }
            let (phi, mut moved) = self.transition(&g, c.free, work);
            let kick = std::array::from_fn(|i| std::array::from_fn(|axis| work.first_input[9 + i][5 + axis]));
            let (x, inputs) = split(&z);
            if !segment.fly(x, &inputs, work) {
                return None;
            }
            z[..STATES].copy_from_slice(&work.states[self.piece - 1]);
            z[STATES..].copy_from_slice((&g.end * DVector::from_row_slice(&inputs)).as_slice());
            for (i, row) in phi.iter().enumerate() {
                for (k, f) in row.iter().enumerate().filter(|(_, f)| **f != 0.0) {
                    moved.column_mut(i).axpy(*f, &s.column(k), 1.0);
                }
            }
            s = moved;
            predict(&mut p, &phi, &self.driving(&g, &kick));
            if !z.iter().all(|v| v.is_finite()) {
                return None;
            }
            seen.pieces.push(Piece { phi, kick });
        }
        Some(seen)
    }

    /// Transition of the states over a piece, and what it makes of the parameters by itself.
    fn transition(&self, g: &Gusts, free: usize, work: &Transition) -> (Square, DMatrix<f64>) {
        let width = ALL + free;
        let mut phi = [[0.0; ALL]; ALL];
        let mut moved = DMatrix::<f64>::zeros(free, ALL);
        for (i, row) in work.slopes[self.piece - 1].chunks_exact(width).enumerate() {
            phi[i].copy_from_slice(&row[..ALL]);
            (0..free).for_each(|j| moved[(j, i)] = row[ALL + j]);
        }
        for i in 0..SPEED + GUSTS {
            (0..SPEED + GUSTS).for_each(|j| phi[STATES + i][STATES + j] = g.end[(i, j)]);
        }
        (phi, moved)
    }

    /// The same filter with gusts or turning of other size but equal scale, the model's linearisation as it was: a size acts on the
    /// driving noise alone.
    pub(crate) fn again(&self, random: &Random, seen: &FilteredRun) -> Pass {
        let g = self.gusts(random);
        let (_, mut p) = self.start(&g);
        // How far this filter's state is from the other's.
        let mut off = [0.0; ALL];
        let mut pass = Pass::default();
        let rows = self.piece * CHANNELS;
        for (k, piece) in seen.pieces.iter().enumerate() {
            for row in k * rows..(k + 1) * rows {
                let (h, other) = (&seen.h[row], seen.pass.innovation[row]);
                let (gain, variance) = update(&mut p, h, self.noise[row % CHANNELS].powi(2));
                let innovation = other - h.iter().zip(&off).map(|(h, o)| h * o).sum::<f64>();
                for ((off, gain), before) in off.iter_mut().zip(&gain).zip(&seen.gain[row]) {
                    *off += gain * innovation - before * other;
                }
                pass.innovation.push(innovation);
                pass.variance.push(variance);
            }
            off = piece.phi.map(|row| row.iter().zip(&off).map(|(f, o)| f * o).sum());
            predict(&mut p, &piece.phi, &self.driving(&g, &piece.kick));
        }
        pass
    }

    fn segment<'s>(&'s self, k: usize, g: &'s Gusts, c: &'s FreeColumns, spread_m_s: [f64; 3]) -> Segment<'s> {
        let first = k * self.piece;
        Segment {
            craft: &self.run.craft,
            drive: &g.drive,
            parameters: &c.parameters,
            columns: &c.columns,
            free: c.free,
            start_s: first as f64 * self.run.interval_s,
            interval_s: self.run.interval_s,
            density: &self.run.density[first..],
            steps: self.piece,
            spread_m_s,
        }
    }

    /// Residuals of a piece as predicted from its start, their channel, and the slopes of the predicted outputs by states and by
    /// parameters.
    fn measurements(
        &self,
        k: usize,
        x: &[f64; STATES],
        inputs: &[f64],
        c: &FreeColumns,
        work: &Transition,
    ) -> Vec<(f64, usize, [f64; ALL], Vec<f64>)> {
        let mut out = Vec::with_capacity(CHANNELS * self.piece);
        let width = ALL + c.free;
        let mut buffer = vec![0.0; width];
        for i in 0..self.piece {
            let at = if i == 0 { x } else { &work.states[i - 1] };
            let t = i as f64 * self.run.interval_s;
            let vw = inputs[0] + t * (inputs[1] + 0.5 * t * inputs[2]);
            let residual = self.run.residual(k * self.piece + i, at, vw, c);
            let turned = origin_slopes(at, self.run.craft.plant.vehicle.p_origin_cm.to_array());
            for (channel, residual) in residual.into_iter().enumerate() {
                buffer.fill(0.0);
                self.run.output_slopes(i, channel, &turned, work, width, &mut buffer);
                if let Some(column) = c.bias_columns[channel] {
                    buffer[ALL + column] += 1.0;
                }
                out.push((residual, channel, std::array::from_fn(|j| buffer[j]), buffer[ALL..].to_vec()));
            }
        }
        out
    }
}

/// Gain and variance of one measurement; its information taken into the covariance.
fn update(p: &mut Square, h: &[f64; ALL], noise2: f64) -> ([f64; ALL], f64) {
    let mut ph = [0.0; ALL];
    for (h, row) in h.iter().zip(p.iter()).filter(|(h, _)| **h != 0.0) {
        ph.iter_mut().zip(row).for_each(|(ph, p)| *ph += h * p);
    }
    let variance = h.iter().zip(&ph).map(|(h, p)| h * p).sum::<f64>() + noise2;
    let gain = ph.map(|v| v / variance);
    for (row, k) in p.iter_mut().zip(&gain) {
        row.iter_mut().zip(&ph).for_each(|(p, ph)| *p -= k * ph);
    }
    (gain, variance)
}

/// `Φ (P + Q) Φᵀ + Q`.
fn predict(p: &mut Square, phi: &Square, q: &Square) {
    let add = |p: &mut Square| p.iter_mut().flatten().zip(q.iter().flatten()).for_each(|(p, q)| *p += q);
    add(p);
    let half = times(phi, p);
    let mut turned = half;
    for i in 0..ALL {
        (0..ALL).for_each(|j| turned[i][j] = half[j][i]);
    }
    let full = times(phi, &turned);
    for i in 0..ALL {
        (0..ALL).for_each(|j| p[i][j] = 0.5 * (full[i][j] + full[j][i]));
    }
    add(p);
}

fn times(a: &Square, b: &Square) -> Square {
    a.map(|row| {
        let mut out = [0.0; ALL];
        for (f, b) in row.iter().zip(b).filter(|(f, _)| **f != 0.0) {
            out.iter_mut().zip(b).for_each(|(o, b)| *o += f * b);
        }
        out
    })
}

fn split(z: &[f64; ALL]) -> ([f64; STATES], [f64; SPEED + GUSTS]) {
    (std::array::from_fn(|i| z[i]), std::array::from_fn(|i| z[STATES + i]))
}

/// A filter of second order with its output and the output's smooth rate as states, so that its size is in B alone; one whose rate
/// is no state of its own stays as it is.
fn own_output(f: ShapingFilter<2>) -> ShapingFilter<2> {
    let row = |v: [f64; 2]| [v[0] * f.a[0][0] + v[1] * f.a[1][0], v[0] * f.a[0][1] + v[1] * f.a[1][1]];
    let (c, ca) = (f.c, row(f.c));
    let determinant = c[0] * ca[1] - c[1] * ca[0];
    if determinant == 0.0 {
        return f;
    }
    let along = |r: [f64; 2]| r[0] * f.b[0] + r[1] * f.b[1];
    // Cayley and Hamilton: C A² = tr(A) C A − det(A) C.
    let (trace, det) = (f.a[0][0] + f.a[1][1], f.a[0][0] * f.a[1][1] - f.a[0][1] * f.a[1][0]);
    ShapingFilter { a: [[0.0, 1.0], [-det, trace]], b: [along(c), along(ca)], c: [1.0, 0.0] }
}

/// e^{A t} of a 2×2 matrix with a double eigenvalue (both Dryden forms) or any other, by scaling and squaring.
fn exponential(a: [[f64; 2]; 2], t: f64) -> [[f64; 2]; 2] {
    let m = nalgebra::Matrix2::new(a[0][0], a[0][1], a[1][0], a[1][1]) * t;
    let e = m.exp();
    [[e[(0, 0)], e[(0, 1)]], [e[(1, 0)], e[(1, 1)]]]
}

/// Stationary covariance of a shaping filter: `A P + P Aᵀ + B Bᵀ = 0`.
fn lyapunov(f: &ShapingFilter<2>) -> [[f64; 2]; 2] {
    let ([[a, b], [c, d]], [x, y]) = (f.a, f.b);
    #[rustfmt::skip]
    let m = nalgebra::Matrix3::new(
        2.0 * a, 2.0 * b, 0.0,
        c,       a + d,   b,
        0.0,     2.0 * c, 2.0 * d,
    );
    let p = m.lu().solve(&nalgebra::Vector3::new(-x * x, -x * y, -y * y)).unwrap_or_default();
    [[p[0], p[1]], [p[1], p[2]]]
}

#[cfg(test)]
pub(super) mod tests;
