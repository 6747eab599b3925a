//! likelihood: effects against generic alternatives. In: the best set. Out: what stands beside time, height, angles, lines and random air.

use super::across::{Said, said_beside};
use super::polish::{declared_alone, polish};
use super::weigh::{GENERIC, SURE, Weighed, weigh, weigh_beside, with_set};
use super::{describe, less_random, score};
use crate::check::{Alternative, Lead, alternatives};
use crate::engine::{Engine, Fit};
use crate::model::{Id, Member, Model};
use crate::search::{Set, is_above, is_within, log_sum};
use windfall_model::{CATALOGUE, CHANNEL_NAMES, POSE, Shape};

/// Outcome of a contest between effects and generic alternatives.
#[derive(Clone, Debug)]
pub struct Contest {
    /// Families of the best set.
    pub families: Vec<&'static str>,
    /// Generic alternatives in it, with what each of them brings to it, strongest first.
    pub leads: Vec<Lead>,
    /// What the best single alternative brings beside the present members.
    pub strongest: f64,
    /// Log odds of all sets with a generic alternative over all without.
    pub odds: f64,
    /// What the best sets say of the numbers that every set has.
    pub(super) said: Vec<(Id, Vec<Said>)>,
}

/// Effects and generic alternatives weighed together at a fitted model.
pub(super) fn contest(engine: &Engine, model: &Model, alternatives: &[Alternative]) -> Option<Contest> {
    outcome(&weigh_beside(engine, model, alternatives)?, model, alternatives)
}

/// What came of weighing effects beside those alternatives at a model.
pub(super) fn outcome(w: &Weighed, model: &Model, alternatives: &[Alternative]) -> Option<Contest> {
    let best = w.sets.first()?;
    let is_generic = |u: usize| w.families[u].0 >= GENERIC;
    let mut leads: Vec<Lead> = best.units.iter().filter(|&&u| is_generic(u)).map(|&u| lead(w, best, u, alternatives)).collect();
    leads.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let families = best.units.iter().filter(|&&u| !is_generic(u)).map(|&u| CATALOGUE[w.families[u].0].family).collect();
    let present: Vec<usize> = (0..w.units.len()).filter(|&u| w.families[u].1.is_none() && !is_generic(u)).collect();
    let floor = if present.is_empty() { Some(0.0) } else { crate::search::weigh(&w.gram, &w.units, &present).map(|s| s.gain) };
    let strongest = (0..w.units.len())
        .filter(|&u| is_generic(u))
        .filter_map(|u| {
            let mut with = present.clone();
            with.push(u);
            Some(crate::search::weigh(&w.gram, &w.units, &with)?.gain - floor?)
        })
        .fold(f64::NEG_INFINITY, f64::max);
    Some(Contest { families, leads, strongest, odds: odds_of(w, &is_generic), said: said_beside(w, model) })
}

/// Log odds of the sets that have such a unit over those that have none.
fn odds_of(w: &Weighed, is_such: &impl Fn(usize) -> bool) -> f64 {
    let (with, without): (Vec<&Set>, Vec<&Set>) = w.sets.iter().partition(|s| s.units.iter().any(|&u| is_such(u)));
    let sum = |sets: &[&Set]| log_sum(&sets.iter().map(|s| s.gain).collect::<Vec<_>>());
    sum(&with) - sum(&without)
}

/// Rivals of a lead that are said.
const RIVALS: usize = 3;

