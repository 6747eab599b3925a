//! verify: evidence from tunnel runs. In: records and the declared plant. Out: residual coefficients per frequency.
//!
//! The residual of the six force and moment balances in coefficient form is projected on sinusoids under a taper that rises
//! quickly at both ends, up to [`BAND_HZ`]. What the motion needs (accelerations) comes from a narrow window, flat over
//! the band; everything that a plant predicts comes from a wide window, so that little sensor noise reaches it. What noise
//! leaves in a bin, and what it does through the predictions, is measured on copies: the data smoothed, and noise added again.

use super::evidence::{BIN, Cov, Evidence, LeadTable, Residual};
use super::fit::Fit;
use crate::VerifyError;
use crate::close::ChannelResidual;
use nalgebra::{Complex, Matrix3, Matrix6, SMatrix, SVector, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use realfft::{RealFftPlanner, RealToComplex};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::sync::{Arc, RwLock};
use windfall_model::frames::{Body, EulerXyz, Rotation, Vec3};
use windfall_model::{AirState, Campaign, Coefficient, Data, Motion, Plant, Record, Sensors, Variable, Wrench};
use windfall_pid::coefficients::{Row, coefficients};
use windfall_pid::smooth::Smoothed;
use windfall_pid::states::{State, states};
use windfall_pid::window::{Kernels, Window};

mod random;

/// Highest frequency used, Hz.
pub const BAND_HZ: f64 = 5.0;
/// Nothing is taken from this much at either end, s: there the windows are off-centre and noisier than inside.
const QUIET_S: f64 = 0.2;
/// Rise of the taper at both ends, s.
const RAMP_S: f64 = 0.4;
/// Noise that the taper lets into low frequencies sits at its ramps; a pulse is looked for this much farther inside, s.
const BLUR_S: f64 = 0.3;
/// Window for accelerations: flat to 1 % up to the band.
const NARROW: Window = Window { half_width_s: 0.1, degree: 6 };
/// Window for predictions.
const WIDE: Window = Window { half_width_s: 0.2, degree: 6 };
/// Copies with which fits are corrected for noise in the regressors; all of them measure noise.
const CORRECTING: usize = 8;
/// Keeps the streams of copies apart from those of a simulator with the same seed: noise that a record has already is no copy.
const COPIES: u64 = 0x636f_7069_6573_0000;
/// Lowest rate of predictions, Hz: five times the band.
const PREDICTION_HZ: f64 = 25.0;

/// Sine and cosine projections of a run at one sample rate.
struct Projector {
    taper: Vec<f64>,
    fft: Arc<dyn RealToComplex<f64>>,
    scale: f64,
    bins: usize,
}

impl Projector {
    fn new(samples: usize, interval_s: f64, bins: usize) -> Self {
        let taper: Vec<f64> = (0..samples)
            .map(|i| {
                // A function of time alone, so that projections at two sample rates agree; sin⁴ keeps their aliases below 1e-8.
                let edge = (i.min(samples - i) as f64 * interval_s - QUIET_S).max(0.0);
                if edge >= RAMP_S { 1.0 } else { (std::f64::consts::FRAC_PI_2 * edge / RAMP_S).sin().powi(4) }
            })
            .collect();
        let power: f64 = taper.iter().map(|w| w * w).sum();
        // |Z|² is then the one-sided density per rad/s.
        let scale = (interval_s / (std::f64::consts::PI * power)).sqrt();
        Self { taper, fft: RealFftPlanner::new().plan_fft_forward(samples), scale, bins }
    }
    /// Projections of six series given by sample; zero frequency is scaled to the variance of a part.
    fn project(&self, series: &[[f64; 6]]) -> Residual {
        let mut out = vec![0.0; self.bins * BIN];
        let mut input = self.fft.make_input_vec();
        let mut output = self.fft.make_output_vec();
        for c in 0..6 {
            for ((x, s), w) in input.iter_mut().zip(series).zip(&self.taper) {
                *x = s[c] * w;
            }
            if self.fft.process(&mut input, &mut output).is_err() {
                return vec![f64::NAN; self.bins * BIN];
            }
            for (k, z) in output.iter().take(self.bins).enumerate() {
                let s = if k == 0 { self.scale * std::f64::consts::FRAC_1_SQRT_2 } else { self.scale };
                out[k * BIN + c] = z.re * s;
                out[k * BIN + 6 + c] = z.im * s;
            }
        }
        out
    }
}

/// One run ready for any plant.
struct Prepared {
    index: usize,
    inputs: Vec<f64>,
    duration_s: f64,
    bins: usize,
    /// Wide smoothing of each [`Series`], in that order.
    wide: Vec<Smoothed>,
    /// What narrow smoothing says beyond wide smoothing under the declared plant, per series.
    beyond: Vec<Residual>,
    project: Projector,
    /// Dynamic pressure under the declared plant, Pa, at the samples of predictions.
    q_declared_pa: Vec<f64>,
    /// States of the data under the declared plant, at the same samples.
    states: Vec<State>,
    /// Gain of wide smoothing per bin.
    wide_gain: Vec<f64>,
}

/// What a residual is made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Series {
    Data,
    /// The data smoothed: what copies add noise to.
    Clean,
    /// From 1.
    Copy(usize),
}

