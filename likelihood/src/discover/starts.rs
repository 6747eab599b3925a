//! likelihood: where a search starts. In: a declared model. Out: fits in gusts from wide to narrow, in other random inputs, after a kick.

use super::polish::{climb_down, names};
use super::weigh::{SURE, Weighed, weigh, with_set};
use super::{LEFT, STARTS, describe, has, less_random_cost, sure_cost};
use crate::engine::{Engine, Fit};
use crate::model::{Id, Member, Model, catalogue};
use crate::search::{Set, is_above};
use crate::shock::{Shock, expected_beyond};
use windfall_model::Role;
use windfall_pid::SearchKind;

/// Sizes of a random input that are tried, as shares of the largest plausible (turbulence: 2 m/s).
pub(super) const LEVELS: [f64; 5] = [0.15, 0.06, 0.025, 0.01, 0.0035];

/// Smaller ones, that are tried while each makes the runs likelier than the one before: a model at rest that is unstable shows the faintest push.
const FAINTER: [f64; 5] = [1e-3, 3e-4, 1e-4, 3e-5, 1e-5];

/// Most steps of scoring of the gusts at the best start.
const SETTLING: usize = 8;

/// Where a search may start: a fit with random inputs, and the best set at it.
pub(super) struct Start {
    /// Log marginal likelihood of that set.
    pub(super) total: f64,
    pub(super) at: Model,
    pub(super) next: Model,
}

/// Starts with random inputs of every effect, sizes and forms, or none; best first, those that lead to the same set once.
pub(super) fn ladder(engine: &Engine, declared: &Model, log: &mut Vec<String>) -> Result<Vec<Start>, String> {
    // What leaves hardly more than noise has led to no wrong place: random inputs are tried beside what it ends at.
    let calm = |model: &Model| engine.climb(model, false, 12).ok().filter(|fit| fit.chi < LEFT);
    let mut free = Freed::new(declared);
    let fit = calm(declared).or_else(|| calm(&lead_in(engine, declared)?)).or_else(|| free.taken_away(engine, false, log));
    if let Some(start) = fit.and_then(|fit| start(engine, fit, log)) {
        return Ok(vec![start]);
    }
    let random: Vec<Member> = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random).collect();
    let mut fits: Vec<Fit> = Vec::new();
    let mut last = String::new();
    let air = random.iter().find(|m| engine.moves_air(m));
    let mut model = declared.clone();
    // Where gusts are declared they are in every set already.
    if let Some(air) = air.filter(|a| !has(declared, a)) {
        model = in_gusts(engine, declared, air, &mut fits, &mut last);
    }
    // No random input but the declared ones.
    match engine.climb(&model, false, 4) {
        Ok(fit) => fits.push(fit),
        Err(d) => last = d.words(&engine.campaign),
    }
    // Other random inputs, in every form.
    for other in random.iter().filter(|m| air.is_none_or(|a| a.effect.family != m.effect.family)) {
        let at_once = scanned(other).into_iter().filter_map(|form| {
            let mut with = model.clone();
            with.members.push(sized(other, 0.03, &form));
            engine.climb(&with, false, 0).ok()
        });
        let best = at_once.min_by(|a, b| b.total.total_cmp(&a.total));
        fits.extend(best.and_then(|fit| engine.climb(&fit.model, false, 3).ok()));
    }
    // A gust pushes and turns at once: beside shed vortices or a turned pose it does not keep the filter near the data, free accelerations do.
    if fits.iter().all(|fit| fit.chi > LEFT) {
        fits.extend(free.taken_away(engine, true, log));
    }
    // Gusts too weak for what the model lacks push its numbers far off, and sets weighed there promise what is not: the best fit's gusts are
    // given the size that they have beside it.
    fits.sort_by(|a, b| b.total.total_cmp(&a.total));
    fits.iter_mut().take(STARTS).filter(|fit| fit.chi > LEFT).for_each(|fit| *fit = settled(engine, declared, fit));
    let best = likeliest(fits.iter()).filter(|fit| fit.chi > LEFT);
    fits.extend(best.and_then(|fit| grown(engine, declared, fit, log)));
    // Poor fits are struck everywhere: only the best is asked.
    fits.extend(likeliest(fits.iter()).and_then(|fit| struck(engine, fit)));
    let likeliest_model = likeliest(fits.iter()).map(|fit| fit.model.clone());
    let mut all: Vec<Start> = fits.into_iter().filter_map(|fit| start(engine, fit, log)).collect();
    all.sort_by(|a, b| b.total.total_cmp(&a.total));
    let mut distinct: Vec<Start> = Vec::new();
    for one in all {
        if distinct.iter().all(|d| names(&d.next) != names(&one.next)) {
            distinct.push(one);
        }
    }
    match likeliest_model {
        _ if !distinct.is_empty() => Ok(distinct),
        Some(model) => Err(unweighed(engine, &model)),
        None => Err(last),
    }
}

