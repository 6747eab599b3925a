//! verify: the loop closed with measured data. In: a campaign and its declared model. Out: what the model lacks, its numbers,
//! and the error on held-out runs before and after.
//!
//! Residual → is it beyond noise → weigh every effect of the catalogue → add the best → identify everything again together →
//! again, until it is noise. Error rates are stated in [`Options`]; nothing here knows a family by name.

use crate::VerifyError;
use crate::resimulate::hold_out;
use crate::trace::{
    Candidate, Evidence, Fit, Free, Hypothesis, PointEvidence, Problem, StopReason, TunnelEvidence, acts, p_value, repeats, weigh,
};
use rayon::prelude::*;
use windfall_model::{Acts, CATALOGUE, Campaign, Plant, Use};

mod figures;
mod lead;
mod likely;
mod rehearse;
mod result;

pub use figures::{Figure, Role, Series, Topic, figures};
pub(crate) use likely::LEFT;
pub use result::{
    After, Bound, CandidateLine, ChannelResidual, Check, Closing, ConstantLine, EffectLine, Form, HeldOut, HeldOutTrajectory,
    NoiseLine, ParameterLine, SetLine, Shift, Unexplained, Verdict,
};

/// How effects are searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// One effect after another, on spectra of coefficients.
    Rounds,
    /// Sets of effects, by the one likelihood of what was measured; runs with attitude only.
    Sets,
}

/// Error rates and effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How effects are searched.
    pub search: Search,
    /// Chance of naming any effect in a campaign that has none, per round.
    pub false_alarm: f64,
    /// Odds below which a family that explains less is still a rival.
    pub rival_odds: f64,
    /// Most effects that are added.
    pub most_effects: usize,
    /// Noisy copies of the data: the final intervals are known to one in the square root of twice that.
    pub copies: usize,
    /// Families fitted in full per round.
    pub shortlist: usize,
    /// Seed of the copies.
    pub seed: u64,
    /// Flights of each held-out run when the model has random inputs; 0: held-out runs are not flown again.
    pub flights: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            search: Search::Sets,
            false_alarm: 0.005,
            rival_odds: 20.0,
            most_effects: 4,
            copies: 48,
            shortlist: 6,
            seed: 1,
            flights: 8,
        }
    }
}

/// One added effect with what spoke for it.
struct Added {
    p_value: f64,
    rivals: Vec<String>,
    held_out_gain: Option<f64>,
}

/// Evidence of the runs of one use.
fn evidence(campaign: &Campaign, indices: &[usize], plant: &Plant, options: &Options) -> Result<Box<dyn Evidence>, VerifyError> {
    Ok(if campaign.is_point_mass() {
        Box::new(PointEvidence::new(campaign, indices, plant)?)
    } else {
        Box::new(TunnelEvidence::new(campaign, indices, plant, options.copies, options.seed)?)
    })
}

fn runs_of(campaign: &Campaign, used: Use) -> Vec<usize> {
    (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == used).collect()
}

/// Closes the loop of a campaign.
///
/// # Errors
/// A record that is not what its campaign says it is, no run to identify on, runs too short, or a declared model that cannot be fitted.
pub fn close(campaign: &Campaign, options: &Options) -> Result<Closing, VerifyError> {
    windfall_pid::plausible::plausible(campaign)?;
    if campaign.is_point_mass() || options.search == Search::Rounds {
        close_by_rounds(campaign, options)
    } else {
        likely::close(campaign, options)
    }
}

