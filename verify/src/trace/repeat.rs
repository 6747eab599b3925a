//! verify: effects judged between runs. In: a fit of few runs, each set up anew. Out: families weighed, gains as few runs allow.
//!
//! Launches and drops share more than noise within a run: a release a little off, a spin a little different. What every run has
//! of its own is part of the unmodelled residual, with sizes from the scatter between runs (random effects, Laird and Ware,
//! Biometrics 38, 1982), so an effect must repeat from run to run to gain anything. Few runs know that scatter poorly: twice
//! the gain of log-likelihood is χ² only after Box's factor (Biometrika 36, 1949), with runs as the only witnesses.

use super::fit::{Fit, Problem};
use super::hypothesis::{Free, Instance};
use super::search::Candidate;

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

/// The factor for a gain of one fit over another; 1 where the covariance within a run is known.
#[must_use]
pub fn repeats(problem: &Problem<'_>, over: &Fit, tested: usize) -> f64 {
    problem.evidence.witnesses().map_or(1.0, |w| w.factor(over.free.len(), tested))
}

/// A family weighed by a fit in full: an effect takes its share out of the scatter between runs, which one step from a fit that
/// has all of it there cannot see.
pub(super) fn weighed(problem: &Problem<'_>, over: &Fit, form: Instance) -> Option<Candidate> {
    let mut h = over.hypothesis.clone();
    h.effects.push(form);
    let k = h.effects.len() - 1;
    let fit = problem.fit(&h, false);
    let own = |f: &Free| if let Free::Effect(e, i) = *f { (e == k).then_some((i, fit.std_error(*f))) } else { None };
    let std_errors: Vec<(usize, f64)> = fit.free.iter().filter_map(own).collect();
    let degrees = std_errors.len();
    let instance = fit.hypothesis.effects[k].clone();
    let mean: Vec<usize> = instance.mean_strengths().collect();
    let bound = |i: usize| {
        let (p, v) = (&instance.parameters[i], instance.values[i].abs());
        let error = std_errors.iter().find(|(j, _)| *j == i).map_or(f64::INFINITY, |(_, s)| *s);
        (i, (v + 1.96 * error).min(p.high))
    };
    let bounds = mean.into_iter().map(bound).collect();
    let statistic = 2.0 * problem.gain(over, &fit) * repeats(problem, over, degrees);
    (statistic.is_finite() && degrees > 0).then_some(Candidate {
        instance,
        statistic,
        degrees,
        tried: 1,
        p_value: 1.0,
        std_errors,
        bounds,
    })
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
