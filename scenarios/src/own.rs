//! scenarios: `[columns]`, run files in their owner's names, units, axes and attitudes. In: the table, columns as a file has them. Out:
//! the columns of the run file of this program.

mod attitude;
mod read;
mod told;

pub(crate) use attitude::SEQUENCES;
use attitude::{Attitude, OwnAxes, Turned};
pub(crate) use read::read;

use crate::column_unit::ColumnUnit;
use crate::columns::{Columns, fault, some_of};
use crate::error::{Fault, ReadError};
use crate::run_columns::{RUN_COLUMNS, RunColumn};
use std::path::Path;

const POSITION: [&str; 3] = ["X_m", "Y_m", "Z_m"];
const ANGLES: [&str; 3] = ["Rx_deg", "Ry_deg", "Rz_deg"];
/// Columns that an attitude makes beside the angles: quaternion tunnel from body. No file's column is called so.
pub(crate) const QUATERNION: [&str; 4] = ["tunnel<-body w", "tunnel<-body x", "tunnel<-body y", "tunnel<-body z"];

/// The quaternion columns of an attitude, made of our angles where the file has those; `None` without an attitude.
pub(crate) fn quaternions(columns: &mut Columns) -> Option<[&'static str; 4]> {
    if columns.get(QUATERNION[0]).is_none() {
        let [Some(a), Some(b), Some(c)] = ANGLES.map(|n| columns.get(n).map(<[f64]>::to_vec)) else { return None };
        let turned = Turned::of_ours([a, b, c], OwnAxes::default());
        QUATERNION.iter().zip(turned.quaternion).for_each(|(n, c)| columns.put(n, c));
    }
    Some(QUATERNION)
}

/// Where one of our columns comes from.
#[derive(Clone, Debug, PartialEq)]
enum Origin {
    /// Columns with weights, whose sum it is: one, or three along a direction.
    Columns {
        parts: Vec<(String, f64)>,
        unit: ColumnUnit,
    },
    Constant(f64),
}

impl Origin {
    fn names(&self) -> impl Iterator<Item = &str> {
        let parts: &[(String, f64)] = match self {
            Self::Columns { parts, .. } => parts,
            Self::Constant(_) => &[],
        };
        parts.iter().map(|(name, _)| name.as_str())
    }
    /// Its values row by row, in our unit.
    fn values(&self, file: &Columns) -> Option<Vec<f64>> {
        match self {
            Self::Constant(value) => Some(vec![*value; file.rows()]),
            Self::Columns { parts, unit } => {
                let parts: Vec<(&[f64], f64)> = parts.iter().map(|(n, w)| Some((file.get(n)?, *w))).collect::<Option<_>>()?;
                let sum = |i: usize| parts.iter().map(|(c, w)| c[i] * w).reduce(|a, b| a + b).unwrap_or(f64::NAN);
                Some((0..file.rows()).map(|i| unit.ours(sum(i))).collect())
            }
        }
    }
}

/// What `[columns]` says; empty: files as this program writes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Own {
    origins: Vec<(&'static str, Origin)>,
    axes: OwnAxes,
    attitude: Option<Attitude>,
}

