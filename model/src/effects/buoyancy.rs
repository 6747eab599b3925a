//! model: effect `buoyancy`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "buoyancy",
    acts: Acts::PointMass,
    physics: "The displaced air carries a part of the weight; fractions are of a sphere of the reference diameter, so that a body of another shape may have up to three.",
    source: "Archimedes; Batchelor, An Introduction to Fluid Dynamics, 1967, §4.1",
    separate_by: "a drop in vacuum or of a denser body of the same size",
    parameters: |_| vec![Parameter::amount("displaced_fraction", "-", 3.0, |p| p.point.buoyancy_fraction)],
    apply: |plant, v| plant.point.buoyancy_fraction += v[0],
};
