//! likelihood: a set fitted in full and weighed again until it stays. In: a start. Out: the fit and all sets at it.

use super::weigh::{SURE, Weighed, weigh, with_set};
use super::{describe, more, score};
use crate::engine::{Engine, Fit};
use crate::model::{Member, Model};
use crate::search::{is_above, is_behind, is_within};
use windfall_model::Role;
use windfall_pid::{SearchKind, StopReason};

/// Rounds of fitting and weighing again.
pub(super) const ROUNDS: usize = 6;

/// Most steps of scoring of random members, and of the first that tell whether they are idle.
const STEPS: usize = 12;
const FEW: usize = 4;
/// Nats by which a form that is behind after those is given up.
const FAR_BEHIND: f64 = 15.0;
/// Mean square of whitened innovations within which a climb is worth going on with.
const NEAR: f64 = 3.0;

/// A search this far below another's end after two rounds is given up.
pub(super) const HOPELESS: f64 = 500.0;

/// A set fitted in full: its score, its fit, and all sets weighed there.
pub(super) type Scored = (f64, Fit, Weighed);

/// Fits a set in full and weighs all sets again, until the set stays.
pub(super) fn polish(engine: &Engine, model: Model, floor: f64, log: &mut Vec<String>) -> Option<Scored> {
    polished(engine, model, floor, true, log)
}

/// The same; where random members' forms are known, they are kept.
pub(super) fn polished(engine: &Engine, mut model: Model, floor: f64, forms: bool, log: &mut Vec<String>) -> Option<Scored> {
    let mut seen: Vec<(String, f64, Fit)> = Vec::new();
    for round in 1..=ROUNDS {
        let fit = fitted(engine, &model, forms && round == 1)?;
        let w = weigh(engine, &fit.model)?;
        let here = score(engine, &fit);
        let key = names(&fit.model);
        let again = with_set(&fit.model, &w, w.choice(), engine);
        let (a, b) = (names(&again), key.clone());
        log.push(format!(
            "  round {round} ({:.0}): {here:.1} chi {:.3} {} | {} -> {a}",
            engine.passes(),
            fit.chi,
            fit.stop.words(SearchKind::Likelihood),
            describe(&fit.model)
        ));
        if round > 1 && is_behind(here, floor, HOPELESS) {
            return None;
        }
        let stays = a == b && same_forms(&again, &fit.model) || seen.iter().any(|(k, ..)| *k == a && a != b);
        seen.push((key, here, fit));
        if stays || round == ROUNDS || engine.is_exhausted() {
            // Of the sets that were visited in a circle, the best.
            let (_, here, best) = seen.into_iter().max_by(|x, y| x.1.total_cmp(&y.1))?;
            return without_promises(engine, here, best, log);
        }
        model = again;
    }
    None
}

/// A fit without members that weighing only promised, and all sets without them weighed there: columns are of where the fit stands, with its
/// shapes, and leave out that in gusts a number also changes how uncertain a prediction is; they may promise a gain that no fit finds.
fn without_promises(engine: &Engine, mut here: f64, mut fit: Fit, log: &mut Vec<String>) -> Option<Scored> {
    let mut empty: Vec<&'static str> = Vec::new();
    for k in (0..fit.model.members.len()).rev() {
        let m = &fit.model.members[k];
        if m.random || m.declared || m.is_local() {
            continue;
        }
        let family = m.effect.family;
        let mut without = fit.model.clone();
        without.members.remove(k);
        let Ok(mut less) = engine.climb(&without, true, 8) else { continue };
        let mut there = score(engine, &less);
        if !is_within(there, here, SURE) && is_within(there, here, HOPELESS) {
            // Gusts of the size that goes with the effect are not those without it.
            less = engine.settle_random(&less, FEW);
            there = score(engine, &less);
        }
        if is_within(there, here, SURE) {
            log.push(format!("  {family} brings {}", more(here, there)));
            (here, fit) = (there, less);
            empty.push(family);
        }
    }
    let mut weighed = weigh(engine, &fit.model)?;
    weighed.leave_out(&empty);
    Some((here, fit, weighed))
}

