//! model: effect `thrust`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "thrust",
    acts: Acts::FreeFlight,
    physics: "Thrusts are a factor larger or smaller than their settings, and those of the right and left by different factors: voltage of the battery, propellers that differ, inflow.",
    source: "McCormick, Aerodynamics, Aeronautics and Flight Mechanics, 1995, ch. 6",
    separate_by: "propellers on a balance; flights without thrust",
    parameters: |_| vec![Parameter::strength("fraction", "-", 0.5), Parameter::strength("unequal", "-", 0.3)],
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            free.thrust_excess += v[0];
            free.thrust_unequal += v[1];
        }
    },
};