/// A generic alternative of the best set as a lead, with those that may stand in its place.
fn lead(w: &Weighed, best: &Set, unit: usize, alternatives: &[Alternative]) -> Lead {
    let rest: Vec<usize> = best.units.iter().copied().filter(|&x| x != unit).collect();
    let without = crate::search::weigh(&w.gram, &w.units, &rest).map_or(0.0, |s| s.gain);
    let of = |set: &Set, u: usize| {
        let columns = set.columns.iter().zip(&set.estimates).filter(|(c, _)| w.units[u].columns.contains(c));
        alternatives[w.families[u].0 - GENERIC].lead(set.gain - without, columns.map(|(_, e)| *e).collect())
    };
    let others = (0..w.units.len()).filter(|u| w.families[*u].0 >= GENERIC && !best.units.contains(u));
    let in_its_place = others.filter_map(|u| {
        let mut members = rest.clone();
        members.push(u);
        members.sort_unstable();
        Some((u, crate::search::weigh(&w.gram, &w.units, &members)?))
    });
    let mut near: Vec<(usize, Set)> = in_its_place.filter(|(_, s)| is_within(s.gain, best.gain, SURE)).collect();
    near.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
    near.truncate(RIVALS);
    Lead { rivals: near.iter().map(|(u, s)| of(s, *u)).collect(), ..of(best, unit) }
}

/// The best set held against generic alternatives: members that those make needless are taken out, and the rest fitted again.
pub(super) fn against_alternatives(
    engine: &Engine,
    fit: Fit,
    weighed: Weighed,
    log: &mut Vec<String>,
) -> (Fit, Weighed, Option<Contest>) {
    let all = alternatives(engine);
    let Some(first) = contest(engine, &fit.model, &all) else { return (fit, weighed, None) };
    let keep = |m: &Member| m.declared || m.random || first.families.contains(&m.effect.family);
    if first.leads.is_empty() || fit.model.members.iter().all(keep) {
        return (fit, weighed, Some(first));
    }
    let mut model = fit.model.clone();
    model.members.retain(keep);
    log.push(format!("generic alternatives leave {}", describe(&model)));
    let fewer = engine.climb(&model, true, 6).ok().and_then(|f| Some((weigh(engine, &f.model)?, f)));
    let Some((w, f)) = fewer else { return (fit, weighed, Some(first)) };
    let Some(again) = contest(engine, &f.model, &all) else { return (f, w, Some(first)) };
    // Where they are gone, what was taken out is preferred again: both say as much, and the effect is the one with a cause.
    let families: Vec<&'static str> = fit.model.members.iter().filter(|m| !m.random).map(|m| m.effect.family).collect();
    if again.leads.is_empty() && families.iter().all(|family| again.families.contains(family)) {
        log.push("  which are preferred again without it".to_owned());
        let (strongest, odds) = (first.strongest, again.odds);
        return (fit, weighed, Some(Contest { families, leads: Vec::new(), strongest, odds, said: Vec::new() }));
    }
    (f, w, Some(again))
}

/// Gusts weaker than this share of the tunnel speed are no tunnel's: closed tunnels with many screens have 0.0005, a vertical one with
/// few some 0.005.
pub(super) const FAINT: f64 = 0.001;

/// Bandwidth below which a band is a line, as a share of its centre: it keeps its phase over several periods, which no turbulence does.
const NARROW: f64 = 0.2;

/// Frequency of gusts whose band is a line.
fn tone_hz(engine: &Engine, member: &Member, speed_m_s: f64) -> Option<f64> {
    let mut plant = engine.campaign.plant.clone();
    (member.effect.apply)(&mut plant, &member.values);
    let all = plant.disturbances(speed_m_s);
    let strongest = all.iter().max_by(|a, b| a.rms.total_cmp(&b.rms))?;
    line_hz(&strongest.shape)
}

/// Frequency of a spectrum that is a line.
fn line_hz(shape: &Shape) -> Option<f64> {
    match *shape {
        Shape::Band { centre_rad_s, bandwidth_rad_s } if bandwidth_rad_s < NARROW * centre_rad_s => {
            Some(centre_rad_s / std::f64::consts::TAU)
        }
        _ => None,
    }
}

/// Whether gusts of that size are fainter than any tunnel's.
fn is_faint(size_m_s: f64, speed_m_s: f64) -> bool {
    size_m_s < FAINT * speed_m_s
}

