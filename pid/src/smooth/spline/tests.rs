//! pid tests: the spline against dense least squares. In: noise. Out: values, slopes, noise, weights, the choice of knots.

use super::*;
use nalgebra::{DMatrix, DVector};
use pulp::Scalar;

/// On the widest unit and on none at all.
#[test]
fn exact_bits_on_every_unit() {
    let sample = |i: usize| -> WideRow {
        std::array::from_fn(|k| (0.01 * (1 + k * i) as f64).sin() + (17.3 * (i * i + k) as f64).sin() * 1e-3)
    };
    let samples: Vec<WideRow> = (0..400).map(sample).collect();
    let size2 = sum_of_squares(&samples);
    let grid = Grid::new(40, samples.len());
    let factor = grid.factor.as_ref().expect("more samples than coefficients");
    let smoothing = || Smoothing { grid: &grid, factor, samples: &samples, dt: 0.01 };
    let trial = |scale: f64| Trial { grid: &grid, samples: &samples, size2: size2.map(|s| s * scale) };
    assert_eq!(Arch::new().dispatch(smoothing()), smoothing().with_simd(Scalar::new()));
    // The larger sum makes the residual be taken sample by sample.
    for scale in [1.0, 1e-9] {
        assert_eq!(Arch::new().dispatch(trial(scale)), trial(scale).with_simd(Scalar::new()));
    }
}

/// Rows of crooked numbers, the last of them a zero.
fn crooked(n: usize) -> Vec<WideRow> {
    let at = |i: usize, k: usize| {
        3.0 + 0.4 * k as f64 + (0.2 * (1 + k) as f64 * i as f64).sin() + 0.3 * ((i * i + 5 * k) as f64).cos()
    };
    (0..n).map(|i| std::array::from_fn(|k| if k < CHANNELS { at(i, k) } else { 0.0 })).collect()
}

fn column(samples: &[WideRow], k: usize) -> DVector<f64> {
    DVector::from_fn(samples.len(), |i, _| samples[i][k])
}

/// B-splines at the samples.
fn basis(intervals: usize, n: usize) -> DMatrix<f64> {
    let knots = Knots { intervals };
    let mut b = DMatrix::zeros(n, knots.count());
    for i in 0..n {
        let x = i as f64 * intervals as f64 / (n - 1) as f64;
        let first = knots.interval(x);
        for (k, value) in knots.values(first, x).into_iter().enumerate() {
            b[(i, first + k)] = value;
        }
    }
    b
}

/// What of y the span of orthonormal columns leaves.
fn left_over(q: &DMatrix<f64>, y: &DVector<f64>) -> DVector<f64> {
    let once = y - q * (q.transpose() * y);
    &once - q * (q.transpose() * &once)
}

/// Truncated powers of degree 7 by singular values: values, derivatives, noise and bandwidth of four intervals.
#[test]
fn exact_fit_is_the_least_squares_spline_in_truncated_powers() {
    const N: usize = 47;
    const DT: f64 = 0.031;
    let samples = crooked(N);
    let x = by_channel(&samples);
    // 46 sample intervals over 11.2 are 4.1 knot intervals, so four. Bounds: condition number 1e5 of the powers at values up to 6.
    let fit = smooth(std::array::from_fn(|k| x[k].as_slice()), DT, Some(11.2 * DT)).expect("good settings");
    let powers = |t: f64| -> [Vec<f64>; 3] {
        let power = |t: f64, p: i32| if p < 0 { 0.0 } else { t.powi(p) };
        let one = |t: f64, p: i32| [t.powi(p), f64::from(p) * power(t, p - 1), f64::from(p * (p - 1)) * power(t, p - 2)];
        let smooth = (0..8).map(|p| one(t, p));
        let rows: Vec<[f64; 3]> = smooth.chain([-0.5, 0.0, 0.5].map(|knot| one((t - knot).max(0.0), 7))).collect();
        [0, 1, 2].map(|order| rows.iter().map(|r| r[order]).collect())
    };
    // Time in half lengths of the run about its middle.
    let place = |i: usize| (2 * i) as f64 / (N - 1) as f64 - 1.0;
    let half_s = (N - 1) as f64 * DT / 2.0;
    let rows: Vec<[Vec<f64>; 3]> = (0..N).map(|i| powers(place(i))).collect();
    let at = |order: usize| DMatrix::from_fn(N, 11, |i, j| rows[i][order][j]);
    let inverse = at(0).pseudo_inverse(1e-14).expect("a small number");
    for (k, s) in fit.channels.iter().enumerate() {
        let y = column(&samples, k);
        let c = &inverse * &y;
        for (order, (found, bound)) in [(&s.value, 1e-9), (&s.rate, 1e-8), (&s.second, 1e-6)].into_iter().enumerate() {
            let expected = at(order) * &c / half_s.powi(i32::try_from(order).expect("small"));
            let worst = (DVector::from_column_slice(found) - expected).norm();
            assert!(worst < bound, "{k} {order} {worst}");
        }
        let rss = (&y - at(0) * c).norm_squared();
        assert!((fit.noise_std[k] - (rss / (47 - 11) as f64).sqrt()).abs() < 1e-9);
        assert!((fit.bandwidth_hz[k] - 0.5 * 4.0 / (46.0 * DT)).abs() < 1e-12);
    }
}

/// Normal equations square the condition number: one solution leaves 3e-13, the second the round-off of 700 values below 8.
#[test]
fn exact_second_solution_restores_the_digits() {
    let n = 101;
    let samples = crooked(n);
    let grid = Grid::new(50, n);
    let factor = grid.factor().expect("enough samples");
    let (orders, _) = Arch::new().dispatch(Smoothing { grid: &grid, factor, samples: &samples, dt: 1.0 });
    let q = basis(50, n).qr().q();
    let off = |k: usize| {
        let y = column(&samples, k);
        (column(&orders[0], k) - &y + left_over(&q, &y)).norm_squared()
    };
    let all = (0..CHANNELS).map(off).sum::<f64>().sqrt();
    assert!(all < 1.2e-13, "{all}");
}

