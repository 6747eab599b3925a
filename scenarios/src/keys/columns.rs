//! scenarios: keys of `[columns]`. In: nothing. Out: the tables of keys.

use super::{Key, Kind, TableSpec, optional, other};
use crate::own::SEQUENCES;
use crate::run_columns::RUN_COLUMNS;

/// Keys beside the columns.
const BESIDE: [Key; 2] = [
    optional(other("axes", Kind::Table, "axes of positions and attitudes, where they are not ours; not for a point mass")),
    optional(other("attitude", Kind::Table, "quaternion or Euler angles in place of R_x, R_y, R_z")),
];
/// Where each column of ours is in the owner's file, and those.
static KEYS: [Key; RUN_COLUMNS.len() + BESIDE.len()] = {
    let mut keys = [BESIDE[0]; RUN_COLUMNS.len() + BESIDE.len()];
    let mut i = 0;
    while i < RUN_COLUMNS.len() {
        let column = &RUN_COLUMNS[i];
        keys[i] = Key { unit: column.quantity.ours().word, ..optional(other(column.name, Kind::Column, column.of_owner)) };
        i += 1;
    }
    keys[i] = BESIDE[0];
    keys[i + 1] = BESIDE[1];
    keys
};

pub(crate) static COLUMNS: TableSpec = TableSpec {
    path: "columns",
    meaning: "How run files name and measure their columns, where that is not as in this table: the name of the file's column, or \
              `{ name = \"...\", unit = \"...\" }`. What is not named here keeps name and unit. `[run.columns]` below a `[[run]]` \
              stands in place of the whole table for that run. `docs/own-columns.md` has examples.",
    keys: &KEYS,
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
