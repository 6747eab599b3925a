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
mod tests {
    use super::Witnesses;
    use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

    /// A mean of eleven runs, and three numbers on one axis: Box's χ² against the F distribution that holds exactly there,
    /// `n ln(1 + qF/ν)` being twice the gain. His next term is of
    /// order 1/n², times the square of the gain: under a tenth of these probabilities.
    #[test]
    fn exact_f_of_few_runs() {
        let w = Witnesses { runs: 11, axes: 1 };
        for (known, tested, f) in [(0, 1, 17.2), (0, 1, 4.0), (0, 3, 12.5), (2, 1, 9.0)] {
            let (n, q, spare) = (11.0, f64::from(tested), 11.0 - f64::from(known + tested));
            let gain = n * (q * f / spare).ln_1p();
            let exact = FisherSnedecor::new(q, spare).expect("positive").sf(f);
            let box_1949 = ChiSquared::new(q).expect("positive").sf(gain * w.factor(known as usize, tested as usize));
            assert!((box_1949 / exact - 1.0).abs() < 0.1, "{known} {tested}: {box_1949} {exact}");
        }
    }
}
