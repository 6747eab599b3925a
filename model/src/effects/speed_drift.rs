//! model: effect `speed-drift`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "speed-drift",
    acts: Acts::Runs,
    physics: "The recorded tunnel speed drifts slowly away from the air's own: an anemometer that warms up. A first-order process of 30 s; over shorter times a random walk.",
    source: "Gelb, Applied Optimal Estimation, 1974, §3.6; IEEE Std 952, 1997, annex B",
    separate_by: "a second anemometer beside the first, or its zero before and after each run",
    parameters: |_| vec![Parameter::positive("rms_m_s", "m/s", 4.0)],
    apply: |plant, v| plant.drift.speed_rms_m_s = plant.drift.speed_rms_m_s.hypot(v[0]),
};
