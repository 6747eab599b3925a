//! pid tests: quality of fits by hand, the test for whiteness against plain sums and its closed form, the covariance of coloured
//! residuals against the sum over all frequencies one by one.

use super::super::problem::Solution;
use super::super::run::Nominal;
use super::super::run::tests::{SAMPLES, Shown, erring, flown};
use super::*;
use crate::StopReason;
use std::f64::consts::TAU;
use windfall_model::{Freedom, PerChannel, Plant, Record, Unknown, UnknownId, Unknowns};

/// Numbers that look like noise.
fn noise(n: usize, seed: usize) -> Vec<f64> {
    (0..n).map(|i| ((7 * i * i + 11 * seed + 3) as f64).sin() + 0.4 * ((13 * i * (seed + 1)) as f64).cos()).collect()
}

/// `Σ x(t) exp(-2πi k t/length)`.
fn fourier(x: &[f64], k: usize, length: usize) -> Complex64 {
    x.iter().enumerate().map(|(t, x)| Complex64::from_polar(*x, -TAU * (k * t) as f64 / length as f64)).sum()
}

fn low_p(series: &[&[f64]], interval_s: &[f64]) -> f64 {
    low_frequency_p(series, interval_s, &mut RealFftPlanner::new())
}

/// Probability that F of an even number of degrees of freedom `2m` over `d` is larger: with `y = d/(d + 2mF)`, `y^a Σ_{j<m}
/// (a)_j/j! (1 - y)^j`, `a = d/2` (Abramowitz and Stegun 1964, 26.6.4).
fn f_larger(f: f64, m: usize, d: f64) -> f64 {
    let (y, a) = (d / (d + 2.0 * m as f64 * f), 0.5 * d);
    let (mut term, mut sum) = (1.0, 0.0);
    for j in 0..m {
        sum += term;
        term *= (a + j as f64) / (j + 1) as f64 * (1.0 - y);
    }
    y.powf(a) * sum
}

/// Two series of unlike length and rate with some power added below 1 Hz.
#[test]
fn exact_whiteness_is_an_f_test_of_the_periodogram() {
    let slow = |n: usize, h: f64, size: f64| {
        noise(n, n).iter().enumerate().map(|(i, x)| x + size * (TAU * 0.7 * h * i as f64).sin()).collect::<Vec<f64>>()
    };
    let (a, b) = (slow(53, 0.07, 0.5), slow(40, 0.11, 0.7));
    let (mut high, mut low) = ((0.0, 0.0), [(0.0, 0_usize); 4]);
    for (x, h) in [(&a, 0.07), (&b, 0.11)] {
        let n = x.len();
        // Neither the mean nor the last frequency of an even length, which have one degree of freedom.
        for k in (1..n).filter(|k| 2 * k < n) {
            let (power, hz) = (fourier(x, k, n).norm_sqr() / n as f64, k as f64 / (n as f64 * h));
            if hz > 0.25 / h {
                high = (high.0 + power, high.1 + 2.0);
            }
            for (low, band) in low.iter_mut().zip([0.3, 1.0, 2.5, 6.0]) {
                if hz <= band {
                    *low = (low.0 + power, low.1 + 1);
                }
            }
        }
    }
    let smallest =
        low.map(|(sum, m)| f_larger(sum / (2 * m) as f64 / (high.0 / high.1), m, high.1)).into_iter().fold(1.0, f64::min);
    let found = low_p(&[&a, &b], &[0.07, 0.11]);
    // An incomplete beta function by its continued fraction, and sums of a hundred.
    assert!((1e-6..0.05).contains(&smallest) && (found / (4.0 * smallest) - 1.0).abs() < 1e-9, "{found} {}", 4.0 * smallest);
}

const STD: PerChannel<f64> = [7.5e-4, 8e-4, 9e-4, 1.1e-3, 1.9e-3, 2.1e-3, 2.6e-3];

/// Two parameters and a bias free; the second is known beforehand.
fn free(plant: &Plant) -> Unknowns {
    let one = |(i, value): (usize, &f64)| Unknown::linear(UnknownId::Parameter(i), "", *value, Freedom::Held(*value));
    let mut all: Vec<Unknown> = plant.aero.values.iter().enumerate().map(one).collect();
    (all[1].freedom, all[0].freedom) = (Freedom::Free(0), Freedom::Free(1));
    all.push(Unknown::linear(UnknownId::Nuisance("Ry_bias_rad"), "", 0.004, Freedom::Free(2)));
    let mut unknowns = Unknowns::from(all);
    unknowns.know(0, 6.0, 7e-4);
    unknowns
}

