//! scenarios: keys of `[[wind_tunnel]]`. In: nothing. Out: the table of keys.

use super::{Key, Kind, TableSpec, num, optional, other};

pub(crate) static WIND_TUNNEL: TableSpec = TableSpec {
    path: "wind_tunnel",
    meaning: "Static coefficients measured on a balance, which identified curves are held against; nothing is fitted to them. The file is a table: \
              `alpha_T_deg` (total angle of attack, 0 to 180, ascending), one or more of `CA`, `CN`, `Cm`, and their standard uncertainties \
              `CA_std`, `CN_std`, `Cm_std` where the test states them; reference area and length as those of `[vehicle]`. An empty cell was not \
              measured.",
    keys: &[
        other("file", Kind::Text, "table of points (CSV, Parquet, MATLAB), beside the campaign file"),
        optional(other("name", Kind::Text, "name of the test; absent: that of the file")),
        Key {
            needed: false,
            ..num(
                "moment_reference_m",
                "m",
                -1e3,
                1e3,
                "place on body x about which Cm is given, from the geometric origin toward the nose; absent: the origin",
            )
        },
    ],
};
