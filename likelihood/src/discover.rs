//! likelihood: what a declared model lacks. In: a campaign. Out: the set of effects that its runs speak for, with rivals and probabilities.
//!
//! Start in wide gusts, where the filter cannot lose the data, and narrow them; at every level all sets are weighed. The best are fitted
//! in full, random inputs searched together with the set, and all sets weighed again at the new point until the set stays.

use crate::check::{Lead, lines, outliers};
use crate::engine::{Engine, Fit};
use crate::gram::Gram;
use crate::model::{Id, Member, Model, catalogue};
use crate::random_range::RandomRange;
use crate::search::{Unit, is_above, is_behind, is_within, log_sum, of_any_size};
use nalgebra::{DMatrix, DVector};
use windfall_model::{POSE, Use};

mod across;
mod contest;
mod open;
mod polish;
mod refit;
mod rivals;
mod starts;
mod told;
mod weigh;

use across::{across_sets, beside_what_is_missing};
pub use contest::Contest;
use contest::{against_alternatives, against_free_accelerations, against_gusts};
pub use open::beside_something_else;
use polish::{Scored, alone, climb_down, declared_alone, in_other_forms, names, polish, polished};
use refit::rivals_fitted;
pub use rivals::{RivalPair, Rivals, Unseen, log_odds};
use starts::{LEVELS, Start, ladder, lead_in, sized, struck, with_random};
use told::told_from_none;
pub use weigh::{FamilySet, SOMETHING_ELSE};
use weigh::{SURE, Weighed, named};

/// Starts that are followed to the end.
const STARTS: usize = 2;

/// A start this far below the best, in nats, is not followed, unless the best left more than this mean square of what noise leaves.
const FAR: f64 = 60.0;

/// Mean square of whitened innovations, as a multiple of what noise leaves, below which a fit has hardly anything left.
const LEFT: f64 = 1.1;

