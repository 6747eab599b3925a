//! model: effect `spin-lift`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "spin-lift",
    acts: Acts::PointMass,
    physics: "A spinning ball lifts across its velocity (Magnus): the lift coefficient follows the settings of the launcher.",
    source: "Briggs, Am. J. Phys. 27, 1959; Mehta, Ann. Rev. Fluid Mech. 17, 1985",
    separate_by: "launches with the settings reversed",
    parameters: |inputs| {
        let mut all: Vec<_> = inputs.iter().map(|i| Parameter::per_input("CL", i, 10.0)).collect();
        all.push(Parameter::strength("CL_constant", "-", 5.0));
        all
    },
    apply: |plant, v| {
        let n = v.len() - 1;
        let lift = &mut plant.point.lift_per_input;
        lift.resize(lift.len().max(n), 0.0);
        for (k, value) in lift.iter_mut().zip(&v[..n]) {
            *k += value;
        }
        plant.point.lift_constant += v[n];
    },
};
