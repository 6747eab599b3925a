//! model: effect `apparent-mass`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "apparent-mass",
    acts: Acts::FreeFlight,
    physics: "The air that the body drags along resists its acceleration and, in steady flight aslant, turns it (Munk); fractions are of the displaced air, along the body's axes. Its products and its inertia in turning are left out.",
    source: "Lamb, Hydrodynamics, 1932, §124; Thomasson, J. Aircraft 37, 2000 (airships)",
    separate_by: "releases from rest without thrust, and steady flights at the same angles",
    parameters: |_| ["x", "y", "z"].map(|n| Parameter::positive(&format!("displaced_fraction_{n}"), "-", 2.0)).to_vec(),
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            let displaced_kg = free.buoyancy_kg;
            free.apparent_kg.iter_mut().zip(v).for_each(|(m, fraction)| *m += fraction * displaced_kg);
        }
    },
};