/// The same fit with turbulence in the place of gusts whose band is a line, where that is not surely less likely: of Dryden's form or of a broad
/// band, each from the lengths that are likeliest at the gusts' own size.
fn as_turbulence(engine: &Engine, fit: &Fit, gusts: usize, log: &mut Vec<String>) -> Option<Fit> {
    /// Most steps of scoring of sizes and shapes.
    const STEPS: usize = 8;
    let speed = engine.mean_speed_m_s();
    let own = &fit.model.members[gusts];
    tone_hz(engine, own, speed)?;
    let starts = Member::null(own.effect, &engine.campaign).forms().into_iter().filter_map(|form| {
        let mut model = fit.model.clone();
        model.members[gusts].values = form;
        own.strengths().for_each(|i| model.members[gusts].values[i] = own.values[i]);
        Some((engine.sum(&model, &[], &[]).ok()?.log_likelihood, model))
    });
    let starts: Vec<(f64, Model)> = starts.collect();
    let likeliest = |band: bool| {
        let of_kind = starts.iter().filter(|(_, model)| engine.has_band(model) == band);
        of_kind.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, model)| model)
    };
    let fits = [false, true].into_iter().filter_map(likeliest).filter_map(|model| {
        let near = engine.climb(model, false, 6).ok()?;
        let end = engine.settle_random(&near, STEPS);
        let end = engine.climb(&end.model, true, 8).unwrap_or(end);
        tone_hz(engine, &end.model.members[gusts], speed).is_none().then(|| (score(engine, &end), end))
    });
    let (there, end) = fits.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let here = score(engine, fit);
    log.push(format!("turbulence {there:.1} for a line {here:.1}: {}", describe(&end.model)));
    is_within(there, here, SURE).then_some(end)
}

/// A fit with all sets and all generic alternatives weighed at it.
fn anew(engine: &Engine, fit: Fit, all: &[Alternative]) -> Option<(Fit, Weighed, Option<Contest>)> {
    let (weighed, contest) = (weigh(engine, &fit.model)?, contest(engine, &fit.model, all));
    Some((fit, weighed, contest))
}

/// A fit without gusts beside the generic alternatives, and the score of both.
struct Still {
    there: f64,
    other: Contest,
    still: Fit,
}

