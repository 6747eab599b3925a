//! discover: whether a wrong roll zero explains what a mass effect does. In: what a search found. Out: rivals in words.
//!
//! No record tells where the roll of the body begins: poses with y and z exchanged fly as well as sound ones. What is declared along y
//! and z then stands along other axes, so that a wrong inertia or centre of mass is found. Here the declared constants are turned by quarter
//! turns about the nose and the runs fitted again without that effect.

use windfall_likelihood::{Discovery, Engine, Model};
use windfall_model::frames::{Body, Vec3};
use windfall_model::{Campaign, Inertia, Plant};

/// Families that a wrong roll zero looks like.
const FAMILIES: [&str; 2] = ["inertia", "center-of-mass"];
/// Nats of log marginal likelihood within which one cannot be told from the other: odds of twenty, those of rivals among families. The roll
/// zero has no number of its own, so that the numbers of the effect have to pay for themselves.
const WITHIN: f64 = 2.995_732_273_553_991;
/// Share of the effect's gain from which on a turn explains the same (chosen): damping that is declared over alpha and beta is not quite the
/// same about turned axes, which costs some nats of thousands.
const SAME: f64 = 0.95;
/// Steps of a fit, as many as that of the declared model alone takes.
const STEPS: usize = 12;

/// A quarter turn of the body's axes about x: what was along y is along z, what was along z along -y.
fn quarter(v: Vec3<Body>) -> Vec3<Body> {
    let [x, y, z] = v.to_array();
    Vec3::new(x, -z, y)
}

fn turned_inertia(i: Inertia) -> Inertia {
    Inertia { yy: i.zz, zz: i.yy, xy: -i.xz, xz: i.xy, yz: -i.yz, ..i }
}

/// The plant whose constants stand along axes a number of quarter turns further.
fn turned(plant: &Plant, quarters: usize) -> Plant {
    let mut out = plant.clone();
    for _ in 0..quarters {
        out.vehicle.inertia = turned_inertia(out.vehicle.inertia);
        out.vehicle.p_origin_cm = quarter(out.vehicle.p_origin_cm);
        if let Some(t) = out.tether.as_mut() {
            t.p_origin_hook = quarter(t.p_origin_hook);
        }
    }
    out
}

/// What a number of quarter turns is called.
fn words(quarters: usize) -> String {
    let what = if quarters == 2 { "y and z of the body reversed" } else { "y and z of the body exchanged" };
    format!("{what} (roll zero off by {} deg)", 90 * quarters)
}

/// For a family that was found: the turns of the roll zero that explain what it explains. Turns that change nothing that is declared are
/// none.
pub(super) fn rivals(campaign: &Campaign, engine: &Engine, indices: &[usize], found: &Discovery, family: &str) -> Vec<String> {
    if !FAMILIES.contains(&family) {
        return Vec::new();
    }
    let mut without: Model = found.after.model.clone();
    without.members.retain(|m| m.effect.family != family);
    // Both in an engine made anew from the campaign, whose priors and noise are the same.
    let fitted =
        |campaign: &Campaign, model: &Model, steps: usize| engine.beside(campaign, indices)?.climb(model, true, steps).ok();
    let Some(here) = fitted(campaign, &found.after.model, STEPS) else { return Vec::new() };
    let bare = fitted(campaign, &without, STEPS).map_or(f64::NEG_INFINITY, |fit| fit.total);
    let explains = |total: f64| total + WITHIN > here.total || total - bare > SAME * (here.total - bare);
    let mut seen = vec![campaign.plant.clone()];
    let mut all = Vec::new();
    for quarters in 1..4 {
        let plant = turned(&campaign.plant, quarters);
        if seen.contains(&plant) {
            continue;
        }
        seen.push(plant.clone());
        let other = Campaign { plant, ..campaign.clone() };
        if fitted(&other, &without, STEPS).is_some_and(|fit| explains(fit.total)) {
            all.push(words(quarters));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four quarter turns are none, and two reverse y and z: products with x change sign, that of y and z stays.
    #[test]
    fn exact_quarter_turns_of_the_constants() {
        let inertia = Inertia { xx: 1.0, yy: 2.0, zz: 2.5, xy: 0.1, xz: 0.2, yz: 0.3 };
        let place = Vec3::new(0.1, 0.2, 0.3);
        let moved = |n: usize| (0..n).fold((inertia, place), |(i, v), _| (turned_inertia(i), quarter(v)));
        assert_eq!(moved(1).1.to_array().map(f64::to_bits), [0.1_f64, -0.3, 0.2].map(f64::to_bits));
        assert_eq!(moved(1).0, Inertia { xx: 1.0, yy: 2.5, zz: 2.0, xy: -0.2, xz: 0.1, yz: -0.3 });
        assert_eq!(moved(2).0, Inertia { xy: -0.1, xz: -0.2, ..inertia });
        assert_eq!(moved(4), (inertia, place));
    }
}
