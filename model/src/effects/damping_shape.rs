//! model: effect `damping-shape`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "damping-shape",
    acts: Acts::Lander,
    physics: "Pitch and yaw damping vary with angle otherwise than declared: a bump sech²(α_T/width) around zero angle (positive: less stable, the low-angle instability of blunt bodies) on top of the declared even polynomial.",
    source: "Mitcheltree, Wilmoth, Cheatwood, Brauckmann and Greene, AIAA 97-3539, 1997; thesis §4.1.1 and §6.1",
    separate_by: "an unperturbed run long enough to hold the limit cycle, and perturbations that decay through the bump",
    parameters: |_| {
        vec![
            Parameter::strength("bump", "-", 100.0),
            Parameter::shape("width_rad", "rad", 0.01, 0.6, 0.1, &[0.03, 0.06, 0.1, 0.17, 0.3]),
        ]
    },
    apply: |plant, v| {
        plant.aero.add(C::Cm, v[0], 1.0, &[Factor::Bump(V::AlphaT, v[1]), Factor::Power(V::PitchDamping, 1)]);
        plant.aero.add(C::Cn, v[0], 1.0, &[Factor::Bump(V::AlphaT, v[1]), Factor::Power(V::YawDamping, 1)]);
    },
};
