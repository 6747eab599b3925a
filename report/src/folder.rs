//! report: the page of any folder of results. In: results as they were read. Out: HTML; what has no page of its own is laid out as
//! tables, every list of records one table.

use crate::closing::closing_body;
use crate::html::{Cell, escape, page, section, table};
use crate::study::study_body;
use crate::svg::chart;
use serde_json::{Map, Value};
use windfall_verify::close::{Closing, Figure, Role, Series, Topic};
use windfall_verify::study::Summary;

/// What a folder holds.
#[derive(Default)]
pub struct FolderResults<'a> {
    /// A closing with a campaign.
    pub closing: Option<&'a Closing>,
    /// Its figures.
    pub figures: &'a [Figure],
    /// A study.
    pub study: Option<&'a Summary>,
    /// Any other results: title, then the JSON.
    pub others: &'a [(String, Value)],
}

/// The page of a folder.
#[must_use]
pub fn folder_page(title: &str, results: &FolderResults<'_>) -> String {
    let closing = results.closing.map(|c| closing_body(c, results.figures));
    let studied = results.study.map(study_body);
    let mut body: String = closing.into_iter().chain(studied).collect();
    if body.is_empty() {
        body = format!("<h1>{}</h1>\n", escape(title));
    }
    for (name, value) in results.others {
        let mut value = value.clone();
        let drawn = bands(&mut value);
        body += &section(name, "", &(drawn + &laid_out(&value, 3)));
    }
    page(title, &body)
}

/// Figures of what has bands: identified coefficients over the angle, re-simulated runs over time. Their series, and the covariance,
/// are taken out of the value: no one reads them as tables.
fn bands(value: &mut Value) -> String {
    let mut figures = Vec::new();
    for set in value.get_mut("data_sets").and_then(Value::as_array_mut).into_iter().flatten() {
        let Some(map) = set.as_object_mut() else { continue };
        map.remove("covariance");
        let curves = map.remove("curves");
        // Kinds of run alone are in the file; the page shows all runs together.
        if map.get("name").and_then(Value::as_str) == Some("combined") {
            figures.extend(curves.iter().flat_map(|c| c.as_array()).flatten().filter_map(curve));
        }
    }
    for run in value.get_mut("runs").and_then(Value::as_array_mut).into_iter().flatten() {
        let Some(map) = run.as_object_mut() else { continue };
        let bands = map.remove("bands");
        let name = map.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
        figures.extend(bands.iter().flat_map(|b| b.as_array()).flatten().filter_map(|b| over_time(&name, b)));
    }
    if figures.is_empty() {
        return String::new();
    }
    let note = "Shaded, and ± in the titles: 95 % at each point, from the covariance of the estimates. Thick grey: measured.";
    format!("<p class=\"note\">{note}</p>\n<div class=\"grid\">{}</div>\n", figures.iter().map(chart).collect::<String>())
}

/// Half the band where it is widest: it may be thinner than the curve.
fn widest([low, high]: &[Vec<f64>; 2]) -> String {
    format!(", ± {} at most", crate::number(low.iter().zip(high).map(|(a, b)| 0.5 * (b - a)).fold(0.0, f64::max)))
}

fn numbers(value: &Value, key: &str) -> Option<Vec<f64>> {
    value.get(key)?.as_array()?.iter().map(Value::as_f64).collect()
}

fn curve(c: &Value) -> Option<Figure> {
    let word = |key: &str| c.get(key).and_then(Value::as_str);
    let angle = match word("over")? {
        "alpha" => "α",
        "beta" => "β",
        _ => "α_T",
    };
    let quantity = word("quantity")?;
    let band = [numbers(c, "low")?, numbers(c, "high")?];
    Some(Figure {
        topic: Topic::Variable,
        title: format!("{quantity} over {angle}{}", widest(&band)),
        x_label: format!("{angle}, deg"),
        y_label: quantity.to_owned(),
        log_y: false,
        series: vec![Series { role: Role::After, x: numbers(c, "angle_deg")?, y: numbers(c, "value")?, band: Some(band) }],
    })
}

fn over_time(run: &str, b: &Value) -> Option<Figure> {
    let (title, unit) = match b.get("quantity")?.as_str()? {
        "theta_deg" => ("Θ", "deg"),
        _ => ("ω_q,r", "deg/s"),
    };
    let t = numbers(b, "t_s")?;
    let band = [numbers(b, "low")?, numbers(b, "high")?];
    let measured = Series { role: Role::Measured, x: t.clone(), y: numbers(b, "test")?, band: None };
    Some(Figure {
        topic: Topic::Trajectory,
        title: format!("{run}: {title}{}", widest(&band)),
        x_label: "time, s".to_owned(),
        y_label: format!("{title}, {unit}"),
        log_y: false,
        series: vec![measured, Series { role: Role::After, x: t, y: numbers(b, "median")?, band: Some(band) }],
    })
}

/// A value as HTML: scalars of a record in one table, lists of records as tables, the rest below headings.
fn laid_out(value: &Value, level: usize) -> String {
    match value {
        Value::Object(map) => record(map, level),
        Value::Array(items) => list(items, level),
        other => format!("<p>{}</p>\n", escape(&scalar(other).unwrap_or_default())),
    }
}

