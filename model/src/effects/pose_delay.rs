//! model: effect `pose-delay`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "pose-delay",
    acts: Acts::Lander,
    physics: "Position and attitude are stamped late: the recorded pose is an old one, while tunnel speed is current.",
    source: "Thesis §2.1.4 (two recorders); Klein and Morelli, Aircraft System Identification, 2006, §10.2 (compatibility)",
    separate_by: "a run with steps of tunnel speed; a common mechanical event in both recorders",
    parameters: |_| vec![Parameter::positive("delay_s", "s", 0.3).allowed_to(super::LONGEST_LAG_S)],
    apply: |plant, v| plant.sensors.pose_delay_s += v[0],
};
