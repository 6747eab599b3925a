//! model: effect `viscous-friction`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "viscous-friction",
    acts: Acts::Pivot,
    physics: "The bearing resists turning in proportion to the rate otherwise than declared (grease, temperature), so that amplitude falls by another share in every swing.",
    source: "Newton; Stribeck, VDI-Z. 46, 1902 (lubricated bearings)",
    separate_by: "the same swings at another temperature or with another lubricant; a decay from small amplitude",
    parameters: |_| vec![Parameter::amount("viscous_n_m_s", "N m s", 0.01, |p| p.point.pivot.map_or(0.0, |p| p.viscous_n_m_s))],
    apply: |plant, v| {
        if let Some(p) = &mut plant.point.pivot {
            p.viscous_n_m_s += v[0];
        }
    },
};
