//! tests: the program from outside. In: arguments and files. Out: exit codes, printed text and written files.

mod arrows;
mod bad_input;
mod bandwidth;
mod capsule;
mod circles;
mod commands;
mod descend;
mod examples;
mod figures;
mod gusts;
mod knowledge;
mod loop_closes;
mod one_identify;
mod own_columns;
mod plan;
mod program;
mod record_check;
mod structure;
mod supply;
mod wind_tunnel;
