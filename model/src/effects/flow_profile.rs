//! model: effect `flow-profile`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "flow-profile",
    acts: Acts::Lander,
    physics: "Speed varies across the section: a bowl or bulge in r² about the axis, and a tilt.",
    source: "Barlow, Rae and Pope, Low-Speed Wind Tunnel Testing, 1999, §6.2; Neihouse, Klinar and Scher, NASA TR R-57, 1960 (spin-tunnel velocity profiles)",
    separate_by: "runs that drift far from the axis",
    parameters: |_| {
        vec![
            Parameter::strength("bowl_per_m2", "1/m2", 0.5),
            Parameter::strength("tilt_y_per_m", "1/m", 0.5),
            Parameter::strength("tilt_z_per_m", "1/m", 0.5),
        ]
    },
    apply: |plant, v| {
        plant.flow.profile_per_m2 += v[0];
        plant.flow.gradient_per_m[0] += v[1];
        plant.flow.gradient_per_m[1] += v[2];
    },
};
