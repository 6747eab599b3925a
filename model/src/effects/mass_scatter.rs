//! model: effect `mass-scatter`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "mass-scatter",
    acts: Acts::Runs,
    physics: "The mass differs from run to run (ballast, moisture, parts exchanged): each run has its own, normally distributed about the common one. Inertia is as declared.",
    source: "Gelman et al., Bayesian Data Analysis, 2013, ch. 5 (hierarchical models)",
    separate_by: "weighing the model before each run",
    parameters: |_| vec![Parameter::positive("std", "-", 1.0)],
    apply: |plant, v| plant.scatter.mass = plant.scatter.mass.hypot(v[0]),
};
