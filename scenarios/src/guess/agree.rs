//! scenarios: guesses of several files that have the same columns. In: a guess of each. Out: units that all of them are in.

use super::sheet::{Found, Sheet};
use super::vectors::Euler;
use super::{Attitude, Guess, settled};
use crate::columns::Columns;
use std::path::Path;

/// Files with the same columns have them in the same units: what one of them is too large for, none is in.
pub(super) fn agree(guesses: &mut [Guess], sheets: &[(&Path, Sheet<'_>, &Columns)]) {
    let degrees: Vec<Euler> = guesses
        .iter()
        .filter_map(|g| match &g.attitude {
            Some(Attitude::Euler(e)) if e.unit == "deg" => Some(Euler { names: e.names.clone(), why: e.why.clone(), ..*e }),
            _ => None,
        })
        .collect();
    let wide: Vec<Vec<Found>> = guesses.iter().filter_map(|g| g.position.as_ref().map(|p| p.found.clone())).collect();
    for (g, (_, sheet, _)) in guesses.iter_mut().zip(sheets) {
        if let Some(Attitude::Euler(e)) = &mut g.attitude
            && let Some(other) = degrees.iter().find(|d| d.names == e.names && e.unit != "deg")
        {
            (e.unit, e.why) = (other.unit, other.why.clone());
            g.turns = g.attitude.as_mut().map_or_else(Vec::new, |a| settled(sheet, a));
        }
        for f in g.position.iter_mut().flat_map(|p| &mut p.found).filter(|f| f.why.starts_with("GUESS") && f.unit == "m") {
            let other = wide.iter().flatten().find(|o| o.name == f.name && o.unit == "mm");
            if let Some(o) = other {
                (f.unit, f.why) = (o.unit.clone(), o.why.clone());
            }
        }
    }
}
