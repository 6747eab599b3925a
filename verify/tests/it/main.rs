//! verify tests: one binary. In: nothing. Out: verdicts.

mod common;
mod resimulate;
