//! discover tests: scores of sets against integrals of normal densities by dense matrices, and the moves between sets.

use super::*;
use crate::close::tests::{body, campaign};
use windfall_model::effects::find;
use windfall_model::{Acts, Constant, PointRecord};
use windfall_pid::StopReason;

/// Six drops of nine samples each, with errors of 2 mm.
pub(in crate::close::points) fn drops() -> Campaign {
    let drop = |k: usize| {
        let t_s: Vec<f64> = (0..9).map(|i| 0.05 * f64::from(i)).collect();
        let error = |i: usize| 0.003 * ((37 * i * i + 11 * k) as f64).sin();
        let down = t_s.iter().enumerate().map(|(i, t)| 1.3 * t + 4.9 * t * t + error(i)).collect();
        (Vec::new(), PointRecord { t_s, position_m: [Some(down), None, None], ..PointRecord::default() })
    };
    let mut plant = body();
    plant.aero.values = vec![1.7];
    campaign(plant, &[], (0..6).map(drop).collect())
}

pub(in crate::close::points) fn effect(family: &str, values: &[f64]) -> EffectInstance {
    let effect = find(family, Acts::PointMass).expect("in the catalogue");
    EffectInstance { values: values.to_vec(), ..EffectInstance::null(effect, &[]) }
}

/// A set with these numbers of its fit.
pub(in crate::close::points) fn scored(
    families: &[usize],
    effects: Vec<EffectInstance>,
    free: &[Free],
    log_likelihood: f64,
    score: f64,
) -> ScoredSet {
    let n = free.len();
    let covariance = DMatrix::from_fn(n, n, |i, j| if i == j { 0.04 * (i + 1) as f64 } else { 0.01 / (1 + i + j) as f64 });
    let hypothesis = TrackModel {
        declared: vec![1.7],
        priors: Vec::new(),
        constants: Vec::new(),
        effects,
        generic: Vec::new(),
        scatter: None,
    };
    let (free, residual) = (free.to_vec(), vec![0.0; 72]);
    let fit = TrackFit { hypothesis, free, covariance, log_likelihood, residual, stop: StopReason::Converged };
    ScoredSet { families: families.to_vec(), fit, score }
}

/// A contest of drag, a steady push and apparent mass that stands at a set.
pub(in crate::close::points) fn contest<'a>(
    campaign: &'a Campaign,
    settings: &'a Settings,
    declared: ScoredSet,
    best: ScoredSet,
    neighbours: Vec<ScoredSet>,
) -> TrackContest<'a> {
    let families =
        ["drag", "constant-acceleration", "apparent-mass"].map(|f| find(f, Acts::PointMass).expect("in the catalogue"));
    TrackContest {
        campaign,
        settings,
        select: None,
        evidence: TrackEvidence::new(campaign, &[0, 1, 2, 3, 4, 5], &campaign.plant).expect("six tracks"),
        families: families.to_vec(),
        declared,
        singles: Vec::new(),
        best,
        neighbours,
    }
}

/// Two families beside a declared effect, an uncertain constant, a declared parameter and a shape. The integral of a normal
/// likelihood of covariance C about x over a normal prior of covariance P about zero is √(|C|/|C + P|) exp(−½ xᵀ(C + P)⁻¹x); where
/// the prior is in C already, P is none. Box's factor of six runs and three numbers of effects more than one is 2.5/6. To rounding of two
/// factorisations.
#[test]
fn exact_score_of_two_families() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let mut push = effect("constant-acceleration", &[1.7, 0.6, 0.0]);
    push.parameters[1].role = Role::Shape(&[0.5, 1.5]);
    let effects = vec![effect("length-scale", &[0.02]), effect("drag", &[0.31]), push];
    let free =
        [Free::Declared(0), Free::Constant(0), Free::Effect(0, 0), Free::Effect(1, 0), Free::Effect(2, 0), Free::Effect(2, 1)];
    let mut set = scored(&[0, 1], effects, &free, -31.0, 0.0);
    let mass = Constant { key: "mass", component: "", unit: "kg", lens: |p| Some(&mut p.vehicle.mass_kg), std: 0.2 };
    set.fit.hypothesis.constants = vec![(mass, 0.1)];
    assert_eq!((set.place(0), set.place(1)), (1, 2));
    let found = contest(&c, &settings, scored(&[], Vec::new(), &free[..1], -43.0, 0.0), set.clone(), Vec::new());
    let covariance = &set.fit.covariance;
    let x = DVector::from_column_slice(&[0.0, 0.0, 0.02, 0.31, 1.7, 0.6]);
    let marginal = |first: f64, second: f64| {
        let widths = [30.0 * 1.7, 0.0, first * 0.1, first * 3.0, second * 3.0, 0.5 * 0.6];
        let both = covariance + DMatrix::from_diagonal(&DVector::from_column_slice(&widths).map(|w| w * w));
        let inverse = both.clone().try_inverse().expect("positive definite");
        (covariance.determinant() / both.determinant()).sqrt() * (-0.5 * x.dot(&(inverse * &x))).exp()
    };
    let widths = [0.3, 0.1, 0.03, 0.01];
    let mean = widths.iter().flat_map(|a| widths.iter().map(move |b| (a, b))).map(|(a, b)| marginal(*a, *b)).sum::<f64>() / 16.0;
    let expected = 2.5 / 6.0 * 12.0 + mean.ln() - 2.0 * 3.0_f64.ln();
    let score = found.score(&set.fit, 2);
    assert!((score - expected).abs() < 1e-9 * expected.abs(), "{score} {expected}");
    // Runs kept for choosing add their log predictive density.
    let kept = TrackEvidence::new(&c, &[1, 4], &c.plant).expect("two tracks");
    let added = problem(&c, &kept).predictive(&set.fit);
    let both = TrackContest { select: Some(&kept), ..found }.score(&set.fit, 2);
    assert!(
        added > UNFLOWN && added.abs() > 1.0 && (both - expected - added).abs() < 1e-9 * both.abs(),
        "{both} {expected} {added}"
    );
}

