//! model: effect `wake-shedding`.

use super::{Acts, Effect, Parameter};
use crate::disturbance::WakeShedding;

pub(super) static EFFECT: Effect = Effect {
    family: "wake-shedding",
    acts: Acts::Lander,
    physics: "Vortices leave the wake at a Strouhal frequency and shake the model in pitch and yaw: a narrow-band random moment about f = St V/d.",
    source: "Roshko, NACA TR 1191, 1954; Sakamoto and Haniu, J. Fluids Eng. 112, 1990; thesis §6.1",
    separate_by: "a run at another tunnel speed (lighter or heavier ballast): the band moves with V",
    parameters: |_| {
        vec![
            Parameter::positive("moment_rms", "-", 1.0),
            Parameter::shape("strouhal", "-", 0.003, 0.4, 0.04, &[0.012, 0.018, 0.025, 0.035, 0.05, 0.07, 0.1, 0.14]),
            Parameter::shape("bandwidth", "-", 0.02, 2.0, 0.2, &[0.1, 0.3, 0.8]),
        ]
    },
    apply: |plant, v| {
        plant.shedding = WakeShedding { moment_rms: v[0], strouhal: v[1], bandwidth: v[2] };
    },
};
