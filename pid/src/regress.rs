//! pid: least squares (thesis §4.2). In: stacked series of responses and regressors. Out: estimates and their accuracy.

mod colour;
mod lagged;
mod noisy;
mod quality;
mod reflect;
mod spectral;

use crate::PidError;
use crate::interval::NORMAL_95;
use nalgebra::{DMatrix, DVector};
use reflect::Triangle;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// One coefficient over one run: what the regression stacks. Residuals may be correlated within a series, never between two.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegressionSeries {
    /// One column per parameter, each as long as `response`.
    pub regressors: Vec<Vec<f64>>,
    /// Measured coefficient.
    pub response: Vec<f64>,
    /// Factor of each row, in [0, 1]; empty means ones.
    pub weight: Vec<f64>,
    /// What its residuals are like.
    pub residuals: Colour,
}

/// What is assumed of residuals within a series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colour {
    /// White: ordinary least squares with the standard errors of eqs 4.17-4.20.
    #[default]
    White,
    /// Any colour, estimates as they are for white ones; standard errors of Morelli and Klein 1997, autocorrelation up to this
    /// lag in samples.
    Corrected(usize),
    /// Any colour that is stationary; estimates weighted by the inverse of the residuals' own spectrum over this many cosines
    /// (2 · duration · bandwidth).
    Weighted(usize),
}

/// Result of a regression.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressionFit {
    /// Estimates (eq. 4.15, or weighted by spectrum).
    pub estimate: Vec<f64>,
    /// Covariance for white residuals (eq. 4.19), of the ordinary estimate.
    pub covariance_white: DMatrix<f64>,
    /// Covariance of the estimates as the series' residuals are declared.
    pub covariance: DMatrix<f64>,
    /// Coefficient of determination (eq. 4.18), of the weighted rows.
    pub r2: f64,
    /// Residual variance s² (eq. 4.17), of the weighted rows.
    pub s2: f64,
    /// Condition number of the regressor matrix with columns scaled to unit length.
    pub condition: f64,
    /// Weighted residuals, per series.
    pub residuals: Vec<Vec<f64>>,
    /// Degrees of freedom that the residuals leave.
    pub freedom: f64,
    /// Probability that white residuals look as coloured as these (Ljung and Box 1978, 20 lags).
    pub whiteness_p: f64,
    /// Number of rows.
    pub rows: usize,
    /// Half-width of each estimate's 95 % interval, standard errors.
    pub half_width: Vec<f64>,
    /// Why an estimate is none.
    pub refused: Vec<Option<Refusal>>,
    /// What else than the instruments' noise is in the residual, where that was asked for and is beyond chance.
    pub driven: Option<Driven>,
}

/// Why regression cannot estimate a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// Its regressor, the others taken out, is mostly the instruments' noise: power of the motion over that of the noise.
    Noise {
        /// Below 1; not above 0 where noise alone explains the regressor.
        signal_to_noise: f64,
    },
    /// Something drives body and residual alike, and the motion of a while before tells too little of that of now.
    Weak {
        /// F of the first stage.
        strength: f64,
    },
}

/// A residual beyond the instruments' noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driven {
    /// Its power over that of the noise, where it moves an estimate most.
    pub ratio: f64,
    /// Time before of the instruments, diameters of flow.
    pub lag: u32,
}

/// What a regression gives, or which column it cannot have.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RegressionOutcome {
    /// Full rank.
    Fit(Box<RegressionFit>),
    /// The data do not determine all parameters; the column is the one that weighs most in the undetermined combination.
    Deficient {
        /// Column to leave out.
        column: usize,
        /// Numerical rank.
        rank: usize,
    },
}

/// Singular values of the scaled regressors below this share of the largest count as zero: well above rounding of the QR of
/// 1e4 rows (1e-14), well below any condition number that leaves digits in an estimate.
const RANK_TOLERANCE: f64 = 1.0e-10;

