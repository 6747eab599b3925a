//! model: effect `tether-length`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "tether-length",
    acts: Acts::Lander,
    physics: "The pull depends on how much line hangs between hook and ring: its drag and weight grow with length.",
    source: "Thesis §6.2 (position in the test section); Hoerner, Fluid-Dynamic Drag, 1965, ch. 4 (drag of lines)",
    separate_by: "runs held at several heights",
    parameters: |_| vec![Parameter::strength("per_m", "1/m", 20.0)],
    apply: |plant, v| {
        if let Some(t) = &mut plant.tether {
            t.length_per_m += v[0];
        }
    },
};
