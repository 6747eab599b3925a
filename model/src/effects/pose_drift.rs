//! model: effect `pose-drift`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "pose-drift",
    acts: Acts::Runs,
    physics: "The recorded pose drifts slowly, each channel by itself: cameras that warm up or a mount that creeps. A first-order process of 30 s; over shorter times a random walk.",
    source: "Gelb, Applied Optimal Estimation, 1974, §3.6; IEEE Std 952, 1997, annex B",
    separate_by: "a record of the model at rest, as long as a run",
    parameters: |_| {
        let position = ["x_rms_m", "y_rms_m", "z_rms_m"].map(|n| Parameter::positive(n, "m", 0.1));
        let attitude = ["rx_rms_rad", "ry_rms_rad", "rz_rms_rad"].map(|n| Parameter::positive(n, "rad", 0.1));
        position.into_iter().chain(attitude).collect()
    },
    apply: |plant, v| {
        let drift = &mut plant.drift;
        let all = drift.position_rms_m.iter_mut().chain(&mut drift.attitude_rms_rad);
        all.zip(v).for_each(|(rms, more)| *rms = rms.hypot(*more));
    },
};
