//! model: effect `loose-mass`.

use super::{Acts, Effect, Parameter};
use crate::vehicle::LooseMass;

/// Frequencies tried: at a damping ratio of 0.05 a resonance is 10 % wide, and one that falls between two tries is not seen.
const TRIED_HZ: [f64; 17] =
    [0.70, 0.78, 0.87, 0.97, 1.08, 1.20, 1.34, 1.49, 1.66, 1.85, 2.06, 2.30, 2.56, 2.85, 3.17, 3.53, 3.93];

pub(super) static EFFECT: Effect = Effect {
    family: "loose-mass",
    acts: Acts::Lander,
    physics: "A part inside the model (the movable ballast) can swing sideways on its mount and resonates.",
    source: "Den Hartog, Mechanical Vibrations, 1956, §3.2; thesis §2.1.2 (internal movable mass)",
    separate_by: "the same run with the ballast clamped",
    parameters: |_| {
        vec![
            Parameter::positive("mass_kg", "kg", 0.3),
            Parameter::shape("frequency_hz", "Hz", 0.3, 20.0, 2.0, &TRIED_HZ),
            Parameter::shape("damping_ratio", "-", 0.005, 1.0, 0.05, &[0.05]),
            Parameter::shape("x_cm_m", "m", -0.3, 0.3, 0.1, &[-0.1, 0.1]),
            Parameter::shape("in_full", "-", 0.0, 1.0, 1.0, &[1.0]),
        ]
    },
    apply: |plant, v| {
        plant.vehicle.loose =
            Some(LooseMass { mass_kg: v[0], frequency_hz: v[1], damping_ratio: v[2], x_cm_m: v[3], in_full: v[4] });
    },
};
