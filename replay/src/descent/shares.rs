//! replay: which source a scatter is from. In: a quantity and the parameters of each descent. Out: shares of its variance.

use super::result::ParameterShare;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};
use windfall_pid::NORMAL_95;

/// Singular values of scaled parameters below this share of the largest are no direction of their own (parameters tied to each other).
const SAME: f64 = 1e-9;

/// Share of the variance that parameters make, with its 95 % interval: correlation of pairs that share them and nothing else (Homma and
/// Saltelli 1996, eq. 2; standard error of a correlation `(1 − r²)/√n`).
pub(super) fn of_pairs(pairs: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let n = pairs.len() as f64;
    let mean = pairs.iter().flatten().sum::<f64>() / (2.0 * n);
    let variance = pairs.iter().flatten().map(|x| (x - mean).powi(2)).sum::<f64>() / (2.0 * n);
    let covariance = pairs.iter().map(|[a, b]| (a - mean) * (b - mean)).sum::<f64>() / n;
    if variance.is_nan() || variance <= 0.0 {
        return (0.0, [0.0; 2]);
    }
    let r = (covariance / variance).clamp(-1.0, 1.0);
    let error = NORMAL_95 * (1.0 - r * r) / n.sqrt();
    (r.max(0.0), [(r - error).clamp(0.0, 1.0), (r + error).clamp(0.0, 1.0)])
}

/// Columns of numbers less their means over their standard deviations; zeros where nothing varies.
fn standardised(x: &[f64]) -> (DVector<f64>, f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let std = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    let scale = if std > 0.0 { 1.0 / std } else { 0.0 };
    (DVector::from_iterator(x.len(), x.iter().map(|v| (v - mean) * scale)), std)
}

/// Parameters made ready for regressions of many quantities on them.
pub(super) struct Regressors {
    names: Vec<String>,
    /// Standardised, a column a parameter.
    x: DMatrix<f64>,
    /// Pseudo-inverse of their correlation over the number of descents.
    inverse: DMatrix<f64>,
    /// Models that differ.
    models: f64,
}

impl Regressors {
    /// `values`: a row a descent that landed; `models`: how many of these differ in their parameters.
    pub(super) fn new(names: Vec<String>, values: &[&[f64]], models: usize) -> Self {
        let (rows, n) = (values.len(), names.len());
        let mut x = DMatrix::zeros(rows, n);
        for k in 0..n {
            let column: Vec<f64> = values.iter().map(|v| v[k]).collect();
            x.set_column(k, &standardised(&column).0);
        }
        let correlation = x.transpose() * &x / rows.max(1) as f64;
        let svd = correlation.svd(true, true);
        let largest = svd.singular_values.iter().copied().fold(0.0, f64::max);
        let inverse = svd.pseudo_inverse(SAME * largest).unwrap_or_else(|_| DMatrix::zeros(n, n));
        Self { names, x, inverse, models: models as f64 }
    }

