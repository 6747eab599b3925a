//! model: effect `swivel-friction`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "swivel-friction",
    acts: Acts::Lander,
    physics: "The swivel between line and model does not turn freely: it resists roll with a torque that hardly depends on how fast the model rolls, and stops a slow roll altogether.",
    source: "Coulomb friction, made smooth at rest: Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30, 1994",
    separate_by: "the same roll without tether (drop test), or with a freshly oiled swivel",
    parameters: |_| {
        vec![
            Parameter::amount("torque_n_m", "N m", 0.1, |p| p.tether.as_ref().map_or(0.0, |t| t.swivel_n_m)),
            Parameter::shape("slip_rad_s", "rad/s", 0.005, 0.5, 0.05, &[0.05]),
        ]
    },
    apply: |plant, v| {
        if let Some(t) = &mut plant.tether {
            t.swivel_n_m += v[0];
            t.swivel_rate_rad_s = v[1];
        }
    },
};
