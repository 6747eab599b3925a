//! verify tests: one binary. In: nothing. Out: verdicts.

mod checks;
mod close;
mod closing;
mod common;
mod compatibility;
mod descent;
mod free_flight;
mod gross;
mod height_and_force;
mod identification;
mod measured_sets;
mod plan;
mod planet;
mod point_mass;
mod quantities;
mod recovery;
mod resimulate;
mod statistics;
mod structure;
mod symmetry;
