//! likelihood tests: what scores are made of, bounds by halving, gains; and what the tests of the search have in common.

use super::*;
use crate::flown::{flown, flown_by};
use crate::model::Number;
use crate::search::Set;
use nalgebra::Cholesky;
use std::sync::OnceLock;
use windfall_model::{CATALOGUE, CHANNELS};
use windfall_pid::StopReason;

/// Two seconds of SAGE in gusts of 0.1 m/s, with work counted from nothing; and the declared model with those gusts.
pub(super) fn in_gusts() -> (Engine, Model) {
    static FLOWN: OnceLock<(Engine, Model)> = OnceLock::new();
    let (mut engine, model) = FLOWN.get_or_init(|| flown(2.0, "turbulence", &[0.1, 0.1, 0.6, 0.6, 0.0])).clone();
    engine.count_anew();
    (engine, model)
}

pub(super) fn member(engine: &Engine, family: &str) -> Member {
    let effect = CATALOGUE.iter().find(|e| e.family == family).expect("an effect of the catalogue");
    Member::null(effect, &engine.campaign)
}

pub(super) fn number(id: Id, value: f64, prior: f64) -> Number {
    Number { id, value, prior, range: [f64::NEG_INFINITY, f64::INFINITY], at_end: [false; 2], step: 1.0 }
}

/// A fit of those numbers at a marginal likelihood and a likelihood.
pub(super) fn fit(model: Model, numbers: Vec<Number>, covariance: DMatrix<f64>, [total, log_likelihood]: [f64; 2]) -> Fit {
    let (channels, stop) = ([[1.0; 4]; CHANNELS], StopReason::Converged);
    Fit { model, numbers, covariance, total, log_likelihood, chi: 1.0, channels, stop }
}

/// A model of one constant.
pub(super) fn bare() -> Model {
    Model { declared: Vec::new(), constants: vec![0.3], members: Vec::new() }
}

/// Everything weighed by a whole of which the first number is in every set.
pub(super) fn weighed(whole: Gram, units: Vec<Unit>, families: Vec<(usize, Option<usize>)>, sets: Vec<Set>) -> Weighed {
    let (base, others) = (vec![0], (1..whole.numbers.len()).collect::<Vec<_>>());
    let gram = whole.given(&base, &others).expect("definite");
    Weighed { gram, whole, base, others, units, families, sets, total: 0.0 }
}

pub(super) fn unit(group: usize, columns: &[usize], cost: f64) -> Unit {
    Unit { group, columns: columns.to_vec(), cost }
}

/// A set of units with a column each, of the same place.
pub(super) fn set(units: &[usize], gain: f64) -> Set {
    Set { units: units.to_vec(), gain, fit: 0.0, columns: units.to_vec(), estimates: vec![0.0; units.len()] }
}

/// A normal equation for each number by itself.
pub(super) fn apart(numbers: Vec<Number>, g: &[f64], b_here: &[f64], log_likelihood: f64) -> Gram {
    Gram::new(numbers, DMatrix::from_diagonal(&DVector::from_column_slice(g)), DVector::from_column_slice(b_here), log_likelihood)
}

/// Posterior mean, variance and gain of such a number: of the density N(0, s²) times exp(b x − g x²/2).
pub(super) fn alone_by_hand(gram: &Gram, i: usize) -> [f64; 3] {
    let (g, s) = (gram.g[(i, i)], gram.numbers[i].prior);
    let b = gram.b_here[i] + g * gram.numbers[i].value;
    let variance = 1.0 / (g + 1.0 / (s * s));
    [variance * b, variance, 0.5 * b * b * variance + 0.5 * (variance / (s * s)).ln()]
}

