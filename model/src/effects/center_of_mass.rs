//! model: effect `center-of-mass`.

use super::{Acts, Effect, Parameter};
use crate::frames::Vec3;

pub(super) static EFFECT: Effect = Effect {
    family: "center-of-mass",
    acts: Acts::Lander,
    physics: "The centre of mass is not where it is declared: aerodynamic and tether forces act at a different arm, and the tracked origin swings about another point.",
    source: "Thesis eqs B.62-B.66; errata: 2.9 mm give the simulated Θ of Table 5.6",
    separate_by: "runs at another tunnel speed or with added ballast; a static balance of the model",
    parameters: |_| ["x_m", "y_m", "z_m"].map(|n| Parameter::strength(n, "m", 0.05)).to_vec(),
    apply: |plant, v| plant.vehicle.p_origin_cm += Vec3::new(v[0], v[1], v[2]),
};
