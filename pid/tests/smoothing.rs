//! pid tests: smoothers against closed forms. In: polynomials, sines, noise. Out: values and derivatives that must come back.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;
use windfall_model::Record;
use windfall_pid::PidError;
use windfall_pid::smooth::{Smoothed, Smoother, smooth};

const DT: f64 = 1.0 / 150.0;

/// A record whose channel X (and all others alike) is f.
fn record(n: usize, f: impl Fn(f64) -> f64) -> Record {
    let t_s: Vec<f64> = (0..n).map(|i| i as f64 * DT).collect();
    let x: Vec<f64> = t_s.iter().map(|t| f(*t)).collect();
    let three = || [x.clone(), x.clone(), x.clone()];
    Record {
        position_m: three(),
        attitude_rad: three(),
        vw_m_s: x.clone(),
        ps_pa: vec![101_325.0; n],
        ts_k: vec![290.0; n],
        t_s,
        ..Record::default()
    }
}

fn noisy(n: usize, f: impl Fn(f64) -> f64, std: f64, seed: u64) -> Record {
    let mut r = record(n, f);
    let mut g = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let [x, y, z] = &mut r.position_m;
    let [a, b, c] = &mut r.attitude_rad;
    for series in [x, y, z, a, b, c, &mut r.vw_m_s] {
        for v in series {
            let e: f64 = StandardNormal.sample(&mut g);
            *v += std * e;
        }
    }
    r
}

/// Largest errors of value, rate and second derivative over all channels and samples.
fn errors(s: &Smoothed, f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let mut worst: [f64; 3] = [0.0; 3];
    for c in &s.channels {
        for (i, t) in s.t_s.iter().enumerate() {
            let truth = f(*t);
            for (k, found) in [c.value[i], c.rate[i], c.second[i]].into_iter().enumerate() {
                let error = (found - truth[k]).abs();
                assert!(error.is_finite());
                worst[k] = worst[k].max(error);
            }
        }
    }
    worst
}

/// A polynomial of degree 7 in t − 0.4 with its derivatives, |t − 0.4| < 0.7.
fn septic(t: f64) -> [f64; 3] {
    const C: [f64; 8] = [0.3, -1.1, 2.0, 0.7, -3.0, 1.9, 4.0, -2.3];
    let x = t - 0.4;
    let sum = |f: &dyn Fn(usize) -> f64| (0..8).map(|k| C[k] * f(k)).sum::<f64>();
    let p = |k: usize, d: usize| if k < d { 0.0 } else { x.powi(i32::try_from(k - d).expect("small")) };
    [sum(&|k| p(k, 0)), sum(&|k| k as f64 * p(k, 1)), sum(&|k| (k as f64) * (k as f64 - 1.0) * p(k, 2))]
}

#[test]
fn exact_spline_and_local_polynomial_reproduce_a_polynomial_of_their_degree_to_the_ends() {
    let r = record(150, |t| septic(t)[0]);
    let smoothers = [
        Smoother::Spline { knot_s: 2.0 * DT },
        Smoother::Spline { knot_s: 0.1 },
        Smoother::Local { half_width_s: [0.1; 7], degree: 7 },
        Smoother::Auto,
    ];
    for smoother in smoothers {
        let e = errors(&smooth(&r, &smoother).expect("a good record"), septic);
        // Rounding 1e-16 amplified at the ends by the square of the polynomial's derivative bound: 2·7²/knot, squared.
        assert!(e[0] < 1e-12 && e[1] < 1e-9 && e[2] < 1e-5, "{smoother:?}: {e:?}");
    }
}

fn sine(t: f64) -> [f64; 3] {
    let w = 2.0 * PI * 3.0;
    [(w * t + 0.3).sin(), w * (w * t + 0.3).cos(), -w * w * (w * t + 0.3).sin()]
}

#[test]
fn exact_thesis_series_of_a_trend_and_its_own_sines_comes_back_with_derivatives() {
    let n = 301;
    let length = (n - 1) as f64 * DT;
    let (w3, w7) = (3.0 * PI / length, 7.0 * PI / length);
    let f = |t: f64| {
        [
            0.4 - 0.9 * t + 0.5 * (w3 * t).sin() - 0.2 * (w7 * t).sin(),
            -0.9 + 0.5 * w3 * (w3 * t).cos() - 0.2 * w7 * (w7 * t).cos(),
            -0.5 * w3 * w3 * (w3 * t).sin() + 0.2 * w7 * w7 * (w7 * t).sin(),
        ]
    };
    let s = smooth(&record(n, |t| f(t)[0]), &Smoother::Thesis { cutoffs_hz: [f64::INFINITY; 7] }).expect("good");
    let e = errors(&s, f);
    // Rounding 1e-16 times ω² up to (π/Δt)² = 2e5, over the root of 300 terms.
    assert!(e[0] < 1e-13 && e[1] < 1e-11 && e[2] < 1e-8, "{e:?}");
}