/// A search's outcome.
#[derive(Clone, Debug)]
pub struct Discovery {
    /// Fit of the declared model alone; none where it departs.
    pub before: Option<Fit>,
    /// Why there is none.
    pub before_fault: Result<(), String>,
    /// That no set of effects stays near the runs, in words, and where the declared model departs: `after` has accelerations left free then.
    pub departs: Option<String>,
    /// Fit of the best set.
    pub after: Fit,
    /// Sets weighed at the end, best first.
    pub sets: Vec<FamilySet>,
    /// Everything weighed at the end.
    pub gram: Gram,
    /// Units of it.
    pub units: Vec<Unit>,
    /// Family of each unit, and its form's index (none for a member's own).
    pub families: Vec<(usize, Option<usize>)>,
    /// What generic alternatives say beside the effects.
    pub contest: Option<Contest>,
    /// What gusts weaker than any tunnel's, or of a band as narrow as a tone, may stand for.
    pub faint: Vec<Lead>,
    /// Families of those gusts: in the fit, where they make up for what they stand for, but no effect that was found.
    pub stand_ins: Vec<&'static str>,
    /// Gain of log marginal likelihood of each random member, by its place.
    pub random_gains: Vec<(usize, f64)>,
    /// What is known of the random members' numbers.
    pub random_ranges: Vec<RandomRange>,
    /// Upper 95 % bounds of random strengths that were not found: family, parameter, bound, unit.
    pub random_bounds: Vec<(&'static str, String, f64, String)>,
    /// Lines in the spectra of the innovations.
    pub lines: Vec<Lead>,
    /// Passes over the runs at which the search ended, where those are all that it may do.
    pub unfinished_passes: Option<f64>,
    /// Whether the errors of `after` carry what the leads may have moved its numbers by.
    pub errors_carry_missing: bool,
    /// Innovations of each channel of the pose beyond five standard deviations.
    pub outliers: [usize; POSE],
    /// What was done, for those who look beneath.
    pub log: Vec<String>,
}

impl Discovery {
    /// The sets weighed at the end, with something else as a set of its own where generic alternatives were weighed beside them.
    #[must_use]
    pub fn sets_and_something_else(&self) -> Vec<FamilySet> {
        and_something_else(&self.sets, self.contest.as_ref().map(|c| c.odds))
    }
}

/// Sets, best first, with something else among them at those log odds over all of them.
fn and_something_else(sets: &[FamilySet], odds: Option<f64>) -> Vec<FamilySet> {
    let all = log_sum(&sets.iter().map(|s| s.gain).collect::<Vec<_>>());
    let other = odds.map(|odds| FamilySet { families: vec![SOMETHING_ELSE], gain: all + odds, fit: f64::NEG_INFINITY });
    let mut sets: Vec<FamilySet> = sets.iter().cloned().chain(other).collect();
    sets.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    sets
}

/// Nats by which runs that were not identified on are less likely with effects than without, from which they contradict them: of some 160 campaigns of
/// another simulator with names two lost any, both named wrong: a trim that scatters, and a wrong harmonic.
pub const CONTRADICTED: f64 = 10.0;
/// Log predictive density of runs that a fit cannot fly.
pub const UNFLOWN: f64 = -1e6;

/// Odds against one family, beforehand: one of all families in a third of the campaigns. With one in every campaign, stated probabilities of
/// sets came out too low: at 0.6 to 0.8 (mean 73 %) 97 % of 150 were true.
fn against_family() -> f64 {
    3.0 * catalogue().count() as f64
}

/// Searches for what a campaign's declared model lacks.
///
/// # Errors
/// The words of why not even the declared model can be followed.
pub fn discover(engine: &mut Engine) -> Result<Discovery, String> {
    let mut log = Vec::new();
    let declared = Model::declared(&engine.campaign);
    let best = searched(engine, &declared, &mut log);
    log.push(format!("work {:.0}", engine.passes()));
    let unfinished_passes = engine.is_exhausted().then(|| engine.passes().round());
    engine.count_anew();
    let ((_, after, weighed), departs) = or_followed_freely(engine, &declared, best, &mut log)?;
    let (after, weighed) = rivals_fitted(engine, after, weighed, &mut log);
    let (after, weighed) = selected(engine, after, weighed, &mut log);
    let (after, weighed) = told_from_none(engine, after, weighed, &mut log);
    let (after, weighed, contest) = against_alternatives(engine, after, weighed, &mut log);
    let (after, weighed, contest, faint) = against_gusts(engine, after, weighed, contest, &mut log);
    let is_faint = !faint.is_empty();
    let (contest, faint) = against_free_accelerations(engine, &after, faint, contest, &mut log);
    let engine = &engine.without_priors_of_strengths();
    let after = engine.climb(&after.model, true, 10).unwrap_or(after);
    let (after, ridges) = engine.along_ridges(engine.settle_exactly(&after));
    let before = declared_alone(engine, &declared, &after);
    let sets = named(&weighed, &after.model);
    let (random_gains, random_ranges) = (gains(engine, &after), engine.random_ranges(&after));
    let random_bounds = random_bounds(engine, &after);
    let stands_in = |m: &&Member| is_faint && m.random && !m.declared && engine.moves_air(m);
    let stand_ins = after.model.members.iter().filter(stands_in).map(|m| m.effect.family).collect();
    let mut after = engine.robust(&after);
    after.covariance = along(after.covariance, &ridges);
    let mut after = across_sets(after, &weighed);
    let missing = contest.as_ref().filter(|c| !c.leads.is_empty());
    let errors_carry_missing = missing.is_some();
    if let Some(contest) = missing {
        after = beside_what_is_missing(after, &contest.said);
    }
    let (before, before_fault) = match before {
        Ok(fit) => (Some(engine.robust(&fit)), Ok(())),
        Err(words) => (None, Err(words)),
    };
    let innovations = engine.sum(&after.model, &[], &[]).ok();
    let lines = innovations.as_ref().map_or_else(Vec::new, |s| lines(engine, &after.model, s));
    let outliers = innovations.as_ref().map_or([0; POSE], outliers);
    Ok(Discovery {
        before,
        before_fault,
        departs,
        after,
        sets,
        gram: weighed.gram,
        units: weighed.units,
        families: weighed.families,
        contest,
        faint,
        stand_ins,
        random_gains,
        random_ranges,
        random_bounds,
        lines,
        unfinished_passes,
        errors_carry_missing,
        outliers,
        log,
    })
}

/// The best set from all starts, in noise learnt again at it, with random inputs that no start had and what struck once: its score, its fit,
/// and all sets weighed there.
fn searched(engine: &mut Engine, declared: &Model, log: &mut Vec<String>) -> Result<Option<Scored>, String> {
    let noise = engine.noise.map(|n| format!("{:.3e}/{:.2}", n.std(), if n.coloured > 0.0 { n.correlation } else { 0.0 }));
    log.push(format!("noise {}", noise.join(" ")));
    let Some(best) = from_starts(engine, log)? else { return Ok(None) };
    // In a wrong form, what is left over looks like gusts.
    let best = alone(engine, in_other_forms(engine, best, log), log);
    let tried = names(&best.1.model);
    let mut best = in_bursts(engine, best, log);
    for beside in [Some(best.1.clone()), nearly_noise(engine, declared, &best.1)] {
        if !engine.is_exhausted()
            && let Some(more) = beside.and_then(|fit| with_random(engine, &fit))
        {
            log.push(format!("random inputs beside it: {}", describe(&more.model)));
            // One input more must beat the set without it as any larger set must.
            if let Some(other) = polish(engine, more.model, best.0, log).filter(|other| is_above(other.0, best.0, SURE)) {
                best = other;
            }
        }
    }
    if !engine.is_exhausted() && engine.has_band(&best.1.model) {
        best = in_steep_bands(engine, best, log);
    }
    if !engine.campaign.knowledge.exact_noise && !engine.is_exhausted() {
        best = in_own_noise(engine, best, log);
    }
    if !engine.is_exhausted() && names(&best.1.model) != tried {
        best = in_other_forms(engine, best, log);
    }
    // Something that struck once, beside what was found.
    if !engine.is_exhausted()
        && let Some(struck) = struck(engine, &best.1)
        && let Some(other) = polish(engine, struck.model, f64::NEG_INFINITY, log).filter(|other| other.0 > best.0)
    {
        best = other;
    }
    if engine.bursts().is_none() && !engine.is_exhausted() {
        best = in_bursts(engine, best, log);
    }
    Ok(Some(best))
}

/// What a search found, or the declared model in free accelerations and why.
fn or_followed_freely(
    engine: &mut Engine,
    declared: &Model,
    found: Result<Option<Scored>, String>,
    log: &mut Vec<String>,
) -> Result<(Scored, Option<String>), String> {
    let fault = match found {
        Ok(Some(best)) => return Ok((best, None)),
        Ok(None) => "no set of effects could be fitted".to_owned(),
        Err(words) => words,
    };
    let (followed, words) = followed_freely(engine, declared, log).ok_or(fault)?;
    Ok((followed, Some(words)))
}

/// The declared model with its accelerations left free by the least that keeps it near its runs, where no set of effects does; and that in words,
/// with where the model departs. The engine's accelerations stay free by that.
fn followed_freely(engine: &mut Engine, declared: &Model, log: &mut Vec<String>) -> Option<(Scored, String)> {
    /// Shares of the accelerations of free flight, each about three times the one before.
    const FREEDOM: [f64; 7] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0];
    let mut words = "no set of effects keeps the model near its runs".to_owned();
    if let Err(departed) = engine.climb(declared, false, 0) {
        words += &format!(": {}", departed.words(&engine.campaign));
    }
    for slack in FREEDOM {
        engine.slack = [slack; 6];
        if let Ok(fit) = engine.climb(declared, false, 12)
            && let Some(weighed) = weigh::weigh(engine, &fit.model)
        {
            log.push(format!("accelerations left free by {slack}: chi {:.3}", fit.chi));
            return Some(((score(engine, &fit), fit, weighed), words));
        }
    }
    None
}

