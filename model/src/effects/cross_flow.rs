//! model: effect `cross-flow`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "cross-flow",
    acts: Acts::Lander,
    physics: "The stream is not vertical: a lateral component (flow angularity) fixed in the tunnel, while the model rolls; in proportion to the tunnel speed, or steady (what it is in proportion to at at_m_s).",
    source: "Barlow, Rae and Pope, Low-Speed Wind Tunnel Testing, 1999, §6.2; thesis §2.1.1 (flow straightener)",
    separate_by: "runs at other roll angles: a tunnel-fixed cause turns in body axes",
    parameters: |_| {
        let mut all = ["y_rad", "z_rad"].map(|n| Parameter::strength(n, "rad", 0.1)).to_vec();
        all.push(Parameter::shape("steady", "-", 0.0, 1.0, 0.0, &[0.0, 1.0]));
        all.push(Parameter::reference());
        all
    },
    apply: |plant, v| {
        plant.flow.angularity_rad[0] += v[0];
        plant.flow.angularity_rad[1] += v[1];
        plant.flow.steady_at_m_s = if v[2] > 0.5 { v[3] } else { 0.0 };
    },
};
