//! pid: ordinary least squares (thesis §4.2). In: stacked series of responses and regressors. Out: estimates and their accuracy.

mod colour;

use crate::PidError;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// One coefficient over one run: what the regression stacks. Residuals may be correlated within a series, never between two.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// One column per parameter, each as long as `response`.
    pub regressors: Vec<Vec<f64>>,
    /// Measured coefficient.
    pub response: Vec<f64>,
    /// Factor of each row, in (0, 1]; empty means ones.
    pub weight: Vec<f64>,
    /// Longest lag over which residuals are taken as correlated, samples; 0: white.
    pub correlated_samples: usize,
}

/// Result of a regression.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Estimates (eq. 4.15).
    pub estimate: Vec<f64>,
    /// Covariance for white residuals (eq. 4.19).
    pub covariance_white: DMatrix<f64>,
    /// Covariance for residuals of any colour (Morelli and Klein, J. Aircraft 34(2), 1997).
    pub covariance: DMatrix<f64>,
    /// Coefficient of determination (eq. 4.18), of the weighted rows.
    pub r2: f64,
    /// Residual variance s² (eq. 4.17), of the weighted rows.
    pub s2: f64,
    /// Condition number of the regressor matrix with columns scaled to unit length.
    pub condition: f64,
    /// Weighted residuals, per series.
    pub residuals: Vec<Vec<f64>>,
    /// Degrees of freedom that correlated residuals leave (Bartlett 1946).
    pub freedom: f64,
    /// Probability that white residuals look as coloured as these (Ljung and Box 1978, 20 lags).
    pub whiteness_p: f64,
    /// Number of rows.
    pub rows: usize,
}

/// What a regression gives, or which column it cannot have.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Outcome {
    /// Full rank.
    Fit(Box<Fit>),
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
pub fn ols(series: &[Series]) -> Result<Outcome, PidError> {
    let columns = series.first().map_or(0, |s| s.regressors.len());
    let rows = series.iter().map(|s| s.response.len()).sum::<usize>();
    if columns == 0 || rows <= columns {
        return Err(PidError::TooFewSamples { what: "regression".to_owned(), samples: rows, needed: columns.max(1) + 1 });
    }
    let (mut x, y) = stack(series, rows, columns);
    let scale: Vec<f64> = x.column_iter().map(|c| c.norm()).collect();
    if let Some(column) = scale.iter().position(|s| *s <= f64::MIN_POSITIVE) {
        return Ok(Outcome::Deficient { column, rank: columns - 1 });
    }
    for (mut c, s) in x.column_iter_mut().zip(&scale) {
        c /= *s;
    }
    let (q_t_y, r) = {
        let qr = x.clone().qr();
        let mut z = DMatrix::from_column_slice(rows, 1, y.as_slice());
        qr.q_tr_mul(&mut z);
        (z.rows(0, columns).into_owned(), qr.r())
    };
    let svd = r.clone().svd(false, true);
    let singular = &svd.singular_values;
    let (largest, smallest) = (singular.max(), singular.min());
    if smallest <= RANK_TOLERANCE * largest {
        let v_t = svd.v_t.expect("asked for");
        let column =
            v_t.row(singular.imin()).iter().map(|v| v.abs()).enumerate().fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a }).0;
        return Ok(Outcome::Deficient { column, rank: singular.iter().filter(|s| **s > RANK_TOLERANCE * largest).count() });
    }
    let scaled = r.solve_upper_triangular(&q_t_y).expect("full rank");
    let r_inverse = r.solve_upper_triangular(&DMatrix::identity(columns, columns)).expect("full rank");
    // Columns back to their own size.
    let unscale = DMatrix::from_diagonal(&DVector::from_iterator(columns, scale.iter().map(|s| 1.0 / s)));
    let bread = &unscale * &r_inverse * r_inverse.transpose() * &unscale;
    let fitted = &x * &scaled;
    let residual = &y - fitted.column(0);
    let s2 = residual.norm_squared() / (rows - columns) as f64;
    let residuals = split(&residual, series);
    let (covariance, freedom) = colour::covariance(series, &residuals, &bread);
    Ok(Outcome::Fit(Box::new(Fit {
        estimate: (&unscale * scaled).as_slice().to_vec(),
        covariance_white: &bread * s2,
        covariance: covariance.unwrap_or_else(|| &bread * s2),
        r2: determination(series, &y, &residual),
        s2,
        condition: largest / smallest,
        freedom: (freedom - columns as f64).max(1.0),
        whiteness_p: ljung_box(&residuals),
        residuals,
        rows,
    })))
}

impl Fit {
    /// Standard errors of a covariance matrix (eq. 4.20).
    #[must_use]
    pub fn std_errors(covariance: &DMatrix<f64>) -> Vec<f64> {
        covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }
    /// Half-width of the 95 % interval in standard errors.
    #[must_use]
    pub fn t95(&self) -> f64 {
        StudentsT::new(0.0, 1.0, self.freedom).map_or(1.96, |t| t.inverse_cdf(0.975))
    }
}

fn weight(s: &Series, i: usize) -> f64 {
    s.weight.get(i).copied().unwrap_or(1.0)
}

fn stack(series: &[Series], rows: usize, columns: usize) -> (DMatrix<f64>, DVector<f64>) {
    let (mut x, mut y) = (DMatrix::zeros(rows, columns), DVector::zeros(rows));
    let mut start = 0;
    for s in series {
        for i in 0..s.response.len() {
            let w = weight(s, i);
            y[start + i] = w * s.response[i];
            for (c, regressor) in s.regressors.iter().enumerate() {
                x[(start + i, c)] = w * regressor[i];
            }
        }
        start += s.response.len();
    }
    (x, y)
}

fn split(residual: &DVector<f64>, series: &[Series]) -> Vec<Vec<f64>> {
    let mut start = 0;
    series
        .iter()
        .map(|s| {
            let part = residual.as_slice()[start..start + s.response.len()].to_vec();
            start += s.response.len();
            part
        })
        .collect()
}

/// Share of the response's variance about its mean that the model explains (eq. 4.18).
fn determination(series: &[Series], y: &DVector<f64>, residual: &DVector<f64>) -> f64 {
    let pairs = || series.iter().flat_map(|s| (0..s.response.len()).map(move |i| (weight(s, i), s.response[i])));
    let (w2, w2y) = pairs().fold((0.0, 0.0), |(a, b), (w, y)| (a + w * w, b + w * w * y));
    let mean = w2y / w2;
    let about_mean: f64 = y.norm_squared() - w2 * mean * mean;
    if about_mean > 0.0 { 1.0 - residual.norm_squared() / about_mean } else { 0.0 }
}

/// Portmanteau test over all series.
fn ljung_box(residuals: &[Vec<f64>]) -> f64 {
    const LAGS: usize = 20;
    let mut q = 0.0;
    let mut freedom = 0.0;
    for v in residuals.iter().filter(|v| v.len() > 2 * LAGS) {
        let n = v.len() as f64;
        let r0 = v.iter().map(|x| x * x).sum::<f64>();
        if r0 <= 0.0 {
            continue;
        }
        for k in 1..=LAGS {
            let r = v.iter().zip(&v[k..]).map(|(a, b)| a * b).sum::<f64>() / r0;
            q += n * (n + 2.0) * r * r / (n - k as f64);
        }
        freedom += LAGS as f64;
    }
    ChiSquared::new(freedom).map_or(1.0, |c| c.sf(q))
}
