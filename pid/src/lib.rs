//! pid: the identifier. In: run records and a declared plant. Out: aerodynamic parameters with intervals.
//!
//! Record → [`smooth`] → [`states`] → [`coefficients`] → [`regress`] → [`Identification`]. Written from the thesis' §3-4 and
//! Appendix B by components and Euler angles; it never sees a simulator or its truth.

mod angles;
pub mod bands;
pub mod bandwidth;
mod choice;
pub mod coefficients;
pub mod compatibility;
mod declared;
mod envelope;
mod equation_error;
pub mod equations;
mod error;
mod euler;
pub mod filter_error;
pub mod golden;
mod identifiability;
mod identification;
mod identify;
mod information;
mod instrument;
mod interval;
mod not_noise;
pub mod output_error;
pub mod plan;
mod plant;
pub mod plausible;
pub mod regress;
mod shared;
pub mod simplex;
pub mod smooth;
pub mod states;
mod stop;
pub mod structure;
mod test_table;
pub mod tether_fit;

pub use angles::{Angles, rates_and_angles};
pub use choice::identify_chosen;
pub use envelope::{Envelope, RunEnvelope, SetEnvelope};
pub use equation_error::{RunRows, estimated, process};
pub use error::PidError;
pub use identifiability::identifiability;
pub use identification::{CoefficientFit, Curve, DataSet, Estimate, FoundEffect, FoundNumber, Held, Identification, Refused};
pub use identify::{Method, identify, identify_by, identify_with};
pub use information::{Correlation, Identifiability};
pub use interval::{NORMAL_95, ci95, relative_percent};
pub use plant::{PROCESS_NOISE, TURBULENCE};
pub use stop::{SearchKind, StopReason};
pub use test_table::{TestTable, add_envelopes, run_envelope, test_table};
