//! replay: runs flown again. In: campaigns, identified models, chance. Out: recovery, re-simulation, stated errors beside the scatter over
//! copies, descents of what was identified. No physics and no files of its own.

mod bootstrap;
pub mod descent;
mod error;
mod joint_errors;
mod quantile;
mod recovery;
mod resimulate;

pub use bootstrap::{Bootstrap, BootstrapLine, bootstrap};
pub use error::ReplayError;
pub use joint_errors::drawn;
pub use quantile::quantile;
pub use recovery::{Reconstructed, Recovered, Recovery, TABLE_C_1, campaign_of, parameters_of, recover, recover_by};
pub use resimulate::{
    Band, FlownParameter, HoldOut, Initial, Replay, Resimulation, RunComparison, Statistic, Swing, TrajectoryError,
    estimate_initial, hold_out, initial_of, instant_errors, mean_median_std, resimulate, resimulate_with_draws,
};
