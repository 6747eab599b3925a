//! tests: the program from outside. In: arguments and files. Out: exit codes, printed text and written files.

mod arrows;
mod capsule;
mod commands;
mod knowledge;
mod loop_closes;
mod plan;
mod program;
mod structure;
