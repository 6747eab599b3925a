//! pid tests: selection on problems whose answer theory gives.

use super::criterion::Criterion;
use super::select::tests::{crooked, dense};
use super::select::{FAMILY_ERROR, Reduced, SelectionRows};
use super::{Likely, gained};
use crate::regress::{Colour, PreparedColumns, RegressionSeries, spectra, whitened};
use nalgebra::{DMatrix, DVector};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

struct Chance(ChaCha8Rng);

impl Chance {
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
    /// White rows of a run: `truth` times the first columns, plus noise.
    fn rows(&mut self, n: usize, columns: usize, truth: &[f64]) -> SelectionRows {
        let x = DMatrix::from_fn(n, columns, |_, _| self.normal());
        let y = DVector::from_fn(n, |i, _| truth.iter().enumerate().map(|(j, t)| t * x[(i, j)]).sum::<f64>() + self.normal());
        SelectionRows { x, y }
    }
}

/// Share of `draws` in which something happens, and 3.5 standard deviations of a share that is `p`.
fn share(draws: usize, p: f64, mut happens: impl FnMut() -> bool) -> (f64, f64) {
    let count = (0..draws).filter(|_| happens()).count();
    (count as f64 / draws as f64, 3.5 * (p * (1.0 - p) / draws as f64).sqrt())
}

/// One column, two runs that tell as much: predicting each from the other gains where `4 b₁ b₂ > b₁² + b₂²`, that is for directions of
/// (b₁, b₂) from 15 to 75 deg and their opposites. A column that is not there has every direction alike: it enters one time in three.
#[test]
fn exact_cross_validation_of_two_runs_takes_a_third_of_what_is_not_there() {
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(1));
    let gains = || {
        // One row of length one in each run: as much information, a slope with normal error.
        let run = |c: &mut Chance| SelectionRows { x: DMatrix::from_element(1, 1, 1.0), y: DVector::from_element(1, c.normal()) };
        let reduced = Reduced::new(vec![run(&mut chance), run(&mut chance)]);
        let (values, _) = reduced.cross_validation().expect("two runs");
        values[1] < values[0]
    };
    let (found, within) = share(3000, 1.0 / 3.0, gains);
    assert!((found - 1.0 / 3.0).abs() < within, "{found}");
}

/// White rows, two true columns of ten, each 20 standard errors: kept always; any other enters with the stated chance at most.
#[test]
fn recover_subset_and_f_err_as_often_as_they_say() {
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(2));
    let draws = 400;
    let mut wrong = [0_usize; 2];
    for _ in 0..draws {
        let runs = (0..2).map(|_| chance.rows(100, 10, &[1.5, -1.5])).collect();
        let reduced = Reduced::new(runs);
        for (count, criterion) in wrong.iter_mut().zip([Criterion::Subset, Criterion::F]) {
            let (chosen, _) = reduced.choose(criterion).expect("chooses");
            assert!(chosen.starts_with(&[0, 1]), "{criterion:?}: {chosen:?}");
            *count += usize::from(chosen.len() > 2);
        }
    }
    // 200 rows: the variance's own error makes the chance a fifth larger.
    let p = 1.2 * FAMILY_ERROR;
    let within = 3.5 * (p * (1.0 - p) / draws as f64).sqrt();
    for count in wrong {
        assert!((count as f64) < draws as f64 * (p + within), "{wrong:?} of {draws}");
    }
}

