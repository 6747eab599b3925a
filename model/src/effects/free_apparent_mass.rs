//! model: effect `apparent-mass`.

use super::{Acts, Effect, Parameter};
use crate::plant::Plant;

pub(super) static EFFECT: Effect = Effect {
    family: "apparent-mass",
    acts: Acts::FreeFlight,
    physics: "The air that the body drags along resists its acceleration and, in steady flight aslant, turns it (Munk); fractions are of the displaced air, along the body's axes. Its products and its inertia in turning are left out.",
    source: "Lamb, Hydrodynamics, 1932, §124; Thomasson, J. Aircraft 37, 2000 (airships)",
    separate_by: "releases from rest without thrust, and steady flights at the same angles",
    parameters: |_| {
        vec![
            Parameter::amount("displaced_fraction_x", "-", 2.0, |p| fraction(p, 0)),
            Parameter::amount("displaced_fraction_y", "-", 2.0, |p| fraction(p, 1)),
            Parameter::amount("displaced_fraction_z", "-", 2.0, |p| fraction(p, 2)),
        ]
    },
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            let displaced_kg = free.buoyancy_kg;
            free.apparent_kg.iter_mut().zip(v).for_each(|(m, fraction)| *m += fraction * displaced_kg);
        }
    },
};

/// Apparent mass along a body axis over that of the displaced air; zero where no air is displaced.
fn fraction(plant: &Plant, axis: usize) -> f64 {
    plant.free_flight.as_ref().filter(|f| f.buoyancy_kg > 0.0).map_or(0.0, |f| f.apparent_kg[axis] / f.buoyancy_kg)
}
