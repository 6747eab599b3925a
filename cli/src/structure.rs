//! cli: `windfall structure`. In: a campaign. Out: terms that its runs carry, `structure.json`, and `structure.toml` to declare them.

use crate::args::StructureArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::files::{write_json_atomically, write_structure};
use windfall::results::{Choice, CoefficientChoice, Symmetry};

/// Names of the result files.
const FILE: &str = "structure.json";
const DECLARED: &str = "structure.toml";
/// Name of the model in `[aero.<name>]`.
const NAME: &str = "chosen";

pub(crate) fn run(args: &StructureArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let campaign = session.campaign(&args.campaign)?;
    let folder = session.outputs(&[FILE, DECLARED])?;
    let found = session.work("choosing terms", || campaign.structure(&args.request))?;
    session.warn_all(&found.warnings);
    session.write(folder.as_deref(), |stage| {
        write_structure(&stage.join(DECLARED), &found.aero(NAME).structure)?;
        Ok(write_json_atomically(&stage.join(FILE), &found)?)
    })?;
    session.show(&found, || words(&campaign.data.name, &found))?;
    session.written(folder.as_deref(), &[FILE, DECLARED]);
    Ok(true)
}

/// What is printed of a choice of terms.
#[must_use]
pub fn words(campaign: &str, found: &Choice) -> String {
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
