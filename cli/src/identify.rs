//! cli: `windfall identify`. In: a campaign. Out: a table of parameters, `identification.json`, `coefficients.json` and
//! `records.json`.

use crate::args::IdentifyArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::files::series_text;
use windfall::report;
use windfall::results::{
    Bootstrap, DataSet, Estimate, FoundNumber, Identification, Identified, SignalTracks, SmoothingTracks, TestTable,
};

/// Names of the result files.
const FILES: [&str; 3] = ["identification.json", "coefficients.json", "records.json"];

pub(crate) fn run(args: &IdentifyArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let campaign = session.campaign(&args.campaign)?;
    let folder = session.outputs(&FILES)?;
    let what = if args.request.bootstrap.is_some() { "identifying, then copies" } else { "identifying" };
    let (result, tracks, records) = session.work(what, || {
        let result = campaign.identify(&args.request)?;
        // Without a file nobody sees them; a plant whose coefficients cannot be had has none.
        if folder.is_none() {
            return Ok((result, SignalTracks::default(), SmoothingTracks::default()));
        }
        let tracks = campaign.coefficient_tracks(&result).unwrap_or_default();
        let records = campaign.smoothing_of(&result, &args.request).unwrap_or_default();
        Ok((result, tracks, records))
    })?;
    if let Some(reason) = &result.found.reason {
        session.say(&format!("method {}: {reason}", result.found.method));
    }
    // The reader's notes, which lead the warnings, are said already.
    session.warn_all(&result.found.warnings[campaign.warnings.len()..]);
    let beside = [series_text(&tracks)?, series_text(&records)?];
    session.deliver_with(folder.as_deref(), &FILES, (&result, &beside), || words(&campaign.data.name, &result))?;
    Ok(true)
}

/// What is printed of an identification.
#[must_use]
pub fn words(campaign: &str, result: &Identified) -> String {
    let curves = crate::wind_tunnel::lines(&result.wind_tunnel);
    table(campaign, &result.found) + &curves + &result.bootstrap.as_ref().map_or_else(String::new, bootstrap_table)
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
    if let Some(smoothing) = &found.smoothing {
        let _ = writeln!(text, "smoothing: {smoothing}");
    }
    let agreement = found.compatibility.iter().flat_map(report::agreement);
    let told = found.identifiability.iter().flat_map(report::identifiable);
    for line in agreement.chain(told).chain(report::test_table(&TestTable::of(found))) {
        let _ = writeln!(text, "{line}");
    }
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
    if let Some(e) = &d.envelope {
        let _ = writeln!(text, "{}", report::validity(e));
    }
    let _ = writeln!(
        text,
        "{:<11}{:<16}{:>14}{:>12}{:>10}   {:<28}{:>12}",
        "coef", "parameter", "estimate", "std error", "RSE %", "95 % interval", "white s.e."
    );
    for p in &d.parameters {
        let _ = writeln!(text, "{}", line(p));
    }
    for h in &d.held {
        let _ = writeln!(text, "{:<11}{:<16}{:>14.6}   held", "", h.name, h.value);
    }
    for c in &d.constants {
        let _ = writeln!(text, "{}", beside(&c.name, c));
    }
    for (e, p) in d.effects.iter().flat_map(|e| e.parameters.iter().map(move |p| (e, p))) {
        let _ = writeln!(text, "{}", beside(&format!("{}.{}", e.family, p.name), p));
    }
    for r in &d.refused {
        let _ = writeln!(text, "{:<11}{:<16} not estimated: {}", r.coefficient, r.name, r.reason);
    }
    for f in &d.fits {
        let _ = writeln!(
            text,
            "{:<11}R² = {:.6}, residual std = {:.3e}, p(white) = {:.3}",
            f.coefficient, f.r2, f.residual_std, f.residual_whiteness_p
        );
    }
}

/// A constant or an effect's number: found with its standard error, or held.
fn beside(name: &str, p: &FoundNumber) -> String {
    let unit = if p.unit == "-" { "" } else { p.unit.as_str() };
    let how = p.std_error.map_or_else(|| "held".to_owned(), |s| format!("± {s:.3e}"));
    format!("{name:<41} {:>14.6} {unit}   {how}", p.estimate)
}

fn line(p: &Estimate) -> String {
    let interval = format!("[{:.6}, {:.6}]", p.ci95[0], p.ci95[1]);
    let relative = p.rse_percent.map_or_else(|| "–".to_owned(), |r| format!("{r:.3}"));
    format!(
        "{:<11}{:<16}{:>14.6}{:>12.3e}{relative:>10}   {interval:<28}{:>12.3e}",
        p.coefficient, p.name, p.estimate, p.std_error, p.std_error_white
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gust that is not there has an error and no relative one.
    #[test]
    fn law_a_zero_has_no_relative_error() {
        let json = serde_json::json!({"coefficient": "turbulence", "name": "axial_rms_m_s", "estimate": 0.0, "std_error": 0.001,
            "rse_percent": windfall::results::relative_percent(0.001, 0.0), "ci95": [0.0, 0.002], "std_error_white": 0.001});
        assert!(json["rse_percent"].is_null());
        let shown = line(&serde_json::from_value(json).expect("an estimate"));
        assert!(shown.contains("1.000e-3         –   [0.000000, 0.002000]") && shown.chars().count() < 110, "{shown}");
    }
}
