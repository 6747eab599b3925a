//! pid: which columns a regression needs. In: rows of several runs. Out: chosen columns by each criterion.
//!
//! Each run is reduced to a triangle once (Householder QR of `[X | y]`); every subset's regression is then one of a few dozen
//! rows. Orthogonalising by QR is Gram and Schmidt's way done stably: what a column adds, once those before it are taken out of it, is
//! the fall of the sum of squares (Morelli, J. Aircraft 32(2), 1995; Klein and Morelli 2006, §5.4.2).

use super::criterion::Criterion;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chance that any spurious term of a pool enters by [`Criterion::F`].
pub const FAMILY_ERROR: f64 = 0.01;
/// Threshold of the partial F that practice uses for white residuals.
const WHITE_F: f64 = 4.0;
/// A column of which less than this part is left when those before are taken out is no column of its own.
const OWN_PART: f64 = 1e-6;
/// Most columns of which all subsets are tried.
const MOST_FREE: usize = 14;

/// Rows of one run.
#[derive(Clone, Debug)]
pub(crate) struct SelectionRows {
    pub(crate) x: DMatrix<f64>,
    pub(crate) y: DVector<f64>,
}

/// A regression over several runs, each as a triangle.
pub(crate) struct Reduced {
    triangles: Vec<DMatrix<f64>>,
    rows: Vec<SelectionRows>,
    /// Squared length of each column over all runs.
    lengths: Vec<f64>,
    pub(crate) count: usize,
    columns: usize,
}

/// A subset's regression.
#[derive(Clone, Debug)]
pub(crate) struct SolvedSubset {
    pub(crate) rss: f64,
    pub(crate) estimate: DVector<f64>,
    /// (XᵀX)⁻¹.
    pub(crate) bread: DMatrix<f64>,
}

/// One more column at a time, that which explains most first.
#[derive(Clone, Debug)]
pub(crate) struct Path {
    pub(crate) order: Vec<usize>,
    /// Sum of squares left with the first 0, 1, 2, … columns.
    pub(crate) rss: Vec<f64>,
}

impl Reduced {
    /// The same without the rows themselves, for which only [`Criterion::Press`] asks.
    pub(crate) fn without_rows(mut self) -> Self {
        self.rows.clear();
        self
    }

