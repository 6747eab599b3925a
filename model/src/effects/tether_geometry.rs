//! model: effect `tether-geometry`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "tether-geometry",
    acts: Acts::Lander,
    physics: "The tether's drag or weight is wrong in size, or the ring is not where it is declared.",
    source: "Thesis eqs B.29-B.36 and §6.1 (the tether model may have errors)",
    separate_by: "the same perturbation without tether (drop test), or with the ring moved",
    parameters: |_| {
        vec![
            Parameter::strength("pull_excess", "-", 10.0),
            Parameter::strength("weight_excess", "-", 10.0),
            Parameter::strength("ring_y_m", "m", 3.0),
            Parameter::strength("ring_z_m", "m", 3.0),
        ]
    },
    apply: |plant, v| {
        if let Some(t) = &mut plant.tether {
            t.drag_area_m2 *= 1.0 + v[0];
            t.weight_n *= 1.0 + v[1];
            t.ring_shift_m[0] += v[2];
            t.ring_shift_m[1] += v[3];
        }
    },
};