/// Closing by rounds: the only way for flights without attitude.
fn close_by_rounds(campaign: &Campaign, options: &Options) -> Result<Closing, VerifyError> {
    let indices = runs_of(campaign, Use::Identify);
    if indices.is_empty() {
        return Err(VerifyError::NoRuns { what: "identify" });
    }
    let mut proof = evidence(campaign, &indices, &campaign.plant, options)?;
    let start = declared_fit(campaign, proof.as_mut())?;
    let held = runs_of(campaign, Use::HoldOut);
    let mut held_proof = if held.is_empty() { None } else { Some(evidence(campaign, &held, &campaign.plant, options)?) };
    if let Some(h) = held_proof.as_mut() {
        h.settle(&start.hypothesis.plant(&campaign.plant));
    }
    let body = acts(campaign.is_point_mass());
    let residual = channels(&problem(campaign, proof.as_ref()), &start);
    let mut fit = start.clone();
    let mut added: Vec<Added> = Vec::new();
    let mut first: Option<Vec<Candidate>> = None;
    let weighed = loop {
        let weighed = weigh(&problem(campaign, proof.as_ref()), &fit, body);
        first.get_or_insert_with(|| weighed.clone());
        if added.len() >= options.most_effects {
            break weighed;
        }
        let Some((next, why)) = round(&problem(campaign, proof.as_ref()), held_proof.as_deref(), &fit, &weighed, body, options)
        else {
            break weighed;
        };
        added.push(why);
        // Noise reaches the residual through the model, so it is measured again with the better one.
        let plant = next.hypothesis.plant(&campaign.plant);
        proof.settle(&plant);
        if let Some(h) = held_proof.as_mut() {
            h.settle(&plant);
        }
        fit = fitted(&problem(campaign, proof.as_ref()), &next.hypothesis);
    };
    if let Some(bias) = rehearse::bias(campaign, &indices, &fit, options) {
        for (f, b) in bias {
            let unbiased = fit.hypothesis.get(f) - b;
            fit.hypothesis.set(f, unbiased);
        }
    }
    let problem = problem(campaign, proof.as_ref());
    problem.calibrate(&mut fit);
    let before = side(campaign, &problem, held_proof.as_deref(), &held, &start, options)?;
    let after = side(campaign, &problem, held_proof.as_deref(), &held, &fit, options)?;
    let left = channels(&problem, &fit);
    let beyond = |c: &[ChannelResidual]| p_least(c) < options.false_alarm;
    let unexplained = if beyond(&left) { lead::describe(campaign, proof.as_ref(), &fit, &left, options) } else { Vec::new() };
    let verdict = match (added.is_empty(), unexplained.is_empty()) {
        (false, _) => Verdict::Effect,
        (true, false) => Verdict::Unexplained,
        (true, true) => Verdict::Consistent,
    };
    Ok(Closing {
        campaign: campaign.name.clone(),
        verdict,
        residual: result::Residuals { per_channel: residual },
        residual_after: result::Residuals { per_channel: left },
        noise: Vec::new(),
        constants: Vec::new(),
        sets: Vec::new(),
        effects: effect_lines(&fit, &added),
        candidates: first.unwrap_or_default().iter().map(CandidateLine::of).collect(),
        bounds: bounds(&weighed, &problem, &fit),
        unexplained,
        shifts: shifts(campaign, &start, &fit),
        before,
        after,
        false_alarm_rate: options.false_alarm,
    })
}

fn problem<'a>(campaign: &'a Campaign, evidence: &'a dyn Evidence) -> Problem<'a> {
    Problem { evidence, base: &campaign.plant, declared: &campaign.declared, inputs: &campaign.inputs }
}

/// Evidence of a campaign's runs to identify on and the fit of its declared model, for those who look beneath the loop.
///
/// # Errors
/// As [`close`].
pub fn declared(campaign: &Campaign, options: &Options) -> Result<(Box<dyn Evidence>, Fit), VerifyError> {
    let mut proof = evidence(campaign, &runs_of(campaign, Use::Identify), &campaign.plant, options)?;
    let fit = declared_fit(campaign, proof.as_mut())?;
    Ok((proof, fit))
}

/// Declared model alone: fitted, noise measured at the fit, fitted again.
fn declared_fit(campaign: &Campaign, proof: &mut dyn Evidence) -> Result<Fit, VerifyError> {
    let generic = vec![0.0; proof.generic().len()];
    let mut h = Hypothesis { declared: campaign.plant.aero.values.clone(), effects: Vec::new(), generic };
    for round in 0..3 {
        let fit = problem(campaign, proof).fit(&h, false);
        if !fit.log_likelihood.is_finite() {
            return Err(VerifyError::Fit { campaign: campaign.name.clone(), reason: fit.stop.words() });
        }
        h = fit.hypothesis.clone();
        if round == 2 {
            return Ok(fit);
        }
        proof.settle(&h.plant(&campaign.plant));
    }
    Err(VerifyError::Fit { campaign: campaign.name.clone(), reason: "no fit was made" })
}