/// Least squares by Householder QR of the stacked, column-scaled regressors.
///
/// # Errors
/// [`PidError::TooFewSamples`] unless there are more rows than parameters.
///
/// # Examples
/// ```
/// use windfall_pid::regress::{RegressionOutcome, RegressionSeries, ols};
/// let x = vec![0.0, 1.0, 2.0, 3.0];
/// let line = RegressionSeries { regressors: vec![vec![1.0; 4], x], response: vec![1.0, 3.0, 5.0, 7.0], ..RegressionSeries::default() };
/// let RegressionOutcome::Fit(fit) = ols(&[line])? else { panic!("two columns are independent") };
/// assert!((fit.estimate[0] - 1.0).abs() < 1e-12 && (fit.estimate[1] - 2.0).abs() < 1e-12);
/// # Ok::<(), windfall_pid::PidError>(())
/// ```
pub fn ols(series: &[RegressionSeries]) -> Result<RegressionOutcome, PidError> {
    let prepared: Vec<PreparedColumns> = series.iter().cloned().map(PreparedColumns::new).collect();
    let columns: Vec<usize> = (0..series.first().map_or(0, |s| s.regressors.len())).collect();
    fit(&prepared.iter().collect::<Vec<_>>(), &columns)
}

/// A series with the transforms that its colour needs, done once for all data sets that use it.
#[derive(Clone, Debug)]
pub(crate) struct PreparedColumns {
    /// Its rows times their factors.
    series: RegressionSeries,
    cosines: Option<spectral::Cosines>,
    /// What draws of the instruments' noise add to the amplitudes; empty: regressors are taken as exact.
    draws: Vec<spectral::Cosines>,
    /// Diameters of flow between samples.
    step: f64,
}

impl PreparedColumns {
    pub(crate) fn new(mut series: RegressionSeries) -> Self {
        for column in series.regressors.iter_mut().chain(std::iter::once(&mut series.response)) {
            column.iter_mut().zip(&series.weight).for_each(|(x, w)| *x *= w);
        }
        let cosines = match series.residuals {
            Colour::Weighted(count) => Some(spectral::cosines(&series, count)),
            Colour::White | Colour::Corrected(_) => None,
        };
        Self { series, cosines, draws: Vec::new(), step: 0.0 }
    }
    /// With the same rows as draws of the instruments' noise change them, `step` diameters of flow from sample to sample.
    pub(crate) fn with_noise(self, draws: impl Iterator<Item = RegressionSeries>, step: f64) -> Self {
        let draws = match &self.cosines {
            Some(own) => draws.filter_map(|d| Some(Self::new(d).cosines?.less(own))).collect(),
            None => Vec::new(),
        };
        Self { draws, step, ..self }
    }
    /// Columns and response as cosine amplitudes.
    pub(crate) fn amplitudes(&self) -> Option<(DMatrix<f64>, DVector<f64>)> {
        self.cosines.as_ref().map(|c| spectral::whitened(c, &vec![1.0; c.len()]))
    }
}

/// Spectra of the residuals that these columns leave in prepared series with [`Colour::Weighted`] residuals.
pub(crate) fn spectra(prepared: &[&PreparedColumns], columns: &[usize]) -> Option<Vec<Vec<f64>>> {
    let cosines: Option<Vec<_>> = prepared.iter().map(|p| p.cosines.as_ref()).collect();
    spectral::spectra(&cosines?, columns)
}

/// A prepared series' columns and response as cosine amplitudes over the root of their spectrum: residuals of unit variance,
/// nearly independent.
pub(crate) fn whitened(prepared: &PreparedColumns, spectrum: &[f64]) -> Option<(DMatrix<f64>, DVector<f64>)> {
    prepared.cosines.as_ref().map(|c| spectral::whitened(c, spectrum))
}

/// Least squares on some columns of prepared series.
pub(crate) fn fit(prepared: &[&PreparedColumns], columns: &[usize]) -> Result<RegressionOutcome, PidError> {
    fit_under(prepared, columns, None)
}

