//! discover: the loop closed with measured data. In: a campaign and its declared model. Out: what the model lacks, its numbers,
//! and the error on held-out runs before and after.
//!
//! Tunnel runs by the one likelihood of `windfall_likelihood` (`likely`), tracks of bodies without attitude by a contest of sets whose
//! covariance has what every run has of its own (`points`). Nothing here knows a family by name.

use crate::DiscoverError;
use crate::wind_tunnel::{self, WindTunnelLine};
use windfall_model::{Campaign, Plant, Use};
use windfall_pid::bands::largest_angle_rad;
use windfall_pid::plausible::looked;

mod balance;
mod chance;
mod checks;
mod figure;
mod figures;
mod finding;
mod fitted;
mod flown;
mod innovations;
mod judged;
mod lead;
mod likely;
mod points;
mod pose_rates;
mod poses;
mod result;
mod roll_zero;
mod sets;
mod settings;
mod sides;
mod signals;
mod slope;
mod smoothing;
mod static_curves;
mod track_shape;
mod tracks;
mod whitened;

pub use crate::residual::ChannelResidual;
pub use chance::p_value;
pub(crate) use figure::short;
pub use figure::{Figure, Role, Series, Topic};
pub use figures::figures;
pub use fitted::{FittedInstead, FlownCoefficient, FlownValue, Instead, ParameterLine};
pub use innovations::{InnovationLine, InnovationShape};
pub use judged::{CheckLine, CheckedRuns, Finding, Level, NotNamed};
pub use result::{
    After, CandidateLine, Closing, ConstantLine, EffectBound, EffectLine, Form, FormCheck, HeldOut, HeldOutTrajectory, NoiseLine,
    RunValue, SetLine, Shift, Unexplained, Verdict,
};
pub use sides::Sides;
pub use signals::{BodyShape, RunTracks, SignalTracks, TrackSignal};
pub use smoothing::{SmoothingTracks, smoothing};
pub use tracks::{coefficient_tracks, flight_tracks, tracks};
pub use windfall_likelihood::SOMETHING_ELSE;

/// Error rates and effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Chance of calling what is left unexplained where it is noise.
    pub false_alarm: f64,
    /// Seed of the noisy copies by which the figures' noise is measured.
    pub seed: u64,
    /// Flights of each held-out run when the model has random inputs; 0: held-out runs are not flown again.
    pub flights: usize,
    /// Whether a record that the check refuses is closed all the same.
    pub accept_record: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { false_alarm: 0.005, seed: 1, flights: 8, accept_record: false }
    }
}

pub(crate) fn runs_of(campaign: &Campaign, used: Use) -> Vec<usize> {
    (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == used).collect()
}

/// Closes the loop of a campaign.
///
/// # Errors
/// A record that is not what its campaign says it is, no run to identify on, runs too short, or a declared model that cannot be fitted.
pub fn close(campaign: &Campaign, options: &Options) -> Result<Closing, DiscoverError> {
    let looked = looked(campaign, options.accept_record)?;
    let record = looked.notes();
    if campaign.has_tracks() {
        return Ok(Closing { record, ..points::close(campaign, options)? }.with_finding());
    }
    let campaign = &looked.with_difference();
    let closing = likely::close(campaign, options)?;
    let wind_tunnel = static_points(campaign, closing.plants()?)?;
    Ok(Closing { wind_tunnel, record, ..closing }.with_finding())
}

/// The campaign as closing takes it: both recorders on one clock. Figures and tracks of a closing are of these runs.
///
/// # Errors
/// None of a record that was closed.
pub fn as_closed(campaign: &Campaign) -> Result<Campaign, DiscoverError> {
    Ok(looked(campaign, true)?.with_difference())
}

/// Both sides of a closing at the points of wind-tunnel tests.
fn static_points(campaign: &Campaign, sides: &Sides) -> Result<Vec<WindTunnelLine>, DiscoverError> {
    if campaign.knowledge.wind_tunnel.is_empty() {
        return Ok(Vec::new());
    }
    let plants: Vec<(&str, &Plant)> =
        sides.each().map(|(role, p)| (if role == Role::Before { "before" } else { "after" }, p)).collect();
    Ok(wind_tunnel::of_plants(campaign, &plants, reached_rad(campaign)?))
}

/// Largest total angle of attack of the runs to identify on, rad.
fn reached_rad(campaign: &Campaign) -> Result<f64, DiscoverError> {
    let of = |i: &usize| largest_angle_rad(campaign, *i);
    let all = runs_of(campaign, Use::Identify).iter().map(of).collect::<Result<Vec<f64>, _>>()?;
    Ok(all.into_iter().fold(0.0, f64::max))
}

#[cfg(test)]
mod tests;
