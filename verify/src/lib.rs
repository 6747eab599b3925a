//! The loop: recovery, re-simulation, tracing and closing, and the verdicts. No physics and no files of its own.

mod bootstrap;
mod checks;
pub mod close;
pub mod descent;
mod error;
mod identify;
mod joint_errors;
pub mod many;
mod quantile;
mod recovery;
mod residual;
mod resimulate;
pub mod separate;
pub mod statistics;
pub mod study;
pub mod tracks;
mod wind_tunnel;

pub use bootstrap::{Bootstrap, BootstrapLine, bootstrap};
pub use checks::{Bound, Check, CheckKind, CheckVerdict, Setups, all_pass, checks};
pub use error::VerifyError;
pub use identify::{Identified, IdentifyOrder, Tie, identify};
pub use joint_errors::drawn;
pub use recovery::{Reconstructed, Recovered, Recovery, TABLE_C_1, campaign_of, recover};
pub use resimulate::{
    Band, FlownParameter, HoldOut, Initial, Replay, Resimulation, RunComparison, Statistic, Swing, TrajectoryError,
    estimate_initial, hold_out, resimulate, resimulate_with_draws,
};
pub use wind_tunnel::{WindTunnelLine, WindTunnelModel};
pub use windfall_pid::{DataSet, Estimate, Identification};
