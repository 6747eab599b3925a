//! likelihood tests: spectra of lines and of autocovariances, Whittle's cost written out, bridged samples.

use super::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

fn record(mut next: impl FnMut() -> f64) -> Record {
    let n = 3000;
    let noise: Vec<f64> = (0..n).map(|_| next()).collect();
    let t_s: Vec<f64> = (0..n).map(|i| i as f64 / 150.0).collect();
    // A pitch mode of about 1 Hz below the noise, a hundred times its size.
    let x: Vec<f64> = t_s.iter().zip(&noise).map(|(t, e)| 0.1 * (6.0 * t).sin() + e).collect();
    Record {
        position_m: [x.clone(), x.clone(), x.clone()],
        vw_m_s: x.clone(),
        attitude_rad: [x.clone(), x.clone(), x],
        ps_pa: vec![1e5; n],
        ts_k: vec![290.0; n],
        t_s,
        ..Record::default()
    }
}

/// Covariances of means by all pairs of their samples.
#[test]
fn exact_covariances_of_means() {
    let noise = ChannelNoise { white: 0.0, coloured: 2.0, correlation: 0.8 };
    let m = 3;
    let between = |a: i32, b: i32| 2.0 * 0.8_f64.powi((a - b).abs());
    let mean = |of: &dyn Fn(i32) -> f64| (0..3).map(of).sum::<f64>() / 3.0;
    let own = mean(&|i| mean(&|k| between(i, k)));
    let next = |lag: i32| mean(&|i| mean(&|k| between(i, k + 3 * lag)));
    let found = noise.of_means(m);
    assert!((found.stationary[0] - own).abs() < 1e-14 && (found.stationary[2] - 2.0).abs() < 1e-14);
    // Mean, then mean again: by the last sample; and one later.
    assert!((found.by_last[0] * found.stationary[1] - next(1)).abs() < 1e-14);
    assert!((found.by_last[0] * found.by_last[1] * found.stationary[1] - next(2)).abs() < 1e-14);
}

#[test]
fn recover_white_and_coloured_noise() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let sensors =
        Sensors { position_std_m: 1.0, roll_std_rad: 1.0, pitch_yaw_std_rad: 1.0, wind_std_m_s: 1.0, ..Sensors::default() };
    let white = record(|| 1e-3 * normal());
    let found = learn(&[&white], &sensors)[0];
    // 1300 ordinates, every second one: 4 % of the variance a sigma.
    assert!((found.std() / 1e-3 - 1.0).abs() < 0.06 && found.coloured == 0.0, "{found:?}");
    let mut state = 0.0;
    let r: f64 = 0.9;
    let red = record(|| {
        state = r * state + (1.0 - r * r).sqrt() * 1e-3 * normal();
        state
    });
    let found = learn(&[&red], &sensors)[0];
    assert!((found.std() / 1e-3 - 1.0).abs() < 0.2 && (found.correlation - 0.9).abs() < 0.04, "{found:?}");
}

/// White noise and a first-order one, by their autocovariances.
fn shape(share: f64, r: f64, w: f64) -> f64 {
    1.0 - share + share * (1.0 + 2.0 * (1..600).map(|h| r.powi(h) * (f64::from(h) * w).cos()).sum::<f64>())
}

fn ordinates(n: u32, power: impl Fn(f64, f64) -> f64) -> Vec<Ordinate> {
    let at = |k: u32| {
        let w = 0.15 + 2.95 * f64::from(k) / f64::from(n - 1);
        let ratio = 1.0 + 20.0 * f64::from(k) / f64::from(n);
        Ordinate { w, ratio, power: power(w, ratio), noise_alone: true }
    };
    (0..n).map(at).collect()
}