/// Why no set can be weighed at a model, in words.
fn unweighed(engine: &Engine, model: &Model) -> String {
    let known = model.known(&engine.campaign);
    let sum = match engine.sum(model, &known, &[]) {
        Ok(sum) => sum,
        Err(d) => return d.words(&engine.campaign),
    };
    let name = |id: Id| match id {
        Id::Declared(i) => engine.campaign.plant.aero.structure.parameters.get(i).cloned(),
        Id::Constant(i) => engine.campaign.knowledge.constants.get(i).map(|c| c.key.to_owned()),
        _ => None,
    };
    let unseen: Vec<String> =
        known.iter().enumerate().filter(|(i, _)| sum.g[(*i, *i)] <= 0.0).filter_map(|(_, n)| name(n.id)).collect();
    if unseen.is_empty() {
        "no effect can be weighed beside the declared model".to_owned()
    } else {
        format!("no run depends on {}", unseen.join(", "))
    }
}

/// A fit with its random inputs settled. In inputs of another size the declared numbers may have wandered off: once more from where they are
/// declared, where that is likelier.
fn settled(engine: &Engine, declared: &Model, fit: &Fit) -> Fit {
    let fit = engine.settle_random(fit, SETTLING);
    if fit.chi < LEFT || engine.is_exhausted() {
        return fit;
    }
    match engine.climb(&from_declared(declared, &fit.model), false, 12) {
        Ok(again) => likeliest([fit, engine.settle_random(&again, SETTLING)].into_iter()).unwrap_or(again),
        Err(_) => fit,
    }
}

/// A model's members beside the numbers that are declared.
fn from_declared(declared: &Model, model: &Model) -> Model {
    Model { members: model.members.clone(), ..declared.clone() }
}

/// Fits in gusts from wide to narrow, each starting from the one before, in the likeliest form; the last model, its gusts taken out.
pub(super) fn in_gusts(engine: &Engine, declared: &Model, air: &Member, fits: &mut Vec<Fit>, last: &mut String) -> Model {
    let without = |mut model: Model| {
        model.members.retain(|m| m.effect.family != air.effect.family);
        model
    };
    let with = |model: &Model, level: f64, form: &[f64]| {
        let mut model = without(model.clone());
        model.members.push(sized(air, level, form));
        model
    };
    let forms = air.forms();
    let mut followed = declared.clone();
    for (k, level) in LEVELS.iter().enumerate() {
        let model = with(&followed, *level, &forms[forms.len() / 2]);
        let mut fit = engine.climb(&model, false, if k == 0 { 6 } else { 3 });
        if k == 0
            && let Some(led) = lead_in(engine, &model)
            && let Ok(other) = engine.climb(&led, false, 3)
            && fit.as_ref().map_or(true, |f| f.total < other.total)
        {
            fit = Ok(other);
        }
        match fit {
            Ok(fit) => {
                followed = fit.model.clone();
                // Very wide gusts only lead the parameters near.
                if k > 0 {
                    let others = forms.iter().filter_map(|form| engine.climb(&with(&fit.model, *level, form), false, 0).ok());
                    let best = likeliest(others);
                    fits.push(best.filter(|b| b.total > fit.total).unwrap_or(fit));
                }
            }
            Err(d) => *last = d.words(&engine.campaign),
        }
    }
    without(followed)
}

