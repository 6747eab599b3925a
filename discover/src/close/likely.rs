//! discover: closing on the one likelihood of tunnel runs. In: a campaign. Out: the closing, from what the search over sets of effects found.

use super::chance::p_value;
use super::checks;
use super::result::{ConstantLine, Form, FormCheck, NoiseLine, Residuals, RunValue};
use super::sets::{Told, contradicted, not_named, probability, rivals, sets, unsettled};
use super::{
    After, CandidateLine, ChannelResidual, CheckLine, CheckedRuns, Closing, EffectBound, EffectLine, Finding, HeldOut, Options,
    ParameterLine, Shift, Sides, Unexplained, Verdict, runs_of,
};
use crate::DiscoverError;
use statrs::distribution::{ContinuousCDF, Normal};
use windfall_likelihood::{Discovery, Engine, Fit, Id, Lead, Member, NOISE_KNOWN, OfRun, discover};
use windfall_model::{CATALOGUE, CHANNEL_NAMES, Campaign, Data, Effect, POSE, Plant, Role, RunNumber, RunScatter, Use};
use windfall_pid::NORMAL_95;
use windfall_pid::bandwidth::bandwidth_lines;
use windfall_replay::{ReplayError, hold_out};

/// Gain, in nats beyond its cost, from which a generic alternative says that something is unexplained, and from which a line of the
/// instrument's is listed.
const LEAD: f64 = 4.0;

/// Closes the loop of a campaign of tunnel runs.
///
/// # Errors
/// No run to identify on, or a declared model that no search can follow.
pub(super) fn close(campaign: &Campaign, options: &Options) -> Result<Closing, DiscoverError> {
    let indices = runs_of(campaign, Use::Identify);
    let mut engine = Engine::new(campaign, &indices).ok_or(ReplayError::NoRuns { what: "identify" })?;
    let found = discover(&mut engine).map_err(|words| DiscoverError::NoEnd { campaign: campaign.name.clone(), words })?;
    let held = runs_of(campaign, Use::HoldOut);
    let after = &found.after;
    let contradicted = contradicted(&found);
    let mut unexplained = unexplained(&found, &contradicted, &engine, options);
    let before = found.before.as_ref().unwrap_or(after);
    let plants = [before, after].map(|fit| fit.model.plant(engine.campaign()));
    let of = |fit, plant| side(campaign, &engine, fit, plant, &held, options);
    let (side_before, side_after) = (of(before, &plants[0]), of(after, &plants[1]));
    let held_out_gain = held_out_gain(&side_before, &side_after).filter(|_| after.model.members.iter().any(|m| !m.declared));
    let checks = checked(&engine, &found, &held, held_out_gain);
    if unexplained.is_empty() {
        unexplained.extend(checks::said(&checks, CheckedRuns::Identify));
    }
    unexplained.extend(checks::said(&checks, CheckedRuns::HoldOut));
    unexplained.extend(checks::said_of_all(&checks, worst_channel(&found)));
    let told = Told::of(&found, &engine, unexplained.is_empty());
    let is_named = |m: &Member| {
        let family = m.effect.family;
        !m.declared && !found.stand_ins.contains(&family) && !contradicted.contains(&family) && told.stands(family)
    };
    let named = after.model.members.iter().enumerate().filter(|(_, m)| is_named(m));
    let mut effects: Vec<EffectLine> = named.map(|(k, m)| effect_line(k, m, &found, &engine, &told, held_out_gain)).collect();
    for e in &mut effects {
        e.rivals.extend(super::roll_zero::rivals(campaign, &engine, &indices, &found, &e.family));
    }
    let [plant_before, plant_after] = plants;
    let sides = Some(Sides { before: plant_before, after: (!effects.is_empty()).then_some(plant_after) });
    let sets = sets(&told.sets);
    Ok(Closing {
        campaign: campaign.name.clone(),
        verdict: Verdict::of(&effects, &unexplained),
        finding: Finding::default(),
        checks,
        declared_departs: found.before_fault.clone().err(),
        noise_is_scatter: false,
        not_named: not_named(&found, &told, &contradicted, &effects),
        joined: engine.joined(campaign),
        record: Vec::new(),
        bandwidth: bandwidth_lines(campaign),
        unfinished_passes: found.unfinished_passes,
        errors_carry_unexplained: found.errors_carry_missing,
        residual: Residuals { per_channel: channels(before) },
        residual_after: Residuals { per_channel: channels(after) },
        noise: noise(campaign, &engine, &indices, &found),
        innovations: super::innovations::lines(&engine, &before.model, &after.model),
        constants: constants(engine.campaign(), after),
        sets,
        candidates: candidates(&found),
        bounds: bounds(&found),
        unexplained,
        shifts: Shift::between(parameters(campaign, before), parameters(campaign, after)),
        instead: Vec::new(),
        before: side_before,
        after: side_after,
        effects,
        wind_tunnel: Vec::new(),
        false_alarm_rate: options.false_alarm,
        sides,
    })
}

