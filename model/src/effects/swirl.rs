//! model: effect `swirl`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "swirl",
    acts: Acts::Lander,
    physics: "The stream turns about the tunnel's axis behind the fan's turning vanes: lateral air velocity in proportion to distance from the axis and to the tunnel speed, or steady (what it is in proportion to at at_m_s).",
    source: "Neihouse, Klinar and Scher, NASA TR R-57, 1960; Barlow, Rae and Pope, 1999, §6.2",
    separate_by: "runs that drift far from the axis",
    parameters: |_| {
        vec![
            Parameter::strength("rad_per_m", "rad/m", 0.2),
            Parameter::shape("steady", "-", 0.0, 1.0, 0.0, &[0.0, 1.0]),
            Parameter::reference(),
        ]
    },
    apply: |plant, v| {
        plant.flow.swirl_rad_per_m += v[0];
        plant.flow.steady_at_m_s = if v[1] > 0.5 { v[2] } else { 0.0 };
    },
};