#[test]
fn exact_wiener_filter_is_one_half_at_its_cutoff_and_ends_at_one_percent() {
    let n = 301;
    let length = (n - 1) as f64 * DT;
    let f = |k: f64| k / (2.0 * length);
    let amplitude = |k: f64, cutoff: f64| {
        let r = record(n, |t| (2.0 * PI * f(k) * t).sin());
        let s = smooth(&r, &Smoother::Thesis { cutoffs_hz: [cutoff; 7] }).expect("good");
        let x = &s.channels[2].value;
        2.0 / (n - 1) as f64 * x.iter().zip(&s.t_s).map(|(x, t)| x * (2.0 * PI * f(k) * t).sin()).sum::<f64>()
    };
    // Eqs 3.11-3.12: η = 1 at the cutoff; η = 1/8 at twice it; η = 8 at half; η ≤ 0.01 is cut.
    assert!((amplitude(6.0, f(6.0)) - 0.5).abs() < 1e-12);
    assert!((amplitude(12.0, f(6.0)) - (1.0 / 64.0) / (1.0 / 64.0 + 1.0)).abs() < 1e-12);
    assert!((amplitude(3.0, f(6.0)) - 64.0 / 65.0).abs() < 1e-12);
    assert!(amplitude(28.0, f(6.0)).abs() < 1e-12);
    assert!(amplitude(27.0, f(6.0)) > 1e-5);
}

#[test]
fn recover_noise_level_by_every_smoother() {
    let r = noisy(3000, |t| sine(t / 3.0)[0], 0.01, 7);
    let smoothers = [Smoother::Auto, Smoother::ThesisAuto, Smoother::Local { half_width_s: [0.1; 7], degree: 4 }];
    for smoother in smoothers {
        let s = smooth(&r, &smoother).expect("good");
        for std in s.noise_std {
            // 3000 samples: standard deviation known to 1.3 %, four of them, and 1 % for the bandwidth that the thesis' filter keeps.
            assert!((std / 0.01 - 1.0).abs() < 0.06, "{smoother:?}: {std}");
        }
    }
}

#[test]
fn law_automatic_bandwidth_follows_signal_and_noise() {
    let bandwidth = |f: f64, std: f64| {
        smooth(&noisy(3000, |t| (2.0 * PI * f * t).sin(), std, 3), &Smoother::Auto).expect("good").bandwidth_hz[0]
    };
    assert!(bandwidth(1.0, 0.01) > 1.0 && bandwidth(1.0, 0.01) < 8.0, "{}", bandwidth(1.0, 0.01));
    assert!(bandwidth(4.0, 0.01) > 2.0 * bandwidth(1.0, 0.01));
    assert!(bandwidth(1.0, 0.0001) > bandwidth(1.0, 0.05));
    let thesis = |f: f64| {
        smooth(&noisy(3000, |t| (2.0 * PI * f * t).sin(), 0.01, 3), &Smoother::ThesisAuto).expect("good").bandwidth_hz[0]
    };
    assert!(thesis(1.0) > 1.0 && thesis(4.0) > 4.0 && thesis(1.0) < thesis(4.0), "{} {}", thesis(1.0), thesis(4.0));
}

#[test]
fn law_weights_are_the_ratio_of_second_derivative_scatter() {
    for smoother in [Smoother::Spline { knot_s: 0.1 }, Smoother::Local { half_width_s: [0.1; 7], degree: 4 }] {
        let runs: Vec<Smoothed> =
            (0..300).map(|k| smooth(&noisy(200, |_| 0.0, 1.0, 100 + k), &smoother).expect("good")).collect();
        let scatter =
            |i: usize| runs.iter().flat_map(|s| s.channels.iter().map(move |c| c.second[i].powi(2))).sum::<f64>().sqrt();
        let middle = (85..115).map(scatter).sum::<f64>() / 30.0;
        for i in [0, 3, 10, 189, 199] {
            // 2100 draws: ratio known to 1.6 %; the spline's scatter varies by some per cent between knots.
            let ratio = runs[0].weight[i] * scatter(i) / middle;
            assert!((0.85..1.15).contains(&ratio) || runs[0].weight[i] > 0.999, "{smoother:?}, sample {i}: {ratio}");
        }
    }
}

fn fault(change: impl Fn(&mut Record)) -> PidError {
    let mut r = record(100, |t| t);
    change(&mut r);
    smooth(&r, &Smoother::Auto).expect_err("a fault was put in")
}

