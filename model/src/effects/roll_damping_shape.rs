//! model: effect `roll-damping-shape`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor::Power as P};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "roll-damping-shape",
    acts: Acts::Lander,
    physics: "Roll damping depends on angle or on roll rate itself: C_lp varies with sin²α_T and |p̂|.",
    source: "Murphy, Free Flight Motion of Symmetric Missiles, BRL R1216, 1963; thesis Tables 5.2-5.4 (C_lp from 0.6 to −5.7)",
    separate_by: "runs released with much roll rate, at small and at large angles",
    parameters: |_| vec![Parameter::strength("Cl_p_sin2", "-", 1000.0), Parameter::strength("Cl_p_abs_p", "-", 5000.0)],
    apply: |plant, v| {
        plant.aero.add(C::Cl, v[0], 1.0, &[P(V::RollRate, 1), P(V::SinAlphaT, 2)]);
        plant.aero.add(C::Cl, v[1], 1.0, &[P(V::RollRate, 1), P(V::RollRateAbs, 1)]);
    },
};
