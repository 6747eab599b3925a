//! model: effect `pose-misalignment`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "pose-misalignment",
    acts: Acts::Attitude,
    physics: "The reflective dots are registered at a slightly wrong attitude: reported body axes are turned against the real ones.",
    source: "Thesis §2.1.4; Klein and Morelli, Aircraft System Identification, 2006, §10.2",
    separate_by: "a static calibration of the dots on a surface plate",
    parameters: |_| ["x_rad", "y_rad", "z_rad"].map(|n| Parameter::strength(n, "rad", 0.2)).to_vec(),
    apply: |plant, v| {
        for (angle, value) in plant.sensors.misalignment_rad.iter_mut().zip(v) {
            *angle += value;
        }
    },
};
