//! model: effect `length-scale`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "length-scale",
    acts: Acts::Any,
    physics: "The unit of length of the motion capture is off by a factor (the wand that it was calibrated with): recorded positions, and with them velocities and accelerations, are the true ones times that factor.",
    source: "Klein and Morelli, Aircraft System Identification, 2006, §10.2; thesis §2.1.4",
    separate_by: "a measured length in the view of the cameras; a heavy ball in free fall",
    parameters: |_| vec![Parameter::strength("scale", "-", 0.1)],
    apply: |plant, v| plant.sensors.length_scale += v[0],
};