/// What a member's numbers are in each run, those that differ from run to run.
fn by_run(m: &Member, fit: &Fit, engine: &Engine) -> Vec<RunValue> {
    let plant = &engine.campaign().plant;
    let mut own = Plant { scatter: RunScatter::default(), ..plant.clone() };
    (m.effect.apply)(&mut own, &m.values);
    let numbers: Vec<RunNumber> = own.scatter.numbers().into_iter().map(|(number, _)| number).collect();
    if numbers.is_empty() {
        return Vec::new();
    }
    let parameters = &plant.aero.structure.parameters;
    let one = |of: OfRun| {
        let (name, unit) = match of.number {
            RunNumber::Mass => ("mass".to_owned(), "-"),
            RunNumber::Attachment(axis) => (format!("attachment {}", ["x", "y", "z"][axis.min(2)]), "m"),
            RunNumber::Aero(place) => (parameters.get(place).cloned().unwrap_or_default(), "-"),
        };
        let run = engine.campaign().runs.get(of.run).map_or_else(String::new, |r| r.name.clone());
        RunValue { run, name, unit: unit.to_owned(), value: of.value, std_error: of.std }
    };
    engine.by_run(fit).into_iter().filter(|of| numbers.contains(&of.number)).map(one).collect()
}

/// Unit of a channel of the pose in reports over SI: degrees of angles.
fn shown(channel: usize, x: f64) -> f64 {
    if (3..6).contains(&channel) { x.to_degrees() } else { x }
}

fn channels(fit: &Fit) -> Vec<ChannelResidual> {
    let normal = Normal::standard();
    fit.channels
        .iter()
        .enumerate()
        .map(|(c, [found, expected, ratio, count])| ChannelResidual {
            channel: CHANNEL_NAMES[c].to_owned(),
            rms: shown(c, found.sqrt()),
            expected_rms: shown(c, expected.sqrt()),
            p_value: normal.sf((ratio - 1.0) / (2.0 / count.max(1.0) + NOISE_KNOWN * NOISE_KNOWN).sqrt()),
        })
        .collect()
}

fn noise(campaign: &Campaign, engine: &Engine, indices: &[usize], found: &Discovery) -> Vec<NoiseLine> {
    let declared = windfall_likelihood::declared_noise(&campaign.plant.sensors);
    let bridged = |i: &usize| match &campaign.runs[*i].data {
        Data::Tunnel(r) => r.bridged.iter().filter(|b| **b).count(),
        Data::Point(_) => 0,
    };
    let missing = indices.iter().map(bridged).sum();
    (0..CHANNEL_NAMES.len())
        .map(|c| {
            let n = engine.noise[c];
            NoiseLine {
                channel: CHANNEL_NAMES[c].to_owned(),
                declared_std: shown(c, declared[c].std()),
                learnt_std: shown(c, n.std()),
                colour: if n.coloured > 0.0 { n.correlation } else { 0.0 },
                coloured_share: n.coloured / (n.coloured + n.white),
                lines_hz: lines_of(c, found, engine),
                missing,
                outliers: found.outliers.get(c).copied().unwrap_or(0),
            }
        })
        .collect()
}