/// The fit of the declared model alone where it leaves hardly more than noise, for which effects were found: a random input may explain as much.
fn nearly_noise(engine: &Engine, declared: &Model, found: &Fit) -> Option<Fit> {
    let has_effects = found.model.members.iter().any(|m| !m.declared && !m.random);
    let fit = if has_effects { engine.climb(declared, false, 12).ok() } else { None };
    fit.filter(|fit| fit.chi < LEFT)
}

/// The best set where the gusts' variance changes along the runs as it is likeliest to do, where that is surely likelier; in it what bursts seemed
/// to be is weighed again.
fn in_bursts(engine: &mut Engine, best: Scored, log: &mut Vec<String>) -> Scored {
    let without = |model: &Model| {
        let mut model = model.clone();
        model.members.retain(|m| !m.is_local() || m.declared);
        model
    };
    let calm = without(&best.1.model);
    let own = names(&best.1.model);
    let tries = [
        in_dryden_alone(engine, &best.1.model),
        (calm.members.len() < best.1.model.members.len()).then_some(calm),
        Some(best.1.model.clone()),
    ];
    let ends = tries.into_iter().flatten().enumerate().filter_map(|(k, model)| {
        let is_allowed = k == 0 || !engine.is_exhausted() || names(&model) == own;
        let bursty = is_allowed.then(|| engine.in_bursts(&model))??;
        log.push(format!("bursts, {:.1} for knowing them ({:.0})", bursty.bursts_price, bursty.passes()));
        let end = polished(&bursty, model, f64::NEG_INFINITY, false, log)?;
        Some((bursty, end))
    });
    surely_likelier(engine, best, ends.max_by(|a, b| a.1.0.total_cmp(&b.1.0)))
}

