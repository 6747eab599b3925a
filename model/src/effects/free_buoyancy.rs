//! model: effect `buoyancy`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "buoyancy",
    acts: Acts::FreeFlight,
    physics: "The displaced air carries more or less than declared: helium is lost between flights, and the net weight is the small difference of two larger numbers. The change acts where the displaced air does.",
    source: "Archimedes; Khoury, Airship Technology, 2012, ch. 2",
    separate_by: "the body weighed in still air before each flight",
    parameters: |_| vec![Parameter::strength("fraction", "-", 0.2)],
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            free.buoyancy_kg *= 1.0 + v[0];
        }
    },
};
