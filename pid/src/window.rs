//! pid: local polynomial smoothing at chosen samples. In: uniform series. Out: value and derivatives every few samples.
//!
//! Savitzky and Golay (1964): a polynomial is fitted to a window of samples and evaluated with its derivatives; at the ends of
//! a run the last whole window is evaluated off-centre, so that nothing is reflected or assumed there.

use crate::smooth::Signal;
use nalgebra::DMatrix;

/// A fitted window: half width and degree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Half width, s.
    pub half_width_s: f64,
    /// Polynomial degree, at most 8.
    pub degree: usize,
}

/// Kernels of one window at one sample interval.
#[derive(Clone, Debug)]
pub struct Kernels {
    half: usize,
    unit_s: f64,
    /// Row k: coefficient of x^k from the window's samples, x in [−1, 1].
    fit: DMatrix<f64>,
}

impl Kernels {
    /// Kernels for a sample interval (s); at least `degree + 1` samples in the window.
    #[must_use]
    pub fn new(window: Window, interval_s: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a window of some hundred samples")]
        let half = ((window.half_width_s / interval_s).round() as usize).max(window.degree.div_ceil(2) + 1);
        let m = 2 * half + 1;
        let x = |i: usize| (i as f64 - half as f64) / half as f64;
        let v = DMatrix::from_fn(m, window.degree + 1, |i, k| x(i).powi(i32::try_from(k).unwrap_or(0)));
        let qr = v.qr();
        let fit = qr.r().solve_upper_triangular(&qr.q().transpose()).expect("distinct abscissae give full rank");
        Self { half, unit_s: half as f64 * interval_s, fit }
    }
    /// Samples in a window.
    #[must_use]
    pub fn len(&self) -> usize {
        2 * self.half + 1
    }
    /// A window is never empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }
    /// Weights of value, first and second derivative at `offset` samples from the window's centre.
    fn weights(&self, offset: f64) -> [Vec<f64>; 3] {
        let x = offset / self.half as f64;
        let order = self.fit.nrows();
        let mut rows = [vec![0.0; self.len()], vec![0.0; self.len()], vec![0.0; self.len()]];
        for k in 0..order {
            let (kf, e) = (k as f64, i32::try_from(k).unwrap_or(0));
            let basis = [
                x.powi(e),
                if k >= 1 { kf * x.powi(e - 1) / self.unit_s } else { 0.0 },
                if k >= 2 { kf * (kf - 1.0) * x.powi(e - 2) / (self.unit_s * self.unit_s) } else { 0.0 },
            ];
            for (row, b) in rows.iter_mut().zip(basis) {
                for (w, f) in row.iter_mut().zip(self.fit.row(k).iter()) {
                    *w += b * f;
                }
            }
        }
        rows
    }
    /// Gain of the second derivative at angular frequency ω: 1 at low frequency, falling outside the window's band.
    #[must_use]
    pub fn second_gain(&self, omega_rad_s: f64, interval_s: f64) -> f64 {
        let w2 = omega_rad_s * omega_rad_s;
        if w2 * self.unit_s * self.unit_s < 1e-6 {
            return 1.0;
        }
        let [_, _, second] = self.weights(0.0);
        let sum: f64 =
            second.iter().enumerate().map(|(i, c)| c * (omega_rad_s * (i as f64 - self.half as f64) * interval_s).cos()).sum();
        -sum / w2
    }
    /// Gain of the value at angular frequency ω.
    #[must_use]
    pub fn value_gain(&self, omega_rad_s: f64, interval_s: f64) -> f64 {
        let [value, _, _] = self.weights(0.0);
        value.iter().enumerate().map(|(i, c)| c * (omega_rad_s * (i as f64 - self.half as f64) * interval_s).cos()).sum()
    }
    /// Smooths each series (same length, at least one window) at samples 0, stride, 2·stride, …
    #[must_use]
    pub fn smooth(&self, series: &[&[f64]], stride: usize) -> Vec<Signal> {
        let n = series.first().map_or(0, |s| s.len());
        let m = self.len();
        let mut out: Vec<Signal> = series.iter().map(|_| Signal::default()).collect();
        if n < m {
            return out;
        }
        let centre = self.weights(0.0);
        for i in (0..n).step_by(stride) {
            let low = i.saturating_sub(self.half).min(n - m);
            let off = i as f64 - (low + self.half) as f64;
            let own;
            let w = if low + self.half == i {
                &centre
            } else {
                own = self.weights(off);
                &own
            };
            for (signal, s) in out.iter_mut().zip(series) {
                let window = &s[low..low + m];
                let dot = |row: &[f64]| row.iter().zip(window).map(|(a, b)| a * b).sum::<f64>();
                signal.value.push(dot(&w[0]));
                signal.rate.push(dot(&w[1]));
                signal.second.push(dot(&w[2]));
            }
        }
        out
    }
}
