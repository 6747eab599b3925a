//! The loop: recovery, re-simulation, tracing and closing, and the verdicts. No physics and no files of its own.

mod error;
mod resimulate;
pub mod trace;

pub use error::VerifyError;
pub use resimulate::{
    FlownParameter, HoldOut, Initial, InitialStop, Replay, Resimulation, RunComparison, Statistic, Swing, TrajectoryError,
    estimate_initial, fly_like, hold_out, identified_plant, resimulate,
};
