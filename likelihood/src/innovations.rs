//! likelihood: the innovations themselves. In: an engine, a model. Out: whitened series per run, for those who look at their shape.

use crate::engine::Engine;
use crate::filter::SETTLED_S;
use crate::model::Model;
use windfall_model::POSE;

/// Whitened innovations of one run: standard normal and independent where the model and its noise are right.
#[derive(Clone, Debug, PartialEq)]
pub struct Innovations {
    /// Index of the run in its campaign.
    pub run: usize,
    /// Time from one row to the next, s.
    pub step_s: f64,
    /// Rows in the order of [`windfall_model::CHANNEL_NAMES`], the pose's six; an exact zero where nothing was measured.
    pub rows: Vec<[f64; POSE]>,
}

impl Engine {
    /// Whitened innovations at a model, without the time in which first states are found: they say little of the noise there. None where the model departs.
    #[must_use]
    pub fn innovations(&self, model: &Model) -> Option<Vec<Innovations>> {
        let sum = self.sum(model, &[], &[]).ok()?;
        let one = |(run, seen): (&crate::run::Prepared, crate::filter::Seen)| Innovations {
            run: run.index,
            step_s: run.step_s(),
            rows: seen.innovations.whitened.into_iter().skip(crate::run::whole(SETTLED_S / run.step_s())).collect(),
        };
        Some(self.runs.iter().zip(sum.runs).map(one).collect())
    }
}
