//! model: effect `turbulence`.

use super::{Acts, Effect, Parameter};

pub(super) static EFFECT: Effect = Effect {
    family: "turbulence",
    acts: Acts::Lander,
    physics: "Gusts of the tunnel push the model at random: three independent components, of stated rms and length scale along and across the stream, in Dryden's form or limited to a band about V/(2πL); force and moment come from one gust, coherently.",
    source: "MIL-F-8785C, 1980, §3.7; Dryden, NACA TR 342, 1930",
    separate_by: "a drop test in still air",
    parameters: |_| {
        vec![
            Parameter::positive("axial_rms_m_s", "m/s", 2.0),
            Parameter::positive("lateral_rms_m_s", "m/s", 2.0),
            Parameter::shape("axial_scale_m", "m", 0.05, 10.0, 0.6, &[0.2, 0.6, 1.8]),
            Parameter::shape("lateral_scale_m", "m", 0.05, 10.0, 0.6, &[0.2, 0.6, 1.8]),
            // Two octaves have a half-power bandwidth of 1.5 of their centre.
            Parameter::shape("bandwidth", "-", 0.0, 4.0, 0.0, &[1.5, 0.0]),
        ]
    },
    apply: |plant, v| {
        let t = &mut plant.turbulence;
        t.axial_rms_m_s = t.axial_rms_m_s.hypot(v[0]);
        t.lateral_rms_m_s = t.lateral_rms_m_s.hypot(v[1]);
        t.axial_scale_m = v[2];
        t.lateral_scale_m = v[3];
        t.bandwidth = v[4];
    },
};