/// `Σ ln f + I/f` (Whittle 1953) at the variance where its slope is zero; where a spectrum is exactly noise beside motion, `Σ ln I`
/// and one an ordinate.
#[test]
fn exact_cost_is_whittles() {
    let (share, r) = (0.4, 0.7);
    let plain = ordinates(60, |w, _| 7.3 + 4.1 * (5.0 * w).sin());
    let (cost, variance) = Search { spectrum: &plain, motion: false }.at(share, r);
    let of = |v: f64| plain.iter().map(|o| (v * shape(share, r, o.w)).ln() + o.power / (v * shape(share, r, o.w))).sum::<f64>();
    assert!((cost - of(variance)).abs() < 1e-10, "{cost}");
    // Slope by the logarithm of the variance, of 60 times h²/6.
    assert!((of(variance * 1.0001) - of(variance / 1.0001)).abs() < 1e-8);
    let moved = ordinates(60, |w, ratio| 5.7 * (shape(share, r, w) + 30.0 / ratio.powi(6)));
    let (cost, variance) = Search { spectrum: &moved, motion: true }.at(share, r);
    assert!((variance - 5.7).abs() < 1e-11 && (cost - moved.iter().map(|o| o.power.ln() + 1.0).sum::<f64>()).abs() < 1e-10);
}

/// A spectrum that is 2.6 times white and coloured noise everywhere has that ratio to it, known to two over its ordinates; one of too few
/// ordinates has none.
#[test]
fn exact_ratio_of_a_spectrum_to_noise() {
    let (share, r) = (0.4, 0.7);
    let noise = ChannelNoise { white: 3.0 * (1.0 - share), coloured: 3.0 * share, correlation: r };
    let of = |n: u32| noise.log_ratio(&ordinates(n, |w, _| 2.6 * 3.0 * shape(share, r, w)));
    let [log, variance] = of(120).expect("enough ordinates");
    assert!((log - 2.6_f64.ln()).abs() < 1e-10 && (variance - 2.0 / 120.0).abs() < 1e-15, "{log} {variance}");
    assert_eq!(of(u32::try_from(FEWEST).expect("few") - 1), None);
}

/// One ordinate in a thousand is a line: it counts as twelve times the variance, `1000 v = 999·7 + 12 v`. Three rounds from the
/// mean of all, 77, leave 70 (12/1000)³.
#[test]
fn exact_a_line_counts_as_a_tail() {
    let line = ordinates(1000, |w, _| if w < 0.151 { 7e4 } else { 7.0 });
    let (cost, variance) = Search { spectrum: &line, motion: false }.at(0.0, 0.0);
    assert!((variance - 999.0 * 7.0 / 988.0).abs() < 2e-4, "{variance}");
    assert!((cost - (1000.0 * variance.ln() + 999.0 * 7.0 / variance + 12.0)).abs() < 1e-9, "{cost}");
}

/// A spectrum that is exactly of a share and correlation is likeliest there: within half the last grid's steps, a fiftieth.
#[test]
fn exact_share_and_correlation() {
    for (share, r) in [(0.55, 0.8), (0.9, 0.93), (0.7, 0.58)] {
        let of = |v: f64| ordinates(120, |w, _| v * shape(share, r, w));
        let spectra = [of(3.1), of(0.2)];
        let (_, s, q) = best(&spectra.each_ref().map(|spectrum| Search { spectrum, motion: false }));
        assert!((s - share).abs() < 0.01 && (q - r).abs() < 0.01, "{s} {q}");
    }
}

/// A line of whole turns beside a trend: A² n/6 in its ordinate by Hann's window, a quarter in its neighbours', as of differences,
/// and none elsewhere. Ordinates are those above 3.5 Hz, noise alone above 10 Hz, up to 0.99 of half the sample rate.
#[test]
fn exact_spectrum_of_a_line() {
    let (n, dt, k, a) = (500, 0.0101, 111, 0.37);
    let turn = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let series: Vec<f64> = (0..=n).map(|i| a * (turn(k) * i as f64 + 0.3).cos() + 40.0 + 0.3 * i as f64).collect();
    let t_s = (0..=n).map(|i| i as f64 * dt).collect();
    let mut record = Record { t_s, ..Record::default() };
    *record.channels_mut()[2] = series;
    let found = spectrum(&record, 2);
    let last = (0.99 * 0.5 * n as f64) as usize;
    assert_eq!(found.len(), last - 17);
    for (o, at) in found.iter().zip(18..) {
        let hz = at as f64 / (n as f64 * dt);
        let whole = a * a * n as f64 / 6.0 * (1.0 - turn(k).cos()) / (1.0 - turn(at).cos());
        let power = whole * [1.0, 0.25, 0.0][k.abs_diff(at).min(2)];
        assert!((o.power - power).abs() < 1e-10, "{at}: {} {power}", o.power);
        assert!((o.w - turn(at)).abs() < 1e-12 && (o.ratio - hz / 3.5).abs() < 1e-12 && o.noise_alone == (hz > 10.0), "{o:?}");
    }
}

