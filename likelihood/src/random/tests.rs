//! likelihood tests: covariances and transitions of random inputs against Lyapunov's equation, closed forms and densities.

use super::*;

/// The form's own variance is what was asked for, at every length, the lag takes some of it, and its covariance stays what it is
/// from step to step.
#[test]
fn exact_stationary_covariance() {
    for time_s in [0.01, 0.08, 0.5] {
        let d = Disturbance { entry: Entry::AirVelocity(1), rms: 0.3, shape: Shape::DrydenLateral { time_s } };
        let i = input(&d, 0.02, Spectra::default());
        // Displacement and rate are uncorrelated: x² + 3 (T ẋ)².
        assert!((i.stationary[1][1] + 3.0 * i.stationary[2][2] - 0.09).abs() < 1e-14);
        assert!((0.6..1.0).contains(&(i.stationary[0][0] / 0.09)));
        let of = |b: &Block| Rates::from_fn(|r, c| b[r][c]);
        let (phi, p0) = (of(&i.whole), of(&i.stationary));
        let next = phi * p0 * phi.transpose() + of(&i.added);
        // The shortest step's series leaves (step/lag)⁵/120 of the fastest lag.
        assert!((next - p0).amax() < 1e-8 * p0.amax(), "{time_s}: {next} {p0}");
        let (a, b, _) = gust(time_s, 3.0_f64.sqrt());
        let p = of(&i.stationary);
        let left = a * p + p * a.transpose();
        // All of the driving noise is in the last state.
        let driven = left[(2, 2)];
        assert!(driven < 0.0 && (left - b * b.transpose() * driven).amax() < 1e-9 * driven.abs());
    }
}

/// Response of the states at a frequency, `(jω - A)⁻¹ b`.
fn response(a: &Rates, b: &States, w: f64) -> SVector<nalgebra::Complex<f64>, ORDER> {
    let m = SMatrix::<nalgebra::Complex<f64>, ORDER, ORDER>::from_fn(|r, c| {
        nalgebra::Complex::new(-a[(r, c)], if r == c { w } else { 0.0 })
    });
    m.lu().solve(&b.map(|x| nalgebra::Complex::new(x, 0.0))).expect("a stable filter")
}

/// Von Kármán's density, both components, within what the ratio leaves of it (4 % up to ten times the corner).
#[test]
fn exact_von_karman() {
    let (time_s, rms) = (0.08, 0.3);
    for (shape, lateral) in [(Shape::DrydenLongitudinal { time_s }, false), (Shape::DrydenLateral { time_s }, true)] {
        let i = input(
            &Disturbance { entry: Entry::AirVelocity(1), rms, shape },
            0.02,
            Spectra { von_karman: true, ..Spectra::default() },
        );
        let of = if lateral { &ACROSS } else { &ALONG };
        let (a, _, form) = ratio(time_s, of);
        let p = Rates::from_fn(|r, c| i.stationary[r][c]);
        assert!(((form.transpose() * p * form)[(0, 0)] / (of.share * rms * rms) - 1.0).abs() < 1e-9);
        let left = a * p + p * a.transpose();
        let (last, driven) = (i.order - 1, left[(i.order - 1, i.order - 1)]);
        for x in [0.1, 1.0, 3.0, 10.0] {
            let w = x / time_s;
            let states = response(&a, &States::ith(last, 1.0), w);
            let h: nalgebra::Complex<f64> = (0..ORDER).map(|k| states[k] * form[k]).sum();
            let found = -driven * h.norm_sqr() / std::f64::consts::PI;
            let y = (1.339 * x).powi(2);
            let expected = rms * rms * time_s / std::f64::consts::PI
                * if lateral { (1.0 + 8.0 / 3.0 * y) / (1.0 + y).powf(11.0 / 6.0) } else { 2.0 / (1.0 + y).powf(5.0 / 6.0) };
            assert!((found / expected - 1.0).abs() < 0.04, "{lateral} {x}: {found} for {expected}");
        }
    }
}

