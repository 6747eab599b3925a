//! discover: identification as users order it. In: a campaign and what is known beforehand. Out: all of `identification.json`, the same for
//! the program and for Python.

use crate::DiscoverError;
use crate::wind_tunnel::{self, WindTunnelLine};
use serde::{Deserialize, Serialize};
use windfall_likelihood::{Engine, Fit, Id, Member, Model};
use windfall_model::{Campaign, Constant, Parameter};
use windfall_pid::bands::add_curves;
use windfall_pid::bandwidth::{BandwidthLine, bandwidth_lines};
use windfall_pid::compatibility::{Compatibility, pressure};
use windfall_pid::output_error::{EstimateOptions, Handling, Prior};
use windfall_pid::plausible::looked;
use windfall_pid::smooth::Smoother;
use windfall_pid::{
    DataSet, Estimate, FoundEffect, FoundNumber, Held, Identification, Method, ci95, identifiability, identify_by,
    identify_chosen, relative_percent,
};
use windfall_replay::{Bootstrap, bootstrap};

/// What is asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdentifyOrder {
    /// How; none: as is right for the data.
    pub method: Option<Method>,
    /// Only all runs together, without each kind of run alone.
    pub combined_only: bool,
    /// Parameters that are not estimated but kept at a value.
    pub hold: Vec<Held>,
    /// Parameters that equal another.
    pub tie: Vec<Tie>,
    /// What is known of parameters from elsewhere.
    pub prior: Vec<Prior>,
    /// Copies of the campaign by which the stated errors are checked.
    pub bootstrap: Option<usize>,
    /// How the thesis' method smooths; none: with the cutoffs of Table 3.1.
    pub smoother: Option<Smoother>,
    /// Whether a record that the check refuses is identified all the same.
    pub accept_record: bool,
}

/// One parameter equal to another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tie {
    /// The parameter.
    pub name: String,
    /// That which it equals.
    pub to: String,
}

/// The content of `identification.json`: an identification, and its check where one was asked for.
///
/// ```
/// use windfall_pid::Method;
/// use windfall_replay::campaign_of;
/// use windfall_sim::{Seed, fly};
/// use windfall_discover::{IdentifyOrder, identify};
/// let file = windfall_scenarios::read_bundled("appendix-c").expect("bundled");
/// let flight = &file.scenario.flights[0];
/// let record = fly(&file.scenario.plant, flight, Seed::default())?.record;
/// let campaign = campaign_of(&file.declared_plant, &[(flight, record)]);
/// let order = IdentifyOrder { method: Some(Method::EquationError), combined_only: true, ..IdentifyOrder::default() };
/// let identified = identify(&campaign, &[], &order)?;
/// assert_eq!((identified.found.method.as_str(), identified.bootstrap), ("equation-error", None));
/// # Ok::<(), windfall_discover::DiscoverError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// Parameters, curves, what the runs can tell and whether the instruments agree.
    #[serde(flatten)]
    pub found: Identification,
    /// Stated errors beside the scatter over copies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bootstrap: Option<Bootstrap>,
    /// Identified curves at the points of the campaign's wind-tunnel tests.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub wind_tunnel: Vec<WindTunnelLine>,
    /// Runs and channels that were smoothed or resampled before their export, and the rate at which they are used.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bandwidth: Vec<BandwidthLine>,
}

impl AsRef<Identification> for Identified {
    fn as_ref(&self) -> &Identification {
        &self.found
    }
}