/// A set at its likeliest, without random members that bring less than they cost; those in the likelier of their forms where these are open.
fn fitted(engine: &Engine, model: &Model, open: bool) -> Option<Fit> {
    let mut fit = climb_down(engine, model)?;
    if !crate::random_fit::random_numbers(&fit.model).is_empty() {
        // Shapes first: what a set's members leave is no gust.
        fit = engine.climb(&fit.model, true, 10).unwrap_or(fit);
        fit = without_idle(engine, engine.settle_random(&fit, if open { FEW } else { STEPS }));
        if open {
            fit = without_idle(engine, in_likelier_form(engine, engine.settle_random(&fit, STEPS)));
        }
    }
    engine.climb(&fit.model.at_trim(&engine.campaign), true, 10).ok()
}

pub(super) fn names(model: &Model) -> String {
    let mut all: Vec<&str> = model.members.iter().map(|m| m.effect.family).collect();
    all.sort_unstable();
    all.join("+")
}

pub(super) fn same_forms(a: &Model, b: &Model) -> bool {
    a.members.iter().all(|m| {
        let other = b.members.iter().find(|o| o.effect.family == m.effect.family);
        other.is_some_and(|o| {
            m.parameters.iter().enumerate().all(|(i, p)| {
                p.role == Role::Strength || m.random || (m.values[i] - o.values[i]).abs() <= 0.3 * o.values[i].abs()
            })
        })
    })
}

/// A climb from a set's quadratic estimates; from three tenths of them, and of those again, where the model departs there.
pub(super) fn climb_down(engine: &Engine, model: &Model) -> Option<Fit> {
    let mut model = model.clone();
    for _ in 0..3 {
        if let Ok(fit) = engine.climb(&model, false, 12) {
            return Some(fit);
        }
        model.members.iter_mut().filter(|m| !m.random).for_each(weaken);
    }
    None
}

/// All strengths at three tenths.
fn weaken(m: &mut Member) {
    let strengths: Vec<usize> = m.strengths().collect();
    strengths.iter().for_each(|&i| m.values[i] *= 0.3);
}

/// The same with random members in the other of their forms, those that a shape of zero parts (gusts of Dryden's form or of a band), where
/// that is likelier: at its best scale of those tried, then settled.
fn in_likelier_form(engine: &Engine, fit: Fit) -> Fit {
    let mut best = fit;
    for k in (0..best.model.members.len()).filter(|&k| best.model.members[k].random).collect::<Vec<_>>() {
        let member = best.model.members[k].clone();
        let Some(place) = member.parameters.iter().position(windfall_model::Parameter::parts_forms) else { continue };
        let others = member.forms().into_iter().filter(|form| (form[place] > 0.0) != (member.values[place] > 0.0));
        let tries = others.filter_map(|form| {
            let mut model = best.model.clone();
            model.members[k].values = form;
            engine.climb(&model, false, 0).ok()
        });
        let Some(other) = tries.max_by(|a, b| a.total.total_cmp(&b.total)) else { continue };
        let other = engine.settle_random(&other, FEW);
        if is_behind(other.total, best.total, FAR_BEHIND) {
            continue;
        }
        let other = engine.settle_random(&other, STEPS);
        if other.total > best.total {
            best = other;
        }
    }
    best
}

/// The best set with members in others of their forms, those that no climb leads to (a switch, a harmonic), where that is likelier: a
/// strong effect in the wrong form is far from where its columns say what another form would bring.
pub(super) fn in_other_forms(engine: &Engine, mut best: Scored, log: &mut Vec<String>) -> Scored {
    /// Nats that tell two forms apart at all.
    const DIFFERENT: f64 = 0.1;
    for k in 0..best.1.model.members.len() {
        let Some(member) = best.1.model.members.get(k).filter(|m| !m.random && !m.declared) else { continue };
        let others = member.other_forms();
        let model = best.1.model.clone();
        let fits = others.into_iter().filter_map(|values| {
            let mut other = model.clone();
            other.members[k].values = values;
            let fit = engine.climb(&other, true, 8).ok()?;
            // What stood in for the right form may be needless in it.
            let w = weigh(engine, &fit.model)?;
            let again = with_set(&fit.model, &w, w.choice(), engine);
            let less = engine.climb(&again, true, 8).ok();
            [Some(fit), less].into_iter().flatten().map(|f| (score(engine, &f), f)).max_by(|a, b| a.0.total_cmp(&b.0))
        });
        let Some((there, fit)) = fits.max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        if is_above(there, best.0, DIFFERENT) {
            log.push(format!("in another form {there:.1}: {}", describe(&fit.model)));
            if let Some(other) = polish(engine, fit.model, best.0, log).filter(|other| other.0 > best.0) {
                best = other;
            }
        }
    }
    best
}

