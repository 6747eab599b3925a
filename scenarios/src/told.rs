//! scenarios: what reading does to the columns of runs, in words. In: a campaign file or a run file. Out: lines, of runs that are read alike
//! together.

use crate::campaign::{RunEntry, asked, down_of, entries, inputs_of};
use crate::error::ReadError;
use crate::formats::{read_columns, stem};
use crate::keys;
use crate::open::text_of;
use crate::own::Own;
use crate::plant::{Declared, read_declared};
use crate::point::Down;
use crate::point_body::InputSource;
use crate::run_columns::is_of_tunnel;
use crate::table::{Source, Table};
use std::path::Path;
use windfall_model::Measured;

/// What is done to every column of the runs of a campaign: where it comes from, its unit, axes, attitude, and what nothing reads.
///
/// # Errors
/// [`ReadError`] with every fault of the campaign file, or of a run file that cannot be read.
pub fn columns_of_campaign(path: &Path) -> Result<Vec<String>, ReadError> {
    let text = text_of(path)?;
    let source = Source::new(path, &text);
    let root = source.parse()?;
    let file = Table::new(&source, "", &root, 0..0, &keys::CAMPAIGN_FILE);
    let declared = read_declared(&file, false);
    let down = down_of(&file, declared.as_ref());
    let entries = entries(&file, declared.as_ref());
    let inputs = inputs_of(&source, &entries);
    let Some(declared) = declared.filter(|_| !source.has_faults()) else { return source.finish(None) };
    let mut groups: Vec<(Vec<String>, Vec<String>)> = Vec::new();
    for e in &entries {
        let lines = told(e, &declared, down, &inputs)?;
        let name = stem(&e.path).unwrap_or_default();
        match groups.iter_mut().find(|(_, of)| *of == lines) {
            Some((names, _)) if names.contains(&name) => {}
            Some((names, _)) => names.push(name),
            None => groups.push((vec![name], lines)),
        }
    }
    let of = |(names, lines): (Vec<String>, Vec<String>)| {
        let head = format!("columns of {}:", names.join(", "));
        std::iter::once(head).chain(lines.into_iter().map(|l| format!("  {l}"))).collect::<Vec<_>>()
    };
    Ok(groups.into_iter().flat_map(of).collect())
}

fn told(e: &RunEntry, declared: &Declared, down: Option<Down>, inputs: &[String]) -> Result<Vec<String>, ReadError> {
    let file = read_columns(&e.path)?;
    if !declared.tracked() {
        return Ok(e.columns.told(&file, is_of_tunnel));
    }
    let asked = asked(e, declared, down, inputs);
    let mut lines = e.columns.told(&file, |n| asked.is_read(n, declared.measured == Measured::Pose));
    let column = |(input, source): (&String, &InputSource)| match source {
        InputSource::Column { name, .. } => Some(format!("{input} from {name}")),
        InputSource::Constant(_) => None,
    };
    let from: Vec<String> = e.inputs.iter().filter_map(column).collect();
    if !from.is_empty() {
        lines.push(format!("inputs row by row: {}", from.join(", ")));
    }
    Ok(lines)
}

/// The same of a run file alone, which has this program's own columns.
///
/// # Errors
/// [`ReadError`] where the file cannot be read.
pub fn columns_of_run(path: &Path) -> Result<Vec<String>, ReadError> {
    Ok(Own::default().told(&read_columns(path)?, is_of_tunnel))
}
