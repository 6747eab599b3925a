//! likelihood tests: ridges against parabolas and the posterior itself.

use super::*;
use crate::flown::flown;

/// The posterior of a loose mass' size is what its interval says: 1.92 below the top at the farther end of 95 %, all other numbers
/// following.
#[test]
fn law_a_loose_mass_is_known_as_well_as_said() {
    let (engine, model) = flown(12.0, "loose-mass", &[0.05, 2.0, 0.05, 0.1, 1.0]);
    let engine = engine.without_priors_of_strengths();
    let fit = engine.climb(&model, true, 12).expect("a fit");
    let (mass, before) = (Id::Member(0, 0), height(&fit));
    let (fit, added) = engine.along_ridges(fit);
    let at = fit.numbers.iter().position(|n| n.id == mass).expect("a strength");
    let std = added.iter().fold(fit.covariance[(at, at)], |sum, column| sum + column[at] * column[at]).sqrt();
    assert!(!added.is_empty() && height(&fit) > before - 1e-6, "{before} {}", height(&fit));
    let (step, own) = step(&fit, mass).expect("a step");
    let held = engine.holding(mass);
    let fallen = [-1.0, 1.0].map(|side| {
        let start = along(&fit.model, &fit.numbers, &step, side * NORMAL_95 * std / own);
        let there = held.climb(&start, true, 12).expect("a fit").model;
        let sum = engine.sum(&there, &[], &[]).expect("a pass");
        height(&fit) - sum.log_likelihood + penalty(&engine.free(&there, true))
    });
    let least = fallen[0].min(fallen[1]);
    assert!((least - 1.92).abs() < 0.3, "{fallen:?} at {std} for {own}");
}

/// Of a parabola: its own top and standard deviation, whichever places of it are known; of one that is steeper below: what it is
/// above.
#[test]
fn exact_crest_of_a_parabola() {
    for places in [vec![-1.0, 1.0, 4.0, 9.0], vec![2.5, 3.5, 5.0], vec![-4.0, -2.0, 0.0, 1.0]] {
        let ridge: Vec<(f64, f64)> = places.into_iter().map(|x: f64| (x, 7.0 - 0.5 * ((x - 3.0) / 2.0_f64).powi(2))).collect();
        let found = crest(&ridge).expect("three places");
        let top = found.value.min(ridge[ridge.len() - 1].0);
        assert!((top - 3.0_f64.min(ridge[ridge.len() - 1].0)).abs() < 1e-12, "{found:?}");
        if ridge[ridge.len() - 1].0 > 3.0 {
            assert!((found.std - 2.0).abs() < 1e-9, "{found:?}");
        }
    }
    let std = |x: f64| if x < 0.0 { 1.0 } else { 3.0 };
    let ridge: Vec<(f64, f64)> = (-30..=70).map(|i| 0.1 * f64::from(i)).map(|x| (x, -0.5 * (x / std(x)).powi(2))).collect();
    let found = crest(&ridge).expect("many places");
    assert!(found.value.abs() < 0.2 && (found.std - 3.0).abs() < 0.1, "{found:?}");
    assert!(crest(&ridge[..2]).is_none());
}

/// Of a parabola that has not fallen by 95 % where it ends: its own standard deviation, as it goes on, on either side.
#[test]
fn exact_reach_beyond_the_places() {
    for side in [-1.0, 1.0] {
        let mut ridge: Vec<(f64, f64)> =
            [1.4, 2.7, 3.3, 4.2].map(|x: f64| (side * x, 7.0 - 0.5 * ((x - 2.9) / 1.7).powi(2))).to_vec();
        ridge.sort_by(|a, b| a.0.total_cmp(&b.0));
        let found = crest(&ridge).expect("four places");
        assert!((found.value - side * 2.9).abs() < 1e-12 && (found.std - 1.7).abs() < 1e-9, "{found:?}");
    }
}

