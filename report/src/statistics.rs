//! report: the page of a closing against published statistics. In: its JSON. Out: each figure's distribution over simulated runs beside the
//! test, explanations with their parameters, what one run tells apart.

use crate::chart::Range;
use crate::draw::Look;
use crate::html::{Cell, escape, section, table};
use crate::laid_out::laid_out;
use crate::legend::key;
use crate::plot::{Plot, Plots};
use crate::words::{number, p_value, plain_key};
use serde_json::Value;
use windfall_discover::close::{Figure, Role, Series, Topic};

/// Most explanations with a figure each.
const SHOWN: usize = 4;

/// The body; none for what is no such closing.
pub(crate) fn statistics(v: &Value, plots: &mut Plots) -> Option<String> {
    let verdict = text(v, "verdict")?;
    let conclusions: Vec<&str> = v.get("conclusions")?.as_array()?.iter().filter_map(Value::as_str).collect();
    let words: String = conclusions.iter().map(|c| format!("<li>{}</li>", escape(&in_words(c)))).collect();
    let mut out = format!(
        "<p class=\"lead\">{}</p>\n<div class=\"verdict {}\"><b>{}</b><ul>{words}</ul></div>\n",
        escape(text(v, "source").unwrap_or_default()),
        escape(verdict),
        escape(verdict)
    );
    let lead = "Look for bars that hold the mark at one: the published test among simulated runs. Dot: mean over runs; bar: central 90 %.";
    let mut drawn = figures("Declared model", v.get("before")?, plots);
    let all = v.get("explanations")?.as_array()?;
    for e in all.iter().take(SHOWN) {
        drawn += &figures(&format!("With {}", families(e, "families")), e.get("figures")?, plots);
    }
    out += &section("Figures over simulated runs", lead, &drawn);
    out += &distributions(v, plots);
    out += &histories(v, plots);
    let rows: Vec<Vec<Cell>> = all.iter().map(explanation).collect();
    let heads = ["effects", "p", "closes", "possible", "score", "parameters"];
    let lead = "Look at p and score: an explanation is possible when its p-value is not small; a smaller score is better.";
    out += &section("Explanations", lead, &some(&heads, &rows));
    let lead = "Look for powers near one: then one run of these figures tells the two apart.";
    let rows: Vec<Vec<Cell>> = v.get("separations").and_then(Value::as_array).into_iter().flatten().map(separation).collect();
    out += &section(
        "What would separate them",
        lead,
        &some(&["if this is true", "this is rejected", "in this share of runs"], &rows),
    );
    let screened: Vec<Vec<Cell>> = v.get("screened").and_then(Value::as_array).into_iter().flatten().map(screening).collect();
    let heads = ["effect", "largest change (std over runs)", "gap closed alone", "changes the figures", "searched"];
    let lead = "Effects that change no figure can be neither found nor excluded by such statistics.";
    out += &section("Every effect's screening", lead, &some(&heads, &screened));
    out += &section(
        "Options and seed",
        "",
        &laid_out(&serde_json::json!({ "seed": v["seed"], "flights": v["flights"], "options": v["options"] }), 3),
    );
    Some(out)
}

fn some(heads: &[&str], rows: &[Vec<Cell>]) -> String {
    if rows.is_empty() { String::new() } else { table(heads, rows) }
}

fn text<'a>(v: &'a Value, key: &str) -> Option<&'a str> {
    v.get(key)?.as_str()
}

fn float(v: &Value, key: &str) -> f64 {
    v.get(key).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

fn yes(v: &Value, key: &str) -> Cell {
    Cell::text(if v.get(key).and_then(Value::as_bool).unwrap_or(false) { "yes" } else { "no" })
}

fn families(v: &Value, key: &str) -> String {
    let all: Vec<&str> = v.get(key).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str).collect();
    if all.is_empty() {
        return "the declared model".to_owned();
    }
    all.iter().map(|f| plain_key(f).0).collect::<Vec<_>>().join(" + ")
}

/// Distributions over runs, over the test.
fn figures(title: &str, all: &Value, plots: &mut Plots) -> String {
    let one = |f: &Value| {
        let test = float(f, "test");
        let ends = f.get("central90")?.as_array()?;
        let (low, high) = (ends.first()?.as_f64()?, ends.get(1)?.as_f64()?);
        let fitted = if f.get("fitted")?.as_bool()? { "" } else { " (not fitted)" };
        Some(Range {
            name: format!("{} {}{fitted}", text(f, "statistic")?, quantity(text(f, "quantity")?)),
            ends: [low / test, high / test],
            inner: None,
            dot: float(f, "mean") / test,
            note: format!("test {}", number(test)),
            look: if title == "Declared model" { Look::Before } else { Look::After },
        })
    };
    let ranges: Vec<Range> = all.as_array().into_iter().flatten().filter_map(one).collect();
    let (title, x_label) = (title.to_owned(), "simulated over test".to_owned());
    plots.put(Plot::Ranges { title, x_label, marks: vec![1.0], ranges })
}

