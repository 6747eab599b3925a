//! The loop: recovery, re-simulation, tracing and closing, and the verdicts. No physics and no files of its own.

mod error;
pub mod trace;

pub use error::VerifyError;
