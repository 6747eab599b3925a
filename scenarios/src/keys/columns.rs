//! scenarios: keys of `[columns]`. In: nothing. Out: the tables of keys.

use super::{Key, Kind, TableSpec, optional, other};
use crate::own::SEQUENCES;

/// A column of ours: where it is in the owner's file.
const fn column(name: &'static str, unit: &'static str, meaning: &'static str) -> Key {
    Key { unit, ..optional(other(name, Kind::Column, meaning)) }
}

pub(crate) static COLUMNS: TableSpec = TableSpec {
    path: "columns",
    meaning: "How run files name and measure their columns, where that is not as in this table: the name of the file's column, or \
              `{ name = \"...\", unit = \"...\" }`. What is not named here keeps name and unit. `[run.columns]` below a `[[run]]` \
              stands in place of the whole table for that run. `docs/own-columns.md` has examples.",
    keys: &[
        column("t_s", "s", "time"),
        column("X_m", "m", "position along tunnel X, or the owner's x where `axes` is given"),
        column("Y_m", "m", "position along tunnel Y, or the owner's y"),
        column("Z_m", "m", "position along tunnel Z, or the owner's z"),
        column("Rx_deg", "deg", "first Euler angle of T = Rx Ry Rz"),
        column("Ry_deg", "deg", "second Euler angle"),
        column("Rz_deg", "deg", "third Euler angle"),
        column("qW_Pa", "Pa", "dynamic pressure"),
        column("ps_Pa", "Pa", "static pressure; a number where the file has none"),
        column("VW_m_s", "m/s", "tunnel speed; a number where the file has none"),
        column("Ts_K", "K", "static temperature; a number where the file has none"),
        column("fX_m_s2", "m/s2", "specific force along the file's X (point mass): what an accelerometer at rest reads upward"),
        column("fY_m_s2", "m/s2", "specific force along Y"),
        column("fZ_m_s2", "m/s2", "specific force along Z"),
        column("angle_deg", "deg", "angle of a body on a pivot from hanging down"),
        optional(other("axes", Kind::Table, "axes of positions and attitudes, where they are not ours; not for a point mass")),
        optional(other("attitude", Kind::Table, "quaternion or Euler angles in place of R_x, R_y, R_z")),
    ],
};
pub(crate) static COLUMN: TableSpec = TableSpec {
    path: "columns.<column>",
    meaning: "One column. Units of time: s, ms, us, ns, min. Length: m, mm, cm, um, km, in, ft. Angle: deg, rad, mrad, turn. Pressure: \
              Pa, hPa, kPa, MPa, mbar, bar, atm, mmHg, Torr, psi, psf. Speed: m/s, mm/s, cm/s, km/h, ft/s, kn, mph. Temperature: K, \
              degC, degF, degR. Acceleration: m/s2, g, ft/s2.",
    keys: &[
        optional(other("name", Kind::Text, "the file's column; absent: our name")),
        optional(other(
            "names",
            Kind::Words,
            "in place of `name`: three columns of a vector, whose component along `along` it is",
        )),
        optional(Key {
            name: "along",
            kind: Kind::Numbers(3),
            unit: "-",
            range: [-1e3, 1e3],
            needed: false,
            meaning: "direction in the axes of `names`; its length does not count",
        }),
        optional(other("unit", Kind::Text, "its unit; absent: ours")),
    ],
};
pub(crate) static COLUMNS_AXES: TableSpec = TableSpec {
    path: "columns.axes",
    meaning: "Which of the owner's axes ours are. With `tunnel = [\"-z\", \"x\", \"-y\"]` tunnel X (down) is the owner's -z, Y his x, Z his -y.",
    keys: &[
        optional(other("tunnel", Kind::Words, "tunnel X (down), Y, Z as axes of the owner's room; absent: x, y, z")),
        optional(other("body", Kind::Words, "body x (out of the nose), y, z as axes of the owner's body; absent: x, y, z")),
    ],
};
pub(crate) static COLUMNS_ATTITUDE: TableSpec = TableSpec {
    path: "columns.attitude",
    meaning: "Attitude about the owner's axes; exactly one of quaternion and euler. The matrix of an Euler sequence is the product of its \
              right-handed rotations in order, R = R1 R2 R3: each about an axis of the body as the one before has left it.",
    keys: &[
        optional(other("quaternion", Kind::Words, "four columns")),
        optional(other("scalar", Kind::Choice(&["first", "last"]), "where the real part of the quaternion stands")),
        optional(other("euler", Kind::Words, "three columns, in the order of the sequence")),
        optional(other("sequence", Kind::Choice(&SEQUENCES), "axes of the three angles")),
        optional(other("unit", Kind::Text, "of the three angles: deg, rad, mrad, turn")),
        other(
            "rotates",
            Kind::Choice(&["body-to-world", "world-to-body"]),
            "which components the rotation takes to which: v_world = R v_body, or v_body = R v_world",
        ),
    ],
};
