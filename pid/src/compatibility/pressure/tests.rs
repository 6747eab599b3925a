//! pid tests: two witnesses of one speed, against dense Gaussian algebra and planted scales and delays.

use super::*;
use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Two witnesses of a speed that wanders, `late` samples apart.
fn pairs(seed: u64, scale: f64, late: usize, n: usize) -> Vec<Witnesses> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let h = 1.0 / 150.0;
    let (mut v, mut a, mut b) = (7.4, 0.0, 0.0);
    let mut speed = Vec::new();
    for _ in 0..n + late {
        speed.push(v);
        v += h * (a + 0.5 * h * b);
        a += h * b;
        // A hand that holds the speed: drawn back, so that it stays positive.
        b += (0.04_f64 * h).sqrt() * normal() - h * (1.5 * b + 1.2 * a + 0.4 * (v - 7.4));
    }
    let noisy = |x: &[f64], gain: f64, std: f64, normal: &mut dyn FnMut() -> f64| -> Vec<f64> {
        x.iter().map(|x| gain * x + std * normal()).collect()
    };
    let one = noisy(&speed[late..], 1.0, 2.57e-3, &mut normal);
    let other = noisy(&speed[..n], scale, 4e-3, &mut normal);
    vec![Witnesses::new(&one, other, h)]
}

