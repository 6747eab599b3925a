//! Groups of campaigns, named as in the shared foreign ones: A clean, B noise, C constants, D turbulence, E outside the
//! catalogue, F several effects, G one effect hardly visible, S one effect plainly visible. H to L are in `laboratory`; M has forms
//! outside the catalogue that were written later.

use crate::air::{Colour, Gusts};
use crate::chance::Chance;
use crate::craft::Craft;
use crate::families::{FAMILIES, LATER, plant};
use crate::forms;
use crate::instruments::Noise;
use crate::knobs::Knob as K;
use crate::spec::{Run, Spec};
use crate::write::LABORATORY;

/// A campaign that flies: number `i` of a group. Draws are made again until one does.
///
/// # Panics
/// On a group that is not of A to M or S, or when none of 200 draws flies.
pub(crate) fn draw(group: &str, i: usize, seed: u64) -> (Spec, Vec<Run>) {
    (0..200)
        .find_map(|attempt| sized(group, i, seed * 1_000_003 + i as u64 * 1009 + attempt))
        .unwrap_or_else(|| panic!("group {group}, campaign {i}: none of 200 draws stays in the test section"))
}

/// A draw whose one effect is made as plain as wanted: its distance from the declared model is measured and its size chosen by it.
/// Effects of the catalogue keep the size at which they are given in `families` unless that is less than plain.
fn sized(group: &str, i: usize, seed: u64) -> Option<(Spec, Vec<Run>)> {
    let mut c = Chance::new(seed, 7);
    let [low, high] = match group {
        "G" => SMALL,
        "E" | "M" => PLAIN,
        "D" => [IN_GUSTS, f64::INFINITY],
        _ => [PLAIN[0], f64::INFINITY],
    };
    let wanted = c.factor(low, high.min(PLAIN[1] / PLAIN[0] * low));
    let mut gain = if group == "G" { 0.003 } else { 1.0 };
    let mut predicted = None;
    for _ in 0..4 {
        let mut spec = spec(group, i, seed, gain);
        let random = ["turbulence", "wake-shedding"];
        let given = spec.families.iter().filter(|f| !random.contains(&f.as_str())).count();
        let runs = spec.fly()?;
        let apart = match predicted {
            _ if given == 0 || ["F", "I", "J", "L"].contains(&group) => return Some((spec, runs)),
            Some(apart) => apart,
            None => crate::sizes::apart(&spec, &runs)?,
        };
        spec.tag("gain", gain);
        spec.tag("apart_sigma", apart.round());
        if (low..high).contains(&apart) || (gain >= MOST && apart < low) {
            return Some((spec, runs));
        }
        let by = (wanted / apart).clamp(0.003, 30.0).min(MOST / gain);
        gain *= by;
        // Near enough to be taken as in proportion.
        predicted = (0.2..5.0).contains(&by).then_some(apart * by);
    }
    None
}

/// Distances in standard deviations of what is plainly visible, from and to.
const PLAIN: [f64; 2] = [100.0, 600.0];
/// The same of what is hardly visible: about two and a half times what can be seen at all.
const SMALL: [f64; 2] = [4.0, 8.0];
/// What stands out of gusts that nobody knows: twice the middle of what is hardly visible without any.
const IN_GUSTS: f64 = 12.0;
/// Most that sizes are multiplied by: what hides even so stays hidden, and its distance is in the tags.
const MOST: f64 = 3.0;

/// Large sizes: this much of a plainly visible one.
pub(crate) fn large(c: &mut Chance, gain: f64) -> f64 {
    gain * c.factor(0.7, 1.5)
}

pub(crate) fn start(group: &str, what: &str, other: bool, seed: u64, c: &mut Chance) -> Spec {
    let craft = if other { Craft::other(c) } else { Craft::sage() };
    let mut spec = Spec::plain(group, what, craft, other, seed);
    spec.tag("craft", if other { "other" } else { "sage" });
    spec
}

/// Number `i` of a group, from a seed of its own.
pub(crate) fn spec(group: &str, i: usize, seed: u64, gain: f64) -> Spec {
    let c = &mut Chance::new(seed, u64::from(group.as_bytes()[0]));
    match group {
        "A" => start(group, "clean", true, seed, c),
        "B" => noisy(i, seed, gain, c),
        "C" => measured(i, seed, gain, c),
        "D" => gusty(i, seed, gain, c),
        "E" => outside(i, seed, gain, c),
        "F" => several(i, seed, gain, c),
        "G" | "S" => single(group, i, seed, gain, c),
        "M" => {
            let (size, mut spec) = (large(c, gain), start(group, "outside", i % 3 == 2, seed, c));
            forms::plant(&mut spec, forms::NEW, i, size, c);
            spec
        }
        "H" | "I" | "J" | "K" | "L" => crate::laboratory::spec(group, i, seed, gain, c),
        other => panic!("no group {other}: A to M, or S"),
    }
}

/// Effects that stand beside something else: spread over the catalogue by the number, turbulence not among them.
pub(crate) fn partner(i: usize) -> &'static str {
    let others: Vec<&str> = FAMILIES.into_iter().filter(|f| *f != "turbulence").collect();
    others[(i * 7 + 3) % others.len()]
}

