//! scenarios: tables over height in files of their own, and atmospheres. In: a table of a scenario or campaign. Out: checked rows.

use crate::columns::Columns;
use crate::error::{Fault, ReadError};
use crate::formats::{columns_of_text, read_columns};
use crate::table::Table;
use crate::{keys, limits};
use std::path::Path;
use windfall_model::planet::{Air, Atmosphere, AtmosphereTable};

/// Columns of an atmosphere file.
pub(crate) const ATMOSPHERE_COLUMNS: [&str; 4] = ["height_m", "pressure_Pa", "temperature_K", "gas_constant_J_kg_K"];

/// `atmosphere` of an `[environment]`: a word or a file.
pub(crate) fn atmosphere(t: &Table<'_>) -> Option<Atmosphere> {
    match t.word_or_table(&keys::ATMOSPHERE_PLANET)? {
        Ok(0) => Some(Atmosphere::Us1976),
        Ok(_) => Some(Atmosphere::Venus),
        Err(table) => {
            let rows = rows(&table, ATMOSPHERE_COLUMNS, |[_, p, temperature, r]| {
                (p > 0.0 && temperature > 0.0 && r > 0.0)
                    .then_some(())
                    .ok_or("pressure, temperature and gas constant must be above zero")
            })?;
            let air = |[h, pressure_pa, temperature_k, gas_constant_j_kg_k]: [f64; 4]| {
                (h, Air { pressure_pa, temperature_k, gas_constant_j_kg_k })
            };
            AtmosphereTable::new(rows.into_iter().map(air).collect()).map(Atmosphere::Table)
        }
    }
}

/// Rows of the table's `file`, beside the scenario file: every cell finite, the first column ascending, two rows or more, each sound.
pub(crate) fn rows<const N: usize>(
    t: &Table<'_>,
    names: [&str; N],
    sound: impl Fn([f64; N]) -> Result<(), &'static str>,
) -> Option<Vec<[f64; N]>> {
    let word = t.text("file");
    if word.is_empty() {
        return None;
    }
    let path = limits::beside(t.source, t.at("file"), &t.full("file"), &word);
    if t.source.has_faults() {
        return None;
    }
    let read = t.source.bundled_table(&word).map_or_else(|| read_columns(&path), |text| columns_of_text(&path, text));
    let columns = match read.and_then(|c| c.complain(|_| true).map(|()| c)) {
        Ok(columns) => columns,
        Err(ReadError::Faults(faults)) => {
            t.source.add(&faults);
            return None;
        }
        Err(e) => {
            t.source.fault(t.at("file"), t.full("file"), word, e.to_string(), "a path beside this file");
            return None;
        }
    };
    let mut faults = misnamed(&path, &columns, &names);
    let all: Vec<[f64; N]> = (0..columns.rows()).map(|i| names.map(|n| columns.get(n).map_or(f64::NAN, |c| c[i]))).collect();
    if faults.is_empty() {
        faults = unsound(&path, &columns.lines, &names, &all, sound);
    }
    t.source.add(&faults);
    faults.is_empty().then_some(all)
}

/// Columns that are not known, and those that are missing.
fn misnamed<const N: usize>(path: &Path, columns: &Columns, names: &[&str; N]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut say = |line: Option<usize>, key: &str, value: &str, what: &str| {
        faults.push(crate::columns::fault(path, line, key, value, what, &format!("columns {}", names.join(", "))));
    };
    for name in columns.names().iter().filter(|n| !names.contains(&n.as_str())) {
        say(Some(1), "column", name, "is not known here");
    }
    for name in names.iter().filter(|n| columns.get(n).is_none()) {
        say(Some(1), name, "", "column is missing");
    }
    faults
}

/// Rows that are not finite, do not ascend or are not sound; fewer than two.
fn unsound<const N: usize>(
    path: &Path,
    lines: &[usize],
    names: &[&str; N],
    all: &[[f64; N]],
    sound: impl Fn([f64; N]) -> Result<(), &'static str>,
) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (i, row) in all.iter().enumerate() {
        let mut say = |key: &str, value: f64, what: &str| {
            faults.push(crate::columns::fault(path, Some(lines[i]), key, &value.to_string(), what, "correct the row"));
        };
        if let Some(k) = row.iter().position(|x| !x.is_finite()) {
            say(names[k], row[k], "must be a finite number");
        } else if i > 0 && row[0] <= all[i - 1][0] {
            say(names[0], row[0], &format!("must be above {}, the one of the row before: they ascend", all[i - 1][0]));
        } else if let Err(what) = sound(*row) {
            say(names[0], row[0], what);
        }
    }
    if all.len() < 2 {
        faults.push(crate::columns::fault(path, None, "rows", &all.len().to_string(), "must be two or more", "more heights"));
    }
    faults
}
