//! model: effect `roll-periodic`.

use super::{Acts, Effect, Parameter};
use crate::aero::{Coefficient as C, Factor};
use crate::flow::Variable as V;

pub(super) static EFFECT: Effect = Effect {
    family: "roll-periodic",
    acts: Acts::Lander,
    physics: "Outriggers and arm make the static moment vary with the clock angle of the wind: n-fold harmonics in φ of the moment in the plane of α_T.",
    source: "Thesis §1.2.3 (five outriggers, one arm) and §2.2.3 (static data against φ)",
    separate_by: "perturbed runs released at other clock angles",
    parameters: |_| {
        vec![
            Parameter::strength("Cm_cos", "-", 5.0),
            Parameter::strength("Cm_sin", "-", 5.0),
            Parameter::shape("harmonic", "-", 1.0, 12.0, 5.0, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
        ]
    },
    apply: |plant, v| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a harmonic number from 1 to 12")]
        let n = v[2].round() as u8;
        let s = Factor::Power(V::SinAlphaT, 1);
        for (value, wave) in [(v[0], Factor::CosClock(n)), (v[1], Factor::SinClock(n))] {
            plant.aero.add(C::Cm, value, 1.0, &[s, Factor::Power(V::CosPhi, 1), wave]);
            plant.aero.add(C::Cn, value, -1.0, &[s, Factor::Power(V::SinPhi, 1), wave]);
        }
    },
};
