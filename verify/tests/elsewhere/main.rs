//! A second simulator for tests, apart from the program's: other coordinates, another integrator, other noise, air, constants
//! and physics. It writes campaign folders, which the program reads as any user's.

#![expect(clippy::print_stdout, reason = "a study prints its table")]

mod against;
mod air;
mod algebra;
mod chance;
mod closed;
mod craft;
mod dump;
mod exact;
mod families;
mod flight;
mod forces;
mod forms;
mod groups;
mod hand;
mod instruments;
mod knobs;
mod laboratory;
mod motion;
mod outside;
mod score;
mod sizes;
mod spec;
mod study;
mod unknown;
mod write;
