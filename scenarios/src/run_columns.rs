//! scenarios: the columns of a run file, each once. In: nothing. Out: name, what it measures, who needs it, what it means.

use crate::column_unit::UnitQuantity;

/// Who has a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Who {
    /// A tunnel run has it.
    TunnelRun,
    /// A tunnel run may have it.
    TunnelRunMay,
    /// A body without attitude or on a pivot.
    OtherBody,
}

/// A column of a run file.
pub(crate) struct RunColumn {
    pub(crate) name: &'static str,
    pub(crate) quantity: UnitQuantity,
    pub(crate) who: Who,
    pub(crate) meaning: &'static str,
    /// What it is in `[columns]`, where the owner's column is named that is this one.
    pub(crate) of_owner: &'static str,
    /// Whether `[columns]` may give one number for a whole run.
    pub(crate) may_be_constant: bool,
}

const fn column(name: &'static str, quantity: UnitQuantity, meaning: &'static str, of_owner: &'static str) -> RunColumn {
    RunColumn { name, quantity, who: Who::TunnelRun, meaning, of_owner, may_be_constant: false }
}
const fn slow(name: &'static str, quantity: UnitQuantity, meaning: &'static str, of_owner: &'static str) -> RunColumn {
    RunColumn { may_be_constant: true, ..column(name, quantity, meaning, of_owner) }
}
const fn other(name: &'static str, quantity: UnitQuantity, meaning: &'static str) -> RunColumn {
    RunColumn { who: Who::OtherBody, ..column(name, quantity, meaning, meaning) }
}

/// All columns; those of the motion signals in the order of [`windfall_model::CHANNEL_NAMES`].
pub(crate) const RUN_COLUMNS: [RunColumn; 15] = [
    column("t_s", UnitQuantity::Time, "time, increasing, uniform to 1 %", "time"),
    column(
        "X_m",
        UnitQuantity::Length,
        "position of the geometric origin, tunnel X (down)",
        "position along tunnel X, or the owner's x where `axes` is given",
    ),
    column("Y_m", UnitQuantity::Length, "position, tunnel Y (horizontal)", "position along tunnel Y, or the owner's y"),
    column("Z_m", UnitQuantity::Length, "position, tunnel Z (horizontal)", "position along tunnel Z, or the owner's z"),
    column(
        "Rx_deg",
        UnitQuantity::Angle,
        "roll: first Euler angle of x-y-z, body to tunnel T = Rx Ry Rz; may pass 180, with or without jumps of 360",
        "first Euler angle of T = Rx Ry Rz",
    ),
    column("Ry_deg", UnitQuantity::Angle, "second Euler angle", "second Euler angle"),
    column("Rz_deg", UnitQuantity::Angle, "third Euler angle", "third Euler angle"),
    slow("VW_m_s", UnitQuantity::Speed, "tunnel speed, upward positive", "tunnel speed; a number where the file has none"),
    slow("ps_Pa", UnitQuantity::Pressure, "static pressure", "static pressure; a number where the file has none"),
    slow("Ts_K", UnitQuantity::Temperature, "static temperature", "static temperature; a number where the file has none"),
    RunColumn {
        who: Who::TunnelRunMay,
        ..column("qW_Pa", UnitQuantity::Pressure, "dynamic pressure; absent: computed from V_W, p_s and T_s", "dynamic pressure")
    },
    other(
        "fX_m_s2",
        UnitQuantity::Acceleration,
        "specific force along the file's X (point mass): what an accelerometer at rest reads upward",
    ),
    other("fY_m_s2", UnitQuantity::Acceleration, "specific force along Y"),
    other("fZ_m_s2", UnitQuantity::Acceleration, "specific force along Z"),
    other("angle_deg", UnitQuantity::Angle, "angle of a body on a pivot from hanging down"),
];

/// Names of the columns that `who` has, in order.
pub(crate) fn names_of(who: Who) -> impl Iterator<Item = &'static str> {
    RUN_COLUMNS.iter().filter(move |c| c.who == who).map(|c| c.name)
}

/// Whether a tunnel run has or may have a column of this name.
pub(crate) fn is_of_tunnel(name: &str) -> bool {
    RUN_COLUMNS.iter().any(|c| c.name == name && c.who != Who::OtherBody)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn law_motion_signals_are_in_channel_order_behind_the_time() {
        let names: Vec<&str> = names_of(Who::TunnelRun).skip(1).take(windfall_model::CHANNELS).collect();
        assert_eq!(names, windfall_model::CHANNEL_NAMES);
    }
}