/// Identifies a campaign: parameters by one method, what the runs can tell at all, whether the instruments agree, coefficient curves with
/// bands, and copies where they are asked for. `notes` are what the reader of the campaign had to say; they lead the warnings.
///
/// # Errors
/// A record that is not what its campaign says it is, knowledge of parameters that the structure does not have, and what the method refuses ([`windfall_pid::PidError`]).
pub fn identify(campaign: &Campaign, notes: &[String], request: &IdentifyOrder) -> Result<Identified, DiscoverError> {
    let looked = looked(campaign, request.accept_record)?;
    let campaign = held(&looked.campaign, request)?;
    let options = options(&campaign, request)?;
    let mut found = match request.method {
        Some(method) => identify_by(&campaign, method, &options)?,
        None if says_more(&campaign) && request.tie.is_empty() && request.prior.is_empty() => {
            by_likelihood(&held(&looked.with_difference(), request)?, &options)?
        }
        None => identify_chosen(&campaign, &options)?,
    };
    // Copies of what the likelihood found are identified by output error.
    let method = Method::of_name(&found.method).unwrap_or(Method::OutputError);
    // Values that the method itself held (scales of gusts) stay beside those that were ordered.
    found.data_sets.iter_mut().for_each(|d| d.held = [request.hold.as_slice(), &d.held].concat());
    if found.identifiability.is_none() {
        // A plant that cannot be integrated has none.
        found.identifiability = identifiability(&campaign, &options).ok();
    }
    if found.compatibility.is_none() {
        found.compatibility = pressure(&campaign).map(Compatibility::of_pressure);
    }
    if let Some(seen) = found.compatibility.as_mut().and_then(|c| c.instruments.as_mut()) {
        // The lag that the check took out is part of what the recorders have.
        seen.add_wind_delay(looked.taken_s());
    }
    add_curves(&campaign, &mut found)?;
    let copies = request.bootstrap.map(|n| bootstrap(&campaign, &found, method, &options, n));
    let copies = copies.transpose()?;
    found.warnings.splice(0..0, notes.iter().cloned().chain(looked.notes()));
    if let Some((b, first)) = copies.as_ref().and_then(|b| Some((b, b.failed.first()?))) {
        found.warnings.push(format!("{} of {} copies gave no answer, the first: {first}", b.failed.len(), b.draws));
    }
    let wind_tunnel = wind_tunnel::of_data_sets(&campaign, &found.data_sets);
    Ok(Identified { found, bootstrap: copies, wind_tunnel, bandwidth: bandwidth_lines(&campaign) })
}

/// Mean square of the whitened innovations over what it should be from which a residual is left: twelve standard deviations of a run of a
/// minute.
const LEFT: f64 = 1.15;

/// Name of the likelihood in results.
const LIKELIHOOD: &str = "likelihood";

/// Whether a campaign says what is uncertain of its constants, or which effects its model has.
fn says_more(campaign: &Campaign) -> bool {
    let k = &campaign.knowledge;
    !campaign.has_tracks() && (!k.constants.is_empty() || !k.effects.is_empty())
}

/// Parameters by the likelihood that carries what a campaign says; the other methods take constants as exact. How well each coefficient is
/// explained is regression's.
fn by_likelihood(campaign: &Campaign, options: &EstimateOptions) -> Result<Identification, DiscoverError> {
    // Random effects, which regression warns of, are in the likelihood.
    let starting = EstimateOptions { starting: true, ..options.clone() };
    let mut found = identify_by(&campaign.with_effects_in_plant(), Method::EquationError, &starting)?;
    let fit = |d: &DataSet, near: Option<&Model>| {
        let indices: Vec<usize> = (0..campaign.runs.len()).filter(|&i| d.runs.contains(&campaign.runs[i].name)).collect();
        let engine = Engine::new(campaign, &indices).ok_or_else(|| "no run is long enough".to_owned());
        let end = engine.and_then(|engine| {
            let fit = windfall_likelihood::identify(&engine, near)?;
            let robust = engine.robust(&fit);
            let constants = found_constants(engine.campaign(), &robust);
            Ok((robust, fit.covariance, constants))
        });
        end.map_err(|words| DiscoverError::NoEnd { campaign: format!("{}, {}", campaign.name, d.name), words })
    };
    // All runs first: they lead the others.
    let whole = found.data_sets.iter().position(|d| d.is_of_all_runs());
    let lead = whole.map(|i| fit(&found.data_sets[i], None)).transpose()?;
    let mut all = Vec::new();
    for (i, d) in found.data_sets.iter().enumerate() {
        match &lead {
            Some(f) if Some(i) == whole => all.push(f.clone()),
            _ => all.push(fit(d, lead.as_ref().map(|(f, ..)| &f.model))?),
        }
    }
    for (d, (fit, white, constants)) in found.data_sets.iter_mut().zip(&all) {
        (d.constants, d.effects) = (constants.clone(), found_effects(fit));
        let structure = &campaign.plant.aero.structure;
        let place = |e: &Estimate| {
            let i = structure.index(&e.name)?;
            fit.numbers.iter().position(|n| n.id == Id::Declared(i)).map(|k| (i, k))
        };
        let places: Vec<Option<(usize, usize)>> = d.parameters.iter().map(place).collect();
        for (e, at) in d.parameters.iter_mut().zip(&places) {
            let Some((i, k)) = *at else { continue };
            let (value, std) = (fit.model.declared[i], fit.covariance[(k, k)].sqrt());
            (e.estimate, e.std_error, e.std_error_white) = (value, std, white[(k, k)].sqrt());
            e.ci95 = ci95(value, std);
            e.rse_percent = relative_percent(std, value);
        }
        for (row, a) in d.covariance.iter_mut().zip(&places) {
            for (x, b) in row.iter_mut().zip(&places) {
                if let (Some((_, i)), Some((_, k))) = (a, b) {
                    *x = fit.covariance[(*i, *k)];
                }
            }
        }
    }
    for (d, (fit, ..)) in found.data_sets.iter().zip(&all) {
        if fit.chi > LEFT {
            found.warnings.push(format!(
                "{}: the innovations' mean square is {:.2} of what noise leaves: `windfall close` says what the model lacks",
                d.name, fit.chi
            ));
        }
    }
    found.reason = Some("the campaign says what is uncertain of its constants or which effects act".to_owned());
    LIKELIHOOD.clone_into(&mut found.method);
    Ok(found)
}

