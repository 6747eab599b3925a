//! likelihood tests: the pitch mode and loads by their formulas, lines put into series and found again.

use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

const STREAM: HumStream = HumStream { density_kg_m3: 1.13, speed_m_s: 7.4, swing_hz: 0.0 };

fn plant() -> Plant {
    windfall_scenarios::read_bundled("sage-unperturbed").expect("a bundled scenario").declared_plant
}

fn white(seed: u64, n: usize, std: f64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..n).map(|_| std * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng)).collect()
}

/// A body without a tether or damping: `ω² = −½ρV² S d C_m(α)/(α I_yy)` at α = 0.02, `C_m = a sin α + b sin³ α`. Where that
/// pushes away from zero there is no mode.
#[test]
fn exact_pitch_mode() {
    for (a, swings) in [(-2.0655, true), (1.3, false)] {
        let mut plant = plant();
        plant.tether = None;
        plant.vehicle.inertia.yy = 0.0173;
        for (name, value) in [("Cm_sin", a), ("Cm_sin3", 2.5278), ("Cm_1", 0.0), ("Cm_2", 0.0)] {
            let place = plant.aero.structure.index(name).expect("a parameter");
            plant.aero.values[place] = value;
        }
        let (d, sine) = (plant.vehicle.diameter_m, 0.02_f64.sin());
        let moment = 0.5 * 1.13 * 7.4 * 7.4 * (TAU / 8.0 * d * d) * d * (a * sine + 2.5278 * sine.powi(3));
        let hz = if swings { (-moment / 0.02 / 0.0173).sqrt() / TAU } else { 0.0 };
        let found = pitch_hz(&plant, STREAM);
        // Rounding of a difference of rates of order one over an angle of 0.02.
        assert!((found - hz).abs() < 1e-12, "{found} {hz}");
    }
}

/// The load that shakes a body of its inertia (`F = m (2πf)² a`, `M = I (2πf)² a`), as a coefficient: a line is the instrument's
/// above ten times what is plausible and five times the faster mode.
#[test]
fn exact_lines_that_no_load_makes() {
    let plant = plant();
    let v = &plant.vehicle;
    let (hz, qs) = (31.0, 0.5 * 1.13 * 7.4 * 7.4 * TAU / 8.0 * v.diameter_m * v.diameter_m);
    let of = |channel, hz, amplitude| of_instrument(&plant, STREAM, channel, hz, amplitude);
    for (channel, inertia, plausible) in [
        (1, v.mass_kg, 0.05),
        (3, v.inertia.xx / v.diameter_m, 0.005),
        (4, v.inertia.yy / v.diameter_m, 0.02),
        (5, v.inertia.yy / v.diameter_m, 0.02),
    ] {
        let load = |amplitude: f64| inertia * (TAU * hz) * (TAU * hz) * amplitude / qs / plausible;
        let found = load_of(&plant, STREAM, channel, hz, 3e-4);
        assert!((found / load(3e-4) - 1.0).abs() < 1e-13, "{channel}: {found}");
        let border = 10.0 / load(1.0);
        assert!(!of(channel, hz, 0.99 * border) && of(channel, hz, 1.01 * border), "{channel}");
    }
    let pitch = pitch_hz(&plant, STREAM);
    for swing_hz in [0.0, 3.0 * pitch] {
        let (border, stream) = (5.0 * pitch.max(swing_hz), HumStream { swing_hz, ..STREAM });
        assert!(!of_instrument(&plant, stream, 4, 0.99 * border, 1.0) && of_instrument(&plant, stream, 4, 1.01 * border, 1.0));
    }
}

/// Fast lines in two channels go, one that loads might make stays. A thousandth of an ordinate's width of 0.075 Hz, and noise of a
/// fiftieth of a line over 2000 samples.
#[test]
fn recover_lines_of_a_record() {
    let n = 2000;
    let t_s: Vec<f64> = (0..n).map(|i| i as f64 / 150.0).collect();
    let noise: Vec<Vec<f64>> = (0..POSE as u64).map(|seed| white(seed, n, 1e-5)).collect();
    let channel =
        |c: usize, of: &dyn Fn(f64) -> f64| -> Vec<f64> { t_s.iter().zip(&noise[c]).map(|(t, e)| of(*t) + e).collect() };
    let place = |c: usize| channel(c, &|t| 0.05 * (1.3 * t).sin());
    let mut record = Record {
        position_m: [0, 1, 2].map(place),
        attitude_rad: [
            channel(3, &|t| 0.5 * t),
            channel(4, &|t| 0.1 * (TAU * 0.9 * t).sin() + 0.02 * (TAU * 4.2 * t).cos()),
            channel(5, &|t| 0.1 * (TAU * 0.9 * t).cos()),
        ],
        vw_m_s: vec![7.4; n],
        ps_pa: vec![98_000.0; n],
        ts_k: vec![301.0; n],
        t_s: t_s.clone(),
        ..Record::default()
    };
    let clean = record.clone();
    let lines = [(1, 43.7, [4e-4, -3e-4]), (5, 50.3, [1e-3, 2.4e-3])];
    for (c, hz, [a, b]) in lines {
        let series = &mut *record.channels_mut()[c];
        t_s.iter().zip(series).for_each(|(t, x)| *x += a * (TAU * hz * t).cos() + b * (TAU * hz * t).sin());
    }
    let found = take_off(&mut record, &plant());
    assert_eq!(found.len(), lines.len(), "{found:?}");
    for (hum, (c, hz, [a, b])) in found.iter().zip(lines) {
        let size = f64::hypot(a, b);
        assert!(hum.channel == c && (hum.hz - hz).abs() < 2e-4 && (hum.amplitude / size - 1.0).abs() < 0.01, "{hum:?}");
        let left = record.channels()[c]
            .iter()
            .zip(clean.channels()[c])
            .map(|(x, y)| (x - y).abs())
            .max_by(f64::total_cmp)
            .unwrap_or(f64::NAN);
        assert!(left < 0.01 * size, "{c}: {left}");
    }
    assert_eq!(record.attitude_rad[1], clean.attitude_rad[1]);
}

