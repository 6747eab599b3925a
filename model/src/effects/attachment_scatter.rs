//! model: effect `attachment-scatter`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "attachment-scatter",
    acts: Acts::Runs,
    physics: "The tether is attached elsewhere in each run (a knot that slips): its place across the body is normally distributed about the common one.",
    source: "Gelman et al., Bayesian Data Analysis, 2013, ch. 5 (hierarchical models); thesis eqs B.29-B.36",
    separate_by: "measuring the attachment before and after each run",
    parameters: |_| vec![Parameter::positive("std_m", "m", 0.5)],
    apply: |plant, v| {
        if plant.tether.is_some() {
            plant.scatter.attachment_m = plant.scatter.attachment_m.hypot(v[0]);
        }
    },
};
