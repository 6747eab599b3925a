//! model: effect `static-pressure`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "static-pressure",
    acts: Acts::Altimeter,
    physics: "The vents of the altimeter do not see the pressure of the free air but one that is off by a share of the dynamic pressure, which brakes or flaps beside them change; the height is wrong by that share of v2/2g.",
    source: "Gracey, Measurement of aircraft speed and altitude, NASA RP-1046, 1980, ch. 3-6 (position error of static-pressure installations)",
    separate_by: "an accelerometer or satellite heights beside the altimeter; vents away from brakes and shoulders",
    parameters: |inputs| {
        let mut all = vec![Parameter::strength("Cp", "-", 0.5)];
        all.extend(inputs.iter().map(|i| Parameter::per_input("Cp", i, 10.0)));
        all
    },
    apply: |plant, v| {
        plant.point.pressure_coefficient += v[0];
        let per = &mut plant.point.pressure_per_input;
        per.resize(per.len().max(v.len() - 1), 0.0);
        per.iter_mut().zip(&v[1..]).for_each(|(k, value)| *k += value);
    },
};
