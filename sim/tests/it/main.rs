//! sim tests: one binary. In: nothing. Out: verdicts.

mod batch;
mod campaign;
mod chance;
mod common;
mod descent;
mod ends;
mod free_flight;
mod instruments;
mod lander;
mod nothing;
mod planet;
mod properties;
mod rigid;
mod sage;
mod scaling;
mod solver;