/// A band's variance is what was asked for, its output's rate has no white noise in it, and its density is the filter's: with
/// gentle edges the model's own, with steep ones σ²/(1 + ε² T₃²) over the same with one, T₃ Chebyshev's polynomial of `(ω/ω₀ -
/// ω₀/ω)/b`.
#[test]
fn exact_band() {
    let (centre_rad_s, bandwidth_rad_s) = (12.0, 16.0);
    let d = Disturbance { entry: Entry::AirVelocity(1), rms: 0.3, shape: Shape::Band { centre_rad_s, bandwidth_rad_s } };
    let epsilon = 1.0 / (3.0 * 0.4_f64.atanh()).sinh();
    let half = ((1.0 / epsilon).acosh() / 3.0).cosh();
    let chebyshev = |w: f64| {
        let x = half * (w / centre_rad_s - centre_rad_s / w).abs() / (bandwidth_rad_s / centre_rad_s);
        1.0 / (1.0 + (epsilon * (4.0 * x.powi(3) - 3.0 * x)).powi(2))
    };
    for (steep, edges) in [(false, &BUTTERWORTH[..]), (true, &CHEBYSHEV[..])] {
        let i = input(&d, 0.02, Spectra { steep, ..Spectra::default() });
        assert!((i.stationary[0][0] - 0.09).abs() < 1e-14);
        let (order, (a, b, _)) = band(centre_rad_s, bandwidth_rad_s / centre_rad_s, edges);
        let of = |m: &Block| Rates::from_fn(|r, c| m[r][c]);
        let left = a * of(&i.stationary) + of(&i.stationary) * a.transpose();
        let driven = left[(order - 2, order - 2)];
        assert!(b[0].abs() < 1e-300 && driven < 0.0 && (left - b * b.transpose() * driven).amax() < 1e-9 * driven.abs());
        let density = |w: f64| {
            let h = response(&a, &b, w)[0];
            // One-sided over ω: two sides of |H|² over 2π, driven by white noise of that size.
            -driven * h.norm_sqr() / std::f64::consts::PI
        };
        for w in [3.0, 9.0, 12.0, 22.0, 40.0] {
            let expected = if steep { chebyshev(w) / chebyshev(12.0) * density(12.0) } else { d.density(w) };
            assert!((density(w) / expected - 1.0).abs() < 1e-9, "{steep} {w}: {} for {expected}", density(w));
        }
        // Half power at the edges of the stated width.
        if steep {
            let edge = 0.5 * (bandwidth_rad_s + (bandwidth_rad_s.powi(2) + 4.0 * centre_rad_s.powi(2)).sqrt());
            assert!((density(edge) / density(12.0) - 0.5).abs() < 1e-9);
        }
    }
}

/// The integral of white noise behind a first-order lag has the variance of textbooks, in steps short and long beside the lag.
#[test]
fn exact_variance_of_an_integral() {
    for (lag, h) in [(0.5_f64, 0.02_f64), (0.02, 0.02), (0.002, 0.02)] {
        let mut a = -Rates::identity();
        a[(0, 0)] = -1.0 / lag;
        let d = driven(&a, &States::x(), h);
        let e = (-h / lag).exp();
        // ∫₀ʰ (lag (1 - e^{-s/lag}))² ds.
        let variance = lag * lag * (h - 2.0 * lag * (1.0 - e) + 0.5 * lag * (1.0 - e * e));
        assert!((d.added[(ORDER, ORDER)] / variance - 1.0).abs() < 1e-7, "{lag}");
        assert!((d.sums[0][(0, 0)] / (lag * (1.0 - e)) - 1.0).abs() < 1e-9);
        // Simpson's sum of the stages is that integral too.
        let [start, first, middle, third, end] = d.stages.map(|m| m[(0, 0)]);
        let simpson = h / 12.0 * (start + 4.0 * first + 2.0 * middle + 4.0 * third + end);
        assert!((simpson - d.sums[0][(0, 0)]).abs() < 1e-12);
        // And so is what two halves make of its integral.
        let twice = h * h / 12.0 * (start + 3.0 * first + middle + third);
        assert!((twice - d.sums[1][(0, 0)]).abs() < 1e-12, "{twice} {}", d.sums[1][(0, 0)]);
    }
}

/// All shapes, with the order of each.
fn shapes() -> [(Shape, Spectra, usize); 7] {
    let (time_s, plain) = (0.11, Spectra::default());
    let band = Shape::Band { centre_rad_s: 12.0, bandwidth_rad_s: 16.0 };
    [
        (Shape::DrydenLongitudinal { time_s }, plain, 3),
        (Shape::DrydenLateral { time_s }, plain, 3),
        (Shape::DrydenLongitudinal { time_s }, Spectra { von_karman: true, ..plain }, 3),
        (Shape::DrydenLateral { time_s }, Spectra { von_karman: true, ..plain }, 4),
        (band, plain, 4),
        (band, Spectra { steep: true, ..plain }, 6),
        (Shape::Narrow { centre_rad_s: 9.0, bandwidth_rad_s: 2.5 }, plain, 2),
    ]
}

/// Of every shape the states beyond its order decay by themselves, undriven, and the others keep their covariance from step to
/// step.
#[test]
fn law_states_without_a_use_decay() {
    for (shape, spectra, order) in shapes() {
        let i = input(&Disturbance { entry: Entry::AirVelocity(2), rms: 0.3, shape }, 0.02, spectra);
        assert_eq!(i.order, order);
        for (a, b) in (order..ORDER).flat_map(|a| (0..ORDER).map(move |b| (a, b))) {
            let kept = i.whole[a][b];
            assert!(if a == b { kept > 0.5 && kept < 1.0 } else { kept.abs() < 1e-300 }, "{shape:?} {a} {b}: {kept}");
            assert!(i.added[a][b].abs() < 1e-300 && i.stationary[a][b].abs() < 1e-300);
        }
        let of = |b: &Block| Rates::from_fn(|r, c| b[r][c]);
        let (phi, p) = (of(&i.whole), of(&i.stationary));
        let next = phi * p * phi.transpose() + of(&i.added);
        assert!((next - p).amax() < 1e-8 * p.amax(), "{shape:?}: {next} {p}");
    }
}

