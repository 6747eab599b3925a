//! discover: closing on tracks: flights of bodies without attitude, and of rigid ones whose pose was recorded. In: a campaign of tracks. Out: the closing, from a contest of sets of effects.
//!
//! Sets are fitted in full and weighed by their log marginal likelihood (Laplace's approximation, normal priors), grown, pruned and
//! swapped one family at a time until none is better. What every run has of its own - its initial state, a slow push, the drift of its
//! tracker - is part of the covariance, so that an effect must repeat from run to run; of one run alone what a steady push replaces is not named (`own_push`). A strength beyond what any body can have explains
//! nothing. Of runs held out nothing is used.

use super::chance::{p_least, p_value, p_value_of_best};
use super::checks;
use super::sets::beside;
use super::{
    After, CandidateLine, ChannelResidual, CheckLine, CheckedRuns, Closing, ConstantLine, EffectBound, EffectLine, Finding, Form,
    HeldOut, NoiseLine, Options, ParameterLine, SetLine, Shift, Sides, Verdict, lead, result, runs_of,
};
use crate::DiscoverError;
use crate::close::result::FormCheck;
use crate::tracks::{Free, Problem, TrackEvidence, TrackFit, TrackModel};
use windfall_model::{Acts, Campaign, Measured, Plant, Use};
use windfall_pid::{NORMAL_95, StopReason};
use windfall_replay::ReplayError;

mod amounts;
mod contest;
mod flown;
mod instead;
mod own_push;
mod settings;

use contest::{ScoredSet, TrackContest};
use settings::Settings;

/// Odds below which another family is a rival.
const RIVAL: f64 = 20.0;

/// Closes the loop of a campaign of tracks.
///
/// # Errors
/// No run to identify on, runs too short, or a declared model that cannot be flown.
pub(super) fn close(campaign: &Campaign, options: &Options) -> Result<Closing, DiscoverError> {
    let indices = runs_of(campaign, Use::Identify);
    if indices.is_empty() {
        return Err(ReplayError::NoRuns { what: "identify" }.into());
    }
    let settings = Settings::of(campaign, &indices);
    let own = settings.standardised(campaign);
    let other = |used: Use| {
        let runs = runs_of(&own, used);
        (!runs.is_empty()).then(|| TrackEvidence::new(&own, &runs, &own.plant)).transpose()
    };
    let (held, select) = (other(Use::HoldOut)?, other(Use::Select)?);
    let (found, aside) = own_push::set_aside(TrackContest::new(&own, &settings, &indices, select.as_ref())?.run()?);
    let (start, best) = (&found.declared.fit, &found.best.fit);
    let unexplained_of = |left: &[ChannelResidual], fit: &TrackFit| {
        let beyond = p_least(left) < options.false_alarm;
        if beyond { lead::describe(&own, &found.evidence, fit, left, options) } else { Vec::new() }
    };
    let residual = found.channels(start);
    let left = found.channels(best);
    let mut unexplained = unexplained_of(&left, best);
    let checks = checked(&found, held.as_ref(), &left, unexplained.is_empty());
    unexplained.extend(checks::said(&checks, CheckedRuns::HoldOut));
    let worst = left.iter().min_by(|a, b| a.p_value.total_cmp(&b.p_value)).map_or("", |c| c.channel.as_str());
    unexplained.extend(checks::said_of_all(&checks, worst));
    let effects: Vec<EffectLine> = (0..found.best.families.len())
        .map(|k| effect_line(&found, &settings, k, unexplained.is_empty(), held.as_ref(), p_least(&left)))
        .collect();
    unexplained.extend(own_push::described(&aside, &left));
    let plant = |fit: &TrackFit| outward_plant(campaign, &settings, fit);
    let sides = Some(Sides { before: plant(start), after: (!effects.is_empty()).then(|| plant(best)) });
    let sets = sets(&found);
    Ok(Closing {
        campaign: campaign.name.clone(),
        verdict: Verdict::of(&effects, &unexplained),
        finding: Finding::default(),
        checks,
        declared_departs: None,
        noise_is_scatter: found.evidence.chance_of_noise(&best.residual).is_some_and(|p| p < checks::LEVEL),
        not_named: beside(&sets, &effects, |family| own_push::reason(&aside, family)),
        joined: Vec::new(),
        record: Vec::new(),
        bandwidth: Vec::new(),
        unfinished_passes: None,
        errors_carry_unexplained: false,
        residual: result::Residuals { per_channel: residual },
        noise: noise(&found, campaign, &left),
        residual_after: result::Residuals { per_channel: left },
        innovations: Vec::new(),
        constants: constants(&own, best),
        sets,
        effects,
        candidates: candidates(&found),
        bounds: bounds(&found, &settings),
        unexplained,
        shifts: Shift::between(parameter_lines(campaign, start), parameter_lines(campaign, best)),
        instead: instead::of(&found),
        before: side(&own, start, held.as_ref()),
        after: side(&own, best, held.as_ref()),
        wind_tunnel: Vec::new(),
        false_alarm_rate: options.false_alarm,
        sides,
    })
}

