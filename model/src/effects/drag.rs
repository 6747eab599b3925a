//! model: effect `drag`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;

pub(super) static EFFECT: Effect = Effect {
    family: "drag",
    acts: Acts::PointMass,
    physics: "Quadratic drag against the velocity.",
    source: "Newton; Hoerner, Fluid-Dynamic Drag, 1965",
    separate_by: "launches at other speeds",
    parameters: |_| vec![Parameter::strength("CD", "-", 5.0)],
    apply: |plant, v| plant.aero.add(C::CA, v[0], 1.0, &[]),
};