/// An oscillator in white noise: place and rate are uncorrelated, the rate's variance is the place's times the frequency's square
/// (Gelb 1974, §4.3), and a step is the decaying oscillation of textbooks.
#[test]
fn exact_oscillator() {
    let (w, d, h, rms) = (9.0_f64, 2.5_f64, 0.02_f64, 0.3_f64);
    let shape = Shape::Narrow { centre_rad_s: w, bandwidth_rad_s: d };
    let i = input(&Disturbance { entry: Entry::Coefficient(4), rms, shape }, h, Spectra::default());
    assert!((i.stationary[0][0] - rms * rms).abs() < 1e-14 && (i.stationary[1][1] / (w * rms).powi(2) - 1.0).abs() < 1e-12);
    assert!(i.stationary[0][1].abs() < 1e-12);
    let damped = (w * w - 0.25 * d * d).sqrt();
    let ((s, c), e) = ((damped * h).sin_cos(), (-0.5 * d * h).exp());
    let expected = [[c + 0.5 * d * s / damped, s / damped], [-w * w * s / damped, c - 0.5 * d * s / damped]];
    for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        assert!((i.whole[a][b] - e * expected[a][b]).abs() < 1e-12 * w * w, "{a} {b}");
    }
}

/// A form of gusts behind its lag: by the response to a sine, numerator over denominator of the form times 1/(1 + jω lag), the lag
/// a tenth of the gust's own time within 2 to 20 ms; before the lag the form is what the lag follows.
#[test]
fn exact_form_behind_a_lag() {
    type C = nalgebra::Complex<f64>;
    let of = |coefficients: &[f64], s: C| coefficients.iter().rev().fold(C::new(0.0, 0.0), |sum, x| sum * s + C::new(*x, 0.0));
    for (time_s, lag) in [(0.08, 0.008), (0.5, 0.02), (0.01, 0.002)] {
        let zeta = 3.0_f64.sqrt();
        let forms: [(_, &[f64], &[f64]); 3] = [
            (gust(time_s, zeta), &[1.0, zeta], &[1.0, 2.0, 1.0]),
            (ratio(time_s, &ALONG), ALONG.above, ALONG.below),
            (ratio(time_s, &ACROSS), ACROSS.above, ACROSS.below),
        ];
        for ((a, b, form), above, below) in forms {
            let still = response(&a, &b, 0.0)[0];
            for x in [0.3, 1.7, 12.0] {
                let w = x / time_s;
                let states = response(&a, &b, w);
                let s = C::new(0.0, x);
                let expected = of(above, s) / of(below, s) / C::new(1.0, w * lag);
                assert!((states[0] / still - expected).norm() < 1e-11 * expected.norm(), "{time_s} {x}");
                let before = (0..ORDER).map(|k| states[k] * form[k]).sum::<C>();
                assert!((before - states[0] * C::new(1.0, w * lag)).norm() < 1e-11 * before.norm());
            }
        }
    }
}

/// Drift of a recorded channel is a first-order process of one state; a number of a run stays as it is and differs between runs.
#[test]
fn exact_drift_and_number() {
    let (t, h, rms) = (30.0_f64, 0.02_f64, 0.3_f64);
    let steep = Spectra { von_karman: true, steep: true };
    for entry in [Entry::RecordedPose(4), Entry::RecordedSpeed] {
        let i = input(&Disturbance { entry, rms, shape: Shape::DrydenLongitudinal { time_s: t } }, h, steep);
        let kept = (-h / t).exp();
        assert_eq!((i.order, i.rate), (1, [0.0; ORDER]));
        assert!((i.whole[0][0] - kept).abs() < 1e-12 && (i.stationary[0][0] - rms * rms).abs() < 1e-12);
        assert!((i.added[0][0] / (rms * rms * (1.0 - kept * kept)) - 1.0).abs() < 1e-9);
        assert!((i.reach[0][0] / h - 1.0).abs() < h / t && i.reach[1].iter().all(|x| x.abs() < 1e-15));
    }
    let number = Entry::Number(windfall_model::RunNumber::Mass);
    let i = input(&Disturbance { entry: number, rms, shape: Shape::Constant }, h, Spectra::default());
    assert_eq!((i.order, i.whole[0][0], i.stationary[0][0], i.added), (1, 1.0, rms * rms, [[0.0; ORDER]; ORDER]));
    assert!(i.stages.iter().all(|s| (s[0][0] - 1.0).abs() < 1e-15) && i.broad.abs() < 1e-15);
}