fn noisy(i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let (mut noise, plain) = (Noise::default(), Noise::default());
    let name = match i / 2 % 12 {
        0 => {
            noise.gain = [c.factor(0.5, 0.8); 7];
            "sigma smaller"
        }
        1 => {
            noise.gain = [c.factor(1.25, 2.0); 7];
            "sigma larger"
        }
        2 => {
            noise.gain = std::array::from_fn(|_| c.factor(0.5, 2.0));
            "sigma by channel"
        }
        3 => {
            noise.ar = c.uniform(0.3, 0.6);
            "AR(1) weak"
        }
        4 => {
            noise.ar = c.uniform(0.8, 0.9);
            "AR(1) strong"
        }
        5 => {
            noise.heavy = true;
            "Student t 3"
        }
        6 => {
            noise.drop = 0.1;
            "rows missing"
        }
        7 => {
            noise.gaps = 2 + c.below(3);
            "gaps"
        }
        8 => {
            noise.quantum = c.uniform(1.0, 2.0);
            "quantised"
        }
        9 => {
            noise.hum = [c.uniform(0.5, 1.5), c.uniform(8.0, 40.0)];
            "hum"
        }
        10 => {
            noise.outliers = c.uniform(0.002, 0.01);
            "outliers"
        }
        _ => {
            noise = Noise { gain: [c.factor(0.8, 1.3); 7], ar: c.uniform(0.3, 0.6), drop: 0.05, outliers: 0.002, ..plain };
            "several"
        }
    };
    let mut spec = start("B", name, i % 4 > 1, seed, c);
    spec.noise = noise;
    spec.tag("noise", name);
    if i % 2 == 1 {
        let size = large(c, gain);
        with_effect(&mut spec, partner(i / 2), size, c);
    }
    spec
}

pub(crate) fn with_effect(spec: &mut Spec, family: &str, size: f64, c: &mut Chance) {
    spec.what.push_str(" + effect");
    spec.tag("effect", family);
    spec.tag("times", size);
    plant(spec, family, size, c);
}

fn measured(i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let mut spec = start("C", "constants", i % 4 > 1, seed, c);
    if i % 2 == 1 {
        // Not what the stated uncertainties already allow.
        let within = ["tether-geometry", "pose-misalignment", "wind-scale", "inertia", "center-of-mass"];
        let family = (i / 2..).map(partner).find(|f| !within.contains(f)).expect("there are others");
        let size = large(c, gain);
        with_effect(&mut spec, family, size, c);
    }
    let (l, d) = (&LABORATORY, &mut spec.declared);
    d.mass *= 1.0 + l.mass * c.normal();
    for j in 0..3 {
        d.inertia[j] *= 1.0 + l.inertia * c.normal();
        d.cm[j] += l.cm * c.normal();
        d.hook[j] += l.hook * c.normal();
        d.ring[j] += l.ring * c.normal();
    }
    for k in [K::MisX, K::MisY, K::MisZ] {
        spec.knobs.set(k, spec.knobs.get(k) + l.angle_deg.to_radians() * c.normal());
    }
    spec.knobs.set(K::Vscale, spec.knobs.get(K::Vscale) + l.wind * c.normal());
    spec.uncertain = true;
    spec
}

fn gusty(i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let colour = Colour::ALL[i / 2 % 4];
    let lengths = [0.15, 0.3, 0.6, 1.2, 2.4];
    let mut spec = start("D", colour.name(), i % 6 > 3, seed, c);
    spec.families.push("turbulence".to_owned());
    let (rms, length) = (c.uniform(0.05, 0.12), lengths[(i / 2 + 2 * (i / 8)) % 5]);
    spec.gusts = Some(Gusts { colour, axial: rms * c.uniform(0.8, 1.0), lateral: rms, length });
    spec.tag("kind", colour.name());
    spec.tag("L", length);
    spec.tag("rms", rms);
    if i % 2 == 1 {
        let size = large(c, gain);
        with_effect(&mut spec, partner(i / 2 + 5), size, c);
    } else {
        spec.tag("effect", "none");
    }
    spec
}

fn outside(i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let size = large(c, gain);
    let count = forms::FORMS.len() + LATER.len();
    let which = i * 5 % count;
    let mut spec = start("E", "outside", i % 3 == 2, seed, c);
    if which < forms::FORMS.len() {
        forms::plant(&mut spec, forms::FORMS, which, size, c);
    } else {
        let name = LATER[which - forms::FORMS.len()];
        plant(&mut spec, name, size, c);
        spec.families = vec!["unexplained".to_owned()];
        spec.tag("form", name);
        spec.tag("size", size);
    }
    spec
}

fn several(i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let many = if i.is_multiple_of(2) { 2 } else { 3 };
    let mut spec = start("F", if many == 2 { "pair" } else { "triple" }, i % 4 > 1, seed, c);
    while spec.families.len() < many {
        let family = FAMILIES[c.below(FAMILIES.len())];
        // Two that the same data hardly tell apart are not asked for together.
        if spec.families.iter().all(|f| f != family && !alike(f, family)) {
            let size = large(c, gain);
            plant(&mut spec, family, size, c);
        }
    }
    let names = spec.families.clone();
    spec.tag("effects", names);
    spec
}

fn alike(a: &str, b: &str) -> bool {
    let sets: [&[&str]; 4] = [
        &["asymmetry", "center-of-mass"],
        &["wind-delay", "pose-delay"],
        &["wind-scale", "axial-speed"],
        &["turbulence", "wake-shedding"],
    ];
    sets.iter().any(|s| s.contains(&a) && s.contains(&b))
}

fn single(group: &str, i: usize, seed: u64, gain: f64, c: &mut Chance) -> Spec {
    let family = FAMILIES[i % FAMILIES.len()];
    let size = large(c, gain);
    let mut spec = start(group, family, i / FAMILIES.len() % 2 == 1, seed, c);
    spec.tag("effect", family);
    spec.tag("times", size);
    plant(&mut spec, family, size, c);
    spec
}
