//! model: effect `pivot-friction`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "pivot-friction",
    acts: Acts::Pivot,
    physics: "The bearing resists turning with a torque that hardly depends on the rate (dry friction), so that amplitude falls by the same amount in every swing and the body stops away from its lowest place.",
    source: "Coulomb; made smooth at rest: Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30, 1994",
    separate_by: "small swings from rest, and the same arm with a weight added near the pivot",
    parameters: |_| vec![Parameter::amount("torque_n_m", "N m", 0.01, |p| p.point.pivot.map_or(0.0, |p| p.dry_n_m))],
    apply: |plant, v| {
        if let Some(p) = &mut plant.point.pivot {
            p.dry_n_m += v[0];
        }
    },
};