fn likeliest<F: std::borrow::Borrow<Fit>>(fits: impl Iterator<Item = F>) -> Option<F> {
    fits.max_by(|a, b| a.borrow().total.total_cmp(&b.borrow().total))
}

/// A fit with the effects that bring most, one at a time, until no more than noise is left: far from the runs, columns promise strengths several times too
/// large, and several effects at once what one of them brings. None where no effect brings anything.
fn grown(engine: &Engine, declared: &Model, fit: &Fit, log: &mut Vec<String>) -> Option<Fit> {
    /// Effects at most, and those that are tried each time.
    const MOST: usize = 4;
    const TRIED: usize = 3;
    let mut grown: Option<Fit> = None;
    for _ in 0..MOST {
        let here = grown.as_ref().unwrap_or(fit);
        if here.chi < LEFT || engine.is_exhausted() {
            break;
        }
        let w = weigh(engine, &here.model)?;
        let fits = one_larger(&w, &here.model).take(TRIED).filter_map(|set| {
            let fit = climb_down(engine, &with_set(&here.model, &w, set, engine))?;
            Some(engine.settle_random(&fit, SETTLING))
        });
        let Some(best) = likeliest(fits).filter(|best| is_above(best.total, here.total, SURE)) else { break };
        log.push(format!("  grown ({:.0}): {:.1} chi {:.3} {}", engine.passes(), best.total, best.chi, describe(&best.model)));
        grown = Some(best);
    }
    grown.map(|fit| in_calm(engine, declared, fit))
}

/// Sets of one effect more than a model has, best first.
fn one_larger<'a>(w: &'a Weighed, model: &Model) -> impl Iterator<Item = &'a Set> {
    let size = 1 + model.found().len();
    w.sets.iter().filter(move |set| set.units.len() == size)
}

/// A fit without the random inputs that only led to it, where that is likelier: in them declared numbers wander off, and sets weighed there make
/// good for that. From where numbers are declared, led in by free accelerations as the declared model alone is.
fn in_calm(engine: &Engine, declared: &Model, fit: Fit) -> Fit {
    let calm = from_declared(declared, &fit.model).calm();
    let is_likelier = |calm: &Fit| calm.total > less_random_cost(fit.total, &fit.model, engine);
    let led = lead_in(engine, &calm).and_then(|model| climb_down(engine, &model));
    led.filter(is_likelier).unwrap_or(fit)
}

/// Parameters found while accelerations are left free, less and less: from far starting values no gust leads a model's roll.
pub(super) fn lead_in(engine: &Engine, model: &Model) -> Option<Model> {
    const FREEDOM: [f64; 3] = [1.0, 0.2, 0.04];
    let mut free = engine.clone();
    let mut model = model.clone();
    for (slack, steps) in FREEDOM.into_iter().zip([4, 3, 3]) {
        free.slack = [slack; 6];
        model = free.climb(&model, false, steps).ok()?.model;
    }
    Some(model)
}

/// A set that is found while accelerations are left free, less and less: in gusts of any size strong effects together lead a model astray.
struct Freed {
    model: Model,
    /// What is left to take away.
    levels: &'static [f64],
}

impl Freed {
    fn new(declared: &Model) -> Self {
        Self { model: declared.clone(), levels: &[1.0, 0.3, 0.1, 0.03, 0.01] }
    }

    /// The fit of that set; random inputs come in where asked for and more than noise is left. No fit where more is left with them too, or the
    /// model departs once accelerations are free no more: it goes on from there when called again.
    fn taken_away(&mut self, engine: &Engine, random: bool, log: &mut Vec<String>) -> Option<Fit> {
        let mut free = engine.clone();
        while let [slack, rest @ ..] = self.levels {
            free.slack = [*slack; 6];
            // With accelerations free a model that is right leaves less than noise.
            let fit = to_noise(&free, free.climb(&self.model, false, 4).ok()?, random)?;
            let w = weigh(&free, &fit.model)?;
            self.model = with_set(&fit.model, &w, w.choice(), &free);
            log.push(format!("  freed {slack} ({:.0}): chi {:.3} -> {}", engine.passes(), fit.chi, describe(&self.model)));
            self.levels = rest;
        }
        let fit = engine.climb(&climb_down(engine, &self.model)?.model, true, 8).ok()?;
        // Free accelerations had taken a part of the gusts.
        to_noise(engine, engine.settle_random(&fit, 3), random)
    }
}

