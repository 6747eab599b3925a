//! pid: the motion at instants, for a balance of forces. In: records. Out: values and derivatives of the seven motion signals.
//!
//! Polynomials of degree four (Savitzky and Golay 1964) through windows of 0.7 s for place and speed and 0.4 s for angles: the tunnel's
//! 1 Hz motion passes, noise of Table A.3 leaves 0.03 m/s² and 0.2 rad/s² of accelerations of 1 m/s² and 10 rad/s².

use super::median;
use crate::instrument::Sample;
use nalgebra::DMatrix;
use windfall_model::{Record, RunChannel};

/// Half-width of a window, s, for place and speed, and for angles; and the least number of samples.
pub(super) const HALF_S: [f64; 2] = [0.35, 0.2];
pub(super) const FEWEST: usize = 6;
/// The same of a record that was thinned to its bandwidth, whose samples have less noise: two more samples than the polynomial has numbers.
const FEWEST_THINNED: usize = 3;
/// Interval, s, above which a record's clock cannot be right: its windows are then of so many samples.
pub(super) const SLOWEST_S: f64 = 0.1;
const BLIND: [usize; 2] = [50, 30];
const DEGREE: usize = 4;
/// Most instants of a campaign.
const MOST: usize = 600;

/// Delays of the anemometer that are looked at: their number and step, s.
pub(super) const DELAYS: usize = 4;
pub(super) const DELAY_S: f64 = 0.15;

/// One instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionSample {
    /// Time of the record, s.
    pub(super) t_s: f64,
    /// Recorded time for which it stands, s.
    pub(super) span_s: f64,
    /// Value, rate and second derivative by recorded time of X, Y, Z (m), R_x, R_y, R_z (rad), V_W (m/s).
    pub(super) motion: Sample,
    /// The same of V_W, one to [`DELAYS`] steps of [`DELAY_S`] later.
    pub(super) later: [[f64; 3]; DELAYS],
    /// Static pressure, Pa.
    pub(super) ps_pa: f64,
    /// Static temperature, K.
    pub(super) ts_k: f64,
}

/// Instants of all runs, evenly spread.
pub(super) fn instants(runs: &[(&str, &Record)]) -> Vec<MotionSample> {
    let stride = stride(runs);
    runs.iter().flat_map(|(_, r)| of_run(r, stride)).collect()
}

/// Samples from one instant of a campaign to the next.
pub(super) fn stride(runs: &[(&str, &Record)]) -> usize {
    runs.iter().map(|(_, r)| r.len()).sum::<usize>().div_ceil(MOST).max(1)
}

pub(super) fn of_run(r: &Record, stride: usize) -> Vec<MotionSample> {
    let dt = r.interval_s();
    let (thinned, least) = (!r.bandwidth.is_empty(), if r.bandwidth.is_empty() { FEWEST } else { FEWEST_THINNED });
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples")]
    let half = |k: usize| if dt > SLOWEST_S && !thinned { BLIND[k] } else { (HALF_S[k] / dt.max(1e-5)).round() as usize };
    let half = [half(0), half(1)].map(|h| h.max(least).min((r.len() - 1) / 2));
    let [Some(wide), Some(narrow)] = half.map(|h| weights(h, dt)) else { return Vec::new() };
    let (p, t) = (median(&r.ps_pa), median(&r.ts_k));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples")]
    let step = (DELAY_S / dt.max(1e-5)).round() as usize;
    let margin = half[0].max(half[1]);
    (margin..r.len() - margin)
        .step_by(stride)
        .map(|i| {
            let fit = |x: &[f64], i: usize, h: usize, weights: &[Vec<f64>; 3]| {
                let part = &x[i - h..=i + h];
                // Differences from the sample itself lose nothing to a large mean.
                let sum = |order: usize| weights[order].iter().zip(part).map(|(w, v)| w * (v - x[i])).sum::<f64>();
                [x[i] + sum(0), sum(1), sum(2)]
            };
            let channels = r.channels();
            let motion = RunChannel::ALL.map(|c| {
                let (h, weights) = if c.is_angle() { (half[1], &narrow) } else { (half[0], &wide) };
                fit(channels[c.at()], i, h, weights)
            });
            let later = std::array::from_fn(|k| fit(&r.vw_m_s, (i + step * (k + 1)).min(r.len() - 1 - half[0]), half[0], &wide));
            MotionSample { t_s: r.t_s[i], span_s: dt * stride as f64, motion, later, ps_pa: p, ts_k: t }
        })
        .collect()
}

/// Least-squares weights of value, rate and second derivative in the middle of a window.
pub(super) fn weights(half: usize, dt: f64) -> Option<[Vec<f64>; 3]> {
    let m = 2 * half + 1;
    #[expect(clippy::cast_possible_wrap, clippy::cast_possible_truncation, reason = "a degree below ten")]
    let a = DMatrix::from_fn(m, DEGREE + 1, |i, j| ((i as f64 - half as f64) / half as f64).powi(j as i32));
    let inverse = (a.transpose() * &a).try_inverse()? * a.transpose();
    let unit = half as f64 * dt;
    let row = |order: usize, factor: f64| inverse.row(order).iter().map(|w| w * factor).collect();
    Some([row(0, 1.0), row(1, 1.0 / unit), row(2, 2.0 / (unit * unit))])
}

#[cfg(test)]
mod tests;