/// Constants as a fit has them.
fn found_constants(campaign: &Campaign, fit: &Fit) -> Vec<FoundNumber> {
    let one = |(i, c): (usize, &Constant)| FoundNumber {
        name: c.name(),
        estimate: c.value(&campaign.plant).unwrap_or(0.0) + fit.model.constants[i],
        std_error: fit.std_error(Id::Constant(i)),
        unit: c.unit.to_owned(),
    };
    campaign.knowledge.constants.iter().enumerate().map(one).collect()
}

/// Effects as a fit has them: those that are declared, and gusts where the likelihood finds such.
fn found_effects(fit: &Fit) -> Vec<FoundEffect> {
    let number = |k: usize, i: usize, p: &Parameter, value: f64| FoundNumber {
        name: p.name.clone(),
        estimate: value,
        std_error: fit.std_error(Id::Member(k, i)),
        unit: p.unit.to_owned(),
    };
    let one = |(k, m): (usize, &Member)| FoundEffect {
        family: m.effect.family.to_owned(),
        parameters: m.parameters.iter().zip(&m.values).enumerate().map(|(i, (p, v))| number(k, i, p, *v)).collect(),
    };
    fit.model.members.iter().enumerate().map(one).collect()
}

/// The campaign with what is to be held at its value and no longer declared.
fn held(campaign: &Campaign, request: &IdentifyOrder) -> Result<Campaign, DiscoverError> {
    let mut campaign = campaign.clone();
    for (k, h) in request.hold.iter().enumerate() {
        let i = index(&campaign, "hold", &h.name)?;
        if request.hold[..k].iter().any(|other| other.name == h.name) {
            return Err(DiscoverError::HeldTwice { name: h.name.clone() });
        }
        campaign.plant.aero.values[i] = h.value;
        campaign.declared[i] = false;
    }
    Ok(campaign)
}

fn options(campaign: &Campaign, request: &IdentifyOrder) -> Result<EstimateOptions, DiscoverError> {
    for t in &request.tie {
        index(campaign, "tie", &t.name)?;
        index(campaign, "tie", &t.to)?;
    }
    for p in &request.prior {
        index(campaign, "prior", &p.name)?;
    }
    let tied = |t: &Tie| (t.name.clone(), Handling::Tied { to: t.to.clone() });
    Ok(EstimateOptions {
        handling: request.tie.iter().map(tied).collect(),
        priors: request.prior.clone(),
        combined_only: request.combined_only,
        compatibility: true,
        smoother: request.smoother.clone(),
        ..EstimateOptions::default()
    })
}

fn index(campaign: &Campaign, what: &'static str, name: &str) -> Result<usize, DiscoverError> {
    let structure = &campaign.plant.aero.structure;
    let unknown = || DiscoverError::UnknownParameter { what, name: name.to_owned(), allowed: structure.parameters.join(", ") };
    structure.index(name).ok_or_else(unknown)
}
