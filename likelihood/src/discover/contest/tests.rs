//! likelihood tests: a contest of numbers that the runs tell apart, and what stands for something else.

use super::super::tests::{alone_by_hand, apart, bare, fit, in_gusts, number, set, unit, weighed};
use super::*;
use crate::columns::{Basis, Site};
use crate::flown::flown;
use nalgebra::DMatrix;

/// A member beside three alternatives: a lead brings what its number does by itself, less its cost; one nearly as strong is its rival, a weak one is not.
#[test]
fn exact_leads_and_rivals() {
    let mut numbers = vec![number(Id::Constant(0), 0.2, 0.7)];
    numbers.extend((0..4).map(|i| number(Id::Generic(i), 0.0, 1.3)));
    let whole = apart(numbers, &[11.0, 50.0, 90.0, 70.0, 60.0], &[-2.0, 30.0, 60.0, -52.0, 33.0], 0.0);
    let costs = [3.0, 5.0, 5.5, 4.5];
    let by_hand: Vec<[f64; 3]> = (1..5).map(|i| alone_by_hand(&whole, i)).collect();
    let gain = |i: usize| by_hand[i][2] - costs[i];
    assert!(gain(1) > gain(2) && gain(1) - gain(2) < SURE && gain(1) - gain(3) > SURE);
    let units = costs.iter().enumerate().map(|(i, c)| unit(i, &[i], *c)).collect();
    let families = vec![(0, None), (GENERIC, None), (GENERIC + 1, None), (GENERIC + 2, None)];
    let mut w = weighed(whole, units, families, Vec::new());
    w.sets = [vec![0, 1], vec![0]].map(|s| crate::search::weigh(&w.gram, &w.units, &s).expect("a set")).to_vec();
    let alternatives = [0, 1, 2].map(|place| Alternative { site: Site::Load(place), bases: vec![Basis::Height(1)], prior: 1.3 });
    let found = outcome(&w, &bare(), &alternatives).expect("an outcome");
    assert_eq!((found.families.len(), found.leads.len(), found.leads[0].rivals.len()), (1, 1, 1));
    let (lead, rival) = (&found.leads[0], &found.leads[0].rivals[0]);
    assert_eq!((lead.channel.as_str(), rival.channel.as_str()), (Site::Load(0).name(), Site::Load(1).name()));
    assert!((lead.gain - gain(1)).abs() < 1e-9 && (lead.amplitudes[0] - by_hand[1][0]).abs() < 1e-12, "{lead:?}");
    assert!((rival.gain - gain(2)).abs() < 1e-9 && (rival.amplitudes[0] - by_hand[2][0]).abs() < 1e-12, "{rival:?}");
    assert!((found.strongest - gain(1)).abs() < 1e-9, "{}", found.strongest);
    // One set with an alternative, one without.
    assert!((found.odds - gain(1)).abs() < 1e-9, "{}", found.odds);
    // Over the member alone the whole brings the same.
    assert!((over_effects(w.sets[0].gain, &w) - gain(1)).abs() < 1e-9);
    w.sets = vec![set(&[1], 9.0)];
    assert!((over_effects(9.0, &w) - 9.0).abs() < 1e-12);
}

/// A band of a seventh of its centre is a line, of a quarter is none; gusts of a thousandth of the speed are the least of a tunnel.
#[test]
fn exact_lines_and_faint_gusts() {
    let centre_rad_s = 3.0 * std::f64::consts::PI;
    let band = |share: f64| line_hz(&Shape::Band { centre_rad_s, bandwidth_rad_s: share * centre_rad_s });
    assert!(band(1.0 / 7.0).is_some_and(|hz| (hz - 1.5).abs() < 1e-12) && band(0.25).is_none());
    assert!(is_faint(0.005, 7.4) && !is_faint(0.008, 7.4));
    // Ten nats, or a twentieth of what a set brings.
    assert!(is_plain(11.0, 100.0) && !is_plain(9.0, 100.0) && !is_plain(15.0, 400.0) && is_plain(25.0, 400.0));
}

/// Fainter gusts stand for what the worst channel shows, and bring the difference of two likelihoods; a tunnel's stand for nothing.
#[test]
fn exact_stand_in() {
    let (engine, mut model) = in_gusts();
    model.members[0].values[..2].fill(1e-4);
    let with = fit(model.clone(), Vec::new(), DMatrix::zeros(0, 0), [0.0, 57.0]);
    let mut still = fit(model.clone().calm(), Vec::new(), DMatrix::zeros(0, 0), [0.0, 45.5]);
    still.channels[4][2] = 1.7;
    let lead = stand_in(&engine, &with, &still, 0, 7.4).expect("a lead");
    assert_eq!(lead.channel, CHANNEL_NAMES[4]);
    assert!((lead.gain - 11.5).abs() < 1e-12 && lead.line_hz.is_none(), "{lead:?}");
    // The same in a band of a tenth of its centre, V/(2πL).
    model.members[0].values[4] = 0.1;
    let tone = fit(model.clone(), Vec::new(), DMatrix::zeros(0, 0), [0.0, 57.0]);
    let hz = stand_in(&engine, &tone, &still, 0, 7.4).expect("a lead").line_hz.expect("a line");
    assert!((hz - 7.4 / (std::f64::consts::TAU * 0.6)).abs() < 1e-9, "{hz}");
    model.members[0].values = vec![0.1, 0.1, 0.6, 0.6, 0.0];
    assert!(stand_in(&engine, &fit(model, Vec::new(), DMatrix::zeros(0, 0), [0.0, 57.0]), &still, 0, 7.4).is_none());
}

/// Gusts of Dryden's form, fitted with a band of a tenth of its centre, are turbulence; those flown in so narrow a band are not.
#[test]
fn recover_turbulence_from_a_line() {
    let narrow = |engine: &Engine, model: &Model| {
        let mut model = model.clone();
        model.members[0].values[4] = 0.1;
        engine.settle_random(&engine.climb(&model, false, 6).expect("a fit"), 6)
    };
    let (engine, model) = in_gusts();
    let line = narrow(&engine, &model);
    assert!(tone_hz(&engine, &line.model.members[0], 7.4).is_some());
    let broad = as_turbulence(&engine, &line, 0, &mut Vec::new()).expect("as likely");
    assert!(tone_hz(&engine, &broad.model.members[0], 7.4).is_none() && score(&engine, &broad) > score(&engine, &line) - SURE);
    assert!(as_turbulence(&engine, &broad, 0, &mut Vec::new()).is_none(), "no line");

    let (engine, model) = flown(4.0, "turbulence", &[0.05, 0.05, 0.6, 0.6, 0.1]);
    let line = narrow(&engine, &model);
    let mut log = Vec::new();
    assert!(as_turbulence(&engine, &line, 0, &mut log).is_none(), "{log:?}");
    assert!(log.iter().any(|l| l.starts_with("turbulence ")), "compared: {log:?}");
}
