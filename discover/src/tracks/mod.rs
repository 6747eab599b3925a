//! discover: fits to tracks of bodies without attitude, and of rigid ones in free flight. In: tracks, a declared plant, effects. Out: estimates, covariance, likelihood.

mod bins;
mod blocks;
mod components;
mod drift;
mod evidence;
mod fit;
mod force;
mod likelihood;
mod model;
mod normal;
mod pose;
mod pose_flown;
mod pose_noise;
mod scatter;
mod start;
mod track;
mod whitened;
mod witnesses;

pub use evidence::{TrackEvidence, TrackResidual};
pub use fit::{Problem, TrackFit};
pub use model::{EffectInstance, Free, TrackModel};
pub(crate) use pose::{kept_of, rotation_of};
pub(crate) use track::stated_std;
pub use witnesses::Witnesses;

#[cfg(test)]
pub(crate) mod tests;
