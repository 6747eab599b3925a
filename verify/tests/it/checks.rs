//! verify tests: the checks of `windfall verify`. In: bundled scenarios. Out: whether all pass, and whether they can fail.

use crate::bundled;
use windfall_verify::{Check, CheckKind, CheckVerdict, Setups, all_pass, checks};

fn run(change: impl Fn(&mut [windfall_model::Scenario; 4])) -> Vec<Check> {
    let mut s = ["appendix-c", "full-scale-venus-20km", "sage-combined", "pole-push"].map(bundled);
    change(&mut s);
    let [appendix_c, full_scale, combined, pole_push] = &s;
    checks(&Setups { appendix_c, pole_push, full_scale, combined }).expect("the checks run")
}

fn of<'a>(all: &'a [Check], id: &str) -> &'a Check {
    all.iter().find(|c| c.id == id).unwrap_or_else(|| panic!("check {id}"))
}

#[test]
fn recover_every_check_passes_and_shows_the_thesis_beside() {
    let all = run(|_| ());
    let failed: Vec<&Check> = all.iter().filter(|c| c.verdict == CheckVerdict::Fail).collect();
    assert!(all_pass(&all), "{failed:?}");
    for kind in [CheckKind::Exact, CheckKind::Published, CheckKind::Recovered] {
        assert!(all.iter().any(|c| c.kind == kind));
    }
    let mut ids: Vec<&str> = all.iter().map(|c| c.id.as_str()).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), all.len(), "ids are unique");
    // Both methods on the same run, side by side; the thesis' own is a result without a bound.
    let (own, thesis) = (of(&all, "appendix-c-equation-error-CN-CN_sin3"), of(&all, "appendix-c-thesis-CN-CN_sin3"));
    assert_eq!((own.verdict, thesis.verdict), (CheckVerdict::Pass, CheckVerdict::Shown));
    // Unsmoothed derivatives, as the thesis took them there: of the order of its own error.
    assert!(own.figure < 1e-3 && thesis.figure > 0.1 && thesis.figure < 6.84, "{} {}", own.figure, thesis.figure);
    // Smoothed whole and cropped then, a pushed run keeps its linear terms; cropped first, C_N,sin³ would be off by three times itself.
    let pushed = |name: &str| of(&all, &format!("pole-push-thesis-{name}")).figure;
    // README has 3.694 for 3.5129, 5.17 % off.
    assert!(
        (pushed("CN-CN_sin") - 5.17).abs() < 0.01 && pushed("CN-CN_sin3") < 100.0,
        "{} {}",
        pushed("CN-CN_sin"),
        pushed("CN-CN_sin3")
    );
    assert_eq!((own.thesis, thesis.thesis), (Some(6.84), Some(6.84)));
    assert!(all.iter().filter(|c| c.id.starts_with("appendix-c-equation-error")).count() == 13);
}

/// Checks that cannot fail prove nothing: a lander with another drag misses the printed trim, another scale misses Froude.
#[test]
fn law_checks_fail_on_another_lander() {
    let all = run(|[appendix_c, full_scale, ..]| {
        let i = appendix_c.plant.aero.structure.index("CA_T0").expect("there");
        appendix_c.plant.aero.values[i] *= 1.02;
        full_scale.plant.vehicle.mass_kg *= 1.001;
    });
    assert!(!all_pass(&all));
    for id in ["trim-pressure", "trim-speed", "froude-scaling"] {
        assert_eq!(of(&all, id).verdict, CheckVerdict::Fail, "{id}");
    }
    // What does not depend on the drag's value still holds.
    for id in ["trim-hover", "fall-with-drag", "torque-free-energy", "appendix-c-equation-error-CA-CA_T0"] {
        assert_eq!(of(&all, id).verdict, CheckVerdict::Pass, "{id}");
    }
}
