//! likelihood tests: sizes of random inputs, pulses, and what is worth a fit.

use super::super::tests::{apart, in_gusts, member, number, set, unit, weighed};
use super::*;
use crate::model::Id;

/// A twentieth of the largest plausible, which is 2 m/s, is that share of it again.
#[test]
fn exact_size_as_a_share() {
    let (engine, mut model) = in_gusts();
    let null = member(&engine, "turbulence");
    let gusts = sized(&null, 0.05, &[9.0, 9.0, 0.2, 1.8, 1.5]);
    assert!(gusts.values.iter().zip([0.1, 0.1, 0.2, 1.8, 1.5]).all(|(v, e)| (v - e).abs() < 1e-15), "{:?}", gusts.values);
    model.members = vec![gusts];
    assert!((size_of(&model) - 0.05).abs() < 1e-15);
}

/// A pulse of which a half is over at an instant starts that much before it, also before the run.
#[test]
fn exact_start_of_a_pulse() {
    assert!((start_s(1.7, 0.5, 0.4) - 1.5).abs() < 1e-15 && (start_s(0.1, 0.5, 0.4) + 0.1).abs() < 1e-15);
    assert!(brings_nothing(9.95, 10.0) && !brings_nothing(9.8, 10.0) && !brings_nothing(10.05, 10.0));
}

/// Of a thousand kicks with an exponential law, 1000 e⁻ᵍ bring g: with 9 nats one of eight, with 12 less than one of twenty.
#[test]
fn exact_kicks_of_a_tail() {
    let all: Vec<Shock> = (0..1000).map(|i| Shock { t_s: 0.0, gain: -((f64::from(i) + 0.5) / 1000.0).ln() }).collect();
    assert!(is_of_the_tail([11.0, 20.0], &all) && !is_of_the_tail([11.0, 23.0], &all));
}

/// Of one effect more than the model has, its random members not counted.
#[test]
fn exact_sets_of_one_more() {
    let (engine, mut model) = in_gusts();
    model.members.push(member(&engine, "damping-shape"));
    let whole = apart(vec![number(Id::Constant(0), 0.0, 1.0), number(Id::Generic(0), 0.0, 1.0)], &[1.0; 2], &[0.0; 2], 0.0);
    let sets = vec![set(&[0], 9.0), set(&[0, 1], 7.0), set(&[], 5.0), set(&[0, 1, 2], 4.0), set(&[1, 2], 3.0)];
    let w = weighed(whole, vec![unit(0, &[0], 0.0)], vec![(0, None)], sets);
    let found: Vec<&[usize]> = one_larger(&w, &model).map(|s| s.units.as_slice()).collect();
    assert_eq!(found, [[0, 1], [1, 2]]);
}
