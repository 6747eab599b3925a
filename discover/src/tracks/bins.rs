//! discover: how residuals are held. A bin is up to twelve real numbers with one covariance; unused entries are zero with unit variance.

use nalgebra::SMatrix;

/// Numbers in a bin.
pub(crate) const BIN: usize = 12;
/// Covariance of a bin, or a part of it.
pub(crate) type Cov = SMatrix<f64, BIN, BIN>;
/// Residual of all bins, `BIN` numbers each.
pub(crate) type Residual = Vec<f64>;
