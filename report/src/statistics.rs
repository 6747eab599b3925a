//! report: the page of a closing against published statistics. In: its JSON. Out: each figure's distribution over simulated runs beside the
//! test, explanations with their parameters, what one run tells apart.

use crate::chart::Range;
use crate::draw::Look;
use crate::html::{Cell, escape, section, table};
use crate::laid_out::laid_out;
use crate::plot::{Plot, Plots};
use crate::words::{number, p_value, plain_key};
use serde_json::Value;

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
        Cell::text(parameters.join("; ")),
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
    use super::in_words;

    #[test]
    fn exact_keys_of_a_sentence_in_words() {
        let found = in_words("median omega_qr_deg_s +20 %; max q_deg_s of it: axial_scale_m, duration_s.");
        assert_eq!(found, "median ω_q,r +20 %; max q of it: axial scale, duration.");
    }
}