/// Ordinates beside are the quantiles of an exponential of mean 1.7 (upper median of 74: 2 %); those of the line's own lobe and
/// those far away are larger by far.
#[test]
fn exact_level_beside_a_line() {
    let (k, n) = (61, 2 * (BESIDE - LOBE));
    let mut power = vec![1e6; 140];
    let beside = (k - BESIDE..=k + BESIDE).filter(|i| i.abs_diff(k) > LOBE);
    beside.enumerate().for_each(|(i, at)| power[at] = -1.7 * (1.0 - ((31 * i % n) as f64 + 0.5) / n as f64).ln());
    power[k] = 1.7 * 23.0;
    assert!((over(&power, k) / 23.0 - 1.0).abs() < 0.025, "{}", over(&power, k));
}

/// A trend is one number in all differences, which Hann's window keeps to the lowest two ordinates: the line is where it was.
#[test]
fn law_a_trend_hides_no_line() {
    let series: Vec<f64> = white(1, 2500, 1e-3).iter().enumerate().map(|(i, e)| 5e-4 * (2.31 * i as f64).cos() + e).collect();
    let steep: Vec<f64> = series.iter().enumerate().map(|(i, x)| x + 3.0 - 100.0 * i as f64).collect();
    let [plain, beside] = [series, steep].map(|s| super::line(&s).expect("a line"));
    assert!((plain - 2.31).abs() < 5e-4 && (plain - beside).abs() < 1e-5, "{plain} {beside}");
}

/// Noise alone is no line; nor is what stands where its lobe or its surroundings are not whole, at either end of the spectrum.
#[test]
fn law_noise_is_no_line() {
    for seed in 0..8 {
        assert_eq!(super::line(&white(seed, 1500, 0.3)), None, "{seed}");
    }
    let n = 700;
    let at = |ordinate: usize| {
        let w = TAU * ordinate as f64 / n as f64;
        let series: Vec<f64> = white(3, n + 1, 1e-6).iter().enumerate().map(|(i, e)| (w * i as f64 + 0.4).cos() + e).collect();
        super::line(&series).map(|found| (found - w).abs() < 1e-4)
    };
    // Ordinates up to n/2.
    assert_eq!([40, 46, 345, 348].map(at), [None, Some(true), Some(true), None]);
}

/// Whole turns: squares under Hann's window have a mean of a quarter exactly.
#[test]
fn exact_amplitudes_of_whole_turns() {
    let (a, b, w) = (3.7, -5.3, TAU * 37.0 / 500.0);
    let series: Vec<f64> = (0..501).map(|i| a * (w * i as f64).cos() + b * (w * i as f64).sin() + 11.0).collect();
    let (c, s) = sinusoid(&series, w);
    assert!((c - a).abs() < 1e-11 && (s - b).abs() < 1e-11, "{c} {s}");
}

#[test]
fn exact_swing_is_the_largest_motion() {
    let angles: Vec<Vec<f64>> = [0.2, 0.1]
        .map(|a| (0..3000).map(|i| 0.05 + a * (TAU * 0.8 * i as f64 / 150.0).sin() + 1e-3 * (1.7 * i as f64).cos()).collect())
        .into();
    // An ordinate is 1/20 Hz wide.
    assert!((swing_hz(&angles, 1.0 / 150.0) - 0.8).abs() < 0.03);
    assert!(swing_hz(&[], 1.0).abs() < 1e-12);
}

#[test]
fn recover_a_line_beside_motion() {
    let (a, b, w) = (3e-4, -4e-4, 0.6661);
    let line = |i: usize| a * (w * i as f64).cos() + b * (w * i as f64).sin();
    let motion = |i: usize| 0.3 * (0.06 * i as f64).sin() + 1e-4 * i as f64;
    let series: Vec<f64> = (0..2500).map(|i| motion(i) + line(i)).collect();
    let found = super::line(&series).expect("a line");
    // A thousandth of an ordinate's width is 2.5e-6; Hann's sidelobes of the motion, 0.3 m, are under 1e-3 of the line.
    assert!((found - w).abs() < 1e-5, "{found}");
    let (c, s) = sinusoid(&series, found);
    assert!((c - a).abs() < 1e-2 * 5e-4 && (s - b).abs() < 1e-2 * 5e-4, "{c} {s}");
}
