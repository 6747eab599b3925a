//! model: effect `aero-scatter`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "aero-scatter",
    acts: Acts::Runs,
    physics: "One aerodynamic parameter differs from run to run (a bent fin, a fairing off, another state of the flow): each run has its own, normally distributed about the common one.",
    source: "Gelman et al., Bayesian Data Analysis, 2013, ch. 5 (hierarchical models)",
    separate_by: "each configuration flown twice, in turn",
    parameters: |_| vec![Parameter::positive("std", "-", 1.0), Parameter::aero_place("parameter")],
    apply: |plant, v| {
        plant.scatter.aero = v[0];
        plant.scatter.aero_place = v[1];
    },
};
