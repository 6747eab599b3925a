//! model: effect `inertia`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "inertia",
    acts: Acts::Lander,
    physics: "Products of inertia that are not declared, or pitch and yaw inertia that differ otherwise than declared.",
    source: "Thesis eqs B.8-B.10; errata: products are not printed",
    separate_by: "perturbed runs with roll; a bifilar pendulum test",
    parameters: |_| ["xy_kg_m2", "xz_kg_m2", "yz_kg_m2", "yy_kg_m2"].map(|n| Parameter::strength(n, "kg m2", 0.01)).to_vec(),
    apply: |plant, v| {
        let i = &mut plant.vehicle.inertia;
        i.xy += v[0];
        i.xz += v[1];
        i.yz += v[2];
        i.yy += v[3];
    },
};
