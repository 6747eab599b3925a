//! pid: parameters that are not linear, by variable projection. In: whitened rows, columns that change with a shape. Out: shape and
//! linear parameters with their covariance.
//!
//! For a given shape the rest is linear least squares; what that leaves is a function of the shape alone (Golub and Pereyra, SIAM J.
//! Numer. Anal. 10(2), 1973), minimised by Gauss-Newton with Kaufman's slope (BIT 15, 1975), `−P⊥ (∂Φ/∂θ) c`. Errors are those of
//! shape and linear parameters together, `[Φ | (∂Φ/∂θ) c]`.

use nalgebra::{DMatrix, DVector};

/// How the shape is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ShapeSearch {
    /// Gauss-Newton on the projected residual, steps halved until they help.
    GaussNewton,
    /// Downhill simplex (Nelder and Mead 1965), as the thesis names for models that are not linear (§4.2).
    Simplex,
}

/// A problem with one shape parameter θ and one column that it changes: `y = X c + φ(θ) b + noise of unit variance`.
pub struct Shaped<'a> {
    /// X, rows × terms.
    pub linear: &'a DMatrix<f64>,
    /// y.
    pub response: &'a DVector<f64>,
    /// φ(θ) and dφ/dθ.
    pub column: &'a dyn Fn(f64) -> Option<[DVector<f64>; 2]>,
    /// Range of θ, both ends positive.
    pub range: [f64; 2],
}

/// Where a search ended.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeFit {
    /// θ.
    pub shape: f64,
    /// Its standard error.
    pub shape_std_error: f64,
    /// c, then b.
    pub estimate: Vec<f64>,
    /// Their standard errors, with θ unknown.
    pub std_error: Vec<f64>,
    /// Sum of squares left.
    pub rss: f64,
    /// False where θ ended at an end of its range: the data do not tell it.
    pub inside: bool,
}

/// Starts over the range, evenly in the logarithm.
const STARTS: usize = 6;
/// A step in ln θ below this ends the search.
const STEP: f64 = 1e-6;
/// Most steps.
const STEPS: usize = 40;
/// Most evaluations of the simplex, and its first reach as part of the range.
const EVALUATIONS: usize = 60;
const REACH: f64 = 0.1;

/// At one shape.
struct At {
    rss: f64,
    residual: DVector<f64>,
    estimate: DVector<f64>,
    /// Slope of the model by ln θ, c and b fixed.
    slope: DVector<f64>,
    /// The same less what the columns can follow.
    projected: DVector<f64>,
}

/// Middles of as many equal parts.
fn starts([low, high]: [f64; 2]) -> [f64; STARTS] {
    std::array::from_fn(|k| low + (k as f64 + 0.5) / STARTS as f64 * (high - low))
}

impl Shaped<'_> {
    fn columns(&self, theta: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let [phi, slope] = (self.column)(theta)?;
        let n = self.linear.ncols();
        let mut x = self.linear.clone().resize_horizontally(n + 1, 0.0);
        x.set_column(n, &phi);
        Some((x, slope))
    }

    fn at(&self, theta: f64) -> Option<At> {
        let (x, slope) = self.columns(theta)?;
        let n = x.ncols();
        let qr = x.qr();
        let (q, r) = (qr.q(), qr.r());
        let out = |v: &DVector<f64>| v - &q * q.tr_mul(v);
        let estimate = r.solve_upper_triangular(&q.tr_mul(self.response))?;
        let residual = out(self.response);
        let slope = slope * (theta * estimate[n - 1]);
        Some(At { rss: residual.norm_squared(), residual, projected: out(&slope), estimate, slope }).filter(|a| a.rss.is_finite())
    }

    /// Least squares over shape and linear parameters; `None` where no shape in the range gives a column of its own.
    #[must_use]
    pub fn fit(&self, search: ShapeSearch) -> Option<ShapeFit> {
        let [low, high] = self.range.map(f64::ln);
        let starts = starts([low, high]).into_iter().filter_map(|l| Some((l, self.at(l.exp())?.rss)));
        let (start, _) = starts.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let log = match search {
            ShapeSearch::GaussNewton => self.descend(start, [low, high])?,
            ShapeSearch::Simplex => {
                let value = |x: &[f64]| self.at((low + x[0] * (high - low)).exp()).map_or(f64::INFINITY, |a| a.rss);
                let x = crate::simplex::minimise(value, &[(start - low) / (high - low)], REACH, EVALUATIONS).at;
                low + x[0] * (high - low)
            }
        };
        self.report(log, [low, high])
    }

    fn descend(&self, start: f64, [low, high]: [f64; 2]) -> Option<f64> {
        let (mut log, mut now) = (start, self.at(start.exp())?);
        for _ in 0..STEPS {
            let information = now.projected.norm_squared();
            if information <= 0.0 || !information.is_finite() {
                break;
            }
            let step = now.projected.dot(&now.residual) / information;
            let tried = (0..12).find_map(|halving| {
                let next = (log + step * 0.5_f64.powi(halving)).clamp(low, high);
                self.at(next.exp()).filter(|a| a.rss < now.rss).map(|a| (next, a))
            });
            let Some((next, there)) = tried else { break };
            let moved = (next - log).abs();
            (log, now) = (next, there);
            if moved < STEP {
                break;
            }
        }
        Some(log)
    }

    fn report(&self, log: f64, [low, high]: [f64; 2]) -> Option<ShapeFit> {
        let at = self.at(log.exp())?;
        let (x, _) = self.columns(log.exp())?;
        let n = x.ncols();
        let mut all = x.resize_horizontally(n + 1, 0.0);
        all.set_column(n, &at.slope);
        let variance = at.rss / all.nrows().saturating_sub(n + 1).max(1) as f64;
        let inverse = all.qr().r().solve_upper_triangular(&DMatrix::identity(n + 1, n + 1))?;
        let std = |i: usize| (inverse.row(i).norm_squared() * variance).sqrt();
        Some(ShapeFit {
            shape: log.exp(),
            shape_std_error: log.exp() * std(n),
            estimate: at.estimate.as_slice().to_vec(),
            std_error: (0..n).map(std).collect(),
            rss: at.rss,
            inside: log > low + 1e-3 && log < high - 1e-3,
        })
    }
}

#[cfg(test)]
mod tests;