/// Frequencies of an instrument's lines in a channel, of all runs, ascending, one for each twentieth of a Hz.
fn lines_of(channel: usize, found: &Discovery, engine: &Engine) -> Vec<f64> {
    let mine = found.lines.iter().filter(|l| l.of_instrument && l.gain > LEAD && l.channel == CHANNEL_NAMES[channel]);
    let left = mine.filter_map(|l| l.line_hz);
    let off = engine.hum.iter().filter(|h| h.channel == channel).map(|h| h.hz);
    let mut all: Vec<f64> = left.chain(off).map(|hz| (20.0 * hz).round() / 20.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn constants(campaign: &Campaign, fit: &Fit) -> Vec<ConstantLine> {
    campaign
        .knowledge
        .constants
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let declared = c.value(&campaign.plant).unwrap_or(0.0);
            ConstantLine {
                key: c.name(),
                declared,
                uncertainty: c.std,
                estimate: declared + fit.model.constants[i],
                std_error: fit.std_error(Id::Constant(i)),
                unit: c.unit.to_owned(),
            }
        })
        .collect()
}

/// Channel of the pose whose innovations are left largest over noise.
fn worst_channel(found: &Discovery) -> &'static str {
    let channels = &found.after.channels;
    CHANNEL_NAMES[(0..POSE).max_by(|a, b| channels[*a][2].total_cmp(&channels[*b][2])).unwrap_or(0)]
}

fn effect_line(k: usize, m: &Member, found: &Discovery, engine: &Engine, told: &Told, held_out_gain: Option<f64>) -> EffectLine {
    let fit = &found.after;
    let family = m.effect.family;
    let parameters = m
        .parameters
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let random = found.random_ranges.iter().find(|range| range.place == (k, i));
            let std = random.map(|range| range.std).or_else(|| fit.std_error(Id::Member(k, i)));
            let value = random.map_or(m.values[i], |range| range.value);
            let line = ParameterLine::of_effect(p, value, std.unwrap_or(f64::NAN), p.is_at_end(value));
            ParameterLine { ci95: random.map(|range| range.ci95).or(line.ci95), ..line }
        })
        .collect();
    let gust = m.random && engine.moves_air(m);
    let strongest = found.contest.as_ref().map_or(f64::NEG_INFINITY, |c| c.strongest);
    EffectLine {
        family: family.to_owned(),
        parameters,
        flown: Vec::new(),
        p_value: p_of(k, m, found),
        probability: Some(probability(&told.sets, family)),
        rivals: rivals(&told.sets, family),
        form: Some(Form {
            ok: told.is_explained,
            checks: std::iter::once(("the best of all generic alternatives", -strongest))
                .chain(held_out_gain.map(|gain| ("the held-out runs, with the effects over without", gain)))
                .map(|(what, gain)| FormCheck { what: what.to_owned(), p_value: gain.exp().min(1.0) })
                .collect(),
        }),
        held_out_gain: None,
        by_run: by_run(m, fit, engine),
        steep_edges: gust && engine.has_steep_edges(m),
        bursts: if gust { engine.bursts() } else { None },
        physics: m.effect.physics.to_owned(),
        source: m.effect.source.to_owned(),
        separate_by: m.effect.separate_by.to_owned(),
    }
}

/// Chance of strengths this many standard errors from null anywhere in the catalogue (Wald's statistic, Šidák's correction); of random
/// inputs by the gain of likelihood.
fn p_of(k: usize, m: &Member, found: &Discovery) -> f64 {
    let fit = &found.after;
    let families = CATALOGUE.len();
    if m.random {
        let gain = found.random_gains.iter().find(|g| g.0 == k).map_or(0.0, |g| g.1);
        return p_value(2.0 * gain, m.values.len(), families);
    }
    let places: Vec<usize> = (0..fit.numbers.len())
        .filter(|&i| matches!(fit.numbers[i].id, Id::Member(j, p) if j == k && m.parameters[p].role == Role::Strength))
        .collect();
    let n = places.len();
    let covariance = nalgebra::DMatrix::from_fn(n, n, |i, j| fit.covariance[(places[i], places[j])]);
    let values = nalgebra::DVector::from_fn(n, |i, _| fit.numbers[places[i]].value);
    let statistic = covariance.cholesky().map_or(0.0, |c| values.dot(&c.solve(&values)));
    p_value(statistic, n, families)
}