fn record(map: &Map<String, Value>, level: usize) -> String {
    let rows: Vec<Vec<Cell>> =
        map.iter().filter_map(|(k, v)| Some(vec![Cell::text(words(k)), Cell::Number(scalar(v)?)])).collect();
    let mut out = if rows.is_empty() { String::new() } else { table(&["", ""], &rows) };
    for (k, v) in map.iter().filter(|(_, v)| scalar(v).is_none()) {
        let body = laid_out(v, level + 1);
        if !body.is_empty() {
            let h = level.min(6);
            out += &format!("<h{h}>{}</h{h}>\n{body}", escape(&words(k)));
        }
    }
    out
}

fn list(items: &[Value], level: usize) -> String {
    let records: Vec<&Map<String, Value>> = items.iter().filter_map(Value::as_object).collect();
    if records.len() < items.len() || records.is_empty() {
        let all: Vec<String> = items
            .iter()
            .map(|v| format!("<li>{}</li>", escape(&v.as_str().map_or_else(|| v.to_string(), str::to_owned))))
            .collect();
        return if all.is_empty() { String::new() } else { format!("<ul>{}</ul>\n", all.concat()) };
    }
    let mut heads: Vec<&str> = Vec::new();
    for key in records.iter().flat_map(|r| r.iter().filter(|(_, v)| scalar(v).is_some()).map(|(k, _)| k.as_str())) {
        if !heads.contains(&key) {
            heads.push(key);
        }
    }
    // Records that hold records come one below the other; flat ones are a table.
    let nested = |r: &&Map<String, Value>| r.values().any(|v| scalar(v).is_none());
    if records.iter().any(nested) {
        let one = |(k, r): (usize, &&Map<String, Value>)| {
            let named = ["name", "title", "family"].iter().find_map(|n| r.get(*n).and_then(Value::as_str));
            let h = level.min(6);
            format!("<h{h}>{}</h{h}>\n{}", escape(named.unwrap_or(&format!("{}", k + 1))), record(r, level + 1))
        };
        return records.iter().enumerate().map(one).collect();
    }
    let cell = |v: Option<&Value>| match v {
        Some(Value::Number(_)) => Cell::Number(v.and_then(scalar).unwrap_or_default()),
        other => Cell::text(other.and_then(scalar).unwrap_or_default()),
    };
    let rows: Vec<Vec<Cell>> = records.iter().map(|r| heads.iter().map(|h| cell(r.get(*h))).collect()).collect();
    let names: Vec<String> = heads.iter().map(|h| words(h)).collect();
    table(&names.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

/// Text of a scalar or of a short list of scalars; none for what needs room.
fn scalar(v: &Value) -> Option<String> {
    match v {
        Value::Null => Some("–".to_owned()),
        Value::Bool(b) => Some(if *b { "yes" } else { "no" }.to_owned()),
        Value::Number(n) if n.is_f64() => n.as_f64().map(crate::number),
        Value::Number(n) => Some(n.to_string()),
        Value::String(s) => Some(s.clone()),
        Value::Array(a) if (1..=6).contains(&a.len()) && a.iter().all(|v| !v.is_array() && !v.is_object()) => {
            let all: Option<Vec<String>> = a.iter().map(scalar).collect();
            let inner = all?.join(", ");
            Some(if a[0].is_number() { format!("[{inner}]") } else { inner })
        }
        _ => None,
    }
}

/// A key as words.
fn words(key: &str) -> String {
    key.replace('_', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_bands_are_drawn_and_their_series_not_laid_out() {
        let value = serde_json::json!({"data_sets": [{"name": "combined", "covariance": [[123.456]], "curves": [{
            "quantity": "C_A", "over": "alpha_T", "angle_deg": [0.0, 10.0, 20.0], "value": [6.6, 6.5, 6.2], "low": [6.5, 6.4, 6.0],
            "high": [6.7, 6.6, 6.4]}]}]});
        let page = folder_page("r", &FolderResults { others: &[("Identification".to_owned(), value)], ..Default::default() });
        assert!(page.contains("C_A over α_T, ± 0.2000 at most") && page.contains("class=\"band after\""), "{page}");
        assert!(!page.contains("123.4"), "a covariance is no table to read");
    }

    #[test]
    fn law_any_result_is_laid_out_and_escaped() {
        let value = serde_json::json!({
            "method": "equation-error", "n": 3, "ci95": [1.0, 2.0],
            "data_sets": [{"name": "<combined>", "parameters": [{"name": "CA_T0", "estimate": 6.662}]}],
            "warnings": [], "series": [[1.0], [2.0]]
        });
        let page =
            folder_page("results", &FolderResults { others: &[("identification".to_owned(), value)], ..Default::default() });
        for text in ["equation-error", "[1.000, 2.000]", "&lt;combined&gt;", "CA_T0", "6.662"] {
            assert!(page.contains(text), "{text}");
        }
        assert!(!page.contains("<combined>"));
    }
}