/// A solution by hand.
fn solved(runs: &[PreparedRun<'_>], unknowns: Unknowns, residuals: Vec<PerChannel<Vec<f64>>>, white: DMatrix<f64>) -> Solved {
    let (c, mut work) = (FreeColumns::of(&unknowns), Transition::default());
    let nominals: Vec<Nominal> = runs.iter().map(|r| r.smoothed.clone()).collect();
    let linear = runs.iter().zip(&nominals).map(|(r, n)| r.linearise(n, &c, &STD, &mut work).expect("flies")).collect();
    let solution = Solution {
        parameters: unknowns.parameters(),
        names: unknowns.names(),
        estimates: unknowns.values(),
        covariance: white,
        noise_std: STD,
        condition: 1.0,
        log_likelihood2: 0.0,
        iterations: 1,
        stop: StopReason::Converged,
    };
    Solved { solution, first: DMatrix::default(), unknowns, nominals, linear, residuals }
}

/// A record of a flight, and a shorter one as of a slower flight, so that an average is over more than its fewest frequencies
/// there.
fn records(plant: &Plant) -> [Record; 2] {
    let record = flown(plant, 0).record(plant, &Shown::default());
    let mut slow = record.clone();
    let keep = SAMPLES - 4;
    slow.t_s.iter_mut().for_each(|t| *t *= 50.0);
    let series = slow.position_m.iter_mut().chain(&mut slow.attitude_rad);
    series.chain([&mut slow.t_s, &mut slow.vw_m_s, &mut slow.ps_pa, &mut slow.ts_k]).for_each(|x| x.truncate(keep));
    [record, slow]
}

/// One less the residual's squares over those about the mean, over all runs; a channel far below its sensor's noise is not tried.
#[test]
fn exact_fits_by_hand() {
    assert!((spread(&[1.5, -0.5, 3.5]) - 8.0).abs() < 1e-15);
    let plant = erring();
    let records = records(&plant);
    let runs = records.each_ref().map(|r| PreparedRun::new("", r, &plant).expect("it can be integrated"));
    let residuals: Vec<PerChannel<Vec<f64>>> =
        runs.iter().map(|r| std::array::from_fn(|c| noise(r.record.len(), c).iter().map(|e| 0.03 * e).collect())).collect();
    let mut solved = solved(&runs, free(&plant), residuals, DMatrix::identity(3, 3));
    solved.solution.noise_std[1] = 1e-9;
    let fits = channel_fits(&runs, &solved);
    for (c, fit) in fits.iter().enumerate() {
        let (mut total, mut left) = (0.0, 0.0);
        for (record, residual) in records.iter().zip(&solved.residuals) {
            let x = record.channels()[c];
            let (n, sum): (f64, f64) = (x.len() as f64, x.iter().sum());
            total += x.iter().map(|x| x * x).sum::<f64>() - sum * sum / n;
            left += residual[c].iter().map(|e| e.powi(2)).sum::<f64>();
        }
        // Squares of R_x near 3 rad cancel to those about their mean.
        assert!((fit.r2 - (1.0 - left / total)).abs() < 1e-9 * (1.0 + left / total), "{c}: {} {left} {total}", fit.r2);
        assert!((fit.residual_std - solved.solution.noise_std[c]).abs() < 1e-18);
        let series = [solved.residuals[0][c].as_slice(), solved.residuals[1][c].as_slice()];
        let p = if c == 1 { 1.0 } else { low_p(&series, &runs.each_ref().map(|r| r.interval_s)) };
        assert!((fit.whiteness_p - p).abs() < 1e-15);
    }
}

/// `M⁻¹ (Σ_f Gᴴ P G) M⁻¹` over every frequency of twice the length by plain sums, negative ones too; P the mean over a quarter of a
/// hertz on either side, at least four frequencies, within the spectrum. Then no variance below that of white noise.
#[test]
fn exact_coloured_covariance_is_the_sum_over_all_frequencies() {
    let plant = erring();
    let records = records(&plant);
    let runs = records.each_ref().map(|r| PreparedRun::new("", r, &plant).expect("it can be integrated"));
    let residuals: Vec<PerChannel<Vec<f64>>> = runs
        .iter()
        .map(|r| std::array::from_fn(|c| noise(r.record.len(), c).iter().map(|e| STD[c] * (e + 0.7)).collect()))
        .collect();
    let unknowns = free(&plant);
    let (c, mut work) = (FreeColumns::of(&unknowns), Transition::default());
    let white = DMatrix::from_row_slice(3, 3, &[0.02, 0.003, -1e-4, 0.003, 0.004, 2e-5, -1e-4, 2e-5, 3e-6]) * 1e-5;
    let solved = solved(&runs, unknowns, residuals, white.clone());
    let mut middle = DMatrix::<f64>::zeros(3, 3);
    middle[(1, 1)] = 1.0 / (7e-4 * 7e-4);
    for (i, run) in runs.iter().enumerate() {
        let g = run.profiled_slopes(&solved.nominals[i], &solved.linear[i], &c, &mut work).expect("flies");
        let (n, half) = (run.record.len(), [4, 6][i]);
        let of = |x: &[f64]| (0..2 * n).map(|k| fourier(x, k, 2 * n)).collect::<Vec<_>>();
        let residual = solved.residuals[i].each_ref().map(|r| of(r));
        let g: Vec<Vec<Vec<Complex64>>> = g.iter().map(|g| g.iter().map(|g| of(g)).collect()).collect();
        for k in 0..2 * n {
            // A negative frequency has the conjugate of the positive one.
            let near: Vec<usize> = (0..=n).filter(|j| j.abs_diff(k.min(2 * n - k)) <= half).collect();
            let p = DMatrix::from_fn(CHANNELS, CHANNELS, |a, b| {
                let p =
                    near.iter().map(|j| residual[a][*j] * residual[b][*j].conj()).sum::<Complex64>() / (near.len() * n) as f64;
                if k > n { p.conj() } else { p }
            });
            let g = DMatrix::from_fn(CHANNELS, 3, |a, j| g[a][j][k] / STD[a].powi(2));
            middle += (g.adjoint() * p * g).map(|z| z.re) / (2 * n) as f64;
        }
    }
    let mut expected = &white * middle * &white;
    let found = coloured(&runs, &solved).expect("flies");
    let wider: Vec<f64> = (0..3).map(|i| white[(i, i)] / expected[(i, i)]).collect();
    assert!(wider.iter().any(|w| *w > 1.5) && wider.iter().any(|w| *w < 0.7), "{wider:?}");
    for i in 0..3 {
        for j in 0..3 {
            expected[(i, j)] *= (wider[i].max(1.0) * wider[j].max(1.0)).sqrt();
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            // Sums of 7 × 7 × 54 terms that partly cancel.
            let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
            assert!((found[(i, j)] - expected[(i, j)]).abs() < 1e-10 * scale, "{i} {j}: {found} {expected}");
        }
    }
}

/// A single pulse is white, at whatever half-width: its covariance is that of sums over time (Parseval), `Σ g gᵀ h²/n s⁻⁴` of its
/// channel.
#[test]
fn law_a_pulse_is_white() {
    let plant = erring();
    let [record, _] = records(&plant);
    let run = PreparedRun::new("", &record, &plant).expect("it can be integrated");
    let unknowns = free(&plant);
    let (c, mut work) = (FreeColumns::of(&unknowns), Transition::default());
    let height = 0.013;
    let mut residuals: PerChannel<Vec<f64>> = std::array::from_fn(|_| vec![0.0; SAMPLES]);
    residuals[4][9] = height;
    let solved = solved(std::slice::from_ref(&run), unknowns, vec![residuals], DMatrix::identity(3, 3));
    let g = run.profiled_slopes(&solved.nominals[0], &solved.linear[0], &c, &mut work).expect("flies");
    let mut expected = DMatrix::<f64>::zeros(3, 3);
    for t in 0..SAMPLES {
        let g = nalgebra::DVector::from_fn(3, |j, _| g[4][j][t]);
        expected += &g * g.transpose() * (height * height / (SAMPLES as f64 * STD[4].powi(4)));
    }
    expected[(1, 1)] += 7e-4_f64.powi(-2);
    let found = coloured(&[run], &solved).expect("flies");
    // More than one, which white noise is said to give: nothing is widened.
    assert!(expected.diagonal().min() > 1.0, "{expected}");
    for i in 0..3 {
        for j in 0..3 {
            let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
            assert!((found[(i, j)] - expected[(i, j)]).abs() < 1e-10 * scale, "{i} {j}: {found} {expected}");
        }
    }
}
