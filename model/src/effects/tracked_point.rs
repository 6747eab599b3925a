//! model: effect `tracked-point`.

use super::{Acts, Effect, Parameter};
use crate::frames::Vec3;

pub(super) static EFFECT: Effect = Effect {
    family: "tracked-point",
    acts: Acts::FreeFlight,
    physics: "Recorded positions are those of another point of the body than its geometric origin, so that turning looks like translation.",
    source: "Klein and Morelli, Aircraft System Identification, 2006, §10.2 (lever arm)",
    separate_by: "a static calibration: the body turned by hand about a fixed point",
    parameters: |_| ["x_m", "y_m", "z_m"].map(|n| Parameter::strength(n, "m", 0.2)).to_vec(),
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            free.p_origin_tracked += Vec3::new(v[0], v[1], v[2]);
        }
    },
};