/// Gusts of Dryden's form in the place of all random inputs, fitted, where a model has others or gusts of a band: with one size all along,
/// gusts that come in bursts look like a second random input or a band far from theirs.
fn in_dryden_alone(engine: &Engine, model: &Model) -> Option<Model> {
    let gusts = model.members.iter().find(|m| m.random && engine.moves_air(m) && !m.declared)?;
    let is_other = |m: &Member| m.random && !m.declared && !engine.moves_air(m);
    if !engine.has_band(model) && !model.members.iter().any(is_other) {
        return None;
    }
    Some(beside(engine, model.clone().calm(), &Member::null(gusts.effect, &engine.campaign))?.model)
}

/// A model with a random input beside it, fitted from a middle size and form.
fn beside(engine: &Engine, mut model: Model, null: &Member) -> Option<Fit> {
    let forms = null.forms();
    model.members.push(sized(null, LEVELS[1], &forms[forms.len() / 2]));
    let fit = engine.climb(&model, false, 6).ok()?;
    Some(engine.settle_random(&fit, 5))
}

/// The end of a search by another engine, which takes this one's place, where it is surely likelier; the best otherwise.
fn surely_likelier(engine: &mut Engine, best: Scored, other: Option<(Engine, Scored)>) -> Scored {
    match other {
        Some((with, end)) if is_above(end.0, best.0, SURE) => {
            *engine = with;
            end
        }
        _ => best,
    }
}

/// The best set where the gusts' bands have steep edges, where that is surely likelier.
fn in_steep_bands(engine: &mut Engine, best: Scored, log: &mut Vec<String>) -> Scored {
    let mut steep = engine.clone();
    steep.spectra.steep = true;
    let end = polished(&steep, best.1.model.clone(), f64::NEG_INFINITY, false, log);
    if let Some(end) = &end {
        log.push(format!("steep edges bring {} ({:.0})", more(end.0, best.0), steep.passes()));
    }
    surely_likelier(engine, best, end.map(|end| (steep, end)))
}

/// Noise again, by the likelihood of the best model, and the best model in it. Gusts and coloured noise may stand for each other: where both
/// are there, a model without gusts is given the noise that suits it before the two are compared.
fn in_own_noise(engine: &mut Engine, best: Scored, log: &mut Vec<String>) -> Scored {
    let calm = best.1.model.clone().calm();
    let is_coloured = engine.noise.iter().any(|n| n.coloured > 0.0);
    let other = (is_coloured && calm.members.len() < best.1.model.members.len()).then(|| {
        let mut calm_engine = engine.clone();
        let fit = calm_engine.climb(&calm, true, 10).ok()?;
        calm_engine.refine_noise(&fit.model);
        let end = polish(&calm_engine, fit.model, f64::NEG_INFINITY, log)?;
        Some((calm_engine.noise, end))
    });
    let best = if engine.refine_noise(&best.1.model) {
        log.push(format!("noise {:?}", engine.noise.map(|n| format!("{:.3e}/{:.2}", n.std(), n.correlation))));
        polished(engine, best.1.model.clone(), f64::NEG_INFINITY, false, log).unwrap_or(best)
    } else {
        best
    };
    match other.flatten() {
        Some((noise, end)) if end.0 > best.0 => {
            engine.noise = noise;
            end
        }
        _ => best,
    }
}

/// The best set from the starts that are worth following: random inputs that every start may have are none, or one effect in one form at one
/// size.
fn from_starts(engine: &Engine, log: &mut Vec<String>) -> Result<Option<Scored>, String> {
    // From what a check of the records has seen, where it has.
    let starts = ladder(&engine.coarse(), &Model::seen(&engine.campaign), log)?;
    let mut best: Option<Scored> = None;
    let top = starts.first().map_or(f64::NEG_INFINITY, |s| s.total);
    for Start { total, at, next } in starts.into_iter().take(STARTS) {
        let floor = best.as_ref().map_or(f64::NEG_INFINITY, |b| b.0);
        if engine.is_exhausted() && best.is_some() {
            break;
        }
        if is_behind(total, top, FAR) && best.as_ref().is_some_and(|b| b.1.chi < LEFT) {
            continue;
        }
        log.push(format!("start at {total:.1}: {}", describe(&at)));
        let Some(end) = polish(engine, next, floor, log) else { continue };
        log.push(format!("  ends at {:.1}: {}", end.0, describe(&end.1.model)));
        if end.0 > floor {
            best = Some(end);
        }
    }
    Ok(best)
}

