//! discover: residuals of tracks in units of their sensor's noise, from slow to fast. In: evidence and a residual. Out: numbers with their
//! frequencies, one list for each measured axis.

use super::bins::BIN;
use super::evidence::TrackEvidence;
use windfall_model::Measured;

/// Whitened numbers of one axis: frequency (Hz) and residual over the standard deviation of the sensor's noise in it.
pub(crate) type WhitenedNumbers = Vec<[f64; 2]>;

impl TrackEvidence {
    /// Of every measured axis, by its channel; none of poses, which are judged by their scatter between runs.
    pub(crate) fn whitened(&self, residual: &[f64]) -> Vec<(usize, WhitenedNumbers)> {
        if self.kind == Measured::Pose {
            return Vec::new();
        }
        let std = |i: usize| self.noise()[i / BIN][(i % BIN, i % BIN)].max(f64::MIN_POSITIVE).sqrt();
        let of = |axis: usize| {
            let all = self.places(axis).into_iter().map(|(i, _, hz)| [hz, residual[i] / std(i)]);
            (axis, all.filter(|x| x[1].is_finite()).collect())
        };
        self.axes().into_iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests;
