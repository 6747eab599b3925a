//! report: a study's page. In: its summary. Out: HTML; for every method where its errors lie and whether its intervals hold them.

use crate::chart::Range;
use crate::draw::Look;
use crate::html::{Cell, escape, section, table};
use crate::legend::key;
use crate::number;
use crate::pairs::Pair;
use crate::plot::{Plot, Plots};
use crate::study_closings::closings;
use crate::study_varied::over_varied;
use crate::words::with_interval;
use windfall_discover::NORMAL_95;
use windfall_discover::close::{Figure, Role, Series};
use windfall_study::{NumberLine, ParameterSummary, Rate, RecoveredDraw, RecoveryLine, ReliabilityPoint, Summary, WordLine};

/// Share of the draws that a stated interval should cover.
const STATED: f64 = 0.95;

/// The body of a study's page.
pub(crate) fn study_body(s: &Summary, plots: &mut Plots) -> String {
    let mut out = format!("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape(&s.study), escape(&lead(s)));
    let mut methods: Vec<&str> = Vec::new();
    for p in &s.parameters {
        if !methods.contains(&p.method.as_str()) {
            methods.push(&p.method);
        }
    }
    for method in methods {
        let own: Vec<&ParameterSummary> = s.parameters.iter().filter(|p| p.method == method).collect();
        let title = if method == "close" { "effects found by closing" } else { method };
        out += &section(
            &format!("{title}: errors and coverage"),
            "Errors should lie inside the outer marks, and coverage bars should reach the mark at 0.95.",
            &(errors(&own, &s.numbers, plots) + &coverage(&own, plots) + &parameters(&own)),
        );
        let recovered: Vec<&RecoveryLine> = s.recovery.iter().filter(|r| r.method == method).collect();
        let lead = "Look for a blue curve on the dashed one: of intervals that are stated to hold the truth with some probability, how many do. \
                    Below the line: stated errors are too small. Normal intervals of every size, all parameters together; shaded: from the worst \
                    parameter to the best.";
        out += &section(&format!("{title}: reliability of intervals"), lead, &reliability(&recovered, plots));
        let lead = "Look for bars across the dashed line, which is what was put in; one in twenty may miss it and has the other colour. The first \
                    draws, each estimate with its 95 % interval.";
        out += &section(&format!("{title}: recovery"), lead, &recovery(&recovered, plots));
        out += &over_varied(&format!("{title}: errors over what was varied"), &recovered, &s.varied, plots);
    }
    out += &s.closings.as_ref().map_or_else(String::new, |c| closings(c, plots));
    let rates: Vec<Range> =
        s.rates.iter().filter(|r| !r.name.ends_with(".covered")).filter_map(|r| share(r, &words(&r.name))).collect();
    let lead = "Dot: share of draws. Bar: its 95 % interval (Clopper and Pearson).";
    out += &section("How often", lead, &ranges(plots, "Share of draws", rates, &[], "share"));
    // The confusion matrix has what those two say.
    let shown = |w: &&WordLine| s.closings.is_none() || !["close.families", "close.truth"].contains(&w.name.as_str());
    let shown = s.words.iter().filter(shown).flat_map(|w| w.counts.iter().map(move |c| (w.name.as_str(), c)));
    let rows: Vec<Vec<Cell>> = shown
        .map(|(w, c)| {
            vec![Cell::text(words(w)), Cell::text(if c.name.is_empty() { "none" } else { &c.name }), Cell::Number(of(c))]
        })
        .collect();
    out += &section("What was said how often", "", &some(&["column", "word", "draws"], &rows));
    let failed = |m: &windfall_study::Count| vec![Cell::text(&m.message), Cell::Number(m.count.to_string())];
    let rows: Vec<Vec<Cell>> = s.failures.messages.iter().map(failed).collect();
    out + &section("Failures", "", &some(&["message", "draws"], &rows))
}

fn lead(s: &Summary) -> String {
    let early =
        if s.stopped_early { format!(" of {} ordered: the stopping rule was content", s.draws_ordered) } else { String::new() };
    format!("{} draws{early}, seed {}; {} failed.", s.draws, s.seed, s.failures.any.count)
}

fn ranges(plots: &mut Plots, title: &str, ranges: Vec<Range>, marks: &[f64], x_label: &str) -> String {
    plots.put(Plot::Ranges { title: title.to_owned(), x_label: x_label.to_owned(), marks: marks.to_vec(), ranges })
}

fn some(heads: &[&str], rows: &[Vec<Cell>]) -> String {
    if rows.is_empty() { String::new() } else { table(heads, rows) }
}

fn of(r: &Rate) -> String {
    format!("{} of {}", r.count, r.of)
}

/// A column in words: `close.right_or_rival` is `close: right or rival`.
fn words(column: &str) -> String {
    column.replacen('.', ": ", 1).replace(['.', '_'], " ")
}

fn name(p: &ParameterSummary) -> String {
    format!("{} {}", p.coefficient, p.name)
}

/// Quantiles of the errors over the mean stated standard error; over their scatter where no error is stated.
fn errors(own: &[&ParameterSummary], numbers: &[NumberLine], plots: &mut Plots) -> String {
    let one = |p: &&ParameterSummary| {
        let column = format!("{}.{}.{}.error", p.method, p.coefficient, p.name);
        let line = numbers.iter().find(|n| n.name == column)?;
        let unit = p.mean_std_error.or(p.scatter).filter(|u| *u > 0.0)?;
        let at = |wanted: f64| Some(line.quantiles.iter().find(|q| (q.p - wanted).abs() < 1e-9)?.value / unit);
        Some(Range {
            name: name(p),
            ends: [at(0.025)?, at(0.975)?],
            inner: Some([at(0.25)?, at(0.75)?]),
            dot: at(0.5)?,
            note: format!("bias {}", number(p.bias)),
            look: Look::After,
        })
    };
    let rows: Vec<Range> = own.iter().filter_map(one).collect();
    let label = "error in stated standard errors: median, half and 95 % of the draws";
    ranges(plots, "Errors: inside the outer marks where stated errors are true", rows, &[-NORMAL_95, 0.0, NORMAL_95], label)
}

fn coverage(own: &[&ParameterSummary], plots: &mut Plots) -> String {
    let rows: Vec<Range> = own.iter().filter_map(|p| share(&p.coverage, &name(p))).collect();
    ranges(plots, "Coverage of the stated 95 % intervals", rows, &[STATED], "share of draws, with its 95 % interval")
}

fn share(r: &Rate, name: &str) -> Option<Range> {
    Some(Range { name: name.to_owned(), ends: r.ci95?, inner: None, dot: r.rate?, note: of(r), look: Look::After })
}

fn parameters(own: &[&ParameterSummary]) -> String {
    let maybe = |x: Option<f64>| Cell::Number(x.map_or_else(|| "–".to_owned(), number));
    let row = |p: &&ParameterSummary| {
        vec![
            Cell::text(name(p)),
            Cell::Number(bias(p)),
            maybe(p.scatter),
            maybe(p.mean_std_error),
            maybe(p.scatter_over_std_error),
            Cell::number(p.rms_error),
            maybe(p.coverage.rate),
            Cell::Number(p.n.to_string()),
        ]
    };
    let heads = ["parameter", "bias ± 95 %", "scatter", "stated", "scatter/stated", "rms error", "covered", "draws"];
    some(&heads, &own.iter().map(row).collect::<Vec<_>>())
}

fn bias(p: &ParameterSummary) -> String {
    let (bias, half) = with_interval(p.bias, p.bias_ci95.map(|[a, b]| 0.5 * (b - a)));
    half.map_or_else(|| bias.clone(), |h| format!("{bias} ± {h}"))
}

/// Share of intervals that hold the truth over the probability with which they are stated to.
fn reliability(own: &[&RecoveryLine], plots: &mut Plots) -> String {
    let Some(first) = own.first() else { return String::new() };
    let stated: Vec<f64> = first.reliability.iter().map(|r| r.stated).collect();
    let at = |k: usize| own.iter().filter_map(move |l| l.reliability.get(k));
    let pooled = |k: usize| at(k).map(|r| r.count as f64).sum::<f64>() / at(k).map(|r| r.of as f64).sum::<f64>();
    let end = |k: usize, pick: fn(f64, f64) -> f64, start: f64| at(k).map(ReliabilityPoint::share).fold(start, pick);
    let places = || 0..stated.len();
    let band = [places().map(|k| end(k, f64::min, 1.0)).collect(), places().map(|k| end(k, f64::max, 0.0)).collect()];
    let line = Series { role: Role::Noise, x: vec![0.0, 1.0], y: vec![0.0, 1.0], ..Series::default() };
    let curve =
        Series { role: Role::After, x: stated.clone(), y: places().map(pooled).collect(), band: Some(band), ..Series::default() };
    let figure = Figure {
        title: format!("{}: reliability of the stated intervals", first.method),
        x_label: "stated probability".to_owned(),
        y_label: "fraction that holds the truth".to_owned(),
        series: vec![line, curve],
        ..Figure::default()
    };
    let marks = key(&[("after", "all parameters"), ("noise", "as stated")]);
    format!("{marks}<div class=\"grid\">{}</div>\n", plots.charts([figure]))
}

/// Every parameter's first draws.
fn recovery(own: &[&RecoveryLine], plots: &mut Plots) -> String {
    let one = |l: &&RecoveryLine| {
        let of = |d: &RecoveredDraw| Pair { truth: d.truth, estimate: d.estimate, half: NORMAL_95 * d.std_error };
        let name = format!("{} {}", l.coefficient, l.name);
        Plot::Pairs { title: format!("{}: {name}", l.method), y_label: name, pairs: l.draws.iter().map(of).collect() }
    };
    let drawn: String = own.iter().map(|l| plots.put(one(l))).collect();
    if drawn.is_empty() { drawn } else { format!("<div class=\"grid\">{drawn}</div>\n") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four errors of a parameter whose stated error is one: the median dot lies on the mark at zero, the coverage where it must.
    #[test]
    fn law_a_summary_becomes_figures_with_its_numbers() {
        let summary: Summary = serde_json::from_value(serde_json::json!({
            "study": "noise <1>", "seed": 3, "draws": 40, "draws_ordered": 40, "stopped_early": false,
            "failures": {"any": {"name": "failure", "count": 1, "of": 40, "rate": 0.025, "ci95": [0.001, 0.13]},
                         "messages": [{"message": "fell & broke", "count": 1}]},
            "parameters": [{"method": "m", "coefficient": "C", "name": "p", "n": 39, "bias": 0.125, "bias_ci95": [0.1, 0.15],
                "scatter": 1.0, "scatter_ci95": null, "rms_error": 1.0, "mean_std_error": 1.0, "scatter_over_std_error": 1.0,
                "coverage": {"name": "C p", "count": 36, "of": 39, "rate": 0.923, "ci95": [0.79, 0.98]}}],
            "rates": [], "words": [],
            "numbers": [{"name": "m.C.p.error", "n": 39, "mean": 0.125, "mean_ci95": null, "std": 1.0, "std_ci95": null, "min": -2.0,
                "max": 2.0, "quantiles": [{"p": 0.025, "value": -2.0}, {"p": 0.25, "value": -0.7}, {"p": 0.5, "value": 0.0},
                    {"p": 0.75, "value": 0.7}, {"p": 0.975, "value": 2.0}]}],
            "recovery": [{"method": "m", "coefficient": "C", "name": "p",
                "draws": [{"truth": 1.0, "estimate": 1.5, "std_error": 0.5}, {"truth": 1.0, "estimate": 3.0, "std_error": 0.5}],
                "reliability": [{"stated": 0.5, "count": 20, "of": 40, "ci95": [0.3, 0.7]},
                    {"stated": 0.9, "count": 30, "of": 40, "ci95": [0.6, 0.9]}]}]
        }))
        .expect("a summary");
        let mut plots = Plots::default();
        let body = study_body(&summary, &mut plots);
        for text in ["noise &lt;1&gt;", "40 draws", "36 of 39", "fell &amp; broke", "0.1250", "Coverage"] {
            assert!(body.contains(text), "{text} in {body}");
        }
        // Errors from −2 to 2: the median, zero, lies on the middle mark.
        let Plot::Ranges { ranges, marks, .. } = &plots.all[0] else { panic!("errors first") };
        assert_eq!((ranges[0].ends, ranges[0].dot, marks[1]), ([-2.0, 2.0], 0.0, 0.0));
        assert!(!body.contains("How often") && !body.contains("Confusion"), "no rates, no section");
        let Plot::Chart(reliability) = &plots.all[2] else { panic!("reliability after coverage") };
        assert_eq!((reliability.series[1].x.as_slice(), reliability.series[1].y.as_slice()), (&[0.5, 0.9][..], &[0.5, 0.75][..]));
        let Plot::Pairs { pairs, .. } = &plots.all[3] else { panic!("recovery last") };
        assert!(pairs.len() == 2 && (pairs[1].half - 0.5 * NORMAL_95).abs() < 1e-12);
    }
}
