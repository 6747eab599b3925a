//! model: effect `apparent-mass`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "apparent-mass",
    acts: Acts::Lander,
    physics: "Air that moves with the model must be accelerated with it: an extra inertia that acts on accelerations but has no weight, and, when it differs along and across the axis, a moment in steady flow (Munk) that static coefficients declared from the same data absorb.",
    source: "Lamb, Hydrodynamics, 1932, §§121-124; Brennen, Report CR 82.010, 1982",
    separate_by: "a perturbed run with larger vertical acceleration (step of tunnel speed) at the same attitude",
    parameters: |_| {
        vec![
            Parameter::amount("axial_kg", "kg", 0.3, |p| p.vehicle.apparent.axial_kg),
            Parameter::amount("radial_kg", "kg", 0.3, |p| p.vehicle.apparent.radial_kg),
            Parameter::amount("transverse_kg_m2", "kg m2", 0.01, |p| p.vehicle.apparent.transverse_kg_m2),
            Parameter::shape("unturned", "-", 0.0, 1.0, 0.0, &[0.0, 1.0]),
            Parameter::shape("in_gusts", "-", 0.0, 1.0, 0.0, &[0.0, 1.0]),
        ]
    },
    apply: |plant, v| {
        plant.vehicle.apparent.axial_kg += v[0];
        plant.vehicle.apparent.radial_kg += v[1];
        plant.vehicle.apparent.transverse_kg_m2 += v[2];
        plant.vehicle.apparent.unturned = v[3];
        plant.vehicle.apparent.in_gusts = v[4];
    },
};
