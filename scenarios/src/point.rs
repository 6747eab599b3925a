//! scenarios: tracks of bodies without attitude, and of rigid ones in free flight. In: a path and the axis that points down. Out: track in
//! tunnel axes.

use crate::clean::remove_spikes;
use crate::columns::{Columns, fault, some_of};
use crate::error::ReadError;
use crate::formats::read_columns;
use crate::own::{Own, quaternions};
use crate::record::{note_unused, refuse_unusable, spike_note, times};
use crate::units::median;
use std::path::Path;
use windfall_model::{Measured, PointRecord};

/// Fewest samples of a track.
const FEWEST: usize = 8;
/// Largest median of a position, m: above it there is no air that acts (chosen; a parachute at Titan opens at 150 km).
const HIGHEST_M: f64 = 1e6;
/// Columns of the file's axes.
const COLUMNS: [&str; 3] = ["X_m", "Y_m", "Z_m"];
const FORCES: [&str; 3] = ["fX_m_s2", "fY_m_s2", "fZ_m_s2"];

/// The file axis that points down, as in `[axes] down`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Down {
    /// 0 = X, 1 = Y, 2 = Z of the file.
    pub axis: usize,
    /// True for `-X`, `-Y`, `-Z`: down is against the axis.
    pub negative: bool,
}

impl Down {
    /// From the place of the word in `+X, -X, +Y, -Y, +Z, -Z`.
    pub(crate) fn from_choice(place: usize) -> Self {
        Self { axis: place / 2, negative: place % 2 == 1 }
    }
    /// For tunnel X, Y, Z: file axis and sign. Tunnel X is down; Y and Z are the file's other two axes, unturned, in the order
    /// that keeps the set right-handed: `-Z` gives (−Z, Y, X), `+Z` gives (Z, X, Y), `+X` gives (X, Y, Z).
    #[must_use]
    pub fn tunnel_from_file(self) -> [(usize, f64); 3] {
        let (next, last) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        if self.negative { [(self.axis, -1.0), (last, 1.0), (next, 1.0)] } else { [(self.axis, 1.0), (next, 1.0), (last, 1.0)] }
    }
}

/// What a track's file is read for.
pub(crate) struct Asked<'a> {
    pub(crate) measured: Measured,
    pub(crate) down: Down,
    /// Stated standard deviation, in the unit of what was measured.
    pub(crate) std: f64,
    /// The same of specific forces beside positions.
    pub(crate) force_std: f64,
    pub(crate) window_s: Option<[f64; 2]>,
    /// Inputs that the file has row by row: their place, column, and what it has at 0 and 1.
    pub(crate) inputs: Vec<(usize, &'a str, [f64; 2])>,
}

