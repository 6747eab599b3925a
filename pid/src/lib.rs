//! pid: the identifier. In: run records and a declared plant. Out: aerodynamic parameters with intervals.
//!
//! Record → [`smooth`] → [`states`] → [`coefficients`] → [`regress`] → [`Identification`]. Written from the thesis' §3-4 and
//! Appendix B by components and Euler angles; it never sees a simulator or its truth.

mod angles;
pub mod bands;
mod choice;
pub mod coefficients;
pub mod compatibility;
pub mod equations;
mod error;
pub mod filter_error;
pub mod golden;
mod identifiability;
mod identification;
mod identify;
mod instrument;
pub mod output_error;
pub mod plan;
mod plant;
pub mod plausible;
pub mod regress;
pub mod simplex;
pub mod smooth;
pub mod states;
pub mod structure;
pub mod tether_fit;
pub mod window;

pub use angles::{Angles, rates_and_angles};
pub use choice::identify_chosen;
pub use error::PidError;
pub use identifiability::{Correlation, Identifiability, identifiability};
pub use identification::{CoefficientFit, DataSet, Estimate, Held, Identification, NORMAL_95, relative_percent};
pub use identify::{Method, RunRows, estimated, identify, identify_by, identify_with, process};
