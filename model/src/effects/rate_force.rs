//! model: effect `rate-force`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor::Power as P};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "rate-force",
    acts: Acts::Lander,
    physics: "Pitching and yawing make a force across the axis: C_N from q̂, C_Y from r̂.",
    source: "Tobak and Schiff, NASA TR R-456, 1976; Klein and Morelli, Aircraft System Identification, 2006, §3.4",
    separate_by: "perturbed runs with a different ratio of rate to angle (another c.m. along the axis)",
    parameters: |_| vec![Parameter::strength("CN_q", "-", 100.0)],
    apply: |plant, v| {
        plant.aero.add(C::CN, v[0], 1.0, &[P(V::PitchRate, 1)]);
        plant.aero.add(C::CY, v[0], 1.0, &[P(V::YawRate, 1)]);
    },
};
