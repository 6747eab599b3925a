//! verify tests: the program flies its closed forms; how far apart two results are.

use super::*;
use crate::tests::{pass, with_setups};

/// Bodies without moment, and closed forms with air.
#[test]
fn exact_closed_forms_are_flown() {
    with_setups(|s| {
        pass(&rigid_body(s).expect("flies"));
        let all = air(s).expect("flies");
        pass(&all);
        // √(q S d |C_m,sin|/I_yy)/2π is 0.96 Hz in print; lift, damping and tether change it by less than a tenth.
        let words = &all.iter().find(|c| c.id == "pitch-mode-flown").expect("a check").what;
        let hertz: f64 = words.split_once("mode at ").and_then(|(_, w)| w.split(' ').next()?.parse().ok()).expect("a number");
        assert!((hertz / 0.96 - 1.0).abs() < 0.1, "{hertz}");
    });
}

/// A tether that pulls more the longer it is keeps its length to second order: small pitching is that of its pull at trim.
#[test]
fn exact_pitching_on_a_stretched_tether() {
    with_setups(|s| {
        let (plant, like) = first(s.appendix_c).expect("a flight");
        let mut plant = plant.clone();
        plant.tether.as_mut().expect("a tether").length_per_m = 0.9;
        pass(&[pitching(&plant, like).expect("flies")]);
    });
}

/// Differences over what is known: 13 of 65, and 0.4 of 1.6.
#[test]
fn exact_relative_differences() {
    let known = Vector3::new(16.0, -63.0, 0.0);
    assert!((relative(known + Vector3::new(3.0, 4.0, 12.0), known) - 0.2).abs() < 1e-15);
    assert!((of_largest(&[1.1, -2.0, 0.5], &[1.0, -1.6, 0.2]) - 0.25).abs() < 1e-15);
}
