//! verify: tracing a residual to an effect. In: evidence and a declared plant. Out: fits and weighed families.

mod evidence;
mod fit;
mod hypothesis;
mod likelihood;
mod point;
mod repeat;
mod search;
mod tunnel;

pub use evidence::{BIN, Cov, Evidence, LeadTable, Residual};
pub use fit::{Fit, Problem, StopReason};
pub use hypothesis::{Free, Hypothesis, Instance, acts};
pub use point::{PointEvidence, TrackResidual};
pub use repeat::{Witnesses, repeats};
pub use search::{Candidate, Weighing, p_value, weigh};
pub use tunnel::{BAND_HZ, TunnelEvidence};
