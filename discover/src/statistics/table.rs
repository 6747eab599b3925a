//! discover: the closing in words. In: a closing. Out: a text table in the layout of thesis Table 5.6, and conclusions.

use super::{Explanation, FigureOver, FigureSeparation, StatisticsClosing};
use std::fmt::Write as _;
use windfall_model::{Acts, effects};

/// The table: test, the source's own simulation, the declared model, and the best explanation with its 5 % and 95 % over runs.
#[must_use]
pub fn statistics_table(c: &StatisticsClosing) -> String {
    let mut text = format!("{}\n", c.source);
    let after = c.explanations.first();
    let _ =
        writeln!(text, "{:<24}{:>9}{:>12}{:>24}{:>34}", "", "test", "its own", "declared model", after.map_or("-".into(), name));
    let _ = writeln!(text, "{:<24}{:>9}{:>12}{:>24}{:>34}", "", "", "simulation", "mean [5 %, 95 %]", "mean [5 %, 95 %]");
    for (i, b) in c.before.iter().enumerate() {
        let own = c.source_simulation[i].map_or_else(|| "-".to_owned(), |v| format!("{v:.4}"));
        let a = after.map_or_else(|| "-".to_owned(), |e| cell(&e.figures[i]));
        let label = format!("{} {}{}", b.quantity.name(), b.statistic.name(), if b.fitted { "" } else { " *" });
        let _ = writeln!(text, "{label:<24}{:>9.4}{own:>12}{:>24}{a:>34}", b.test, cell(b));
    }
    if c.before.iter().any(|b| !b.fitted) {
        text.push_str("* not fitted, only held against the result\n");
    }
    text.push('\n');
    for e in &c.explanations {
        let _ = writeln!(
            text,
            "{:<36} {}  J {:6.2} on {}  p {:.3}  score {:7.2}",
            name(e),
            standing(e),
            e.j,
            e.degrees,
            e.p_value,
            e.score
        );
        for p in &e.parameters {
            let open = if p.decided { "" } else { "  not decided" };
            let unit = if p.unit == "-" { "" } else { p.unit };
            let _ = writeln!(text, "    {:<18} {:>10.4} [{:.4}, {:.4}] {unit}{open}", p.name, p.estimate, p.ci95[0], p.ci95[1]);
        }
    }
    text.push('\n');
    for line in &c.conclusions {
        let _ = writeln!(text, "{line}");
    }
    text
}

fn name(e: &Explanation) -> String {
    e.families.join(" + ")
}

fn standing(e: &Explanation) -> &'static str {
    match (e.closes, e.possible) {
        (true, true) => "closes       ",
        (true, false) => "closes, p low",
        (false, true) => "possible     ",
        (false, false) => "rejected     ",
    }
}

fn cell(f: &FigureOver) -> String {
    format!("{:.2} [{:.2}, {:.2}]", f.mean, f.central90[0], f.central90[1])
}

/// What the figures decide and what they do not.
pub(super) fn conclusions(c: &StatisticsClosing) -> Vec<String> {
    let mut all = vec![declared(c)];
    let possible: Vec<&Explanation> = c.explanations.iter().filter(|e| e.possible).collect();
    let alone: Vec<String> = possible.iter().filter(|e| e.families.len() == 1).map(|e| name(e)).collect();
    let (closing, failing): (Vec<&Explanation>, Vec<&Explanation>) = c.explanations.iter().partition(|e| e.closes);
    if !closing.is_empty() {
        all.push(format!("Close all fitted figures: {}.", closing.iter().map(|e| name(e)).collect::<Vec<_>>().join("; ")));
    }
    for e in failing {
        all.push(format!("{} does not close: {}.", name(e), short(e)));
    }
    if possible.len() > 1 {
        let names: Vec<String> = possible.iter().map(|e| name(e)).collect();
        let both = |s: &&FigureSeparation| possible.iter().filter(|e| e.families == s.truth || e.families == s.other).count() > 1;
        let power = c.separations.iter().filter(both).map(|s| s.power).fold(0.0, f64::max);
        let least = c.separations.iter().filter(both).map(|s| s.power).fold(1.0, f64::min);
        all.push(format!(
            "These figures cannot decide between {}: had one of them been true, another would be rejected at 5 % in {:.0} to {:.0} % of \
             such runs.",
            names.join("; "),
            100.0 * least,
            100.0 * power
        ));
        let mut families: Vec<&str> = possible.iter().flat_map(|e| e.families.iter().copied()).collect();
        families.sort_unstable();
        families.dedup();
        for f in families {
            if let Some(effect) = effects::find(f, Acts::Lander) {
                all.push(format!("To tell {f}: {}.", effect.separate_by));
            }
        }
    }
    if alone.is_empty() && !possible.is_empty() {
        all.push("No single effect of the catalogue that was searched does it alone.".to_owned());
    }
    all.push(
        "A possible explanation is rejected wrongly in 5 % of runs. The search is not exhaustive: what is not listed is not excluded."
            .to_owned(),
    );
    if let Some(best) = c.explanations.first() {
        all.extend(held(best));
        let open: Vec<String> = best.parameters.iter().filter(|p| !p.decided).map(|p| p.name.clone()).collect();
        if !open.is_empty() {
            all.push(format!("In {}, these figures leave open: {}.", name(best), open.join(", ")));
        }
        all.push(format!("{:.0} % of its runs would have left the test section before their end.", 100.0 * best.left_section));
    }
    if let Some(worst) = c.processing.iter().map(|x| x.abs()).reduce(f64::max) {
        all.push(format!("Instruments and smoothing change a mean figure by {:.1} % at most.", 100.0 * worst));
    }
    all
}

fn declared(c: &StatisticsClosing) -> String {
    let parts: Vec<String> = c
        .before
        .iter()
        .filter(|f| f.fitted && f.statistic.name() == "mean")
        .map(|f| format!("mean {} {:+.0} %", f.quantity.name(), 100.0 * f.relative))
        .collect();
    format!("Declared model: {}; probability of the test {:.4}.", parts.join(", "), c.before_p_value)
}

fn short(e: &Explanation) -> String {
    let bad: Vec<String> = e
        .figures
        .iter()
        .filter(|f| f.fitted && (!f.inside || f.relative.abs() > 0.15))
        .map(|f| {
            format!(
                "{} {} {:+.0} %{}",
                f.statistic.name(),
                f.quantity.name(),
                100.0 * f.relative,
                if f.inside { "" } else { ", outside 90 %" }
            )
        })
        .collect();
    bad.join("; ")
}

/// Figures that were not fitted.
fn held(e: &Explanation) -> Vec<String> {
    e.figures
        .iter()
        .filter(|f| !f.fitted)
        .map(|f| {
            let word = if f.inside { "inside" } else { "outside" };
            format!(
                "Not fitted: {} {} of the test, {:.1}, is {word} the central 90 % of {} [{:.1}, {:.1}].",
                f.statistic.name(),
                f.quantity.name(),
                f.test,
                name(e),
                f.central90[0],
                f.central90[1]
            )
        })
        .collect()
}

#[cfg(test)]
mod tests;
