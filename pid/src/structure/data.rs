//! pid: rows for choosing a structure. In: processed runs and a pool. Out: rows as they are, and whitened ones, of each run.

use super::pool::{Candidate, Pool};
use super::select::{Reduced, SelectionRows};
use crate::equation_error::{RunRows, cosines, faded};
use crate::regress::{Colour, PreparedColumns, RegressionSeries, spectra, whitened};
use nalgebra::{DMatrix, DVector};
use windfall_model::{Aero, Campaign, Coefficient, Contribution, Factor, Structure, Term};

/// Widths of bumps that stand in for any width while the noise's spectrum is estimated, rad.
const NUISANCE_RAD: [f64; 2] = [0.05, 0.15];

/// A pool's data, whitened.
pub(crate) struct PoolData<'a> {
    pub(crate) pool: &'a Pool,
    runs: &'a [RunRows],
    /// Candidates whose regressor is known: all but those with a width.
    pub(crate) linear: Vec<usize>,
    /// Per run, then coefficient.
    spectra: Vec<Vec<Vec<f64>>>,
    rows: Vec<SelectionRows>,
}

/// A coefficient less what effects that the plant declares add to it.
fn response(run: &RunRows, aero: &Aero, coefficient: Coefficient) -> Vec<f64> {
    let extra: Vec<_> = aero.extra.iter().filter(|(c, _, _)| *c == coefficient).collect();
    let rest = |row: &crate::coefficients::CoefficientRow| {
        row.exp_origin[coefficient as usize] - extra.iter().map(|(_, v, t)| v * t.value(&row.flow)).sum::<f64>()
    };
    run.rows.iter().map(rest).collect()
}

fn regressor(run: &RunRows, coefficient: Coefficient, contributions: &[(Coefficient, Term)]) -> Vec<f64> {
    let mine: Vec<&Term> = contributions.iter().filter(|(c, _)| *c == coefficient).map(|(_, t)| t).collect();
    run.rows.iter().map(|row| mine.iter().map(|t| t.value(&row.flow)).sum()).collect()
}

/// The candidate's contributions with another width of its bumps.
pub(crate) fn with_width(candidate: &Candidate, width: f64) -> Vec<(Coefficient, Term)> {
    let mut contributions = candidate.contributions.clone();
    for factor in contributions.iter_mut().flat_map(|(_, t)| &mut t.factors) {
        if let Factor::Bump(_, w) = factor {
            *w = width;
        }
    }
    contributions
}

/// Derivative of a candidate's regressor by its width: `d sech²(x/w)/dw = 2 x/w² tanh(x/w) sech²(x/w)`.
fn by_width(run: &RunRows, coefficient: Coefficient, contributions: &[(Coefficient, Term)]) -> Vec<f64> {
    let slope = |t: &Term, row: &crate::coefficients::CoefficientRow| {
        let bump = t.factors.iter().find_map(|f| match f {
            Factor::Bump(v, w) => Some((row.flow.get(*v), *w)),
            _ => None,
        });
        bump.map_or(0.0, |(x, w): (f64, f64)| 2.0 * x / (w * w) * (x / w).tanh() * t.value(&row.flow))
    };
    let mine: Vec<&Term> = contributions.iter().filter(|(c, _)| *c == coefficient).map(|(_, t)| t).collect();
    run.rows.iter().map(|row| mine.iter().map(|t| slope(t, row)).sum()).collect()
}

/// Whether a candidate acts anywhere in these runs.
fn excited(candidate: &Candidate, coefficients: &[Coefficient], runs: &[RunRows]) -> bool {
    let size = |k: &Coefficient| {
        runs.iter().map(|r| regressor(r, *k, &candidate.contributions).iter().map(|v| v * v).sum::<f64>()).sum::<f64>()
    };
    coefficients.iter().map(size).sum::<f64>() > 0.0
}

fn weighted(run: &RunRows, regressors: Vec<Vec<f64>>, response: Vec<f64>) -> RegressionSeries {
    RegressionSeries { regressors, response, weight: faded(run), residuals: Colour::Weighted(cosines(run)) }
}

impl<'a> PoolData<'a> {
    /// `None` where the data do not determine a spectrum: no rows, or fewer than candidates.
    pub(crate) fn new(pool: &'a Pool, runs: &'a [RunRows], aero: &Aero) -> Option<Self> {
        let usable = |c: &usize| !pool.candidates[*c].shaped && excited(&pool.candidates[*c], &pool.coefficients, runs);
        let linear: Vec<usize> = (0..pool.candidates.len()).filter(usable).collect();
        let nuisance: Vec<_> =
            pool.candidates.iter().filter(|c| c.shaped).flat_map(|c| NUISANCE_RAD.map(|w| with_width(c, w))).collect();
        let series = |run: &RunRows, coefficient: Coefficient| {
            let own = linear.iter().map(|&c| regressor(run, coefficient, &pool.candidates[c].contributions));
            let more = nuisance.iter().map(|n| regressor(run, coefficient, n));
            PreparedColumns::new(weighted(run, own.chain(more).collect(), response(run, aero, coefficient)))
        };
        let prepared: Vec<Vec<PreparedColumns>> =
            runs.iter().map(|run| pool.coefficients.iter().map(|c| series(run, *c)).collect()).collect();
        let flat: Vec<&PreparedColumns> = prepared.iter().flatten().collect();
        let mut found = spectra(&flat, &independent(&flat)?)?.into_iter();
        let mut spectra: Vec<Vec<Vec<f64>>> = Vec::new();
        let mut rows = Vec::new();
        for series in &prepared {
            let own: Vec<Vec<f64>> = found.by_ref().take(series.len()).collect();
            let parts: Option<Vec<_>> = series.iter().zip(&own).map(|(p, s)| whitened(p, s)).collect();
            rows.push(stacked(&parts?, linear.len()));
            spectra.push(own);
        }
        Some(Self { pool, runs, linear, spectra, rows })
    }

