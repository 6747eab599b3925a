//! model: effect `drag`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;

pub(super) static EFFECT: Effect = Effect {
    family: "drag",
    acts: Acts::PointOrPivot,
    physics: "Quadratic drag against the velocity; its coefficient may follow the settings of the launcher, since spin moves separation on a ball.",
    source: "Newton; Hoerner, Fluid-Dynamic Drag, 1965; Bearman and Harvey, Aeronaut. Q. 27, 1976 (drag over spin)",
    separate_by: "launches at other speeds, and with other settings",
    parameters: |inputs| {
        // With settings, the first is drag at settings of zero, which may be far from any launch.
        let at_zero = if inputs.is_empty() { Parameter::positive("CD", "-", 2.0) } else { Parameter::strength("CD", "-", 50.0) };
        let mut all = vec![at_zero];
        all.extend(inputs.iter().map(|i| Parameter::per_input("CD", i, 10.0)));
        all
    },
    apply: |plant, v| {
        if v[0] != 0.0 {
            plant.aero.add(C::CA, v[0], 1.0, &[]);
        }
        let drag = &mut plant.point.drag_per_input;
        drag.resize(drag.len().max(v.len() - 1), 0.0);
        drag.iter_mut().zip(&v[1..]).for_each(|(k, value)| *k += value);
    },
};
