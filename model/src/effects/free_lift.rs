//! model: effect `lift`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;

pub(super) static EFFECT: Effect = Effect {
    family: "lift",
    acts: Acts::FreeFlight,
    physics: "Lift coefficient beyond the declared one, the same at all angles: camber, wings set at another angle.",
    source: "Etkin, Dynamics of Flight, 1996, ch. 2",
    separate_by: "glides at two net weights",
    parameters: |_| vec![Parameter::strength("CL", "-", 1.0)],
    apply: |plant, v| {
        if v[0] != 0.0 {
            plant.aero.add(C::CN, v[0], 1.0, &[]);
        }
    },
};
