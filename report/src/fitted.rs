//! report: declared parameters that a closing fitted, and coefficients at the settings flown. In: a closing. Out: HTML.

use crate::html::{Cell, escape, table};
use crate::words::{number, with_interval};
use std::fmt::Write as _;
use windfall_discover::NORMAL_95;
use windfall_discover::close::{Closing, EffectLine, FlownValue, Instead, ParameterLine, RunValue};
use windfall_discover::words::listed;

/// Declared parameters: in the file, fitted with the declared model, and with effects; and what would do as well.
pub(crate) fn shifts(c: &Closing) -> String {
    let error = |of: &[ParameterLine], name: &str| of.iter().find(|p| p.name == name).and_then(|p| p.std_error);
    let with = |x: f64, s: Option<f64>| {
        let (estimate, half) = with_interval(x, s.map(|s| NORMAL_95 * s));
        half.map_or(estimate.clone(), |h| format!("{estimate} ± {h}"))
    };
    let rows: Vec<Vec<Cell>> = c
        .shifts
        .iter()
        .map(|s| {
            let before = error(&c.before.parameters, &s.name);
            let moved = (s.after - s.before) / before.unwrap_or(f64::NAN);
            let moved = if moved.is_finite() { format!("{moved:+.1}") } else { "–".to_owned() };
            let file = c.after.parameters.iter().find(|p| p.name == s.name);
            let declared = file.and_then(|p| p.declared).map_or_else(|| "–".to_owned(), number);
            let prior = file.and_then(|p| p.declared_std).map_or_else(|| "none".to_owned(), number);
            vec![
                Cell::text(&s.name),
                Cell::Number(declared),
                Cell::Number(prior),
                Cell::Number(with(s.before, before)),
                Cell::Number(with(s.after, error(&c.after.parameters, &s.name))),
                Cell::Number(moved),
            ]
        })
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let heads =
        ["parameter", "in the file", "its prior, 1 σ", "declared model, fitted", "with effects", "moved / std error before"];
    table(&heads, &rows) + &instead(c)
}

/// What would do as well as a parameter that the runs moved.
fn instead(c: &Closing) -> String {
    let mut out = String::new();
    for f in &c.instead {
        let one = |i: &Instead| {
            let unit = if i.unit == "-" { String::new() } else { format!(" {}", i.unit) };
            format!("{} of {} for {}{unit} ({})", i.key, number(i.estimate), number(i.declared), i.meaning)
        };
        let list: Vec<String> = f.instead.iter().map(one).collect();
        let words = if list.is_empty() {
            format!("No other number of the body, the air or the instruments would do as well as {}.", f.parameter)
        } else {
            format!("In place of {} these would do as well, each alone: {}.", f.parameter, listed(&list))
        };
        let _ = writeln!(out, "<p>{}</p>", escape(&words));
    }
    out
}

/// A number with its interval of 95 %.
fn interval(value: f64, std_error: f64) -> Cell {
    let (estimate, half) = with_interval(value, Some(NORMAL_95 * std_error));
    Cell::Number(half.map_or(estimate.clone(), |h| format!("{estimate} ± {h}")))
}

/// What differs from run to run, run by run.
pub(crate) fn by_run(e: &EffectLine) -> String {
    if e.by_run.is_empty() {
        return String::new();
    }
    let row = |r: &RunValue| vec![Cell::text(&r.run), Cell::text(&r.name), interval(r.value, r.std_error), Cell::text(&r.unit)];
    let rows: Vec<Vec<Cell>> = e.by_run.iter().map(row).collect();
    table(&["run", "number", "departure ± 95 %", "unit"], &rows)
}

/// Coefficients of an effect that follow settings of the runs, where they were flown.
pub(crate) fn flown(e: &EffectLine) -> String {
    if e.flown.is_empty() {
        return String::new();
    }
    let value = |v: &FlownValue| interval(v.estimate, v.std_error);
    let rows: Vec<Vec<Cell>> = e
        .flown
        .iter()
        .map(|f| vec![Cell::text(f.words()), value(&f.least), Cell::text(&f.least.run), value(&f.most), Cell::text(&f.most.run)])
        .collect();
    table(&["coefficient", "least ± 95 %", "in run", "most ± 95 %", "in run"], &rows)
}
