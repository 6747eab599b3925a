//! model: effect `constant-acceleration`.

use super::{Acts, Effect, Parameter};
use crate::frames::Vec3;

pub(super) static EFFECT: Effect = Effect {
    family: "constant-acceleration",
    acts: Acts::PointMass,
    physics: "A constant extra acceleration: a tilted axis, a wrong local gravity, a steady draught on a slow body.",
    source: "Kinematics; decoy for lift that is fitted condition by condition",
    separate_by: "launches in other directions",
    parameters: |_| ["down_m_s2", "y_m_s2", "z_m_s2"].map(|n| Parameter::strength(n, "m/s2", 3.0)).to_vec(),
    apply: |plant, v| plant.point.acceleration += Vec3::new(v[0], v[1], v[2]),
};
