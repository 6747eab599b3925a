//! pid: whether residuals are noise, and what follows for the errors when they are not. In: residuals of all runs, and how outputs
//! depend on the parameters. Out: a probability per channel; a covariance for coloured residuals.

use super::problem::{Solved, floor};
use super::run::{FreeColumns, PreparedRun};
use crate::equations::Transition;
use nalgebra::DMatrix;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use windfall_model::{CHANNEL_NAMES, CHANNELS};

/// Quality of one channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelFit {
    /// Channel, as in the run file.
    pub channel: &'static str,
    /// Share of the channel's variance that the model explains.
    pub r2: f64,
    /// Standard deviation of the residual, SI.
    pub residual_std: f64,
    /// Probability that white noise has as much more power at low frequency than at high as the residual has.
    pub whiteness_p: f64,
}

/// Upper ends of the low bands tried, Hz: the slow drift, the swing and its neighbourhood, all that a model can follow.
const BANDS_HZ: [f64; 4] = [0.3, 1.0, 2.5, 6.0];
/// Half-width over which a cross-spectrum is averaged, Hz.
const AVERAGE_HZ: f64 = 0.25;

/// Fit of every channel over all runs.
pub(crate) fn channel_fits(runs: &[PreparedRun<'_>], solved: &Solved) -> Vec<ChannelFit> {
    let mut planner = RealFftPlanner::new();
    let floor = floor(runs);
    let fit = |(c, channel): (usize, &'static str)| {
        let series: Vec<&[f64]> = solved.residuals.iter().map(|r| r[c].as_slice()).collect();
        let interval: Vec<f64> = runs.iter().map(|r| r.interval_s).collect();
        let total: f64 = runs.iter().map(|r| spread(r.record.channels()[c])).sum();
        let left: f64 = series.iter().map(|s| s.iter().map(|e| e * e).sum::<f64>()).sum();
        ChannelFit {
            channel,
            r2: if total > 0.0 { 1.0 - left / total } else { 0.0 },
            residual_std: solved.solution.noise_std[c],
            // What is far below the sensor's noise is the integrator's, not the model's.
            whiteness_p: if solved.solution.noise_std[c] > floor[c] {
                low_frequency_p(&series, &interval, &mut planner)
            } else {
                1.0
            },
        }
    };
    CHANNEL_NAMES.into_iter().enumerate().map(fit).collect()
}

/// Sum of squares about the mean.
pub(crate) fn spread(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| (v - mean).powi(2)).sum()
}

/// F test of the periodogram's mean below each of [`BANDS_HZ`] against that above a quarter of the sample rate, the smallest
/// probability times the number of bands (Bonferroni). One-sided: a fit takes power out of low frequencies, a wrong model adds.
pub(crate) fn low_frequency_p(series: &[&[f64]], interval_s: &[f64], planner: &mut RealFftPlanner<f64>) -> f64 {
    let (mut high, mut high_count) = (0.0, 0.0);
    let (mut low, mut low_count) = ([0.0; BANDS_HZ.len()], [0.0; BANDS_HZ.len()]);
    for (x, h) in series.iter().zip(interval_s) {
        let n = x.len();
        let spectrum = transform(x, n, planner);
        for (k, z) in spectrum.iter().enumerate().take(n.div_ceil(2)).skip(1) {
            let (power, hz) = (z.norm_sqr() / n as f64, k as f64 / (n as f64 * h));
            if hz > 0.25 / h {
                high += power;
                high_count += 2.0;
            }
            for ((sum, count), _) in low.iter_mut().zip(&mut low_count).zip(BANDS_HZ).filter(|(_, band)| hz <= *band) {
                *sum += power;
                *count += 2.0;
            }
        }
    }
    let p = |(sum, count): (f64, f64)| {
        let ratio = (sum / count) / (high / high_count);
        FisherSnedecor::new(count, high_count).ok().filter(|_| ratio.is_finite()).map_or(1.0, |f| f.sf(ratio))
    };
    let smallest = low.into_iter().zip(low_count).filter(|l| l.1 > 0.0).map(p).fold(1.0, f64::min);
    (smallest * BANDS_HZ.len() as f64).min(1.0)
}

