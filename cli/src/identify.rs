//! cli: `windfall identify`. In: a campaign. Out: a table of parameters, and `identification.json`.

use crate::args::{IdentifyArgs, MethodWord};
use crate::knowledge;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall_pid::{
    DataSet, Identifiability, Identification, Method, filter_error, identifiability, identify, identify_chosen, output_error,
};
use windfall_scenarios::read_campaign_with_warnings;

/// Name of the result file.
pub(crate) const FILE: &str = "identification.json";

pub(crate) fn run(args: &IdentifyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let (mut campaign, notes) = read_campaign_with_warnings(&args.campaign)?;
    notes.iter().for_each(|n| session.warn(n));
    let options = knowledge::options(args, &mut campaign)?;
    let folder = session.outputs(&[FILE.to_owned()])?;
    let method = args.method.map(|word| match word {
        MethodWord::Thesis => Method::Thesis,
        MethodWord::EquationError => Method::EquationError,
        MethodWord::OutputError => Method::OutputError,
        MethodWord::FilterError => Method::FilterError,
    });
    let spinner = session.spinner("identifying");
    let found = session.pool()?.install(|| match method {
        Some(Method::OutputError) => output_error::identify(&campaign, &options),
        Some(Method::FilterError) => filter_error::identify(&campaign, &options),
        Some(method) => knowledge::none(&options, method).and_then(|()| identify(&campaign, method)),
        None => identify_chosen(&campaign, &options),
    });
    spinner.finish_and_clear();
    let mut found = found.map_err(Failure::of_identification)?;
    found.data_sets.iter_mut().for_each(|d| d.held.clone_from(&args.hold));
    if found.identifiability.is_none() {
        // A plant that cannot be integrated has none.
        found.identifiability = session.pool()?.install(|| identifiability(&campaign, &options)).ok();
    }
    if let Some(reason) = &found.reason {
        session.say(&format!("method {}: {reason}", found.method));
    }
    found.warnings.iter().for_each(|w| session.warn(w));
    session.deliver(folder.as_deref(), FILE, &found, || table(&campaign.name, &found))?;
    Ok(true)
}

fn table(campaign: &str, found: &Identification) -> String {
    let mut text = format!("{campaign}, method {}\n", found.method);
    if let Some(told) = &found.identifiability {
        excitation(&mut text, told);
    }
    found.data_sets.iter().for_each(|d| data_set(&mut text, d));
    text
}

/// What the runs can tell.
fn excitation(text: &mut String, told: &Identifiability) {
    let _ = writeln!(
        text,
        "these runs tell {} of {} parameters apart (condition number {:.3e})",
        told.rank, told.free, told.condition
    );
    for c in &told.correlations {
        let _ = writeln!(text, "  {} and {}: errors correlated by {:+.4}", c.first, c.second, c.correlation);
    }
    for set in &told.inseparable {
        let _ =
            writeln!(text, "  not separable by these runs: {}: hold one, or add a run that excites them apart", set.join(", "));
    }
}

fn data_set(text: &mut String, d: &DataSet) {
    let _ = write!(
        text,
        "\n{} ({} samples of {}; condition number {:.3e})\n",
        d.name,
        d.n_samples,
        d.runs.join(", "),
        d.condition_number
    );
    let _ = writeln!(
        text,
        "{:<11}{:<16}{:>14}{:>12}{:>10}   {:<28}{:>12}",
        "coef", "parameter", "estimate", "std error", "RSE %", "95 % interval", "white s.e."
    );
    for p in &d.parameters {
        let interval = format!("[{:.6}, {:.6}]", p.ci95[0], p.ci95[1]);
        let _ = writeln!(
            text,
            "{:<11}{:<16}{:>14.6}{:>12.3e}{:>10.3}   {interval:<28}{:>12.3e}",
            p.coefficient, p.name, p.estimate, p.std_error, p.rse_percent, p.std_error_white
        );
    }
    for h in &d.held {
        let _ = writeln!(text, "{:<11}{:<16}{:>14.6}   held", "", h.name, h.value);
    }
    for f in &d.fits {
        let _ = writeln!(
            text,
            "{:<11}R² = {:.6}, residual std = {:.3e}, p(white) = {:.3}",
            f.coefficient, f.r2, f.residual_std, f.residual_whiteness_p
        );
    }
}
