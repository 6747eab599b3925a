//! likelihood: what a declared model lacks. In: a campaign. Out: the set of effects that its runs speak for, with rivals and probabilities.
//!
//! Start in wide gusts, where the filter cannot lose the data, and narrow them; at every level all sets are weighed. The best are fitted
//! in full, random inputs searched together with the set, and all sets weighed again at the new point until the set stays.

use crate::check::{Alternative, Lead, alternatives, lines, outliers};
use crate::columns::CHANNEL_NAMES;
use crate::engine::{Engine, Fit, always};
use crate::gram::Gram;
use crate::model::{Id, Member, Model, Number, candidates, catalogue};
use crate::noise::POSE;
use crate::search::{Set, Unit, search, units};
use windfall_model::{CATALOGUE, Effect, Role, Use};

/// Most effects in a set.
const MOST: usize = 4;
/// Rounds of fitting and weighing again.
const ROUNDS: usize = 6;
/// Sizes of a random input that are tried, as shares of the largest plausible (turbulence: 2 m/s).
const LEVELS: [f64; 5] = [0.15, 0.06, 0.025, 0.01, 0.0035];
/// Starts that are followed to the end.
const STARTS: usize = 2;

/// A start this far below the best, in nats, is not followed, unless the best left more than this mean square of what noise leaves.
const FAR: f64 = 60.0;
const LEFT: f64 = 1.1;

/// A search this far below another's end after two rounds is given up.
const HOPELESS: f64 = 500.0;

