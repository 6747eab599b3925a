//! scenarios: tracks of bodies without attitude, and of rigid ones in free flight. In: a path and the axis that points down. Out: track in
//! tunnel axes.

use crate::clean::remove_spikes;
use crate::columns::{Columns, fault, some_of};
use crate::error::ReadError;
use crate::formats::read_columns;
use crate::own::{Own, quaternions};
use crate::record::{spike_note, times};
use crate::units::median;
use std::path::Path;
use windfall_model::{Measured, PointRecord};

/// Fewest samples of a track.
const FEWEST: usize = 8;
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
            Measured::Position | Measured::Pose | Measured::PositionAndForce => (self.std, 1e5, "metres"),
            Measured::SpecificForce => (self.std, 1e4, "m/s2"),
            Measured::Angle => (self.std.to_degrees(), 1e5, "degrees"),
        }
    }
    /// Columns of specific forces beside positions, for each of the file's axes.
    fn beside(&self) -> Option<[&'static str; 3]> {
        (self.measured == Measured::PositionAndForce).then_some(FORCES)
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
    let asked =
        Asked { measured: Measured::Position, down, std: position_std_m, force_std: 0.0, window_s, inputs: Vec::new() };
    read_own_track(path, &Own::default(), &asked)
}

/// The same for any measurement, and for a file whose columns are its owner's.
pub(crate) fn read_own_track(path: &Path, own: &Own, asked: &Asked<'_>) -> Result<(PointRecord, Vec<String>), ReadError> {
    let mut columns = own.apply(path, read_columns(path)?)?;
    let mut notes = std::mem::take(&mut columns.notes);
    let one =
        |key: &str, value: &str, what: &str, remedy: &str| ReadError::Faults(vec![fault(path, None, key, value, what, remedy)]);
    let (names, vertical) = asked.columns();
    let attitude = if asked.measured == Measured::Pose { Some(attitude_columns(path, &mut columns)?) } else { None };
    let all_axes = attitude.iter().flat_map(|_| names);
    let beside = asked.beside().map(|f| f[asked.down.axis]);
    let needed = ["t_s", vertical].into_iter().chain(beside).chain(all_axes).chain(asked.inputs.iter().map(|(_, c, _)| *c));
    for needed in needed {
        if columns.get(needed).is_none() {
            let what = format!("column is missing; the file has {}", some_of(columns.names()));
            let remedy = "t_s, the column of the vertical axis that [axes] down names (or angle_deg), and the columns of inputs";
            return Err(one(needed, "", &what, remedy));
        }
    }
    for (force, place) in asked.beside().iter().flatten().zip(names) {
        if columns.get(force).is_some() && columns.get(place).is_none() {
            let what = format!("stands without {place}: a specific force beside positions is along an axis whose position is there");
            return Err(one(force, "", &what, "both, or neither"));
        }
    }
    let inputs = asked.inputs.iter().map(|(_, c, _)| *c);
    let turned = attitude.into_iter().flatten();
    let series: Vec<&'static str> = names.into_iter().chain(asked.beside().into_iter().flatten()).collect();
    let present: Vec<&str> = series.iter().copied().filter(|c| columns.get(c).is_some()).chain(inputs).chain(turned).collect();
    let complete: Vec<bool> =
        (0..columns.rows()).map(|i| present.iter().all(|c| columns.get(c).is_some_and(|x| x[i].is_finite()))).collect();
    let lost = complete.iter().filter(|c| !**c).count();
    if lost > 0 {
        let what = match asked.measured {
            Measured::Position => "position",
            Measured::Pose => "position or attitude",
            Measured::SpecificForce | Measured::Angle | Measured::PositionAndForce => "value",
        };
        notes.push(format!("{lost} rows with a missing {what} dropped"));
        columns.retain(&complete);
    }
    let mut t_s = times(path, &mut columns, asked.window_s, &mut notes)?;
    if t_s.len() < FEWEST {
        let what = format!("a track needs {FEWEST} samples or more");
        return Err(one("samples", &t_s.len().to_string(), &what, "a longer track, or a wider window_s"));
    }
    let interval_s = median(&t_s.windows(2).map(|w| w[1] - w[0]).collect::<Vec<_>>());
    let mut file_axes: Vec<Option<Vec<f64>>> = series.iter().map(|c| columns.get(c).map(<[f64]>::to_vec)).collect();
    for (name, axis) in series.iter().zip(&mut file_axes) {
        let Some(x) = axis else { continue };
        let (per_unit, limit, unit) = asked.limit(name);
        if median(x).abs() > limit {
            return Err(one(name, &format!("{:.3} (median)", median(x)), &format!("must be within {limit:e} {unit}"), unit));
        }
        notes.extend(remove_spikes(&t_s, x, interval_s, per_unit).iter().map(|s| spike_note(name, t_s[s.index], s)));
    }
    let good: Vec<bool> = (0..t_s.len()).map(|i| file_axes.iter().flatten().all(|x| x[i].is_finite())).collect();
    let keep = |x: &mut Vec<f64>| *x = x.iter().zip(&good).filter(|(_, g)| **g).map(|(v, _)| *v).collect();
    keep(&mut t_s);
    file_axes.iter_mut().flatten().for_each(keep);
    let recorded = |(place, column, [zero, one]): &(usize, &str, [f64; 2])| {
        let mut u: Vec<f64> = columns.get(column).unwrap_or(&[]).iter().map(|x| (x - zero) / (one - zero)).collect();
        keep(&mut u);
        (*place, u)
    };
    let recorded_inputs = asked.inputs.iter().map(recorded).collect();
    let mut quaternion = attitude.map(|names| names.map(|n| columns.get(n).map_or_else(Vec::new, <[f64]>::to_vec)));
    quaternion.iter_mut().flatten().for_each(keep);
    let attitude = quaternion.map_or_else(Vec::new, |q| (0..t_s.len()).map(|i| [q[0][i], q[1][i], q[2][i], q[3][i]]).collect());
    let along = |first: usize| {
        let turned = |(axis, sign): (usize, f64)| {
            file_axes.get(first + axis)?.as_ref().map(|x| x.iter().map(|v| sign * v).collect::<Vec<f64>>())
        };
        asked.down.tunnel_from_file().map(turned)
    };
    let radians = |axis: usize| file_axes[axis].as_ref().map(|x| x.iter().map(|v| v.to_radians()).collect());
    let position_m = if asked.measured == Measured::Angle { [0, 1, 2].map(radians) } else { along(0) };
    let record = PointRecord {
        t_s,
        position_m,
        specific_force_m_s2: along(3),
        attitude,
        measured: asked.measured,
        recorded_inputs,
        ..PointRecord::default()
    };
    Ok((record, notes))
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
