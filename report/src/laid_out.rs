//! report: results that have no page of their own. In: JSON. Out: tables, every list of records one.

use crate::html::{Cell, escape, table};
use serde_json::{Map, Value};

/// A value as HTML: scalars of a record in one table, lists of records as tables, the rest below headings.
pub(crate) fn laid_out(value: &Value, level: usize) -> String {
    match value {
        Value::Object(map) => record(map, level),
        Value::Array(items) => list(items, level),
        other => format!("<p>{}</p>\n", escape(&scalar(other).unwrap_or_default())),
    }
}

fn record(map: &Map<String, Value>, level: usize) -> String {
    let rows: Vec<Vec<Cell>> =
        map.iter().filter_map(|(k, v)| Some(vec![Cell::text(words(k)), Cell::Number(scalar(v)?)])).collect();
    let mut out = if rows.is_empty() { String::new() } else { table(&["quantity", "value"], &rows) };
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
