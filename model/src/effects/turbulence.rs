//! model: effect `turbulence`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "turbulence",
    acts: Acts::Lander,
    physics: "Gusts of the tunnel push the model at random: three independent components of Dryden form, of stated rms along and across the stream, and length scale; force and moment come from one gust, coherently.",
    source: "MIL-F-8785C, 1980, §3.7; Dryden, NACA TR 342, 1930",
    separate_by: "a drop test in still air",
    parameters: |_| {
        vec![
            Parameter::positive("axial_rms_m_s", "m/s", 2.0),
            Parameter::positive("lateral_rms_m_s", "m/s", 2.0),
            Parameter::shape("scale_m", "m", 0.05, 10.0, 0.6, &[0.15, 0.3, 0.6, 1.2, 2.4]),
        ]
    },
    apply: |plant, v| {
        let t = &mut plant.turbulence;
        t.axial_rms_m_s = t.axial_rms_m_s.hypot(v[0]);
        t.lateral_rms_m_s = t.lateral_rms_m_s.hypot(v[1]);
        t.scale_m = v[2];
    },
};