/// A search's outcome.
#[derive(Clone, Debug)]
pub struct Discovery {
    /// Fit of the declared model alone; none where it departs.
    pub before: Option<Fit>,
    /// Why there is none.
    pub before_fault: Result<(), String>,
    /// Fit of the best set.
    pub after: Fit,
    /// Sets weighed at the end: families, log marginal likelihood over the empty set's.
    pub sets: Vec<(Vec<&'static str>, f64)>,
    /// Everything weighed at the end.
    pub gram: Gram,
    /// Units of it.
    pub units: Vec<Unit>,
    /// Family of each unit, and its form's index (none for a member's own).
    pub families: Vec<(usize, Option<usize>)>,
    /// What generic alternatives say beside the effects.
    pub contest: Option<Contest>,
    /// What gusts weaker than any tunnel's may stand for.
    pub faint: Vec<Lead>,
    /// Gain of log marginal likelihood of each random member, by its place.
    pub random_gains: Vec<(usize, f64)>,
    /// Standard errors of random members' numbers, by place and parameter.
    pub random_errors: Vec<((usize, usize), f64)>,
    /// Upper 95 % bounds of random strengths that were not found: family, parameter, bound, unit.
    pub random_bounds: Vec<(&'static str, String, f64, String)>,
    /// Lines in the spectra of the innovations.
    pub lines: Vec<Lead>,
    /// Innovations of each channel of the pose beyond five standard deviations.
    pub outliers: [usize; POSE],
    /// What was done, for those who look beneath.
    pub log: Vec<String>,
}

/// Number of families that a lander may have.
fn families() -> f64 {
    catalogue().count() as f64
}

/// Log odds by which a larger set must beat a smaller one to be chosen: twenty to one.
const SURE: f64 = 3.0;

impl Weighed {
    /// The smallest set that the best does not beat by [`SURE`], the best of that size.
    fn choice(&self) -> &Set {
        let best = &self.sets[0];
        let enough = |s: &&Set| s.gain >= best.gain - SURE;
        self.sets.iter().filter(enough).min_by_key(|s| s.units.len()).unwrap_or(best)
    }
}

struct Weighed {
    gram: Gram,
    /// Everything, with the places of what every set has and of the others.
    whole: Gram,
    base: Vec<usize>,
    others: Vec<usize>,
    units: Vec<Unit>,
    families: Vec<(usize, Option<usize>)>,
    sets: Vec<Set>,
    total: f64,
}

/// Searches for what a campaign's declared model lacks.
///
/// # Errors
/// The words of why not even the declared model can be followed.
pub fn discover(engine: &mut Engine) -> Result<Discovery, String> {
    let mut log = Vec::new();
    let declared = Model::declared(&engine.campaign);
    let noise = engine.noise.map(|n| format!("{:.3e}/{:.2}", n.std(), if n.coloured > 0.0 { n.correlation } else { 0.0 }));
    log.push(format!("noise {}", noise.join(" ")));
    // Random inputs that every start may have: none, or one effect in one form at one size.
    let starts = ladder(&engine.coarse(), &declared, &mut log)?;
    let mut best: Option<(f64, Fit, Weighed)> = None;
    let top = starts.first().map_or(f64::NEG_INFINITY, |s| s.total);
    for Start { total, at, next } in starts.into_iter().take(STARTS) {
        let floor = best.as_ref().map_or(f64::NEG_INFINITY, |b| b.0);
        if total < top - FAR && best.as_ref().is_some_and(|b| b.1.chi < LEFT) {
            continue;
        }
        log.push(format!("start at {total:.1}: {}", describe(&at)));
        let Some((fit, weighed)) = polish(engine, next, floor, &mut log) else { continue };
        let score = fit.total - cost_of(&fit.model, engine);
        log.push(format!("  ends at {score:.1}: {}", describe(&fit.model)));
        if best.as_ref().is_none_or(|b| score > b.0) {
            best = Some((score, fit, weighed));
        }
    }
    // Noise again, by the likelihood of the best model, and the best model in it.
    if let Some((_, fit, _)) = &best
        && !engine.campaign.knowledge.exact_noise
        && engine.refine_noise(&fit.model)
    {
        log.push(format!("noise {:?}", engine.noise.map(|n| format!("{:.3e}/{:.2}", n.std(), n.correlation))));
        if let Some((fit, weighed)) = polish(engine, fit.model.clone(), f64::NEG_INFINITY, &mut log) {
            best = Some((fit.total, fit, weighed));
        }
    }
    // Something that struck once, beside what was found.
    if let Some((_, fit, _)) = &best
        && let Some(struck) = struck(engine, fit)
        && let Some((fit, weighed)) = polish(engine, struck.model, f64::NEG_INFINITY, &mut log)
        && best.as_ref().is_none_or(|b| fit.total - cost_of(&fit.model, engine) > b.1.total - cost_of(&b.1.model, engine))
    {
        best = Some((fit.total, fit, weighed));
    }
    let (_, after, weighed) = best.ok_or("no set of effects could be fitted")?;
    let (after, weighed) = selected(engine, after, weighed, &mut log);
    let (after, weighed, contest) = against_alternatives(engine, after, weighed, &mut log);
    let (after, weighed, contest, faint) = against_gusts(engine, after, weighed, contest, &mut log);
    let before = declared_alone(engine, &declared, &after);
    let sets = named(&weighed, &after.model);
    let (random_gains, random_errors) = (gains(engine, &after), random_errors(engine, &after));
    let random_bounds = random_bounds(engine, &after);
    let (before, before_fault) = match before {
        Ok(fit) => (Some(fit), Ok(())),
        Err(words) => (None, Err(words)),
    };
    let innovations = engine.sum(&after.model, &[], &[]).ok();
    let lines = innovations.as_ref().map_or_else(Vec::new, |s| lines(engine, &after.model, s));
    let outliers = innovations.as_ref().map_or([0; POSE], outliers);
    Ok(Discovery {
        before,
        before_fault,
        after,
        sets,
        gram: weighed.gram,
        units: weighed.units,
        families: weighed.families,
        contest,
        faint,
        random_gains,
        random_errors,
        random_bounds,
        lines,
        outliers,
        log,
    })
}

/// Declared parameters and uncertain constants with what the campaign declares and, where the runs speak for them, gusts; no other effect.
/// `near` is where other runs have led already.
///
/// # Errors
/// The words of why the declared model cannot be followed.
pub fn identify(engine: &Engine, near: Option<&Model>) -> Result<Fit, String> {
    let declared = Model::declared(&engine.campaign);
    let led = lead_in(&engine.coarse(), &declared);
    let near = near.map(|m| Model { members: declared.members.clone(), ..m.clone() });
    let ends = [Some(&declared), led.as_ref(), near.as_ref()].into_iter().flatten().filter_map(|m| climb_down(engine, m));
    let still = ends.max_by(|a, b| a.total.total_cmp(&b.total));
    let start = still.as_ref().map_or_else(|| led.clone().unwrap_or_else(|| declared.clone()), |f| f.model.clone());
    let gusts = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random && moves_air(m, engine));
    let gusty = gusts
        .filter(|m| !has(&declared, m))
        .filter_map(|null| {
            let mut model = start.clone();
            let forms = null.forms();
            model.members.push(sized(&null, LEVELS[1], &forms[forms.len() / 2]));
            let fit = engine.climb(&model, false, 6).ok()?;
            let fit = engine.settle_random(&fit, 5);
            Some((fit.total - random_cost(&fit.model, engine), fit))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match (still, gusty) {
        (Some(still), Some((total, gusty))) => Ok(if total > still.total + SURE { gusty } else { still }),
        (Some(fit), None) | (None, Some((_, fit))) => Ok(fit),
        (None, None) => Err("with the declared model no fit stays within its runs".to_owned()),
    }
}

/// Whether a random member is a gust.
fn moves_air(m: &Member, engine: &Engine) -> bool {
    let mut v = m.values.clone();
    v[0] = 1.0;
    let mut plant = engine.campaign.plant.clone();
    (m.effect.apply)(&mut plant, &v);
    plant.disturbances(1.0).iter().any(|d| matches!(d.entry, windfall_model::Entry::AirVelocity(_)))
}

/// Effects that the runs kept for choosing speak for: one whose absence predicts those runs better is left out, worst first.
fn selected(engine: &Engine, fit: Fit, weighed: Weighed, log: &mut Vec<String>) -> (Fit, Weighed) {
    let select: Vec<usize> = (0..engine.campaign.runs.len()).filter(|&i| engine.campaign.runs[i].used == Use::Select).collect();
    let (mut fit, mut weighed) = (fit, weighed);
    while let Some(here) = engine.predict(&fit.model, &select) {
        let free = (0..fit.model.members.len()).filter(|&k| !fit.model.members[k].declared && !fit.model.members[k].is_local());
        let without = free.filter_map(|k| {
            let mut model = fit.model.clone();
            model.members.remove(k);
            let less = engine.climb(&model, true, 6).ok()?;
            Some((engine.predict(&less.model, &select)?, less))
        });
        let Some((gain, less)) = without.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if gain <= here {
            break;
        }
        let Some(w) = self::weighed(engine, &less.model) else { break };
        log.push(format!("select runs prefer {} by {:.1}", describe(&less.model), gain - here));
        (fit, weighed) = (less, w);
    }
    (fit, weighed)
}

/// The best set held against generic alternatives: members that those make needless are taken out, and the rest fitted again.
fn against_alternatives(engine: &Engine, fit: Fit, weighed: Weighed, log: &mut Vec<String>) -> (Fit, Weighed, Option<Contest>) {
    let all = alternatives(engine);
    let Some(first) = contest(engine, &fit.model, &all) else { return (fit, weighed, None) };
    let keep = |m: &Member| m.declared || m.random || first.families.contains(&m.effect.family);
    if first.leads.is_empty() || fit.model.members.iter().all(keep) {
        return (fit, weighed, Some(first));
    }
    let mut model = fit.model.clone();
    model.members.retain(keep);
    log.push(format!("generic alternatives leave {}", describe(&model)));
    let fewer = engine.climb(&model, true, 6).ok().and_then(|f| Some((self::weighed(engine, &f.model)?, f)));
    let Some((w, f)) = fewer else { return (fit, weighed, Some(first)) };
    let again = contest(engine, &f.model, &all).or(Some(first));
    (f, w, again)
}

/// Gusts weaker than this share of the tunnel speed are no tunnel's: closed tunnels with many screens have 0.0005, a vertical one with
/// few some 0.005.
const FAINT: f64 = 0.001;

/// Gusts held against generic alternatives without gusts: random air takes up any small and slow residual, whatever it varies with. What
/// the alternatives explain better is theirs; gusts that are fainter than a tunnel's are said to stand for something else.
fn against_gusts(
    engine: &Engine,
    fit: Fit,
    weighed: Weighed,
    contest: Option<Contest>,
    log: &mut Vec<String>,
) -> (Fit, Weighed, Option<Contest>, Vec<Lead>) {
    const NEAR: f64 = 2.0;
    let speed = engine.runs.iter().map(|r| r.speed_m_s).sum::<f64>() / engine.runs.len().max(1) as f64;
    let gusts = fit.model.members.iter().position(|m| m.random && !m.declared && moves_air(m, engine));
    let Some(gusts) = gusts else { return (fit, weighed, contest, Vec::new()) };
    let member = &fit.model.members[gusts];
    let size = member.strengths().map(|i| member.values[i]).fold(0.0, f64::max);
    let mut still = fit.model.clone();
    still.members.remove(gusts);
    let Ok(still) = engine.climb(&still, true, 6) else { return (fit, weighed, contest, Vec::new()) };
    let all = alternatives(engine);
    let Some(beside) = weighed_beside(engine, &still.model, &all) else { return (fit, weighed, contest, Vec::new()) };
    let Some(other) = outcome(&beside, &all) else { return (fit, weighed, contest, Vec::new()) };
    let here = fit.total - cost_of(&fit.model, engine);
    log.push(format!("without gusts {:.1} for {here:.1}, {:?}", beside.total, other.leads));
    if still.chi < NEAR
        && !other.leads.is_empty()
        && beside.total > here + SURE
        && let Some(weighed) = self::weighed(engine, &still.model)
    {
        return (still, weighed, Some(other), Vec::new());
    }
    if size >= FAINT * speed {
        return (fit, weighed, contest, Vec::new());
    }
    let worst = (0..POSE).max_by(|a, b| still.channels[*a][2].total_cmp(&still.channels[*b][2])).unwrap_or(0);
    let small = Lead {
        channel: CHANNEL_NAMES[worst].to_owned(),
        variable: format!("time at random, as gusts of {size:.1e} m/s would make it, fainter than any tunnel's"),
        gain: fit.log_likelihood - still.log_likelihood,
        line_hz: None,
        of_instrument: false,
        amplitudes: Vec::new(),
    };
    let leads = if other.leads.is_empty() { vec![small] } else { other.leads };
    (fit, weighed, contest, leads)
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

/// Standard errors of the random members' numbers by their information, to first order in their logarithms.
fn random_errors(engine: &Engine, fit: &Fit) -> Vec<((usize, usize), f64)> {
    let places = crate::engine::random_numbers(&fit.model);
    if places.is_empty() {
        return Vec::new();
    }
    let inverse = engine.random_scores(&fit.model).and_then(|(_, _, information)| information.try_inverse());
    let Some(inverse) = inverse else { return Vec::new() };
    let one = |(j, (k, i)): (usize, (usize, usize))| {
        let variance = inverse[(j, j)];
        (variance > 0.0).then(|| ((k, i), fit.model.members[k].values[i] * variance.sqrt()))
    };
    places.into_iter().enumerate().filter_map(one).collect()
}

/// Sizes of random inputs that are not in the model at which the likelihood has fallen by what 95 % leave (1.92), by bisection.
fn random_bounds(engine: &Engine, fit: &Fit) -> Vec<(&'static str, String, f64, String)> {
    let here = fit.log_likelihood;
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
                    engine.sum(&model, &[], &[]).map_or(true, |s| s.log_likelihood < here - 1.92)
                };
                let p = &null.parameters[i];
                let (mut low, mut high) = ((1e-5 * p.high).ln(), p.high.ln());
                for _ in 0..7 {
                    let middle = 0.5 * (low + high);
                    if falls(middle.exp()) { high = middle } else { low = middle }
                }
                (null.effect.family, p.name.clone(), high.exp(), p.unit.to_owned())
            })
        })
        .collect()
}

