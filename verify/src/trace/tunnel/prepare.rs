//! verify: a tunnel run made ready for any plant. In: a record and the declared plant. Out: data, their smoothed twin and noisy
//! copies, each smoothed in two windows.

use super::super::evidence::Residual;
use super::BAND_HZ;
use super::spectrum::Projector;
use crate::VerifyError;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use windfall_model::{Plant, Record, Sensors};
use windfall_pid::coefficients::{Row, coefficients};
use windfall_pid::smooth::Smoothed;
use windfall_pid::states::{State, states};
use windfall_pid::window::{Kernels, Window};

/// Window for accelerations: flat to 1 % up to the band.
const NARROW: Window = Window { half_width_s: 0.1, degree: 6 };
/// Window for predictions.
const WIDE: Window = Window { half_width_s: 0.2, degree: 6 };
/// Keeps the streams of copies apart from those of a simulator with the same seed: noise that a record has already is no copy.
const COPIES: u64 = 0x636f_7069_6573_0000;
/// Lowest rate of predictions, Hz: five times the band.
const PREDICTION_HZ: f64 = 25.0;

/// One run ready for any plant.
pub(super) struct Prepared {
    pub(super) index: usize,
    pub(super) inputs: Vec<f64>,
    pub(super) duration_s: f64,
    pub(super) bins: usize,
    /// Wide smoothing of each [`Series`], in that order.
    pub(super) wide: Vec<Smoothed>,
    /// What narrow smoothing says beyond wide smoothing under the declared plant, per series.
    pub(super) beyond: Vec<Residual>,
    pub(super) project: Projector,
    /// Dynamic pressure under the declared plant, Pa, at the samples of predictions.
    pub(super) q_declared_pa: Vec<f64>,
    /// States of the data under the declared plant, at the same samples.
    pub(super) states: Vec<State>,
    /// Gain of wide smoothing per bin.
    pub(super) wide_gain: Vec<f64>,
}

impl Prepared {
    /// Wide smoothing of the data.
    pub(super) fn data(&self) -> &Smoothed {
        &self.wide[Series::Data.index()]
    }
    /// Angular frequency of a bin, rad/s.
    pub(super) fn omega(&self, bin: usize) -> f64 {
        std::f64::consts::TAU * bin as f64 / self.duration_s
    }
}

/// What a residual is made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Series {
    Data,
    /// The data smoothed: what copies add noise to.
    Clean,
    /// From 1.
    Copy(usize),
}

impl Series {
    /// All of them with so many copies.
    pub(super) fn all(copies: usize) -> impl Iterator<Item = Self> {
        [Self::Data, Self::Clean].into_iter().chain((1..=copies).map(Self::Copy))
    }
    pub(super) const fn index(self) -> usize {
        match self {
            Self::Data => 0,
            Self::Clean => 1,
            Self::Copy(c) => c + 1,
        }
    }
    pub(super) const fn of_copy(copy: usize) -> Self {
        if copy == 0 { Self::Data } else { Self::Copy(copy) }
    }
}

pub(super) fn prepare(
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
