//! study: many campaigns. In: what each gave. Out: a row each, counts, parameters pooled over campaigns.

mod outcome;
mod pool;
mod summary;
mod table;

pub use outcome::{CampaignOutcome, OutcomeParameter, Status};
pub use pool::{Pooled, pool};
pub use summary::{ManySummary, PooledParameter, Tally};
pub use table::campaign_table;
