//! study: rows of many campaigns as a table. In: what each gave. Out: columns and rows, the same for the same outcomes.

use super::outcome::CampaignOutcome;
use std::collections::HashMap;
use windfall_model::study::{Cell, CellKind, Column, Row};

/// Columns before those of the parameters.
const FIXED: [(&str, CellKind); 11] = [
    ("path", CellKind::Word),
    ("name", CellKind::Word),
    ("status", CellKind::Word),
    ("exit_code", CellKind::Number),
    ("reason", CellKind::Word),
    ("method", CellKind::Word),
    ("verdict", CellKind::Word),
    ("families", CellKind::Word),
    ("probability", CellKind::Number),
    ("worst_channel", CellKind::Word),
    ("p_value", CellKind::Number),
];

/// Columns and rows: one row a campaign, numbered from 0; for every parameter that any campaign has its estimate and standard error, in
/// the order in which they first occur.
#[must_use]
pub fn campaign_table(outcomes: &[CampaignOutcome]) -> (Vec<Column>, Vec<Row>) {
    let mut columns: Vec<Column> = FIXED.iter().map(|(name, kind)| Column { name: (*name).to_owned(), kind: *kind }).collect();
    let mut places: HashMap<String, usize> = HashMap::new();
    for stem in outcomes.iter().flat_map(|o| o.parameters.iter().map(super::OutcomeParameter::stem)) {
        let names = ["estimate", "std_error"].map(|what| format!("{stem}.{what}"));
        places.entry(stem).or_insert_with(|| {
            columns.extend(names.map(|name| Column { name, kind: CellKind::Number }));
            columns.len() - 2
        });
    }
    let row = |(k, o): (usize, &CampaignOutcome)| {
        let mut cells = fixed(o);
        cells.resize(columns.len(), Cell::Number(None));
        for p in &o.parameters {
            let Some(&place) = places.get(&p.stem()) else { continue };
            cells[place] = Cell::Number(Some(p.estimate).filter(|x| x.is_finite()));
            cells[place + 1] = Cell::Number(p.std_error.filter(|x| x.is_finite()));
        }
        Row { draw: k as u64, cells }
    };
    let rows = outcomes.iter().enumerate().map(row).collect();
    (columns, rows)
}

/// Cells of [`FIXED`].
fn fixed(o: &CampaignOutcome) -> Vec<Cell> {
    let word = |w: &str| Cell::Word(w.to_owned());
    vec![
        word(&o.path),
        word(&o.name),
        word(o.status.name()),
        Cell::Number(Some(f64::from(o.exit_code))),
        word(&o.reason),
        word(&o.method),
        word(o.verdict.map_or("", windfall_discover::close::Verdict::name)),
        word(&o.families.join("+")),
        Cell::Number(o.probability),
        word(&o.worst_channel),
        Cell::Number(o.p_value),
    ]
}