impl Series {
    /// All of them with so many copies.
    fn all(copies: usize) -> impl Iterator<Item = Self> {
        [Self::Data, Self::Clean].into_iter().chain((1..=copies).map(Self::Copy))
    }
    const fn index(self) -> usize {
        match self {
            Self::Data => 0,
            Self::Clean => 1,
            Self::Copy(c) => c + 1,
        }
    }
    const fn of_copy(copy: usize) -> Self {
        if copy == 0 { Self::Data } else { Self::Copy(copy) }
    }
}

/// Cross-spectrum of the six channels at one frequency.
type Spectrum = SMatrix<Complex<f64>, 6, 6>;

/// The latest plant without aerodynamics and contacts (both are added to its rows), and the rows it gives per run and series.
type Focus = (Plant, Vec<Vec<Vec<Row>>>);

/// Evidence of tunnel runs.
pub struct TunnelEvidence {
    runs: Vec<Prepared>,
    noise: Vec<Cov>,
    generic: Vec<Vec<Cov>>,
    copies: usize,
    declared: Plant,
    focus: RwLock<Option<Focus>>,
}

impl TunnelEvidence {
    /// Prepares the runs of a campaign whose indices are given, with `copies` noisy copies drawn from `seed`.
    ///
    /// # Errors
    /// Runs that are too short or whose states cannot be made under the declared plant.
    pub fn new(campaign: &Campaign, indices: &[usize], declared: &Plant, copies: usize, seed: u64) -> Result<Self, VerifyError> {
        let runs = indices
            .par_iter()
            .map(|&i| match &campaign.runs[i].data {
                Data::Tunnel(record) => prepare(record, &campaign.runs[i].inputs, i, declared, copies, seed),
                Data::Point(_) => Err(VerifyError::NotTunnel { run: campaign.runs[i].name.clone() }),
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut evidence =
            Self { runs, noise: Vec::new(), generic: Vec::new(), copies, declared: declared.clone(), focus: RwLock::new(None) };
        evidence.measure_noise(declared);
        Ok(evidence)
    }

    /// Measures what sensor noise leaves in every bin under a plant: mean over copies and neighbouring frequencies.
    pub fn measure_noise(&mut self, plant: &Plant) {
        self.focus(plant);
        let clean = self.clean(plant);
        let all: Vec<Residual> = (1..=self.copies).into_par_iter().map(|c| self.residual(plant, c)).collect();
        let mut raw = vec![Cov::zeros(); self.bins()];
        for copy in &all {
            for ((m, a), b) in raw.iter_mut().zip(copy.chunks_exact(BIN)).zip(clean.chunks_exact(BIN)) {
                let part = |from: usize| SVector::<f64, 6>::from_fn(|c, _| a[from + c] - b[from + c]);
                let z = part(0).map(|x| Complex::new(x, 0.0)) + part(6).map(|x| Complex::new(0.0, x));
                *m += real_form(&(z * z.adjoint())) / self.copies as f64;
            }
        }
        self.noise.clear();
        let mut start = 0;
        for run in &self.runs {
            // Zero frequency has a real part alone, scaled to the variance of one.
            raw[start] *= 2.0;
            self.noise.extend(averaged(&raw[start..start + run.bins]));
            start += run.bins;
        }
        let bins = self.noise.len();
        self.generic = (0..6)
            .map(|c| {
                let level = self.noise.iter().map(|m| m[(c, c)]).sum::<f64>() / bins as f64;
                let mut unit = Cov::zeros();
                unit[(c, c)] = level;
                unit[(6 + c, 6 + c)] = level;
                vec![unit; bins]
            })
            .collect();
    }

    /// Noise stays as measured; the data are now taken as free of it, so that fits are not corrected for it.
    pub fn forget_copies(&mut self) {
        self.copies = 0;
        if let Ok(mut f) = self.focus.write() {
            *f = None;
        }
    }

    fn rows(&self, plant: &Plant, run: usize, series: Series) -> Option<Vec<Row>> {
        let p = &self.runs[run];
        let own = without_aero(plant).for_run(p.index, &p.inputs);
        Some(coefficients(&states(&p.wide[series.index()], &own).ok()?, &own))
    }

    fn residual_series(&self, plant: &Plant, series: Series) -> Residual {
        (0..self.runs.len()).flat_map(|r| self.residual_run(plant, r, series)).collect()
    }

    fn residual_run(&self, plant: &Plant, run: usize, series: Series) -> Residual {
        let p = &self.runs[run];
        let focus = self.focus.read().ok();
        let bare = without_aero(plant);
        let kept = focus
            .as_deref()
            .and_then(|f| f.as_ref())
            .filter(|(known, _)| *known == bare)
            .and_then(|(_, rows)| rows[run].get(series.index()));
        let fresh;
        let rows = match kept {
            Some(rows) => rows,
            None => match self.rows(plant, run, series) {
                Some(rows) => {
                    fresh = rows;
                    &fresh
                }
                None => return vec![f64::NAN; p.bins * BIN],
            },
        };
        let unit = Unit::new(plant, &self.declared);
        let contacts: Vec<_> = plant.contacts.iter().filter(|c| c.run == p.index).collect();
        let start_s = rows.first().map_or(0.0, |r| r.t_s);
        let missing: Vec<[f64; 6]> = rows
            .iter()
            .zip(&p.q_declared_pa)
            .map(|(row, q)| {
                let mut c = plant.aero.coefficients(&row.flow);
                for contact in &contacts {
                    let load = load_coefficients(&contact.wrench(row.t_s - start_s), row.q_pa, plant);
                    c.iter_mut().zip(load.iter()).for_each(|(c, l)| *c += l);
                }
                unit.convert(std::array::from_fn(|i| row.exp_origin[i] - c[i]), row.q_pa / q)
            })
            .collect();
        let mut z = p.project.project(&missing);
        for (a, b) in z.iter_mut().zip(&p.beyond[series.index()]) {
            *a += b;
        }
        z
    }

    /// Residual series of the data in time, per run: coefficients from wide smoothing, at 25 Hz or more.
    #[must_use]
    pub fn series(&self, plant: &Plant) -> Vec<Vec<(Row, [f64; 6])>> {
        (0..self.runs.len())
            .map(|r| {
                let rows = self.rows(plant, r, Series::Data).unwrap_or_default();
                rows.into_iter()
                    .map(|row| {
                        let c = plant.aero.coefficients(&row.flow);
                        (row, std::array::from_fn(|i| row.exp_origin[i] - c[i]))
                    })
                    .collect()
            })
            .collect()
    }

    /// Frequency of every bin, Hz, and its run.
    #[must_use]
    pub fn frequencies(&self) -> Vec<(usize, f64)> {
        self.runs.iter().enumerate().flat_map(|(r, p)| (0..p.bins).map(move |k| (r, k as f64 / p.duration_s))).collect()
    }
}

impl Prepared {
    /// Wide smoothing of the data.
    fn data(&self) -> &Smoothed {
        &self.wide[Series::Data.index()]
    }
    /// Angular frequency of a bin, rad/s.
    fn omega(&self, bin: usize) -> f64 {
        std::f64::consts::TAU * bin as f64 / self.duration_s
    }
}

/// Map from a small change of measured pose (position along and rotation about body axes) to the residual, averaged along a
/// run: by the pose itself, its rate and its second derivative.
struct LoopMap {
    orders: [Matrix6<f64>; 3],
}

/// States of a run that the map is averaged over.
const LOOP_STATES: usize = 40;

impl LoopMap {
    fn new(run: &Prepared, plant: &Plant, declared: &Plant) -> Option<Self> {
        let own = plant.for_run(run.index, &run.inputs);
        let unit = Unit::new(&own, declared);
        let mut orders = [Matrix6::<f64>::zeros(); 3];
        let stride = (run.states.len() / LOOP_STATES).max(1);
        let some: Vec<(&State, &f64)> = run.states.iter().zip(&run.q_declared_pa).step_by(stride).collect();
        let scale = (1.0 + declared.sensors.wind_scale) / (1.0 + own.sensors.wind_scale);
        for (s, q) in &some {
            let air = AirState { vw_m_s: s.vw * scale, vw_rate_m_s2: s.vw_rate * scale, ..still(s) };
            let balance = |order: usize, column: usize, h: f64| {
                let e = balance(&moved_by(&motion(s), own.vehicle.p_origin_cm, order, column, h), &air, &own, **q);
                SVector::<f64, 6>::from(unit.convert(e, 1.0))
            };
            for (order, m) in orders.iter_mut().enumerate() {
                for column in 0..6 {
                    let h = 1e-3;
                    let d = (balance(order, column, h) - balance(order, column, -h)) / (2.0 * h * some.len() as f64);
                    m.column_mut(column).zip_apply(&d, |a, b| *a += b);
                }
            }
        }
        orders.iter().all(|m| m.iter().all(|x| x.is_finite())).then_some(Self { orders })
    }
    fn at(&self, omega: f64) -> Spectrum {
        let real = self.orders[0] - self.orders[2] * (omega * omega);
        real.zip_map(&(self.orders[1] * omega), Complex::new)
    }
}

/// A motion whose origin's pose (order 0), its rate (1) or second derivative (2) is changed by `h` along (columns 0-2) or about
/// (3-5) a body axis.
fn moved_by(m: &Motion, r_cm: Vec3<Body>, order: usize, column: usize, h: f64) -> Motion {
    let mut axis = [0.0; 3];
    axis[column % 3] = h;
    let (axis, r) = (Vec3::<Body>::from_array(axis), m.r_tunnel_body);
    // A rotation moves the c.m. about the origin.
    let shift = if column < 3 { r * axis } else { r * axis.cross(r_cm) };
    let mut n = *m;
    match order {
        0 => {
            n.p_tunnel_cm += shift;
            if column >= 3 {
                let q = axis.to_array().map(|x| 0.5 * x);
                n.r_tunnel_body = r * Rotation::from_quaternion([1.0, q[0], q[1], q[2]]);
            }
        }
        1 => {
            n.v_tunnel_cm += shift;
            if column >= 3 {
                n.w_tunnel_body += axis;
            }
        }
        _ => {
            n.a_tunnel_cm += shift;
            if column >= 3 {
                n.w_tunnel_body_rate += axis;
            }
        }
    }
    n
}

/// Load that a motion needs beyond what a plant gives, as coefficients at the declared dynamic pressure.
fn balance(m: &Motion, air: &AirState, plant: &Plant, q_pa: f64) -> [f64; 6] {
    let v = &plant.vehicle;
    let i = v.inertia.matrix();
    let (w, wd) = (m.w_tunnel_body.xyz, m.w_tunnel_body_rate.xyz);
    let g = Vec3::new(plant.environment.gravity_m_s2, 0.0, 0.0);
    let given = plant.wrench(m, air);
    let f = m.r_tunnel_body.inverse() * (m.a_tunnel_cm - g) * v.mass_kg - given.f;
    let moment = Vec3::from(i * wd + w.cross(&(i * w))) - given.m;
    load_coefficients(&Wrench { f, m: moment }, q_pa, plant).into()
}

/// Complex covariance of a bin from its real form.
fn circular(m: &Cov) -> Spectrum {
    SMatrix::from_fn(|i, k| Complex::new(m[(i, k)] + m[(6 + i, 6 + k)], m[(6 + i, k)] - m[(i, 6 + k)]))
}

/// Residuals of every plant in one unit: that of the acceleration they miss, as a load on the declared vehicle at the declared
/// dynamic pressure. Without it a plant could shrink its residual by claiming less inertia or more pressure.
struct Unit {
    force: Vector3<f64>,
    moment: Matrix3<f64>,
}

impl Unit {
    fn new(plant: &Plant, declared: &Plant) -> Self {
        let mass = |p: &Plant| {
            let (m, a) = (p.vehicle.mass_kg, &p.vehicle.apparent);
            Vector3::new(m + a.axial_kg, m + a.radial_kg, m + a.radial_kg)
        };
        let inertia = |p: &Plant| {
            let i = p.vehicle.apparent.transverse_kg_m2;
            p.vehicle.inertia.matrix() + Matrix3::from_diagonal(&Vector3::new(0.0, i, i))
        };
        let back = inertia(plant).try_inverse().unwrap_or_else(Matrix3::zeros);
        Self { force: mass(declared).component_div(&mass(plant)), moment: inertia(declared) * back }
    }
    fn convert(&self, e: [f64; 6], q_ratio: f64) -> [f64; 6] {
        let f = self.force.component_mul(&Vector3::new(e[0], e[1], e[2])) * q_ratio;
        let m = self.moment * Vector3::new(e[3], e[4], e[5]) * q_ratio;
        [f.x, f.y, f.z, m.x, m.y, m.z]
    }
}

/// The part of a plant that its rows depend on.
fn without_aero(plant: &Plant) -> Plant {
    let mut bare = plant.clone();
    bare.aero.values.clear();
    bare.aero.extra.clear();
    bare.contacts.clear();
    bare.turbulence = windfall_model::Turbulence::default();
    bare.shedding = windfall_model::WakeShedding::default();
    bare
}

impl Evidence for TunnelEvidence {
    fn bins(&self) -> usize {
        self.runs.iter().map(|r| r.bins).sum()
    }
    fn samples(&self) -> usize {
        self.bins() * BIN
    }
    fn copies(&self) -> usize {
        self.copies.min(CORRECTING)
    }
    fn noisy(&self) -> usize {
        self.copies
    }
    fn residual(&self, plant: &Plant, copy: usize) -> Residual {
        self.residual_series(plant, Series::of_copy(copy))
    }
    fn clean(&self, plant: &Plant) -> Residual {
        self.residual_series(plant, Series::Clean)
    }
    fn residual_of(&self, plant: &Plant, run: usize) -> Residual {
        let mut all = Vec::with_capacity(self.samples());
        for (r, p) in self.runs.iter().enumerate() {
            if r == run {
                all.extend(self.residual_run(plant, r, Series::Data));
            } else {
                all.extend(std::iter::repeat_n(0.0, p.bins * BIN));
            }
        }
        all
    }
    fn noise(&self) -> &[Cov] {
        &self.noise
    }
    fn generic(&self) -> &[Vec<Cov>] {
        &self.generic
    }
    fn random(&self, plant: &Plant) -> Vec<Cov> {
        let mut out = Vec::with_capacity(self.bins());
        for run in &self.runs {
            out.extend(random::spectra(run, plant));
        }
        out
    }
    fn random_draws(&self, plant: &Plant, count: usize) -> Vec<Residual> {
        let per_run: Vec<Vec<Residual>> = self.runs.iter().map(|r| random::draws(r, plant, count)).collect();
        (0..count).map(|c| per_run.iter().flat_map(|d| d[c].iter().copied()).collect()).collect()
    }
    fn closed_loop(&self, sigma: &[Cov], plant: &Plant, moved: &[(Plant, f64)]) -> Vec<f64> {
        let starts = self.runs.iter().scan(0, |at, r| {
            let start = *at;
            *at += r.bins;
            Some(start)
        });
        let runs: Vec<(&Prepared, usize)> = self.runs.iter().zip(starts).collect();
        let share = |bin: usize| circular(&(sigma[bin] - self.noise[bin]));
        let idle = (0..sigma.len()).all(|b| {
            (sigma[b] - self.noise[b]).diagonal().iter().zip(self.noise[b].diagonal().iter()).all(|(d, n)| *d < 1e-3 * n)
        });
        if idle {
            return vec![0.0; moved.len()];
        }
        let prepared: Vec<Option<(LoopMap, Vec<Spectrum>)>> = runs
            .par_iter()
            .map(|(run, start)| {
                let map = LoopMap::new(run, plant, &self.declared)?;
                let back = (0..run.bins)
                    .map(|k| {
                        let bin = start + k;
                        let p = share(bin) * circular(&sigma[bin]).try_inverse()?;
                        let l = map.at(run.omega(k)).try_inverse()?;
                        Some(l * p * Complex::new(2.0 * run.wide_gain[k], 0.0))
                    })
                    .map(|m| m.unwrap_or_else(SMatrix::zeros))
                    .collect();
                Some((map, back))
            })
            .collect();
        moved
            .par_iter()
            .map(|(to, step)| {
                let mut sum = 0.0;
                for ((run, _), prepared) in runs.iter().zip(&prepared) {
                    let (Some((map, back)), Some(other)) = (prepared, LoopMap::new(run, to, &self.declared)) else { continue };
                    for (k, b) in back.iter().enumerate().skip(1) {
                        sum += ((other.at(run.omega(k)) - map.at(run.omega(k))) * b).trace().re;
                    }
                }
                sum / step
            })
            .collect()
    }
    fn focus(&self, plant: &Plant) {
        let bare = without_aero(plant);
        if self.focus.read().is_ok_and(|f| f.as_ref().is_some_and(|(known, _)| *known == bare)) {
            return;
        }
        let rows: Option<Vec<Vec<Vec<Row>>>> = (0..self.runs.len())
            .map(|r| {
                let all: Vec<Series> = Series::all(self.copies()).collect();
                all.into_par_iter().map(|s| self.rows(plant, r, s)).collect::<Option<Vec<_>>>()
            })
            .collect();
        if let (Ok(mut f), Some(rows)) = (self.focus.write(), rows) {
            *f = Some((bare, rows));
        }
    }
    fn durations_s(&self) -> Vec<f64> {
        self.runs.iter().map(|r| r.duration_s).collect()
    }
    fn run_indices(&self) -> Vec<usize> {
        self.runs.iter().map(|r| r.index).collect()
    }
    fn margin_s(&self) -> f64 {
        QUIET_S + RAMP_S + BLUR_S
    }
    fn settle(&mut self, plant: &Plant) {
        self.measure_noise(plant);
    }
    fn channel_residuals(&self, z: &[f64], expected: &[Cov], fitted: usize) -> Vec<ChannelResidual> {
        Coefficient::ALL
            .iter()
            .enumerate()
            .map(|(c, name)| {
                let parts = || {
                    z.chunks_exact(BIN).zip(expected).flat_map(move |(z, m)| [(z[c], m[(c, c)]), (z[6 + c], m[(6 + c, 6 + c)])])
                };
                let numbers = parts().count() as f64;
                // Density per rad/s times the width of a bin, summed: the variance in the band.
                let width = std::f64::consts::TAU * BAND_HZ / (0.5 * numbers);
                let (sum, expected, ratio) = parts().fold((0.0, 0.0, 0.0), |(a, b, r), (z, v)| (a + z * z, b + v, r + z * z / v));
                let degrees = (numbers - fitted as f64 / 6.0).max(1.0);
                // Noise is known from the copies, each averaged over neighbours that repeat about every seventh bin.
                let known = numbers * self.copies as f64;
                let p_value = FisherSnedecor::new(degrees, known).map_or(1.0, |f| f.sf(ratio / degrees));
                ChannelResidual {
                    channel: name.name().to_owned(),
                    rms: (sum * width).sqrt(),
                    expected_rms: (expected * width).sqrt(),
                    p_value,
                }
            })
            .collect()
    }
    fn lead_table(&self, plant: &Plant) -> LeadTable {
        let mut table = LeadTable { residuals: vec![Vec::new(); 6], variables: Vec::new() };
        let names = ["time in the run (s)", "X (m)", "Y (m)", "Z (m)", "distance from the axis (m)"];
        table.variables = Variable::ALL
            .iter()
            .map(|v| v.name().to_owned())
            .chain(names.iter().map(|n| (*n).to_owned()))
            .map(|n| (n, Vec::new()))
            .collect();
        for (run, series) in self.runs.iter().zip(self.series(plant)) {
            for (state, (row, e)) in run.states.iter().zip(series) {
                table.residuals.iter_mut().zip(e).for_each(|(r, e)| r.push(e));
                let [x, y, z] = state.p_tunnel_origin;
                let own = [row.t_s, x, y, z, y.hypot(z)];
                let values = row.flow.values.iter().chain(&own);
                table.variables.iter_mut().zip(values).for_each(|((_, s), v)| s.push(*v));
            }
        }
        table
    }
    fn peak_hz(&self, fit: &Fit, channel: usize) -> Option<f64> {
        let ratios = fit.residual.chunks_exact(BIN).zip(&self.noise);
        ratios
            .zip(self.frequencies())
            .map(|((z, m), (_, f))| ((z[channel].powi(2) + z[6 + channel].powi(2)) / m[(channel, channel)], f))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, f)| f)
    }
}