/// All numbers fitted together; shapes stay as they are when freeing them does not settle on something better.
fn fitted(problem: &Problem<'_>, h: &Hypothesis) -> Fit {
    let free = problem.fit(h, true);
    if free.stop == StopReason::Converged && free.log_likelihood.is_finite() {
        return free;
    }
    let held = problem.fit(h, false);
    if held.log_likelihood > free.log_likelihood || !free.log_likelihood.is_finite() { held } else { free }
}

/// One round: the best family that is beyond noise and holds on runs not used.
fn round(
    problem: &Problem<'_>,
    held: Option<&dyn Evidence>,
    fit: &Fit,
    weighed: &[Candidate],
    body: Acts,
    options: &Options,
) -> Option<(Fit, Added)> {
    let families = CATALOGUE.iter().filter(|e| e.acts == body).count();
    let rare = |p: f64| p_value_of_best(p, families) < options.false_alarm;
    let strongest = weighed.iter().map(|c| c.statistic).fold(0.0, f64::max);
    let short: Vec<&Candidate> =
        weighed.iter().filter(|c| rare(c.p_value) && c.statistic > SHORTLIST_SHARE * strongest).take(options.shortlist).collect();
    let numbers = (problem.evidence.samples() as f64).ln();
    let mut fits: Vec<(f64, f64, Fit, &Candidate)> = short
        .into_par_iter()
        .filter_map(|c| {
            let mut h = fit.hypothesis.clone();
            h.effects.push(c.instance.clone());
            let full = fitted(problem, &h);
            let gain = problem.gain(fit, &full);
            let own = full.hypothesis.effects.len() - 1;
            let plausible = full.hypothesis.effects[own].is_plausible();
            let parameters = if problem.evidence.witnesses().is_some() { c.degrees } else { c.instance.parameters.len() };
            let penalty = 0.5 * parameters as f64 * numbers;
            let p = p_value(2.0 * gain * repeats(problem, fit, c.degrees), c.degrees, c.tried);
            let told = problem.evidence.tells(&fit.residual, &full.residual);
            (gain.is_finite() && plausible && told && rare(p)).then_some((gain - penalty, p, full, c))
        })
        .collect();
    fits.sort_by(|a, b| b.0.total_cmp(&a.0));
    let confirmed = |f: &Fit, c: &Candidate| held.filter(|_| !c.instance.is_local()).map(|h| held_gain(problem, h, fit, f));
    let (position, held_out_gain) =
        fits.iter().enumerate().map(|(i, (_, _, f, c))| (i, confirmed(f, c))).find(|(_, gain)| gain.is_none_or(|g| g > 0.0))?;
    let (best, p, ..) = fits[position];
    let least = best - options.rival_odds.ln();
    let rivals = fits
        .iter()
        .enumerate()
        .filter(|(i, f)| *i != position && f.0 > least)
        .map(|(_, f)| f.3.instance.effect.family.to_owned())
        .collect();
    let p_value = p_value_of_best(p, families);
    Some((fits.swap_remove(position).2, Added { p_value, rivals, held_out_gain }))
}

/// A family is fitted in full when it explains at least this share of what the best explains.
const SHORTLIST_SHARE: f64 = 0.2;

/// Probability that the best of several families does so well by chance (Šidák 1967).
fn p_value_of_best(p: f64, families: usize) -> f64 {
    -f64::exp_m1(families as f64 * f64::ln_1p(-p.min(1.0 - 1e-16)))
}

/// Gain of log-likelihood on runs that were not used, all numbers as identified.
fn held_gain(problem: &Problem<'_>, held: &dyn Evidence, over: &Fit, fit: &Fit) -> f64 {
    let other = Problem { evidence: held, base: problem.base, declared: problem.declared, inputs: problem.inputs };
    other.predicted_gain(&over.hypothesis, &fit.hypothesis)
}

