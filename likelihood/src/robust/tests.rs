//! likelihood tests: long-run covariances against sums over all pairs.

use super::*;
use crate::flown::flown;
use crate::model::Id;
use crate::shock::Taken;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// The mean of a first-order process scatters by (1 + ρ)/(1 - ρ) of what independent values would leave; white ones by one.
#[test]
fn exact_variance_of_the_mean_of_a_first_order_process() {
    for (rho, tolerance) in [(0.0_f64, 0.06), (0.6, 0.1)] {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut runs = Vec::new();
        for _ in 0..4 {
            let mut x = [0.0; POSE];
            let innovations = (0..5000).map(|_| {
                x.iter_mut().for_each(|x| {
                    let white: f64 = StandardNormal.sample(&mut rng);
                    *x = rho * *x + (1.0 - rho * rho).sqrt() * white;
                });
                Some(x)
            });
            let innovations: Vec<_> = innovations.collect();
            let slopes = (0..innovations.len()).map(|_| Some(DMatrix::from_element(POSE, 1, 1.0))).collect();
            runs.push(Whitened { innovations, slopes });
        }
        let most = 50;
        let expected = (20_000 * POSE) as f64
            * (1..=most).fold(1.0, |s, lag| s + 2.0 * weight(lag, most) * rho.powi(i32::try_from(lag).unwrap_or(0)));
        let found = long_run(&runs, 1, most)[(0, 0)];
        assert!((found / expected - 1.0).abs() < tolerance, "{rho}: {found} for {expected}");
    }
}

/// Crooked numbers, the same ones for the same place.
fn crooked(i: usize, k: usize) -> f64 {
    (1.7 * i as f64 + 0.3 * (i * k) as f64 + 2.9 * k as f64).sin()
}

/// Bartlett's weights are the shares of a window's places that have another one so much later in it.
#[test]
fn exact_weights() {
    for lag in 0..=5 {
        let pairs = (0..6).filter(|k| k + lag < 6).count();
        assert!((weight(lag, 5) - pairs as f64 / 6.0).abs() < 1e-15, "{lag}");
    }
}

/// Innovations of variance s² and their slopes are taken over s, of nodes that are settled and where all channels were measured.
#[test]
fn exact_whitened() {
    let (std, count) = (|c: usize| 0.3 + 0.4 * c as f64, [POSE, POSE, 0, POSE]);
    let node = |k: usize| Taken {
        t_s: [0.2, 0.7, 0.8, 0.9][k],
        channels: (0..count[k])
            .map(|c| Innovation {
                slope: Vec::new(),
                covariance: Vec::new(),
                value: std(c) * crooked(k, c),
                variance: std(c).powi(2),
                columns: (0..2).map(|j| std(c) * crooked(k + j, c + 1)).collect(),
            })
            .collect(),
        ..Taken::default()
    };
    let found = Whitened::of(&Trace { nodes: (0..4).map(node).collect() });
    for (k, (innovation, slope)) in found.innovations.iter().zip(&found.slopes).enumerate() {
        let (Some(innovation), Some(slope)) = (innovation, slope) else {
            assert!(k == 0 || k == 2);
            continue;
        };
        for c in 0..POSE {
            assert!((innovation[c] - crooked(k, c)).abs() < 1e-15, "{k} {c}");
            (0..2).for_each(|j| assert!((slope[(c, j)] - crooked(k + j, c + 1)).abs() < 1e-15, "{k} {c} {j}"));
        }
    }
}

/// The score's covariance is the sum over all pairs of nodes of a run that are near enough, and the prior's information; that alone
/// where nothing was seen.
#[test]
fn exact_score_by_all_pairs() {
    let (n, most) = (2, 3);
    let run = |r: usize, nodes: usize| Whitened {
        innovations: (0..nodes).map(|k| (k != 2).then(|| std::array::from_fn(|c| crooked(k + 11 * r, c)))).collect(),
        slopes: (0..nodes).map(|k| (k != 2).then(|| DMatrix::from_fn(POSE, n, |c, j| crooked(3 * k + c, j + r)))).collect(),
    };
    let runs = [run(0, 7), run(1, 5)];
    let pairs = |r: &Whitened| {
        let at: Vec<usize> = (0..r.innovations.len()).filter(|&k| r.innovations[k].is_some()).collect();
        at.iter().flat_map(|&k| at.iter().map(move |&l| (k, l))).filter(|(k, l)| k.abs_diff(*l) <= most).collect::<Vec<_>>()
    };
    let of = |r: &Whitened, k: usize| DVector::from_column_slice(&r.innovations[k].expect("measured"));
    let count = runs.iter().flat_map(|r| &r.innovations).flatten().count() as f64;
    // The first innovation of a pair in its rows, so that an earlier second one is a transposed correlation.
    let correlation = |lag: usize| {
        let mut sum = DMatrix::<f64>::zeros(POSE, POSE);
        for r in &runs {
            pairs(r).into_iter().filter(|(k, l)| k + lag == *l).for_each(|(k, l)| sum += of(r, k) * of(r, l).transpose());
        }
        sum * ((4 - lag) as f64 / 4.0 / count)
    };
    let mut expected = DMatrix::zeros(n, n);
    for r in &runs {
        for (k, l) in pairs(r) {
            let between = if l >= k { correlation(l - k) } else { correlation(k - l).transpose() };
            let slope = |k: usize| r.slopes[k].as_ref().expect("measured");
            expected += slope(k).transpose() * between * slope(l);
        }
    }
    let number = |i: usize| {
        let prior = [0.7, 3.0][i];
        Number { id: Id::Constant(i), value: 0.0, prior, range: [-1.0, 1.0], at_end: [false; 2], step: 1.0 }
    };
    let prior = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0 / 0.49, 1.0 / 9.0]));
    let numbers = [number(0), number(1)];
    assert!((score(&runs, most, &numbers) - expected - &prior).amax() < 1e-12);
    assert!((score(&[], most, &numbers) - prior).amax() < 1e-15);
}

