//! Families of the catalogue, each planted at a size of which one is plainly visible.

use crate::air::{Colour, Gusts};
use crate::chance::Chance;
use crate::knobs::Knob as K;
use crate::spec::Spec;

/// Those of a lander, without those of [`LATER`].
pub(crate) const FAMILIES: [&str; 25] = [
    "damping-shape",
    "apparent-mass",
    "asymmetry",
    "roll-periodic",
    "magnus",
    "axial-shape",
    "axial-speed",
    "roll-damping-shape",
    "rate-force",
    "turbulence",
    "flow-profile",
    "swirl",
    "cross-flow",
    "wake-shedding",
    "tether-line-rate",
    "tether-length",
    "tether-geometry",
    "center-of-mass",
    "inertia",
    "loose-mass",
    "wind-scale",
    "wind-delay",
    "pose-misalignment",
    "pose-delay",
    "contact",
];

/// Families that a catalogue may have or not: named by themselves they are right as they are as something outside.
pub(crate) const LATER: [&str; 4] = ["length-scale", "time-base", "mass", "swivel-friction"];

/// Families that the same data may not tell from this one.
fn rivals(family: &str) -> &'static [&'static str] {
    match family {
        "asymmetry" => &["center-of-mass"],
        "center-of-mass" => &["asymmetry"],
        _ => &[],
    }
}

/// Adds a family to a campaign.
///
/// # Panics
/// On a family that is not of [`FAMILIES`] or [`LATER`].
pub(crate) fn plant(spec: &mut Spec, family: &str, size: f64, c: &mut Chance) {
    spec.families.push(family.to_owned());
    spec.rivals.extend(rivals(family).iter().map(|r| (*r).to_owned()));
    if !(geometric(spec, family, size, c) || aerodynamic(spec, family, size, c) || flowing(spec, family, size, c)) {
        instrumental(spec, family, size, c);
    }
}

fn geometric(spec: &mut Spec, family: &str, size: f64, c: &mut Chance) -> bool {
    let s = size;
    let mass = spec.craft.mass / 0.7873;
    let k = &mut spec.knobs;
    match family {
        "apparent-mass" => {
            k.set(K::MaX, 0.035 * s * mass);
            k.set(K::MaR, 0.022 * s * mass);
            k.set(K::IaR, 0.0005 * s * mass);
        }
        "tether-line-rate" => k.set(K::TethC, 0.6 * s),
        "tether-length" => k.set(K::TethLen, 6.0 * s * c.sign()),
        "tether-geometry" => {
            if c.happens(0.5) {
                let excess = 3.0 * s;
                spec.craft.drag_area *= 1.0 + excess;
                spec.craft.line_weight *= 1.0 + excess;
            } else {
                let angle = c.phase();
                k.set(K::RingY, 0.8 * s * angle.cos());
                k.set(K::RingZ, 0.8 * s * angle.sin());
            }
        }
        "center-of-mass" => {
            let angle = c.phase();
            spec.craft.cm[1] += 0.0027 * s * angle.cos();
            spec.craft.cm[2] += 0.0027 * s * angle.sin();
        }
        "inertia" => {
            let (angle, yy) = (c.phase(), spec.craft.inertia[1]);
            k.set(K::Ixy, 0.05 * s * yy * angle.cos());
            k.set(K::Ixz, 0.05 * s * yy * angle.sin());
        }
        "loose-mass" => {
            k.set(K::SloshM, 0.03 * s * mass);
            k.set(K::SloshHz, c.factor(0.8, 3.5));
            k.set(K::SloshZeta, c.factor(0.03, 0.08));
            k.set(K::SloshX, 0.1 * c.sign());
        }
        "mass" => {
            spec.declared.mass *= 1.0 + 0.03 * s * c.sign();
            spec.reference.mass = spec.declared.mass;
        }
        "swivel-friction" => k.set(K::Swivel, 2.5e-4 * s),
        _ => return false,
    }
    true
}