/// The cost of a pulse: one of thrice the catalogue's families, of two durations, at any instant of the run. What is sure is twenty to one above it.
#[test]
fn exact_cost_of_a_pulse_and_of_gusts() {
    let (engine, model) = in_gusts();
    let family = (3.0 * catalogue().count() as f64).ln();
    let pulse = member(&engine, "contact");
    let expected = family + 2.0_f64.ln() + (engine.instants() as f64).ln();
    assert!((cost(&pulse, &engine) - expected).abs() < 1e-12 && (sure_cost(&pulse, &engine) - expected - 3.0).abs() < 1e-12);
    assert!((less_random_cost(7.3, &model, &engine) - (7.3 - family)).abs() < 1e-12);
    let price = engine.random_price(&model);
    assert!(price > 1.0 && (less_random(7.3, &model, &engine) - (7.3 - family - price)).abs() < 1e-12);
    // With an effect of one strength, which the runs know to a tenth of its prior, beside the gusts.
    let mut both = model;
    both.members.push(member(&engine, "damping-shape"));
    let place = both.members.len() - 1;
    let fitted = fit(both.clone(), vec![number(Id::Member(place, 0), 4.0, 10.0)], DMatrix::from_element(1, 1, 1.0), [12.3, 0.0]);
    let size = of_any_size(std::iter::once((4.0, 1.0, 10.0)));
    let expected = 12.3 + size - family - (family + 5.0_f64.ln()) - engine.random_price(&both);
    assert!(size.abs() > 0.1 && (score(&engine, &fitted) - expected).abs() < 1e-9, "{} {expected}", score(&engine, &fitted));
}

/// Halved seven times, five decades are known to their 128th part; where all falls, the bound is that above the low end.
#[test]
fn exact_bound_by_halving() {
    let part = 1e5_f64.powf(1.0 / 128.0);
    let found = bound(2000.0, |size| size > 37.0);
    assert!(found >= 37.0 && found <= 37.0 * part, "{found}");
    assert!((bound(2000.0, |_| true) / (0.02 * part) - 1.0).abs() < 1e-12);
}

/// What is not known along a ridge widens a covariance as an independent number along it does.
#[test]
fn exact_covariance_along_ridges() {
    let ridges = [DVector::from_vec(vec![0.3, -0.7]), DVector::from_vec(vec![0.2, 0.5])];
    let found = along(DMatrix::from_row_slice(2, 2, &[2.0, 0.1, 0.1, 3.0]), &ridges);
    let expected = [2.0 + 0.09 + 0.04, 0.1 - 0.21 + 0.1, 0.1 - 0.21 + 0.1, 3.0 + 0.49 + 0.25];
    assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-14), "{found}");
    assert!(Cholesky::new(found).is_some());
}

/// Gusts that were flown bring the difference of two likelihoods.
#[test]
fn recover_gain_of_gusts() {
    let (engine, model) = in_gusts();
    let with = engine.climb(&model, false, 3).expect("a fit");
    let without = engine.climb(&with.model.clone().calm(), false, 3).expect("a fit");
    let (found, expected) = (gains(&engine, &with), with.log_likelihood - without.log_likelihood);
    assert!(found.len() == 1 && found[0].0 == 0 && expected > 5.0, "{found:?} {expected}");
    assert!((found[0].1 / expected - 1.0).abs() < 1e-9, "{found:?} {expected}");
    assert_eq!(more(12.34, 5.0), "7.3");
}

/// A short closing: a centre of mass a millimetre off to one side is named and lies within four of its stated errors, the declared model alone is far less
/// likely, and the likelihood stated is that of a pass at what is stated.
#[test]
fn recover_a_centre_of_mass() {
    let (mut engine, truth) = flown(2.0, "center-of-mass", &[0.0, 1e-3, 0.0]);
    let found = discover(&mut engine).expect("a set");
    assert_eq!(found.after.model.found(), ["center-of-mass"], "{:#?}", found.log);
    let place = found.after.numbers.iter().position(|n| n.id == Id::Member(0, 1)).expect("the strength");
    let std = found.after.covariance[(place, place)].sqrt();
    let off = found.after.model.members[0].values[1] - truth.members[0].values[1];
    assert!(off.abs() < 4.0 * std && std < 2e-4, "{off} {std}");
    let anew = engine.sum(&found.after.model, &[], &[]).expect("a pass").log_likelihood;
    assert!((found.after.log_likelihood - anew).abs() < 1e-6, "{} {anew}", found.after.log_likelihood);
    let before = found.before.expect("the declared model's fit");
    assert!(found.after.log_likelihood > before.log_likelihood + 20.0 && found.contest.is_none_or(|c| c.leads.is_empty()));
}