/// What every family alone would bring beside what all sets have.
fn candidates(found: &Discovery) -> Vec<CandidateLine> {
    let mut all: Vec<CandidateLine> = Vec::new();
    for (unit, (family, _)) in found.units.iter().zip(&found.families) {
        let Some(posterior) = found.gram.posterior(&unit.columns) else { continue };
        let statistic = (0..unit.columns.len()).map(|i| posterior.mean[i] * found.gram.b[unit.columns[i]]).sum::<f64>();
        let line = CandidateLine {
            family: CATALOGUE[*family].family.to_owned(),
            score: statistic,
            p_value: p_value(statistic, unit.columns.len(), CATALOGUE.len()),
        };
        match all.iter_mut().find(|l| l.family == line.family) {
            Some(l) if l.score < line.score => *l = line,
            Some(_) => {}
            None => all.push(line),
        }
    }
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    all
}

/// How large each strength that was not found could still be, beside the best set: in the form that hides it best.
fn bounds(found: &Discovery) -> Vec<EffectBound> {
    let named: Vec<&'static str> = found.after.model.members.iter().map(|m| m.effect.family).collect();
    let present: Vec<usize> = found
        .units
        .iter()
        .zip(&found.families)
        .filter(|(_, (f, form))| form.is_none() && named.contains(&CATALOGUE[*f].family))
        .flat_map(|(u, _)| u.columns.iter().copied())
        .collect();
    let mut all: Vec<EffectBound> = Vec::new();
    for (unit, (family, _)) in found.units.iter().zip(&found.families) {
        let effect: &Effect = CATALOGUE[*family];
        if named.contains(&effect.family) {
            continue;
        }
        let places: Vec<usize> = present.iter().chain(&unit.columns).copied().collect();
        let Some(posterior) = found.gram.posterior(&places) else { continue };
        for (i, &place) in places.iter().enumerate().skip(present.len()) {
            let number = &found.gram.numbers[place];
            let Id::Strength(_, _, parameter) = number.id else { continue };
            let upper95 = (posterior.mean[i].abs() + NORMAL_95 * posterior.covariance[(i, i)].sqrt()).min(number.range[1]);
            let p = &(effect.parameters)(&[])[parameter];
            match all.iter_mut().find(|b| b.family == effect.family && b.parameter == p.name) {
                Some(b) => b.upper95 = b.upper95.max(upper95),
                None => all.push(EffectBound {
                    family: effect.family.to_owned(),
                    parameter: p.name.clone(),
                    upper95,
                    unit: p.unit.to_owned(),
                }),
            }
        }
    }
    all.extend(found.random_bounds.iter().map(|(family, parameter, upper95, unit)| EffectBound {
        family: (*family).to_owned(),
        parameter: parameter.clone(),
        upper95: *upper95,
        unit: unit.clone(),
    }));
    all
}