/// A fit that leaves no more than noise, with random inputs beside it where they may be; none where it cannot be had.
fn to_noise(engine: &Engine, fit: Fit, random: bool) -> Option<Fit> {
    let mut fit = fit;
    let most = if random { catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random).count() } else { 0 };
    for _ in 0..most {
        if fit.chi < LEFT || engine.is_exhausted() {
            break;
        }
        fit = engine.settle_random(&with_random(engine, &fit)?, 3);
    }
    (fit.chi < LEFT).then_some(fit)
}

/// Forms of a random input that are scanned: every value of its first shape, the middle ones of the others.
pub(super) fn scanned(m: &Member) -> Vec<Vec<f64>> {
    if m.parameters.iter().any(|p| p.role == Role::AeroPlace) {
        return m.forms();
    }
    let shapes: Vec<(usize, &[f64])> = m
        .parameters
        .iter()
        .enumerate()
        .filter_map(|(i, p)| if let Role::Shape(t) = p.role { Some((i, t)) } else { None })
        .collect();
    let Some((first, tried)) = shapes.first() else { return vec![m.values.clone()] };
    tried
        .iter()
        .map(|v| {
            let mut form = m.values.clone();
            shapes.iter().for_each(|(i, t)| form[*i] = t[t.len() / 2]);
            form[*first] = *v;
            form
        })
        .collect()
}

/// A random member with all strengths at a share of their largest.
pub(super) fn sized(null: &Member, level: f64, form: &[f64]) -> Member {
    let mut m = Member { values: form.to_vec(), ..null.clone() };
    let strengths: Vec<usize> = m.strengths().collect();
    for i in strengths {
        m.values[i] = level * m.parameters[i].high;
    }
    m
}

/// A fit as a start: all sets weighed at it.
pub(super) fn start(engine: &Engine, fit: Fit, log: &mut Vec<String>) -> Option<Start> {
    let w = weigh(engine, &fit.model)?;
    let total = less_random_cost(w.total, &fit.model, engine);
    let next = with_set(&fit.model, &w, w.choice(), engine);
    log.push(format!(
        "  level ({:.0}) {}: {total:.1} chi {:.3} {} -> {}",
        engine.passes(),
        describe(&fit.model),
        fit.chi,
        fit.stop.words(SearchKind::Likelihood),
        describe(&next)
    ));
    Some(Start { total, at: fit.model, next })
}

/// Size of the last member as a share of the largest plausible.
fn size_of(model: &Model) -> f64 {
    model.members.last().map_or(0.0, |m| m.strengths().map(|i| m.values[i] / m.parameters[i].high).fold(0.0, f64::max))
}

/// Whether an input takes off what is next to nothing.
fn brings_nothing(there: f64, here: f64) -> bool {
    const NONE: f64 = 0.1;
    (here - NONE..=here).contains(&there)
}

