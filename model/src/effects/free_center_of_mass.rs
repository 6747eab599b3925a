//! model: effect `center-of-mass`.

use super::{Acts, Effect, Parameter};
use crate::frames::Vec3;

pub(super) static EFFECT: Effect = Effect {
    family: "center-of-mass",
    acts: Acts::FreeFlight,
    physics: "The centre of mass without moved parts is elsewhere than declared; mass and inertia about it stay.",
    source: "Statics",
    separate_by: "the body hung by two points, without its moved parts",
    parameters: |_| ["x_m", "y_m", "z_m"].map(|n| Parameter::strength(n, "m", 0.05)).to_vec(),
    apply: |plant, v| {
        plant.vehicle.p_origin_cm += Vec3::new(v[0], v[1], v[2]);
    },
};
