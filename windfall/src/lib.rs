//! Simulate a lander in a vertical wind tunnel, identify its aerodynamics, fly what was found, and say what the model lacks.
//!
//! ```
//! use windfall::prelude::*;
//!
//! fn main() -> windfall::Result<()> {
//!     let campaign = Scenario::bundled("sage-perturbed")?.fly(&Fly::default())?.campaign();
//!     let found = campaign.identify(&Identify { method: Some(Method::OutputError), combined: true, ..Identify::default() })?;
//!     let again = campaign.resimulate(&found, &Resimulate::default())?;
//!     assert!(again.trajectory.attitude_rms_deg < 0.5);
//!     let closing = campaign.close(&Close::default())?;
//!     assert_eq!(closing.verdict, Verdict::Consistent);
//!     Ok(())
//! }
//! ```
//!
//! A verb is a request, a method and a result. The request is a plain struct whose [`Default`] is what most want; it reads and writes
//! as JSON, and with the feature `cli` it is also the flags of the program's command. [`Campaign::read`] takes measured runs in place of
//! a scenario. Work runs on the threads of the current rayon pool; no result depends on how many there are.
//!
//! Units are SI, angles rad, unless a name ends in `_deg`. Program (`cli/`) and Python (`python/`) stand on this crate alone.

mod campaign;
mod check;
mod descend;
mod error;
mod explain;
mod folder;
mod found;
pub mod free;
mod glossary;
mod many;
pub mod planet;
mod published;
mod requests;
mod scenario;
mod study;
mod words;

pub use campaign::{Campaign, CampaignSource};
pub use check::{Checked, Verification, check, looked_at, reached, verify};
pub use descend::{DescentScenario, put_descents, write_descents};
pub use error::{Error, ErrorKind, Result};
pub use explain::{Explain, Init, explain, init};
pub use folder::{DESCENT_FILES, FIGURE_ENDINGS, FIGURE_WIDTHS_MM, ResultsFolder};
pub use found::{identification_of, read_identification};
pub use many::{CampaignDone, Campaigns, Each, Many};
pub use published::Published;
pub use requests::{
    Close, Cutoff, Descend, Fly, Identify, MOST_COPIES, MOST_DESCENTS, MOST_THREADS, Plan, Resimulate, Structure, Study,
};
pub use scenario::{FlightSummary, Flights, Scenario, Simulation};
pub use study::{Drawing, PartRule, SUMMARY};
pub use windfall_model as model;
pub use windfall_report as report;
pub use words::{criterion, cutoff, hold, prior, seconds, target, tie};

/// What a session begins with.
pub mod prelude {
    pub use crate::results::{Identified, Resimulation, Verdict};
    pub use crate::{Campaign, Close, Fly, Identify, Method, Plan, Published, Resimulate, Scenario, Structure};
}

/// Results by name, in the layout of the JSON files.
pub mod results {
    pub use crate::campaign::Planned;
    pub use windfall_discover::close::{
        CheckedRuns, Closing, EffectLine, Figure, HeldOut, Instead, SignalTracks, SmoothingTracks, Verdict,
    };
    pub use windfall_discover::separate::{Deciding, NextRun, Separated, Separation, Sharpened};
    pub use windfall_discover::statistics::{StatisticsClosing, statistics_table};
    pub use windfall_discover::{Identified, WindTunnelLine, WindTunnelModel};
    pub use windfall_pid::compatibility::{Compatibility, FALSE_ALARM_RATE, InstrumentError, Instruments, Pressure};
    pub use windfall_pid::plan::{TargetPlan, TestPlan};
    pub use windfall_pid::structure::{Choice, CoefficientChoice, Symmetry};
    pub use windfall_pid::{
        DataSet, Envelope, Estimate, FoundEffect, FoundNumber, Identifiability, Identification, NORMAL_95, RunEnvelope,
        SetEnvelope, TestTable, relative_percent,
    };
    pub use windfall_replay::descent::{Descended, DescentSummary, HeightLine, ParameterShare, SteadyFall, TouchDownLine};
    pub use windfall_replay::{Bootstrap, Resimulation, RunComparison, Statistic};
    pub use windfall_sim::{Flown, Truth};
    pub use windfall_study::many::{CampaignOutcome, ManySummary, OutcomeParameter, Pooled, PooledParameter, Status, Tally};
    pub use windfall_study::{Moments, Summary};
    pub use windfall_verify::{Check, CheckKind, CheckVerdict};
}

/// Files of the program: results as JSON, structures, studies' folders.
pub mod files {
    pub use windfall_scenarios::{
        BUNDLED, BUNDLED_FREE, BUNDLED_PLANETS, CampaignStore, FileSet, Piece, Store, json_text, key_reference, read_json,
        read_runs, record_columns, series_text, settle, text_atomically, write_columns_csv, write_json_atomically,
        write_structure,
    };
}

pub use windfall_discover::statistics::StatisticsError;
pub use windfall_discover::{DiscoverError, Tie};
pub use windfall_pid::output_error::Prior;
pub use windfall_pid::plan::{Target, Wanted};
pub use windfall_pid::structure::Criterion;
pub use windfall_pid::{Held, Method, PidError};
pub use windfall_replay::ReplayError;
pub use windfall_scenarios::{Draft, DraftKind, FindError, ReadError, RunColumns, Shard, StoreError, WriteError};
pub use windfall_sim::SimError;
pub use windfall_study::StudyError;
pub use windfall_verify::VerifyError;