/// Forty pairs: means within 3.5/√40 standard errors, scatter within 3.5/√80 of 1, and 1 % false alarms are none to three.
#[test]
fn recover_scale_and_delay_with_true_intervals() {
    let mut z = [Vec::new(), Vec::new()];
    for seed in 0..40 {
        let p = measured(&pairs(seed, 1.02, 4, 2500)).expect("determined");
        let half = 0.5 * (p.speed_scale_ci95[1] - p.speed_scale_ci95[0]) / NORMAL_95;
        z[0].push((p.speed_scale - 1.02) / half);
        let ci = p.delay_ci95_s.expect("determined");
        z[1].push((p.delay_s.expect("determined") - 4.0 / 150.0) / (0.5 * (ci[1] - ci[0]) / NORMAL_95));
        assert!(p.p_value < 1e-6 && p.whiteness_p > 1e-4, "{p:?}");
    }
    for z in z {
        let n = z.len() as f64;
        let mean = z.iter().sum::<f64>() / n;
        let scatter = (z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
        assert!(mean.abs() < 3.5 / n.sqrt() && (scatter - 1.0).abs() < 3.5 / (2.0 * n).sqrt(), "{mean} {scatter}");
    }
    let alarms = (100..200).filter(|s| measured(&pairs(*s, 1.0, 0, 1500)).expect("determined").p_value < 0.01).count();
    assert!(alarms <= 4, "{alarms} of 100");
}

#[test]
fn law_a_computed_pressure_is_recognised() {
    let mut p = pairs(1, 1.0, 0, 500);
    p[0].w = p[0].v.iter().map(|v| 1.0001 * v).collect();
    assert!(shared(&p) > 0.999 && shared(&pairs(1, 1.0, 0, 500)).abs() < 0.2);
    let found = computed(&p);
    assert!((found.speed_scale - 1.0001).abs() < 1e-9 && found.p_value > 0.99, "{found:?}");
}

/// A run of crooked numbers.
fn crooked(n: usize, interval_s: f64) -> Witnesses {
    let wave = |i: usize, k: f64| (k * i as f64).sin();
    Witnesses {
        v: (0..n).map(|i| 5.0 + 0.4 * wave(i, 1.3) - 0.3 * wave(i, 0.21)).collect(),
        w: (0..n).map(|i| 5.3 - 0.35 * wave(i, 2.1) + 0.5 * wave(i, 0.17)).collect(),
        interval_s,
        intensity: 2.3,
        variance: [0.04, 0.09],
    }
}

/// Innovations of a filter are what the Cholesky factor of the whole covariance makes white: `L e = y − mean`, measurements in the
/// filter's order. Of the start little is known, 1e8 of the larger variance in speed and both derivatives; later each sample's jerk adds
/// to the second alone. Those of the first three samples are not used. Nine decades between the variances leave seven digits.
#[test]
fn exact_innovations_by_the_whole_covariance() {
    let (n, h, scale, delay) = (12, 0.11, 1.07, 0.25);
    let p = crooked(n, h);
    // The pressure is two samples late and begins as many before the speed.
    let rows: Vec<(usize, f64, f64, f64, f64)> = (0..n + 2)
        .flat_map(|i| {
            let t = i as f64 * h;
            [
                (i >= 2).then(|| (2 * i, t, 1.0, p.v[i - 2], p.variance[0])),
                p.w.get(i).map(|w| (2 * i + 1, t - 0.03, scale, *w, p.variance[1])),
            ]
        })
        .flatten()
        .collect();
    // Speed some time after the start by the start, then by the jerk of each sample.
    let by = |t: f64, i: usize, k: usize| match k {
        0 => 1.0,
        1 => t,
        2 => t * t / 2.0,
        _ if i < k - 2 => 0.0,
        _ => (t - (k - 2) as f64 * h).powi(2) / 2.0,
    };
    let a = DMatrix::from_fn(rows.len(), 5 + n, |r, k| rows[r].2 * by(rows[r].1, rows[r].0 / 2, k));
    let known = DMatrix::from_fn(5 + n, 5 + n, |i, j| match (i == j, i) {
        (false, _) => 0.0,
        (true, 0..3) => 1e8 * 0.09,
        _ => p.intensity * h,
    });
    let noise = DMatrix::from_fn(rows.len(), rows.len(), |i, j| if i == j { rows[i].4 } else { 0.0 });
    let l = (&a * known * a.transpose() + noise).cholesky().expect("noise everywhere").unpack();
    let off = DVector::from_iterator(rows.len(), rows.iter().map(|r| r.3 - r.2 * p.v[0]));
    let e = l.solve_lower_triangular(&off).expect("a diagonal");
    let mut expected = vec![0.0; 2 * (n + 2)];
    rows.iter().zip(e.iter()).filter(|(r, _)| r.0 >= 6).for_each(|(r, e)| expected[r.0] = *e);
    let found = p.at([scale, delay], p.shift(delay));
    assert_eq!((found.each.len(), found.w_from), (expected.len(), 0));
    for (k, (found, expected)) in found.each.iter().zip(&expected).enumerate() {
        assert!((found - expected).abs() < 1e-6, "{k}: {found} {expected}");
    }
    let log = e.norm_squared() + 2.0 * l.diagonal().map(f64::ln).sum();
    assert!((found.minus_twice_log - log).abs() < 1e-6 * log.abs(), "{} {log}", found.minus_twice_log);
    // The other way round it begins two samples after the speed.
    let early = p.at([scale, -delay], p.shift(-delay));
    assert_eq!((early.each.len(), early.w_from), (2 * (n + 2), 2));
    assert!(
        early.each.iter().enumerate().all(|(k, e)| (k / 2 < 3 || (k % 2 == 0 && k / 2 >= n)) == (*e == 0.0)),
        "{:?}",
        early.each
    );
}

/// Score, information and its middle by dense algebra: slopes J of the innovations by differences of another step, scores of a sample
/// those of both witnesses, `−Jᵀe`, `JᵀJ` and `Σ w(lag) s sᵀ` over all pairs of samples, Bartlett's weights falling to zero one sample
/// beyond half a second. One run is shorter than that. The code's differences over 1e-4 s leave (1/200)² of what
/// changes over a sample of 0.02 s.
#[test]
fn exact_score_and_information_by_slopes() {
    let pairs = [crooked(40, 0.02), crooked(20, 0.021)];
    let at = [1.05, 0.033];
    let (mut score, mut information, mut middle) = (Vector2::zeros(), Matrix2::zeros(), Matrix2::zeros());
    for (p, lags) in pairs.iter().zip([25.0, 23.0]) {
        let shift = p.shift(at[1]);
        let e = DVector::from_vec(p.at(at, shift).each);
        let side = |k: usize, h: f64| {
            let mut to = at;
            to[k] += h;
            DVector::from_vec(p.at(to, shift).each)
        };
        let j = DMatrix::from_columns(
            &[2e-6, 2e-5].iter().enumerate().map(|(k, h)| (side(k, *h) - side(k, -h)) / (2.0 * h)).collect::<Vec<_>>(),
        );
        let total = -j.tr_mul(&e);
        score += Vector2::new(total[0], total[1]);
        information += j.tr_mul(&j).fixed_view::<2, 2>(0, 0);
        let own = |i: usize| -(j.row(2 * i) * e[2 * i] + j.row(2 * i + 1) * e[2 * i + 1]).transpose();
        for a in 0..e.len() / 2 {
            for b in 0..e.len() / 2 {
                let weight = 1.0 - a.abs_diff(b) as f64 / (lags + 1.0);
                middle += (own(a) * own(b).transpose()).fixed_view::<2, 2>(0, 0) * weight.max(0.0);
            }
        }
    }
    let l = local(&pairs, at);
    assert!((l.score - score).amax() < 1e-4 * score.amax(), "{} {score}", l.score);
    for (found, expected) in [(l.information, information), (l.middle, middle)] {
        assert!((found - expected).component_div(&expected).amax() < 1e-4, "{found} {expected}");
    }
    assert_eq!(l.of_w.iter().map(Vec::len).collect::<Vec<_>>(), [40, 20]);
}

/// ½ρV² back to V.
#[test]
fn exact_speed_of_a_dynamic_pressure() {
    assert!((indicated(0.6 * 7.3 * 7.3, 1.2) - 7.3).abs() < 1e-14);
}

/// An inverse of any size: products of the diagonal overflow, or vanish, unscaled.
#[test]
fn exact_inverse_of_any_size() {
    for (a, b) in [(1e200, 4e200), (1e-200, 4e-200)] {
        let inverse = scaled_inverse(&Matrix2::new(a, 0.3 * a, 0.3 * a, b)).expect("it has one");
        let expected = Matrix2::new(4.0, -0.3, -0.3, 1.0) / 3.91;
        assert!((inverse * a - expected).amax() < 1e-14, "{inverse}");
    }
    assert_eq!(scaled_inverse(&Matrix2::new(1.0, 0.0, 0.0, 0.0)), None);
}

/// A record without noise counts as exact to 1e-9 of its start.
#[test]
fn exact_floor_of_the_noise() {
    let p = Witnesses::new(&[6.3; 40], vec![5.0; 40], 0.01);
    for variance in p.variance {
        assert!((variance.sqrt() / 6.3e-9 - 1.0).abs() < 1e-12, "{variance}");
    }
}

/// Ratios of 1.01, 1.00 and 1.03 over two runs: mean 1.01333, its standard error 0.0088192; squares of both ends.
#[test]
fn exact_scale_of_a_computed_pressure() {
    let with = |v: &[f64], w: &[f64]| Witnesses { v: v.to_vec(), w: w.to_vec(), ..crooked(0, 0.01) };
    let pairs = [with(&[2.0, 4.0], &[2.02, 4.0]), with(&[5.0], &[5.15])];
    let found = computed(&pairs);
    let mean = 3.04 / 3.0;
    let std = ([1.01, 1.0, 1.03].map(|r: f64| (r - mean).powi(2)).iter().sum::<f64>() / 6.0).sqrt();
    let ends = [mean - 1.959_963_985 * std, mean + 1.959_963_985 * std];
    let expected = [mean, ends[0], ends[1], mean * mean, ends[0] * ends[0], ends[1] * ends[1], 0.0];
    let [a, b] = found.speed_scale_ci95;
    let [c, d] = found.pressure_scale_ci95;
    for (found, expected) in [found.speed_scale, a, b, found.pressure_scale, c, d, found.p_value].into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
    // What does not change shares nothing.
    assert!(shared(&[with(&[2.0, 4.0, 3.0], &[5.0; 3])]).abs() < 1e-300);
}

/// Two hands on the throttle, of 0.8 s and of an incommensurate period: a search from no delay would end a period away. Scale and
/// delay within 3.5 of their standard errors; and as sure of agreement where there is.
#[test]
fn recover_a_delay_of_more_than_a_period() {
    let (n, h) = (500, 0.02);
    let speed = |t: f64| 7.4 + 0.3 * (std::f64::consts::TAU * t / 0.8).sin() + 0.2 * (3.1 * t).sin();
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut noisy = |x: f64| -> f64 {
        let normal: f64 = StandardNormal.sample(&mut rng);
        x + 3e-3 * normal
    };
    for (scale, delay) in [(1.03, 0.87), (1.0, 0.0), (0.98, -0.91)] {
        let v: Vec<f64> = (0..n).map(|i| noisy(speed(i as f64 * h))).collect();
        let w = (0..n).map(|i| noisy(scale * speed(i as f64 * h - delay))).collect();
        let found = measured(&[Witnesses::new(&v, w, h)]).expect("determined");
        let std = |[low, high]: [f64; 2]| (high - low) / (2.0 * NORMAL_95);
        let of_scale = std(found.speed_scale_ci95);
        assert!(of_scale < 1e-4 && (found.speed_scale - scale).abs() < 3.5 * of_scale, "{found:?}");
        let of_delay = std(found.delay_ci95_s.expect("determined"));
        assert!(of_delay < 1e-3 && (found.delay_s.expect("determined") - delay).abs() < 3.5 * of_delay, "{found:?}");
        if delay == 0.0 { assert!(found.p_value > 1e-3) } else { assert!(found.p_value < 1e-6) }
    }
}

/// A speed that does not change tells no delay, whatever the noise and the unit: of twenty records, with either instrument the better one, one in
/// twenty may seem to, and one in a hundred is a false alarm: four and two at most by three standard errors of the counts.
#[test]
fn recover_no_delay_of_a_constant_speed() {
    for (n, h, noise, unit) in [(300, 1.0 / 150.0, [3e-3, 9e-3], 1.0), (200, 0.02, [9e-3, 2e-3], 1e3)] {
        let (mut told, mut alarms) = (0, 0);
        for seed in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let [v, w] = noise.map(|std| -> Vec<f64> {
                StandardNormal.sample_iter(&mut rng).take(n).map(|e: f64| unit * (7.4 + std * e)).collect()
            });
            let found = measured(&[Witnesses::new(&v, w, h)]).expect("a scale");
            told += usize::from(found.delay_s.is_some());
            alarms += usize::from(found.p_value < 0.01);
        }
        assert!(told <= 4 && alarms <= 2, "{n} at {h} s: {told} delays, {alarms} alarms");
    }
}

/// At a constant speed, sampled so slowly that the start tells no rate, no delay is told; the scale's test is that of one normal number.
#[test]
fn exact_test_of_a_scale_alone() {
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    let mut noisy = |x: f64| -> Vec<f64> {
        let normal = StandardNormal.sample_iter(&mut rng);
        normal.take(60).map(|e: f64| x + 3e-3 * e).collect()
    };
    let still = Witnesses { v: noisy(7.4), w: noisy(7.401), interval_s: 4.0, intensity: 1e-14, variance: [9e-6; 2] };
    let found = measured(&[still]).expect("determined");
    let [low, high] = found.speed_scale_ci95;
    let z = (found.speed_scale - 1.0) / ((high - low) / (2.0 * NORMAL_95));
    assert_eq!((found.delay_s, found.delay_ci95_s), (None, None));
    assert!((found.p_value - statrs::function::erf::erfc(z.abs() / std::f64::consts::SQRT_2)).abs() < 1e-9, "{z} {found:?}");
    assert!(z.abs() > 0.1 && z.abs() < 3.5, "{z}");
}