fn prepare(
    record: &Record,
    inputs: &[f64],
    index: usize,
    declared: &Plant,
    copies: usize,
    seed: u64,
) -> Result<Prepared, VerifyError> {
    let dt = record.interval_s();
    let (narrow, wide) = (Kernels::new(NARROW, dt), Kernels::new(WIDE, dt));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive ratio")]
    let stride = ((1.0 / dt / PREDICTION_HZ) as usize).max(1);
    // Whole strides only: both projections then cover the same time.
    let n = record.len() / stride * stride;
    if n < 2 * wide.len() {
        return Err(VerifyError::TooShort { run: index, samples: n, needed: 2 * wide.len() });
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
    let bins = (BAND_HZ * n as f64 * dt) as usize + 1;
    let plant = declared.for_run(index, inputs);
    let fine = Projector::new(n, dt, bins);
    let project = Projector::new(n / stride, dt * stride as f64, bins);
    let mut smoothed = Vec::with_capacity(copies + 2);
    let mut beyond = Vec::with_capacity(copies + 2);
    let (mut q_declared_pa, mut kept) = (Vec::new(), Vec::new());
    let wide_gain = (0..bins).map(|k| wide.value_gain(std::f64::consts::TAU * k as f64 / (n as f64 * dt), dt)).collect();
    let data = record.channels().map(|c| c[..n].to_vec());
    let clean = smoothed_channels(&data, &wide);
    for series in Series::all(copies) {
        let channels = match series {
            Series::Data => data.clone(),
            Series::Clean => clean.clone(),
            Series::Copy(copy) => noisy(&clean, &declared.sensors, seed, index, copy),
        };
        let a = decimated(record, &narrow, &channels, 1);
        let b = decimated(record, &wide, &channels, stride);
        let rows = |s: &Smoothed| -> Result<Vec<Row>, VerifyError> { Ok(coefficients(&states(s, &plant)?, &plant)) };
        let exp = |rows: &[Row]| rows.iter().map(|r| r.exp_origin).collect::<Vec<_>>();
        let mut z = fine.project(&exp(&rows(&a)?));
        let coarse = rows(&b)?;
        if series == Series::Data {
            q_declared_pa = coarse.iter().map(|r| r.q_pa).collect();
            kept = states(&b, &plant)?;
        }
        for (x, y) in z.iter_mut().zip(project.project(&exp(&coarse))) {
            *x -= y;
        }
        beyond.push(z);
        smoothed.push(b);
    }
    Ok(Prepared {
        index,
        inputs: inputs.to_vec(),
        duration_s: n as f64 * dt,
        bins,
        wide: smoothed,
        beyond,
        project,
        q_declared_pa,
        states: kept,
        wide_gain,
    })
}

/// Every channel smoothed at every sample.
fn smoothed_channels(channels: &[Vec<f64>; 7], kernels: &Kernels) -> [Vec<f64>; 7] {
    let series: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
    let mut signals = kernels.smooth(&series, 1).into_iter();
    std::array::from_fn(|_| signals.next().map(|s| s.value).unwrap_or_default())
}

/// The seven channels with sensor noise added.
fn noisy(channels: &[Vec<f64>; 7], sensors: &Sensors, seed: u64, run: usize, copy: usize) -> [Vec<f64>; 7] {
    let (p, r, a, w) = (sensors.position_std_m, sensors.roll_std_rad, sensors.pitch_yaw_std_rad, sensors.wind_std_m_s);
    let std = [p, p, p, r, a, a, w];
    std::array::from_fn(|c| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ COPIES);
        rng.set_stream((run as u64) << 32 | (copy as u64) << 8 | c as u64);
        channels[c].iter().map(|x| x + std[c] * Distribution::<f64>::sample(&StandardNormal, &mut rng)).collect()
    })
}

