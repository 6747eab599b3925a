//! model: effect `apparent-mass`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "apparent-mass",
    acts: Acts::PointMass,
    physics: "A sphere drags along half the air it displaces when it accelerates; fractions are of a sphere of the reference diameter, so that a body of another shape may have up to three.",
    source: "Lamb, Hydrodynamics, 1932, §92",
    separate_by: "launches at very different accelerations, such as a drop beside a fast throw",
    parameters: |_| vec![Parameter::amount("displaced_fraction", "-", 3.0, |p| p.point.apparent_fraction)],
    apply: |plant, v| plant.point.apparent_fraction += v[0],
};
