//! discover: what runs say. In: a campaign and its declared model. Out: identification as it is ordered, what the model lacks and its
//! numbers, for tunnel runs, tracks of bodies without attitude and published statistics; what to fly next. No physics and no files of its own.

pub mod close;
mod error;
mod identify;
mod residual;
pub mod separate;
pub mod statistics;
pub mod tracks;
mod wind_tunnel;
pub mod words;

pub use error::DiscoverError;
pub use identify::{Identified, IdentifyOrder, Tie, identify};
pub use wind_tunnel::{WindTunnelLine, WindTunnelModel};
// What `Identified` is made of.
pub use windfall_pid::compatibility::{Agreement, Compatibility, InstrumentError, Instruments, NotExamined, Pressure};
pub use windfall_pid::{
    Correlation, DataSet, Envelope, Estimate, FoundEffect, FoundNumber, Identifiability, Identification, NORMAL_95, Refused,
    RunEnvelope, SetEnvelope, TestTable, ci95,
};
