//! pid: the thesis' global Fourier smoothing (§3.1-3.2). In: raw signals. Out: sine series, filtered, with exact derivatives.

use super::{Fit, Signal};
use crate::PidError;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;
use std::f64::consts::PI;
use windfall_model::{CHANNELS, PerChannel};

/// Smooths seven channels with given cutoffs (Hz), or with those that the spectra show.
pub(super) fn smooth(raw: PerChannel<&[f64]>, dt: f64, cutoffs_hz: Option<PerChannel<f64>>) -> Result<Fit, PidError> {
    if let Some(value) = cutoffs_hz.iter().flatten().copied().find(|f| f.is_nan() || *f <= 0.0) {
        return Err(PidError::Setting { setting: "cutoff frequency, Hz", value, allowed: "above 0, or infinite for no filter" });
    }
    let mut planner = RealFftPlanner::new();
    let mut bandwidth_hz = [0.0; CHANNELS];
    let mut noise_std = [0.0; CHANNELS];
    let mut c = 0;
    let channels = raw.map(|x| {
        let trend = Trend::of(x);
        let b = sine_coefficients(&trend.removed(x), &mut planner);
        let cutoff = cutoffs_hz.map_or_else(|| cutoff_hz(&b, dt), |f| f[c]);
        let signal = reconstruct(&b, &trend, cutoff, dt, &mut planner);
        bandwidth_hz[c] = cutoff;
        noise_std[c] = noise(x, &signal.value);
        c += 1;
        signal
    });
    Ok(Fit { channels, noise_std, weight: vec![1.0; raw[0].len()], bandwidth_hz })
}

/// The straight line through the first and the last sample (eq. 3.2).
struct Trend {
    first: f64,
    per_sample: f64,
}

impl Trend {
    fn of(x: &[f64]) -> Self {
        Self { first: x[0], per_sample: (x[x.len() - 1] - x[0]) / (x.len() - 1) as f64 }
    }
    fn at(&self, i: usize) -> f64 {
        self.first + i as f64 * self.per_sample
    }
    fn removed(&self, x: &[f64]) -> Vec<f64> {
        x.iter().enumerate().map(|(i, v)| v - self.at(i)).collect()
    }
}

/// Amplitudes b_k, k = 0..N−1, of the odd reflection's sine series (eqs 3.3-3.6).
fn sine_coefficients(xi: &[f64], planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
    let last = xi.len() - 1;
    let fft = planner.plan_fft_forward(2 * last);
    let mut odd = fft.make_input_vec();
    for i in 1..last {
        odd[i] = xi[i];
        odd[2 * last - i] = -xi[i];
    }
    let mut out = fft.make_output_vec();
    fft.process(&mut odd, &mut out).expect("buffers are made by the plan");
    out.iter().map(|z| -z.im / last as f64).collect()
}

/// Wiener filter (eqs 3.11-3.12).
fn wiener(f_hz: f64, cutoff_hz: f64) -> f64 {
    if !cutoff_hz.is_finite() {
        return 1.0;
    }
    let eta = (cutoff_hz / f_hz).powi(3);
    if eta > 0.01 { 1.0 - 1.0 / (eta * eta + 1.0) } else { 0.0 }
}

/// Smoothed signal and derivatives (eqs 3.13-3.14, 3.18 with the trend divided by Δt as well, 3.19).
fn reconstruct(b: &[f64], trend: &Trend, cutoff_hz: f64, dt: f64, planner: &mut RealFftPlanner<f64>) -> Signal {
    let last = b.len() - 1;
    let omega = |k: usize| k as f64 * PI / (last as f64 * dt);
    let kept: Vec<f64> =
        b.iter().enumerate().map(|(k, b)| if k == 0 { 0.0 } else { b * wiener(omega(k) / (2.0 * PI), cutoff_hz) }).collect();
    let value = synthesise(&kept, |_, a| Complex64::new(0.0, -0.5 * a), planner);
    let rate = synthesise(&kept, |k, a| Complex64::new(0.5 * omega(k) * a, 0.0), planner);
    let second = synthesise(&kept, |k, a| Complex64::new(0.0, 0.5 * omega(k) * omega(k) * a), planner);
    let slope = trend.per_sample / dt;
    Signal {
        value: value.iter().enumerate().map(|(i, v)| v + trend.at(i)).collect(),
        rate: rate.iter().map(|v| v + slope).collect(),
        second,
    }
}

/// Sum over k of 2 Re(coefficient · exp(iω_k t)) at the N samples. The term at the Nyquist frequency, which is zero in eq. 3.5, is left out.
fn synthesise(kept: &[f64], term: impl Fn(usize, f64) -> Complex64, planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
    let last = kept.len() - 1;
    let fft = planner.plan_fft_inverse(2 * last);
    let mut spectrum = fft.make_input_vec();
    for k in 1..last {
        spectrum[k] = term(k, kept[k]);
    }
    let mut out = fft.make_output_vec();
    fft.process(&mut spectrum, &mut out).expect("ends of the spectrum are real zeros");
    out.truncate(kept.len());
    out
}

/// Standard deviation of raw minus smoothed (eqs 3.15-3.17, squared as it must be).
fn noise(raw: &[f64], smoothed: &[f64]) -> f64 {
    let nu: Vec<f64> = raw.iter().zip(smoothed).map(|(a, b)| a - b).collect();
    let n = nu.len() as f64;
    let mean = nu.iter().sum::<f64>() / n;
    (nu.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt()
}

/// Cutoff where the signal's share of the spectrum falls to the noise's: rms of b_k over a sliding band sinks below √2 times
/// the floor, which is the rms of the upper half of the spectrum. There the optimal filter is one half, as eq. 3.11 has it.
fn cutoff_hz(b: &[f64], dt: f64) -> f64 {
    let last = b.len() - 1;
    let half = last / 2;
    let floor2 = b[half..last].iter().map(|v| v * v).sum::<f64>() / (last - half) as f64;
    let width = (last / 150).clamp(4, half.max(4));
    let per_k = 1.0 / (2.0 * last as f64 * dt);
    let sunk = (1..half).find(|&k| {
        let band = &b[k..(k + width).min(last)];
        band.iter().map(|v| v * v).sum::<f64>() <= 2.0 * floor2 * band.len() as f64
    });
    sunk.unwrap_or(half) as f64 * per_k
}

#[cfg(test)]
mod tests;
