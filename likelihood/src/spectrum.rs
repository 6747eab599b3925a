//! likelihood: periodograms. In: a series. Out: power over frequency behind Hann's window.

use realfft::RealFftPlanner;
use std::f64::consts::TAU;

/// Power of a windowed series: ordinate `k` is at `k` whole turns over the series.
pub(crate) struct Periodogram {
    /// Squared sizes of the transform.
    pub(crate) power: Vec<f64>,
    /// Sum of the window's squares: the mean of `power` for white noise of variance one.
    pub(crate) window: f64,
}

/// Hann's window of `n` samples.
pub(crate) fn hann(n: usize) -> impl Fn(usize) -> f64 {
    move |i| 0.5 - 0.5 * (TAU * (i as f64 + 0.5) / n as f64).cos()
}

/// Periodogram of a series; `None` where it cannot be transformed.
pub(crate) fn periodogram(series: impl ExactSizeIterator<Item = f64>) -> Option<Periodogram> {
    let n = series.len();
    let window: Vec<f64> = (0..n).map(hann(n)).collect();
    let mut input: Vec<f64> = series.zip(&window).map(|(x, w)| x * w).collect();
    let plan = RealFftPlanner::new().plan_fft_forward(n);
    let mut output = plan.make_output_vec();
    plan.process(&mut input, &mut output).ok()?;
    Some(Periodogram { power: output.iter().map(|z| z.norm_sqr()).collect(), window: window.iter().map(|w| w * w).sum() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `sin²` from end to end of the samples, their middles counted; power by the transform's sum.
    #[test]
    fn exact_power_by_the_sum() {
        let n = 15;
        let window = |i: usize| (0.5 * TAU * (i as f64 + 0.5) / n as f64).sin().powi(2);
        let series: Vec<f64> = (0..n).map(|i| (i * i % 7) as f64 - 1.3).collect();
        let found = periodogram(series.iter().copied()).expect("a transform");
        assert_eq!(found.power.len(), 8);
        for (k, power) in found.power.iter().enumerate() {
            let part =
                |of: fn(f64) -> f64| (0..n).map(|i| series[i] * window(i) * of(TAU * (k * i) as f64 / n as f64)).sum::<f64>();
            let sum = part(f64::cos).powi(2) + part(f64::sin).powi(2);
            assert!((power - sum).abs() < 1e-12 && (found.window - 3.0 / 8.0 * n as f64).abs() < 1e-13, "{k}: {power} {sum}");
        }
    }
}
