//! sim tests: one binary. In: nothing. Out: verdicts.

mod campaign;
mod common;
