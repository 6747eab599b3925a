//! discover tests: sizes of variance components.

use super::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

#[test]
fn recover_component_sizes() {
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let bins = 2000;
    let noise = vec![Cov::identity(); bins];
    let mut one = Cov::identity();
    one[(0, 0)] = 0.0;
    let a = vec![one; bins];
    let g = SVector::<f64, BIN>::from_fn(|i, _| [1.0, 2.0, 0.0, 0.0, 1.0, 0.0][i % 6]);
    let b: Vec<Cov> = (0..bins).map(|k| g * g.transpose() * (1.0 / (1.0 + k as f64 / 500.0))).collect();
    let (va, vb) = (0.5, 3.0);
    let mut z = Vec::new();
    for k in 0..bins {
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let common = draw() * f64::sqrt(vb / (1.0 + k as f64 / 500.0));
        for (c, gc) in g.iter().enumerate() {
            z.push(draw() + if c > 0 { draw() * f64::sqrt(va) } else { 0.0 } + gc * common);
        }
    }
    let (v, _) = components(&noise, &[&a, &b], &z, &[1.0, 1.0], Effort { gain: 1e-4, rounds: 60 });
    // 22,000 numbers inform the first, 2,000 the second: 4 standard errors.
    assert!((v[0] - va).abs() < 4.0 * 1.5 * (2.0 / 22_000.0_f64).sqrt(), "{v:?}");
    assert!((v[1] - vb).abs() < 4.0 * vb * 1.3 * (2.0 / 2_000.0_f64).sqrt(), "{v:?}");
}

/// `x* + c ρᵏ` leads to `x*` where ρ is 31/32 or less; a slower one is taken 32 steps' worth further: from a remainder of one to
/// `1 − 64 (1 − ρ) + 32² (1 − ρ)²`. A size that falls to nothing stays at the smallest logarithm.
#[test]
fn exact_extrapolation_of_a_geometric_series() {
    let (limit, apart) = ([1.7, -3.1, 0.4], [0.9, 2.3, -1.1]);
    let after = |rate: f64, k: i32| -> Vec<f64> { limit.iter().zip(&apart).map(|(x, c)| x + c * rate.powi(k)).collect() };
    for (rate, left) in [(0.7_f64, 0.0), (0.95, 0.0), (0.99, 1.0 - 64.0 * 0.01 + 1024.0 * 1e-4)] {
        let found = extrapolated(&after(rate, 0), &after(rate, 1), &after(rate, 2));
        // Second differences lose three digits.
        found
            .iter()
            .zip(limit)
            .zip(apart)
            .for_each(|((x, to), c)| assert!((x - to - left * c).abs() < 1e-11, "{x} {to}, rate {rate}"));
    }
    assert!((extrapolated(&[-20.0], &[-25.0], &[-29.9])[0] - SMALLEST).abs() < 1e-15);
}