fn aerodynamic(spec: &mut Spec, family: &str, size: f64, c: &mut Chance) -> bool {
    let (s, angle, sign) = (size, c.phase(), c.sign());
    let k = &mut spec.knobs;
    match family {
        "damping-shape" => {
            k.set(K::Bump, 7.0 * s * if c.happens(0.75) { 1.0 } else { -1.0 });
            k.set(K::BumpWidth, c.factor(0.06, 0.2));
        }
        "asymmetry" => {
            k.set(K::Cm0, 0.07 * s * angle.cos());
            k.set(K::Cn0, 0.07 * s * angle.sin());
        }
        "roll-periodic" => {
            k.set(K::RpCos, 0.3 * s * angle.cos());
            k.set(K::RpSin, 0.3 * s * angle.sin());
            k.set(K::RpN, 2.0 + c.below(4) as f64);
        }
        "magnus" => k.set(K::Mag, 6.0 * s * sign),
        "axial-shape" => k.set(K::CA2, 2.2 * s * sign),
        "axial-speed" => k.set(K::CaV, 0.6 * s * sign),
        "roll-damping-shape" => k.set(K::Clpp, -750.0 * s),
        "rate-force" => k.set(K::CNq, 9.0 * s),
        "wake-shedding" => {
            k.set(K::Shed, 0.065 * s);
            k.set(K::Strouhal, c.factor(0.03, 0.07));
            k.set(K::ShedBand, c.factor(0.1, 0.3));
        }
        _ => return false,
    }
    true
}

fn flowing(spec: &mut Spec, family: &str, size: f64, c: &mut Chance) -> bool {
    let (s, angle, sign) = (size, c.phase(), c.sign());
    let k = &mut spec.knobs;
    match family {
        "turbulence" => {
            let rms = c.uniform(0.06, 0.11) * s;
            spec.gusts = Some(Gusts { colour: Colour::Dryden, axial: 0.9 * rms, lateral: rms, length: c.factor(0.3, 1.2) });
        }
        "flow-profile" => {
            if c.happens(0.6) {
                k.set(K::Prof, 0.3 * s * sign);
            } else {
                k.set(K::TiltY, 0.03 * s * angle.cos());
                k.set(K::TiltZ, 0.03 * s * angle.sin());
            }
        }
        "swirl" => k.set(K::Swirl, 0.2 * s * sign),
        "cross-flow" => {
            k.set(K::Vy, 0.12 * s * angle.cos());
            k.set(K::Vz, 0.12 * s * angle.sin());
        }
        _ => return false,
    }
    true
}

fn instrumental(spec: &mut Spec, family: &str, size: f64, c: &mut Chance) {
    let (s, angle, sign) = (size, c.phase(), c.sign());
    let duration = spec.plans()[0].duration;
    let k = &mut spec.knobs;
    match family {
        "wind-scale" => k.set(K::Vscale, 0.02 * s * sign),
        "wind-delay" => k.set(K::Vdelay, 0.3 * s),
        "pose-misalignment" => {
            k.set(K::MisY, 0.012 * s * angle.cos());
            k.set(K::MisZ, 0.012 * s * angle.sin());
        }
        "pose-delay" => k.set(K::PoseDelay, 0.02 * s),
        "contact" => {
            k.set(K::HitRun, 1.0 + c.below(2) as f64);
            k.set(K::HitAt, c.uniform(3.0, duration - 3.0));
            k.set(K::HitFor, c.uniform(0.12, 0.35));
            k.set(K::HitF, 0.03 * s * sign);
            k.set(K::HitM, 0.004 * s * c.sign());
        }
        "length-scale" => k.set(K::LengthScale, 0.03 * s * sign),
        "time-base" => k.set(K::TimeScale, 0.02 * s * sign),
        other => unreachable!("no family {other}"),
    }
}
