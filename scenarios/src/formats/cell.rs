//! scenarios: one cell of a text. In: its characters, the separator of its columns. Out: a number.

/// A cell as a number, NaN where nothing was measured; `None` when it is something else.
pub(super) fn number(cell: &str, separator: u8) -> Option<f64> {
    let value = cell.parse().ok().or_else(|| match cell {
        "" | "-" => Some(f64::NAN),
        _ if ["na", "n/a", "#n/a", "null"].iter().any(|w| cell.eq_ignore_ascii_case(w)) => Some(f64::NAN),
        _ if separator != b',' && cell.matches(',').count() == 1 && !cell.contains('.') => cell.replace(',', ".").parse().ok(),
        _ => None,
    })?;
    Some(if f64::is_finite(value) { value } else { f64::NAN })
}
