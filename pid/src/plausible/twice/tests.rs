//! pid tests: runs that share samples, and runs that differ by a share of their noise.

use super::super::tests::record;
use super::*;

fn sets_of(runs: &[&Record]) -> Option<GrossFault> {
    let names = ["a", "b", "c"];
    fault(&names.into_iter().zip(runs.iter().copied()).collect::<Vec<_>>())
}

/// Of 100 samples 60 are also another run's, or 49.
#[test]
fn exact_shared_samples() {
    let a = record(100, 0.01, |i| std::array::from_fn(|k| (i as f64 * 0.37 + k as f64).sin()));
    let other = record(100, 0.01, |i| std::array::from_fn(|k| (i as f64 * 0.29 + k as f64).cos()));
    let sharing = |share: usize| {
        let mut b = record(100, 0.01, |i| std::array::from_fn(|k| (i as f64 * 0.41 + k as f64).cos()));
        let (from, into) = (a.channels(), b.channels_mut());
        into.into_iter().zip(from).for_each(|(x, y)| x[..share].copy_from_slice(&y[..share]));
        b
    };
    let found = sets_of(&[&a, &other, &sharing(60)]).expect("one run");
    assert_eq!((found.place.as_str(), &found.evidence[..4]), ("runs a and c", "60 %"));
    assert!(sets_of(&[&a, &other, &sharing(49)]).is_none());
}

/// Samples at ±a have second differences of 4a, which white noise of a standard deviation of 4a/(√6·0.6745) = 2.42a has at the
/// median: runs that differ by less than half of that are one, if they have one clock to 1e-3.
#[test]
fn exact_difference_over_noise() {
    let a = 0.013;
    let run =
        |off: f64, interval_s: f64| record(120, interval_s, |i| [a * if i.is_multiple_of(2) { 1.0 + off } else { off - 1.0 }; 6]);
    let first = run(0.0, 0.01);
    for (off, interval_s, expected) in
        [(1.2, 0.01, true), (-1.2, 0.01, true), (1.22, 0.01, false), (1.2, 0.010_005, true), (1.2, 0.010_2, false)]
    {
        assert_eq!(sets_of(&[&first, &run(off, interval_s)]).is_some(), expected, "{off} {interval_s}");
    }
    // Too short to tell, or of another length.
    let cut = |n: usize| record(n, 0.01, |i| [a * if i.is_multiple_of(2) { 2.2 } else { 0.2 }; 6]);
    assert!(sets_of(&[&first, &cut(99)]).is_none() && sets_of(&[&first, &cut(241)]).is_none());
}