/// Keys of the colours of declared model and best explanation.
fn sides(v: &Value) -> [(&'static str, String); 2] {
    let best = v.get("explanations").and_then(|e| e.get(0)).map_or_else(String::new, |e| families(e, "families"));
    [("before", "declared model".to_owned()), ("after", format!("with {best}"))]
}

/// Every figure's distribution over simulated runs, the published one marked.
fn distributions(v: &Value, plots: &mut Plots) -> String {
    let list = |all: Option<&Value>| all.and_then(Value::as_array).cloned().unwrap_or_default();
    let (before, after) = (list(v.get("before")), list(v.get("explanations").and_then(|e| e.get(0)?.get("figures"))));
    let curve = |role: Role, f: &Value| {
        let x: Vec<f64> = f.get("quantiles")?.as_array()?.iter().filter_map(Value::as_f64).collect();
        let last = x.len().saturating_sub(1).max(1) as f64;
        Some(Series { role, y: (0..x.len()).map(|k| k as f64 / last).collect(), x, ..Series::default() })
    };
    let one = |(k, b): (usize, &Value)| {
        let x_label = format!("{} {}", text(b, "statistic")?, quantity(text(b, "quantity")?));
        let fitted = if b.get("fitted")?.as_bool()? { "" } else { ", not fitted" };
        let series = [curve(Role::Before, b), after.get(k).and_then(|a| curve(Role::After, a))].into_iter().flatten().collect();
        Some(Figure {
            topic: Topic::Distribution,
            title: format!("{x_label}: test {}{fitted}", number(float(b, "test"))),
            x_label,
            y_label: "share of runs below".to_owned(),
            marks: vec![float(b, "test")],
            series,
            ..Figure::default()
        })
    };
    let all: Vec<Figure> = before.iter().enumerate().filter_map(one).filter(|f| !f.series.is_empty()).collect();
    let drawn = plots.charts(all);
    if drawn.is_empty() {
        return drawn;
    }
    let [b, a] = sides(v);
    let marks = key(&[(b.0, &b.1), (a.0, &a.1), ("cut", "published test")]);
    let lead = "Look where the dashed line crosses the curves: at one half the published test is an ordinary run of that model, near zero or one \
                it is a run that the model hardly ever flies, and outside the curve one that it never does. A flat curve: runs differ much from \
                each other, and one test says little.";
    section("The test among simulated runs", lead, &format!("{marks}<div class=\"grid\">{drawn}</div>\n"))
}

/// One simulated run over time.
fn histories(v: &Value, plots: &mut Plots) -> String {
    let all = v.get("histories").and_then(Value::as_array).cloned().unwrap_or_default();
    let Some(run) = all.first().and_then(|h| h.get("run")?.as_u64()) else { return String::new() };
    let numbers = |h: &Value, name: &str| -> Vec<f64> {
        h.get(name).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_f64).collect()
    };
    let one = |name: &str| {
        let roles = [Role::Before, Role::After].into_iter().zip(&all);
        let series = roles.map(|(role, h)| Series { role, x: numbers(h, "t_s"), y: numbers(h, name), ..Series::default() });
        Figure {
            topic: Topic::Trajectory,
            title: format!("{} of simulated run {run}", quantity(name)),
            x_label: "time (s)".to_owned(),
            y_label: quantity(name),
            series: series.collect(),
            ..Figure::default()
        }
    };
    let drawn = plots.charts(["theta_deg", "omega_qr_deg_s"].map(one));
    let [b, a] = sides(v);
    let marks = key(&[(b.0, b.1.as_str()), (a.0, a.1.as_str())][..all.len().min(2)]);
    let lead = "Look whether such a run could be the published one: of a test of which statistics alone are printed there is no history, and a model \
                may have the right numbers by another kind of motion. The same gusts and sensor noise in both.";
    section("One simulated run", lead, &format!("{marks}<div class=\"grid\">{drawn}</div>\n"))
}