/// Gusts held against generic alternatives without gusts: random air takes up any small and slow residual, whatever it varies with. What
/// the alternatives explain better is theirs; gusts that are fainter than a tunnel's are said to stand for something else.
pub(super) fn against_gusts(
    engine: &Engine,
    fit: Fit,
    weighed: Weighed,
    contest: Option<Contest>,
    log: &mut Vec<String>,
) -> (Fit, Weighed, Option<Contest>, Vec<Lead>) {
    const NEAR: f64 = 2.0;
    let speed = engine.mean_speed_m_s();
    let gusts = fit.model.members.iter().position(|m| m.random && !m.declared && engine.moves_air(m));
    let Some(gusts) = gusts else { return (fit, weighed, contest, Vec::new()) };
    let all = alternatives(engine);
    let broad = as_turbulence(engine, &fit, gusts, log).and_then(|fit| anew(engine, fit, &all));
    let (fit, weighed, contest) = broad.unwrap_or((fit, weighed, contest));
    let mut without = fit.model.clone();
    without.members.remove(gusts);
    let has_more = without.members.iter().any(|m| !m.declared && !m.random);
    // What was found in gusts may stand for what those left of an alternative: beside the declared model alone, too.
    let alone = has_more.then(|| declared_alone(engine, &Model::declared(&engine.campaign), &fit).ok()).flatten();
    let tries = [Some(without), alone.map(|f| f.model)].map(|model| {
        let still = engine.climb(&model?, true, 12).ok()?;
        let beside = weigh_beside(engine, &still.model, &all)?;
        let there = less_random(beside.total, &still.model, engine);
        Some(Still { there, other: outcome(&beside, &still.model, &all)?, still })
    });
    let Still { there, other, still } = match &tries {
        [Some(set), Some(alone)]
            if set.still.chi < NEAR && (alone.still.chi >= NEAR || is_above(set.there, alone.there, SURE)) =>
        {
            set
        }
        [_, Some(alone)] => alone,
        [Some(set), None] => set,
        [None, None] => return (fit, weighed, contest, Vec::new()),
    };
    let (there, here) = (*there, score(engine, &fit));
    log.push(format!("without gusts {there:.1} for {here:.1} (chi {:.2}), {:?}", still.chi, other.leads));
    if still.chi < NEAR
        && !other.leads.is_empty()
        && is_above(there, here, SURE)
        && let Some(weighed) = weigh(engine, &still.model)
    {
        let (still, weighed, contest) = against_alternatives(engine, still.clone(), weighed, log);
        return (still, weighed, contest, Vec::new());
    }
    // Better without gusts by what weighing promises: the fit decides.
    if still.chi < NEAR
        && is_above(there, here, SURE)
        && let Some(w) = weigh(engine, &still.model)
        && let Some((score, fit, weighed)) = polish(engine, with_set(&still.model, &w, w.choice(), engine), here, log)
        && score > here
    {
        let again = self::contest(engine, &fit.model, &all);
        return (fit, weighed, again, Vec::new());
    }
    let [Some(Still { other, still, .. }), _] = tries else { return (fit, weighed, contest, Vec::new()) };
    let Some(lead) = stand_in(engine, &fit, &still, gusts, speed) else { return (fit, weighed, contest, Vec::new()) };
    let leads = if lead.line_hz.is_some() || other.leads.is_empty() { vec![lead] } else { other.leads };
    (fit, weighed, contest, leads)
}

/// What gusts stand for that are no tunnel's: a tone, or fainter than any tunnel's air. `still` is the fit without them.
fn stand_in(engine: &Engine, fit: &Fit, still: &Fit, gusts: usize, speed_m_s: f64) -> Option<Lead> {
    let member = &fit.model.members[gusts];
    let size = member.strengths().map(|i| member.values[i]).fold(0.0, f64::max);
    let line_hz = tone_hz(engine, member, speed_m_s);
    let variable = match line_hz {
        Some(_) => "a line for which gusts of a narrow band stand, and no tunnel's turbulence is a tone,".to_owned(),
        None if is_faint(size, speed_m_s) => {
            format!("time at random, as gusts of {size:.1e} m/s would make it, fainter than any tunnel's")
        }
        None => return None,
    };
    let worst = (0..POSE).max_by(|a, b| still.channels[*a][2].total_cmp(&still.channels[*b][2])).unwrap_or(0);
    Some(Lead {
        channel: CHANNEL_NAMES[worst].to_owned(),
        variable,
        gain: fit.log_likelihood - still.log_likelihood,
        line_hz,
        ..Lead::default()
    })
}

/// Effects and generic alternatives beside the declared model while accelerations are left free, just as far as what it lacks needs: the filter
/// stays near the data, so that a load shows as it is, and not as what a stand-in makes of it.
struct Freed {
    contest: Contest,
    /// What the best set brings, and that over the best without alternatives.
    gain: f64,
    over: f64,
}

/// The least freedom of the accelerations at which the declared model leaves about as much as noise does; none where it leaves less or far more.
fn freed(engine: &Engine) -> Option<Freed> {
    let (mut free, fits) = in_free_accelerations(engine);
    let (slack, fit) = fits.into_iter().next_back().filter(|(_, fit)| ABOUT.contains(&fit.chi))?;
    free.slack = [slack; 6];
    let all = alternatives(engine);
    let w = weigh_beside(&free, &fit.model, &all)?;
    let gain = w.sets.first()?.gain;
    Some(Freed { contest: outcome(&w, &fit.model, &all)?, gain, over: over_effects(gain, &w) })
}