/// Absolute checks: every channel of the runs identified on as it was judged, every channel of the runs held out, whether those ask for other
/// parameters, and whether they are likelier with the effects.
fn checked(
    found: &TrackContest<'_>,
    held: Option<&TrackEvidence>,
    left: &[ChannelResidual],
    nothing_left: bool,
) -> Vec<CheckLine> {
    let mut own = checks::of_channels(CheckedRuns::Identify, left);
    let least = left.iter().map(|c| c.p_value).fold(1.0, f64::min);
    own.iter_mut().for_each(|c| c.ok = nothing_left || c.p_value > least);
    let Some(held) = held else { return own };
    let (fit, problem) = (&found.best.fit, problem(found.campaign, held));
    let mut others = match problem.of_others(fit) {
        Some((z, moved_p_value)) => {
            let mut all = checks::of_channels(CheckedRuns::HoldOut, &held.channel_residuals(&z, 0));
            all.push(checks::of_all(CheckedRuns::HoldOut, checks::PARAMETERS, moved_p_value));
            all
        }
        // A model that cannot be flown there leaves anything but noise.
        None => left.iter().take(1).map(|c| checks::of_all(CheckedRuns::HoldOut, &c.channel, 0.0)).collect(),
    };
    checks::hold(&mut others);
    let gain = problem.predictive(fit) - problem.predictive(&found.declared.fit);
    others.extend(Some(gain).filter(|g| !g.is_nan() && !found.best.families.is_empty()).map(checks::of_gain));
    own.into_iter().chain(others).collect()
}

impl TrackContest<'_> {
    fn channels(&self, fit: &TrackFit) -> Vec<ChannelResidual> {
        self.evidence.channel_residuals(&fit.residual, fit.free.len())
    }
    /// Every set that was weighed at the end, best first, with its probability among them.
    fn weighed(&self) -> Vec<(&ScoredSet, f64)> {
        let mut all: Vec<&ScoredSet> = self.neighbours.iter().chain([&self.best]).collect();
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        let top = all[0].score;
        let sum: f64 = all.iter().map(|s| (s.score - top).exp()).sum();
        all.into_iter().map(|s| (s, (s.score - top).exp() / sum)).collect()
    }
}

fn effect_line(
    found: &TrackContest<'_>,
    settings: &Settings,
    k: usize,
    nothing_left: bool,
    held: Option<&TrackEvidence>,
    p_left: f64,
) -> EffectLine {
    let fit = &found.best.fit;
    let place = found.best.place(k);
    let instance = &fit.hypothesis.effects[place];
    let effect = instance.effect;
    let without = found.without(k);
    let gain = |h: &TrackEvidence| {
        let problem = problem(found.campaign, h);
        without.map(|w| problem.predictive(fit) - problem.predictive(&w.fit))
    };
    EffectLine {
        by_run: Vec::new(),
        family: effect.family.to_owned(),
        parameters: settings
            .outward(fit, place)
            .into_iter()
            .zip(instance.parameters.iter().zip(&instance.values))
            .map(|((value, std), (p, v))| ParameterLine::of_effect(p, value, std, p.is_at_end(*v)))
            .collect(),
        flown: flown::coefficients(found, settings, place),
        p_value: chance(found, k),
        probability: Some(found.weighed().iter().filter(|(s, _)| s.has(effect)).map(|(_, p)| p).sum::<f64>().min(1.0)),
        rivals: rivals(found, k),
        form: Some(Form {
            ok: nothing_left,
            checks: vec![FormCheck { what: "what is left along the worst axis is noise".to_owned(), p_value: p_left }],
        }),
        bursts: None,
        steep_edges: false,
        held_out_gain: held.and_then(gain),
        physics: effect.physics.to_owned(),
        source: effect.source.to_owned(),
        separate_by: effect.separate_by.to_owned(),
    }
}

