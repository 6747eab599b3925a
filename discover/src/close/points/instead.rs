//! discover: what would do as well as a declared parameter that the runs moved. In: a contest. Out: numbers of the body, the air and the
//! instruments, each fitted in place of it.
//!
//! Of one coast the drag coefficient is seen through its product with density and area over mass: a factor on it may be any of them, a path that is
//! not vertical, or an altimeter's scale. Each is fitted with the parameter at its declared value and everything else as in the best set; it is
//! listed where the likelihood tells the parameter from it at odds of less than twenty.

use super::contest::TrackContest;
use super::{RIVAL, problem};
use crate::close::{FittedInstead, Instead, ParameterLine};
use crate::tracks::{Free, Problem, TrackFit, TrackModel};
use rayon::prelude::*;
use windfall_model::{Constant, Effect, Given, PLANT_NUMBERS, Plant, PlantNumber};
use windfall_pid::NORMAL_95;

/// Parts of a plant whose declared numbers may be wrong instead.
const PARTS: [&str; 3] = ["vehicle.", "environment.", "pivot."];

/// Of every declared parameter that moved beyond its error, of a body that has one.
pub(super) fn of(found: &TrackContest<'_>) -> Vec<FittedInstead> {
    let (campaign, fit) = (found.campaign, &found.best.fit);
    if campaign.plant.aero.structure.parameters.len() > 1 {
        return Vec::new();
    }
    let line = |i: usize| ParameterLine::of_declared(campaign, i, fit.hypothesis.declared[i], fit.std_error(Free::Declared(i)));
    let moved = |i: &usize| campaign.declared[*i] && line(*i).moved().is_some_and(|m| m.abs() > NORMAL_95);
    (0..campaign.declared.len())
        .filter(moved)
        .map(|i| FittedInstead { parameter: campaign.plant.aero.structure.parameters[i].clone(), instead: instead_of(found, i) })
        .collect()
}

fn instead_of(found: &TrackContest<'_>, parameter: usize) -> Vec<Instead> {
    let known = |n: &PlantNumber| found.campaign.knowledge.constants.iter().any(|c| (c.key, c.component) == (n.key, n.component));
    let may = |n: &&PlantNumber| {
        matches!(n.given, Given::Declared | Given::DeclaredOfPoint) && PARTS.iter().any(|p| n.key.starts_with(p)) && !known(n)
    };
    let numbers: Vec<&PlantNumber> = PLANT_NUMBERS.iter().filter(may).collect();
    let mut all: Vec<Instead> = numbers.par_iter().filter_map(|n| by_number(found, parameter, n)).collect();
    all.extend(found.families.par_iter().filter_map(|&e| by_effect(found, parameter, e)).collect::<Vec<_>>());
    all.extend(by_slope(found, parameter));
    all.retain(|i| i.lost < RIVAL.ln());
    all.sort_by(|a, b| a.lost.total_cmp(&b.lost));
    all
}

/// The best set with the parameter at its declared value.
fn held(found: &TrackContest<'_>, parameter: usize) -> TrackModel {
    let mut h = found.best.fit.hypothesis.clone();
    h.declared[parameter] = found.campaign.plant.aero.values[parameter];
    h
}

/// A model fitted with the parameter held, and what it loses of the log-likelihood.
fn refitted(found: &TrackContest<'_>, parameter: usize, h: &TrackModel) -> (TrackFit, f64) {
    let mut declared = found.campaign.declared.clone();
    declared[parameter] = false;
    let fit = Problem { declared: &declared, ..problem(found.campaign, &found.evidence) }.fit(h, true);
    let lost = found.best.fit.log_likelihood - fit.log_likelihood;
    (fit, lost)
}

/// With a constant of which nothing is believed: its standard uncertainty is its own size.
fn by_constant(found: &TrackContest<'_>, parameter: usize, constant: Constant) -> (f64, f64) {
    let mut h = held(found, parameter);
    h.constants.push((constant, 0.0));
    let place = h.constants.len() - 1;
    let (fit, lost) = refitted(found, parameter, &h);
    (fit.hypothesis.constants[place].1, lost)
}

fn by_number(found: &TrackContest<'_>, parameter: usize, n: &PlantNumber) -> Option<Instead> {
    let declared = (n.lens)(&mut found.campaign.plant.clone()).map(|x| *x).filter(|x| *x != 0.0)?;
    let constant = Constant { key: n.key, component: n.component, unit: n.unit, lens: n.lens, std: declared.abs() };
    let (departure, lost) = by_constant(found, parameter, constant);
    let estimate = declared + departure;
    let possible = estimate * declared > 0.0 && (n.range[0]..=n.range[1]).contains(&estimate);
    possible.then(|| Instead { key: n.name(), meaning: n.meaning.to_owned(), declared, estimate, unit: n.unit.to_owned(), lost })
}

fn slope(plant: &mut Plant) -> Option<&mut f64> {
    Some(&mut plant.point.slope_squared)
}

/// A path that is not vertical, where heights alone were measured.
fn by_slope(found: &TrackContest<'_>, parameter: usize) -> Option<Instead> {
    let (departure, lost) =
        by_constant(found, parameter, Constant { key: "path", component: "", unit: "-", lens: slope, std: 1.0 });
    (departure > 0.0 && lost.is_finite()).then(|| Instead {
        key: "path".to_owned(),
        meaning: "angle of the path from the vertical at the first sample".to_owned(),
        declared: 0.0,
        estimate: departure.sqrt().atan().to_degrees(),
        unit: "deg".to_owned(),
        lost,
    })
}

/// An effect that does not act on the coefficients themselves.
fn by_effect(found: &TrackContest<'_>, parameter: usize, effect: &'static Effect) -> Option<Instead> {
    let mut h = held(found, parameter);
    let null = found.null(effect);
    let steps: Vec<f64> = null.parameters.iter().map(|p| p.step).collect();
    let mut moved = found.campaign.plant.clone();
    (effect.apply)(&mut moved, &steps);
    if moved.aero != found.campaign.plant.aero || h.effects.iter().any(|e| e.effect == effect) {
        return None;
    }
    h.effects.push(null);
    let k = h.effects.len() - 1;
    let (fit, lost) = refitted(found, parameter, &h);
    let i = fit.free.iter().find_map(|f| if let Free::Effect(e, i) = *f { (e == k).then_some(i) } else { None })?;
    let (p, estimate) = (&fit.hypothesis.effects[k].parameters[i], fit.hypothesis.effects[k].values[i]);
    Some(Instead {
        key: format!("{} {}", effect.family, p.name),
        meaning: format!("effect {}", effect.family),
        declared: 0.0,
        estimate,
        unit: p.unit.to_owned(),
        lost,
    })
}
