//! discover tests: sizes of components against their definition, and the smooth kernel against its integral.

use super::super::tests::{ball, close, thrown, times};
use super::*;

fn tracks() -> [Track; 2] {
    let long = thrown(&times(11, 0.4, 1.7), &[0, 2], [1.0, 0.0, -2.0], [3.0, 0.0, 5.0]);
    let short = thrown(&times(7, 0.0, 0.9), &[2], [0.0, 0.0, 3.0], [0.0, 0.0, -2.0]);
    [(long, true), (short, true)].map(|(r, pushed)| Track::new(&r, &[], 0, &ball(0.0), pushed).expect("flies"))
}

/// The mean variance of the numbers where a component acts, two fewer than samples of each run, is what is asked for: its sum of
/// variances is that times 9 and 5 of the axis that both have, times 9 of the other. Its shape is the kernel's.
#[test]
fn exact_mean_variance_of_a_component() {
    let tracks = tracks();
    let kernel = |axis: usize| move |a: usize, s: f64, r: f64| if a == axis { s.min(r) } else { 0.0 };
    for (axis, numbers) in [(2, 14.0), (0, 9.0)] {
        let raw: Vec<Cov> = tracks.iter().flat_map(|t| t.blocks(kernel(axis), 0.0)).collect();
        let pushed: Vec<Cov> = tracks.iter().flat_map(|t| t.push_blocks(axis)).collect();
        for (all, raw) in [(parts(&tracks, 0.37, kernel(axis)), raw), (pushes(&tracks, 0.37, axis), pushed)] {
            let sum = |all: &[Cov]| all.iter().map(nalgebra::Matrix::trace).sum::<f64>();
            close(sum(&all), 0.37 * numbers, 1e-12);
            let by = 0.37 * numbers / sum(&raw);
            all.iter().zip(&raw).for_each(|(a, b)| close((a - b * by).amax(), 0.0, 1e-12));
        }
    }
}

/// `∫ (s − u)(r − u) du` over forces of white noise at times `u` up to the earlier of the two; Simpson's rule is exact for a
/// square.
#[test]
fn exact_smooth_is_the_integral_of_two_responses() {
    for [s, r] in [[0.7, 1.9], [1.9, 0.7], [1.3, 1.3]] {
        let low = f64::min(s, r);
        let at = |u: f64| (s - u) * (r - u);
        close(smooth(s, r), low / 6.0 * (at(0.0) + 4.0 * at(0.5 * low) + at(low)), 1e-14);
    }
}