    pub(crate) fn new(rows: Vec<SelectionRows>) -> Self {
        let columns = rows.first().map_or(0, |r| r.x.ncols());
        let triangle = |r: &SelectionRows| {
            let mut a = DMatrix::zeros(r.x.nrows().max(columns + 1), columns + 1);
            a.view_mut((0, 0), r.x.shape()).copy_from(&r.x);
            a.view_mut((0, columns), (r.y.len(), 1)).copy_from(&r.y);
            a.qr().unpack_r().rows(0, columns + 1).into_owned()
        };
        let triangles = rows.iter().map(triangle).collect();
        let lengths = (0..columns).map(|j| rows.iter().map(|r| r.x.column(j).norm_squared()).sum()).collect();
        let count = rows.iter().map(|r| r.y.len()).sum();
        Self { triangles, rows, lengths, count, columns }
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// Column, estimate and standard error of each of these columns.
    pub(crate) fn estimates(&self, chosen: &[usize]) -> Vec<(usize, f64, f64)> {
        let Some(solved) = self.solve(&self.runs(), chosen) else { return Vec::new() };
        let variance = solved.rss / (self.count - chosen.len()).max(1) as f64;
        let one = |(i, &c): (usize, &usize)| (c, solved.estimate[i], (solved.bread[(i, i)] * variance).sqrt());
        chosen.iter().enumerate().map(one).collect()
    }

    pub(crate) fn runs(&self) -> Vec<usize> {
        (0..self.triangles.len()).collect()
    }

    /// Stacked triangle of chosen columns and the response over some runs.
    fn triangle(&self, runs: &[usize], columns: &[usize]) -> DMatrix<f64> {
        let (n, height) = (columns.len(), self.columns + 1);
        let mut a = DMatrix::zeros(runs.len() * height, n + 1);
        for (k, &run) in runs.iter().enumerate() {
            for (j, &c) in columns.iter().chain(std::iter::once(&self.columns)).enumerate() {
                a.view_mut((k * height, j), (height, 1)).copy_from(&self.triangles[run].column(c));
            }
        }
        a.qr().unpack_r()
    }

    /// Least squares on some columns over some runs; `None` where the last column has nothing of its own.
    pub(crate) fn solve(&self, runs: &[usize], columns: &[usize]) -> Option<SolvedSubset> {
        let n = columns.len();
        let r = self.triangle(runs, columns);
        let own = |j: usize| r[(j, j)].powi(2) > OWN_PART.powi(2) * self.lengths[columns[j]].max(f64::MIN_POSITIVE);
        if !(0..n).all(own) {
            return None;
        }
        let rss = r[(n, n)].powi(2);
        let inverse = r.view((0, 0), (n, n)).solve_upper_triangular(&DMatrix::identity(n, n))?;
        let estimate = &inverse * r.view((0, n), (n, 1)).column(0);
        Some(SolvedSubset { rss, estimate, bread: &inverse * inverse.transpose() })
    }

    fn rss(&self, runs: &[usize], columns: &[usize]) -> Option<f64> {
        self.solve(runs, columns).map(|s| s.rss)
    }

    /// Sum of squares that an estimate leaves in one run.
    fn left(&self, run: usize, columns: &[usize], estimate: &DVector<f64>) -> f64 {
        let t = &self.triangles[run];
        let mut e = t.column(self.columns).into_owned();
        columns.iter().zip(estimate.iter()).for_each(|(&c, p)| e.axpy(-p, &t.column(c), 1.0));
        e.norm_squared()
    }

    /// Columns by what they explain once those before are taken out; those with nothing of their own are left out.
    pub(crate) fn path(&self, runs: &[usize]) -> Path {
        let mut path = Path { order: Vec::new(), rss: vec![self.rss(runs, &[]).unwrap_or(0.0)] };
        loop {
            let with = |c: usize| Some((c, self.rss(runs, &[path.order.as_slice(), &[c]].concat())?));
            let left = (0..self.columns).filter(|c| !path.order.contains(c));
            let Some((c, rss)) = left.filter_map(with).min_by(|a, b| a.1.total_cmp(&b.1)) else { return path };
            path.order.push(c);
            path.rss.push(rss);
        }
    }

    /// Residual variance of all columns together.
    pub(crate) fn variance(&self) -> f64 {
        let r = self.triangle(&self.runs(), &(0..self.columns).collect::<Vec<_>>());
        r[(self.columns, self.columns)].powi(2) / (self.count - self.columns).max(1) as f64
    }

    /// Each row's residual were it not used, squared and summed.
    fn press(&self, columns: &[usize]) -> Option<f64> {
        let solved = self.solve(&self.runs(), columns)?;
        let mut sum = 0.0;
        for r in &self.rows {
            for i in 0..r.y.len() {
                let x = DVector::from_iterator(columns.len(), columns.iter().map(|&c| r.x[(i, c)]));
                let leverage = (&solved.bread * &x).dot(&x);
                sum += ((r.y[i] - x.dot(&solved.estimate)) / (1.0 - leverage).max(f64::EPSILON)).powi(2);
            }
        }
        Some(sum)
    }

    /// Sum of squares of each run predicted from the other runs with 0, 1, 2, … columns, which each of these sets of runs puts in
    /// its own order; and these orders. `None` for fewer than two runs.
    pub(crate) fn cross_validation(&self) -> Option<(Vec<f64>, Vec<Path>)> {
        let runs = self.runs();
        if runs.len() < 2 {
            return None;
        }
        let others = |out: usize| runs.iter().copied().filter(|r| *r != out).collect::<Vec<_>>();
        let paths: Vec<Path> = runs.iter().map(|&out| self.path(&others(out))).collect();
        let longest = paths.iter().map(|p| p.order.len()).min()?;
        let at = |n: usize| -> Option<f64> {
            runs.iter()
                .map(|&out| {
                    let columns = &paths[out].order[..n];
                    Some(self.left(out, columns, &self.solve(&others(out), columns)?.estimate))
                })
                .sum()
        };
        Some(((0..=longest).map_while(at).collect(), paths))
    }

    /// Stepwise: the best column enters where its partial F exceeds the threshold, then those leave that no longer do.
    fn stepwise(&self, variance: Option<f64>, threshold: f64) -> Vec<usize> {
        let runs = self.runs();
        let mut chosen: Vec<usize> = Vec::new();
        let s2 = |rss: f64, n: usize| variance.unwrap_or(rss / (self.count - n).max(1) as f64).max(f64::MIN_POSITIVE);
        for _ in 0..4 * self.columns {
            let before = chosen.clone();
            let Some(now) = self.rss(&runs, &chosen) else { break };
            let with = |c: usize| Some((c, self.rss(&runs, &[chosen.as_slice(), &[c]].concat())?));
            let best = (0..self.columns).filter(|c| !chosen.contains(c)).filter_map(with).min_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((c, rss)) = best
                && (now - rss) / s2(rss, chosen.len() + 1) > threshold
            {
                chosen.push(c);
            }
            chosen = self.pruned(chosen, threshold, |chosen, c| {
                let all = self.rss(&runs, chosen)?;
                let without: Vec<usize> = chosen.iter().copied().filter(|k| *k != c).collect();
                Some((self.rss(&runs, &without)? - all) / s2(all, chosen.len()))
            });
            if chosen == before {
                break;
            }
        }
        chosen.sort_unstable();
        chosen
    }

    /// Drops the weakest column while it is below the threshold.
    fn pruned(&self, mut chosen: Vec<usize>, threshold: f64, strength: impl Fn(&[usize], usize) -> Option<f64>) -> Vec<usize> {
        loop {
            let strengths = chosen.iter().map(|&c| (c, strength(&chosen, c).unwrap_or(0.0)));
            match strengths.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((c, f)) if f <= threshold => chosen.retain(|k| *k != c),
                _ => return chosen,
            }
        }
    }

