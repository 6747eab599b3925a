//! discover tests: whitened numbers by hand.

use super::super::tests::{ball, campaign, close, thrown, times};
use super::*;

/// Two axes: each number with its frequency, half periods over twice the duration, over the standard deviation of white noise.
#[test]
fn exact_numbers_are_over_their_noise() {
    let t_s = times(8, 0.0, 1.3);
    let c = campaign(ball(0.0), &[], vec![(Vec::new(), thrown(&t_s, &[0, 2], [1.0; 3], [2.0; 3]))]);
    let mut evidence = TrackEvidence::new(&c, &[0], &c.plant).expect("flies");
    evidence.noise = vec![super::super::bins::Cov::identity() * 0.09];
    let z: Vec<f64> = (0..BIN).map(|i| 0.7 + i as f64).collect();
    let all = evidence.whitened(&z);
    assert_eq!(all.iter().map(|(axis, x)| (*axis, x.len())).collect::<Vec<_>>(), [(0, 6), (2, 6)]);
    for (k, (_, numbers)) in all.iter().enumerate() {
        for (order, [hz, x]) in numbers.iter().enumerate() {
            close(*hz, 0.5 * (order as f64 + 2.0) / 1.3, 1e-14);
            close(*x, z[2 * order + k] / 0.3, 1e-12);
        }
    }
}
