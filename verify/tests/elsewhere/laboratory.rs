//! Groups of records as laboratories have them: H filtered or taken again before they were written, I runs that differ, J instruments that
//! wander and clocks that are apart, K other sizes, L walls, steep angles and a gas that warms. Every second one has an effect of the catalogue too,
//! where nothing else is to be found.

use crate::chance::Chance;
use crate::craft::Craft;
use crate::groups::{large, partner, start, with_effect};
use crate::knobs::Knob as K;
use crate::spec::Spec;

/// Number `i` of a group, from a seed of its own.
///
/// # Panics
/// On a group that is not of H to L.
pub(crate) fn spec(group: &str, i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let mut spec = start(group, "clean", i % 4 > 1, seed, c);
    match group {
        "H" => smoothed(&mut spec, i, c),
        "I" => differing(&mut spec, i, c),
        "J" => wandering(&mut spec, i, c),
        "K" => sized(&mut spec, i),
        "L" => hard(&mut spec, i, c),
        other => unreachable!("no group {other}"),
    }
    if i % 2 == 1 && spec.families.is_empty() {
        let size = large(c, gain);
        // In a size of its own an effect is given by coefficients, not by lengths or masses.
        let family = if group == "K" { COEFFICIENTS[i / 2 % COEFFICIENTS.len()] } else { partner(i / 2) };
        with_effect(&mut spec, family, size, c);
    }
    spec
}

/// Effects whose numbers have no dimension.
const COEFFICIENTS: [&str; 9] = [
    "damping-shape",
    "asymmetry",
    "magnus",
    "axial-shape",
    "axial-speed",
    "roll-damping-shape",
    "rate-force",
    "wind-scale",
    "pose-misalignment",
];

fn named(spec: &mut Spec, what: &str) {
    what.clone_into(&mut spec.what);
}

fn smoothed(spec: &mut Spec, i: usize, c: &mut Chance) {
    if (i / 2).is_multiple_of(2) {
        spec.noise.corner_hz = c.factor(6.0, 40.0);
        named(spec, "filtered");
    } else {
        spec.noise.resampled_hz = [60.0, 75.0, 120.0, 200.0, 240.0][c.below(5)];
        named(spec, "resampled");
    }
}

fn differing(spec: &mut Spec, i: usize, c: &mut Chance) {
    let runs = spec.plans();
    let used: Vec<usize> = (0..runs.len()).filter(|&k| !runs[k].hold_out).collect();
    let mut other = |craft: Craft, which: &[usize]| spec.own_craft.extend(which.iter().map(|k| (*k, craft.clone())));
    let mut craft = spec.craft.clone();
    let what = match i / 2 % 5 {
        0 => {
            craft.mass *= 1.0 + c.sign() * c.factor(0.01, 0.03);
            let unperturbed: Vec<usize> = (0..runs.len()).filter(|&k| runs[k].kind == "unperturbed").collect();
            other(craft, &unperturbed);
            "mass"
        }
        1 => {
            let which = [0, 1, 5][c.below(3)];
            craft.aero[which] *= 1.0 + c.sign() * c.factor(0.05, 0.15);
            other(craft, &used[..1]);
            "coefficient"
        }
        2 => {
            craft.hook[1] += c.sign() * c.factor(0.008, 0.02);
            other(craft, &used[..1]);
            "attachment"
        }
        3 => {
            craft.aero.iter_mut().for_each(|a| *a *= 1.0 + 0.1 * c.normal());
            let perturbed: Vec<usize> = (0..runs.len()).filter(|&k| runs[k].kind == "perturbed").collect();
            other(craft, &perturbed);
            "two vehicles"
        }
        _ => {
            spec.run_noise = (0..runs.len()).map(|_| c.factor(0.5, 4.0)).collect();
            "noise by run"
        }
    };
    named(spec, what);
    let right = match what {
        "mass" => "mass-scatter",
        "coefficient" => "aero-scatter",
        "attachment" => "attachment-scatter",
        // All coefficients of half of the runs.
        "two vehicles" => "unexplained",
        _ => return,
    };
    spec.families.push(right.to_owned());
    spec.tag("form", what);
}

fn wandering(spec: &mut Spec, i: usize, c: &mut Chance) {
    let (what, right) = match i % 4 {
        0 => {
            spec.noise.wander[6] = c.factor(2.0, 8.0);
            ("speed wanders", "speed-drift")
        }
        1 => {
            (0..3).for_each(|k| spec.noise.wander[k] = c.factor(0.7, 2.0));
            ("cameras wander", "pose-drift")
        }
        2 => {
            spec.knobs.set(K::Vdelay, c.factor(0.5, 4.0));
            ("speed late", "wind-delay")
        }
        _ => {
            spec.knobs.set(K::PoseDelay, c.factor(0.5, 4.0));
            spec.rivals.push("wind-delay".to_owned());
            ("pose late", "pose-delay")
        }
    };
    named(spec, what);
    spec.families.push(right.to_owned());
    spec.tag("form", what);
}

fn sized(spec: &mut Spec, i: usize) {
    let size = [0.5, 4.0, 10.0][i / 2 % 3];
    spec.size = size;
    spec.craft = spec.craft.sized(size);
    spec.declared = spec.craft.clone();
    spec.reference = spec.craft.clone();
    spec.other = true;
    named(spec, &format!("size {size}"));
}

fn hard(spec: &mut Spec, i: usize, c: &mut Chance) {
    let what = match i / 2 % 4 {
        0 => {
            spec.knobs.set(K::WallAt, 0.2);
            spec.knobs.set(K::WallStiff, c.factor(300.0, 3000.0));
            spec.knobs.set(K::WallDamp, 2.0);
            "hard wall"
        }
        1 => {
            spec.knobs.set(K::WallAt, 0.15);
            spec.knobs.set(K::WallStiff, c.factor(1.0, 5.0));
            "soft wall"
        }
        2 => {
            spec.release_deg = [38.0, 46.0];
            "steep"
        }
        _ => {
            spec.knobs.set(K::Heating, c.sign() * c.factor(0.004, 0.02));
            "gas warms"
        }
    };
    named(spec, what);
    if what.ends_with("wall") {
        spec.families.push("unexplained".to_owned());
        spec.tag("form", what);
    }
}