/// Series that are correlated over some steps: the covariance of their sums over all pairs of steps, of series longer and shorter
/// than that.
#[test]
fn exact_autocovariance_by_all_pairs() {
    for (length, most) in [(7, 3), (4, 9)] {
        let series: Vec<Vec<f64>> = (0..2).map(|i| (0..length).map(|k| crooked(k, i)).collect()).collect();
        let found = autocovariance(&[&series[0], &series[1]], most);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let pairs = (0..length).flat_map(|k| (0..length).map(move |l| (k, l, k.abs_diff(l)))).filter(|p| p.2 <= most);
            let expected: f64 =
                pairs.map(|(k, l, lag)| (1.0 - lag as f64 / (most + 1) as f64) * series[i][k] * series[j][l]).sum();
            assert!((found[(i, j)] - expected).abs() < 1e-13, "{length} {i} {j}");
        }
    }
}

/// Where the score scatters as the model says, errors are the model's own; where it scatters more, they are those of `A⁻¹ J A⁻¹`
/// with the model's correlations; they never fall.
#[test]
fn law_errors_grow_to_the_sandwich() {
    let information = DMatrix::from_row_slice(2, 2, &[2.0, 0.7, 0.7, 1.1]);
    let own = information.clone().try_inverse().expect("an information");
    for (by, expected) in [(1.0, 1.0), (0.3, 1.0), (2.5, 2.5)] {
        assert!((grown(&own, &(&information * by)) - &own * expected).amax() < 1e-14, "{by}");
    }
    let score = DMatrix::from_row_slice(2, 2, &[9.0, 0.2, 0.2, 4.0]);
    let (found, sandwich) = (grown(&own, &score), &own * &score * &own);
    let correlation = |m: &DMatrix<f64>| m[(0, 1)] / (m[(0, 0)] * m[(1, 1)]).sqrt();
    (0..2).for_each(|i| assert!((found[(i, i)] - sandwich[(i, i)]).abs() < 1e-14 && found[(i, i)] > own[(i, i)]));
    assert!((correlation(&found) - correlation(&own)).abs() < 1e-14);
}

/// Correlations are looked at over a second. The same run once more leaves half the covariances, its own and the one that holds for
/// any spectrum, which is one. Gusts of no size move no number, whatever of them is not seen.
#[test]
fn law_of_two_runs_and_of_vanishing_gusts() {
    let (one, model) = flown(2.0, "turbulence", &[0.2, 0.2, 0.6, 0.6, 0.0]);
    assert!((one.memory() as f64 * one.runs[0].step_s() - 1.0).abs() < 0.5 * one.runs[0].step_s());
    let mut two = one.clone();
    two.runs.push(one.runs[0].clone());
    let (a, b) = (one.random_covariance(&model).expect("slopes"), two.random_covariance(&model).expect("slopes"));
    assert!(a.0.clone().cholesky().is_some() && a.1.clone().cholesky().is_some());
    // Rounding times the information's condition.
    assert!((&b.0 * 2.0 - &a.0).amax() < 1e-6 * a.0.amax() && (&b.1 * 2.0 - &a.1).amax() < 1e-6 * a.1.amax());
    let mut calm = model.clone();
    calm.members[0].values[..2].copy_from_slice(&[1e-7; 2]);
    let fit = one.climb(&calm, false, 0).expect("a pass");
    let moved = &fit.covariance * one.sum(&calm, &fit.numbers, &[]).expect("a pass").b;
    assert!(one.by_unseen_gusts(&fit).expect("passes").amax() < 1e-6 * moved.amax());
}