/// A loose mass beside a pose delay, nothing else free: a fit with few numbers, declared half a standard deviation off.
fn loose() -> (Engine, Fit) {
    let (mut engine, model) = flown(1.2, "loose-mass", &[0.05, 2.0, 0.05, 0.1, 1.0]);
    engine.campaign.declared.fill(false);
    engine.campaign.plant.sensors.pose_delay_s += 0.002;
    let engine = engine.without_priors_of_strengths();
    let fit = engine.climb(&model, true, 4).expect("a fit");
    (engine, fit)
}

/// Log posterior by hand: every number's square in standard deviations of its prior, halved, off the log-likelihood of a pass.
fn posterior(engine: &Engine, model: &Model) -> f64 {
    let squares: f64 = engine.free(model, true).iter().map(|n| n.value * n.value / (n.prior * n.prior)).sum();
    engine.sum(model, &[], &[]).expect("a pass").log_likelihood - squares / 2.0
}

/// Along a ridge from a fit whose covariance is a quarter of what it should be: heights are log posteriors, steps grow by half
/// each, and the walk ends where the posterior has fallen by 2.2 standard deviations' worth or the mass' range ends.
#[test]
fn law_a_walk_along_a_ridge() {
    let (engine, mut fit) = loose();
    let mass = Id::Member(0, 0);
    fit.covariance *= 0.25;
    assert!((height(&fit) - posterior(&engine, &fit.model)).abs() < 1e-6);
    let std = step(&fit, mass).expect("a step").1;
    let places = engine.ridge_of(&fit, mass).expect("a ridge");
    let own = places.iter().position(|p| p.value.to_bits() == fit.model.members[0].values[0].to_bits()).expect("the fit");
    let highest = places.iter().map(|p| p.height).fold(f64::NEG_INFINITY, f64::max);
    for (i, p) in places.iter().enumerate() {
        // By the sum of steps that grow by half each.
        let away = i.abs_diff(own);
        let sum: f64 = [1.0, 1.5, 2.25, 3.375].iter().take(away).sum();
        assert!(((p.value - places[own].value).abs() - sum * std).abs() < 1e-9, "{i}: {} {sum} {std}", p.value);
        assert!((p.height - posterior(&engine, &p.model)).abs() < 1e-6);
        assert!((p.model.members[0].values[0] - p.value).abs() < 1e-12);
        let ends = i == 0 || i + 1 == places.len();
        assert!(ends == (highest - p.height > 0.5 * 2.2 * 2.2), "{i} {}", highest - p.height);
    }
    assert!(own > 1 && places.len() > own + 2);
    // The fit on the crest has the strength there; near the fit's own top it is as likely.
    let (top, crest) = engine.on_crest(&fit, mass).expect("a crest");
    assert!((top.model.members[0].values[0] - crest.value).abs() < 1e-9, "{crest:?}");
    assert!((crest.value - places[own].value).abs() > 1e-6);
}

/// A ridge of that reach makes the strength's variance its own, and of other numbers the part that follows the strength; a shorter one adds nothing.
#[test]
fn exact_what_a_ridge_adds() {
    let (std, reach) = (0.3_f64, 0.7_f64);
    let step = DVector::from_vec(vec![-0.2, std, 0.5]);
    let added = beyond(step.clone(), std, reach).expect("a longer reach");
    let along = &step * step.transpose() + &added * added.transpose();
    assert!((along[(1, 1)] - reach * reach).abs() < 1e-15);
    assert!((along - &step * step.transpose() * (reach / std).powi(2)).amax() < 1e-14);
    assert!(beyond(step, std, 0.29).is_none());
}

/// A strength with shapes lies on a ridge from four times the standard error on that it has beside known numbers.
#[test]
fn exact_what_is_a_ridge() {
    let (engine, mut fit) = loose();
    let (gram, _) = engine.gram(&fit.model, fit.numbers.clone()).expect("a pass");
    let at = fit.numbers.iter().position(|n| n.id == Id::Member(0, 0)).expect("a strength");
    let beside_known = 1.0 / gram.g[(at, at)].sqrt();
    for (times, ridges) in [(3.9, vec![]), (4.1, vec![at])] {
        fit.covariance[(at, at)] = (times * beside_known).powi(2);
        assert_eq!(on_ridges(&engine, &fit), ridges);
    }
}
