//! model: effect `apparent-mass`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "apparent-mass",
    acts: Acts::PointMass,
    physics: "A sphere drags along half the air it displaces when it accelerates.",
    source: "Lamb, Hydrodynamics, 1932, §92",
    separate_by: "launches at very different accelerations, such as a drop beside a fast throw",
    parameters: |_| vec![Parameter::strength("displaced_fraction", "-", 20.0)],
    apply: |plant, v| plant.point.apparent_fraction += v[0],
};