/// One family more, less or other, and no two.
#[test]
fn law_sets_next_to_each_other() {
    let at = [1, 2];
    for (set, next) in [
        (vec![1, 2], true),
        (vec![1, 2, 3], true),
        (vec![1], true),
        (vec![2, 3], true),
        (vec![3], false),
        (vec![3, 4], false),
        (vec![1, 3, 4], false),
        (vec![1, 2, 3, 4], false),
    ] {
        assert_eq!(is_next_to(&set, &at), next, "{set:?}");
    }
    assert!(is_next_to(&[5], &[]) && !is_next_to(&[5, 6], &[]));
}

/// A larger set stays, and is taken, where it beats a smaller one by more than one; another as large by more than a hundredth.
#[test]
fn law_a_family_must_be_worth_more_than_one() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let set = |families: &[usize], score: f64, left: f64| {
        let mut s = scored(families, Vec::new(), &[], 0.0, score);
        s.fit.residual = vec![left; 72];
        s
    };
    let moved = |smaller: f64, other: Vec<ScoredSet>| {
        let found = contest(&c, &settings, set(&[], smaller, 0.3), set(&[0], 10.0, 0.2), other);
        found.next().map(|s| s.families)
    };
    assert_eq!(moved(9.05, Vec::new()), Some(Vec::new()));
    assert_eq!(moved(8.95, Vec::new()), None);
    for (families, beyond) in [(vec![0, 1], 1.0), (vec![1], 0.01)] {
        assert_eq!(moved(2.0, vec![set(&families, 10.0 + 0.95 * beyond, 0.1)]), None, "{families:?}");
        assert_eq!(moved(2.0, vec![set(&families, 10.0 + 1.05 * beyond, 0.1)]), Some(families));
    }
}

/// Of specific forces drag starts at a quarter of what a body can have, 2; a push, which may have either sign, at nothing.
#[test]
fn exact_start_of_a_fit_to_forces() {
    let c = drops();
    let settings = Settings::of(&c, &[]);
    let none = scored(&[], Vec::new(), &[], 0.0, 0.0);
    let mut forces = c.clone();
    if let windfall_model::Data::Point(record) = &mut forces.runs[0].data {
        record.measured = Measured::SpecificForce;
    }
    let mut found = contest(&c, &settings, none.clone(), none, Vec::new());
    assert_eq!(found.started(found.families[0]).values, [0.0]);
    found.campaign = &forces;
    assert_eq!(found.started(found.families[0]).values, [0.75]);
    assert_eq!(found.started(found.families[1]).values, [0.0; 3]);
}

/// A push of 1 m/s² that all drops share is found to four standard errors of 0.05; one of 6, more than any body can have, explains
/// nothing.
#[test]
fn law_a_strength_beyond_any_body_explains_nothing() {
    for (push, found_it) in [(1.0, true), (6.0, false)] {
        let mut c = drops();
        c.declared = vec![false];
        for run in &mut c.runs {
            let windfall_model::Data::Point(record) = &mut run.data else { panic!("a track") };
            let down = record.position_m[0].as_mut().expect("measured");
            down.iter_mut().zip(&record.t_s).for_each(|(x, t)| *x += 0.5 * push * t * t);
        }
        let settings = Settings::of(&c, &[]);
        let none = scored(&[], Vec::new(), &[], 0.0, 0.0);
        let mut near = none.fit.hypothesis.clone();
        let found = contest(&c, &settings, none.clone(), none, Vec::new());
        near.generic = vec![0.0; found.evidence.components()];
        let set = found.fitted(&[1], &near);
        assert_eq!(set.is_some(), found_it, "{push}");
        assert!(set.is_none_or(|s| (s.fit.hypothesis.effects[0].values[0] - push).abs() < 0.2));
    }
}
