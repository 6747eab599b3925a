//! verify: the loop closed with measured data. In: a campaign and its declared model. Out: what the model lacks, its numbers,
//! and the error on held-out runs before and after.
//!
//! Tunnel runs by the one likelihood of `windfall_likelihood` (`likely`), tracks of bodies without attitude by a contest of sets whose
//! covariance has what every run has of its own (`points`). Nothing here knows a family by name.

use crate::VerifyError;
use windfall_model::{Campaign, Use};

mod balance;
mod chance;
mod figure;
mod figures;
mod flown;
mod innovations;
mod lead;
mod likely;
mod points;
mod poses;
mod result;
mod sides;
mod signals;
mod slope;
mod smoothing;
mod track_shape;
mod tracks;

pub use crate::residual::ChannelResidual;
pub use chance::p_value;
pub use figure::{Figure, Role, Series, Topic};
pub use figures::figures;
pub use innovations::{InnovationLine, InnovationShape};
pub(crate) use likely::LEFT;
pub use result::{
    After, CandidateLine, Closing, ConstantLine, EffectBound, EffectLine, Form, FormCheck, HeldOut, HeldOutTrajectory, NoiseLine,
    ParameterLine, SetLine, Shift, Unexplained, Verdict,
};
pub use signals::{BodyShape, RunTracks, SignalTracks, TrackSignal};
pub use smoothing::{SmoothingTracks, smoothing};
pub use tracks::{coefficient_tracks, flight_tracks, tracks};

/// Error rates and effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Chance of calling what is left unexplained where it is noise.
    pub false_alarm: f64,
    /// Seed of the noisy copies by which the figures' noise is measured.
    pub seed: u64,
    /// Flights of each held-out run when the model has random inputs; 0: held-out runs are not flown again.
    pub flights: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { false_alarm: 0.005, seed: 1, flights: 8 }
    }
}

pub(crate) fn runs_of(campaign: &Campaign, used: Use) -> Vec<usize> {
    (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == used).collect()
}

/// Closes the loop of a campaign.
///
/// # Errors
/// A record that is not what its campaign says it is, no run to identify on, runs too short, or a declared model that cannot be fitted.
pub fn close(campaign: &Campaign, options: &Options) -> Result<Closing, VerifyError> {
    windfall_pid::plausible::plausible(campaign)?;
    if campaign.has_tracks() { points::close(campaign, options) } else { likely::close(campaign, options) }
}
