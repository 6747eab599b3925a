//! likelihood: a set fitted in full and weighed again until it stays. In: a start. Out: the fit and all sets at it.

use super::weigh::{SURE, Weighed, weigh, with_set};
use super::{cost, cost_of, describe};
use crate::engine::{Engine, Fit};
use crate::model::Model;
use windfall_model::Role;

/// Rounds of fitting and weighing again.
pub(super) const ROUNDS: usize = 6;

/// A search this far below another's end after two rounds is given up.
pub(super) const HOPELESS: f64 = 500.0;

/// Fits a set in full and weighs all sets again, until the set stays.
pub(super) fn polish(engine: &Engine, mut model: Model, floor: f64, log: &mut Vec<String>) -> Option<(Fit, Weighed)> {
    let mut seen: Vec<(String, Fit)> = Vec::new();
    for round in 0..ROUNDS {
        let mut fit = climb_down(engine, &model)?;
        if !crate::random_fit::random_numbers(&fit.model).is_empty() {
            fit = settled(engine, fit);
            if round == 0 {
                fit = in_likelier_form(engine, fit);
            }
            fit = without_idle(engine, fit);
        }
        fit = engine.climb(&fit.model, true, 10).ok()?;
        let w = weigh(engine, &fit.model)?;
        let key = names(&fit.model);
        let again = with_set(&fit.model, &w, w.choice(), engine);
        let (a, b) = (names(&again), key.clone());
        log.push(format!(
            "  round {round}: {:.1} chi {:.3} {} | {} -> {a}",
            fit.total - cost_of(&fit.model, engine),
            fit.chi,
            fit.stop.words(),
            describe(&fit.model)
        ));
        if round >= 1 && fit.total < floor - HOPELESS {
            return None;
        }
        let stays = a == b && same_forms(&again, &fit.model) || seen.iter().any(|(k, _)| *k == a && a != b);
        seen.push((key, fit.clone()));
        if stays || round + 1 == ROUNDS || engine.is_exhausted() {
            // Of the sets that were visited in a circle, the best.
            let (_, best) = seen
                .into_iter()
                .max_by(|x, y| (x.1.total - cost_of(&x.1.model, engine)).total_cmp(&(y.1.total - cost_of(&y.1.model, engine))))?;
            let w = weigh(engine, &best.model)?;
            return Some((best, w));
        }
        model = again;
    }
    None
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

/// A climb from a set's quadratic estimates; from half of them, and from null, where the model departs there.
pub(super) fn climb_down(engine: &Engine, model: &Model) -> Option<Fit> {
    let mut model = model.clone();
    for _ in 0..3 {
        if let Ok(fit) = engine.climb(&model, false, 12) {
            return Some(fit);
        }
        for m in model.members.iter_mut().filter(|m| !m.random) {
            let strengths: Vec<usize> = m.strengths().collect();
            strengths.iter().for_each(|&i| m.values[i] *= 0.3);
        }
    }
    None
}

/// Random members and what they act beside by turns, until neither gains.
fn settled(engine: &Engine, mut fit: Fit) -> Fit {
    /// Turns, steps of scoring in one, and gain that is worth another.
    const TURNS: usize = 5;
    const STEPS: usize = 8;
    const WORTH: f64 = 0.3;
    for _ in 0..TURNS {
        let next = engine.settle_random(&fit, STEPS);
        let gained = next.total - fit.total;
        fit = next;
        if gained < WORTH {
            break;
        }
    }
    fit
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
        let other = settled(engine, other);
        if other.total > best.total {
            best = other;
        }
    }
    best
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
        if let Ok(less) = engine.climb(&without, false, 4)
            && less.total > fit.total - cost(&fit.model.members[k], engine) - SURE
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
        end = engine
            .climb(m, false, 12)
            .map_err(|d| format!("with these parameters the model departs at {:.2} s of run {}", d.t_s, d.run + 1));
        if end.is_ok() {
            break;
        }
    }
    if end.as_ref().is_ok_and(|f| f.chi < FAR_MORE) {
        return end;
    }
    let mut free = engine.coarse();
    for slack in FREEDOM {
        free.slack = slack;
        if let Some(fit) = tries.iter().find_map(|m| free.climb(m, false, 10).ok())
            && fit.chi < FAR_MORE
            && let Ok(fit) = engine.climb(&fit.model, false, 0)
        {
            return Ok(fit);
        }
    }
    end
}
