//! likelihood tests: sets that cannot be told apart, by numbers each with its closed form; odds of two fits.

use super::super::tests::{alone_by_hand, apart, bare, in_gusts, number, set, unit, weighed};
use super::*;

/// Two strengths apart, and runs that tell more of the first: the true one gains half of what its mean square is of the new deviation, and both
/// pay for their priors. What was not found is held by the data, not by its prior.
#[test]
fn exact_odds_with_more_runs() {
    let (engine, _) = in_gusts();
    let numbers = vec![number(Id::Constant(0), 0.0, 0.7), number(Id::Generic(0), 0.0, 0.02), number(Id::Generic(1), 0.0, 1.3)];
    let whole = apart(numbers, &[11.0, 0.004, 60.0], &[-2.0, 0.03, 33.0], 0.0);
    let costs = [2.0, 3.5];
    let information = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 700.0, 5.0]));
    // With the first true the second has none of its own and the other way round; beside it what the campaign's runs say stays.
    let with = |truth: usize| {
        let mean = alone_by_hand(&whole, truth)[0];
        let mut more = whole.clone();
        more.g += &information;
        more.b_here[truth] += information[(truth, truth)] * mean;
        alone_by_hand(&more, 1)[2] - costs[0] - alone_by_hand(&more, 2)[2] + costs[1]
    };
    let expected = [with(1), -with(2)];
    let units = vec![unit(0, &[0], costs[0]), unit(1, &[1], costs[1])];
    let of = |u: usize, gain: f64, fit: f64| Set { fit, ..set(&[u], gain) };
    // The third is far behind in both ways, the fourth in one of them only.
    let sets = vec![of(0, 10.0, 12.0), of(1, 9.0, 20.0), of(1, 3.0, 25.0), of(0, 2.0, 12.5)];
    let w = weighed(whole.clone(), units, vec![(0, None), (1, None)], sets);
    let families = vec![vec![], vec!["b"], vec!["c"], vec!["d"]];
    let model = bare();
    let rivals = Rivals { engine: &engine, model: &model, weighed: w, families };
    let pairs = rivals.pairs(2.0_f64.exp());
    let expected_pairs = [(1, 1.0), (3, 8.0)].map(|(rival, log_odds)| RivalPair { best: 0, rival, log_odds });
    assert_eq!(pairs, expected_pairs);
    let found = rivals.expected(pairs[0], &information).expect("odds");
    assert!(found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9), "{found:?} {expected:?}");
    for (information, own) in [(None, 0.004), (Some(&information), 700.004)] {
        let std = rivals.error(1, information).expect("an error");
        let expected = (own + 1.0 / (1e3_f64 * 0.02).powi(2)).sqrt().recip();
        assert!((std / expected - 1.0).abs() < 1e-9, "{std} {expected}");
    }
}

/// Log odds of a model over another are those of the other over it with the other sign, and the difference of their scores.
#[test]
fn law_odds_of_two_fits() {
    let (engine, model) = in_gusts();
    let calm = model.clone().calm();
    let odds = log_odds(&engine, &model, &calm).expect("odds");
    let scores = [&model, &calm].map(|m| score(&engine, &engine.climb(m, true, 8).expect("a fit")));
    assert!(odds > 0.0 && (odds - (scores[0] - scores[1])).abs() < 1e-6, "{odds} {scores:?}");
}
