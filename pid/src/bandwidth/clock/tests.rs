use super::super::testing::{butterworth, forward_backward, motion, on_straight_lines, white};
use super::*;

fn all(_: usize) -> bool {
    true
}

fn samples(n: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    motion(n, rate_hz, 0.2, seed).iter().zip(white(seed, n, 7.5e-4)).map(|(m, w)| m + w).collect()
}

/// Rows on straight lines: the clock, and its samples to the rounding of the file (1e-6, at most four of them in a tick between rows).
#[test]
fn exact_samples_behind_straight_lines() {
    for (from_hz, to_hz, p, q) in [(100.0, 150.0, 2, 3), (60.0, 150.0, 2, 5), (120.0, 150.0, 4, 5), (10.0, 150.0, 1, 15)] {
        let truth: Vec<Vec<f64>> = (1..4).map(|c| samples(600, from_hz, c)).collect();
        for skipped in [0, 1, 2] {
            let rows: Vec<Vec<f64>> = truth
                .iter()
                .map(|x| on_straight_lines(x, from_hz, to_hz)[skipped..].iter().map(|v| (1e6 * v).round() / 1e6).collect())
                .collect();
            let views: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let clock = straight(&views, &all).unwrap_or_else(|| panic!("{from_hz} to {to_hz} from row {skipped}"));
            assert_eq!((clock.p, clock.q), (p, q));
            let ticks = clock.ticks(rows[0].len());
            let (values, _) = on_lines(&rows[0], &clock, &all);
            for (tick, value) in ticks.iter().zip(&values).skip(1).take(500) {
                let at = (tick + skipped as f64) * from_hz / to_hz;
                assert!((at - at.round()).abs() < 1e-9, "tick at {at} of a sample");
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place among the samples")]
                let truth = truth[0][at.round() as usize];
                assert!((value - truth).abs() < 4e-6, "{from_hz}: {value} {truth}");
            }
        }
    }
}

/// Every sample given three times, or by a pattern of two and one.
#[test]
fn exact_samples_that_are_repeated() {
    for (p, q) in [(1, 3), (2, 3), (3, 5)] {
        let truth = samples(1000, 150.0, 5);
        for skipped in 0..q {
            let rows: Vec<f64> = (skipped..1500).map(|i| truth[i * p / q]).collect();
            let clock = repeated(&[&rows], &all).expect("a clock");
            assert_eq!((clock.p, clock.q), (p, q));
            let ticks = clock.ticks(rows.len());
            let first = (ticks[0] + skipped as f64) * p as f64 / q as f64;
            assert!((first - first.round()).abs() < 1e-9, "{first}");
        }
    }
}

/// Rows of their own have no clock: white, quantised to 1.5 of their noise, smoothed at 12 Hz, without noise. Of 160 runs none: at most 2 % with
/// 95 % confidence.
#[test]
fn law_own_rows_have_no_clock() {
    for seed in 0..40 {
        let raw = samples(1200, 150.0, seed);
        let smooth = forward_backward(&raw, &|x| butterworth(x, 2, 12.0 / 150.0));
        let sorts =
            [raw.clone(), raw.iter().map(|v| (v / 1.1e-3).round() * 1.1e-3).collect(), smooth, motion(1200, 150.0, 0.2, seed)];
        for (k, x) in sorts.iter().enumerate() {
            let other = samples(1200, 150.0, seed + 900);
            assert_eq!(repeated(&[x, &other], &all), None, "seed {seed}, sort {k}");
            assert_eq!(straight(&[x], &all), None, "seed {seed}, sort {k}");
        }
    }
}
