//! model: effect `mass`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "mass",
    acts: Acts::Lander,
    physics: "The model weighs other than declared (ballast, moisture, a line that carries part of it); its inertia is as declared.",
    source: "Thesis eqs B.5-B.7 and B.12",
    separate_by: "weighing the model; runs at another air density or with a known ballast at the centre of mass",
    parameters: |_| vec![Parameter::strength("mass_kg", "kg", 0.3)],
    apply: |plant, v| plant.vehicle.mass_kg += v[0],
};