/// Generic alternatives that are in the best set, lines in the innovations, and what is left whatever it varies with.
fn unexplained(found: &Discovery, contradicted: &[&str], engine: &Engine, options: &Options) -> Vec<Unexplained> {
    let contested: &[Lead] = found.contest.as_ref().map_or(&[], |c| &c.leads);
    // Without faint gusts the same may stand out again.
    let said = |l: &Lead| contested.iter().any(|c| (&c.channel, &c.variable) == (&l.channel, &l.variable));
    let faint = found.faint.iter().filter(|l| !said(l));
    let leads = contested.iter().chain(faint).chain(found.lines.iter().find(|l| !l.of_instrument));
    let entry = |l: &Lead, other: Option<&Lead>| {
        let what = match l.line_hz {
            Some(hz) => format!("{} at {hz:.2} Hz, log-likelihood {:.0} above noise", l.variable, l.gain),
            None => {
                let sizes: Vec<String> = l.amplitudes.iter().map(|a| format!("{a:.2e}")).collect();
                let instead =
                    other.map_or_else(String::new, |o| format!(" in place of {} with {}, as likely", o.channel, o.variable));
                format!(
                    "varies with {}{instead} (a gain of {:.0} in log-likelihood beyond what any effect of the catalogue explains; \
                     amplitudes {})",
                    l.variable,
                    l.gain,
                    sizes.join(", ")
                )
            }
        };
        Unexplained { channel: l.channel.clone(), description: what }
    };
    let words = |l: &Lead| std::iter::once(entry(l, None)).chain(l.rivals.iter().map(|r| entry(r, Some(l)))).collect::<Vec<_>>();
    // Noise alone has a line as strong with probability e^-gain.
    let enough = |l: &&Lead| l.gain > if l.line_hz.is_some() { -options.false_alarm.ln() } else { LEAD };
    let mut all: Vec<Unexplained> = leads.filter(enough).flat_map(words).collect();
    if !contradicted.is_empty() && all.is_empty() {
        all.push(Unexplained { channel: worst_channel(found).to_owned(), description: unsettled(contradicted) });
    }
    if let Some(words) = &found.departs {
        all.push(Unexplained { channel: worst_channel(found).to_owned(), description: words.clone() });
    }
    if let Err(words) = &found.before_fault
        && all.is_empty()
        && found.after.model.members.is_empty()
    {
        all.push(Unexplained { channel: engine.first_run(), description: words.clone() });
    }
    all
}

/// By how much the held-out runs are likelier after than before; none where there are none.
fn held_out_gain(before: &After, after: &After) -> Option<f64> {
    let of = |side: &After| side.hold_out.as_ref()?.log_likelihood;
    Some(of(after)? - of(before)?)
}

/// Absolute checks of the model with the effects: every channel of every run identified on and held out, whether held-out runs ask for other
/// parameters, and whether they are likelier with the effects.
fn checked(engine: &Engine, found: &Discovery, held: &[usize], held_out_gain: Option<f64>) -> Vec<CheckLine> {
    let (after, ranges) = (&found.after, &found.random_ranges);
    let own = engine.mean_squares(&after.model, ranges).unwrap_or_default();
    let mut all = checks::of_squares(CheckedRuns::Identify, &own);
    match engine.of_others(after, held, ranges) {
        Some(Ok(others)) => {
            all.extend(checks::of_squares(CheckedRuns::HoldOut, &others.squares));
            all.push(checks::of_all(CheckedRuns::HoldOut, checks::PARAMETERS, others.moved_p_value));
        }
        // A model that departs in a run leaves anything but noise there.
        Some(Err(_)) => all.push(checks::of_all(CheckedRuns::HoldOut, worst_channel(found), 0.0)),
        None => {}
    }
    checks::hold(&mut all);
    all.extend(held_out_gain.map(checks::of_gain));
    all
}

fn parameters(campaign: &Campaign, fit: &Fit) -> Vec<ParameterLine> {
    let structure = &campaign.plant.aero.structure;
    (0..structure.parameters.len())
        .filter(|&i| campaign.declared[i])
        .map(|i| {
            let std = fit.std_error(Id::Declared(i)).unwrap_or(f64::NAN);
            ParameterLine::of_declared(campaign, i, fit.model.declared[i], std)
        })
        .collect()
}

/// Parameters and errors on held-out runs. Runs on which the model cannot be flown again have no trajectory.
fn side(campaign: &Campaign, engine: &Engine, fit: &Fit, plant: &Plant, held: &[usize], options: &Options) -> After {
    let flights = if plant.disturbances(1.0).is_empty() { 1 } else { options.flights };
    let hold_out = if held.is_empty() || options.flights == 0 {
        None
    } else {
        hold_out(campaign, plant, held, flights).ok().map(|h| HeldOut::of_tunnel(h, engine.predictive(fit, held)))
    };
    After { parameters: parameters(campaign, fit), hold_out }
}

#[cfg(test)]
mod tests;
