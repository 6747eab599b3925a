//! study: many campaigns. In: a study's order and the number of a draw, or what each campaign of others gave. Out: one row of results each,
//! and what all rows say together; numbers pooled over campaigns.
//!
//! Draw i is a function of (study, seed, i) alone: what varies, gusts and sensor noise come from counter-based streams that are
//! addressed by i, so that no order of work, number of threads or interruption changes a bit.

mod closing;
mod columns;
mod dependence;
mod draw;
mod error;
pub mod many;
mod recovery;
mod reliability;
mod row;
mod run;
mod select;
mod stop;
mod summary;

pub use dependence::DependenceLine;
pub use draw::PreparedStudy;
pub use error::StudyError;
pub use recovery::{ClosingSummary, ConfusionLine, RecoveredDraw, RecoveryLine, VariedLine};
pub use reliability::ReliabilityPoint;
pub use run::{each, run};
pub use stop::{Moments, Progress, clopper_pearson};
pub use summary::{Count, FailureKind, NumberLine, ParameterSummary, Quantile, Rate, Summary, WordLine, summarise};