fn transform(x: &[f64], length: usize, planner: &mut RealFftPlanner<f64>) -> Vec<Complex64> {
    let plan = planner.plan_fft_forward(length);
    let mut padded = plan.make_input_vec();
    padded[..x.len()].copy_from_slice(x);
    let mut spectrum = plan.make_output_vec();
    plan.process(&mut padded, &mut spectrum).expect("lengths come from the plan");
    spectrum
}

/// Covariance of the estimates when residuals have any stationary colour, correlated between channels: `M⁻¹ (Σ_f Gᴴ P G) M⁻¹`
/// with M the information, G the transform of the profiled output slopes over their variance and P the residuals' averaged
/// cross-spectrum (Morelli and Klein 1997, in the frequency domain). `None` where a slope cannot be computed.
pub(crate) fn coloured(runs: &[PreparedRun<'_>], solved: &Solved) -> Option<DMatrix<f64>> {
    let mut planner = RealFftPlanner::new();
    let mut work = Transition::default();
    let c = FreeColumns::of(&solved.unknowns);
    let free = c.free;
    let mut middle = DMatrix::<f64>::zeros(free, free);
    for (i, run) in runs.iter().enumerate() {
        let slopes = run.profiled_slopes(&solved.nominals[i], &solved.linear[i], &c, &mut work)?;
        let n = run.record.len();
        let length = 2 * n;
        let residual: Vec<Vec<Complex64>> = solved.residuals[i].iter().map(|r| transform(r, length, &mut planner)).collect();
        let weighted = |(series, std): (&Vec<Vec<f64>>, &f64)| -> Vec<Vec<Complex64>> {
            series
                .iter()
                .map(|s| transform(&s.iter().map(|v| v / (std * std)).collect::<Vec<_>>(), length, &mut planner))
                .collect()
        };
        let g: Vec<Vec<Vec<Complex64>>> = slopes.iter().zip(&solved.solution.noise_std).map(weighted).collect();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of frequencies")]
        let half = ((AVERAGE_HZ * length as f64 * run.interval_s).ceil() as usize).max(4);
        add_middle(&mut middle, &residual, &g, n, half);
    }
    // What is known beforehand is not coloured.
    solved.unknowns.priors().for_each(|(column, _, std)| middle[(column, column)] += std.powi(-2));
    let white = &solved.solution.covariance;
    let mut covariance = white * middle * white;
    // Colour can also make a sum more precise than white noise would; a model that is known to be wrong is given no credit for it.
    let factor = |i: usize| (white[(i, i)] / covariance[(i, i)]).max(1.0).sqrt();
    let factors: Vec<f64> = (0..free).map(factor).collect();
    covariance.iter_mut().enumerate().for_each(|(k, v)| *v *= factors[k % free] * factors[k / free]);
    Some(covariance)
}

/// Adds `Σ_f Gᴴ P G` of one run; P is the mean of `r rᴴ/n` over `2·half + 1` frequencies.
fn add_middle(middle: &mut DMatrix<f64>, residual: &[Vec<Complex64>], g: &[Vec<Vec<Complex64>>], n: usize, half: usize) {
    let bins = residual[0].len();
    let length = 2 * n;
    for a in 0..CHANNELS {
        for b in 0..CHANNELS {
            let mut running = vec![Complex64::default(); bins + 1];
            for k in 0..bins {
                running[k + 1] = running[k] + residual[a][k] * residual[b][k].conj();
            }
            for k in 0..bins {
                let (from, to) = (k.saturating_sub(half), (k + half + 1).min(bins));
                let p = (running[to] - running[from]) / ((to - from) * n) as f64;
                // Both halves of the spectrum, but for its ends.
                let twice = if k == 0 || k == bins - 1 { 1.0 } else { 2.0 };
                for (i, left) in g[a].iter().enumerate() {
                    let left = left[k].conj() * p * (twice / length as f64);
                    g[b].iter().enumerate().for_each(|(j, right)| middle[(i, j)] += (left * right[k]).re);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
