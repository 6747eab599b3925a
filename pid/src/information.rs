//! pid: what runs can tell of parameters, as data. In: numbers. Out: serialisable rows.

use serde::{Deserialize, Serialize};

/// What a campaign's runs can tell of its declared parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identifiability {
    /// Number of free parameters.
    pub free: usize,
    /// Number of independent combinations that the runs tell.
    pub rank: usize,
    /// Condition number of the sensitivities, columns of unit length.
    pub condition: f64,
    /// Pairs correlated by 0.9 or more, strongest first.
    pub correlations: Vec<Correlation>,
    /// Sets of parameters that these runs cannot separate: not at all, or with correlated errors
    /// of which both are larger than the parameters themselves.
    pub inseparable: Vec<Vec<String>>,
    /// Standard error to expect of each parameter where sensors' noise is all there is; none where the rank is deficient.
    pub expected: Vec<(String, f64)>,
}

impl Identifiability {
    /// Parameters that stand in no set that the runs cannot separate and in no pair whose errors go together: the runs tell each of these
    /// apart from all others.
    #[must_use]
    pub fn told_apart(&self) -> usize {
        let pairs = self.correlations.iter().flat_map(|c| [&c.first, &c.second]);
        let mut others: Vec<&String> = self.inseparable.iter().flatten().chain(pairs).collect();
        others.sort();
        others.dedup();
        self.free.saturating_sub(others.len()).min(self.rank)
    }
}

/// Two parameters whose errors go together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correlation {
    /// One.
    pub first: String,
    /// The other.
    pub second: String,
    /// Correlation of their errors, in [−1, 1].
    pub correlation: f64,
}