fn describe(model: &Model) -> String {
    let words: Vec<String> = model
        .members
        .iter()
        .map(|m| format!("{}({})", m.effect.family, m.values.iter().map(|v| format!("{v:.4}")).collect::<Vec<_>>().join(",")))
        .collect();
    words.join(" + ")
}

/// What the members of a model cost a priori.
fn cost_of(model: &Model, engine: &Engine) -> f64 {
    model.members.iter().filter(|m| !m.declared).map(|m| cost(m, engine)).sum()
}

fn cost(m: &Member, engine: &Engine) -> f64 {
    let forms = if m.random { 1 } else { Member::null(m.effect, &engine.campaign).forms().len() };
    let instants = if m.is_local() { engine.instants() } else { 1 };
    families().ln() + (forms as f64).ln() + (instants as f64).ln()
}

/// A model struck at the instant at which a kick explains most, in the likeliest duration; none where that would not be sure.
fn struck(engine: &Engine, fit: &Fit) -> Option<Fit> {
    let null = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).find(|m| m.is_local() && !has(&fit.model, m))?;
    let (run, shock) = engine.shock(&fit.model)?;
    if shock.gain < cost(&null, engine) + SURE {
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
            values[of_instant] = (shock.t_s - share * form[of_duration]).max(0.0);
            Member { values, ..null.clone() }
        })
    });
    let fits = tries.filter_map(|member| {
        let mut model = fit.model.clone();
        model.members.push(member);
        engine.climb(&model, false, 2).ok()
    });
    let best = fits.max_by(|a, b| a.total.total_cmp(&b.total))?;
    let best = engine.climb(&best.model, true, 4).ok()?;
    (best.total - cost(&null, engine) - SURE > fit.total).then_some(best)
}

