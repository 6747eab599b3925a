//! discover: effects judged between runs. In: how many runs, each set up anew. Out: gains of likelihood as few runs allow.
//!
//! Launches and drops share more than noise within a run: a release a little off, a spin a little different. What every run has
//! of its own is part of the unmodelled residual, with sizes from the scatter between runs (random effects, Laird and Ware,
//! Biometrics 38, 1982), so an effect must repeat from run to run to gain anything. Few runs know that scatter poorly: twice
//! the gain of log-likelihood is χ² only after Box's factor (Biometrika 36, 1949), with runs as the only witnesses.

/// Runs that are set up anew each time, and the axes that were measured in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Witnesses {
    /// Runs.
    pub runs: usize,
    /// Axes.
    pub axes: usize,
}

impl Witnesses {
    /// Factor on twice the gain of log-likelihood of `tested` numbers over a fit with `known` ones, for a χ² of `tested`
    /// degrees: `(n − p − q/2 − 1)/n` with numbers per axis, each axis having a scatter of its own; zero when there are too few
    /// runs to say. Where scatter between runs is small beside noise within them this is conservative.
    #[must_use]
    pub fn factor(&self, known: usize, tested: usize) -> f64 {
        let (n, axes) = (self.runs as f64, self.axes as f64);
        ((n - known as f64 / axes - 0.5 * tested as f64 / axes - 1.0) / n).max(0.0)
    }
}

#[cfg(test)]
mod tests;
