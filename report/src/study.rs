//! report: a study's page. In: its summary. Out: HTML; for every method where its errors lie and whether its intervals hold them.

use crate::chart::Range;
use crate::draw::Look;
use crate::html::{Cell, escape, section, table};
use crate::number;
use crate::plot::{Plot, Plots};
use windfall_verify::study::{NumberLine, ParameterSummary, Rate, Summary};

/// Share of the draws that a stated interval should cover, and the number of standard errors that it reaches.
const STATED: f64 = 0.95;
const REACH: f64 = 1.96;

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
        out += &section(
            method,
            "Errors should lie inside the outer marks, and coverage bars should reach the mark at 0.95.",
            &(errors(&own, &s.numbers, plots) + &coverage(&own, plots) + &parameters(&own)),
        );
    }
    let rates: Vec<Range> = s.rates.iter().filter(|r| !r.name.ends_with(".covered")).filter_map(|r| share(r, &r.name)).collect();
    let lead = "Dot: share of draws. Bar: its 95 % interval (Clopper and Pearson).";
    out += &section("How often", lead, &ranges(plots, "Share of draws", rates, &[], "share"));
    let words = s.words.iter().flat_map(|w| w.counts.iter().map(move |c| (w.name.as_str(), c)));
    let rows: Vec<Vec<Cell>> = words.map(|(w, c)| vec![Cell::text(w), Cell::text(&c.name), Cell::Number(of(c))]).collect();
    out += &section("Words", "", &some(&["column", "word", "draws"], &rows));
    let failed = |m: &windfall_verify::study::Count| vec![Cell::text(&m.message), Cell::Number(m.count.to_string())];
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
    ranges(plots, "Errors: inside the outer marks where stated errors are true", rows, &[-REACH, 0.0, REACH], label)
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
            Cell::Number(
                p.bias_ci95.map_or_else(|| number(p.bias), |[a, b]| format!("{} [{}, {}]", number(p.bias), number(a), number(b))),
            ),
            maybe(p.scatter),
            maybe(p.mean_std_error),
            maybe(p.scatter_over_std_error),
            Cell::number(p.rms_error),
            maybe(p.coverage.rate),
            Cell::Number(p.n.to_string()),
        ]
    };
    let heads = ["parameter", "bias [95 %]", "scatter", "stated", "scatter/stated", "rms error", "covered", "draws"];
    some(&heads, &own.iter().map(row).collect::<Vec<_>>())
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
                    {"p": 0.75, "value": 0.7}, {"p": 0.975, "value": 2.0}]}]
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
        assert!(!body.contains("How often"), "no rates, no section");
    }
}
