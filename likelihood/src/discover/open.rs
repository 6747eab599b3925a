//! likelihood: effects beside something else. In: everything weighed at a model. Out: sets of effects with what they bring where every load and
//! every instrument may also differ from the model by a smooth function of anything that is known along the runs.
//!
//! Such a difference is a normal process in few functions, its size integrated out (Kennedy and O'Hagan, Bayesian calibration of computer models,
//! J. R. Stat. Soc. B 63, 2001). An effect that is right brings much beside it. One that stands for another form brings little: the process has
//! that form too, or nearly.

use super::contest::{FREEDOM, in_free_accelerations};
use super::weigh::{
    FamilySet, MOST, SOMETHING_ELSE, Weighed, families_of, merged, quadratic_here, random_families, weigh_beside,
};
use super::{Discovery, less_random};
use crate::check::alternatives;
use crate::engine::Engine;
use crate::model::{Id, Model};
use crate::search::{Unit, search};
use std::collections::BTreeMap;

/// Sizes of what else acts, as multiples of its prior's, each as likely.
const SIZES: [f64; 4] = [10.0, 1.0, 0.1, 0.01];

/// Sets of effects with their log marginal likelihoods where something else acts as well, best first: smooth loads and errors of the instruments, beside
/// the fit with each choice of its random inputs, without those that stand for something else, and beside the declared model in accelerations that are
/// left free as far as is likeliest. Each set has [`SOMETHING_ELSE`] in it.
#[must_use]
pub fn beside_something_else(engine: &Engine, found: &Discovery) -> Vec<FamilySet> {
    // All in the nodes of the free accelerations.
    let (all, engine) = (alternatives(engine), &engine.coarse());
    let fits = choices_of_random(engine, found).into_iter().map(|model| (engine.clone(), model));
    let sets = fits.chain(likeliest_freedom(engine)).filter_map(|(engine, model)| {
        beside_alternatives(&weigh_beside(&engine, &model, &all)?, &random_families(&model), price(&engine, &model))
    });
    merged(sets.flatten())
}

/// What a model's random inputs cost beforehand, and accelerations that are left free: along and about each axis by any of the shares, or not.
fn price(engine: &Engine, model: &Model) -> f64 {
    let freedom = if engine.is_free() { 6.0 * (FREEDOM.len() as f64).ln_1p() } else { 0.0 };
    freedom - less_random(0.0, model, engine)
}

/// The model that was found with each choice of its random inputs, fitted again; without those that stand for something else.
fn choices_of_random(engine: &Engine, found: &Discovery) -> Vec<Model> {
    /// Most random inputs of which each choice is tried.
    const MOST_RANDOM: usize = 4;
    let mut model = found.after.model.clone();
    model.members.retain(|m| m.declared || !found.stand_ins.contains(&m.effect.family));
    let random: Vec<usize> =
        (0..model.members.len()).filter(|&k| model.members[k].random && !model.members[k].declared).collect();
    let with = |choice: usize| {
        let is_out = |k: &usize| random.iter().take(MOST_RANDOM).enumerate().any(|(i, other)| other == k && choice >> i & 1 == 1);
        let members = model.members.iter().enumerate().filter(|(k, _)| !is_out(k)).map(|(_, m)| m.clone()).collect();
        engine.climb(&Model { members, ..model.clone() }, false, 4).ok().map(|fit| fit.model)
    };
    (0..1 << random.len().min(MOST_RANDOM)).filter_map(with).collect()
}

/// The declared model in the free accelerations in which it is likeliest, and the engine that leaves them free: first by one share of free flight's
/// for all axes, then of each axis by its own.
fn likeliest_freedom(engine: &Engine) -> Option<(Engine, Model)> {
    /// Rounds over the axes, at most.
    const ROUNDS: usize = 3;
    let (mut free, fits) = in_free_accelerations(engine);
    let (slack, fit) = fits.into_iter().max_by(|a, b| a.1.total.total_cmp(&b.1.total))?;
    free.slack = [slack; 6];
    let likelihood = |free: &Engine| free.sum(&fit.model, &[], &[]).map_or(f64::NEG_INFINITY, |s| s.log_likelihood);
    let mut best = likelihood(&free);
    for _ in 0..ROUNDS {
        let before = best;
        for axis in 0..6 {
            let here = free.slack[axis];
            let mut share = here;
            for there in FREEDOM.into_iter().chain([0.0]).filter(|there| there.to_bits() != here.to_bits()) {
                free.slack[axis] = there;
                let value = likelihood(&free);
                if value > best {
                    (best, share) = (value, there);
                }
            }
            free.slack[axis] = share;
        }
        if best <= before {
            break;
        }
    }
    let model = free.climb(&fit.model, false, 4).map_or(fit.model, |fit| fit.model);
    Some((free, model))
}

