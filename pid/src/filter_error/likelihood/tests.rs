//! pid tests: the likelihood's score and information by their definitions and by differences.

use super::*;
use crate::filter_error::filter::tests::{NOISE, RANDOM as DRIVE, free, shaken};
use crate::filter_error::point::Sought;
use crate::output_error::PreparedRun;
use crate::output_error::flown::erring;
use windfall_model::{Freedom, Plant, Unknown, UnknownId, Unknowns};

/// The unknowns of `free`, one of them known beforehand.
pub(in super::super) fn unknowns(plant: &Plant) -> Unknowns {
    let c = free(plant);
    let names = &plant.aero.structure.parameters;
    let mut first = vec![true; c.free];
    let one = |(i, value): (usize, &f64)| {
        let freedom = match c.columns[i] {
            None => Freedom::Held(*value),
            Some(k) if std::mem::take(&mut first[k]) => Freedom::Free(k),
            Some(k) => Freedom::Tied(k),
        };
        Unknown::linear(UnknownId::Parameter(i), &names[i], *value, freedom)
    };
    let mut all: Vec<Unknown> = plant.aero.values.iter().enumerate().map(one).collect();
    all.push(Unknown::linear(UnknownId::Nuisance("Ry_bias_rad"), "Ry_bias_rad", 0.0, Freedom::Free(3)));
    let mut all = Unknowns::from(all);
    all.know(1, plant.aero.values[1] + 0.2, 0.1);
    all
}

pub(in super::super) fn point(plant: &Plant) -> SearchPoint {
    let t = DRIVE.turbulence;
    let random =
        [t.axial_rms_m_s, t.lateral_rms_m_s, t.axial_scale_m, t.lateral_scale_m, DRIVE.turning[0], DRIVE.turning[1]].map(f64::ln);
    let sought = Sought { scales: true, turning: true };
    SearchPoint { random, sought, ..SearchPoint::new(unknowns(plant), 0.1) }
}

/// Score and information of the gusts against differences of the likelihood itself: the first exact but for the difference's own half of a
/// thousandth; the parameters' from slopes and innovations; the prior's share by hand.
#[test]
fn exact_score_and_information() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let filters = [Filter::new(&run, NOISE)];
    let (point, mut work) = (point(&plant), Transition::default());
    let found = local(&filters, &point, &mut work).expect("flies");
    let count = free(&plant).free;
    let scales: f64 = (2..4).map(|k| ((point.random[k] - START_SCALE_M.ln()) / SCALE_PRIOR).powi(2)).sum();
    let value = log_likelihood2(&filters, &point, &mut work).expect("flies");
    assert!((found.log_likelihood2 - (value - scales)).abs() < 1e-9 * value.abs());
    let (c, base) = (FreeColumns::of(&point.unknowns), point.random());
    let seen = filters[0].run(&base, &c, &mut work).expect("flies");
    for k in 0..RANDOM {
        // Sizes in the linearisation as it is, scales in the filter anew.
        let mut at = |by: f64| {
            let other = point.varied(k, by);
            if SIZES.contains(&k) {
                return filters[0].again(&other, &seen).log_likelihood2();
            }
            let off = (point.random[k] + by - START_SCALE_M.ln()) / SCALE_PRIOR;
            filters[0].run(&other, &c, &mut work).expect("flies").pass.log_likelihood2() - off * off
        };
        // Half of twice the logarithm; a step of a thousandth to one side instead of to both, with bends of some hundred.
        let slope = 0.5 * (at(5e-4) - at(-5e-4)) / 1e-3;
        let off = (found.score[count + k] - slope).abs();
        assert!(off < 0.05 * slope.abs() + 0.1, "{k}: {} {slope}", found.score[count + k]);
    }
    // By rows.
    let passes: Vec<Pass> = (0..RANDOM)
        .map(|k| {
            let other = point.varied(k, 1e-3);
            if SIZES.contains(&k) {
                filters[0].again(&other, &seen)
            } else {
                filters[0].run(&other, &c, &mut work).expect("flies").pass
            }
        })
        .collect();
    let rows = seen.pass.innovation.len();
    let mut information = DMatrix::<f64>::zeros(count + RANDOM, count + RANDOM);
    let mut score = DVector::<f64>::zeros(count);
    for row in 0..rows {
        let (e, v) = (seen.pass.innovation[row], seen.pass.variance[row]);
        let by = |i: usize| {
            if i < count { seen.by_parameter[row * count + i] } else { (passes[i - count].innovation[row] - e) / 1e-3 }
        };
        let bend = |i: usize| if i < count { 0.0 } else { (passes[i - count].variance[row].ln() - v.ln()) / 1e-3 };
        for i in 0..count + RANDOM {
            (0..count + RANDOM).for_each(|j| information[(i, j)] += by(i) * by(j) / v + 0.5 * bend(i) * bend(j));
        }
        (0..count).for_each(|j| score[j] -= by(j) * e / v);
    }
    information[(1, 1)] += 100.0;
    score[1] += 0.2 / 0.01;
    (2..4).for_each(|k| information[(count + k, count + k)] += 1.0);
    // Logarithms of variances by other ways: 1e-13 over 1e-3.
    assert!((&found.information - &information).amax() < 1e-8 * information.amax());
    assert!((0..count).all(|j| (found.score[j] - score[j]).abs() < 1e-9 * (1.0 + score[j].abs())), "{} {score}", found.score);
    let squares: f64 = (0..rows / CHANNELS).map(|i| seen.pass.innovation[i * CHANNELS + 2].powi(2)).sum();
    assert!((found.left[2] - squares).abs() < 1e-12 && (found.samples - (rows / CHANNELS) as f64).abs() < 1e-12);
    let white = seen.pass.innovation[9] / seen.pass.variance[9].sqrt();
    assert!((found.whitened[0][2][1] - white).abs() < 1e-12);
}

/// What is held has no slope and no say; the inverse is one of every size of unknowns, or names the column that spoils it.
#[test]
fn exact_held_unknowns_and_the_inverse() {
    let plant = erring();
    let record = shaken(&plant);
    let run = PreparedRun::new("shaken", &record, &plant).expect("it can be integrated");
    let still = SearchPoint { sought: Sought::default(), ..point(&plant) };
    let found = local(&[Filter::new(&run, NOISE)], &still, &mut Transition::default()).expect("flies");
    let count = free(&plant).free;
    for k in 2..RANDOM {
        let i = count + k;
        assert!(
            found.score[i] == 0.0 && (found.information[(i, i)] - 1.0).abs() < 1e-15 && found.information[(i, 0)] == 0.0,
            "{k}"
        );
    }
    let m = &found.information;
    let covariance = inverse(m).expect("definite");
    let unit = m * &covariance;
    // Condition 1e4 at unit columns, elements of different size.
    (0..m.nrows()).for_each(|i| assert!((unit[(i, i)] - 1.0).abs() < 1e-8, "{}", unit[(i, i)]));
    let mut spoilt = m.clone();
    spoilt[(3, 3)] = 0.0;
    assert_eq!(inverse(&spoilt), Err(3));
}
