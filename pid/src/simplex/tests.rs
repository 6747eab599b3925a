//! pid tests: downhill simplex on functions whose minimum is known, and its moves by hand.

use super::*;

/// A quadratic bowl off the middle: its minimum within the simplex' last size (a thousandth) in 200 calls.
#[test]
fn exact_bowl() {
    let f = |x: &[f64]| (x[0] - 0.3).powi(2) + 4.0 * (x[1] - 0.8).powi(2) + (x[0] - 0.3) * (x[1] - 0.8);
    let found = minimise(f, &[0.9, 0.1], 0.2, 200);
    let Minimum { at: x, value, stop } = &found;
    assert!((x[0] - 0.3).abs() < 2e-3 && (x[1] - 0.8).abs() < 2e-3 && *value < 1e-5, "{found:?}");
    assert_eq!(*stop, StopReason::Converged);
    assert_eq!(minimise(f, &[0.9, 0.1], 0.2, 20).stop, StopReason::Iterations);
}
#[test]
fn exact_minimum_on_a_face() {
    let x = minimise(|x| x[0] + (x[1] - 0.5).powi(2), &[0.5, 0.2], 0.2, 200).at;
    assert!(x[0] < 1e-3 && (x[1] - 0.5).abs() < 0.03, "{x:?}");
}

/// Nelder and Mead's rules by hand, on values given beforehand. Corners A (0.4, 0.6), B (0.5, 0.6) and C (0.4, 0.5), steps toward the middle,
/// are worth 3, 2 and 1: A is reflected at the middle M (0.45, 0.55) of the others to 2M − A; if that is the best, 3M − 2A is tried;
/// if the worst but for A, (3M − A)/2; if worse than A, (M + A)/2; and if that is no better either, A and B go halfway to C.
#[test]
fn exact_moves_of_nelder_and_mead() {
    let corners = [[0.4, 0.6], [0.5, 0.6], [0.4, 0.5]];
    let reflected = [0.5, 0.5];
    let rules: [(&[f64], &[[f64; 2]]); 3] = [
        (&[0.5, 0.4, 9.0], &[[0.55, 0.45]]),
        (&[2.5, 2.2, 9.0], &[[0.475, 0.525]]),
        (&[4.0, 5.0, 9.0, 9.0, 9.0], &[[0.425, 0.575], [0.45, 0.55], [0.4, 0.55]]),
    ];
    for (values, moves) in rules {
        let mut places = Vec::new();
        let script = [&[3.0, 2.0, 1.0], values].concat();
        let f = |x: &[f64]| {
            places.push([x[0], x[1]]);
            script[places.len() - 1]
        };
        let found = minimise(f, &[0.4, 0.6], 0.1, script.len());
        assert_eq!((places.len(), found.stop), (script.len(), StopReason::Iterations));
        for (place, expected) in places.iter().zip(corners.iter().chain([&reflected]).chain(moves)) {
            assert!(place.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{places:?} {expected:?}");
        }
    }
}