/// Sets of effects, with the random inputs that all have, beside all generic alternatives of a weighing together: families, log marginal likelihood less
/// a price, log-likelihood less it. `None` where the runs cannot tell their columns apart at all.
fn beside_alternatives(w: &Weighed, random: &[&'static str], price: f64) -> Option<Vec<(Vec<&'static str>, f64, f64)>> {
    let is_generic = |place: &usize| matches!(w.whole.numbers[*place].id, Id::Generic(_));
    let (generic, own): (Vec<usize>, Vec<usize>) = w.others.iter().copied().partition(is_generic);
    let base: Vec<usize> = w.base.iter().chain(&generic).copied().collect();
    // Places of the effects' columns among what is left.
    let places: BTreeMap<usize, usize> = own.iter().enumerate().map(|(k, place)| (*place, k)).collect();
    let column = |c: &usize| places.get(&w.others[*c]).copied();
    let of_effects = |(u, family): (&Unit, &(usize, Option<usize>))| {
        let columns = u.columns.iter().map(column).collect::<Option<Vec<_>>>()?;
        Some((Unit { columns, ..u.clone() }, *family))
    };
    let (units, families): (Vec<Unit>, Vec<_>) = w.units.iter().zip(&w.families).filter_map(of_effects).unzip();
    let nulls = w.whole.log_likelihood - quadratic_here(&w.whole) - price;
    let mut all = Vec::new();
    for size in SIZES {
        let mut whole = w.whole.clone();
        generic.iter().for_each(|place| whole.numbers[*place].prior *= size);
        let floor = nulls + whole.posterior(&base)?.gain;
        for set in search(&whole.given(&base, &own)?, &units, MOST) {
            all.push((
                families_of(&families, &set).chain(random.iter().copied()).chain([SOMETHING_ELSE]).collect(),
                floor + set.gain,
                floor + set.fit,
            ));
        }
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{in_gusts, number, unit, weighed};
    use super::*;
    use crate::gram::Gram;
    use crate::search::{log_mean, of_any_size};
    use nalgebra::{DMatrix, DVector};

    /// A constant, an effect's strength and a smooth load whose columns are alike to a part: by the marginal likelihood
    /// `½ bᵀS(I + SGS)⁻¹Sb − ½ ln |I + SGS|` of all three together at each size of the load, summed over the sizes, less the effect's cost and the price.
    /// The likelihood is that of the size at which it is largest.
    #[test]
    fn exact_an_effect_beside_a_smooth_load() {
        let g = DMatrix::from_row_slice(3, 3, &[40.0, 3.0, 5.0, 3.0, 90.0, 70.0, 5.0, 70.0, 80.0]);
        let b_here = DVector::from_vec(vec![-3.0, 54.4, 49.0]);
        let b = &b_here + &g * DVector::from_vec(vec![0.2, 0.0, 0.0]);
        let numbers =
            vec![number(Id::Constant(0), 0.2, 0.7), number(Id::Strength(0, 0, 0), 0.0, 1.3), number(Id::Generic(0), 0.0, 0.9)];
        let whole = Gram::new(numbers, g.clone(), b_here, 17.0);
        // At the constant's null: 17 + 3 · 0.2 − 40 · 0.2²/2, less the price.
        let nulls = 17.0 + 0.6 - 0.8 - 1.5;
        // Gain, and mean and variance of the last of the places.
        let by_hand = |places: &[usize], size: f64| {
            let s = |i: usize| [0.7, 1.3, 0.9 * size][places[i]];
            let n = places.len();
            let a = DMatrix::from_fn(n, n, |i, k| f64::from(u8::from(i == k)) + s(i) * g[(places[i], places[k])] * s(k));
            let y = DVector::from_fn(n, |i, _| s(i) * b[places[i]]);
            let inverse = a.clone().try_inverse().expect("definite");
            let (mean, variance) = ((&inverse * &y)[n - 1] * s(n - 1), inverse[(n - 1, n - 1)] * s(n - 1).powi(2));
            (0.5 * y.dot(&(&inverse * &y)) - 0.5 * a.determinant().ln(), mean, variance)
        };
        let units = vec![unit(0, &[0], 2.5), unit(1000, &[1], 4.0)];
        let w = weighed(whole, units, vec![(0, Some(0)), (1000, None)], Vec::new());
        let sets = merged(beside_alternatives(&w, &["turbulence"], 1.5).expect("sets").into_iter());
        let of = |families: &[&str]| {
            let is_it = |s: &&FamilySet| s.families.len() == families.len() && families.iter().all(|f| s.families.contains(f));
            sets.iter().find(is_it).expect("a set")
        };
        let of_sizes = |f: &dyn Fn(f64) -> f64| log_mean(&SIZES.map(f)) + 4.0_f64.ln();
        let alone = of_sizes(&|size| nulls + by_hand(&[0, 2], size).0);
        assert!((of(&["turbulence", SOMETHING_ELSE]).gain - alone).abs() < 1e-9, "{sets:?} {alone}");
        let with = of_sizes(&|size| {
            let (gain, mean, variance) = by_hand(&[0, 2, 1], size);
            nulls + gain - 2.5 + of_any_size(std::iter::once((mean, variance, 1.3)))
        });
        let found = of(&[windfall_model::CATALOGUE[0].family, "turbulence", SOMETHING_ELSE]);
        assert!((found.gain - with).abs() < 1e-9, "{sets:?} {with}");
        // Of the strength alone the runs say exp(mean x/variance − x² (1/variance − 1/1.3²)/2).
        let fit = SIZES.map(|size| {
            let (_, mean, variance) = by_hand(&[0, 2, 1], size);
            nulls + by_hand(&[0, 2], size).0 + mean * mean / variance - 0.5 * mean * mean * (1.0 / variance - 1.0 / 1.69)
        });
        let most = fit.into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert!((found.fit - most).abs() < 1e-9, "{found:?} {most}");
        assert_eq!(sets.len(), 2);
    }

    /// Six axes by eight shares or none: 6 ln 9 beside what gusts cost.
    #[test]
    fn exact_price_of_freedom() {
        let (engine, model) = in_gusts();
        let mut free = engine.clone();
        free.slack[4] = 0.01;
        let held = price(&engine, &model);
        assert!((held + less_random(0.0, &model, &engine)).abs() < 1e-12 && held > 4.0, "{held}");
        let more = price(&free, &model) + less_random(0.0, &model, &free);
        assert!((more - 6.0 * 9.0_f64.ln()).abs() < 1e-12, "{more}");
    }
}
