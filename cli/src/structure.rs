//! cli: `windfall structure`. In: a campaign. Out: terms that its runs carry, `structure.json`, and `structure.toml` to declare them.

use crate::args::StructureArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall_pid::structure::{Choice, CoefficientChoice, Criterion, Symmetry, choose};
use windfall_scenarios::{read_campaign_with_warnings, write_structure};

/// Names of the result files.
const FILE: &str = "structure.json";
const DECLARED: &str = "structure.toml";
/// Name of the model in `[aero.<name>]`.
const NAME: &str = "chosen";

pub(crate) fn run(args: &StructureArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let (campaign, notes) = read_campaign_with_warnings(&args.campaign)?;
    notes.iter().for_each(|n| session.warn(n));
    let folder = session.outputs(&[FILE.to_owned(), DECLARED.to_owned()])?;
    let spinner = session.spinner("choosing terms");
    let found = session.pool()?.install(|| choose(&campaign, args.criterion));
    spinner.finish_and_clear();
    let found = found.map_err(Failure::of_identification)?;
    found.warnings.iter().for_each(|w| session.warn(w));
    if let Some(folder) = &folder {
        write_structure(&folder.join(DECLARED), &found.aero(NAME).structure)?;
    }
    session.deliver(folder.as_deref(), FILE, &found, || words(&campaign.name, &found))?;
    Ok(true)
}

fn words(campaign: &str, found: &Choice) -> String {
    let mut text = format!("{campaign}, terms by {} on {}\n", found.criterion.name(), found.runs.join(", "));
    found.coefficients.iter().for_each(|c| coefficient(&mut text, c));
    let _ = writeln!(
        text,
        "\nto declare them, with {DECLARED} beside the campaign file:\n\n[aero.{NAME}]\nstructure = \"{DECLARED}\""
    );
    let aero = found.aero(NAME);
    for (name, value) in aero.structure.parameters.iter().zip(&aero.values) {
        let _ = writeln!(text, "{name} = {value:?}");
    }
    text
}

fn coefficient(text: &mut String, c: &CoefficientChoice) {
    let with = match c.coefficient.as_str() {
        "CN" => " with CY",
        "Cm" => " with Cn",
        _ => "",
    };
    let _ = writeln!(text, "\n{}{with}", c.coefficient);
    let _ = writeln!(text, "  {:<12}{:>14}{:>12}{:>14}{:>10}   what", "term", "estimate", "std error", "partial F", "in folds");
    let share = |s: Option<f64>| s.map_or_else(|| "-".to_owned(), |s| format!("{:.0} %", 100.0 * s));
    for k in c.candidates.iter().filter(|k| k.chosen) {
        let Some(t) = c.chosen.iter().find(|t| t.name == k.name) else { continue };
        let (f, s) = (k.partial_f, share(k.fold_share));
        let note = match k.symmetry {
            Symmetry::Revolution => "",
            Symmetry::QuarterTurn => " (not of a body of revolution: one of quarter turns)",
            Symmetry::Rotation => " (not of a body with mirror planes)",
            Symmetry::None => " (asymmetric)",
        };
        let _ = writeln!(text, "  {:<12}{:>14.6}{:>12.3e}{f:>14.1}{s:>10}   {}{note}", k.name, t.estimate, t.std_error, k.why);
    }
    if let Some(s) = c.shape.as_ref().filter(|s| s.found) {
        let _ = writeln!(text, "  {:<12}{:>14.6}{:>12.3e}   width of {}, rad", "", s.width_rad, s.std_error_rad, s.name);
    }
    let mut rest: Vec<_> = c.candidates.iter().filter(|k| !k.chosen).collect();
    rest.sort_by(|a, b| b.partial_f.total_cmp(&a.partial_f));
    let left: Vec<String> = rest.iter().map(|k| format!("{} {:.1} ({})", k.name, k.partial_f, share(k.fold_share))).collect();
    let _ = writeln!(text, "  left out, partial F to enter (share of folds): {}", left.join(", "));
    for k in &c.criteria {
        let value = k.value.map_or_else(String::new, |v| format!(" = {v:.6e}"));
        let _ = writeln!(text, "  {:<18}{}{value}", k.criterion.name(), k.terms.join(", "));
    }
}

/// A criterion by name.
pub(crate) fn criterion(word: &str) -> Result<Criterion, String> {
    let known = || Criterion::ALL.map(Criterion::name).join(", ");
    Criterion::ALL.into_iter().find(|c| c.name() == word).ok_or_else(|| format!("{word}: one of {}", known()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_criteria_as_typed() {
        for c in Criterion::ALL {
            assert_eq!(criterion(c.name()), Ok(c));
        }
        assert!(criterion("aic").is_err_and(|e| e.contains("likelihood")));
    }
}