/// A sentence whose keys are words.
fn in_words(sentence: &str) -> String {
    let word = |w: &str| {
        let key = w.trim_end_matches([',', '.', ';', ':']);
        let rest = &w[key.len()..];
        if key.contains('_') {
            let name = quantity(key);
            let name = name.split(" (").next().unwrap_or(key).to_owned();
            return name + rest;
        }
        w.to_owned()
    };
    sentence.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// A quantity with its unit.
fn quantity(key: &str) -> String {
    match key {
        "theta_deg" => "Θ (deg)".to_owned(),
        "omega_qr_deg_s" => "ω_q,r (deg/s)".to_owned(),
        other => {
            let (name, unit) = plain_key(other);
            unit.map_or(name.clone(), |u| format!("{name} ({u})"))
        }
    }
}

fn explanation(e: &Value) -> Vec<Cell> {
    let one = |p: &Value| {
        let unit = text(p, "unit").filter(|u| *u != "-").map_or_else(String::new, |u| format!(" {u}"));
        let ends = p.get("ci95").and_then(Value::as_array).map_or_else(String::new, |c| {
            let end = |k: usize| c.get(k).and_then(Value::as_f64).map_or_else(|| "–".to_owned(), number);
            format!(" [{}, {}]", end(0), end(1))
        });
        let (name, of_key) = plain_key(text(p, "name").unwrap_or_default());
        let unit = if unit.is_empty() { of_key.map_or_else(String::new, |u| format!(" {u}")) } else { unit };
        format!("{name} {}{ends}{unit}", number(float(p, "estimate")))
    };
    let parameters: Vec<String> = e.get("parameters").and_then(Value::as_array).into_iter().flatten().map(one).collect();
    vec![
        Cell::text(families(e, "families")),
        Cell::Number(p_value(float(e, "p_value"))),
        yes(e, "closes"),
        yes(e, "possible"),
        Cell::number(float(e, "score")),
        Cell::Made(parameters.iter().map(|p| escape(p)).collect::<Vec<_>>().join("<br>")),
    ]
}

fn separation(s: &Value) -> Vec<Cell> {
    let power = format!("{:.0} %", 100.0 * float(s, "power"));
    vec![Cell::text(families(s, "truth")), Cell::text(families(s, "other")), Cell::Number(power)]
}

fn screening(s: &Value) -> Vec<Cell> {
    vec![
        Cell::text(plain_key(text(s, "family").unwrap_or_default()).0),
        Cell::number(float(s, "largest_change")),
        Cell::Number(format!("{:.0} %", 100.0 * float(s, "gap_closed"))),
        yes(s, "moves"),
        yes(s, "leads"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Five quantiles stand at 0, 1/4, … 1, the test is marked, and the explanation's curve lies beside the declared model's.
    #[test]
    fn exact_distributions_and_histories() {
        let over = |x: [f64; 5]| {
            serde_json::json!([{"quantity": "theta_deg", "statistic": "max", "fitted": true, "test": 7.0, "mean": 3.0,
                "central90": [1.0, 5.0], "quantiles": x}])
        };
        let history =
            |y: f64| serde_json::json!({"run": 9, "t_s": [0.0, 1.0], "theta_deg": [0.0, y], "omega_qr_deg_s": [y, 0.0]});
        let v = serde_json::json!({"before": over([1.0, 2.0, 3.0, 4.0, 5.0]), "histories": [history(1.0), history(2.0)],
            "explanations": [{"families": ["swirl"], "figures": over([5.0, 6.0, 7.0, 8.0, 9.0])}]});
        let mut plots = Plots::default();
        let html = distributions(&v, &mut plots) + &histories(&v, &mut plots);
        assert!(
            html.contains("max Θ (deg): test 7.000") && html.contains("with swirl") && html.contains("simulated run 9"),
            "{html}"
        );
        let Plot::Chart(f) = &plots.all[0] else { panic!("a chart") };
        assert_eq!((f.marks.as_slice(), f.series[1].x[2], f.series[1].y[2]), (&[7.0][..], 7.0, 0.5));
        let Plot::Chart(f) = &plots.all[1] else { panic!("a chart") };
        assert_eq!((f.series[0].y.as_slice(), f.series[1].y.as_slice()), (&[0.0, 1.0][..], &[0.0, 2.0][..]));
        assert!(
            distributions(&serde_json::json!({}), &mut plots).is_empty()
                && histories(&serde_json::json!({}), &mut plots).is_empty()
        );
    }

    #[test]
    fn exact_keys_of_a_sentence_in_words() {
        let found = in_words("median omega_qr_deg_s +20 %; max q_deg_s of it: axial_scale_m, duration_s.");
        assert_eq!(found, "median ω_q,r +20 %; max q of it: axial scale, duration.");
    }
}
