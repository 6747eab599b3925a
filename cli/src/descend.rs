//! cli: `windfall descend`. In: a planet scenario, an identification. Out: the touch-down table, `descent.json`, `descents.parquet`, the page.

use crate::args::DescendArgs;
use crate::session::{Failure, Session};
use std::fmt::Write as _;
use windfall::results::{DescentSummary, TouchDownLine};
use windfall::{DESCENT_FILES, DescentScenario, read_identification, write_descents};

pub(crate) fn run(args: &DescendArgs, session: &mut Session<'_>) -> Result<bool, Failure> {
    let scenario = DescentScenario::read(&args.scenario)?;
    let model = args.model.as_deref().map(read_identification).transpose()?;
    let folder = session.outputs(&DESCENT_FILES)?;
    let bar = session.bar("descending", usize::try_from(args.request.draws).unwrap_or(usize::MAX));
    let flown = session.pool()?.install(|| scenario.descend(model.as_ref(), &args.request, || bar.inc(1)));
    bar.finish_and_clear();
    let descended = flown?;
    let summary = &descended.summary;
    session.warn_all(&summary.warnings);
    session.write(folder.as_deref(), |stage| write_descents(stage, &descended))?;
    session.show(summary, || words(summary))?;
    session.written(folder.as_deref(), &DESCENT_FILES);
    if summary.ends.failed == summary.draws {
        let why = summary.ends.reasons.first().map_or("", |r| r.reason.as_str());
        return Err(Failure::numerical(anyhow::anyhow!("every descent failed, most often: {why}")));
    }
    Ok(true)
}

/// What is printed of descents: the result on a screenful.
#[must_use]
pub fn words(s: &DescentSummary) -> String {
    let model = s
        .model
        .as_ref()
        .map_or_else(|| "the scenario's coefficients".to_owned(), |m| format!("parameters of {} by {}", m.data_set, m.method));
    let e = &s.ends;
    let mut text = format!("{}, {}: {} descents, {model}, seed {}\n", s.scenario, s.flight, s.draws, s.seed);
    let _ = writeln!(text, "{} landed, {} tumbled, {} still aloft, {} failed", e.landed, e.tumbled, e.aloft, e.failed);
    for r in &e.reasons {
        let _ = writeln!(text, "  {}: {}", r.count, r.reason);
    }
    if s.touch_down.is_empty() {
        return text;
    }
    let _ = writeln!(
        text,
        "\n{:<30}{:>11}{:>11}{:>11}{:>26}{:>12}  hangs on",
        "at touch-down", "nominal", "mean", "std", "95 % of descents", "parameters"
    );
    s.touch_down.iter().for_each(|l| line(&mut text, l));
    text
}

fn line(text: &mut String, l: &TouchDownLine) {
    let nominal = l.nominal.map_or_else(|| "-".to_owned(), short);
    let range = format!("{} to {}", short(l.low), short(l.high));
    let share = format!("{:.1} %", 100.0 * l.share_of_parameters);
    let most = l.parameters.iter().filter(|p| p.share >= 0.005).take(3);
    let most = most.map(|p| format!("{} {}{:.1} %", p.name, if p.sign < 0 { '-' } else { '+' }, 100.0 * p.share));
    let most: Vec<String> = most.collect();
    let (mean, std) = (short(l.mean), short(l.std));
    let row = format!("{:<30}{nominal:>11}{mean:>11}{std:>11}{range:>26}{share:>12}  {}", l.quantity, most.join(", "));
    let _ = writeln!(text, "{}", row.trim_end());
}

/// Five digits or so.
fn short(x: f64) -> String {
    match x.abs() {
        a if a >= 1000.0 => format!("{x:.1}"),
        a if a >= 100.0 => format!("{x:.2}"),
        a if a >= 10.0 => format!("{x:.3}"),
        a if a >= 0.01 || a <= 0.0 => format!("{x:.4}"),
        _ => format!("{x:.2e}"),
    }
}
