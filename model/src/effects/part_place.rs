//! model: effect `part-place`.

use super::{Acts, Effect, Parameter};
use crate::frames::Vec3;

pub(super) static EFFECT: Effect = Effect {
    family: "part-place",
    acts: Acts::FreeFlight,
    physics: "Parts and thrusts are not where the runs' settings say: the scale of a slide is off by a length, the same in every run.",
    source: "Statics",
    separate_by: "the slide measured from a mark; the body hung by one point",
    parameters: |_| ["x_m", "y_m", "z_m"].map(|n| Parameter::strength(n, "m", 0.05)).to_vec(),
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            free.part_shift += Vec3::new(v[0], v[1], v[2]);
        }
    },
};