impl Own {
    fn origin(&self, ours: &str) -> Option<&Origin> {
        self.origins.iter().find(|(n, _)| *n == ours).map(|(_, o)| o)
    }
    /// The file's columns in our names, units and axes; columns that are not asked for keep their names.
    ///
    /// # Errors
    /// The faults of columns that `[columns]` names and the file lacks, of units that contradict a row of units in the file, and of
    /// attitudes that are none.
    pub(crate) fn apply(&self, path: &Path, file: Columns) -> Result<Columns, ReadError> {
        let used = self.used();
        let ours = |n: &str| RUN_COLUMNS.iter().any(|c| c.name == n) && self.origin(n).is_none();
        file.complain(|n| used.contains(&n) || ours(n))?;
        let faults: Vec<Fault> = self.lacking(path, &file).into_iter().chain(self.contradicted(path, &file)).collect();
        if !faults.is_empty() {
            return Err(ReadError::Faults(faults));
        }
        if *self == Self::default() {
            return Ok(file);
        }
        let (mut names, mut data) = (Vec::new(), Vec::new());
        for ours in RUN_COLUMNS.map(|c| c.name) {
            let column = match self.origin(ours) {
                Some(origin) => origin.values(&file),
                None => file.get(ours).map(<[f64]>::to_vec),
            };
            if let Some(column) = column {
                names.push(ours.to_owned());
                data.push(column);
            }
        }
        for (name, column) in
            file.all().filter(|(n, _)| !used.contains(&n.as_str()) && !RUN_COLUMNS.iter().any(|c| c.name == n.as_str()))
        {
            names.push(name.clone());
            data.push(column.clone());
        }
        let mut ours = Columns::new(names, data, file.lines.clone());
        ours.header = file.header;
        ours.notes.clone_from(&file.notes);
        self.turn(path, &file, &mut ours)?;
        Ok(ours)
    }
    /// The file's names that are read.
    fn used(&self) -> Vec<&str> {
        let columns = self.origins.iter().flat_map(|(_, o)| o.names());
        columns.chain(self.attitude.iter().flat_map(Attitude::columns).map(String::as_str)).collect()
    }
    fn lacking(&self, path: &Path, file: &Columns) -> Vec<Fault> {
        let named = self.origins.iter().flat_map(|(ours, o)| o.names().map(|name| (*ours, name)));
        let attitude = self.attitude.iter().flat_map(Attitude::columns).map(|name| ("attitude", name.as_str()));
        let near: Vec<&str> = file.names().iter().map(String::as_str).collect();
        named
            .chain(attitude)
            .filter(|(_, name)| file.get(name).is_none())
            .map(|(ours, name)| {
                let what =
                    format!("[columns] reads {ours} from it, and the file lacks it; the file has {}", some_of(file.names()));
                let remedy = crate::table::nearest(name, &near).map_or("one of these names".to_owned(), |n| format!("\"{n}\""));
                fault(path, file.header, ours, name, &what, &remedy)
            })
            .collect()
    }
    /// Units that the file itself names below its header, where they are not those that the columns are read in.
    fn contradicted(&self, path: &Path, file: &Columns) -> Vec<Fault> {
        let mut all = Vec::new();
        for RunColumn { name: ours, quantity, .. } in RUN_COLUMNS {
            let (names, unit): (Vec<&str>, _) = match self.origin(ours) {
                Some(origin @ Origin::Columns { unit, .. }) => (origin.names().collect(), *unit),
                Some(Origin::Constant(_)) => continue,
                None => (vec![ours], quantity.ours()),
            };
            for name in names {
                let word = file.names().iter().position(|n| n == name).and_then(|i| file.units.get(i)).map_or("", String::as_str);
                let word = word.trim_matches(['[', ']', '(', ')']);
                if ColumnUnit::of(quantity, word).is_some_and(|u| u.factor() != unit.factor()) {
                    let what = format!("is the unit that the file gives for {name}, which is read in {}", unit.word);
                    let remedy =
                        format!("[columns] {ours} = {{ name = \"{name}\", unit = \"{word}\" }}, or a right row of units");
                    all.push(fault(path, None, ours, word, &what, &remedy));
                }
            }
        }
        all
    }
    /// Positions and attitude in tunnel and body axes.
    fn turn(&self, path: &Path, file: &Columns, ours: &mut Columns) -> Result<(), ReadError> {
        if self.axes != OwnAxes::default()
            && let [Some(x), Some(y), Some(z)] = POSITION.map(|n| ours.get(n).map(<[f64]>::to_vec))
        {
            POSITION.iter().zip(self.axes.tunnel([x, y, z])).for_each(|(n, c)| ours.put(n, c));
        }
        let ours_or_none = || match ANGLES.map(|n| ours.get(n).map(<[f64]>::to_vec)) {
            [Some(a), Some(b), Some(c)] => Some(Ok((Turned::of_ours([a, b, c], self.axes), None))),
            _ => None,
        };
        let turned = match &self.attitude {
            Some(attitude) => Some(attitude.turned(file, self.axes)),
            None if self.axes != OwnAxes::default() => ours_or_none(),
            None => None,
        };
        let Some(turned) = turned else { return Ok(()) };
        let (turned, note) = turned.map_err(|(value, what, remedy)| {
            ReadError::Faults(vec![fault(path, None, "[columns.attitude]", &value, &what, &remedy)])
        })?;
        ANGLES.iter().zip(turned.angles_deg).for_each(|(n, c)| ours.put(n, c));
        QUATERNION.iter().zip(turned.quaternion).for_each(|(n, c)| ours.put(n, c));
        ours.notes.extend(note);
        Ok(())
    }
}
