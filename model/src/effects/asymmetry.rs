//! model: effect `asymmetry`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;

pub(super) static EFFECT: Effect = Effect {
    family: "asymmetry",
    acts: Acts::Lander,
    physics: "A small asymmetry of the shape (a bent outrigger, an excavation arm) gives a constant body-fixed pitch or yaw moment, side or normal force.",
    source: "Murphy, Free Flight Motion of Symmetric Missiles, BRL R1216, 1963",
    separate_by: "runs at another tunnel speed or with added ballast: a moment from shape scales with q, one from mass offset with drag and weight",
    parameters: |_| ["Cm_0", "Cn_0", "CY_0", "CN_0"].map(|n| Parameter::strength(n, "-", 0.5)).to_vec(),
    apply: |plant, v| {
        for (c, value) in [C::Cm, C::Cn, C::CY, C::CN].into_iter().zip(v) {
            plant.aero.add(c, *value, 1.0, &[]);
        }
    },
};
