//! model: effect `asymmetry`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;

pub(super) static EFFECT: Effect = Effect {
    family: "asymmetry",
    acts: Acts::FreeFlight,
    physics: "Side force, rolling and yawing moment coefficients beyond the declared ones, the same at all angles: a body built or bent askew.",
    source: "Etkin, Dynamics of Flight, 1996, ch. 2",
    separate_by: "straight glides without thrust, and turns to both sides",
    parameters: |_| {
        vec![Parameter::strength("CS", "-", 0.5), Parameter::strength("Cl", "-", 0.1), Parameter::strength("Cn", "-", 0.1)]
    },
    apply: |plant, v| {
        for (coefficient, value) in [C::CY, C::Cl, C::Cn].into_iter().zip(v).filter(|(_, v)| **v != 0.0) {
            plant.aero.add(coefficient, *value, 1.0, &[]);
        }
    },
};