/// Chance of such a gain of likelihood over the set without a family from noise alone, anywhere in the catalogue, as few runs allow it.
fn chance(found: &TrackContest<'_>, k: usize) -> f64 {
    let Some(without) = found.without(k) else { return f64::NAN };
    let (fit, place) = (&found.best.fit, found.best.place(k));
    let n = contest::numbers_of(fit, place);
    let gain = 2.0 * (fit.log_likelihood - without.fit.log_likelihood) * found.factor(n);
    p_value(gain, n, found.families.len())
}

/// Families that take this one's place at odds of less than twenty.
fn rivals(found: &TrackContest<'_>, k: usize) -> Vec<String> {
    let mut rest = found.best.families.clone();
    let own = rest.remove(k);
    let swapped = |s: &&ScoredSet| {
        s.families.len() == rest.len() + 1 && !s.families.contains(&own) && rest.iter().all(|f| s.families.contains(f))
    };
    let mut all: Vec<(f64, String)> = found
        .neighbours
        .iter()
        .filter(swapped)
        .filter(|s| found.best.score - s.score < RIVAL.ln())
        .filter_map(|s| Some((s.score, found.family_name(*s.families.iter().find(|f| !rest.contains(f))?))))
        .collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, name)| name).collect()
}

fn sets(found: &TrackContest<'_>) -> Vec<SetLine> {
    let line = |(s, probability): (&ScoredSet, f64)| SetLine {
        families: s.families.iter().map(|f| found.family_name(*f)).collect(),
        probability,
    };
    found.weighed().into_iter().filter(|(_, p)| *p > 1e-3).map(line).collect()
}

/// What every family alone brings to the declared model.
fn candidates(found: &TrackContest<'_>) -> Vec<CandidateLine> {
    let mut all: Vec<CandidateLine> = found
        .singles
        .iter()
        .map(|s| {
            let n = contest::numbers_of(&s.fit, s.place(0));
            let score = 2.0 * (s.fit.log_likelihood - found.declared.fit.log_likelihood) * found.factor(n);
            CandidateLine {
                family: found.family_name(s.families[0]),
                score,
                p_value: p_value_of_best(p_value(score, n, 1), found.families.len()),
            }
        })
        .collect();
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    all
}

