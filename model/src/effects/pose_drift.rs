//! model: effect `pose-drift`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "pose-drift",
    acts: Acts::Runs,
    physics: "The recorded pose drifts slowly, each channel by itself: cameras that warm up or a mount that creeps. A first-order process of 30 s; over shorter times a random walk.",
    source: "Gelb, Applied Optimal Estimation, 1974, §3.6; IEEE Std 952, 1997, annex B",
    separate_by: "a record of the model at rest, as long as a run",
    parameters: |_| {
        vec![Parameter::positive("position_rms_m", "m", 0.1), Parameter::positive("attitude_rms_rad", "rad", 0.1)]
    },
    apply: |plant, v| {
        plant.drift.position_rms_m = plant.drift.position_rms_m.hypot(v[0]);
        plant.drift.attitude_rms_rad = plant.drift.attitude_rms_rad.hypot(v[1]);
    },
};
