//! model: effect `wind-scale`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "wind-scale",
    acts: Acts::Lander,
    physics: "The recorded tunnel speed is off by a factor (probe calibration, blockage).",
    source: "Klein and Morelli, Aircraft System Identification, 2006, §10.2; Barlow, Rae and Pope, 1999, §6.4",
    separate_by: "a second speed probe; runs with much vertical motion",
    parameters: |_| vec![Parameter::strength("scale", "-", 0.3)],
    apply: |plant, v| plant.sensors.wind_scale += v[0],
};
