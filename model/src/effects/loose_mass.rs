//! model: effect `loose-mass`.

use super::{Acts, Effect, Parameter};
use crate::vehicle::LooseMass;

pub(super) static EFFECT: Effect = Effect {
    family: "loose-mass",
    acts: Acts::Lander,
    physics: "A part inside the model (the movable ballast) can swing sideways on its mount and resonates.",
    source: "Den Hartog, Mechanical Vibrations, 1956, §3.2; thesis §2.1.2 (internal movable mass)",
    separate_by: "the same run with the ballast clamped",
    parameters: |_| {
        vec![
            Parameter::positive("mass_kg", "kg", 0.3),
            Parameter::shape("frequency_hz", "Hz", 0.3, 20.0, 2.0, &[0.7, 1.0, 1.4, 2.0, 2.8, 4.0]),
            Parameter::shape("damping_ratio", "-", 0.005, 1.0, 0.05, &[0.05]),
            Parameter::shape("x_cm_m", "m", -0.3, 0.3, 0.1, &[-0.1, 0.1]),
        ]
    },
    apply: |plant, v| {
        plant.vehicle.loose = Some(LooseMass { mass_kg: v[0], frequency_hz: v[1], damping_ratio: v[2], x_cm_m: v[3] });
    },
};
