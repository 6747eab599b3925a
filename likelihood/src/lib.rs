//! likelihood: one likelihood for tunnel runs: what is measured, what drives it at random, and every number that may be wrong.
//!
//! [`Engine`] makes runs ready and learns their noise; a pass of its extended Kalman filter gives the innovations' log-likelihood and the
//! whitened normal equations ([`Gram`]) of every column: declared parameters, uncertain constants, strengths of all effects of the
//! catalogue. [`discover`] weighs sets of effects by marginal likelihood, fits the best, and weighs again until the set stays. In: a
//! campaign. Out: the set, its numbers, rivals, and what generic alternatives say against it.
//!
//! Sources: Klein and Morelli, Aircraft System Identification, 2006, ch. 6; Durbin and Koopman, Time Series Analysis by State Space
//! Methods, 2012; Bishop, Pattern Recognition and Machine Learning, 2006, §3.5.

mod absolute;
mod blown;
mod bursts;
mod check;
mod columns;
mod discover;
mod engine;
mod filter;
#[cfg(test)]
mod flown;
mod gram;
mod hum;
mod innovations;
mod intensity;
mod joined;
mod model;
mod noise;
mod predictive;
mod random;
mod random_fit;
mod random_range;
mod ridge;
mod robust;
mod run;
mod search;
mod shock;
mod spectrum;
mod wind;

pub use absolute::{MeanSquare, NOISE_KNOWN, OtherRuns};
pub use check::Lead;
pub use discover::{
    CONTRADICTED, Contest, Discovery, FamilySet, RivalPair, Rivals, SOMETHING_ELSE, UNFLOWN, Unseen, beside_something_else,
    discover, identify, log_odds,
};
pub use engine::{Engine, Fit, OfRun};
pub use gram::{Gram, Posterior};
pub use hum::Hum;
pub use innovations::Innovations;
pub use model::{Id, Member, Model, Number};
pub use noise::{ChannelNoise, declared as declared_noise};
pub use predictive::{NearFit, Top, averaged, top};
pub use random_range::RandomRange;
pub use search::{Set, Unit, log_mean};