/// A fit with one more random input, in the form and at the size of those tried that is likeliest; none where no such brings anything.
pub(super) fn with_random(engine: &Engine, fit: &Fit) -> Option<Fit> {
    /// Nats that are worth a fit: what is found must bring several times as many.
    const WORTH: f64 = 1.0;
    let coarse = engine.coarse();
    let likelihood = |model: &Model| coarse.sum(model, &[], &[]).map_or(f64::NEG_INFINITY, |s| s.log_likelihood);
    let here = likelihood(&fit.model);
    let absent = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random && !has(&fit.model, m));
    let absent: Vec<Member> = absent.collect();
    // Of one form, down from the first size as long as each is likelier.
    let best_size = |null: &Member, form: &[f64], sizes: &[f64]| {
        let mut best = (f64::NEG_INFINITY, fit.model.clone());
        for level in sizes {
            let mut model = fit.model.clone();
            model.members.push(sized(null, *level, form));
            let there = likelihood(&model);
            if there < best.0 {
                break;
            }
            best = (there, model);
            // What takes so little at that size brings nothing at a smaller one.
            if brings_nothing(there, here) {
                break;
            }
        }
        best
    };
    let best_of = |is_asked: &dyn Fn(&Member) -> bool, sizes: &[f64]| {
        let asked = absent.iter().filter(|null| is_asked(null)).flat_map(|null| {
            let forms = if engine.moves_air(null) { null.forms() } else { scanned(null) };
            forms.into_iter().map(move |form| (null, form))
        });
        asked.map(|(null, form)| best_size(null, &form, sizes)).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut best = best_of(&|_| true, &LEVELS[2..])?;
    // Of other inputs those of any size; gusts fainter than any tunnel's only where such are likelier, or nothing else brings anything.
    if let Some(faint) = best_of(&|m| !engine.moves_air(m), &FAINTER).filter(|faint| faint.0 > best.0) {
        best = faint;
    }
    if !is_above(best.0, here, WORTH) || size_of(&best.1) < LEVELS[4] {
        let faint = best_of(&|m| engine.moves_air(m), &FAINTER).filter(|faint| faint.0 > best.0);
        best = faint.unwrap_or(best);
    }
    let (_, model) = Some(best).filter(|best| is_above(best.0, here, WORTH))?;
    engine.climb(&model, false, 3).ok()
}

/// A model struck at the instant at which a kick explains most, in the likeliest duration; none where that would not be sure, or where random
/// air kicks as hard by itself: in bursts its instants have a longer tail than a Gaussian's.
pub(super) fn struck(engine: &Engine, fit: &Fit) -> Option<Fit> {
    let null = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).find(|m| m.is_local() && !has(&fit.model, m))?;
    let all = engine.shocks(&fit.model).into_iter().flat_map(|(run, all)| all.into_iter().map(move |shock| (run, shock)));
    let (run, shock) = all.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
    if shock.gain < sure_cost(&null, engine) {
        return None;
    }
    let place = |role: Role| null.parameters.iter().position(|p| p.role == role);
    let (of_run, of_instant) = (place(Role::Run)?, place(Role::Instant)?);
    let of_duration = null.parameters.iter().position(|p| matches!(p.role, Role::Shape(_)))?;
    let tries = null.forms().into_iter().flat_map(|form| {
        // The kick may be the pulse's start, middle or end.
        [0.0, 0.5, 1.0].map(|share| {
            let mut values = form.clone();
            values[of_run] = run as f64;
            values[of_instant] = start_s(shock.t_s, share, form[of_duration]);
            Member { values, ..null.clone() }
        })
    });
    let fits = tries.filter_map(|member| {
        let mut model = fit.model.clone();
        model.members.push(member);
        engine.climb(&model, false, 2).ok()
    });
    let best = likeliest(fits)?;
    let best = engine.climb(&best.model, true, 4).ok()?;
    if best.model.members.iter().any(|m| m.random) {
        // In a model without random air what strikes is felt at all later instants; there are no others to compare with.
        let others: Vec<Shock> = engine.shocks(&best.model).into_iter().flat_map(|(_, all)| all).collect();
        if is_of_the_tail([fit.total, best.total], &others) {
            return None;
        }
    }
    is_above(best.total, fit.total, sure_cost(&null, engine)).then_some(best)
}

/// Start of a pulse of which that share is over at an instant; before the run's where it was under way then.
fn start_s(instant_s: f64, share: f64, duration_s: f64) -> f64 {
    instant_s - share * duration_s
}

/// Whether kicks that bring as much as one does, from without it to with it, are not surely absent from the tail of all others.
fn is_of_the_tail([without, with]: [f64; 2], others: &[Shock]) -> bool {
    expected_beyond(with - without, others) > (-SURE).exp()
}

#[cfg(test)]
mod tests;