/// Numbers of intervals by hand: the run's 25 sample intervals over a knot's, at least one, two samples to each.
#[test]
fn exact_intervals_of_a_run() {
    assert_eq!([4.0, 4.2, 1.0, 100.0].map(|samples| intervals_of(samples, 26)), [6, 6, 12, 1]);
    assert_eq!([4.0, 1.0].map(|samples| intervals_of(samples, 27)), [7, 13]);
    for n in 16..200 {
        for intervals in 1..=intervals_of(2.0, n) {
            assert!(Grid::new(intervals, n).factor().is_ok(), "{intervals} {n}");
        }
    }
    let short = Grid::new(5, 9).factor().err();
    assert!(matches!(short, Some(PidError::TooFewSamples { samples: 9, needed: 13, .. })), "{short:?}");
}

/// Knot intervals tried one after the other with residuals by reflections, and what undersmoothing makes of the best.
#[test]
fn exact_choice_is_the_least_generalised_cross_validation() {
    const DT: f64 = 0.011;
    for (n, noise) in [(61, 1.0), (61, 0.1), (75, 0.003), (40, 0.03)] {
        let signal = |i: usize, k: usize| (0.17 * i as f64 + k as f64).sin() + noise * ((i * i + 5 * k) as f64).cos();
        let samples: Vec<WideRow> =
            (0..n).map(|i| std::array::from_fn(|k| if k < CHANNELS { signal(i, k) } else { 0.0 })).collect();
        let last = (n - 1) as f64;
        let tried = (0..20).map(|k| LONGEST_S / DT * RATIO.powi(k)).filter(|knot| *knot >= 2.0);
        let score = |knot: f64| {
            let intervals = ((last / knot).round() as usize).clamp(1, (n - 1) / 2);
            let q = basis(intervals, n).qr().q();
            let left = 1.0 - (intervals + 7) as f64 / n as f64;
            let of = |k| (left_over(&q, &column(&samples, k)).norm_squared() / left.powi(2)).ln();
            ((0..CHANNELS).map(of).sum::<f64>(), intervals)
        };
        let best = tried.map(score).min_by(|a, b| a.0.total_cmp(&b.0)).expect("some are tried").1;
        assert_eq!(cross_validate(&samples, DT), best);
        let expected = (best as f64 / 0.65).round().min((last / 2.0).floor());
        assert_eq!(choose(&samples, DT), expected as usize);
    }
    // A channel at rounding counts as 1e-28 of its sum of squares, one of zeros not at all.
    let mut rss = [0.0; WIDE];
    rss[2] = 0.3;
    let size2 = std::array::from_fn(|k| if k < 3 { 7.3 } else { 0.0 });
    let expected = (2.0 * (1e-28_f64 * 7.3).ln() + 0.3_f64.ln()) - 6.0 * 0.6_f64.ln();
    assert!((log_gcv(rss, size2, 0.6) - expected).abs() < 1e-12);
}

#[test]
fn exact_residual_keeps_seven_digits_however_small() {
    let n = 61;
    let grid = Grid::new(9, n);
    let q = basis(9, n).qr().q();
    // Residuals of 1e-2 of the sum of squares, and of 1e-12 beside a parabola, where a difference of sums has lost all but four.
    for beside in [false, true] {
        let parabola = |i: usize| 2e4 * (1.3 + (i as f64 / 40.0).powi(2));
        let at = |(i, r): (usize, WideRow)| {
            std::array::from_fn(|k| if k < CHANNELS && beside { parabola(i) + 0.1 * r[k] } else { r[k] })
        };
        let samples: Vec<WideRow> = crooked(n).into_iter().enumerate().map(at).collect();
        let size2 = sum_of_squares(&samples);
        let rss = Arch::new().dispatch(Trial { grid: &grid, samples: &samples, size2 }).expect("enough samples");
        for (k, rss) in rss.iter().enumerate().take(CHANNELS) {
            let y = column(&samples, k);
            assert!((size2[k] / y.norm_squared() - 1.0).abs() < 1e-14);
            assert!((rss / left_over(&q, &y).norm_squared() - 1.0).abs() < 1e-7);
        }
    }
}

/// Standard deviations of second derivatives by reflections: `R⁻ᵀ` times their row. Seventeen samples are four intervals, after which
/// places repeat: their mean in the middle of a run is that of every four intervals, as far as the ends do not reach.
#[test]
fn exact_weights_are_ratios_of_standard_deviations() {
    let n = 341;
    let grid = Grid::new(80, n);
    let r = basis(80, n).qr().r();
    let deviation = |i: usize| {
        let (first, x) = grid.place(i);
        let mut row = DVector::zeros(87);
        for (k, v) in grid.knots.slopes(first, x)[1].into_iter().enumerate() {
            row[first + k] = v;
        }
        r.tr_solve_upper_triangular(&row).expect("independent").norm()
    };
    let factor = grid.factor().expect("enough samples");
    // Where the forward solution ends 7e-13 is left out.
    assert!((0..n).all(|i| (grid.second_deviation(factor, i) / deviation(i) - 1.0).abs() < 2e-12));
    let middle = (162..179).map(deviation).sum::<f64>() / 17.0;
    for (i, w) in grid.weights(factor).into_iter().enumerate() {
        let expected = if (68..273).contains(&i) { 1.0 } else { (middle / deviation(i)).min(1.0) };
        assert!((w / expected - 1.0).abs() < 1e-3, "{i}: {w} {expected}");
    }
}