    /// The subset of `free` with the least `RSS/σ² + penalty n`, by trying all, columns `given` being in anyway; sorted. `None` for
    /// more than [`MOST_FREE`] columns.
    pub(crate) fn subset(
        &self,
        runs: &[usize],
        given: &[usize],
        free: &[usize],
        variance: f64,
        penalty: f64,
    ) -> Option<Vec<usize>> {
        if free.len() > MOST_FREE {
            return None;
        }
        let (g, k) = (given.len(), free.len());
        let r = self.triangle(runs, &[given, free].concat());
        let t = r.view((g, g), (k + 1, k + 1)).into_owned();
        let value = |set: u32| -> Option<f64> {
            let columns: Vec<usize> = (0..k).filter(|j| set & (1 << j) != 0).collect();
            let n = columns.len();
            let mut a = DMatrix::zeros(k + 1, n + 1);
            columns.iter().chain([&k]).enumerate().for_each(|(j, &c)| a.set_column(j, &t.column(c)));
            let r = a.qr().unpack_r();
            let own = |j: usize| r[(j, j)].powi(2) > OWN_PART.powi(2) * self.lengths[free[columns[j]]].max(f64::MIN_POSITIVE);
            (0..n).all(own).then(|| r[(n, n)].powi(2) / variance + penalty * n as f64)
        };
        let all = (0..1_u32 << k).filter_map(|set| Some((set, value(set)?)));
        let (best, _) = all.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut chosen: Vec<usize> = (0..k).filter(|j| best & (1 << j) != 0).map(|j| free[j]).collect();
        chosen.sort_unstable();
        Some(chosen)
    }

    /// Square of a column's estimate over its standard error when each run may have its own: the scatter between runs beyond that
    /// of noise counts as error (DerSimonian and Laird, Control. Clin. Trials 7, 1986).
    pub(crate) fn agreement(&self, chosen: &[usize], column: usize, variance: f64) -> Option<f64> {
        let last: Vec<usize> = chosen.iter().copied().filter(|c| *c != column).chain([column]).collect();
        let n = last.len();
        let alone = |run: usize| {
            let r = self.triangle(&[run], &last);
            let information = r[(n - 1, n - 1)].powi(2) / variance;
            let own = r[(n - 1, n - 1)].powi(2) > OWN_PART.powi(2) * self.lengths[column];
            own.then(|| (r[(n - 1, n)] / r[(n - 1, n - 1)], information))
        };
        let each: Vec<(f64, f64)> = self.runs().into_iter().filter_map(alone).collect();
        let total: f64 = each.iter().map(|e| e.1).sum();
        if total <= 0.0 {
            return None;
        }
        let mean = each.iter().map(|(b, w)| b * w).sum::<f64>() / total;
        let q: f64 = each.iter().map(|(b, w)| w * (b - mean).powi(2)).sum();
        let spare = total - each.iter().map(|e| e.1 * e.1).sum::<f64>() / total;
        let between = if spare > 0.0 { ((q - (each.len() as f64 - 1.0)) / spare).max(0.0) } else { 0.0 };
        let weights = || each.iter().map(|(b, w)| (b, 1.0 / (1.0 / w + between)));
        let sum: f64 = weights().map(|w| w.1).sum();
        let pooled = weights().map(|(b, w)| b * w).sum::<f64>() / sum;
        // All runs together tell more than the runs alone; scatter between them then counts in proportion.
        let solved = self.solve(&self.runs(), &last)?;
        let own = solved.bread[(n - 1, n - 1)] * variance;
        let together = solved.estimate[n - 1].powi(2) / (own * (total / sum).max(1.0));
        Some(if between > 0.0 { together.min(pooled * pooled * sum) } else { together })
    }