fn side(
    campaign: &Campaign,
    problem: &Problem<'_>,
    held: Option<&dyn Evidence>,
    indices: &[usize],
    fit: &Fit,
    options: &Options,
) -> Result<After, VerifyError> {
    let plant = fit.hypothesis.plant(problem.base);
    let log_likelihood = held.map(|h| {
        let other = Problem { evidence: h, base: problem.base, declared: problem.declared, inputs: problem.inputs };
        other.predict(&fit.hypothesis)
    });
    let random = !plant.disturbances(1.0).is_empty();
    let hold_out = match (held, campaign.is_point_mass()) {
        (None, _) => None,
        (Some(h), true) => Some(HeldOut::of_points(h.rms_m(&plant), log_likelihood)),
        (Some(_), false) if options.flights == 0 => None,
        (Some(_), false) => {
            let flights = if random { options.flights } else { 1 };
            Some(HeldOut::of_tunnel(hold_out(campaign, &plant, indices, flights)?, log_likelihood))
        }
    };
    Ok(After { parameters: parameter_lines(campaign, fit), hold_out })
}

fn parameter_lines(campaign: &Campaign, fit: &Fit) -> Vec<ParameterLine> {
    let structure = &campaign.plant.aero.structure;
    (0..structure.parameters.len())
        .filter(|&i| campaign.declared[i])
        .map(|i| {
            let f = Free::Declared(i);
            let coefficient = structure.contributions.iter().find(|c| c.parameter == i).map_or("", |c| c.coefficient.name());
            ParameterLine::new(coefficient, &structure.parameters[i], fit.hypothesis.get(f), fit.std_error(f), "-")
        })
        .collect()
}

fn effect_lines(fit: &Fit, added: &[Added]) -> Vec<EffectLine> {
    fit.hypothesis
        .effects
        .iter()
        .zip(added)
        .enumerate()
        .map(|(k, (e, why))| EffectLine {
            family: e.effect.family.to_owned(),
            parameters: e
                .parameters
                .iter()
                .enumerate()
                .map(|(i, p)| {
                    let f = Free::Effect(k, i);
                    ParameterLine::new("", &p.name, e.values[i], fit.error_of(f), p.unit)
                })
                .collect(),
            p_value: why.p_value,
            probability: None,
            form: None,
            rivals: why.rivals.clone(),
            held_out_gain: why.held_out_gain,
            physics: e.effect.physics.to_owned(),
            source: e.effect.source.to_owned(),
            separate_by: e.effect.separate_by.to_owned(),
        })
        .collect()
}

/// What noise alone would leave, against what is left, per channel: ratio of variances with the F distribution, since noise is
/// measured on a finite number of copies.
fn channels(problem: &Problem<'_>, fit: &Fit) -> Vec<ChannelResidual> {
    problem.evidence.channel_residuals(&fit.residual, &problem.explained(&fit.hypothesis), fit.free.len())
}

fn p_least(c: &[ChannelResidual]) -> f64 {
    let least = c.iter().map(|x| x.p_value).fold(1.0, f64::min);
    p_value_of_best(least, c.len())
}

fn bounds(weighed: &[Candidate], problem: &Problem<'_>, fit: &Fit) -> Vec<Bound> {
    weighed
        .par_iter()
        .flat_map_iter(|c| {
            let random = c.instance.random_strengths().map(|i| (i, problem.random_bound(fit, &c.instance, i)));
            let mean = c.bounds.iter().copied();
            random
                .chain(mean)
                .map(|(i, upper95)| {
                    let p = &c.instance.parameters[i];
                    Bound {
                        family: c.instance.effect.family.to_owned(),
                        parameter: p.name.clone(),
                        upper95,
                        unit: p.unit.to_owned(),
                    }
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

fn shifts(campaign: &Campaign, before: &Fit, after: &Fit) -> Vec<Shift> {
    let names = &campaign.plant.aero.structure.parameters;
    (0..names.len())
        .filter(|&i| campaign.declared[i])
        .map(|i| {
            let f = Free::Declared(i);
            Shift {
                name: names[i].clone(),
                before: before.hypothesis.get(f),
                after: after.hypothesis.get(f),
                std_error_after: after.std_error(f),
            }
        })
        .collect()
}
