//! verify: what the tracer weighs. In: a plant. Out: residuals in bins, their noise, and how random inputs would colour them.
//!
//! A bin holds up to twelve real numbers: two vectors (real and imaginary part) of six channels that share one covariance.
//! Tunnel runs use one bin per frequency, point masses one per sample with unused entries zero.

use nalgebra::SMatrix;
use windfall_model::Plant;

/// Covariance or its part within a bin, per real part.
pub type Cov = SMatrix<f64, 6, 6>;
/// Numbers in a bin.
pub const BIN: usize = 12;

/// Residual of all bins, `BIN` numbers each.
pub type Residual = Vec<f64>;

/// A source of residuals.
pub trait Evidence: Sync {
    /// Bins.
    fn bins(&self) -> usize;
    /// Real numbers in use over all bins (the sample size of the likelihood).
    fn samples(&self) -> usize;
    /// Copies of the data with noise added again, for what noise in the regressors does (0: regressors are free of it).
    fn copies(&self) -> usize;
    /// Residual of the data (copy 0) or of a noisy copy (1 ..= copies) under a plant. A run whose state the plant makes
    /// non-finite gives NaN.
    fn residual(&self, plant: &Plant, copy: usize) -> Residual;
    /// Covariance that sensor noise leaves, per bin.
    fn noise(&self) -> &[Cov];
    /// Unit covariance components of an unmodelled residual, to be scaled: each a matrix per bin.
    fn generic(&self) -> &[Vec<Cov>];
    /// Covariance per bin that the random inputs of a plant cause.
    fn random(&self, plant: &Plant) -> Vec<Cov>;
    /// Tells that many residuals near this plant will be asked for.
    fn focus(&self, _plant: &Plant) {}
    /// Residual of the data (copy 0) in one run, all other bins zero.
    fn residual_of(&self, plant: &Plant, run: usize) -> Residual;
    /// Duration of each run, s, for effects at an instant.
    fn durations_s(&self) -> Vec<f64>;
    /// Index in the campaign of each run.
    fn run_indices(&self) -> Vec<usize>;
}
