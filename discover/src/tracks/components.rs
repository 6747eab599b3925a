//! discover: components of what tracks have unmodelled, over all runs. In: tracks, a kernel in time or an axis. Out: covariances per bin of one size.

use super::bins::Cov;
use super::track::Track;

/// One component of the unmodelled residual over all runs, scaled so that its mean variance where it acts is `variance`.
pub(super) fn parts(tracks: &[Track], variance: f64, kernel: impl Fn(usize, f64, f64) -> f64) -> Vec<Cov> {
    let all: Vec<Cov> = tracks.iter().flat_map(|t| t.blocks(&kernel, 0.0)).collect();
    scaled(all, tracks, variance, |a, end| kernel(a, end, end) > 0.0)
}

/// The component of a steady push along `axis`, different in every run, scaled likewise.
pub(super) fn pushes(tracks: &[Track], variance: f64, axis: usize) -> Vec<Cov> {
    let all: Vec<Cov> = tracks.iter().flat_map(|t| t.push_blocks(axis)).collect();
    scaled(all, tracks, variance, |a, _| a == axis)
}

fn scaled(mut all: Vec<Cov>, tracks: &[Track], variance: f64, acts: impl Fn(usize, f64) -> bool) -> Vec<Cov> {
    let trace: f64 = all.iter().map(nalgebra::Matrix::trace).sum();
    let used: f64 = tracks
        .iter()
        .flat_map(|t| t.axes.iter().map(move |&a| (t, a)))
        .filter(|(t, a)| acts(*a, t.duration_s()))
        .map(|(t, _)| t.t_s.len() as f64 - 2.0)
        .sum();
    let scale = variance * used / trace.max(f64::MIN_POSITIVE);
    all.iter_mut().for_each(|m| *m *= scale);
    all
}

/// One sample.
pub(super) fn same(s: f64, r: f64) -> bool {
    s.total_cmp(&r).is_eq()
}

/// Covariance of the position that a force of white noise leaves (the prior of cubic splines, Wahba 1978).
pub(super) fn smooth(s: f64, r: f64) -> f64 {
    let (low, high) = (s.min(r), s.max(r));
    low * low * (3.0 * high - low) / 6.0
}

#[cfg(test)]
mod tests;