fn decimated(record: &Record, kernels: &Kernels, channels: &[Vec<f64>; 7], stride: usize) -> Smoothed {
    let series: Vec<&[f64]> = channels.iter().map(Vec::as_slice).collect();
    let mut signals = kernels.smooth(&series, stride).into_iter();
    let every = |s: &[f64]| s.iter().step_by(stride).copied().collect::<Vec<_>>();
    let samples = channels[0].len();
    let t_s = every(&record.t_s[..samples]);
    let kept = t_s.len();
    Smoothed {
        t_s,
        interval_s: record.interval_s() * stride as f64,
        channels: std::array::from_fn(|_| signals.next().unwrap_or_default()),
        ps_pa: every(&record.ps_pa[..samples]),
        ts_k: every(&record.ts_k[..samples]),
        noise_std: [0.0; 7],
        weight: vec![1.0; kept],
        bandwidth_hz: [0.0; 7],
    }
}

/// Mean over neighbouring bins, each brought to this one's frequency by the local power law of its channels, so that a steep
/// spectrum is neither flattened (a plain mean over a sixth to each side of ω⁴ is 5 % too high) nor cut at the end of the band.
/// The width grows with frequency (a sixth) and is at least three bins to each side, save at the lowest, where it is symmetric.
fn averaged(raw: &[Cov]) -> Vec<Cov> {
    let n = raw.len();
    let x: Vec<f64> = (0..n).map(|k| ((k + 1) as f64).ln()).collect();
    let within = |k: usize, w: usize| k.saturating_sub(w)..(k + w + 1).min(n);
    (0..n)
        .map(|k| {
            let w = (k / 6).max(3).min(k.max(1));
            let exponents: [f64; BIN] = std::array::from_fn(|c| {
                let wide = within(k, 2 * w);
                slope(&x[wide.clone()], &raw[wide].iter().map(|m| m[(c, c)].max(f64::MIN_POSITIVE).ln()).collect::<Vec<_>>())
            });
            let mut sum = Cov::zeros();
            for j in within(k, w) {
                let to: [f64; BIN] = std::array::from_fn(|c| (0.5 * exponents[c] * (x[k] - x[j])).exp());
                sum += raw[j].map_with_location(|r, c, m| m * to[r] * to[c]);
            }
            let m = sum / within(k, w).len() as f64;
            m + Cov::from_diagonal(&m.diagonal()) * RIDGE
        })
        .collect()
}

