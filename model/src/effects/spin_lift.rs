//! model: effect `spin-lift`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "spin-lift",
    acts: Acts::PointMass,
    physics: "A spinning ball is pushed across its velocity (Magnus): up or down by spin about a level axis, sideways as the axis leans; both coefficients follow the settings of the launcher.",
    source: "Briggs, Am. J. Phys. 27, 1959; Mehta, Ann. Rev. Fluid Mech. 17, 1985",
    separate_by: "launches with the settings reversed",
    parameters: |inputs| {
        ["CL", "CS"]
            .iter()
            .flat_map(|name| {
                let per = inputs.iter().map(move |i| Parameter::per_input(name, i, 10.0));
                // Spheres and cubes reach one and a half; with settings, the constant is that at settings of zero.
                let limit = if inputs.is_empty() { 1.5 } else { 50.0 };
                per.chain([Parameter::strength(&format!("{name}_constant"), "-", limit)])
            })
            .collect()
    },
    apply: |plant, v| {
        let (lift, side) = v.split_at(v.len() / 2);
        let n = lift.len() - 1;
        let point = &mut plant.point;
        add(&mut point.lift_per_input, &lift[..n]);
        add(&mut point.side_per_input, &side[..n]);
        point.lift_constant += lift[n];
        point.side_constant += side[n];
    },
};

fn add(to: &mut Vec<f64>, values: &[f64]) {
    to.resize(to.len().max(values.len()), 0.0);
    to.iter_mut().zip(values).for_each(|(k, value)| *k += value);
}