/// How large each strength that was not found could still be, beside the best set.
fn bounds(found: &TrackContest<'_>, settings: &Settings) -> Vec<EffectBound> {
    let added = found.neighbours.iter().filter(|s| s.families.len() == found.best.families.len() + 1);
    added
        .flat_map(|s| {
            let place = s.fit.hypothesis.effects.len() - 1;
            let instance = &s.fit.hypothesis.effects[place];
            settings
                .outward(&s.fit, place)
                .into_iter()
                .zip(&instance.parameters)
                .filter(|((_, std), _)| std.is_finite())
                .map(|((value, std), p)| EffectBound {
                    family: instance.effect.family.to_owned(),
                    parameter: p.name.clone(),
                    upper95: (value.abs() + NORMAL_95 * std).min(p.high),
                    unit: p.unit.to_owned(),
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

fn noise(found: &TrackContest<'_>, campaign: &Campaign, left: &[ChannelResidual]) -> Vec<NoiseLine> {
    let place = |c: &ChannelResidual| campaign.measured().names().iter().position(|n| *n == c.channel);
    left.iter()
        .map(|c| NoiseLine {
            channel: c.channel.clone(),
            declared_std: place(c).map_or(f64::NAN, |a| found.evidence.stds(a)[0]),
            learnt_std: place(c).map_or(f64::NAN, |a| found.evidence.stds(a)[1]),
            colour: 0.0,
            coloured_share: 0.0,
            lines_hz: Vec::new(),
            missing: 0,
            outliers: 0,
        })
        .collect()
}

fn constants(campaign: &Campaign, fit: &TrackFit) -> Vec<ConstantLine> {
    fit.hypothesis
        .constants
        .iter()
        .enumerate()
        .map(|(i, (c, departure))| {
            let declared = c.value(&campaign.plant).unwrap_or(0.0);
            ConstantLine {
                key: c.name(),
                declared,
                uncertainty: c.std,
                estimate: declared + departure,
                std_error: Some(fit.std_error(Free::Constant(i))).filter(|s| s.is_finite()),
                unit: c.unit.to_owned(),
            }
        })
        .collect()
}

/// The plant of a fit, its effects following the run inputs in the campaign's own units.
fn outward_plant(campaign: &Campaign, settings: &Settings, fit: &TrackFit) -> Plant {
    let mut own = fit.hypothesis.clone();
    for k in 0..own.effects.len() {
        own.effects[k].values = settings.outward(fit, k).into_iter().map(|(value, _)| value).collect();
    }
    own.plant(&campaign.plant)
}

/// Parameters and errors on runs held out.
fn side(campaign: &Campaign, fit: &TrackFit, held: Option<&TrackEvidence>) -> After {
    let of = |h: &TrackEvidence| {
        let log_likelihood = Some(problem(campaign, h).predictive(fit));
        let plant = fit.hypothesis.plant(&campaign.plant);
        if campaign.measured() == Measured::Pose {
            return HeldOut::of_poses(h.pose_rms(&plant), h.pose_rms_of_noise(&plant), log_likelihood);
        }
        let of_points = HeldOut::of_points(campaign.measured(), h.rms_m(&plant), plant.point.pivot, log_likelihood);
        match campaign.measured() {
            Measured::PositionAndForce => of_points.with_specific_force(h.rms_m_s2(&plant)),
            _ => of_points,
        }
    };
    After { parameters: parameter_lines(campaign, fit), hold_out: held.map(of) }
}

/// Families that a body without attitude may have.
fn catalogue(body: Acts) -> impl Iterator<Item = &'static windfall_model::Effect> {
    windfall_model::CATALOGUE.into_iter().filter(move |e| e.acts.on(body))
}

/// The declared model, with declared effects and uncertain constants.
fn declared(campaign: &Campaign, settings: &Settings, generic: usize) -> TrackModel {
    let effects = campaign.knowledge.effects.iter().map(|(e, v)| settings.inward(settings.null(e, campaign), v)).collect();
    TrackModel {
        declared: campaign.plant.aero.values.clone(),
        priors: priors(campaign),
        constants: campaign.knowledge.constants.iter().map(|c| (*c, 0.0)).collect(),
        effects,
        generic: vec![0.0; generic],
        scatter: None,
    }
}

/// Priors of the parameters that are fitted.
fn priors(campaign: &Campaign) -> Vec<(usize, f64, f64)> {
    let known = campaign.knowledge.priors.iter().filter(|(i, _)| campaign.declared[*i]);
    known.map(|(i, std)| (*i, campaign.plant.aero.values[*i], *std)).collect()
}

fn problem<'a>(campaign: &'a Campaign, evidence: &'a TrackEvidence) -> Problem<'a> {
    Problem { evidence, base: &campaign.plant, declared: &campaign.declared }
}

/// A fit, noise measured at it, fitted again.
fn settled_fit(campaign: &Campaign, evidence: &mut TrackEvidence, start: TrackModel) -> Result<TrackFit, DiscoverError> {
    let mut h = start;
    for round in 0..3 {
        let fit = problem(campaign, evidence).fit(&h, false);
        if !fit.log_likelihood.is_finite() {
            return Err(DiscoverError::Fit { campaign: campaign.name.clone(), stop: fit.stop });
        }
        h = fit.hypothesis.clone();
        if round == 2 {
            return Ok(fit);
        }
        evidence.settle(&h.plant(&campaign.plant));
    }
    Err(DiscoverError::Fit { campaign: campaign.name.clone(), stop: StopReason::Iterations })
}

fn parameter_lines(campaign: &Campaign, fit: &TrackFit) -> Vec<ParameterLine> {
    let structure = &campaign.plant.aero.structure;
    (0..structure.parameters.len())
        .filter(|&i| campaign.declared[i])
        .map(|i| {
            let f = Free::Declared(i);
            ParameterLine::of_declared(campaign, i, fit.hypothesis.get(f), fit.std_error(f))
        })
        .collect()
}

#[cfg(test)]
mod tests;
