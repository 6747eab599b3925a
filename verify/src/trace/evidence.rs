//! verify: what the tracer weighs. In: a plant. Out: residuals in bins, their noise, and how random inputs would colour them.
//!
//! A bin holds up to twelve real numbers with one covariance. Tunnel runs use one bin per frequency (real, then imaginary part
//! of six channels); unused entries are zero with unit variance.

use super::fit::Fit;
use super::repeat::Witnesses;
use crate::close::ChannelResidual;
use nalgebra::SMatrix;
use windfall_model::Plant;

/// Numbers in a bin.
pub const BIN: usize = 12;
/// Covariance of a bin, or a part of it.
pub type Cov = SMatrix<f64, BIN, BIN>;

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
    /// All copies, with which noise is measured; fits are corrected with the first of them.
    fn noisy(&self) -> usize {
        self.copies()
    }
    /// Residual of the data (copy 0) or of a noisy copy (1 ..= noisy) under a plant. A run whose state the plant makes
    /// non-finite gives NaN.
    fn residual(&self, plant: &Plant, copy: usize) -> Residual;
    /// Residual of what the copies are made of: data with little noise. Copies of noisy data would also carry products of the two
    /// noises, which the data have only once.
    fn clean(&self, plant: &Plant) -> Residual {
        self.residual(plant, 0)
    }
    /// Covariance that sensor noise leaves, per bin.
    fn noise(&self) -> &[Cov];
    /// Unit covariance components of an unmodelled residual, to be scaled: each a matrix per bin.
    fn generic(&self) -> &[Vec<Cov>];
    /// Covariance per bin that the random inputs of a plant cause.
    fn random(&self, plant: &Plant) -> Vec<Cov>;
    /// Draws of what the random inputs of a plant leave in the residual, with all that varies along a run.
    fn random_draws(&self, _plant: &Plant, count: usize) -> Vec<Residual> {
        vec![vec![0.0; self.bins() * BIN]; count]
    }
    /// What the score `aᵀΣ⁻¹z` of each change of plant has at the truth because the motion answers to the random inputs: twice
    /// the real part of `tr(L' L⁻¹ P)` summed over bins, with `L` the map from measured motion to residual, `L'` its change per
    /// step, and `P` the share of the covariance (`sigma`, per bin) that is not sensor noise. The log-determinant of `L` belongs
    /// to the likelihood of what was measured; leaving it out biases every fit of data in closed loop.
    fn closed_loop(&self, _sigma: &[Cov], _plant: &Plant, moved: &[(Plant, f64)]) -> Vec<f64> {
        vec![0.0; moved.len()]
    }
    /// Time at both ends of a run in which a pulse cannot be seen, s.
    fn margin_s(&self) -> f64 {
        0.0
    }
    /// Measures noise again at a better plant.
    fn settle(&mut self, _plant: &Plant) {}
    /// Residual per channel against what is expected of it (covariance per bin), with `fitted` parameters.
    fn channel_residuals(&self, z: &[f64], _expected: &[Cov], _fitted: usize) -> Vec<ChannelResidual> {
        let _ = z;
        Vec::new()
    }
    /// Position rms of a point mass over these runs, m; none for bodies with attitude.
    fn rms_m(&self, _plant: &Plant) -> Option<f64> {
        None
    }
    /// Residual in time beside what it may vary with.
    fn lead_table(&self, _plant: &Plant) -> LeadTable {
        LeadTable::default()
    }
    /// Frequency at which a channel's residual stands highest over its noise, Hz.
    fn peak_hz(&self, _fit: &Fit, _channel: usize) -> Option<f64> {
        None
    }
    /// Tells that many residuals near this plant will be asked for.
    fn focus(&self, _plant: &Plant) {}
    /// Residual of the data (copy 0) in one run, all other bins zero.
    fn residual_of(&self, plant: &Plant, run: usize) -> Residual;
    /// Duration of each run, s, for effects at an instant.
    fn durations_s(&self) -> Vec<f64>;
    /// How many of the unit components have a known cause (a tracker, a launch), so that their size costs nothing.
    fn known_causes(&self) -> usize {
        0
    }
    /// Whether one residual is smaller than another by more than an error of the sensors that all runs share could make.
    fn tells(&self, _before: &[f64], _after: &[f64]) -> bool {
        true
    }
    /// The runs, where each is set up anew and an effect must repeat in them; none where the covariance within a run is known.
    fn witnesses(&self) -> Option<Witnesses> {
        None
    }
    /// Index in the campaign of each run.
    fn run_indices(&self) -> Vec<usize>;
}

/// Residual series of all runs in a row, and variables at the same samples.
#[derive(Clone, Debug, Default)]
pub struct LeadTable {
    /// Per channel.
    pub residuals: Vec<Vec<f64>>,
    /// Name with unit, and values.
    pub variables: Vec<(String, Vec<f64>)>,
}
