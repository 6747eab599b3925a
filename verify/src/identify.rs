//! verify: identification as users order it. In: a campaign and what is known beforehand. Out: all of `identification.json`, the same for
//! the program and for Python.

use crate::VerifyError;
use crate::bootstrap::{Bootstrap, bootstrap};
use serde::{Deserialize, Serialize};
use windfall_model::Campaign;
use windfall_pid::bands::add_curves;
use windfall_pid::compatibility::{Compatibility, pressure};
use windfall_pid::output_error::{Handling, Options, Prior};
use windfall_pid::plausible::plausible;
use windfall_pid::{Held, Identification, Method, identifiability, identify_by, identify_chosen};

/// What is asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Identify {
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
}

/// One parameter equal to another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tie {
    /// The parameter.
    pub name: String,
    /// That which it equals.
    pub to: String,
}

/// The content of `identification.json`: an identification, and its check where one was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// Parameters, curves, what the runs can tell and whether the instruments agree.
    #[serde(flatten)]
    pub found: Identification,
    /// Stated errors beside the scatter over copies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bootstrap: Option<Bootstrap>,
}

/// Identifies a campaign: parameters by one method, what the runs can tell at all, whether the instruments agree, coefficient curves with
/// bands, and copies where they are asked for. `notes` are what the reader of the campaign had to say; they lead the warnings.
///
/// # Errors
/// A record that is not what its campaign says it is, knowledge of parameters that the structure does not have, and what the method refuses ([`windfall_pid::PidError`]).
pub fn identify(campaign: &Campaign, notes: &[String], request: &Identify) -> Result<Identified, VerifyError> {
    plausible(campaign)?;
    let campaign = held(campaign, request)?;
    let options = options(&campaign, request)?;
    let mut found = match request.method {
        Some(method) => identify_by(&campaign, method, &options)?,
        None => identify_chosen(&campaign, &options)?,
    };
    // Values that the method itself held (scales of gusts) stay beside those that were ordered.
    found.data_sets.iter_mut().for_each(|d| d.held = [request.hold.as_slice(), &d.held].concat());
    if found.identifiability.is_none() {
        // A plant that cannot be integrated has none.
        found.identifiability = identifiability(&campaign, &options).ok();
    }
    if found.compatibility.is_none() {
        found.compatibility = pressure(&campaign).map(Compatibility::of_pressure);
    }
    add_curves(&campaign, &mut found)?;
    let copies = request.bootstrap.map(|n| {
        let method = Method::of_name(&found.method).expect("named by the method itself");
        bootstrap(&campaign, &found, method, &options, n)
    });
    let copies = copies.transpose()?;
    found.warnings.splice(0..0, notes.iter().cloned());
    if let Some((b, first)) = copies.as_ref().and_then(|b| Some((b, b.failed.first()?))) {
        found.warnings.push(format!("{} of {} copies gave no answer, the first: {first}", b.failed.len(), b.draws));
    }
    Ok(Identified { found, bootstrap: copies })
}

/// The campaign with what is to be held at its value and no longer declared.
fn held(campaign: &Campaign, request: &Identify) -> Result<Campaign, VerifyError> {
    let mut campaign = campaign.clone();
    for (k, h) in request.hold.iter().enumerate() {
        let i = index(&campaign, "hold", &h.name)?;
        if request.hold[..k].iter().any(|other| other.name == h.name) {
            return Err(VerifyError::HeldTwice { name: h.name.clone() });
        }
        campaign.plant.aero.values[i] = h.value;
        campaign.declared[i] = false;
    }
    Ok(campaign)
}

fn options(campaign: &Campaign, request: &Identify) -> Result<Options, VerifyError> {
    for t in &request.tie {
        index(campaign, "tie", &t.name)?;
        index(campaign, "tie", &t.to)?;
    }
    for p in &request.prior {
        index(campaign, "prior", &p.name)?;
    }
    let tied = |t: &Tie| (t.name.clone(), Handling::Tied { to: t.to.clone() });
    Ok(Options {
        handling: request.tie.iter().map(tied).collect(),
        priors: request.prior.clone(),
        combined_only: request.combined_only,
        compatibility: true,
        ..Options::default()
    })
}

fn index(campaign: &Campaign, what: &'static str, name: &str) -> Result<usize, VerifyError> {
    let structure = &campaign.plant.aero.structure;
    let unknown = || VerifyError::UnknownParameter { what, name: name.to_owned(), allowed: structure.parameters.join(", ") };
    structure.index(name).ok_or_else(unknown)
}
