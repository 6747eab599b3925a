//! likelihood tests: mean squares of runs against one, of flights that a fit has seen and not.

use super::*;
use crate::flown::flown_by;
use windfall_model::Use;

/// The tail of χ² at its mean and beyond, by closed forms of an even number of degrees: 4 of them, `e^{-x/2} (1 + x/2)`.
#[test]
fn exact_tail_of_a_mean_square() {
    let of = |mean_square: f64| MeanSquare { run: String::new(), channel: 0, mean_square, std: 0.5_f64.sqrt() }.p_value();
    for x in [4.0_f64, 20.0] {
        let expected = (-0.5 * x).exp() * (1.0 + 0.5 * x);
        assert!((of(x / 4.0) / expected - 1.0).abs() < 1e-9, "{x}");
    }
    assert!(of(f64::INFINITY).abs() < 1e-300 && of(f64::NAN).abs() < 1e-300);
}

/// Held-out flights of the same plant are noise; one in which the effect is ten times as strong is not. Numbers that the fit hardly knows
/// do not matter.
#[test]
fn law_held_out_flights_of_another_plant_are_not_noise() {
    let flights: [(Use, f64, &[f64]); 3] =
        [(Use::Identify, 6.0, &[0.0, 1e-3, 0.0]), (Use::HoldOut, 6.0, &[0.0, 1e-3, 0.0]), (Use::HoldOut, 6.0, &[0.0, 1e-2, 0.0])];
    let (engine, model) = flown_by("center-of-mass", &flights);
    let fit = engine.climb(&model, false, 12).expect("a fit");
    let least = |squares: &[MeanSquare]| squares.iter().map(MeanSquare::p_value).fold(1.0, f64::min);
    let own = engine.mean_squares(&fit.model, &[]).expect("followed");
    assert!(own.len() == POSE && least(&own) > 1e-3, "{own:?}");
    let of = |run: usize| engine.of_others(&fit, &[run], &[]).expect("a run").expect("followed");
    let same = of(1);
    assert!(least(&same.squares) > 1e-3 && same.moved_p_value > 1e-3, "{same:?}");
    let other = of(2);
    assert!(least(&other.squares) < 1e-9 || other.moved_p_value < 1e-9, "{other:?}");
}
