//! model: effect `rate-damping`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "rate-damping",
    acts: Acts::FreeFlight,
    physics: "Moments against the body rates are a factor larger or smaller than declared, about each axis.",
    source: "Etkin, Dynamics of Flight, 1996, ch. 5",
    separate_by: "releases with roll, pitch or yaw rate",
    parameters: |_| ["roll", "pitch", "yaw"].map(|n| Parameter::strength(n, "-", 1.0)).to_vec(),
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            free.damping_excess.iter_mut().zip(v).for_each(|(x, excess)| *x += excess);
        }
    },
};