/// The best set, or one of its effects alone where that is likelier: what several promise far from the runs one may bring by itself, along a
/// ridge on which no step without one of them ends.
pub(super) fn alone(engine: &Engine, best: Scored, log: &mut Vec<String>) -> Scored {
    /// Effects from which on.
    const SEVERAL: usize = 3;
    let model = &best.1.model;
    let is_open = |m: &Member| !m.declared && !m.random && !m.is_local();
    let effects: Vec<usize> = (0..model.members.len()).filter(|&k| is_open(&model.members[k])).collect();
    if effects.len() < SEVERAL || engine.is_exhausted() {
        return best;
    }
    let fits = effects.into_iter().filter_map(|k| {
        let mut one = model.clone();
        one.members = model.members.iter().enumerate().filter(|(i, m)| m.declared || *i == k).map(|(_, m)| m.clone()).collect();
        let near = engine.climb(&one, true, 8).ok().filter(|fit| fit.chi < NEAR)?;
        let fit = engine.climb(&near.model, true, 30).ok()?;
        Some((score(engine, &fit), fit))
    });
    match fits.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((there, fit)) if there > best.0 => {
            log.push(format!("alone {there:.1} ({:.0}): {}", engine.passes(), describe(&fit.model)));
            polish(engine, fit.model, best.0, log).filter(|other| other.0 > best.0).unwrap_or(best)
        }
        _ => best,
    }
}

/// Random members that bring less than they cost are taken out.
pub(super) fn without_idle(engine: &Engine, fit: Fit) -> Fit {
    let mut fit = fit;
    for k in (0..fit.model.members.len()).rev() {
        if !fit.model.members[k].random || fit.model.members[k].declared {
            continue;
        }
        let mut without = fit.model.clone();
        without.members.remove(k);
        let less = engine.climb(&without, false, 4);
        // From far away, but not lost: to the end.
        let less = less.and_then(|f| {
            if f.stop == StopReason::Iterations && f.chi < NEAR { engine.climb(&f.model, false, 12) } else { Ok(f) }
        });
        if let Ok(less) = less
            && is_within(score(engine, &less), score(engine, &fit), SURE)
        {
            fit = less;
        }
    }
    fit
}

/// The declared model alone, in the noise that was found. Where it leaves far more than noise, its parameters are those found with
/// accelerations left free by what it lacks: the likelihood's own would bend the model to the runs until it flies no other.
pub(super) fn declared_alone(engine: &Engine, declared: &Model, after: &Fit) -> Result<Fit, String> {
    const FAR_MORE: f64 = 2.0;
    const FREEDOM: [f64; 3] = [0.04, 0.2, 1.0];
    let mut model = declared.clone();
    model.declared.clone_from(&after.model.declared);
    let tries = [model, declared.clone()];
    let mut end = Err(String::new());
    for m in &tries {
        end = engine.climb(m, false, 12).map_err(|d| format!("with these parameters {}", d.words(&engine.campaign)));
        if end.is_ok() {
            break;
        }
    }
    if end.as_ref().is_ok_and(|f| f.chi < FAR_MORE) {
        return end;
    }
    let mut free = engine.coarse();
    for slack in FREEDOM {
        free.slack = [slack; 6];
        if let Some(fit) = tries.iter().find_map(|m| free.climb(m, false, 10).ok())
            && fit.chi < FAR_MORE
            && let Ok(fit) = engine.climb(&fit.model, false, 0)
        {
            return Ok(fit);
        }
    }
    end
}

#[cfg(test)]
mod tests;