/// The same under what drives the body, where another coefficient of the same runs shows it.
pub(crate) fn fit_under(
    prepared: &[&PreparedColumns],
    columns: &[usize],
    drive: Option<Driven>,
) -> Result<RegressionOutcome, PidError> {
    let series: Vec<&RegressionSeries> = prepared.iter().map(|p| &p.series).collect();
    let rows = series.iter().map(|s| s.response.len()).sum::<usize>();
    let count = columns.len();
    if count == 0 || rows <= count {
        return Err(PidError::TooFewSamples { what: "regression".to_owned(), samples: rows, needed: count.max(1) + 1 });
    }
    let white = match solve(stack(&series, columns)) {
        Solution::Found(white) => white,
        Solution::Deficient { column, rank } => return Ok(RegressionOutcome::Deficient { column, rank }),
    };
    let residuals_white = quality::residuals(&series, columns, &white.estimate);
    let s2_white = residuals_white.iter().flatten().map(|e| e * e).sum::<f64>() / (rows - count) as f64;
    let covariance_white = &white.bread * s2_white;
    let own = match drive {
        Some(drive) => driven(prepared, columns, &white, drive.ratio),
        None => colour(prepared, columns, &white, &residuals_white),
    };
    let residuals =
        if own.estimate == white.estimate { residuals_white } else { quality::residuals(&series, columns, &own.estimate) };
    let rss: f64 = residuals.iter().flatten().map(|e| e * e).sum();
    Ok(RegressionOutcome::Fit(Box::new(RegressionFit {
        covariance: own.covariance.unwrap_or_else(|| covariance_white.clone()),
        estimate: own.estimate,
        covariance_white,
        r2: quality::determination(&series, rss),
        s2: rss / (rows - count) as f64,
        condition: white.condition,
        half_width: own.freedom.iter().map(|f| student_95(*f)).collect(),
        freedom: own.freedom.iter().copied().fold(f64::INFINITY, f64::min),
        refused: own.refused,
        driven: own.driven,
        whiteness_p: quality::ljung_box(&residuals),
        residuals,
        rows,
    })))
}

/// Estimates under the declared colour; no covariance: that of white residuals.
struct Coloured {
    estimate: Vec<f64>,
    covariance: Option<DMatrix<f64>>,
    /// For each estimate.
    freedom: Vec<f64>,
    refused: Vec<Option<Refusal>>,
    driven: Option<Driven>,
}

impl Coloured {
    /// Of regressors without noise: `rows` independent residuals.
    fn of_exact(estimate: Vec<f64>, covariance: Option<DMatrix<f64>>, rows: f64) -> Self {
        let p = estimate.len();
        Self { freedom: vec![(rows - p as f64).max(1.0); p], refused: vec![None; p], driven: None, estimate, covariance }
    }
}

/// Chance of the instruments' noise below which something else is in a residual. Chosen: five coefficients of a few parameters each
/// raise it to one in a hundred.
const DRIVEN_P: f64 = 1e-3;
/// Residual over response below which it is rounding and the splines' own error. Chosen: five digits, which no instrument has.
const EXACT: f64 = 1e-5;
/// First-stage F below which intervals by instruments are not to be trusted (Staiger and Stock, Econometrica 65(3), 1997).
const WEAK_F: f64 = 10.0;

/// Estimates where regressors carry the instruments' noise; none where that was not asked for.
fn honest(prepared: &[&PreparedColumns], columns: &[usize], white: &White, residuals: &[Vec<f64>]) -> Option<Coloured> {
    let one = |p: &&'_ PreparedColumns| p.cosines.is_some() && !p.draws.is_empty();
    if prepared.is_empty() || !prepared.iter().all(one) {
        return None;
    }
    let cosines: Vec<&spectral::Cosines> = prepared.iter().filter_map(|p| p.cosines.as_ref()).collect();
    let recorded: Vec<noisy::Recorded<'_>> =
        prepared.iter().zip(&cosines).map(|(p, cosines)| noisy::Recorded { cosines, draws: &p.draws }).collect();
    let found = noisy::corrected(&recorded, columns, |spectra| spectral::solve(&cosines, spectra, columns))?;
    let square = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>();
    let (left, all) =
        (residuals.iter().map(|e| square(e)).sum::<f64>(), prepared.iter().map(|p| square(&p.series.response)).sum::<f64>());
    if found.excess_p < DRIVEN_P && left > EXACT * EXACT * all {
        return Some(driven(prepared, columns, white, found.excess));
    }
    let draws = prepared[0].draws.len() as f64;
    let refused = |s: &f64| (*s < 1.0).then_some(Refusal::Noise { signal_to_noise: *s });
    Some(Coloured {
        freedom: vec![draws - 1.0; columns.len()],
        refused: found.signal_to_noise.iter().map(refused).collect(),
        driven: None,
        estimate: found.estimate,
        covariance: Some(found.covariance),
    })
}

