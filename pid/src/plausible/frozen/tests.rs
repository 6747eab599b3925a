//! pid tests: stretches of a record that stand or come again, by their samples.

use super::super::tests::{record, spread};
use super::*;

/// Shortest stretch at 7 ms: 0.12 s are 17.1 samples, so 18.
const NEED: usize = 18;
const STEP_S: f64 = 0.007;

fn moving_pose(i: usize) -> [f64; 6] {
    std::array::from_fn(|k| 0.2 + 0.1 * k as f64 + 0.0013 * (k as f64 + 1.0) * i as f64)
}

/// A ramp on all channels whose samples are taken from other places.
fn taken(from: impl Fn(usize) -> usize) -> Record {
    record(200, STEP_S, |i| moving_pose(from(i)))
}

/// A ramp that stands from sample 120 on for 18 samples, or 17; and a pose that trembles about one place, which may stand by
/// chance.
#[test]
fn exact_frozen_pose() {
    let standing = |count: usize| taken(move |i| if (120..120 + count).contains(&i) { 120 } else { i });
    let found = fault("r", &standing(NEED)).expect("frozen");
    assert_eq!(found.cause, "frozen pose");
    assert!(found.evidence.starts_with("from 0.840 to 0.959 s all of"), "{}", found.evidence);
    assert!(found.evidence.contains("repeat one sample 18 times"), "{}", found.evidence);
    assert!(fault("r", &standing(NEED - 1)).is_none());
    let tremble = |i: usize| std::array::from_fn(|k| 0.3 + 1e-4 * (1.4 * spread(i, k)).round());
    assert!(fault("r", &record(200, STEP_S, |i| tremble(if (120..140).contains(&i) { 120 } else { i }))).is_none());
    let still = fault("r", &taken(|_| 7)).expect("it never moves");
    assert_eq!((still.cause.as_str(), &still.evidence[..15]), ("the pose never changes", "all 200 samples"));
}

/// A ramp of slope u that trembles by ±A has steps of 2A ± u, most of 2A − u, and goes 17u ± 2A in 18 samples: that is beyond six
/// of its smallest steps for A < 23u/14. Where a single step is smaller, beyond six times 0.3 of the usual one, for A < 18.8u/5.6.
#[test]
fn exact_motion_over_resolution() {
    let u = 0.002;
    let of = |a: f64, smaller: bool| {
        let step = if smaller { 1e-6 - u - 2.0 * a } else { 0.0 };
        let x = move |i: usize| 0.3 + u * i as f64 + if i.is_multiple_of(2) { a } else { -a } + if i < 100 { 0.0 } else { step };
        moving(&record(200, STEP_S, |i| [x(i), 0.0, 0.0, x(i), 0.0, 0.0]), NEED)
    };
    assert!(of(1.6 * u, false) && !of(1.7 * u, false));
    assert!(of(3.3 * u, true) && !of(3.4 * u, true));
    // Two of the six must move.
    assert!(!moving(&record(200, STEP_S, |i| [u * i as f64, 0.0, 0.0, 0.0, 0.0, 0.0]), NEED));
}

/// Eighteen samples from sample 20 on again from sample 90 on, after one that stands twice; seventeen are too few.
#[test]
fn exact_block_given_again() {
    let again = |count: usize| {
        taken(move |i| match i {
            89 => 88,
            i if (90..90 + count).contains(&i) => i - 70,
            i => i,
        })
    };
    let found = fault("r", &again(NEED)).expect("given again");
    assert_eq!(found.cause, "repeated block of samples");
    assert!(
        found.evidence.starts_with("from 0.630 s on the pose is, number by number, that from 0.140 s on"),
        "{}",
        found.evidence
    );
    assert!(fault("r", &again(NEED - 1)).is_none());
}
