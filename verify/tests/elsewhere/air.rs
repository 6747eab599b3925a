//! Random air by spectral synthesis, and smooth tracks of anything in time.

use crate::chance::Chance;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
use std::f64::consts::TAU;

/// A cubic spline on an even grid; ends by one-sided differences.
#[derive(Clone, Debug)]
pub(crate) struct Track {
    start: f64,
    step: f64,
    values: Vec<f64>,
    curvature: Vec<f64>,
}

impl Track {
    pub(crate) fn new(start: f64, step: f64, values: Vec<f64>) -> Self {
        let n = values.len();
        let y = &values;
        let end = |a: f64, b: f64, c: f64, d: f64| (2.0 * a - 5.0 * b + 4.0 * c - d) / (step * step);
        let mut m = vec![0.0; n];
        m[0] = end(y[0], y[1], y[2], y[3]);
        m[n - 1] = end(y[n - 1], y[n - 2], y[n - 3], y[n - 4]);
        // m[i-1] + 4 m[i] + m[i+1] = 6 Δ²y/h², by elimination.
        let right = |i: usize| 6.0 * (y[i - 1] - 2.0 * y[i] + y[i + 1]) / (step * step);
        let (mut upper, mut lower) = (vec![0.0; n], vec![0.0; n]);
        lower[0] = m[0];
        for i in 1..n - 1 {
            let pivot = 4.0 - upper[i - 1];
            upper[i] = 1.0 / pivot;
            lower[i] = (right(i) - lower[i - 1]) / pivot;
        }
        for i in (1..n - 1).rev() {
            m[i] = lower[i] - upper[i] * m[i + 1];
        }
        Self { start, step, values, curvature: m }
    }
    /// Value at a time; held beyond the ends.
    pub(crate) fn at(&self, t: f64) -> f64 {
        let last = self.values.len() - 1;
        let x = ((t - self.start) / self.step).clamp(0.0, last as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the last sample")]
        let i = (x as usize).min(last - 1);
        let (b, h2) = (x - i as f64, self.step * self.step / 6.0);
        let a = 1.0 - b;
        a * self.values[i]
            + b * self.values[i + 1]
            + h2 * ((a * a * a - a) * self.curvature[i] + (b * b * b - b) * self.curvature[i + 1])
    }
}

/// Colour of gusts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Colour {
    Dryden,
    VonKarman,
    /// Flat over two octaves about V/(2πL), nothing else.
    Band,
    /// Dryden that comes in bursts.
    Intermittent,
}

impl Colour {
    pub(crate) const ALL: [Self; 4] = [Self::Dryden, Self::VonKarman, Self::Band, Self::Intermittent];
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Dryden => "dryden",
            Self::VonKarman => "von-karman",
            Self::Band => "band",
            Self::Intermittent => "intermittent",
        }
    }
    /// One-sided density per Hz of unit variance; MIL-F-8785C's forms.
    fn density(self, hz: f64, time: f64, axial: bool) -> f64 {
        let w = TAU * hz;
        match self {
            Self::Dryden | Self::Intermittent => {
                let x = (time * w).powi(2);
                if axial { 4.0 * time / (1.0 + x) } else { 2.0 * time * (1.0 + 3.0 * x) / (1.0 + x).powi(2) }
            }
            Self::VonKarman => {
                let x = (1.339 * time * w).powi(2);
                if axial {
                    4.0 * time / (1.0 + x).powf(5.0 / 6.0)
                } else {
                    2.0 * time * (1.0 + 8.0 / 3.0 * x) / (1.0 + x).powf(11.0 / 6.0)
                }
            }
            Self::Band => {
                let centre = 1.0 / (TAU * time);
                if hz > 0.5 * centre && hz < 2.0 * centre { 1.0 / (1.5 * centre) } else { 0.0 }
            }
        }
    }
}

/// Gusts of a campaign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gusts {
    pub(crate) colour: Colour,
    pub(crate) axial: f64,
    pub(crate) lateral: f64,
    pub(crate) length: f64,
}

const GRID_HZ: f64 = 400.0;
/// Gusts shorter than this go over the body unfelt, Hz.
const CUT_HZ: f64 = 70.0;

/// Noise of a density by inverse Fourier transform with random amplitudes, from one second before zero.
pub(crate) fn synthesis(duration: f64, c: &mut Chance, density: impl Fn(f64) -> f64) -> Track {
    let mut n = 1024;
    while (n as f64) < (duration + 3.0) * GRID_HZ {
        n *= 2;
    }
    let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(n);
    let mut lines = inverse.make_input_vec();
    let df = GRID_HZ / n as f64;
    let last = lines.len() - 1;
    for (k, line) in lines.iter_mut().enumerate() {
        let hz = k as f64 * df;
        // A line of variance density · df is (a cos + b sin) with a, b of that variance; half of it on each side.
        let size = if k == 0 || k == last || hz > CUT_HZ { 0.0 } else { 0.5 * (density(hz) * df).sqrt() };
        *line = Complex::new(size * c.normal(), size * c.normal());
    }
    let mut values = inverse.make_output_vec();
    inverse.process(&mut lines, &mut values).expect("sizes fit");
    Track::new(-1.0, 1.0 / GRID_HZ, values)
}

impl Gusts {
    /// Three components along tunnel axes.
    pub(crate) fn draw(&self, speed: f64, duration: f64, c: &mut Chance) -> [Track; 3] {
        std::array::from_fn(|axis| {
            let rms = if axis == 0 { self.axial } else { self.lateral };
            let time = self.length / speed;
            let track = synthesis(duration, c, |hz| rms * rms * self.colour.density(hz, time, axis == 0));
            if self.colour == Colour::Intermittent { bursts(track, c) } else { track }
        })
    }
}

/// Multiplies by a slow envelope of mean square one: bursts of a second or two, calm between.
fn bursts(track: Track, c: &mut Chance) -> Track {
    let (p1, p2) = (c.phase(), c.phase());
    let (f1, f2) = (c.uniform(0.15, 0.3), c.uniform(0.35, 0.6));
    let shape = |t: f64| (1.3 * (TAU * f1 * t + p1).sin() + 0.9 * (TAU * f2 * t + p2).sin()).exp();
    let envelope: Vec<f64> = (0..track.values.len()).map(|i| shape(track.start + i as f64 * track.step)).collect();
    let mean = envelope.iter().map(|e| e * e).sum::<f64>() / envelope.len() as f64;
    let values = track.values.iter().zip(&envelope).map(|(v, e)| v * e / mean.sqrt()).collect();
    Track::new(track.start, track.step, values)
}

/// Narrow-band noise about a frequency: response of an oscillator to white noise, unit variance times `rms²`.
pub(crate) fn narrow(rms: f64, centre_hz: f64, bandwidth: f64, duration: f64, c: &mut Chance) -> Track {
    let (w0, b) = (TAU * centre_hz, TAU * centre_hz * bandwidth);
    synthesis(duration, c, |hz| {
        let w = TAU * hz;
        rms * rms * 4.0 * b * w0 * w0 / ((w0 * w0 - w * w).powi(2) + b * b * w * w)
    })
}
