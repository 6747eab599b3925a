use super::super::testing::{butterworth, coloured, forward_backward, motion, resonance, white};
use super::*;

const RATE_HZ: f64 = 150.0;
const ROWS: usize = 2400;
const STD: f64 = 7.5e-4;

fn channels(seed: u64, of: &dyn Fn(Vec<f64>) -> Vec<f64>) -> Vec<(Vec<f64>, f64)> {
    let one = |c: u64| {
        let noise = white(1000 * seed + c, ROWS + 400, STD);
        let raw: Vec<f64> = noise.iter().zip(motion(ROWS + 400, RATE_HZ, 0.2, c)).map(|(n, m)| n + m).collect();
        (of(raw)[200..200 + ROWS].to_vec(), STD)
    };
    (0..3).map(one).collect()
}

/// Corners of filters of known order, forward and backward or once. Errors: 64 ordinates of three channels below a corner of 12 Hz tell
/// it to 3 % or better; two of these.
#[test]
fn recover_corners_of_several_orders() {
    for corner_hz in [8.0, 12.0, 25.0, 40.0] {
        for order in [2, 3, 4] {
            for twice in [true, false] {
                let filter = |x: Vec<f64>| {
                    let section = |x: &[f64]| butterworth(x, order, corner_hz / RATE_HZ);
                    if twice { forward_backward(&x, &section) } else { section(&x) }
                };
                let found = low_pass(&channels(7, &filter), RATE_HZ).unwrap_or_else(|| panic!("{corner_hz} {order} {twice}"));
                let truth =
                    LowPass { corner_hz, order: order as i32, runs: if twice { 2 } else { 1 }, rate_hz: RATE_HZ, gain: 0.0 };
                let ratio = found.half_power_hz() / truth.half_power_hz();
                assert!((ratio - 1.0).abs() < 0.06, "{corner_hz} Hz, {order}, twice {twice}: {ratio} {found:?}");
            }
        }
    }
}

/// No filter in 300 groups of white, coloured, quantised noise, noise with the line of the mains, with a strong one, and with a resonance: at
/// most 1 % with 95 % confidence (3/300).
#[test]
fn law_sound_noise_is_no_filter() {
    for seed in 0..50 {
        let with_line = |x: Vec<f64>, size: f64, hz: f64| -> Vec<f64> {
            x.iter().enumerate().map(|(i, v)| v + size * STD * (TAU * hz * i as f64 / RATE_HZ).sin()).collect()
        };
        let sorts: [&dyn Fn(Vec<f64>) -> Vec<f64>; 6] = [
            &|x| x,
            &|x| x.iter().zip(coloured(seed, x.len(), 2.0 * STD, 0.9)).map(|(a, b)| a + b).collect(),
            &|x| x.iter().map(|v| (v / STD).round() * STD).collect(),
            &|x| with_line(x, 1.0, 50.0),
            &|x| with_line(x, 30.0, 22.3),
            &|x| x.iter().zip(resonance(seed, x.len(), 2.0 * STD, 12.0 / RATE_HZ, 8.0)).map(|(a, b)| a + b).collect(),
        ];
        for (k, sort) in sorts.iter().enumerate() {
            let found = low_pass(&channels(seed, sort), RATE_HZ);
            assert!(found.is_none(), "seed {seed}, sort {k}: {found:?}");
        }
    }
}

/// A motion without noise is not noise that was smoothed, whatever its spectrum's upper end.
#[test]
fn law_motion_alone_is_no_filter() {
    let one = |c: u64| ((0..ROWS).map(|i| (1e6 * motion(ROWS, RATE_HZ, 0.2, c)[i]).round() / 1e6).collect(), STD);
    let found = low_pass(&(0..3).map(one).collect::<Vec<_>>(), RATE_HZ);
    assert!(found.is_none(), "{found:?}");
}

/// Half of the power of a forward and backward pass of the second order is at 0.802 of the corner, where that is far below the fold.
#[test]
fn exact_half_power() {
    let f = LowPass { corner_hz: 1.0, order: 2, runs: 2, rate_hz: 1e4, gain: 0.0 };
    assert!(
        (f.half_power_hz() - (2.0_f64.sqrt() - 1.0).powf(0.25)).abs() < 1e-6 && (f.power(f.half_power_hz()) - 0.5).abs() < 1e-12
    );
}

/// Bands whose powers are those of a process by its transfer function: its own form costs what the powers themselves do, the other form and white
/// noise far more.
#[test]
fn exact_forms_are_the_spectra_of_their_processes() {
    let saturated = |bands: &[Band]| bands.iter().map(|b| b.weight * (1.0 + b.power.ln())).sum::<f64>();
    let of = |power: &dyn Fn(f64) -> f64| -> Vec<Band> {
        (0..40)
            .map(|k| 2.0 * 1.09_f64.powi(k))
            .filter(|hz| *hz < 74.0)
            .map(|hz| Band { hz, power: power(hz), weight: 20.0 })
            .collect()
    };
    // x[n] = 0.8 x[n-1] + e[n].
    let first_order = of(&|hz| (Complex::new(1.0, 0.0) - Complex::from_polar(0.8, -TAU * hz / RATE_HZ)).norm_sqr().recip());
    // x'' + (w/q) x' + w² x = w² e at the seventeenth band, as its transfer function has it.
    let (own, q) = (2.0 * 1.09_f64.powi(16), QUALITIES[0]);
    let second_order = of(&|hz| {
        let s = Complex::new(0.0, hz / own);
        (s * s + s / q + 1.0).norm_sqr().recip()
    });
    let white = |bands: &[Band]| with_floor(bands, |_| 0.0);
    let over = |cost: f64, bands: &[Band]| cost - saturated(bands);
    let of_first = [super::coloured as fn(&[Band], f64) -> f64, |b, _| resonant(b), |b, _| with_floor(b, |_| 0.0)]
        .map(|f| over(f(&first_order, RATE_HZ), &first_order));
    let of_second = [
        over(resonant(&second_order), &second_order),
        over(super::coloured(&second_order, RATE_HZ), &second_order),
        over(white(&second_order), &second_order),
    ];
    assert!(
        of_first[0] < 1.0 && of_first[2] > 50.0 && of_second[0] < 1.0 && of_second[1] > 50.0 && of_second[2] > 50.0,
        "{of_first:?} {of_second:?}"
    );
}
