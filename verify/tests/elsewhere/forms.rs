//! Forms outside the catalogue: a name, the channel and variable that a good lead would name, and how it is planted.

use crate::chance::Chance;
use crate::knobs::Knob as K;
use crate::spec::Spec;

/// One form.
pub(crate) struct Form {
    pub(crate) name: &'static str,
    /// Where it acts and on what it depends: what a lead should say.
    pub(crate) lead: &'static str,
    plant: fn(&mut Spec, f64, &mut Chance),
}

fn set(spec: &mut Spec, rows: &[(K, f64)]) {
    for (k, v) in rows {
        spec.knobs.set(*k, *v);
    }
}

macro_rules! form {
    ($name:literal, $lead:literal, |$s:ident, $c:ident| [$($knob:ident = $value:expr),*]) => {
        Form { name: $name, lead: $lead, plant: |spec, $s, $c| { let _ = &$c; set(spec, &[$((K::$knob, $value)),*]); } }
    };
}

/// All forms, at size one plainly visible.
pub(crate) const FORMS: &[Form] = &[
    form!("hysteretic-moment", "Cm, Cn: sign of the angle's rate", |s, c| [Hyst = 0.06 * s * c.sign()]),
    form!("fan-tone", "CA: line in frequency", |s, c| [Tone = 0.08 * s, ToneHz = c.factor(0.8, 4.0)]),
    form!("periodic-gust", "CY, CN: line in frequency", |s, c| [SideTone = 0.15 * s, SideHz = c.factor(0.3, 1.2)]),
    form!("pole-wake", "CA: place", |s, c| [Pole = 0.06 * s]),
    form!("moment-jump", "Cm, Cn: angle, a step", |s, c| [Jump = 0.03 * s * c.sign(), JumpAt = c.uniform(0.06, 0.13)]),
    form!("damping-in-time", "Cm, Cn: time", |s, c| [DampTime = 0.8 * s]),
    form!("sticking-line", "CA, tether: sign of the line's rate", |s, c| [Stick = 0.02 * s]),
    form!("snapping-line", "CA, tether: height, one-sided", |s, c| [Snap = 0.6 * s]),
    form!("probe-heating", "VW: time", |s, c| [ProbeHeat = 0.015 * s * c.sign()]),
    form!("probe-bending", "VW: speed", |s, c| [ProbeBend = 0.4 * s * c.sign()]),
    form!("magnetic-moment", "Cl, Cn: attitude in the tunnel", |s, c| [Magnet = 6e-4 * s * c.sign()]),
    form!("late-normal-force", "CY, CN: rate of the angle", |s, c| [LagN = 0.03 * s]),
    form!("fluid-ballast", "Cl, Cm, Cn: rates, late", |s, c| [Fluid = 6e-4 * s, FluidTime = c.factor(0.3, 1.0)]),
    form!("leaking-mass", "CA: time", |s, c| [Leak = 0.006 * s]),
    form!("bending-outrigger", "Cm: line in frequency", |s, c| [Bend = 0.15 * s, BendHz = c.factor(1.5, 3.5)]),
    form!("moment-by-speed", "Cm, Cn: speed", |s, c| [CmV = 1.5 * s * c.sign()]),
    form!("roll-from-angles", "Cl: both angles", |s, c| [RollPitch = 0.08 * s * c.sign()]),
    form!("flow-angle-by-height", "CY: height", |s, c| [HeightFlow = 0.04 * s * c.sign()]),
    form!("scattered-trim", "Cm: run", |s, c| [Scatter = 0.04 * s]),
    form!("wall-force", "CY, CN: place", |s, c| [Wall = 0.5 * s * c.sign()]),
    form!("pose-by-roll", "Y: roll", |s, c| [RollBias = 0.002 * s * c.sign()]),
    form!("yaw-drift", "Rz: time", |s, c| [YawDrift = 1.2e-4 * s * c.sign()]),
    form!("yaw-step", "Rz: time, a step", |s, c| [YawStep = 0.004 * s * c.sign()]),
    form!("damping-by-rate", "Cm, Cn: rate", |s, c| [QQ = -100.0 * s]),
    form!("rotor", "Cm, Cn: rates across", |s, c| [Gyro = 8e-4 * s * c.sign()]),
    form!("swaying-ring", "tether: line in frequency", |s, c| [RingSway = 0.35 * s]),
    form!("speed-by-height", "CA: height", |s, c| [Shear = 0.02 * s * c.sign()]),
    form!("warming-air", "all: time", |s, c| [Warm = 0.012 * s]),
    form!("growing-drag", "CA: time", |s, c| [Ice = 0.012 * s * c.sign()]),
    form!("one-sided-moment", "Cm: sign of alpha", |s, c| [OneSided = 0.25 * s * c.sign()]),
    form!("cross-damping", "Cm, Cn: rates across", |s, c| [CrossDamp = 1.5 * s * c.sign()]),
    form!("flipping-drag", "CA: time, steps", |s, c| [AxialBurst = 0.05 * s]),
];

/// Forms of group M, which no generic basis of the program was made for.
pub(crate) const NEW: &[Form] = &[
    form!("drag-by-roll-rate", "CA: roll rate", |s, c| [RollDrag = 80.0 * s * c.sign()]),
    form!("torsion-of-the-line", "Cl: roll angle", |s, c| [Torsion = 2e-4 * s]),
    form!("late-moment", "Cm, Cn: angle, late", |s, c| [LagM = 0.15 * s, LagMTime = c.factor(0.1, 0.4)]),
    form!("dead-band", "VW: its own change", |s, c| [DeadBand = 0.03 * s]),
    form!("wavy-moment", "Cm, Cn: angle", |s, c| [Wavy = 0.04 * s * c.sign()]),
    form!("separation-at-an-edge", "CA, CN: angle, a step", |s, c| [Edge = 0.2 * s, EdgeAt = c.uniform(0.05, 0.12)]),
    form!("vanes-by-speed", "Cl: speed", |s, c| [VaneSpeed = 0.06 * s * c.sign()]),
    form!("stiff-pulley", "CA, tether: sign of the line's rate", |s, c| [Pulley = 0.3 * s]),
    form!("warm-column", "all: place", |s, c| [Plume = 0.03 * s]),
    form!("parallax", "Y: height", |s, c| [Parallax = 0.05 * s * c.sign()]),
    form!("yaw-tone", "Cn: line in frequency", |s, c| [YawTone = 0.02 * s, YawToneHz = c.factor(0.5, 3.0)]),
    form!("sagging-trim", "Cm: time", |s, c| [Sag = 0.02 * s * c.sign()]),
];

/// Adds form number `which` of a list to a campaign.
pub(crate) fn plant(spec: &mut Spec, forms: &[Form], which: usize, size: f64, c: &mut Chance) {
    let form = &forms[which % forms.len()];
    (form.plant)(spec, size, c);
    spec.families.push("unexplained".to_owned());
    spec.tag("form", form.name);
    spec.tag("lead", form.lead);
    spec.tag("size", size);
}
