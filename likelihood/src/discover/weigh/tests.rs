//! likelihood tests: what a weighing is made of, by numbers that the runs tell apart, each with its closed form.

use super::super::tests::{alone_by_hand, apart, bare, in_gusts, member, number, set, unit, weighed};
use super::*;

/// Six generic groups, one of two columns, beside a constant: the best set has five of them, one more than of effects, each at the odds against any
/// family and against its fellows; the whole is the likelihood of nulls with all gains.
#[test]
fn exact_weighing_of_generic_groups() {
    let (engine, _) = in_gusts();
    let group = [0, 1, 1, 2, 3, 4, 5];
    let mut numbers = vec![number(Id::Constant(0), 0.3, 0.7)];
    numbers.extend((0..group.len()).map(|i| number(Id::Generic(i), 0.05 * i as f64 - 0.1, 1.3)));
    let g = [11.0, 90.0, 80.0, 70.0, 95.0, 75.0, 85.0, 60.0];
    let b_here = [-2.0, 50.0, 40.0, -60.0, 55.0, -57.0, 70.0, 30.0];
    let gram = apart(numbers, &g, &b_here, 1234.5);
    let empty: f64 =
        1234.5 - gram.numbers.iter().enumerate().map(|(i, n)| n.value * (b_here[i] + 0.5 * g[i] * n.value)).sum::<f64>();
    let cost = (3.0 * crate::model::catalogue().count() as f64).ln() + 6.0_f64.ln();
    let mut gains = [-cost; 6];
    group.iter().enumerate().for_each(|(i, &k)| gains[k] += alone_by_hand(&gram, i + 1)[2]);
    gains.sort_by(|a, b| b.total_cmp(a));
    assert!(gains[5] > 0.0);
    let of_five: f64 = gains[..5].iter().sum();
    let of_constant = alone_by_hand(&gram, 0)[2];
    let w = outcome(&engine, &bare(), gram, 6, &group).expect("weighed");
    assert_eq!(w.sets[0].units.len(), 5);
    assert!((w.sets[0].gain - of_five).abs() < 1e-9, "{} {of_five}", w.sets[0].gain);
    assert!((w.total - (empty + of_constant + of_five)).abs() < 1e-9, "{} {empty} {of_constant} {of_five}", w.total);
    let groups: Vec<(usize, Vec<usize>)> = w.units.iter().map(|u| (u.group, u.columns.clone())).collect();
    let expected =
        [vec![0], vec![1, 2], vec![3], vec![4], vec![5], vec![6]].into_iter().enumerate().map(|(k, c)| (GENERIC + k, c));
    assert_eq!(groups, expected.collect::<Vec<_>>());
    assert_eq!(w.families, (0..6).map(|k| (GENERIC + k, None)).collect::<Vec<_>>());
}

/// The smallest set within twenty to one of the best; a constant that every set has moves to its posterior mean with it.
#[test]
fn exact_choice_and_its_constants() {
    let (engine, _) = in_gusts();
    let whole =
        apart(vec![number(Id::Constant(0), 0.3, 0.7), number(Id::Strength(0, 0, 0), 0.0, 1.0)], &[3.0, 5.0], &[1.1, 0.4], 0.0);
    let mean = alone_by_hand(&whole, 0)[0];
    let w = weighed(whole, vec![unit(0, &[0], 1.0)], vec![(0, Some(0))], vec![set(&[0, 0], 10.0), set(&[0], 8.0), set(&[], 1.0)]);
    assert_eq!(w.choice().units.len(), 1);
    let next = with_set(&bare(), &w, &w.sets[2], &engine);
    assert!((next.constants[0] - mean).abs() < 1e-12, "{} {mean}", next.constants[0]);
}

/// Sets of one family in several forms are one of their likelihoods together, beside the random members that all have.
#[test]
fn exact_sum_over_forms() {
    let (engine, model) = in_gusts();
    let place = place_of(member(&engine, "damping-shape").effect).expect("an effect of the catalogue");
    let whole = apart(vec![number(Id::Constant(0), 0.0, 1.0), number(Id::Generic(0), 0.0, 1.0)], &[1.0; 2], &[0.0; 2], 0.0);
    let sets = vec![set(&[0], 3.1), set(&[], 2.8), set(&[1], 2.4)];
    let w = weighed(whole, vec![unit(place, &[0], 0.0), unit(place, &[0], 0.0)], vec![(place, Some(0)), (place, Some(1))], sets);
    let found = named(&w, &model);
    assert_eq!(found.len(), 2);
    assert_eq!(found[0].families, ["damping-shape", "turbulence"]);
    assert!(
        (found[0].gain - (3.1_f64.exp() + 2.4_f64.exp()).ln()).abs() < 1e-12 && (found[1].gain - 2.8).abs() < 1e-12,
        "{found:?}"
    );
}

/// Sets with a family that other runs speak against fall by so much, gain and fit, and are sorted anew; those that they contradict are gone.
#[test]
fn exact_sets_that_other_runs_speak_against() {
    let (engine, _) = in_gusts();
    let places = ["damping-shape", "swirl"].map(|f| place_of(member(&engine, f).effect).expect("an effect of the catalogue"));
    let whole = apart(vec![number(Id::Constant(0), 0.0, 1.0), number(Id::Generic(0), 0.0, 1.0)], &[1.0; 2], &[0.0; 2], 0.0);
    let sets = vec![set(&[0, 1], 9.0), set(&[0], 7.5), set(&[1], 6.0), set(&[], 0.0)];
    let mut w = weighed(whole, places.map(|p| unit(p, &[0], 0.0)).to_vec(), places.map(|p| (p, None)).to_vec(), sets);
    w.lessen("damping-shape", 2.5);
    let found: Vec<_> = w.sets.iter().map(|s| (s.units.as_slice(), s.gain, s.fit)).collect();
    assert_eq!(found, [(&[0, 1][..], 6.5, -2.5), (&[1], 6.0, 0.0), (&[0], 5.0, -2.5), (&[], 0.0, 0.0)]);
    w.leave_out(&["damping-shape"]);
    assert_eq!(w.sets.iter().map(|s| s.units.as_slice()).collect::<Vec<_>>(), [&[1][..], &[]]);
}