/// Part of itself added to the diagonal of a measured covariance, so that it can be factored.
const RIDGE: f64 = 1e-2;

/// Slope of the straight line through points.
fn slope(x: &[f64], y: &[f64]) -> f64 {
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(x), mean(y));
    let (xy, xx) = x.iter().zip(y).fold((0.0, 0.0), |(a, b), (x, y)| (a + (x - mx) * (y - my), b + (x - mx).powi(2)));
    if xx > 0.0 { xy / xx } else { 0.0 }
}

/// Covariance of real and imaginary parts of a circular vector with covariance `E z zᴴ = s`.
fn real_form(s: &Spectrum) -> Cov {
    let mut m = Cov::zeros();
    for i in 0..6 {
        for k in 0..6 {
            let (re, im) = (0.5 * s[(i, k)].re, 0.5 * s[(i, k)].im);
            m[(i, k)] = re;
            m[(6 + i, 6 + k)] = re;
            m[(6 + i, k)] = im;
            m[(i, 6 + k)] = -im;
        }
    }
    m
}

/// A state as the motion that forces are made of.
fn motion(s: &State) -> Motion {
    let [rx_rad, ry_rad, rz_rad] = s.euler_rad;
    let r = EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body();
    let (u, w) = (Vec3::from_array(s.uvw), Vec3::from_array(s.pqr));
    Motion {
        t_s: s.t_s,
        p_tunnel_cm: Vec3::from_array(s.p_tunnel_cm),
        v_tunnel_cm: r * u,
        r_tunnel_body: r,
        w_tunnel_body: w,
        a_tunnel_cm: r * (Vec3::from_array(s.uvw_rate) + w.cross(u)),
        w_tunnel_body_rate: Vec3::from_array(s.pqr_rate),
    }
}

/// The air of a state, without gusts.
fn still(s: &State) -> AirState {
    AirState { vw_m_s: s.vw, vw_rate_m_s2: s.vw_rate, density_kg_m3: s.density, ..AirState::default() }
}

/// A force and moment at the c.m. as six coefficients at the origin.
fn load_coefficients(w: &Wrench, q_pa: f64, plant: &Plant) -> SVector<f64, 6> {
    let qs = q_pa * plant.vehicle.area_m2();
    let m = w.m - w.f.cross(plant.vehicle.p_origin_cm);
    let (f, qsd) = (w.f, qs * plant.vehicle.diameter_m);
    SVector::<f64, 6>::new(-f.x() / qs, f.y() / qs, -f.z() / qs, m.x() / qsd, m.y() / qsd, m.z() / qsd)
}