/// Declared parameters and uncertain constants with what the campaign declares and, where the runs speak for them, gusts; no other effect.
/// `near` is where other runs have led already.
///
/// # Errors
/// The words of why the declared model cannot be followed.
pub fn identify(engine: &Engine, near: Option<&Model>) -> Result<Fit, String> {
    let declared = Model::seen(&engine.campaign);
    let led = lead_in(&engine.coarse(), &declared);
    let near = near.map(|m| Model { members: declared.members.clone(), ..m.clone() });
    let ends = [Some(&declared), led.as_ref(), near.as_ref()].into_iter().flatten().filter_map(|m| climb_down(engine, m));
    let still = ends.max_by(|a, b| a.total.total_cmp(&b.total));
    let start = still.as_ref().map_or_else(|| led.clone().unwrap_or_else(|| declared.clone()), |f| f.model.clone());
    let gusts = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random && engine.moves_air(m));
    let gusty = gusts
        .filter(|m| !has(&declared, m))
        .filter_map(|null| {
            let fit = beside(engine, start.clone(), &null)?;
            Some((less_random(fit.total, &fit.model, engine), fit))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match (still, gusty) {
        (Some(still), Some((total, gusty))) => Ok(if is_above(total, still.total, SURE) { gusty } else { still }),
        (Some(fit), None) | (None, Some((_, fit))) => Ok(fit),
        (None, None) => Err("with the declared model no fit stays within its runs".to_owned()),
    }
}

/// Effects that the runs kept for choosing leave: one goes that these and the identified runs together are not surely likelier with, or that these
/// alone contradict; worst first. Sets with it are as much less likely, or none.
fn selected(engine: &Engine, fit: Fit, weighed: Weighed, log: &mut Vec<String>) -> (Fit, Weighed) {
    if !engine.campaign.runs.iter().any(|r| r.used == Use::Select) {
        return (fit, weighed);
    }
    let (mut fit, mut weighed, mut gone) = (fit, weighed, Vec::new());
    loop {
        let (here, kept) = (score(engine, &fit), predicted(engine, &fit));
        let free = (0..fit.model.members.len()).filter(|&k| !fit.model.members[k].declared && !fit.model.members[k].is_local());
        let without = free.filter_map(|k| {
            let mut model = fit.model.clone();
            model.members.remove(k);
            let less = engine.climb(&model, true, 6).ok()?;
            let by = predicted(engine, &less) - kept;
            let both = score(engine, &less) + by;
            let family = fit.model.members[k].effect.family;
            (is_within(both, here, SURE) || by > CONTRADICTED).then_some((by, both, less, family))
        });
        let Some((by, both, less, family)) = without.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        let Some(mut w) = weigh::weigh(engine, &less.model) else { break };
        gone.push((family, by));
        gone.iter().for_each(|(f, by)| if *by > CONTRADICTED { w.leave_out(&[f]) } else { w.lessen(f, *by) });
        log.push(format!("select runs are likelier by {by:.1}, all by {}: {}", more(both, here), describe(&less.model)));
        (fit, weighed) = (less, w);
    }
    (fit, weighed)
}

/// Log predictive density of the runs kept for choosing; zero without such runs.
fn predicted(engine: &Engine, fit: &Fit) -> f64 {
    let select: Vec<usize> = (0..engine.campaign.runs.len()).filter(|&i| engine.campaign.runs[i].used == Use::Select).collect();
    if select.is_empty() { 0.0 } else { engine.predictive(fit, &select).unwrap_or(UNFLOWN) }
}

/// What each random member brings over a model without it.
fn gains(engine: &Engine, fit: &Fit) -> Vec<(usize, f64)> {
    let random = (0..fit.model.members.len()).filter(|&k| fit.model.members[k].random);
    random
        .map(|k| {
            let mut without = fit.model.clone();
            without.members.remove(k);
            (k, engine.climb(&without, false, 3).map_or(f64::INFINITY, |f| fit.log_likelihood - f.log_likelihood))
        })
        .collect()
}

/// Sizes of random inputs that are not in the model at which the likelihood has fallen by what 95 % leave (1.92), by bisection.
fn random_bounds(engine: &Engine, fit: &Fit) -> Vec<(&'static str, String, f64, String)> {
    // A bound is wanted to a tenth: longer nodes do.
    let engine = &engine.coarse();
    let Ok(here) = engine.sum(&fit.model, &[], &[]).map(|s| s.log_likelihood) else { return Vec::new() };
    let absent = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random);
    absent
        .filter(|m| !has(&fit.model, m))
        .flat_map(|null| {
            let strengths: Vec<usize> = null.strengths().collect();
            let mut form = null.values.clone();
            if let Some(middle) = null.forms().get(null.forms().len() / 2) {
                form.clone_from(middle);
            }
            strengths.into_iter().map(move |i| {
                let falls = |size: f64| {
                    let mut model = fit.model.clone();
                    let mut m = Member { values: form.clone(), ..null.clone() };
                    m.strengths().collect::<Vec<_>>().iter().for_each(|&k| m.values[k] = 0.0);
                    m.values[i] = size;
                    model.members.push(m);
                    engine.sum(&model, &[], &[]).map_or(true, |s| is_behind(s.log_likelihood, here, 1.92))
                };
                let p = &null.parameters[i];
                (null.effect.family, p.name.clone(), bound(p.high, falls), p.unit.to_owned())
            })
        })
        .collect()
}

