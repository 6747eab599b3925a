//! verify tests: one binary. In: nothing. Out: verdicts.

mod checks;
mod common;
mod planet;
mod recovery;
mod resimulate;