impl Asked<'_> {
    /// Names of its columns, and the one that it cannot be without.
    fn columns(&self) -> ([&'static str; 3], &'static str) {
        let all = match self.measured {
            Measured::Position | Measured::Pose | Measured::PositionAndForce => COLUMNS,
            Measured::SpecificForce => FORCES,
            Measured::Angle => return (["angle_deg", "", ""], "angle_deg"),
        };
        (all, all[self.down.axis])
    }
    /// Standard deviation of a column in its unit, its largest median, and that unit.
    fn limit(&self, column: &str) -> (f64, f64, &'static str) {
        match self.measured {
            Measured::PositionAndForce if FORCES.contains(&column) => (self.force_std, 1e4, "m/s2"),
            Measured::Position | Measured::Pose | Measured::PositionAndForce => (self.std, HIGHEST_M, "metres"),
            Measured::SpecificForce => (self.std, 1e4, "m/s2"),
            Measured::Angle => (self.std.to_degrees(), 1e5, "degrees"),
        }
    }
    /// Columns of specific forces beside positions, for each of the file's axes.
    fn beside(&self) -> Option<[&'static str; 3]> {
        (self.measured == Measured::PositionAndForce).then_some(FORCES)
    }
    /// Columns of all that is measured but attitude, whether the file has them or not.
    fn series(&self) -> Vec<&'static str> {
        self.columns().0.into_iter().chain(self.beside().into_iter().flatten()).collect()
    }
    /// Whether a column is read: the time, what is measured, inputs, angles that make an attitude.
    pub(crate) fn is_read(&self, name: &str, attitude: bool) -> bool {
        let turned = attitude && ["Rx_deg", "Ry_deg", "Rz_deg"].contains(&name);
        name == "t_s" || turned || self.series().contains(&name) || self.inputs.iter().any(|(_, c, _)| *c == name)
    }
    /// What one of its rows has, in words.
    fn value(&self) -> &'static str {
        match self.measured {
            Measured::Position => "position",
            Measured::Pose => "position or attitude",
            Measured::SpecificForce | Measured::Angle | Measured::PositionAndForce => "value",
        }
    }
    /// Faults of columns that the file has not.
    fn complain_of_missing(&self, path: &Path, columns: &Columns) -> Result<(), ReadError> {
        let (names, vertical) = self.columns();
        let all_axes = names.into_iter().filter(|_| self.measured == Measured::Pose);
        let beside = self.beside().map(|f| f[self.down.axis]);
        let inputs = self.inputs.iter().map(|(_, c, _)| *c);
        if let Some(missing) =
            ["t_s", vertical].into_iter().chain(beside).chain(all_axes).chain(inputs).find(|c| columns.get(c).is_none())
        {
            let what = format!("column is missing; the file has {}", some_of(columns.names()));
            let remedy = "t_s, the column of the vertical axis that [axes] down names (or angle_deg), and the columns of inputs";
            return Err(ReadError::Faults(vec![fault(path, None, missing, "", &what, remedy)]));
        }
        for (force, place) in self.beside().iter().flatten().zip(names) {
            if columns.get(force).is_some() && columns.get(place).is_none() {
                let what =
                    format!("stands without {place}: a specific force beside positions is along an axis whose position is there");
                return Err(ReadError::Faults(vec![fault(path, None, force, "", &what, "both, or neither")]));
            }
        }
        Ok(())
    }
    /// Takes spikes off every series: the local fit in their place, or NaN. Notes of them; a fault where a series is out of range.
    fn remove_spikes(&self, path: &Path, t_s: &[f64], columns: &mut Columns) -> Result<Vec<String>, ReadError> {
        let interval_s = median(&t_s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>());
        let mut notes = Vec::new();
        for name in self.series() {
            let Some(mut x) = columns.get(name).map(<[f64]>::to_vec) else { continue };
            let (std, limit, unit) = self.limit(name);
            if median(&x).abs() > limit {
                let (value, what) = (format!("{:.3} (median)", median(&x)), format!("must be within {limit:e} {unit}"));
                return Err(ReadError::Faults(vec![fault(path, None, name, &value, &what, unit)]));
            }
            notes.extend(remove_spikes(t_s, &mut x, interval_s, std).iter().map(|s| spike_note(name, t_s[s.index], s)));
            columns.put(name, x);
        }
        Ok(notes)
    }
    /// Track of columns without a gap, in tunnel axes.
    fn record(&self, columns: &Columns, attitude: Option<[&'static str; 4]>) -> PointRecord {
        let column = |name: &str| columns.get(name).map_or_else(Vec::new, <[f64]>::to_vec);
        let input = |(place, name, [zero, one]): &(usize, &str, [f64; 2])| {
            (*place, column(name).iter().map(|x| (x - zero) / (one - zero)).collect())
        };
        let along = |names: [&str; 3]| {
            self.down
                .tunnel_from_file()
                .map(|(axis, sign)| columns.get(names[axis]).map(|x| x.iter().map(|v| sign * v).collect::<Vec<f64>>()))
        };
        let radians = |name: &str| columns.get(name).map(|x| x.iter().map(|v| v.to_radians()).collect());
        let turns = attitude.map(|names| names.map(column));
        let names = self.columns().0;
        PointRecord {
            t_s: column("t_s"),
            position_m: if self.measured == Measured::Angle { names.map(radians) } else { along(names) },
            specific_force_m_s2: self.beside().map_or_else(Default::default, along),
            attitude: turns.map_or_else(Vec::new, |[w, x, y, z]| (0..w.len()).map(|i| [w[i], x[i], y[i], z[i]]).collect()),
            measured: self.measured,
            recorded_inputs: self.inputs.iter().map(input).collect(),
            ..PointRecord::default()
        }
    }
}