/// The least size that `falls`, to a tenth: five decades below the largest halved seven times.
fn bound(largest: f64, falls: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = ((1e-5 * largest).ln(), largest.ln());
    for _ in 0..7 {
        let middle = 0.5 * (low + high);
        if falls(middle.exp()) { high = middle } else { low = middle }
    }
    high.exp()
}

/// A covariance with what is not known along ridges.
fn along(mut covariance: DMatrix<f64>, ridges: &[DVector<f64>]) -> DMatrix<f64> {
    ridges.iter().for_each(|r| covariance += r * r.transpose());
    covariance
}

/// Nats by which a score is above another, in words.
fn more(there: f64, here: f64) -> String {
    format!("{:.1}", there - here)
}

fn describe(model: &Model) -> String {
    let words: Vec<String> = model
        .members
        .iter()
        .map(|m| format!("{}({})", m.effect.family, m.values.iter().map(|v| format!("{v:.4}")).collect::<Vec<_>>().join(",")))
        .collect();
    words.join(" + ")
}

/// Places of a member's strengths among a fit's numbers.
fn strengths(fit: &Fit, member: usize) -> impl Iterator<Item = usize> {
    let is_own = move |id: Id| matches!(id, Id::Member(m, _) if m == member) && fit.model.is_strength(id);
    (0..fit.numbers.len()).filter(move |&i| is_own(fit.numbers[i].id))
}

/// Log marginal likelihood of a fit with what its members cost a priori taken off, its random members' numbers integrated over.
fn score(engine: &Engine, fit: &Fit) -> f64 {
    let members = &fit.model.members;
    let effects = (0..members.len()).filter(|&k| !members[k].declared && !members[k].random);
    let of_number = |i: usize| (fit.numbers[i].value, fit.covariance[(i, i)], fit.numbers[i].prior);
    let sizes: f64 = effects.map(|k| of_any_size(strengths(fit, k).map(of_number))).sum();
    let costs: f64 = members.iter().filter(|m| !m.declared).map(|m| cost(m, engine)).sum();
    fit.total + sizes - costs - engine.random_price(&fit.model)
}

fn cost(m: &Member, engine: &Engine) -> f64 {
    let forms = if m.random { 1 } else { Member::null(m.effect, &engine.campaign).forms().len() };
    let instants = if m.is_local() { engine.instants() } else { 1 };
    against_family().ln() + (forms as f64).ln() + (instants as f64).ln()
}

/// Whether a model has that effect.
fn has(model: &Model, of: &Member) -> bool {
    model.members.iter().any(|m| m.effect.family == of.effect.family)
}

/// What a member must bring to be there for sure.
fn sure_cost(m: &Member, engine: &Engine) -> f64 {
    cost(m, engine) + SURE
}

/// A log marginal likelihood less what the model's random members cost a priori.
fn less_random_cost(total: f64, model: &Model, engine: &Engine) -> f64 {
    total - model.members.iter().filter(|m| m.random && !m.declared).map(|m| cost(m, engine)).sum::<f64>()
}

/// The same with their numbers integrated over.
fn less_random(total: f64, model: &Model, engine: &Engine) -> f64 {
    less_random_cost(total, model, engine) - engine.random_price(model)
}

#[cfg(test)]
mod tests;