/// Residuals smoothed over 30 samples: rows taken as white let nearly always something in, whitened ones as often as is stated.
#[test]
fn recover_level_under_colour() {
    let (n, columns, width) = (3000, 6, 30);
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(3));
    let smooth = |x: &[f64]| -> Vec<f64> { x.windows(width).map(|w| w.iter().sum::<f64>() / width as f64).collect() };
    let mut white = 0;
    let mut own = 0;
    let draws = 120;
    for _ in 0..draws {
        let mut column = || smooth(&(0..n + width - 1).map(|_| chance.normal()).collect::<Vec<_>>());
        let regressors: Vec<Vec<f64>> = (0..columns).map(|_| column()).collect();
        let response = column();
        let fade = |i: usize| (std::f64::consts::FRAC_PI_2 * ((i.min(n - 1 - i) as f64 + 0.5) / 90.0).min(1.0)).sin().powi(2);
        let weight: Vec<f64> = (0..n).map(fade).collect();
        let x = DMatrix::from_fn(n, columns, |i, j| regressors[j][i]);
        let plain = Reduced::new(vec![SelectionRows { x, y: DVector::from_column_slice(&response) }]);
        white += usize::from(!plain.choose(Criterion::WhiteF).expect("chooses").0.is_empty());
        // Up to the smoothing's first zero.
        let residuals = Colour::Weighted(2 * n / width);
        let series = PreparedColumns::new(RegressionSeries { regressors, response, weight, residuals });
        let spectrum = spectra(&[&series], &(0..columns).collect::<Vec<_>>()).expect("enough rows").remove(0);
        let (x, y) = whitened(&series, &spectrum).expect("cosines");
        own += usize::from(!Reduced::new(vec![SelectionRows { x, y }]).choose(Criterion::Subset).expect("chooses").0.is_empty());
    }
    assert!(white > 9 * draws / 10, "{white} of {draws}");
    // 200 amplitudes whose spectrum is known to 20 % (25 neighbours): up to 3 % instead of 1 %, and 3.5 of its standard deviations.
    let p = 3.0 * FAMILY_ERROR;
    let most = draws as f64 * (p + 3.5 * (p * (1.0 - p) / draws as f64).sqrt());
    assert!((own as f64) < most, "{own} of {draws}");
}

/// A column whose slope differs from run to run by far more than noise is no agreed term; one that is the same in all is.
#[test]
fn law_agreed_terms_hold_in_every_run() {
    let mut chance = Chance(ChaCha8Rng::seed_from_u64(4));
    let runs: Vec<SelectionRows> = [5.0, 1.0, 0.3].iter().map(|odd| chance.rows(200, 3, &[2.0, *odd])).collect();
    let reduced = Reduced::new(runs);
    let by = |c| reduced.choose(c).expect("chooses").0;
    assert_eq!(by(Criterion::Subset), [0, 1]);
    assert_eq!(by(Criterion::Agreed), [0]);
}

/// What a column more brings beside other terms, by dense sums of squares: `RSS/σ²` without and with it, each term but that column at its
/// price.
#[test]
fn exact_gain_of_a_column_more() {
    let rows = crooked(&[9, 7]);
    let narrow = rows.iter().map(|r| SelectionRows { x: r.x.columns(0, 3).into_owned(), y: r.y.clone() }).collect();
    let all: Vec<&SelectionRows> = rows.iter().collect();
    let rss = |columns: &[usize]| dense(&all, columns).1;
    let variance = rss(&[0, 1, 2, 3]) / 12.0;
    let found = gained([&Reduced::new(narrow), &Reduced::new(rows.clone())], [&[0, 1], &[1]], 3.7).expect("their own");
    let expected = rss(&[0, 1]) / variance + 2.0 * 3.7 - rss(&[1, 3]) / variance - 3.7;
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

/// Terms of one pool among those of all: counted from its first column, with estimates of all together.
#[test]
fn exact_terms_of_one_pool_among_all() {
    let rows = crooked(&[9, 7]);
    let all: Vec<&SelectionRows> = rows.iter().collect();
    let (b, rss, bread) = dense(&all, &[1, 3, 2]);
    let columns = vec![vec![0, 1], vec![], vec![2, 3]];
    let likely =
        Likely { reduced: Reduced::new(rows.clone()), columns, chosen: vec![vec![1], vec![], vec![3, 2]], settled: true };
    assert_eq!([0, 1, 2].map(|p| likely.own(p)), [vec![1], vec![], vec![1, 0]]);
    let regressed = likely.regressed(2);
    assert_eq!(regressed.partial_f.len(), 2);
    let [first, second] = regressed.estimates[..] else { panic!("two terms") };
    for ((column, estimate, std_error), (k, i)) in [first, second].into_iter().zip([(1, 1), (0, 2)]) {
        assert_eq!(column, k);
        assert!((estimate / b[i] - 1.0).abs() < 1e-9 && (std_error / (bread[(i, i)] * rss / 13.0).sqrt() - 1.0).abs() < 1e-9);
    }
}
