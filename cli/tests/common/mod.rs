//! cli tests: what several of them fly. In: nothing. Out: a scenario's text.

/// A perturbed flight of 2 s at 100 Hz.
pub(crate) fn short_scenario() -> String {
    let whole = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
    whole.replace("duration_s = 18.3", "duration_s = 2.0").replace("rate_hz = 150.0", "rate_hz = 100.0")
}
