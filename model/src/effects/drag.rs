//! model: effect `drag`.

use super::{Acts, Effect, Parameter};
use crate::aero::Coefficient as C;
use crate::plant::Plant;

/// Largest drag coefficient on the cross-section of the reference diameter. A cube of that edge has 1.05 face on (1.34 on the circle), and
/// seen along its diagonal 2.2 times the circle's area.
pub(super) const LARGEST_CD: f64 = 3.0;

pub(super) static EFFECT: Effect = Effect {
    family: "drag",
    acts: Acts::PointOrPivot,
    physics: "Quadratic drag against the velocity; its coefficient may follow the settings of the launcher, since spin moves separation on a ball.",
    source: "Newton; Hoerner, Fluid-Dynamic Drag, 1965; Bearman and Harvey, Aeronaut. Q. 27, 1976 (drag over spin)",
    separate_by: "launches at other speeds, and with other settings",
    parameters: |inputs| {
        let alone = Parameter::amount("CD", "-", LARGEST_CD, Plant::least_drag);
        // With settings, the first is drag at settings of zero, which may be far from any launch.
        let mut all =
            vec![if inputs.is_empty() { alone } else { Parameter { net: alone.net, ..Parameter::strength("CD", "-", 50.0) } }];
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
