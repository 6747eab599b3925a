//! verify tests: one binary. In: nothing. Out: verdicts.

mod checks;
mod planet;
mod quantities;

/// A bundled scenario.
fn bundled(name: &str) -> windfall_model::Scenario {
    windfall_scenarios::read_bundled(name).expect("bundled scenarios are well-formed").scenario
}
