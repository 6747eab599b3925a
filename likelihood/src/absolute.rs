//! likelihood: whether a fit's residual is noise, run by run. In: a fit, its runs and others. Out: mean squares of the whitened innovations of every run
//! and channel against one, with their sampling errors.

use crate::engine::{Engine, Fit};
use crate::filter::Departed;
use crate::model::Model;
use crate::random_range::RandomRange;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use windfall_model::POSE;

/// How well noise is known from the record, as a share of its variance.
pub const NOISE_KNOWN: f64 = 0.03;

/// Mean square of one channel's whitened innovations over a run: one where the model and its noise are right.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanSquare {
    /// Run, or runs taken as one flight.
    pub run: String,
    /// Place among [`windfall_model::CHANNEL_NAMES`].
    pub channel: usize,
    /// Over the time after the first state was found.
    pub mean_square: f64,
    /// Its standard deviation where the model is right.
    pub std: f64,
}

impl MeanSquare {
    /// Probability of as large a mean square from noise alone: χ² with the degrees of freedom that its standard deviation stands for.
    #[must_use]
    pub fn p_value(&self) -> f64 {
        let degrees = 2.0 / self.std.powi(2);
        let statistic = degrees * self.mean_square;
        if statistic.is_finite() { ChiSquared::new(degrees).map_or(1.0, |c| c.sf(statistic)) } else { 0.0 }
    }
}

/// What runs that a fit has not seen say of it.
#[derive(Clone, Debug)]
pub struct OtherRuns {
    /// Every run and channel, where the numbers may move within what the fit leaves of them.
    pub squares: Vec<MeanSquare>,
    /// Probability that the numbers are asked to move as far as they are.
    pub moved_p_value: f64,
}

impl Engine {
    /// Mean squares of its own runs at a model, whose random sizes are known as `ranges` say.
    ///
    /// # Errors
    /// Where the model departs.
    pub fn mean_squares(&self, model: &Model, ranges: &[RandomRange]) -> Result<Vec<MeanSquare>, Departed> {
        let mut all = self.squares(model)?;
        let mut variances: Vec<f64> = all.iter().map(|(_, count)| 2.0 / count.max(1.0) + NOISE_KNOWN * NOISE_KNOWN).collect();
        for range in ranges {
            let mut other = model.clone();
            let (k, i) = range.place;
            let Some(value) = other.members.get_mut(k).and_then(|m| m.values.get_mut(i)) else { continue };
            *value += range.std;
            // A size that the filter cannot follow says nothing of how well squares are known.
            let Ok(there) = self.squares(&other) else { continue };
            for ((variance, (here, _)), (there, _)) in variances.iter_mut().zip(&all).zip(&there) {
                *variance += (there.mean_square - here.mean_square).powi(2);
            }
        }
        all.iter_mut().zip(variances).for_each(|((square, _), variance)| square.std = variance.sqrt());
        Ok(all.into_iter().map(|(square, _)| square).collect())
    }

    /// The same with the count of each, without sampling errors.
    fn squares(&self, model: &Model) -> Result<Vec<(MeanSquare, f64)>, Departed> {
        let sum = self.sum(model, &[], &[])?;
        let of_run = |(run, seen): (&crate::run::Prepared, &crate::filter::Seen)| {
            let one = |channel: usize| {
                let [.., whitened, count] = seen.channels[channel];
                let mean_square = if count > 0.0 { whitened / count } else { 1.0 };
                (MeanSquare { run: run.name.clone(), channel, mean_square, std: 0.0 }, count)
            };
            (0..POSE).map(one).collect::<Vec<_>>()
        };
        Ok(self.runs.iter().zip(&sum.runs).flat_map(of_run).collect())
    }

    /// Mean squares of other runs in the same noise, and how far the fit's numbers are asked to move for them: a number that the fit hardly
    /// knows may stand anywhere within its error. `None` without such runs.
    ///
    /// # Errors
    /// Where the fit's model departs in them.
    pub fn of_others(&self, fit: &Fit, runs: &[usize], ranges: &[RandomRange]) -> Option<Result<OtherRuns, Departed>> {
        let others = self.beside(&self.campaign, runs)?;
        let departed = others.sum(&fit.model, &[], &[]).err();
        if let Some(departed) = departed {
            return Some(Err(departed));
        }
        let mut model = fit.model.clone();
        let top = others.top_near(fit)?;
        fit.numbers.iter().zip(top.off.iter()).for_each(|(n, by)| model.change(n, *by));
        let squares = others.mean_squares(&model, ranges);
        Some(squares.map(|squares| OtherRuns { squares, moved_p_value: top.p_value }))
    }
}

#[cfg(test)]
mod tests;