    /// Chosen columns and the criterion's value with the first 0, 1, 2, … columns (none for stepwise ones). `white`: rows as they
    /// are, with a noise that each fit tells; otherwise whitened rows.
    pub(crate) fn choose(&self, criterion: Criterion) -> Option<(Vec<usize>, Vec<f64>)> {
        let (runs, n) = (self.runs(), self.count as f64);
        let least = |path: &Path, values: Vec<f64>| {
            let best = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
            let mut chosen = path.order[..best.min(path.order.len())].to_vec();
            chosen.sort_unstable();
            (chosen, values)
        };
        let penalised = |each: f64| {
            let path = self.path(&runs);
            let values = path.rss.iter().enumerate().map(|(k, rss)| (rss + each * k as f64) / n).collect();
            least(&path, values)
        };
        let all: Vec<usize> = (0..self.columns).collect();
        let family = || threshold(FAMILY_ERROR / self.columns as f64, 1.0);
        Some(match criterion {
            Criterion::WhiteF => (self.stepwise(None, WHITE_F), Vec::new()),
            Criterion::WhitePse => penalised(self.response_variance()),
            Criterion::Pse => penalised(2.0 * self.variance()),
            Criterion::Bic => penalised(self.variance() * n.ln()),
            Criterion::Press => {
                let path = self.path(&runs);
                let values = (0..=path.order.len()).map_while(|k| self.press(&path.order[..k]).map(|p| p / n)).collect();
                least(&path, values)
            }
            Criterion::CrossValidation => {
                let values = self.cross_validation()?.0.iter().map(|v| v / n).collect();
                least(&self.path(&runs), values)
            }
            Criterion::F => (self.stepwise(Some(self.variance()), family()), Vec::new()),
            Criterion::Subset => (self.subset(&runs, &[], &all, self.variance(), family())?, Vec::new()),
            Criterion::Likelihood => return None,
            Criterion::Agreed => {
                let variance = self.variance();
                let chosen = self.subset(&runs, &[], &all, variance, family())?;
                (self.pruned(chosen, family(), |chosen, c| self.agreement(chosen, c, variance)), Vec::new())
            }
        })
    }

    /// Fall of the sum of squares by a column, entering or not leaving, over the variance that all columns leave.
    pub(crate) fn partial_f(&self, chosen: &[usize], column: usize) -> Option<f64> {
        let without: Vec<usize> = chosen.iter().copied().filter(|c| *c != column).collect();
        let with = [without.as_slice(), &[column]].concat();
        Some((self.rss(&self.runs(), &without)? - self.rss(&self.runs(), &with)?) / self.variance())
    }

    /// For each column, the share of runs left out in turn without which `choose` still has it; `None` for one run.
    pub(crate) fn fold_shares(&self, choose: impl Fn(&[usize]) -> Vec<usize>) -> Option<Vec<f64>> {
        let runs = self.runs();
        let without = |out: &usize| choose(&runs.iter().copied().filter(|r| r != out).collect::<Vec<_>>());
        let folds: Vec<Vec<usize>> = if runs.len() > 1 { runs.iter().map(without).collect() } else { return None };
        let share = |c: usize| folds.iter().filter(|f| f.contains(&c)).count() as f64 / folds.len() as f64;
        Some((0..self.columns).map(share).collect())
    }

    /// The best subset of all columns with [`Criterion::Subset`]'s penalty, over some runs.
    pub(crate) fn best(&self, runs: &[usize]) -> Vec<usize> {
        let all: Vec<usize> = (0..self.columns).collect();
        let penalty = threshold(FAMILY_ERROR / self.columns.max(1) as f64, 1.0);
        self.subset(runs, &[], &all, self.variance(), penalty).unwrap_or_default()
    }

    /// Variance of the response about its mean.
    fn response_variance(&self) -> f64 {
        let n = self.count as f64;
        let mean = self.rows.iter().map(|r| r.y.sum()).sum::<f64>() / n;
        self.rows.iter().flat_map(|r| r.y.iter()).map(|y| (y - mean).powi(2)).sum::<f64>() / n
    }
}

/// Value that a χ² of this freedom exceeds with this probability: partial F with very many rows.
pub(crate) fn threshold(probability: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::INFINITY, |c| c.inverse_cdf(1.0 - probability))
}

#[cfg(test)]
pub(crate) mod tests;