/// Reads a track: `t_s` and any of `X_m, Y_m, Z_m`, the vertical one among them; times may be uneven. Rows that lack a value
/// are dropped and counted; spikes beyond six robust standard deviations of the local fit, and of the declared
/// `position_std_m`, are removed. Notes say so.
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_track(
    path: &Path,
    down: Down,
    position_std_m: f64,
    window_s: Option<[f64; 2]>,
) -> Result<(PointRecord, Vec<String>), ReadError> {
    let asked = Asked { measured: Measured::Position, down, std: position_std_m, force_std: 0.0, window_s, inputs: Vec::new() };
    read_own_track(path, &Own::default(), &asked)
}

/// The same for any measurement, and for a file whose columns are its owner's.
pub(crate) fn read_own_track(path: &Path, own: &Own, asked: &Asked<'_>) -> Result<(PointRecord, Vec<String>), ReadError> {
    let file = read_columns(path)?;
    file.complain(|n| asked.inputs.iter().any(|(_, c, _)| *c == n))?;
    let mut columns = own.apply(path, file)?;
    let mut notes = std::mem::take(&mut columns.notes);
    let attitude = if asked.measured == Measured::Pose { Some(attitude_columns(path, &mut columns)?) } else { None };
    asked.complain_of_missing(path, &columns)?;
    let is_read = |n: &str| asked.is_read(n, attitude.is_some());
    let remedy = "specific_force_std_m_s2 in [sensors] of a point mass, or remove the column or give it another name";
    refuse_unusable(path, &columns, is_read, "a campaign that measures other things alone", remedy)?;
    note_unused(&columns, is_read, &mut notes);
    let read: Vec<&str> =
        asked.series().into_iter().chain(asked.inputs.iter().map(|(_, c, _)| *c)).chain(attitude.into_iter().flatten()).collect();
    let lost = retain_complete(&mut columns, &read);
    if lost > 0 {
        notes.push(format!("{lost} rows with a missing {} dropped", asked.value()));
    }
    let t_s = times(path, &mut columns, asked.window_s, &mut notes)?;
    if t_s.len() < FEWEST {
        let what = format!("a track needs {FEWEST} samples or more");
        let remedy = "a longer track, or a wider window_s";
        return Err(ReadError::Faults(vec![fault(path, None, "samples", &t_s.len().to_string(), &what, remedy)]));
    }
    notes.extend(asked.remove_spikes(path, &t_s, &mut columns)?);
    retain_complete(&mut columns, &asked.series());
    Ok((asked.record(&columns, attitude), notes))
}

/// Keeps the rows of which no column of these is missing a value; how many had one. A column that the file has not is none.
fn retain_complete(columns: &mut Columns, names: &[&str]) -> usize {
    let present: Vec<&[f64]> = names.iter().filter_map(|n| columns.get(n)).collect();
    let complete: Vec<bool> = (0..columns.rows()).map(|i| present.iter().all(|c| c[i].is_finite())).collect();
    columns.retain(&complete);
    complete.iter().filter(|c| !**c).count()
}

/// Columns of the attitude of a rigid body's file.
fn attitude_columns(path: &Path, columns: &mut Columns) -> Result<[&'static str; 4], ReadError> {
    let names = some_of(columns.names());
    quaternions(columns).ok_or_else(|| {
        let what = format!("is missing: the file of a rigid body needs an attitude; the file has {names}");
        let remedy = "[columns.attitude] with a quaternion or Euler angles, or columns Rx_deg, Ry_deg, Rz_deg";
        ReadError::Faults(vec![fault(path, None, "attitude", "", &what, remedy)])
    })
}

#[cfg(test)]
mod tests {
    use super::Down;

    /// Rows of the mapping are orthonormal with determinant +1 for each of the six axes, and the first points down.
    #[test]
    fn law_tunnel_axes_stay_right_handed() {
        for place in 0..6 {
            let down = Down::from_choice(place);
            let rows = down.tunnel_from_file().map(|(axis, sign)| {
                let mut row = [0.0; 3];
                row[axis] = sign;
                row
            });
            let [a, b, c] = rows;
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            assert!(cross.iter().zip(c).all(|(a, b)| (a - b).abs() < 1e-15), "{down:?}");
            assert_eq!(a[down.axis].is_sign_negative(), down.negative);
        }
    }
}
