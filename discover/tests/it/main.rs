//! discover tests: one binary. In: nothing. Out: verdicts.

mod close;
mod closing;
mod common;
mod free_flight;
mod height_and_force;
mod measured_sets;
mod page;
mod plan;
mod point_mass;
mod statistics;
mod symmetry;
