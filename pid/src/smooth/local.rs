//! pid: local polynomials (Savitzky and Golay 1964). In: raw signals. Out: values and derivatives, windows shifted inward at ends.

use super::{Fit, Signal};
use crate::PidError;
use nalgebra::DMatrix;
use windfall_model::{CHANNELS, PerChannel};

/// Smooths seven channels, each with its half-width.
pub(super) fn smooth(raw: PerChannel<&[f64]>, dt: f64, half_width_s: &PerChannel<f64>, degree: usize) -> Result<Fit, PidError> {
    if !(2..=12).contains(&degree) {
        return Err(PidError::Setting { setting: "degree", value: degree as f64, allowed: "2 to 12" });
    }
    if let Some(&value) = half_width_s.iter().find(|h| !(h.is_finite() && **h > 0.0)) {
        return Err(PidError::Setting { setting: "half-width, s", value, allowed: "positive" });
    }
    let n = raw[0].len();
    let fewest = degree / 2 + 1;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and clamped to the run")]
    let half = half_width_s.map(|h| ((h / dt).round().min(n as f64) as usize).clamp(fewest, ((n - 1) / 2).max(fewest)));
    let bandwidth_hz = half.map(|h| 1.0 / (4.0 * h as f64 * dt));
    let mut fit = Fit { channels: Default::default(), noise_std: [0.0; CHANNELS], weight: vec![1.0; n], bandwidth_hz };
    for c in 0..7 {
        let window = Window::new(half[c], degree);
        fit.channels[c] = window.apply(raw[c], dt);
        fit.noise_std[c] = window.noise(raw[c], &fit.channels[c].value);
        for (w, i) in fit.weight.iter_mut().zip(0..n) {
            *w = w.min(window.weight(i, n));
        }
    }
    Ok(fit)
}

/// Values as they are; derivatives of quadratics through five samples, the second that of the first.
pub(super) fn unsmoothed(raw: PerChannel<&[f64]>, dt: f64) -> Fit {
    let n = raw[0].len();
    let window = Window::new(2, 2);
    let channels = raw.map(|x| {
        let rate = window.apply(x, dt).rate;
        Signal { value: x.to_vec(), second: window.apply(&rate, dt).rate, rate }
    });
    Fit { channels, noise_std: [0.0; CHANNELS], weight: vec![1.0; n], bandwidth_hz: [0.5 / dt; CHANNELS] }
}

/// Least-squares weights for each place in a window of 2h+1 samples: `rows[place]` holds those for value, rate, second.
struct Window {
    half: usize,
    rows: Vec<[Vec<f64>; 3]>,
}

impl Window {
    fn new(half: usize, degree: usize) -> Self {
        let m = 2 * half + 1;
        // Legendre-like scaling: x in [−1, 1] keeps the Vandermonde matrix usable to degree 12; QR for the rest.
        let x = |i: usize| (i as f64 - half as f64) / half as f64;
        let basis = |x: f64, order: usize| -> Vec<f64> { chebyshev(x, degree).into_iter().map(|c| c[order]).collect() };
        let a = DMatrix::from_fn(m, degree + 1, |i, j| chebyshev(x(i), degree)[j][0]);
        let qr = a.qr();
        let (q, r) = (qr.q(), qr.r());
        let rows = (0..m)
            .map(|place| {
                [0, 1, 2].map(|order| {
                    let d = nalgebra::DVector::from_vec(basis(x(place), order)) / (half as f64).powi(order as i32);
                    let z = r.tr_solve_upper_triangular(&d).expect("distinct abscissae give full rank");
                    (&q * z).as_slice().to_vec()
                })
            })
            .collect();
        Self { half, rows }
    }
    /// First sample of the window for sample i, and the place of i in it.
    fn place(&self, i: usize, n: usize) -> (usize, usize) {
        let start = i.saturating_sub(self.half).min(n - (2 * self.half + 1));
        (start, i - start)
    }
    fn apply(&self, y: &[f64], dt: f64) -> Signal {
        let n = y.len();
        let at = |order: usize| -> Vec<f64> {
            (0..n)
                .map(|i| {
                    let (start, place) = self.place(i, n);
                    let w = &self.rows[place][order];
                    // Differences from the sample itself lose nothing to a large mean.
                    let sum: f64 = w.iter().zip(&y[start..]).map(|(w, v)| w * (v - y[i])).sum();
                    (if order == 0 { y[i] + sum } else { sum }) / dt.powi(order as i32)
                })
                .collect()
        };
        Signal { value: at(0), rate: at(1), second: at(2) }
    }
    fn noise(&self, raw: &[f64], value: &[f64]) -> f64 {
        let centre = self.rows[self.half][0][self.half];
        let mean2 = raw.iter().zip(value).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / raw.len() as f64;
        (mean2 / (1.0 - centre)).sqrt()
    }
    fn weight(&self, i: usize, n: usize) -> f64 {
        let norm = |place: usize| self.rows[place][2].iter().map(|w| w * w).sum::<f64>().sqrt();
        (norm(self.half) / norm(self.place(i, n).1)).min(1.0)
    }
}

/// Chebyshev polynomials T_0..T_degree with first and second derivatives.
fn chebyshev(x: f64, degree: usize) -> Vec<[f64; 3]> {
    let mut t = vec![[1.0, 0.0, 0.0], [x, 1.0, 0.0]];
    for k in 2..=degree {
        let (a, b) = (t[k - 1], t[k - 2]);
        t.push([2.0 * x * a[0] - b[0], 2.0 * a[0] + 2.0 * x * a[1] - b[1], 4.0 * a[1] + 2.0 * x * a[2] - b[2]]);
    }
    t
}

#[cfg(test)]
mod tests;