/// Where a search may start: a fit with random inputs, and the best set at it.
struct Start {
    /// Log marginal likelihood of that set.
    total: f64,
    at: Model,
    next: Model,
}

/// Starts with random inputs of every effect, sizes and forms, or none; best first, those that lead to the same set once.
fn ladder(engine: &Engine, declared: &Model, log: &mut Vec<String>) -> Result<Vec<Start>, String> {
    let random: Vec<Member> = catalogue().map(|(_, e)| Member::null(e, &engine.campaign)).filter(|m| m.random).collect();
    let mut fits: Vec<Fit> = Vec::new();
    let mut last = String::new();
    let air = random.iter().find(|m| moves_air(m, engine));
    let mut model = declared.clone();
    // Where gusts are declared they are in every set already.
    if let Some(air) = air.filter(|a| !has(declared, a)) {
        model = in_gusts(engine, declared, air, &mut fits, &mut last);
    }
    // No random input but the declared ones.
    match engine.climb(&model, false, 4) {
        Ok(fit) => fits.push(fit),
        Err(d) => last = d.words(),
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
    // Poor fits are struck everywhere: only the best is asked.
    let best = fits.iter().max_by(|a, b| a.total.total_cmp(&b.total));
    fits.extend(best.and_then(|fit| struck(engine, fit)));
    let mut all: Vec<Start> = fits.into_iter().filter_map(|fit| start(engine, fit, log)).collect();
    all.sort_by(|a, b| b.total.total_cmp(&a.total));
    let mut distinct: Vec<Start> = Vec::new();
    for one in all {
        if distinct.iter().all(|d| names(&d.next) != names(&one.next)) {
            distinct.push(one);
        }
    }
    if distinct.is_empty() { Err(last) } else { Ok(distinct) }
}

/// Fits in gusts from wide to narrow, each starting from the one before, in the likeliest form; the last model, its gusts taken out.
fn in_gusts(engine: &Engine, declared: &Model, air: &Member, fits: &mut Vec<Fit>, last: &mut String) -> Model {
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
                    let others = forms.iter().filter_map(|form| engine.climb(&with(&fit.model, *level, form), false, 1).ok());
                    let best = others.max_by(|a, b| a.total.total_cmp(&b.total));
                    fits.push(best.filter(|b| b.total > fit.total).unwrap_or(fit));
                }
            }
            Err(d) => *last = d.words(),
        }
    }
    without(followed)
}