/// Mean squares that are about what noise leaves.
const ABOUT: std::ops::Range<f64> = 0.9..1.5;

/// Shares of the accelerations of free flight that are tried, each about a third of the one before.
pub(super) const FREEDOM: [f64; 8] = [1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003];

/// Fits of the declared model in accelerations that are left free by less and less, as long as they leave about as much as noise does, each with that
/// freedom; and the engine that they were made with.
pub(super) fn in_free_accelerations(engine: &Engine) -> (Engine, Vec<(f64, Fit)>) {
    // A parameter that is hardly seen there would walk off step by step, and what is held against alternatives is how it then fits.
    let mut free = engine.coarse();
    free.near_declared = true;
    // From what a check of the records has seen: no straight line leads from one clock to another that is seconds away.
    let mut model = Model::seen(&engine.campaign);
    let mut fits = Vec::new();
    for slack in FREEDOM {
        free.slack = [slack; 6];
        let Ok(fit) = free.climb(&model, false, 4) else { break };
        if fit.chi > ABOUT.end {
            break;
        }
        model.clone_from(&fit.model);
        fits.push((slack, fit));
    }
    (free, fits)
}

/// What a gain is over that of the best set without alternatives.
fn over_effects(gain: f64, w: &Weighed) -> f64 {
    let of_effects = w.sets.iter().find(|s| s.units.iter().all(|&u| w.families[u].0 < GENERIC));
    gain - of_effects.map_or(0.0, |s| s.gain)
}

/// Whether what a set brings over effects alone is plain beside all that it brings.
fn is_plain(over: f64, gain: f64) -> bool {
    /// Nats, and share of what the best set brings, from which effects are doubted that full fits have found.
    const PLAIN: [f64; 2] = [10.0, 0.05];
    over > PLAIN[0].max(PLAIN[1] * gain)
}

/// What was found held against what stands out in free accelerations: several effects may together stand for a form outside the catalogue, and
/// what is said to be unexplained beside stand-ins may be what those leave. Not in random air, which free accelerations take up: there, and where
/// nothing more stands out, only what is said of the declared numbers is from free accelerations, in which no stand-in moves them.
pub(super) fn against_free_accelerations(
    engine: &Engine,
    fit: &Fit,
    mut faint: Vec<Lead>,
    contest: Option<Contest>,
    log: &mut Vec<String>,
) -> (Option<Contest>, Vec<Lead>) {
    let stands_in = |m: &Member| !faint.is_empty() && !m.declared && engine.moves_air(m);
    let named: Vec<&str> = fit.model.members.iter().filter(|m| !m.declared && !m.random).map(|m| m.effect.family).collect();
    let is_random = fit.model.members.iter().any(|m| m.is_local() || m.random && !stands_in(m));
    let has_leads = contest.as_ref().is_some_and(|c| !c.leads.is_empty());
    let is_open = !faint.is_empty() || has_leads;
    if is_random && !has_leads || named.is_empty() && !is_open {
        return (contest, faint);
    }
    let Some(free) = freed(engine) else { return (contest, faint) };
    let stands_out = if is_open {
        free.over > SURE
    } else {
        is_plain(free.over, free.gain) && !named.iter().all(|f| free.contest.families.contains(f))
    };
    log.push(format!("in free accelerations {:.1}, {:.1} over effects alone: {:?}", free.gain, free.over, free.contest.leads));
    if is_random || !stands_out || free.contest.leads.is_empty() {
        return (contest.map(|c| Contest { said: free.contest.said, ..c }), faint);
    }
    faint.retain(|l| l.line_hz.is_some());
    let strongest = contest.as_ref().map_or(free.over, |c| c.strongest.max(free.over));
    (Some(Contest { families: contest.map_or_else(Vec::new, |c| c.families), strongest, ..free.contest }), faint)
}

#[cfg(test)]
mod tests;
