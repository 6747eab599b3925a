//! pid: which method is right for the data at hand. In: a campaign. Out: its identification, and why that method was taken.

use crate::StopReason;
use crate::compatibility::{Compatibility, NotExamined, join, pressure};
use crate::error::PidError;
use crate::identification::Identification;
use crate::identify::{Method, identify_by};
use crate::not_noise::NotNoise;
use crate::output_error::EstimateOptions;
use crate::plant::{PROCESS_NOISE, TURBULENCE};
use windfall_model::Campaign;

/// Identifies by output error where its residual is noise; by filter error where process noise explains what output error leaves; by
/// equation error where neither follows the runs or the plant has what they do not integrate. [`Identification::reason`] says which
/// and why; a residual that is not noise is a warning.
///
/// # Errors
/// As [`crate::output_error::identify`]; where the declared model cannot even fly through the record, that reason.
pub fn identify_chosen(campaign: &Campaign, options: &EstimateOptions) -> Result<Identification, PidError> {
    let first = match identify_by(campaign, Method::OutputError, options) {
        Ok(found) if left(&found).is_noise_of_pose() => {
            let reason = format!("over all runs its residual is {}", left(&found).clause());
            return Ok(because(found, reason));
        }
        Err(PidError::NotIntegrable { what }) => {
            return equation_error(
                campaign,
                options,
                format!("the plant has {what}, which the methods that integrate leave out"),
            );
        }
        Err(e) if !searched(&e) => return Err(e),
        other => other,
    };
    match (first, identify_by(campaign, Method::FilterError, options)) {
        (first, Ok(mut second)) if driven(&second) => {
            second.compatibility = first.as_ref().map_or_else(|_| no_answer(campaign, options), |f| f.compatibility.clone());
            Ok(by_filter(&first.map_or_else(|e| e.to_string(), |f| format!("its residual is {}", left(&f).clause())), second))
        }
        (Ok(first), Ok(_)) => {
            let reason = format!("its residual is {}, and filter error finds no turbulence in it", left(&first).clause());
            Ok(because(first, reason))
        }
        (Ok(first), Err(e)) => {
            let reason = format!("its residual is {}, and filter error does not end ({e})", left(&first).clause());
            Ok(because(first, reason))
        }
        (Err(e), Ok(mut second)) => {
            second.compatibility = no_answer(campaign, options);
            Ok(by_filter(&e.to_string(), second))
        }
        (Err(_), Err(e)) if !searched(&e) => Err(e),
        (Err(one), Err(other)) => {
            let mut found =
                equation_error(campaign, options, "no trajectory of the declared model follows these runs".to_owned())?;
            found.compatibility = no_answer(campaign, options);
            found.warnings.push(format!(
                "the residual is not noise: the declared model lacks something that output error ({one}) and filter error ({other}) \
                 cannot make up for; intervals say nothing of bias: try windfall close"
            ));
            Ok(found)
        }
    }
}

fn equation_error(campaign: &Campaign, options: &EstimateOptions, reason: String) -> Result<Identification, PidError> {
    Ok(because(identify_by(campaign, Method::EquationError, options)?, reason))
}

/// Filter error's result, with what output error left.
fn by_filter(left: &str, mut found: Identification) -> Identification {
    found.warnings.push(format!(
        "output error leaves more than noise ({left}); filter error takes what is left for process noise, turbulence first: whether it \
         is that or another effect, windfall close tells"
    ));
    because(found, "output error leaves more than noise, and process noise takes up what it leaves".to_owned())
}

/// True for a search that ended without an answer although the model flies.
fn searched(e: &PidError) -> bool {
    matches!(e, PidError::NoAnswer { stop, .. } if *stop != StopReason::FlightFails)
}

fn because(mut found: Identification, reason: String) -> Identification {
    found.reason = Some(reason);
    found
}

/// Channels of all runs together whose residual is not noise.
fn left(found: &Identification) -> NotNoise {
    NotNoise::of(found.of_all_runs().map_or(&[][..], |d| &d.fits))
}

/// The instruments where output error was tried and gave no answer.
fn no_answer(campaign: &Campaign, options: &EstimateOptions) -> Option<Compatibility> {
    options.compatibility.then(|| join(pressure(campaign), Err(NotExamined::NoAnswer)))
}

/// True where gusts or random moments were found.
fn driven(found: &Identification) -> bool {
    let drive = |c: &str| c == TURBULENCE || c == PROCESS_NOISE;
    found.of_all_runs().is_some_and(|d| d.parameters.iter().any(|p| drive(&p.coefficient) && p.estimate > 0.0))
}
