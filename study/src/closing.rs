//! study: the loop closed on one draw. In: the draw's campaign and its true effects. Out: verdict, right or wrong, and numbers.

use super::columns::VERDICTS;
use super::row::Cells;
use crate::StudyError;
use windfall_discover::close::{Closing, Options, SetLine, Verdict, close};
use windfall_model::study::{Cell, DrawnSetup, StudyOrder};
use windfall_model::{Campaign, Role};

pub(super) fn close_draw(
    campaign: &Campaign,
    study: &StudyOrder,
    setting: &DrawnSetup,
    out: &mut Cells<'_>,
) -> Result<(), StudyError> {
    let closing = close(campaign, &Options::default())?;
    let families: Vec<&str> = closing.effects.iter().map(|e| e.family.as_str()).collect();
    let rivals = closing.effects.first().map_or(&[][..], |e| &e.rivals);
    let verdict = match closing.verdict {
        Verdict::Consistent => 0,
        Verdict::Effect => 1,
        Verdict::Unexplained => 2,
    };
    out.set("close.verdict", Cell::Word(VERDICTS[verdict].to_owned()));
    out.set("close.families", Cell::Word(families.join("+")));
    out.set("close.rivals", Cell::Word(rivals.join("+")));
    VERDICTS.iter().enumerate().for_each(|(i, name)| out.flag(&format!("close.{name}"), i == verdict));
    let truth = true_families(study, setting);
    out.set("close.truth", Cell::Word(truth.join("+")));
    if let Some(p) = stated(&closing, &families) {
        out.number("close.probability", p);
    }
    let is_true = |f: &str| truth.contains(&f);
    let right = if truth.is_empty() { verdict == 0 } else { families.first().is_some_and(|f| is_true(f)) };
    out.flag("close.right", right);
    out.flag("close.right_or_rival", right || (!families.is_empty() && rivals.iter().any(|r| is_true(r))));
    for e in &study.effects {
        effect(e.effect.family, &(e.effect.parameters)(&[]), &setting.effect_values[e.index], &closing, out);
    }
    Ok(())
}

/// Probability of the set that is named, or of none; none where nothing accounts for the residual.
fn stated(closing: &Closing, families: &[&str]) -> Option<f64> {
    if closing.verdict == Verdict::Unexplained {
        return None;
    }
    let same = |s: &&SetLine| s.families.len() == families.len() && s.families.iter().all(|f| families.contains(&f.as_str()));
    closing.sets.iter().find(same).map(|s| s.probability)
}

/// Families of which a strength is not zero in this draw.
fn true_families<'s>(study: &'s StudyOrder, setting: &DrawnSetup) -> Vec<&'s str> {
    let acts = |e: &&windfall_model::study::StudyEffect| {
        let parameters = (e.effect.parameters)(&[]);
        parameters.iter().zip(&setting.effect_values[e.index]).any(|(p, v)| p.role == Role::Strength && *v != 0.0)
    };
    study.effects.iter().filter(acts).map(|e| e.effect.family).collect()
}

/// An effect's numbers where it was found, their bounds where it was not.
fn effect(family: &str, parameters: &[windfall_model::Parameter], truth: &[f64], closing: &Closing, out: &mut Cells<'_>) {
    let found = closing.effects.iter().find(|e| e.family == family);
    for (p, &truth) in parameters.iter().zip(truth).filter(|(p, _)| p.role != Role::Reference) {
        let stem = format!("close.{family}.{}", p.name);
        if let Some(line) = found.and_then(|e| e.parameters.iter().find(|l| l.name == p.name)) {
            out.estimate(&stem, line.estimate, line.std_error, line.ci95, truth);
        }
        if let Some(b) = closing.bounds.iter().find(|b| b.family == family && b.parameter == p.name) {
            out.number(&format!("{stem}.upper95"), b.upper95);
            out.flag(&format!("{stem}.bounded"), truth.abs() <= b.upper95);
        }
    }
}
