//! cli: declared numbers that a closing of tracks fitted. In: a closing. Out: lines: declared, found, how far it moved, what would do as well.

use crate::lines::folded;
use std::fmt::Write as _;
use windfall::report::{number, with_interval};
use windfall::results::{Closing, NORMAL_95};

/// One number: key, declared, its standard uncertainty, estimate, standard error.
struct Row<'a> {
    key: &'a str,
    declared: f64,
    uncertainty: Option<f64>,
    estimate: f64,
    std_error: Option<f64>,
}

/// Declared parameters and uncertain constants as they were fitted; empty where there are none, and of tunnel runs, whose page has them.
pub(crate) fn lines(c: &Closing) -> String {
    let parameters = c.after.parameters.iter().filter_map(|p| {
        Some(Row {
            key: &p.name,
            declared: p.declared?,
            uncertainty: p.declared_std,
            estimate: p.estimate,
            std_error: p.std_error,
        })
    });
    let constants = c.constants.iter().map(|k| Row {
        key: &k.key,
        declared: k.declared,
        uncertainty: Some(k.uncertainty),
        estimate: k.estimate,
        std_error: k.std_error,
    });
    let all: Vec<Row<'_>> = parameters.chain(constants).collect();
    if all.is_empty() || !c.is_of_tracks() {
        return String::new();
    }
    let mut text =
        format!("\n{:<34}{:>20}{:>24}{:>14}\n", "declared numbers, fitted", "declared (1 σ)", "found (95 %)", "moved / error");
    all.iter().for_each(|row| line(&mut text, row));
    for f in &c.instead {
        let one = |i: &windfall::results::Instead| {
            let unit = if i.unit == "-" { String::new() } else { format!(" {}", i.unit) };
            format!("{} {} for {}{unit}", i.key, number(i.estimate), number(i.declared))
        };
        let list: Vec<String> = f.instead.iter().map(one).collect();
        let words = if list.is_empty() {
            format!("no other number of the body, the air or the instruments would do as well as {}", f.parameter)
        } else {
            format!("in place of {} these would do as well: {}", f.parameter, list.join("; "))
        };
        let _ = writeln!(text, "  {}", folded(&words, 2));
    }
    text
}

fn line(text: &mut String, row: &Row<'_>) {
    let declared = match row.uncertainty {
        Some(u) => format!("{} ± {}", number(row.declared), number(u)),
        None => format!("{}, no prior", number(row.declared)),
    };
    let (estimate, half) = with_interval(row.estimate, row.std_error.map(|s| NORMAL_95 * s));
    let found = half.map_or(estimate.clone(), |h| format!("{estimate} ± {h}"));
    let moved = row.std_error.map(|s| (row.estimate - row.declared) / row.uncertainty.unwrap_or(0.0).hypot(s));
    let moved = moved.filter(|m| m.is_finite()).map_or_else(|| "–".to_owned(), |m| format!("{m:+.1}"));
    let _ = writeln!(text, "  {:<32}{declared:>20}{found:>24}{moved:>14}", row.key);
}