/// Whether a model has that effect.
fn has(model: &Model, of: &Member) -> bool {
    model.members.iter().any(|m| m.effect.family == of.effect.family)
}

/// Parameters found while accelerations are left free, less and less: from far starting values no gust leads a model's roll.
fn lead_in(engine: &Engine, model: &Model) -> Option<Model> {
    const FREEDOM: [f64; 3] = [1.0, 0.2, 0.04];
    let mut free = engine.clone();
    let mut model = model.clone();
    for (slack, steps) in FREEDOM.into_iter().zip([4, 3, 3]) {
        free.slack = slack;
        model = free.climb(&model, false, steps).ok()?.model;
    }
    Some(model)
}

/// Forms of a random input that are scanned: every value of its first shape, the middle ones of the others.
fn scanned(m: &Member) -> Vec<Vec<f64>> {
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
fn sized(null: &Member, level: f64, form: &[f64]) -> Member {
    let mut m = Member { values: form.to_vec(), ..null.clone() };
    let strengths: Vec<usize> = m.strengths().collect();
    for i in strengths {
        m.values[i] = level * m.parameters[i].high;
    }
    m
}

/// A fit as a start: all sets weighed at it.
fn start(engine: &Engine, fit: Fit, log: &mut Vec<String>) -> Option<Start> {
    let w = weighed(engine, &fit.model)?;
    let total = w.total - random_cost(&fit.model, engine);
    let next = with_set(&fit.model, &w, w.choice(), engine);
    log.push(format!(
        "  level {}: {total:.1} chi {:.3} {} -> {}",
        describe(&fit.model),
        fit.chi,
        fit.stop.words(),
        describe(&next)
    ));
    Some(Start { total, at: fit.model, next })
}

fn random_cost(model: &Model, engine: &Engine) -> f64 {
    model.members.iter().filter(|m| m.random && !m.declared).map(|m| cost(m, engine)).sum()
}

/// All candidates weighed at a model.
fn weighed(engine: &Engine, model: &Model) -> Option<Weighed> {
    weighed_beside(engine, model, &[])
}

/// All candidates and generic alternatives weighed at a model.
fn weighed_beside(engine: &Engine, model: &Model, alternatives: &[Alternative]) -> Option<Weighed> {
    let mut numbers = model.known(&engine.campaign);
    numbers.extend(model.of_members(false));
    numbers.extend(candidates(&engine.campaign, model));
    let mut generic = Vec::new();
    let mut group: Vec<usize> = Vec::new();
    for (k, a) in alternatives.iter().enumerate() {
        for basis in &a.bases {
            let id = Id::Generic(generic.len());
            numbers.push(Number { id, value: 0.0, prior: a.prior, range: [f64::NEG_INFINITY, f64::INFINITY], step: 1.0 });
            generic.push((a.error, a.place, *basis));
            group.push(k);
        }
    }
    let sum = engine.sum(model, &numbers, &generic).ok()?;
    let gram = Gram::new(numbers, sum.g, sum.b, sum.log_likelihood);
    let base: Vec<usize> = places(&gram.numbers, |n| always(n.id, model));
    let others: Vec<usize> =
        places(&gram.numbers, |n| !always(n.id, model) && gram.g[(index(&gram.numbers, n.id), index(&gram.numbers, n.id))] > 0.0);
    let floor = gram.posterior(&base)?;
    let left = gram.given(&base, &others)?;
    let group_of = |id: Id| -> Option<(usize, f64)> {
        match id {
            Id::Strength(family, ..) => Some((family, cost(&Member::null(CATALOGUE[family], &engine.campaign), engine))),
            Id::Member(m, _) => Some((place_of(model.members[m].effect)?, cost(&model.members[m], engine))),
            Id::Generic(i) => Some((GENERIC + group[i], families().ln() + (alternatives.len() as f64).ln())),
            _ => None,
        }
    };
    let key = |id: Id| match id {
        Id::Strength(family, form, _) => (family, form + 1),
        Id::Member(m, _) => (place_of(model.members[m].effect).unwrap_or(0), 0),
        Id::Generic(i) => (GENERIC + group[i], 0),
        _ => (usize::MAX, 0),
    };
    let all = units(&left.numbers, &group_of, &key);
    let families = all.iter().map(|u| {
        let (family, form) = key(left.numbers[u.columns[0]].id);
        (family, form.checked_sub(1))
    });
    let families = families.collect();
    // What the present members' values have brought is put back into the floor: the likelihood of the empty set.
    let shift = gram.log_likelihood - quadratic_here(&gram);
    let sets = search(&left, &all, if alternatives.is_empty() { MOST } else { MOST + 1 });
    let total = shift + floor.gain + sets[0].gain;
    Some(Weighed { gram: left, whole: gram, base, others, units: all, families, sets, total })
}

/// First place of the generic alternatives among families.
const GENERIC: usize = 1000;

/// Outcome of a contest between effects and generic alternatives.
#[derive(Clone, Debug)]
pub struct Contest {
    /// Families of the best set.
    pub families: Vec<&'static str>,
    /// Generic alternatives in it, with what each of them brings to it.
    pub leads: Vec<Lead>,
    /// What the best single alternative brings beside the present members.
    pub strongest: f64,
}

/// Effects and generic alternatives weighed together at a fitted model.
fn contest(engine: &Engine, model: &Model, alternatives: &[Alternative]) -> Option<Contest> {
    outcome(&weighed_beside(engine, model, alternatives)?, alternatives)
}

/// What came of weighing effects beside those alternatives.
fn outcome(w: &Weighed, alternatives: &[Alternative]) -> Option<Contest> {
    let best = w.sets.first()?;
    let is_generic = |u: usize| w.families[u].0 >= GENERIC;
    let leads = best
        .units
        .iter()
        .filter(|&&u| is_generic(u))
        .map(|&u| {
            let rest: Vec<usize> = best.units.iter().copied().filter(|&x| x != u).collect();
            let without = crate::search::weigh(&w.gram, &w.units, &rest).map_or(0.0, |s| s.gain);
            let amplitudes = best
                .columns
                .iter()
                .zip(&best.estimates)
                .filter(|(c, _)| w.units[u].columns.contains(c))
                .map(|(_, e)| *e)
                .collect();
            alternatives[w.families[u].0 - GENERIC].lead(best.gain - without, amplitudes)
        })
        .collect();
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
    Some(Contest { families, leads, strongest })
}

/// What the quadratic says that present values gain over nulls.
fn quadratic_here(gram: &Gram) -> f64 {
    let v = nalgebra::DVector::from_iterator(gram.numbers.len(), gram.numbers.iter().map(|n| n.value));
    gram.b_here.dot(&v) + 0.5 * v.dot(&(&gram.g * &v))
}

fn places(numbers: &[Number], keep: impl Fn(&Number) -> bool) -> Vec<usize> {
    (0..numbers.len()).filter(|&i| keep(&numbers[i])).collect()
}

fn index(numbers: &[Number], id: Id) -> usize {
    numbers.iter().position(|n| n.id == id).unwrap_or(0)
}

fn place_of(effect: &Effect) -> Option<usize> {
    CATALOGUE.iter().position(|e| std::ptr::eq(*e, effect))
}

/// The model with a set's units as members at their estimates; random and declared members stay.
fn with_set(model: &Model, w: &Weighed, set: &Set, engine: &Engine) -> Model {
    let mut next = model.clone();
    next.members.retain(|m| m.random || m.declared);
    for &u in &set.units {
        let (family, form) = w.families[u];
        let mut member = match form {
            Some(form) => {
                let null = Member::null(CATALOGUE[family], &engine.campaign);
                let values = null.forms()[form].clone();
                Member { values, ..null }
            }
            None => match model.members.iter().find(|m| place_of(m.effect) == Some(family)) {
                Some(m) => m.clone(),
                None => continue,
            },
        };
        let strengths: Vec<usize> = member.strengths().collect();
        strengths.iter().for_each(|&i| member.values[i] = 0.0);
        for (c, estimate) in set.columns.iter().zip(&set.estimates) {
            if !w.units[u].columns.contains(c) {
                continue;
            }
            if let Id::Strength(_, _, i) | Id::Member(_, i) = w.gram.numbers[*c].id {
                member.values[i] = *estimate;
            }
        }
        next.members.push(member);
    }
    // What every set has moves with the set.
    let joint: Vec<usize> = w.base.iter().copied().chain(set.columns.iter().map(|&c| w.others[c])).collect();
    if let Some(p) = w.whole.posterior(&joint) {
        for (&place, mean) in w.base.iter().zip(p.mean.iter()) {
            let n = &w.whole.numbers[place];
            if !matches!(n.id, Id::Member(..)) {
                next.change(n, mean - n.value);
            }
        }
    }
    next
}

/// Fits a set in full and weighs all sets again, until the set stays.
fn polish(engine: &Engine, mut model: Model, floor: f64, log: &mut Vec<String>) -> Option<(Fit, Weighed)> {
    let mut seen: Vec<(String, Fit)> = Vec::new();
    for round in 0..ROUNDS {
        let mut fit = climb_down(engine, &model)?;
        if !crate::engine::random_numbers(&fit.model).is_empty() {
            fit = engine.settle_random(&fit, if round == 0 { 5 } else { 2 });
            fit = without_idle(engine, fit);
        }
        fit = engine.climb(&fit.model, true, 10).ok()?;
        let w = weighed(engine, &fit.model)?;
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
        let settled = a == b && same_forms(&again, &fit.model) || seen.iter().any(|(k, _)| *k == a && a != b);
        seen.push((key, fit.clone()));
        if settled || round + 1 == ROUNDS {
            // Of the sets that were visited in a circle, the best.
            let (_, best) = seen
                .into_iter()
                .max_by(|x, y| (x.1.total - cost_of(&x.1.model, engine)).total_cmp(&(y.1.total - cost_of(&y.1.model, engine))))?;
            let w = weighed(engine, &best.model)?;
            return Some((best, w));
        }
        model = again;
    }
    None
}

fn names(model: &Model) -> String {
    let mut all: Vec<&str> = model.members.iter().map(|m| m.effect.family).collect();
    all.sort_unstable();
    all.join("+")
}

fn same_forms(a: &Model, b: &Model) -> bool {
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
fn climb_down(engine: &Engine, model: &Model) -> Option<Fit> {
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

/// Random members that bring less than they cost are taken out.
fn without_idle(engine: &Engine, fit: Fit) -> Fit {
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
fn declared_alone(engine: &Engine, declared: &Model, after: &Fit) -> Result<Fit, String> {
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

/// Families of each set, merged over forms, best first.
fn named(w: &Weighed, model: &Model) -> Vec<(Vec<&'static str>, f64)> {
    let random: Vec<&'static str> = model.members.iter().filter(|m| m.random && !m.declared).map(|m| m.effect.family).collect();
    let mut all: Vec<(Vec<&'static str>, f64)> = Vec::new();
    for set in &w.sets {
        let mut f: Vec<&'static str> =
            set.units.iter().map(|&u| CATALOGUE[w.families[u].0].family).chain(random.iter().copied()).collect();
        f.sort_unstable();
        match all.iter_mut().find(|(k, _)| *k == f) {
            Some((_, gain)) => {
                let (a, b) = (gain.max(set.gain), gain.min(set.gain));
                *gain = a + (b - a).exp().ln_1p();
            }
            None => all.push((f, set.gain)),
        }
    }
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}
