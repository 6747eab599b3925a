//! discover tests: lines of a closing on tracks, from a contest of given numbers, against closed forms.

use super::contest::tests::{contest, drops, effect, scored};
use super::*;
use windfall_model::Constant;

const DECLARED: Free = Free::Declared(0);

/// Drag is best; a steady push or apparent mass in its place; a push beside it.
fn with_drag<'a>(c: &'a Campaign, settings: &'a Settings) -> TrackContest<'a> {
    let drag = || effect("drag", &[0.3]);
    let push = || effect("constant-acceleration", &[-1.1, 0.0, 0.0]);
    let none = scored(&[], Vec::new(), &[DECLARED], -43.0, 897.0);
    let best = scored(&[0], vec![drag()], &[DECLARED, Free::Effect(0, 0)], -31.0, 900.0);
    let near = scored(&[1], vec![push()], &[DECLARED, Free::Effect(0, 0)], -33.0, 897.1);
    let far = scored(&[2], vec![effect("apparent-mass", &[0.1])], &[DECLARED, Free::Effect(0, 0)], -35.0, 896.9);
    let both = scored(&[0, 1], vec![drag(), push()], &[DECLARED, Free::Effect(0, 0), Free::Effect(1, 0)], -30.0, 899.0);
    let singles = vec![near.clone(), best.clone()];
    let mut found = contest(c, settings, none, best, vec![near, far, both]);
    found.singles = singles;
    found
}

/// Probabilities in proportion to the exponential of scores, which may be hundreds of nats; rivals within ln 20, 2.996.
#[test]
fn exact_probabilities_and_rivals() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let found = with_drag(&c, &settings);
    let weights = [1.0, (-1.0_f64).exp(), (-2.9_f64).exp(), (-3.1_f64).exp()];
    let sum: f64 = weights.iter().sum();
    let weighed = found.weighed();
    assert!(weighed.len() == 4 && weighed.iter().zip(weights).all(|((_, p), w)| (p - w / sum).abs() < 1e-12));
    let line = effect_line(&found, &settings, 0, true, None, 0.5);
    assert!((line.probability.expect("weighed") - (weights[0] + weights[1]) / sum).abs() < 1e-12, "{line:?}");
    assert_eq!(line.rivals, ["constant-acceleration"]);
}

/// Of two in the best set, others may take the place of one.
#[test]
fn exact_rivals_of_one_of_two() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let set = |families: &[usize], score: f64| scored(families, Vec::new(), &[], 0.0, score);
    let others = vec![set(&[1, 2], 39.0), set(&[2], 39.5), set(&[0, 2], 36.9)];
    let found = contest(&c, &settings, set(&[], 0.0), set(&[0, 1], 40.0), others);
    assert_eq!(rivals(&found, 0), ["apparent-mass"]);
    assert!(rivals(&found, 1).is_empty());
}

/// Twice 12 nats by one number, of which six runs allow (6 − 1 − ½ − 1)/6, with the tail of χ² of one degree, the error function's;
/// the best of three families.
#[test]
fn exact_chance_of_a_gain() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let found = with_drag(&c, &settings);
    let tail = |gain: f64| statrs::function::erf::erfc((0.5 * gain).sqrt());
    let of_three = |p: f64| 1.0 - (1.0 - p).powi(3);
    let share = 3.5 / 6.0;
    let p = chance(&found, 0);
    assert!((p / of_three(tail(24.0 * share)) - 1.0).abs() < 1e-6, "{p}");
    let lines = candidates(&found);
    assert_eq!(lines.len(), 2);
    for (line, (family, gain)) in lines.iter().zip([("drag", 24.0 * share), ("constant-acceleration", 20.0 * share)]) {
        assert!(line.family == family && (line.score - gain).abs() < 1e-12, "{line:?}");
        assert!((line.p_value / of_three(tail(gain)) - 1.0).abs() < 1e-6, "{line:?}");
    }
}

/// A push of −1.1 ± √0.12 m/s² beside drag is under its size and 1.96 standard errors; two numbers of it were not free and have no
/// bound. One far off is under what a body can have, 3.
#[test]
fn exact_bounds() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let mut found = with_drag(&c, &settings);
    for (value, upper) in [(-1.1, 1.1 + NORMAL_95 * 0.12_f64.sqrt()), (2.9, 3.0)] {
        found.neighbours[2].fit.hypothesis.effects[1].values[0] = value;
        let all = bounds(&found, &settings);
        assert_eq!(all.len(), 1, "{all:?}");
        assert!(all[0].parameter == "down_m_s2" && (all[0].upper95 - upper).abs() < 1e-12, "{all:?}");
    }
}

/// White noise, no part of the residual that is not, and numbers that are known: the log-likelihood of held-out runs differs by half of the whitened
/// squares.
#[test]
fn exact_gain_on_runs_held_out() {
    let mut c = drops();
    c.plant.point.air_density_kg_m3 = 1.2;
    let settings = Settings::of(&c, &[]);
    let mut found = with_drag(&c, &settings);
    let held = TrackEvidence::new(&c, &[1, 4], &c.plant).expect("two tracks");
    for fit in [&mut found.best.fit, &mut found.declared.fit] {
        fit.hypothesis.generic = vec![0.0; held.components()];
        fit.covariance.fill(0.0);
    }
    let squares = |h: &TrackModel| held.residual(&h.plant(&c.plant)).iter().map(|z| z * z).sum::<f64>();
    let less = squares(&found.declared.fit.hypothesis) - squares(&found.best.fit.hypothesis);
    let gain = effect_line(&found, &settings, 0, true, Some(&held), 0.5).held_out_gain.expect("runs");
    let expected = 0.5 * less / held.white_variance(0);
    assert!(expected.abs() > 1e-3 && (gain / expected - 1.0).abs() < 1e-9, "{gain} {expected}");
}

#[test]
fn exact_constants_depart_from_what_is_declared() {
    let c = drops();
    let mut set = scored(&[], Vec::new(), &[Free::Constant(0)], 0.0, 0.0);
    let mass = Constant { key: "mass", component: "", unit: "kg", lens: |p| Some(&mut p.vehicle.mass_kg), std: 0.2 };
    set.fit.hypothesis.constants = vec![(mass, 0.03)];
    let line = &constants(&c, &set.fit)[0];
    assert!((line.declared - 0.1).abs() < 1e-15 && (line.estimate - 0.13).abs() < 1e-15, "{line:?}");
    assert!((line.std_error.expect("free") - 0.2).abs() < 1e-15, "{line:?}");
}
