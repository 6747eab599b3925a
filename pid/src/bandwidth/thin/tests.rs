use super::*;

/// A cubic passes, and white noise keeps 9/4 of its variance over the rows of the window, nearly: (3 (3h² + 3h - 1)) / ((2h-1)(2h+1)(2h+3)).
#[test]
fn exact_a_cubic_passes() {
    let cubic = |t: f64| 0.3 - 1.1 * t + 0.7 * t * t - 0.2 * t * t * t;
    let x: Vec<f64> = (0..60).map(|i| cubic(f64::from(i) / 20.0)).collect();
    assert!([2, 5, 9].iter().all(|h| (mean(&x, 30, *h) - x[30]).abs() < 1e-12));
    let pulse: Vec<f64> = (0..21).map(|i| if i == 10 { 1.0 } else { 0.0 }).collect();
    // Savitzky and Golay 1964, Table I: 17/35.
    assert!((mean(&pulse, 10, 2) - 17.0 / 35.0).abs() < 1e-14);
}
