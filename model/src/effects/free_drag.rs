//! model: effect `drag`.

use super::drag::LARGEST_CD;
use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;
use crate::plant::Plant;

pub(super) static EFFECT: Effect = Effect {
    family: "drag",
    acts: Acts::FreeFlight,
    physics: "Drag coefficient beyond the declared one, the same at all angles.",
    source: "Hoerner, Fluid-Dynamic Drag, 1965",
    separate_by: "glides without thrust, the body weighed",
    parameters: |_| vec![Parameter::amount("CD", "-", LARGEST_CD, Plant::least_drag)],
    apply: |plant, v| {
        if v[0] != 0.0 {
            plant.aero.add(C::CA, v[0], 1.0, &[]);
        }
    },
};
