//! model: effect `magnus`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor::Power as P};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "magnus",
    acts: Acts::Lander,
    physics: "A rolling body at an angle feels a force and moment across the plane of the angle, in proportion to p̂ sin α_T.",
    source: "Murphy, Free Flight Motion of Symmetric Missiles, BRL R1216, 1963; Vaughn and Reis, AIAA J. 13(7), 1975",
    separate_by: "perturbed runs with faster roll, of both signs",
    parameters: |_| vec![Parameter::strength("Cn_p_alpha", "-", 500.0), Parameter::strength("CY_p_alpha", "-", 500.0)],
    apply: |plant, v| {
        let (p, s) = (P(V::RollRate, 1), P(V::SinAlphaT, 1));
        plant.aero.add(C::Cm, v[0], 1.0, &[p, s, P(V::SinPhi, 1)]);
        plant.aero.add(C::Cn, v[0], 1.0, &[p, s, P(V::CosPhi, 1)]);
        plant.aero.add(C::CN, v[1], 1.0, &[p, s, P(V::SinPhi, 1)]);
        plant.aero.add(C::CY, v[1], 1.0, &[p, s, P(V::CosPhi, 1)]);
    },
};
