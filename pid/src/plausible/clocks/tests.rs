//! pid tests: clocks of runs that fall and rise with the speed of the air, by the balance of weight and drag alone.

use super::super::tests::{record, spread};
use super::*;

const G: f64 = 9.806_65;
const TRIM_M_S: f64 = 7.4;

/// Tunnel speed, m/s: some slow waves of 0.1 m/s in all, from 0.05 to 0.5 Hz.
fn speed_m_s(t: f64) -> f64 {
    let waves = [(0.05, 0.3), (0.13, 1.9), (0.29, 4.1), (0.47, 2.2)];
    TRIM_M_S + waves.iter().map(|(hz, phase)| 0.05 * (std::f64::consts::TAU * hz * t + phase).sin()).sum::<f64>()
}

/// Gusts of 0.05 m/s between 0.2 and 1.1 Hz, which no instrument sees.
fn gust_m_s(t: f64) -> f64 {
    let waves = [(0.21, 0.9), (0.37, 5.0), (0.71, 2.7), (1.07, 1.1)];
    waves.iter().map(|(hz, phase)| 0.035 * (std::f64::consts::TAU * hz * t + phase).sin()).sum()
}

/// Heights of a body that weighs what its drag is at the trim speed, from rest: steps of 1 ms by the midpoint rule, errors of 1e-6 m/s.
fn heights(count: usize, interval_s: f64, air_m_s: impl Fn(f64) -> f64) -> Vec<f64> {
    let rate = |t: f64, v: f64| G * (1.0 - ((air_m_s(t) + v) / TRIM_M_S).powi(2));
    let steps = (interval_s / 1e-3).round().max(1.0);
    let h = interval_s / steps;
    let (mut t, mut x, mut v) = (0.0, 0.0, 0.0);
    let mut all = Vec::with_capacity(count);
    while all.len() < count {
        all.push(x);
        for _ in 0..steps as usize {
            let middle = v + 0.5 * h * rate(t, v);
            (x, v, t) = (x + h * middle, v + h * rate(t + 0.5 * h, middle), t + h);
        }
    }
    all
}

/// A run of 30 s at 100 Hz with V_W recorded late, noise of 0.5 mm and 2.5 mm/s of draw `seed`, and gusts.
fn run(late_s: f64, seed: usize, gusts: f64, waves: f64) -> Record {
    let (count, dt) = (3000, 0.01);
    // Each draw is another part of the same waves.
    let start = 17.0 * seed as f64;
    let speed = |t: f64| TRIM_M_S + waves * (speed_m_s(t) - TRIM_M_S);
    let x = heights(count, dt, |t| speed(start + t) + gusts * gust_m_s(start + t));
    let noise = |i: usize, k: usize| spread(i + 5000 * seed, k);
    let mut r = record(count, dt, |i| [x[i] + 5e-4 * noise(i, 0), 0.0, 0.0, 0.2, 0.0, 0.0]);
    r.vw_m_s = (0..count).map(|i| speed(start + i as f64 * dt - late_s) + 2.5e-3 * noise(i, 1)).collect();
    r
}

fn offset(runs: &[Record], declared_s: f64) -> Option<Lag> {
    Clocks::new(&runs.iter().collect::<Vec<_>>(), G).offset(declared_s)
}

/// Either sign, to a third of the run; within four standard errors and the 3 ms that windows of 0.7 s bend the waves by.
#[test]
fn recover_offsets_of_either_sign() {
    for (k, late_s) in [0.5, -0.5, 1.8, -1.0, 7.37, -9.0].into_iter().enumerate() {
        let found = offset(&[run(late_s, k, 0.0, 1.0), run(late_s, k + 10, 0.0, 1.0)], 0.0).expect("an offset");
        assert!((found.lag_s - late_s).abs() < 4.0 * found.std_error_s + 3e-3, "{late_s}: {found:?}");
        assert!(found.std_error_s < 0.02 && found.left_m_s[1] < 0.2 * found.left_m_s[0], "{late_s}: {found:?}");
    }
}

/// In gusts half as large as the waves of the speed.
#[test]
fn recover_an_offset_in_gusts() {
    for late_s in [1.3, -2.1] {
        let found = offset(&[run(late_s, 1, 1.0, 1.0), run(late_s, 2, 1.0, 1.0)], 0.0).expect("an offset");
        assert!((found.lag_s - late_s).abs() < 4.0 * found.std_error_s + 3e-3, "{late_s}: {found:?}");
    }
}

/// No offset is found in runs without one: in calm air, in gusts, without any variation of V_W, in either or both; nor where it is declared.
#[test]
fn law_clocks_that_agree_are_not_accused() {
    for seed in 0..12 {
        for (gusts, waves) in [(0.0, 1.0), (1.0, 1.0), (0.0, 0.0), (1.0, 0.0), (3.0, 0.3)] {
            let found = offset(&[run(0.0, seed, gusts, waves)], 0.0);
            assert!(found.is_none(), "{seed} {gusts} {waves}: {found:?}");
        }
    }
    assert!(offset(&[run(1.8, 0, 0.0, 1.0)], 1.8).is_none());
    assert!(offset(&[], 0.0).is_none());
}

/// One run of three whose clock is another is named, with its own offset; the others are not.
#[test]
fn recover_the_run_whose_clock_differs() {
    let all = [run(0.0, 3, 0.0, 1.0), run(0.0, 4, 0.0, 1.0), run(-1.25, 5, 0.0, 1.0)];
    let names = ["a", "b", "c"];
    let runs: Vec<(&str, &Record)> = names.into_iter().zip(&all).collect();
    let found = apart(&runs, G, 0.0).expect("a fault");
    assert_eq!(found.place, "run c");
    assert!(found.evidence.starts_with("V_W is 1.2") && found.evidence.contains("s early in c"), "{}", found.evidence);
    assert!(apart(&runs[..2], G, 0.0).is_none() && apart(&runs[2..], G, 0.0).is_none());
}

/// A slope through three blocks by hand: left = 2 slope + (1, -1 | 1, 1 | -2, 0), information 6, residuals' sums 0, 2, -2 about 2.
#[test]
fn exact_slope_with_blocks() {
    let row = |block: usize, left: f64| Row { left, slope: 1.0, block };
    let rows = vec![row(0, 3.0), row(0, 1.0), row(1, 3.0), row(1, 3.0), row(2, 0.0), row(2, 2.0)];
    let (estimate, std, freedom) = slope(&[rows]).expect("three blocks");
    assert!((estimate - 2.0).abs() < 1e-14 && (freedom - 2.0).abs() < 1e-14);
    assert!((std - (8.0_f64 * 3.0 / 2.0).sqrt() / 6.0).abs() < 1e-14, "{std}");
}
