//! pid: how many terms are enough. In: nothing. Out: the criteria by name.

use serde::{Deserialize, Serialize};

/// How many terms are enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Criterion {
    /// Stepwise by partial F on rows taken as white, threshold 4 (Klein and Morelli 2006, §5.4.1).
    WhiteF,
    /// Orthogonal functions and least predicted squared error, `RSS/N + σ²_max n/N` with the response's variance for σ²_max, on rows
    /// taken as white: SIDPAC's way (Klein and Morelli 2006, §5.4.2).
    WhitePse,
    /// Orthogonal functions and least predicted squared error, `RSS/N + 2 σ² n/N` (Barron 1984), on whitened rows.
    Pse,
    /// Orthogonal functions and least sum of squares of each whitened row predicted from all others (Allen 1974).
    Press,
    /// Orthogonal functions and least `RSS/σ² + n ln N` (Schwarz 1978), on whitened rows.
    Bic,
    /// Orthogonal functions and least sum of squares of each run predicted from the other runs, on whitened rows.
    CrossValidation,
    /// Stepwise by partial F on whitened rows, with a stated chance that any spurious term enters.
    F,
    /// The subset with the least `RSS/σ² + c n` of all subsets, on whitened rows; c as the threshold of `F` (risk inflation; Foster and
    /// George 1994).
    Subset,
    /// As `Subset`, and each term must stand against its own scatter between runs (random effects; DerSimonian and Laird 1986).
    Agreed,
    /// As `Subset`, on the innovations of filter error: trajectories, not derivatives, with gusts that nobody measured allowed for.
    Likelihood,
}

impl Criterion {
    /// All, in the order of the tables.
    pub const ALL: [Self; 10] = [
        Self::WhiteF,
        Self::WhitePse,
        Self::Pse,
        Self::Press,
        Self::Bic,
        Self::CrossValidation,
        Self::F,
        Self::Subset,
        Self::Agreed,
        Self::Likelihood,
    ];
    /// Name in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::WhiteF => "white-f",
            Self::WhitePse => "white-pse",
            Self::Pse => "pse",
            Self::Press => "press",
            Self::Bic => "bic",
            Self::CrossValidation => "cross-validation",
            Self::F => "f",
            Self::Subset => "subset",
            Self::Agreed => "agreed",
            Self::Likelihood => "likelihood",
        }
    }
}
