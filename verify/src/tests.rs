//! verify tests: the scenarios, and what a bound lets through.

use super::*;

/// Every one of some checks passes; each is named where it does not.
pub(crate) fn pass(checks: &[Check]) {
    let failed: Vec<&Check> = checks.iter().filter(|c| c.verdict != CheckVerdict::Pass).collect();
    assert!(!checks.is_empty() && failed.is_empty(), "{failed:#?}");
}

/// A flight of the lander at model scale, full scale, and a campaign.
pub(crate) fn scenarios() -> [Scenario; 4] {
    let bundled = |name| windfall_scenarios::read_bundled(name).expect("bundled").scenario;
    ["appendix-c", "full-scale-venus-20km", "sage-combined", "pole-push"].map(bundled)
}

/// Checks of these scenarios.
pub(crate) fn with_setups<T>(of: impl FnOnce(&Setups<'_>) -> T) -> T {
    let [appendix_c, full_scale, combined, pole_push] = &scenarios();
    of(&Setups { appendix_c, pole_push, full_scale, combined })
}

/// Half a digit either way.
#[test]
fn exact_bound_around_a_printed_number() {
    let bound = Bound::around(0.53, 0.005);
    let inside = [0.5249, 0.5251, 0.53, 0.5349, 0.5351, f64::NAN].map(|x| bound.contains(x));
    assert_eq!(inside, [false, true, true, true, false, false]);
}
