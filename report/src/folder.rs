//! report: the page of any folder of results. In: results as they were read. Out: HTML; what has no page of its own is laid out as
//! tables, every list of records one table.

use crate::closing::closing_body;
use crate::html::{Cell, escape, page, section, table};
use crate::study::study_body;
use serde_json::{Map, Value};
use windfall_verify::close::{Closing, Figure};
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
        body += &section(name, "", &laid_out(value, 3));
    }
    page(title, &body)
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
