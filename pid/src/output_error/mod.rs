//! pid: output error, maximum likelihood on what was measured (Klein and Morelli 2006, ch. 6; Jategaonkar 2015, ch. 4). In: runs
//! and a declared plant. Out: parameters with their covariance, noise, and why the search ended.
//!
//! Unknown together: the declared parameters, every run's initial state, its tunnel speed (which is measured with noise like the
//! rest: taken as exact, 3 mm/s of it would walk the predicted height away by more than the height's own noise), constant angle
//! errors when asked for, and each channel's variance. Gauss-Newton on pieces of trajectory that start from the smoothed record
//! and are made to meet, so that starting values of the parameters hardly matter; per-run unknowns are eliminated by orthogonal
//! transformations (see [`run`]), parameters solved by singular values of scaled columns.

mod identify;
mod instruments;
mod normal;
mod problem;
mod residual;
mod run;
mod speed;
mod unknowns;

pub use identify::identify;
pub(crate) use identify::{aligned, estimates, kinds, not_noise, ready, run_plants};
pub(crate) use instruments::KINDS;
pub use problem::Solution;
pub(crate) use problem::{Glance, Outcome, Solved, one_step, sensitivities, solve, solve_from};
pub use residual::ChannelFit;
pub(crate) use residual::{channel_fits, coloured, low_frequency_p, spread};
#[cfg(test)]
pub(crate) use run::tests as flown;
pub(crate) use run::{FreeColumns, NODE, PreparedRun, SPEED};
pub use speed::{Liveliness, liveliness};
pub use unknowns::{EstimateOptions, Handling, Prior};
pub(crate) use unknowns::{unknowns, with_errors};
