//! model: effect `axial-speed`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor::Power as P};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "axial-speed",
    acts: Acts::Lander,
    physics: "The axial coefficient varies with speed (Reynolds number: separation on pressure vessel and outriggers moves): ΔC_A = k (V/at_m_s − 1) cos α_T.",
    source: "Hoerner, Fluid-Dynamic Drag, 1965, ch. 3; thesis §6.2 (terms in airspeed correlated)",
    separate_by: "runs with steps of tunnel speed",
    parameters: |_| vec![Parameter::strength("CA_speed", "-", 10.0), Parameter::reference()],
    apply: |plant, v| {
        plant.aero.add(C::CA, v[0], 1.0 / v[1], &[P(V::Speed, 1), P(V::CosAlphaT, 1)]);
        plant.aero.add(C::CA, v[0], -1.0, &[P(V::CosAlphaT, 1)]);
    },
};
