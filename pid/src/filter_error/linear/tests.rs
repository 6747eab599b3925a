//! pid tests: a run as a regression, against the likelihood's own score and information.

use super::*;
use crate::filter_error::filter::tests::{NOISE, RANDOM as DRIVE, shaken};
use crate::filter_error::likelihood::local;
use crate::filter_error::likelihood::tests::point;
use crate::filter_error::point::SearchPoint;
use crate::output_error::flown::erring;
use windfall_model::{Freedom, Unknown, UnknownId, Unknowns};

/// With θ the point's parameters: XᵀX is their information, Xᵀ(y − Xθ) their score, and what is left at θ, squared, is the
/// likelihood less its logarithms; to roundings of sums over 189 rows.
#[test]
fn exact_regression_has_the_score_and_information_of_the_likelihood() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let filters = [Filter::new(&run, NOISE)];
    let (values, names) = (&plant.aero.values, &plant.aero.structure.parameters);
    let one = |(i, v): (usize, &f64)| Unknown::linear(UnknownId::Parameter(i), &names[i], *v, Freedom::Free(i));
    let unknowns = Unknowns::from(values.iter().enumerate().map(one).collect::<Vec<_>>());
    let mut work = Transition::default();
    let seen = filters[0].run(&DRIVE, &FreeColumns::of(&unknowns), &mut work).expect("flies");
    let (x, y) = regression(&seen, values);
    let left = &y - &x * DVector::from_column_slice(values);
    let found = local(&filters, &SearchPoint { unknowns, ..point(&plant) }, &mut work).expect("flies");
    let free = values.len();
    let (information, score) = (x.transpose() * &x, x.transpose() * &left);
    for i in 0..free {
        let scale = information[(i, i)].sqrt();
        assert!((score[i] - found.score[i]).abs() < 1e-9 * scale * left.norm(), "{i}: {} {}", score[i], found.score[i]);
        for j in 0..free {
            let off = (information[(i, j)] - found.information[(i, j)]).abs();
            assert!(off < 1e-9 * scale * information[(j, j)].sqrt(), "{i} {j}: {off}");
        }
    }
    let logarithms: f64 = seen.pass.variance.iter().map(|v| v.ln()).sum();
    let expected = -seen.pass.log_likelihood2() - logarithms;
    assert!((left.norm_squared() / expected - 1.0).abs() < 1e-9, "{} {expected}", left.norm_squared());
}
