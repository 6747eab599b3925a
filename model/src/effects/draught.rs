//! model: effect `draught`.

use super::{Acts, Effect, Parameter};
use crate::frames::Vec3;

pub(super) static EFFECT: Effect = Effect {
    family: "draught",
    acts: Acts::FreeFlight,
    physics: "The air of the room moves, the same everywhere and in every run: ventilation, convection over a warm floor.",
    source: "Kinematics",
    separate_by: "a smoke or balloon trace in the room; the same flight started the other way round",
    parameters: |_| ["down_m_s", "y_m_s", "z_m_s"].map(|n| Parameter::strength(n, "m/s", 0.3)).to_vec(),
    apply: |plant, v| {
        if let Some(free) = plant.free_flight.as_mut() {
            free.v_tunnel_air += Vec3::new(v[0], v[1], v[2]);
        }
    },
};