/// Estimates where something drives body and residual alike.
fn driven(prepared: &[&PreparedColumns], columns: &[usize], white: &White, ratio: f64) -> Coloured {
    let timed: Vec<lagged::Timed<'_>> = prepared.iter().map(|p| lagged::Timed { series: &p.series, step: p.step }).collect();
    let Some(found) = lagged::lagged(&timed, columns) else {
        let refused = vec![Some(Refusal::Weak { strength: 0.0 }); columns.len()];
        return Coloured {
            refused,
            driven: Some(Driven { ratio, lag: 0 }),
            ..Coloured::of_exact(white.estimate.clone(), None, 0.0)
        };
    };
    let refused = |f: &f64| (*f < WEAK_F).then_some(Refusal::Weak { strength: *f });
    Coloured {
        refused: found.strength.iter().map(refused).collect(),
        driven: Some(Driven { ratio, lag: found.lag }),
        estimate: found.estimate,
        covariance: Some(found.covariance),
        freedom: found.freedom,
    }
}

fn colour(prepared: &[&PreparedColumns], columns: &[usize], white: &White, residuals: &[Vec<f64>]) -> Coloured {
    if let Some(found) = honest(prepared, columns, white, residuals) {
        return found;
    }
    let cosines: Option<Vec<_>> = prepared.iter().map(|p| p.cosines.as_ref()).collect();
    if let Some(found) = cosines.and_then(|c| spectral::weighted(&c, columns)) {
        return found;
    }
    let series: Vec<&RegressionSeries> = prepared.iter().map(|p| &p.series).collect();
    let (covariance, freedom) = colour::covariance(&series, columns, residuals, &white.bread);
    Coloured::of_exact(white.estimate.clone(), covariance, freedom)
}

impl RegressionFit {
    /// Standard errors of a covariance matrix (eq. 4.20).
    #[must_use]
    pub fn std_errors(covariance: &DMatrix<f64>) -> Vec<f64> {
        covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }
    /// Half-width of the 95 % interval in standard errors.
    #[must_use]
    pub fn t95(&self) -> f64 {
        student_95(self.freedom)
    }
}

/// Standard errors on either side of a 95 % interval of this freedom.
fn student_95(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(NORMAL_95, |t| t.inverse_cdf(0.975))
}

/// The columns of all series below one another, the response last.
fn stack(series: &[&RegressionSeries], columns: &[usize]) -> Vec<Vec<f64>> {
    let one = |of: &dyn Fn(&RegressionSeries) -> &Vec<f64>| series.iter().map(|s| of(s).as_slice()).collect::<Vec<_>>().concat();
    let regressors = columns.iter().map(|&column| one(&|s| &s.regressors[column]));
    regressors.chain([one(&|s| &s.response)]).collect()
}

/// Estimate and (XᵀX)⁻¹ of ordinary least squares.
struct White {
    estimate: Vec<f64>,
    bread: DMatrix<f64>,
    condition: f64,
}

enum Solution {
    Found(White),
    Deficient { column: usize, rank: usize },
}

/// Columns, the response last.
fn solve(x: Vec<Vec<f64>>) -> Solution {
    let triangle = Triangle::of(x);
    let Triangle { scale, r, z } = &triangle;
    let columns = scale.len();
    if let Some(column) = scale.iter().position(|s| !s.is_normal()) {
        return Solution::Deficient { column, rank: scale.iter().filter(|s| s.is_normal()).count() };
    }
    let svd = r.clone().svd(false, true);
    let singular = &svd.singular_values;
    let largest = singular.max();
    let rank = singular.iter().filter(|s| **s > RANK_TOLERANCE * largest).count();
    let undetermined = || {
        let column = svd.v_t.as_ref().map_or(0, |v| v.row(singular.imin()).transpose().iamax());
        Solution::Deficient { column, rank }
    };
    if rank < columns {
        return undetermined();
    }
    // Columns back to their own size.
    let Some(unscaled) = triangle.inverse() else { return undetermined() };
    Solution::Found(White {
        estimate: (&unscaled * z).as_slice().to_vec(),
        bread: &unscaled * unscaled.transpose(),
        condition: largest / singular.min(),
    })
}
