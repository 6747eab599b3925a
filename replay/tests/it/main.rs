//! replay tests: one binary. In: nothing. Out: verdicts.

mod common;
mod compatibility;
mod data_sets;
mod declared_effects;
mod descent;
mod gross;
mod identification;
mod recovery;
mod resimulate;
mod structure;