/// A trend is in no ordinate, not even the first of a short and fast record.
#[test]
fn law_a_trend_is_no_noise() {
    let of = |trend: f64| {
        let t_s = (0..101).map(|i| f64::from(i) * 1e-3).collect();
        let mut record = Record { t_s, ..Record::default() };
        *record.channels_mut()[1] = (0..101).map(|i| (f64::from(i * i % 17) - 8.0) + trend * f64::from(i)).collect();
        spectrum(&record, 1)
    };
    let (plain, steep) = (of(0.0), of(50.0));
    assert!((plain[0].w - std::f64::consts::TAU / 100.0).abs() < 1e-12);
    assert!(plain.iter().zip(&steep).all(|(p, s)| (p.power - s.power).abs() < 1e-8 * p.power.max(1.0)));
}

/// Fourth differences of alternating noise are 16 times it, and their variance 70 times that of white noise; a cubic has none.
/// Bridged samples get half that variance, about zero, of each channel its own.
#[test]
fn law_bridged_samples_get_noise() {
    let (n, size) = (3000, 0.01);
    let bridged: Vec<bool> = (0..n).map(|i| i % 10 > 6).collect();
    let noise = |i: usize| if bridged[i] { 0.0 } else { size * [1.0, -1.0][i % 2] };
    let x: Vec<f64> = (0..n).map(|i| 1e-9 * (i as f64 - 900.0).powi(3) + noise(i)).collect();
    let [a, b] = [0, 1].map(|_| [x.clone(), x.clone(), x.clone()]);
    let record = Record { position_m: a, attitude_rad: b, vw_m_s: x.clone(), bridged: bridged.clone(), ..Record::default() };
    let std = 16.0 * size / 70.0_f64.sqrt();
    let mut each = Vec::new();
    for c in 0..CHANNELS {
        let (with, ratio) = filled(&record, c);
        let added: Vec<f64> = with.iter().zip(&x).map(|(a, b)| (a - b) / std).collect();
        assert!(added.iter().zip(&bridged).all(|(a, b)| *b || *a == 0.0));
        let added: Vec<f64> = added.into_iter().zip(&bridged).filter(|(_, b)| **b).map(|(a, _)| a).collect();
        let count = added.len() as f64;
        let (mean, square) = (added.iter().sum::<f64>() / count, added.iter().map(|a| a * a).sum::<f64>() / count);
        assert!(mean.abs() < 0.07 && (square - 0.5).abs() < 0.03, "{c}: {mean} {square}");
        let fourth = (0..4).fold(with, |x, _| x.windows(2).map(|w| w[1] - w[0]).collect());
        let all = fourth.iter().map(|f| f * f).sum::<f64>() / fourth.len() as f64;
        assert!((ratio - 70.0 * std * std / all).abs() < 1e-9, "{c}: {ratio}");
        // Without memory: correlations within three of their errors, 1/sqrt(900), and as many as 7 by 8 of them.
        for lag in 1..9 {
            let along = added.windows(lag + 1).map(|w| w[0] * w[lag]).sum::<f64>() / (square * count);
            assert!(along.abs() < 0.12, "channel {c}, lag {lag}: {along}");
        }
        each.push(added);
    }
    for (a, b) in (1..CHANNELS).flat_map(|b| (0..b).map(move |a| (a, b))) {
        let product = each[a].iter().zip(&each[b]).map(|(x, y)| x * y).sum::<f64>() / each[a].len() as f64;
        assert!(product.abs() < 0.05, "{a} {b}: {product}");
    }
}