    /// Share that is linear in the parameters, and each parameter's, largest first.
    pub(super) fn shares(&self, quantity: &[f64]) -> (f64, Vec<ParameterShare>) {
        let (y, std) = standardised(quantity);
        let correlations = self.x.transpose() * &y / quantity.len().max(1) as f64;
        let coefficients = &self.inverse * &correlations;
        // Without any relation a squared correlation has the expectation 1/(n − 1), R² k/(n − 1); n models differ.
        let chance = 1.0 / (self.models - 1.0).max(1.0);
        let less = |square: f64, by: f64| ((square - by) / (1.0 - by).max(f64::EPSILON)).clamp(0.0, 1.0);
        let linear = less(correlations.dot(&coefficients), (chance * self.names.len() as f64).min(1.0));
        // A correlation as large as some parameter's comes by chance for one quantity of twenty (Bonferroni).
        let rare = Normal::standard().inverse_cdf(1.0 - 0.025 / self.names.len().max(1) as f64).powi(2) * chance;
        let one = |k: usize| {
            let square = correlations[k].powi(2);
            let share = if square > rare { less(square, chance) } else { 0.0 };
            ParameterShare {
                name: self.names[k].clone(),
                share,
                sign: if correlations[k] < 0.0 { -1 } else { 1 },
                standardised: coefficients[k],
                std_if_known: std * (1.0 - share).max(0.0).sqrt(),
            }
        };
        let mut all: Vec<ParameterShare> = (0..self.names.len()).map(one).collect();
        all.sort_by(|a, b| b.share.total_cmp(&a.share));
        (linear, all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use windfall_sim::{Channel, Seed};

    fn normal(run: u64, stream: u8) -> f64 {
        Seed { campaign: 5, run }.normals(Channel::Varied(stream)).next().unwrap_or(0.0)
    }

    /// Y = 3 a − b + 0·c + noise of 2: shares 9/14, 1/14, 0, of all 10/14; a correlated partner of a takes its share times ρ².
    /// Bounds: four standard errors, 4·2·√(share(1 − share)/20000) and less.
    #[test]
    fn recover_planted_shares() {
        let n = 20_000;
        let rows: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| normal(i / 2, k));
                vec![10.0 + a, 0.1 * b, c, 0.8 * a + 0.6 * d]
            })
            .collect();
        let y: Vec<f64> =
            rows.iter().enumerate().map(|(i, r)| 3.0 * (r[0] - 10.0) - 10.0 * r[1] + 2.0 * normal(i as u64, 9)).collect();
        let values: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let names = ["a", "b", "c", "d"].map(str::to_owned).to_vec();
        let regressors = Regressors::new(names, &values, rows.len() / 2);
        let (linear, shares) = regressors.shares(&y);
        assert!((linear - 10.0 / 14.0).abs() < 0.02, "{linear}");
        for (name, share, sign, coefficient) in
            [("a", 9.0 / 14.0, 1, 0.802), ("d", 0.64 * 9.0 / 14.0, 1, 0.0), ("b", 1.0 / 14.0, -1, -0.267), ("c", 0.0, 0, 0.0)]
        {
            let p = shares.iter().find(|p| p.name == name).expect("named");
            assert!((p.share - share).abs() < 0.025 && (p.standardised - coefficient).abs() < 0.025, "{p:?}");
            assert!(sign == 0 || p.sign == sign, "{p:?}");
        }
        assert_eq!(shares[0].name, "a");
        let pairs: Vec<[f64; 2]> = y.chunks_exact(2).map(|c| [c[0], c[1]]).collect();
        let (share, [low, high]) = of_pairs(&pairs);
        assert!((share - 10.0 / 14.0).abs() < 0.02 && low < share && share < high && high - low < 0.04, "{share} {low} {high}");
        // A parameter that is another one does not make the regression fail; together they say what one says.
        let twice: Vec<Vec<f64>> = rows.iter().map(|r| vec![r[0], r[0]]).collect();
        let values: Vec<&[f64]> = twice.iter().map(Vec::as_slice).collect();
        let (linear, both) = Regressors::new(vec!["a".to_owned(), "a2".to_owned()], &values, rows.len() / 2).shares(&y);
        assert!((linear - 9.0 / 14.0).abs() < 0.02 && (both[0].share - both[1].share).abs() < 1e-12, "{linear} {both:?}");
    }

    /// Correlation of pairs by Fisher 1925, §38: twice the sum of products over the sum of squares, both about the mean of all. Pairs (1, 3),
    /// (4, 8), (9, 5), five times with the mean moved from 5 to 105: 2·5/46.
    #[test]
    fn exact_correlation_of_pairs() {
        let three = [[101.0, 103.0], [104.0, 108.0], [109.0, 105.0]];
        let (share, [low, high]) = of_pairs(&three.repeat(5));
        let (r, reach) = (10.0 / 46.0, 1.959_964 * (1.0 - (10.0_f64 / 46.0).powi(2)) / 15_f64.sqrt());
        assert!((share - r).abs() < 1e-12 && low.abs() < 1e-300 && (high - r - reach).abs() < 1e-6, "{share} {low} {high}");
    }

    /// Two parameters of five descents that are not at right angles: R² = (r₁² + r₂² − 2 r₁ r₂ r₁₂)/(1 − r₁₂²) and coefficients
    /// (r₁ − r₂ r₁₂)/(1 − r₁₂²) as textbooks have them, less what chance has, of twenty models 1/19 a parameter.
    #[test]
    fn exact_shares_of_two_parameters() {
        let rows = [[1.0, 4.0], [2.0, 1.0], [4.0, 3.0], [7.0, 9.0], [9.0, 5.0]];
        let y = [2.0, -3.0, 4.0, 5.0, 13.0];
        let n = 5.0;
        let mean = |x: &[f64]| x.iter().sum::<f64>() / n;
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / n - mean(a) * mean(b);
        let r = |a: &[f64], b: &[f64]| product(a, b) / (product(a, a) * product(b, b)).sqrt();
        let [a, b] = [0, 1].map(|k| rows.map(|r| r[k]));
        let (r1, r2, r12) = (r(&a, &y), r(&b, &y), r(&a, &b));
        let values: Vec<&[f64]> = rows.iter().map(<[f64; 2]>::as_slice).collect();
        let (linear, shares) = Regressors::new(vec!["a".to_owned(), "b".to_owned()], &values, 20).shares(&y);
        let all = (r1 * r1 + r2 * r2 - 2.0 * r1 * r2 * r12) / (1.0 - r12 * r12);
        assert!((linear - (all - 2.0 / 19.0) / (17.0 / 19.0)).abs() < 1e-12, "{linear} {all}");
        // 97.5 % of two is a normal quantile of 2.2414.
        let share = |r: f64| if r * r > 2.2414_f64.powi(2) / 19.0 { (r * r - 1.0 / 19.0) / (18.0 / 19.0) } else { 0.0 };
        for (name, own, other) in [("a", r1, r2), ("b", r2, r1)] {
            let p = shares.iter().find(|p| p.name == name).expect("named");
            let std = (product(&y, &y) * (1.0 - share(own))).sqrt();
            assert!((p.standardised - (own - other * r12) / (1.0 - r12 * r12)).abs() < 1e-12, "{p:?}");
            assert!((p.share - share(own)).abs() < 1e-12 && (p.std_if_known - std).abs() < 1e-12, "{p:?}");
        }
    }
}
