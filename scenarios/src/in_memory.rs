//! scenarios: tunnel runs whose columns are in memory. In: named columns, a declared plant. Out: runs, held against all that a run file
//! is held against.

use crate::columns::Columns;
use crate::error::ReadError;
use crate::own::Own;
use crate::record::{Piece, pieces_of};
use crate::units;
use std::path::Path;
use windfall_model::{Data, Plant, Run, Use};

/// A run that is in no file: the columns of a run file by their names.
#[derive(Clone, Debug, PartialEq)]
pub struct RunColumns {
    /// Its name, which faults and results say.
    pub name: String,
    /// Kind of run, such as `perturbed`.
    pub kind: String,
    /// What it is for.
    pub used: Use,
    /// Columns of one length, in the units that their names say; NaN where nothing was measured.
    pub columns: Vec<(String, Vec<f64>)>,
    /// Names of columns that hold no numbers.
    pub left_out: Vec<String>,
}

/// Checked runs of a tunnel campaign, and what a reader should know of them: units, dropouts, spikes and gaps as in run files.
///
/// # Errors
/// [`ReadError`] with every fault of every run.
pub fn runs_of_columns(given: Vec<RunColumns>, plant: &Plant) -> Result<(Vec<Run>, Vec<String>), ReadError> {
    let (mut runs, mut notes, mut faults) = (Vec::new(), Vec::new(), Vec::new());
    for g in given {
        let (kind, used) = (g.kind, g.used);
        let rows = g.columns.first().map_or(0, |(_, c)| c.len());
        let (names, data): (Vec<String>, Vec<Vec<f64>>) = g.columns.into_iter().unzip();
        let mut columns = Columns::new(names, data, (1..=rows).collect());
        columns.leave_out(&g.left_out);
        let path = Path::new(&g.name);
        match named_pieces(path, &g.name, columns, &Own::default(), plant, None) {
            Ok(pieces) => {
                notes.extend(pieces.iter().flat_map(|(name, p)| p.notes.iter().map(move |n| format!("{name}: {n}"))));
                runs.extend(pieces.into_iter().map(|(name, p)| Run {
                    name,
                    kind: kind.clone(),
                    used,
                    inputs: Vec::new(),
                    data: Data::Tunnel(p.record),
                    notes: p.notes,
                }));
            }
            Err(ReadError::Faults(all)) => faults.extend(all),
            Err(other) => return Err(other),
        }
    }
    if faults.is_empty() { Ok((runs, notes)) } else { Err(ReadError::Faults(faults)) }
}

/// Pieces of a tunnel run, each with its name, once they make sense for the plant that is said to have flown them.
pub(crate) fn named_pieces(
    path: &Path,
    stem: &str,
    columns: Columns,
    own: &Own,
    plant: &Plant,
    window_s: Option<[f64; 2]>,
) -> Result<Vec<(String, Piece)>, ReadError> {
    let pieces = pieces_of(path, columns, own, &plant.sensors, window_s)?;
    let faults: Vec<_> = pieces.iter().flat_map(|p| units::physics_faults(path, &p.record, plant)).collect();
    if !faults.is_empty() {
        return Err(ReadError::Faults(faults));
    }
    let many = pieces.len() > 1;
    let named = |(i, mut p): (usize, Piece)| {
        p.notes.extend(units::warnings(&p.record));
        p.record.piece_of = many.then(|| stem.to_owned());
        (if many { format!("{stem}-{}", letters(i)) } else { stem.to_owned() }, p)
    };
    Ok(pieces.into_iter().enumerate().map(named).collect())
}

/// a, b, ..., z, aa, ab, ...
fn letters(i: usize) -> String {
    let last = char::from(b'a' + u8::try_from(i % 26).unwrap_or(0));
    if i < 26 { last.to_string() } else { format!("{}{last}", letters(i / 26 - 1)) }
}
