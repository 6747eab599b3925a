//! pid: accuracy under coloured residuals. In: regressors and residuals. Out: covariance and what freedom is left.
//!
//! Morelli and Klein, "Accuracy of Aerodynamic Model Parameters Estimated from Flight Test Data", J. Aircraft 34(2), 1997:
//! `Cov = (XᵀX)⁻¹ [Σ_i Σ_j R(i−j) x_i x_jᵀ] (XᵀX)⁻¹` with R the residuals' autocorrelation. The double sum is done by Fourier
//! transform, and R is tapered (Parzen 1961) so that the sum cannot become negative.

use super::{Colour, RegressionSeries};
use nalgebra::DMatrix;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;

/// Covariance, or none when every series is declared white; and the effective number of independent residuals.
pub(super) fn covariance(
    series: &[&RegressionSeries],
    columns: &[usize],
    residuals: &[Vec<f64>],
    bread: &DMatrix<f64>,
) -> (Option<DMatrix<f64>>, f64) {
    let rows: usize = residuals.iter().map(Vec::len).sum();
    if series.iter().all(|s| s.residuals == Colour::White) {
        return (None, rows as f64);
    }
    let mut planner = RealFftPlanner::new();
    let mut meat = DMatrix::zeros(bread.nrows(), bread.ncols());
    let mut freedom = 0.0;
    for (s, v) in series.iter().zip(residuals) {
        freedom += add_series(s, columns, v, &mut meat, &mut planner);
    }
    (Some(bread * meat * bread), freedom)
}

/// Adds one series' double sum; returns its effective number of independent residuals.
fn add_series(
    s: &RegressionSeries,
    columns: &[usize],
    v: &[f64],
    meat: &mut DMatrix<f64>,
    planner: &mut RealFftPlanner<f64>,
) -> f64 {
    let n = v.len();
    let lags = match s.residuals {
        Colour::Corrected(lags) | Colour::Weighted(lags) => lags,
        Colour::White => 0,
    };
    let lags = lags.clamp(1, n - 1);
    let size = fast_length(n + lags);
    let mut transform = |x: &mut dyn Iterator<Item = f64>| -> Vec<Complex64> {
        let fft = planner.plan_fft_forward(size);
        let mut input = fft.make_input_vec();
        for (a, b) in input.iter_mut().zip(x) {
            *a = b;
        }
        let mut out = fft.make_output_vec();
        fft.process(&mut input, &mut out).expect("buffers are made by the plan");
        out
    };
    let power: Vec<Complex64> =
        transform(&mut v.iter().copied()).iter().map(|z| Complex64::new(z.norm_sqr() / (n * size) as f64, 0.0)).collect();
    let columns: Vec<Vec<Complex64>> = columns.iter().map(|&c| transform(&mut s.regressors[c].iter().copied())).collect();
    let r = autocovariance(power, lags, size, planner);
    let square_sum = r[0] * r[0] + 2.0 * r[1..=lags].iter().map(|r| r * r).sum::<f64>();
    let spectrum = spectrum(&r, size, planner);
    for a in 0..columns.len() {
        for b in 0..=a {
            let sum = cross_sum(&spectrum, &columns[a], &columns[b], size);
            meat[(a, b)] += sum;
            if a != b {
                meat[(b, a)] += sum;
            }
        }
    }
    if square_sum > 0.0 { n as f64 * r[0] * r[0] / square_sum } else { n as f64 }
}

/// Autocovariance at lags 0..=lags (and zeros to `size`), tapered by Parzen's window.
fn autocovariance(mut power: Vec<Complex64>, lags: usize, size: usize, planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
    let fft = planner.plan_fft_inverse(size);
    let mut r = fft.make_output_vec();
    fft.process(&mut power, &mut r).expect("a power spectrum is real");
    for (k, v) in r.iter_mut().enumerate() {
        *v *= parzen(k as f64 / (lags + 1) as f64);
    }
    r
}

fn parzen(x: f64) -> f64 {
    if x <= 0.5 {
        1.0 - 6.0 * x * x * (1.0 - x)
    } else if x < 1.0 {
        2.0 * (1.0 - x).powi(3)
    } else {
        0.0
    }
}

/// Power spectrum of an even autocovariance.
fn spectrum(r: &[f64], size: usize, planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
    let fft = planner.plan_fft_forward(size);
    let mut input = fft.make_input_vec();
    input[0] = r[0];
    for k in 1..=size / 2 {
        input[k] += r[k];
        input[size - k] += r[k];
    }
    let mut out = fft.make_output_vec();
    fft.process(&mut input, &mut out).expect("buffers are made by the plan");
    out.iter().map(|z| z.re.max(0.0)).collect()
}

/// Σ_i Σ_j R(i−j) a_i b_j by Parseval's theorem.
fn cross_sum(spectrum: &[f64], a: &[Complex64], b: &[Complex64], size: usize) -> f64 {
    let last = spectrum.len() - 1;
    let term = |k: usize| spectrum[k] * (a[k].re * b[k].re + a[k].im * b[k].im);
    let inner: f64 = (1..last).map(term).sum();
    (term(0) + 2.0 * inner + term(last)) / size as f64
}

/// Smallest even length at or above n that has no prime factor above 5.
pub(super) fn fast_length(n: usize) -> usize {
    let smooth = |mut m: usize| {
        for p in [2, 3, 5] {
            while m.is_multiple_of(p) {
                m /= p;
            }
        }
        m == 1
    };
    (n.max(2)..).find(|&m| m % 2 == 0 && smooth(m)).expect("powers of two have no end")
}
