//! model: effect `trim-moment`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;

pub(super) static EFFECT: Effect = Effect {
    family: "trim-moment",
    acts: Acts::FreeFlight,
    physics: "Pitching moment coefficient beyond the declared one, the same at all angles: camber, a tail set at another angle.",
    source: "Etkin, Dynamics of Flight, 1996, ch. 2",
    separate_by: "glides at several speeds: a moment of the air grows with their square, that of a weight does not",
    parameters: |_| vec![Parameter::strength("Cm", "-", 0.5)],
    apply: |plant, v| {
        if v[0] != 0.0 {
            plant.aero.add(C::Cm, v[0], 1.0, &[]);
        }
    },
};