#[test]
fn exact_faults_of_a_record_are_named() {
    assert!(matches!(fault(|r| r.attitude_rad[1][42] = f64::NAN), PidError::NotFinite { channel: "Ry_deg", index: 42, .. }));
    assert!(matches!(fault(|r| r.ts_k[7] = f64::INFINITY), PidError::NotFinite { channel: "Ts_K", index: 7, .. }));
    assert!(matches!(fault(|r| r.vw_m_s.truncate(99)), PidError::Length { channel: "VW_m_s", found: 99, expected: 100 }));
    assert!(matches!(fault(|r| r.t_s[50] += 0.02 * DT), PidError::NotUniform { index: 50, .. }));
    assert!(matches!(fault(|r| r.t_s.swap(50, 51)), PidError::NotUniform { index: 50, .. }));
    assert!(matches!(fault(|r| r.t_s[60..].iter_mut().for_each(|t| *t += 1.0)), PidError::NotUniform { .. }));
    let short = smooth(&record(10, |t| t), &Smoother::Auto).expect_err("ten samples");
    assert!(matches!(short, PidError::TooFewSamples { samples: 10, .. }));
    let text = fault(|r| r.attitude_rad[1][42] = f64::NAN).to_string();
    assert!(text.contains("Ry_deg") && text.contains("42") && text.contains("bridge"), "{text}");
}

#[test]
fn exact_settings_out_of_range_are_refused() {
    let r = record(100, |t| t);
    let smoothers = [
        Smoother::Spline { knot_s: DT },
        Smoother::Spline { knot_s: f64::NAN },
        Smoother::Local { half_width_s: [0.1; 7], degree: 1 },
        Smoother::Local { half_width_s: [-0.1; 7], degree: 4 },
        Smoother::Thesis { cutoffs_hz: [0.0; 7] },
        Smoother::Thesis { cutoffs_hz: [f64::NAN; 7] },
    ];
    for smoother in smoothers {
        assert!(matches!(smooth(&r, &smoother), Err(PidError::Setting { .. })), "{smoother:?}");
    }
}

/// Of a window the thesis smooths the whole recording and crops then: the same bits as the crop of the whole, smoothed; cropped first, the
/// reflection at the window's start takes the motion there for an end. Splines see the window alone.
#[test]
fn law_the_thesis_smooths_the_whole_recording() {
    let f = |t: f64| (6.0 * (t - 4.0)).cos() * (-(t - 4.0).powi(2)).exp() + 0.1 * t;
    let whole = noisy(1500, f, 0.01, 5);
    let (rows, thesis) = (600..1300, Smoother::Thesis { cutoffs_hz: [2.5; 7] });
    let window = whole.window(rows.clone());
    let (all, cropped) = (smooth(&whole, &thesis).expect("good"), smooth(&window, &thesis).expect("good"));
    let alone = Record { recording: None, ..window.clone() };
    let first = smooth(&alone, &thesis).expect("good");
    for (c, all) in all.channels.iter().enumerate() {
        for (a, b) in [
            (&all.value, &cropped.channels[c].value),
            (&all.rate, &cropped.channels[c].rate),
            (&all.second, &cropped.channels[c].second),
        ] {
            assert_eq!(a[rows.clone()], b[..]);
        }
        // The odd reflection has no curvature at an end; the motion has −36.
        assert!(first.channels[c].second[0].abs() < f64::MIN_POSITIVE);
        assert!(cropped.channels[c].second[0] < -20.0, "{}", cropped.channels[c].second[0]);
    }
    assert_eq!(smooth(&window, &Smoother::Auto), smooth(&alone, &Smoother::Auto));
    // Turns of the roll are counted from the window's own; another record than the recording's stands for itself.
    let mut turned = window.clone();
    let recording = turned.recording.take();
    turned.attitude_rad[0].iter_mut().for_each(|a| *a += 2.0 * PI);
    turned.recording = recording;
    let roll = &smooth(&turned, &thesis).expect("good").channels[3].value;
    assert!((roll[100] - cropped.channels[3].value[100] - 2.0 * PI).abs() < 1e-12);
    let mut changed = window;
    changed.channels_mut()[0][3] += 0.0;
    assert_eq!(smooth(&changed, &thesis), Ok(first));
}

/// A quadratic through five samples gives a parabola's derivative to rounding, at the ends as well; and of a sine of ω the derivative times
/// (2 sin ωh + 4 sin 2ωh)/(10 ωh), done twice for the second.
#[test]
fn exact_unsmoothed_derivatives() {
    let s = smooth(&record(60, |t| 0.3 - 2.0 * t + 1.7 * t * t), &Smoother::Unsmoothed).expect("good");
    let worst = errors(&s, |t| [0.3 - 2.0 * t + 1.7 * t * t, -2.0 + 3.4 * t, 3.4]);
    // Values of 1 rounded to 1e-16, over samples of 1/150 s, once and twice.
    assert!(worst[0] == 0.0 && worst[1] < 1e-12 && worst[2] < 1e-9, "{worst:?}");
    let w = 2.0 * PI;
    let s = smooth(&record(600, |t| (w * t).sin()), &Smoother::Unsmoothed).expect("good");
    let gain = (2.0 * (w * DT).sin() + 4.0 * (2.0 * w * DT).sin()) / (10.0 * w * DT);
    for i in 10..590 {
        let t = i as f64 * DT;
        assert!((s.channels[0].rate[i] - gain * w * (w * t).cos()).abs() < 1e-10);
        assert!((s.channels[0].second[i] + gain * gain * w * w * (w * t).sin()).abs() < 1e-8);
    }
}
