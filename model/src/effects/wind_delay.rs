//! model: effect `wind-delay`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "wind-delay",
    acts: Acts::Lander,
    physics: "The recorded tunnel speed lags the flow at the model (tubing, distance from the probe, a clock of its own).",
    source: "Klein and Morelli, Aircraft System Identification, 2006, §10.2; thesis §2.1.4",
    separate_by: "a run with steps of tunnel speed",
    parameters: |_| vec![Parameter::positive("delay_s", "s", 2.0).allowed_to(super::LONGEST_LAG_S)],
    apply: |plant, v| plant.sensors.wind_delay_s += v[0],
};
