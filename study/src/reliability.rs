//! study: stated probabilities against how often it is so. In: counts. Out: shares with their intervals.

use super::stop::clopper_pearson;
use serde::{Deserialize, Serialize};

/// How often intervals hold the truth that are stated to do so with some probability.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityPoint {
    /// Stated probability; of classes their mean.
    pub stated: f64,
    /// How often it was so.
    pub count: u64,
    /// Out of how many.
    pub of: u64,
    /// 95 % interval of the share (Clopper and Pearson 1934).
    pub ci95: [f64; 2],
}

impl ReliabilityPoint {
    pub(super) fn new(stated: f64, count: u64, of: u64) -> Self {
        Self { stated, count, of, ci95: clopper_pearson(count, of) }
    }
    /// The share that was so.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.count as f64 / self.of as f64
    }
}