    /// Candidates that the campaign declares or that are in [`Structure::axisymmetric`], by what they are.
    pub(crate) fn usual(&self, campaign: &Campaign) -> Vec<usize> {
        let usual = Structure::axisymmetric();
        let own = &campaign.plant.aero.structure;
        let declared = own.contributions.iter().filter(|k| campaign.declared[k.parameter]);
        let known: Vec<&Contribution> = declared.chain(&usual.contributions).collect();
        let has = |(coefficient, term): &(Coefficient, Term)| {
            known.iter().any(|k| k.coefficient == *coefficient && k.term.factors == term.factors)
        };
        self.linear.iter().copied().filter(|&c| self.pool.candidates[c].contributions.iter().all(has)).collect()
    }

    /// The regression on whitened rows.
    pub(crate) fn reduced(&self) -> Reduced {
        Reduced::new(self.rows.clone())
    }

    /// The same with one more column, last, given over the rows of all runs.
    pub(crate) fn reduced_with(&self, column: &DVector<f64>) -> Reduced {
        let mut start = 0;
        let wider = |r: &SelectionRows| {
            let n = r.x.ncols();
            let mut x = r.x.clone().resize_horizontally(n + 1, 0.0);
            x.set_column(n, &column.rows(start, r.y.len()));
            start += r.y.len();
            SelectionRows { x, y: r.y.clone() }
        };
        Reduced::new(self.rows.iter().map(wider).collect())
    }

    /// Whitened rows of all runs: these linear candidates, and the response.
    pub(crate) fn base(&self, columns: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let n: usize = self.rows.iter().map(|r| r.y.len()).sum();
        let (mut x, mut y) = (DMatrix::zeros(n, columns.len()), DVector::zeros(n));
        let mut start = 0;
        for r in &self.rows {
            for (j, &c) in columns.iter().enumerate() {
                x.view_mut((start, j), (r.y.len(), 1)).copy_from(&r.x.column(c));
            }
            y.rows_mut(start, r.y.len()).copy_from(&r.y);
            start += r.y.len();
        }
        (x, y)
    }

    /// Whitened regressor of a candidate with a width, and its derivative by the width, over all runs.
    pub(crate) fn shaped(&self, candidate: &Candidate, width: f64) -> Option<[DVector<f64>; 2]> {
        let contributions = with_width(candidate, width);
        let mut out = [Vec::new(), Vec::new()];
        for (run, spectra) in self.runs.iter().zip(&self.spectra) {
            for (coefficient, spectrum) in self.pool.coefficients.iter().zip(spectra) {
                let columns = vec![regressor(run, *coefficient, &contributions), by_width(run, *coefficient, &contributions)];
                let nothing = vec![0.0; run.rows.len()];
                let (x, _) = whitened(&PreparedColumns::new(weighted(run, columns, nothing)), spectrum)?;
                out.iter_mut().zip(x.column_iter()).for_each(|(o, c)| o.extend(c.iter()));
            }
        }
        Some(out.map(DVector::from_vec))
    }
}

fn stacked(parts: &[(DMatrix<f64>, DVector<f64>)], columns: usize) -> SelectionRows {
    let n: usize = parts.iter().map(|p| p.1.len()).sum();
    let (mut x, mut y) = (DMatrix::zeros(n, columns), DVector::zeros(n));
    let mut start = 0;
    for (px, py) in parts {
        x.view_mut((start, 0), (py.len(), columns)).copy_from(&px.columns(0, columns));
        y.rows_mut(start, py.len()).copy_from(py);
        start += py.len();
    }
    SelectionRows { x, y }
}

/// Columns of which something is left when those before are taken out, on rows as they are.
fn independent(series: &[&PreparedColumns]) -> Option<Vec<usize>> {
    let rows = |p: &&PreparedColumns| p.amplitudes().map(|(x, y)| SelectionRows { x, y });
    let reduced = Reduced::new(series.iter().map(rows).collect::<Option<_>>()?);
    let mut order = reduced.path(&reduced.runs()).order;
    order.sort_unstable();
    Some(order)
}

/// The regression on rows as they are.
pub(crate) fn plain(pool: &Pool, linear: &[usize], runs: &[RunRows], aero: &Aero) -> Reduced {
    let rows = |run: &RunRows| {
        let parts: Vec<_> = pool
            .coefficients
            .iter()
            .map(|&c| {
                let n = run.rows.len();
                let columns: Vec<Vec<f64>> =
                    linear.iter().map(|&k| regressor(run, c, &pool.candidates[k].contributions)).collect();
                (DMatrix::from_fn(n, linear.len(), |i, j| columns[j][i]), DVector::from_vec(response(run, aero, c)))
            })
            .collect();
        stacked(&parts, linear.len())
    };
    Reduced::new(runs.iter().map(rows).collect())
}

#[cfg(test)]
mod tests;
