//! verify tests: one binary. In: nothing. Out: verdicts.

mod checks;
mod closing;
mod common;
mod descent;
mod planet;
mod quantities;
mod recovery;
mod resimulate;
mod symmetry;
