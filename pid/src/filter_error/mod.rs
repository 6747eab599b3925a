//! pid: filter error, maximum likelihood in turbulence (Klein and Morelli 2006, §6.2; Jategaonkar 2015, ch. 5). In: a campaign.
//! Out: parameters with intervals, size and scale of the gusts with theirs.
//!
//! Gusts of Dryden form drive the declared model; an extended Kalman filter predicts each sample from those before it, and the
//! innovations' likelihood is maximised by scoring. Slopes of the innovations by the aerodynamic parameters follow from the
//! variational equations through the filter at its own gain: at the truth innovations are white and these slopes depend on the past
//! alone, so their sum has zero mean and the bound its usual form. Slopes by size and scale of the gusts, of innovations and of their
//! covariance, are differences of the filter itself (a thousandth of their logarithm: the likelihood bends over its whole, so
//! truncation is 1e-6 and rounding 1e-10 of a slope).
//!
//! The search ends on data whose missing effect is no turbulence too: scales of the gusts are freed last and held where they run away,
//! and where no gust below a tenth of the tunnel speed explains the runs, white moments are allowed for beside it.

mod filter;
mod likelihood;
mod linear;
mod point;
mod report;
mod search;

pub(crate) use filter::{Filter, Random};
pub(crate) use linear::linearised;
pub(crate) use point::NONE_M_S;
pub use search::identify;