/// White noise stays white, and of its size, where a fifth of the samples was bridged by straight lines.
#[test]
fn recover_white_noise_beside_bridges() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut whole = record(|| 1e-3 * Distribution::<f64>::sample(&StandardNormal, &mut rng));
    whole.bridged = (0..whole.len()).map(|i| i % 40 > 31).collect();
    let bridged = whole.bridged.clone();
    for x in whole.channels_mut() {
        for i in (0..x.len()).filter(|i| bridged[*i]) {
            let (from, to) = (i - i % 40 + 31, (i - i % 40 + 40).min(x.len() - 1));
            x[i] = x[from] + (x[to] - x[from]) * (i - from) as f64 / (to - from).max(1) as f64;
        }
    }
    let found = learn(&[&whole], &Sensors::default());
    for (c, n) in found.iter().enumerate() {
        // Three errors of a variance of 2400 samples.
        assert!((n.white / 1e-6 - 1.0).abs() < 0.09 && n.coloured < 0.05 * n.white, "{c}: {n:?}");
    }
}

/// One channel without colour beside others with it keeps its own. Of 600 samples motion's steep spectrum, fitted beside, takes
/// some of the colour: less than halfway from one to the other.
#[test]
fn recover_colours_that_differ() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let n = 600;
    let mut coloured = |r: f64| -> Vec<f64> {
        let mut state = 0.0;
        let mut next = || {
            let drawn: f64 = StandardNormal.sample(&mut rng);
            state = r * state + 1e-3 * (1.0 - r * r).sqrt() * drawn;
            state
        };
        (0..n).map(|_| next()).collect()
    };
    let mut record = Record { t_s: (0..n).map(|i| i as f64 / 150.0).collect(), ..Record::default() };
    for (c, channel) in record.channels_mut().into_iter().enumerate() {
        *channel = coloured(if c == 2 { 0.0 } else { 0.8 });
    }
    let found = learn(&[&record], &Sensors::default());
    for (c, noise) in found.iter().enumerate() {
        // What a share of white noise takes, its colour makes up: the covariance of neighbours is told.
        let neighbours = noise.coloured * noise.correlation / noise.std().powi(2);
        assert!((neighbours - if c == 2 { 0.0 } else { 0.8 }).abs() < 0.3, "{c}: {noise:?}");
    }
}

/// Runs of one noise keep it; of three runs of which one has four times the noise each has its own. 650 independent ordinates: 4 % a sigma.
#[test]
fn recover_noise_of_each_run() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mut run = |std: f64| {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        record(|| std * normal())
    };
    let whole = ChannelNoise::white(1e-3);
    let alike = [run(1e-3), run(1e-3), run(1e-3)];
    let ratios = by_run(&alike.iter().collect::<Vec<_>>(), &[whole; CHANNELS]);
    assert!(ratios.iter().all(|r| (r[0] - 1.0).abs() < 0.15 && (r[POSE] - 1.0).abs() < 1e-15), "{ratios:?}");
    let [first, second, _] = &alike;
    let other = run(4e-3);
    let found = by_run(&[first, second, &other], &[whole; CHANNELS]);
    assert!((found[2][1] / 16.0 - 1.0).abs() < 0.2 && (found[0][1] - 1.0).abs() < 0.2, "{found:?}");
    // Coloured noise: the ratio is to the noise's spectrum, not to its variance.
    let expected = ChannelNoise { white: 0.0, coloured: 1e-6, correlation: 0.9 };
    let (mut state, r) = (0.0, 0.9_f64);
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let red = record(|| {
        let e: f64 = StandardNormal.sample(&mut rng);
        state = r * state + (1.0 - r * r).sqrt() * 2e-3 * e;
        state
    });
    let found = by_run(&[&red], &[expected; CHANNELS])[0][0];
    assert!((found / 4.0 - 1.0).abs() < 0.2, "{found}");
}

/// Squares 0.09, 0.25 and 0.01 over variances 0.03, 0.05 and 0.01 leave a spread of 0.26/3; what is no more than its own error is none.
#[test]
fn exact_numbers_drawn_towards_zero() {
    let spread = 0.26 / 3.0;
    let found = shrunk(&[Some([0.3, 0.03]), None, Some([-0.5, 0.05]), Some([0.1, 0.01])]);
    let expected = [0.3 * spread / (spread + 0.03), 0.0, -0.5 * spread / (spread + 0.05), 0.1 * spread / (spread + 0.01)];
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?} {expected:?}");
    assert_eq!(shrunk(&[Some([0.1, 0.02]), Some([-0.1, 0.03])]), [0.0, 0.0]);
}
