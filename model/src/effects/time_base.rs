//! model: effect `time-base`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "time-base",
    acts: Acts::Any,
    physics: "The clock of the record runs fast or slow: recorded times are the true ones times a factor, so that rates come out smaller and accelerations smaller still.",
    source: "Klein and Morelli, Aircraft System Identification, 2006, §10.2; thesis §2.1.4 (two recorders)",
    separate_by: "a reference clock at both ends of a run; a heavy ball in free fall",
    parameters: |_| vec![Parameter::strength("rate", "-", 0.1)],
    apply: |plant, v| plant.sensors.time_base += v[0],
};