/// A run kept for choosing, hardly a second, beside a centre of mass a hundredth of a millimetre off that a longer one shows: it stays where it is off
/// in that run too, though by chance that is likelier without it, by three nats at most; where it is not the run contradicts it, and it goes though both
/// together are likelier with it. What both do not speak for goes, whichever way the run says.
#[test]
fn law_runs_that_choose() {
    let chosen = |off_m: f64, others_m: f64, duration_s: f64| {
        let (truth, others) = ([0.0, off_m, 0.0], [0.0, others_m, 0.0]);
        let flights = [(Use::Identify, 4.0, &truth[..]), (Use::Select, duration_s, &others[..])];
        let (engine, model) = flown_by("center-of-mass", &flights);
        let fit = engine.climb(&model, true, 12).expect("a fit");
        let alone = engine.climb(&Model { members: Vec::new(), ..fit.model.clone() }, true, 12).expect("a fit");
        let by = predicted(&engine, &fit) - predicted(&engine, &alone);
        let ahead = score(&engine, &fit) - score(&engine, &alone);
        let weighed = weigh::weigh(&engine, &fit.model).expect("weighed");
        let (after, weighed) = selected(&engine, fit, weighed, &mut Vec::new());
        // Of what is gone, the list of sets says the same.
        let all = named(&weighed, &after.model);
        let with = all.iter().find(|s| s.families == ["center-of-mass"]).map(|s| s.gain);
        if after.model.found().is_empty() {
            let own = named(&weigh::weigh(&engine, &after.model).expect("weighed"), &after.model);
            let own = own.iter().find(|s| s.families == ["center-of-mass"]).expect("a set").gain;
            match with {
                Some(gain) => assert!((gain - own - by).abs() < 0.05 && by > -10.0 && gain < 3.0, "{gain} {own} {by}"),
                None => assert!(by < -10.0, "{by}"),
            }
        }
        (by, ahead, after.model.found())
    };
    for duration_s in [0.5, 1.1, 1.3] {
        let (by, ahead, left) = chosen(1e-5, 1e-5, duration_s);
        assert!((-4.0..3.0).contains(&by) && ahead > 20.0 && left == ["center-of-mass"], "{duration_s}: {by} {ahead} {left:?}");
    }
    // Nor does a run that speaks for it by more than the other.
    let (by, ahead, left) = chosen(1e-5, 1e-5, 6.0);
    assert!(by > ahead + 3.0 && ahead > 20.0 && left == ["center-of-mass"], "{by} {ahead} {left:?}");
    let (by, ahead, left) = chosen(5e-5, 0.0, 3.0);
    assert!(by < -100.0 && ahead + by > 100.0 && left.is_empty(), "{by} {ahead} {left:?}");
    let (by, ahead, left) = chosen(0.0, 0.0, 1.0);
    assert!(by.abs() < 3.0 && ahead < 0.0 && left.is_empty(), "{by} {ahead} {left:?}");
}

/// Where no set of effects keeps a model near its runs, the declared one is followed with the least freedom of its accelerations that does, and
/// nothing is named; the words say where it departs, or that no set does.
#[test]
fn law_what_nothing_follows_is_followed_freely() {
    let (mut engine, model) = in_gusts();
    let declared = model.calm();
    let ((_, fit, _), words) = followed_freely(&mut engine, &declared, &mut Vec::new()).expect("a model that flies");
    assert!(engine.slack[0] > 0.0 && fit.model.members.is_empty() && fit.chi.is_finite());
    assert_eq!(words, "no set of effects keeps the model near its runs");
}

/// At odds of three to one something else has three quarters, and stands before sets that share the rest; without a contest it is not among them.
#[test]
fn exact_something_else_among_sets() {
    let set = |families: &[&'static str], gain: f64| FamilySet { families: families.to_vec(), gain, fit: 0.0 };
    let sets = [set(&["magnus"], 7.0 + 0.6_f64.ln()), set(&[], 7.0 + 0.4_f64.ln())];
    let all = and_something_else(&sets, Some(3.0_f64.ln()));
    assert_eq!(all[0].families, [SOMETHING_ELSE]);
    assert!((all[0].gain - (7.0 + 3.0_f64.ln())).abs() < 1e-12 && all[1..] == sets, "{all:?}");
    assert_eq!(and_something_else(&sets, None), sets);
}
