//! discover: what a model leaves of measurements. In: numbers. Out: rows by channel, series beside what they may vary with.

use serde::{Deserialize, Serialize};

/// Residual of one channel against noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChannelResidual {
    /// Coefficient, or axis for a point mass.
    pub channel: String,
    /// rms of the residual in the band used.
    pub rms: f64,
    /// rms that sensor noise alone would leave.
    pub expected_rms: f64,
    /// Probability of as much or more from noise alone.
    pub p_value: f64,
}

/// Residual series of all runs in a row, and variables at the same samples.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeadTable {
    /// Per channel.
    pub(crate) residuals: Vec<Vec<f64>>,
    /// Name with unit, and values.
    pub(crate) variables: Vec<(String, Vec<f64>)>,
}
