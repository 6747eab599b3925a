//! pid tests: steps of a record by hand, each on a line with a scatter that no line takes up.

use super::super::tests::record;
use super::*;
use std::f64::consts::TAU;

/// Every fourth sample the same: without a mean and without a slope.
fn tremble(i: usize) -> f64 {
    [1.0, -1.0, -1.0, 1.0][i % 4]
}

/// Half a sample beyond either end of 0.7 k + 2.3 with a scatter of 0.11.
#[test]
fn exact_line() {
    let x: Vec<f64> = (0..8).map(|k| 2.3 + 0.7 * k as f64 + 0.11 * tremble(k)).collect();
    for (beyond, expected) in [(true, 2.3 + 0.7 * 7.5), (false, 2.3 - 0.7 * 0.5)] {
        let (value, slope, scatter) = line(&x, beyond);
        assert!((value - expected).abs() < 1e-13 && (slope - 0.7).abs() < 1e-13 && (scatter - 0.11).abs() < 1e-13);
    }
}

/// The middle one of five intervals against one and a half times the longest of the others.
#[test]
fn exact_gap() {
    for longest in [0, 1, 3, 4] {
        for (middle, expected) in [(1.49, false), (1.51, true)] {
            let of = |k: usize| if k == 2 { middle } else { 0.8 + 0.2 * f64::from(u8::from(k == longest)) };
            let t: Vec<f64> = (0..6).map(|n| 7.0 + (0..n).map(of).sum::<f64>()).collect();
            assert_eq!(uneven(&t), expected, "{longest} {middle}");
        }
    }
}

/// Sixty samples of 0.01 s: each channel rises by a slope, trembles, and has a step before sample 24.
fn stepped(slope: f64, scatter: f64, steps: [f64; 6]) -> Record {
    let of = |i: usize, k: usize| slope * i as f64 + scatter * tremble(i) + if i < 24 { 0.0 } else { steps[k] };
    record(60, 0.01, |i| std::array::from_fn(|k| of(i, k)))
}

fn on(channel: usize, size: f64) -> [f64; 6] {
    std::array::from_fn(|k| if k == channel { size } else { 0.0 })
}

/// In the words of the report: where, how large and over what. A step counts against the least of its kind, so 0.05 m (2.5 of 0.02
/// m) is more than 0.1 rad (1.9 of 0.052 rad) and less than 0.2 rad.
#[test]
fn exact_largest_step() {
    let of = |slope: f64, scatter: f64, steps: [f64; 6]| fault("r", &stepped(slope, scatter, steps)).map(|f| f.evidence);
    let found = of(0.0, 2e-4, on(1, -0.03)).expect("a step");
    assert!(
        found.starts_with("at 0.240 s Y steps by -30.0 mm from one sample to the next, 0.20 mm being the scatter"),
        "{found}"
    );
    let mut both = on(0, 0.05);
    both[4] = 0.1;
    assert!(of(0.0, 2e-4, both).expect("two steps").starts_with("at 0.240 s X steps by 50.0 mm"));
    both[4] = 0.2;
    let found = of(0.0, 2e-4, both).expect("two steps");
    // 0.2 rad and 0.0002 rad.
    assert!(found.starts_with("at 0.240 s Ry steps by 11.5 deg from one sample to the next, 0.01 deg being"), "{found}");
}

/// Both sides of what counts: 0.02 m, 0.052 rad, and 1.5 slopes of a sample more; twelve times the scatter; a turn is none, to
/// 0.052 rad.
#[test]
fn exact_least_step() {
    for (slope, scatter, steps, expected) in [
        (0.0, 1e-4, on(2, 0.0205), true),
        (0.0, 1e-4, on(2, 0.0195), false),
        (0.0, 1e-4, on(3, 0.053), true),
        (0.0, 1e-4, on(3, 0.051), false),
        (0.004, 1e-4, on(1, 0.0265), true),
        (0.004, 1e-4, on(1, 0.0255), false),
        (0.0, 0.002, on(0, 0.0245), true),
        (0.0, 0.002, on(0, 0.0235), false),
        (0.0, 1e-4, on(5, TAU), false),
        (0.0, 1e-4, on(5, -3.0 * TAU - 0.04), false),
        (0.0, 1e-4, on(5, -3.0 * TAU - 0.06), true),
        (0.0, 1e-4, on(1, TAU), true),
    ] {
        assert_eq!(fault("r", &stepped(slope, scatter, steps)).is_some(), expected, "{slope} {scatter} {steps:?}");
    }
}

/// Twelve samples on each side must be measured, and the step must not be a gap of the clock.
#[test]
fn exact_samples_about_a_step() {
    let mut r = stepped(0.0, 1e-4, on(2, 0.1));
    for (bridged, expected) in [(11, true), (12, false), (23, false), (24, false), (35, false), (36, true)] {
        r.bridged = (0..60).map(|i| i == bridged).collect();
        assert_eq!(fault("r", &r).is_some(), expected, "{bridged}");
    }
    r.bridged.clear();
    r.t_s[24..].iter_mut().for_each(|t| *t += 0.01);
    assert!(fault("r", &r).is_none());
    // What takes three samples, a third in each, is a fast motion: lines meet 0.079 m apart, of which no pair of samples has 0.6.
    let fast = |i: usize| on(1, 0.1 / 3.0 * (i as f64 - 23.0).clamp(0.0, 3.0));
    assert!(fault("r", &record(60, 0.01, fast)).is_none());
    // Steps within twelve samples of the ends have no lines on both sides.
    let at = |place: usize| record(60, 0.01, |i| on(0, 0.1 * f64::from(u8::from(i >= place))));
    for (place, expected) in [(11, false), (12, true), (47, true), (49, false)] {
        assert_eq!(fault("r", &at(place)).is_some(), expected, "{place}");
    }
}
