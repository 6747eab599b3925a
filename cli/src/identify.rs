//! cli: `windfall identify`. In: a campaign. Out: a table of parameters, and `identification.json`.

use crate::args::{IdentifyArgs, MethodWord};
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall_pid::output_error::Options;
use windfall_pid::{DataSet, Identification, Method, PidError, identify, identify_chosen};
use windfall_scenarios::{read_campaign_with_warnings, write_json_atomically};

/// Name of the result file.
pub(crate) const FILE: &str = "identification.json";

pub(crate) fn run(args: &IdentifyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let (campaign, notes) = read_campaign_with_warnings(&args.campaign)?;
    notes.iter().for_each(|n| session.warn(n));
    let folder = session.outputs(&[FILE.to_owned()])?;
    let method = args.method.map(|word| match word {
        MethodWord::Thesis => Method::Thesis,
        MethodWord::EquationError => Method::EquationError,
        MethodWord::OutputError => Method::OutputError,
        MethodWord::FilterError => Method::FilterError,
    });
    let spinner = session.spinner("identifying");
    let found = session.pool()?.install(|| match method {
        Some(method) => identify(&campaign, method),
        None => identify_chosen(&campaign, &Options::default()),
    });
    spinner.finish_and_clear();
    let found = found.map_err(|e| match e {
        PidError::NoAnswer { .. } => Failure::Numerical(e.into()),
        other => other.into(),
    })?;
    if let Some(reason) = &found.reason {
        session.say(&format!("method {}: {reason}", found.method));
    }
    found.warnings.iter().for_each(|w| session.warn(w));
    if let Some(folder) = &folder {
        write_json_atomically(&folder.join(FILE), &found)?;
    }
    if session.common.json {
        session.print_json(&found)?
    } else {
        session.print(&table(&campaign.name, &found))?
    }
    if let Some(folder) = &folder {
        session.say(&format!("written: {}", folder.join(FILE).display()));
    }
    Ok(true)
}

fn table(campaign: &str, found: &Identification) -> String {
    let mut text = format!("{campaign}, method {}\n", found.method);
    found.data_sets.iter().for_each(|d| data_set(&mut text, d));
    text
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
        "{:<6}{:<10}{:>14}{:>12}{:>10}   {:<28}{:>12}",
        "coef", "parameter", "estimate", "std error", "RSE %", "95 % interval", "white s.e."
    );
    for p in &d.parameters {
        let interval = format!("[{:.6}, {:.6}]", p.ci95[0], p.ci95[1]);
        let _ = writeln!(
            text,
            "{:<6}{:<10}{:>14.6}{:>12.3e}{:>10.3}   {interval:<28}{:>12.3e}",
            p.coefficient, p.name, p.estimate, p.std_error, p.rse_percent, p.std_error_white
        );
    }
    for f in &d.fits {
        let _ = writeln!(
            text,
            "{:<6}R² = {:.6}, residual std = {:.3e}, p(white) = {:.3}",
            f.coefficient, f.r2, f.residual_std, f.residual_whiteness_p
        );
    }
}
