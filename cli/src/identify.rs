//! cli: `windfall identify`. In: a campaign. Out: a table of parameters, and `identification.json`.

use crate::args::{IdentifyArgs, MethodWord};
use crate::knowledge;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall_model::Campaign;
use windfall_pid::bands::add_curves;
use windfall_pid::compatibility::{Compatibility, pressure};
use windfall_pid::output_error::Options;
use windfall_pid::{DataSet, Identifiability, Identification, Method, identifiability, identify_by, identify_chosen};
use windfall_scenarios::read_campaign_with_warnings;
use windfall_verify::{Bootstrap, bootstrap};

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
        Some(method) => identify_by(&campaign, method, &options),
        None => identify_chosen(&campaign, &options),
    });
    spinner.finish_and_clear();
    let mut found = found.map_err(Failure::of_identification)?;
    found.data_sets.iter_mut().for_each(|d| d.held.clone_from(&args.hold));
    if found.identifiability.is_none() {
        // A plant that cannot be integrated has none.
        found.identifiability = session.pool()?.install(|| identifiability(&campaign, &options)).ok();
    }
    if found.compatibility.is_none() {
        found.compatibility = pressure(&campaign).map(Compatibility::of_pressure);
    }
    add_curves(&campaign, &mut found).map_err(Failure::of_identification)?;
    if let Some(reason) = &found.reason {
        session.say(&format!("method {}: {reason}", found.method));
    }
    found.warnings.iter().for_each(|w| session.warn(w));
    let copies = match args.bootstrap {
        Some(n) => Some(copies(&campaign, &found, &options, usize::from(n), session)?),
        None => None,
    };
    let result = Written { found: &found, bootstrap: copies.as_ref() };
    session.deliver(folder.as_deref(), FILE, &result, || {
        table(&campaign.name, &found) + &copies.as_ref().map_or_else(String::new, bootstrap_table)
    })?;
    Ok(true)
}

/// The file: an identification, and its check where one was asked for.
#[derive(serde::Serialize)]
struct Written<'a> {
    #[serde(flatten)]
    found: &'a Identification,
    #[serde(skip_serializing_if = "Option::is_none")]
    bootstrap: Option<&'a Bootstrap>,
}

fn copies(
    campaign: &Campaign,
    found: &Identification,
    options: &Options,
    n: usize,
    session: &mut Session<'_>,
) -> Result<Bootstrap, Failure> {
    let method = Method::of_name(&found.method).expect("named by the method itself");
    let spinner = session.spinner("identifying copies");
    let result = session.pool()?.install(|| bootstrap(campaign, found, method, options, n));
    spinner.finish_and_clear();
    let result = result.map_err(Failure::of_verification)?;
    if let Some(first) = result.failed.first() {
        session.warn(&format!("{} of {n} copies gave no answer, the first: {first}", result.failed.len()));
    }
    Ok(result)
}

fn bootstrap_table(b: &Bootstrap) -> String {
    let mut text = format!(
        "\n{} copies of the identified model, identified again (each ratio ± {:.2} by their number)\n",
        b.draws - b.failed.len(),
        b.ratio_std_error
    );
    let _ = writeln!(
        text,
        "{:<11}{:<16}{:>12}{:>12}{:>8}{:>12}{:>14}",
        "coef", "parameter", "std error", "scatter", "ratio", "bias/s.e.", "95 % covers"
    );
    for p in &b.parameters {
        let _ = writeln!(
            text,
            "{:<11}{:<16}{:>12.3e}{:>12.3e}{:>8.2}{:>+12.2}{:>12.0} %",
            p.coefficient,
            p.name,
            p.std_error,
            p.scatter,
            p.ratio,
            p.bias_over_std_error,
            100.0 * p.covered
        );
    }
    text
}

fn table(campaign: &str, found: &Identification) -> String {
    let mut text = format!("{campaign}, method {}\n", found.method);
    if let Some(c) = &found.compatibility {
        crate::agreement::lines(c).iter().for_each(|l| {
            let _ = writeln!(text, "{l}");
        });
    }
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
