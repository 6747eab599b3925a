//! discover tests: lines of a closing on the likelihood, from a search of given numbers, against closed forms.

use super::*;
use crate::close::tests::sage;
use nalgebra::{DMatrix, DVector};
use windfall_likelihood::{ChannelNoise, Gram, Hum, Model, Number, Unit};
use windfall_model::{Constant, Measured};
use windfall_pid::StopReason;

fn number(id: Id, prior: f64, high: f64) -> Number {
    Number { id, value: 0.0, prior, range: [-high, high], at_end: [false; 2], step: 1e-3 }
}

/// Nothing found, and nothing weighed.
fn nothing(model: Model) -> Discovery {
    let (none, empty) = (DVector::zeros(0), DMatrix::zeros(0, 0));
    let gram = Gram { numbers: Vec::new(), g: empty.clone(), b: none.clone(), b_here: none, log_likelihood: 0.0 };
    let after = Fit {
        model,
        numbers: Vec::new(),
        covariance: empty,
        total: 0.0,
        log_likelihood: 0.0,
        chi: 1.0,
        channels: [[4e-6, 9e-6, 1.0, 100.0]; 7],
        stop: StopReason::Converged,
    };
    Discovery {
        before: None,
        before_fault: Ok(()),
        departs: None,
        after,
        sets: Vec::new(),
        gram,
        units: Vec::new(),
        families: Vec::new(),
        contest: None,
        faint: Vec::new(),
        stand_ins: Vec::new(),
        random_gains: Vec::new(),
        random_ranges: Vec::new(),
        random_bounds: Vec::new(),
        lines: Vec::new(),
        unfinished_passes: None,
        errors_carry_missing: false,
        outliers: [0; POSE],
        log: Vec::new(),
    }
}

fn searched(c: &Campaign) -> (Engine, Discovery) {
    let engine = Engine::new(c, &[0]).expect("a tunnel run");
    let found = nothing(Model::declared(engine.campaign()));
    (engine, found)
}

fn place(family: &str) -> usize {
    CATALOGUE.iter().position(|e| e.family == family).expect("in the catalogue")
}

/// The best of the catalogue where one family alone has this chance.
fn of_all(p: f64) -> f64 {
    1.0 - (0..CATALOGUE.len()).map(|_| 1.0 - p).product::<f64>()
}

/// A mean square 1.96 standard deviations, each 0.04, above one: 2 over a count of 20000/7, and the square of 3 % that noise is
/// known to.
#[test]
fn exact_chance_of_a_channel() {
    let c = sage(1.5);
    let (_, mut found) = searched(&c);
    found.after.channels[4] = [4e-6, 9e-6, 1.0784, 20_000.0 / 7.0];
    let lines = channels(&found.after);
    assert!((lines[4].p_value - 0.024_997_895).abs() < 1e-8 && (lines[0].p_value - 0.5).abs() < 1e-12, "{lines:?}");
    assert!((lines[4].rms - 0.36 / std::f64::consts::PI).abs() < 1e-12 && (lines[0].expected_rms - 0.003).abs() < 1e-15);
}

/// A quarter of the variance is coloured; lines to a twentieth of a Hz.
#[test]
fn exact_noise_and_lines() {
    let c = sage(1.5);
    let (mut engine, mut found) = searched(&c);
    engine.noise[4] = ChannelNoise { white: 0.6e-6, coloured: 0.2e-6, correlation: 0.7 };
    engine.hum = vec![Hum { channel: 4, hz: 49.98, amplitude: 1.0 }];
    let channel = CHANNEL_NAMES[4].to_owned();
    found.lines = vec![Lead { channel, gain: 5.0, line_hz: Some(12.36), of_instrument: true, ..Lead::default() }];
    let lines = noise(&c, &engine, &[0], &found);
    assert!((lines[4].coloured_share - 0.25).abs() < 1e-15 && lines[3].lines_hz.is_empty(), "{lines:?}");
    let hz = &lines[4].lines_hz;
    assert!(hz.len() == 2 && (hz[0] - 12.35).abs() < 1e-12 && (hz[1] - 50.0).abs() < 1e-12, "{hz:?}");
}

#[test]
fn exact_constants_depart_from_what_is_declared() {
    let mut c = sage(1.5);
    let mass = Constant { key: "mass", component: "", unit: "kg", lens: |p| Some(&mut p.vehicle.mass_kg), std: 0.2 };
    c.knowledge.constants = vec![mass];
    let (engine, mut found) = searched(&c);
    found.after.model.constants[0] = 0.03;
    found.after.numbers = vec![number(Id::Declared(0), 1.0, 9.0), number(Id::Constant(0), 0.2, 9.0)];
    found.after.covariance = DMatrix::from_diagonal(&DVector::from_column_slice(&[1.0, 4e-4]));
    let line = &constants(engine.campaign(), &found.after)[0];
    assert!((line.estimate - c.plant.vehicle.mass_kg - 0.03).abs() < 1e-15, "{line:?}");
    assert!((line.std_error.expect("free") - 0.02).abs() < 1e-15, "{line:?}");
}

/// Two strengths of 2.1 and −1.2 standard errors have Wald's statistic 2.1² + 1.2², those of a random input twice their gain;
/// χ² of two degrees has the tail e^(−x/2).
#[test]
fn exact_chances_anywhere_in_the_catalogue() {
    let c = sage(1.5);
    let (engine, mut found) = searched(&c);
    let mut gusts = Member::null(CATALOGUE[place("turbulence")], engine.campaign());
    gusts.values.truncate(2);
    found.random_gains = vec![(1, 40.0), (0, 7.3)];
    let p = p_of(0, &gusts, &found);
    assert!(gusts.random && (p / of_all((-7.3_f64).exp()) - 1.0).abs() < 1e-9, "{p}");
    let mut two = Member::null(CATALOGUE[place("mass")], engine.campaign());
    two.parameters.push(two.parameters[0].clone());
    two.values = vec![0.21, -0.06];
    found.after.numbers = [0, 1].map(|i| Number { value: two.values[i], ..number(Id::Member(0, i), 1.0, 9.0) }).to_vec();
    found.after.covariance = DMatrix::from_diagonal(&DVector::from_column_slice(&[0.01, 0.0025]));
    let p = p_of(0, &two, &found);
    assert!((p / of_all((-0.5 * (2.1_f64.powi(2) + 1.2_f64.powi(2))).exp()) - 1.0).abs() < 1e-9, "{p}");
}

/// Without a contest nothing stands against a form; held-out runs 0.7 nats less likely leave e^(−0.7) of its odds.
#[test]
fn exact_checks_of_a_form() {
    let c = sage(1.5);
    let (engine, found) = searched(&c);
    let mass = Member::null(CATALOGUE[place("mass")], engine.campaign());
    let told = Told { sets: Vec::new(), is_explained: true };
    let form = effect_line(0, &mass, &found, &engine, &told, Some(-0.7)).form.expect("a form");
    let p: Vec<f64> = form.checks.iter().map(|c| c.p_value).collect();
    assert!(form.ok && (p[0] - 1.0).abs() < 1e-15 && (p[1] - (-0.7_f64).exp()).abs() < 1e-15, "{p:?}");
    let side = |log_likelihood| After {
        parameters: Vec::new(),
        hold_out: Some(HeldOut::of_points(Measured::Position, 0.1, None, Some(log_likelihood))),
    };
    assert!(held_out_gain(&side(-120.0), &side(-97.5)).is_some_and(|gain| (gain - 22.5).abs() < 1e-12));
}

/// Columns that share no information: a mean is b/(g + 1/s²), its variance 1/(g + 1/s²). Two columns of swirl, one of mass in two
/// forms of which the likelier counts.
#[test]
fn exact_candidates_and_bounds() {
    let c = sage(1.5);
    let (_, mut found) = searched(&c);
    let (swirl, mass) = (place("swirl"), place("mass"));
    found.gram.numbers = vec![
        number(Id::Strength(swirl, 0, 0), 0.5, 4.0),
        number(Id::Strength(swirl, 0, 0), 0.2, 4.0),
        number(Id::Strength(mass, 0, 0), 2.0, 4.0),
        number(Id::Strength(mass, 1, 0), 0.1, 0.31),
    ];
    let (g, b) = ([3.0, 5.0, 0.7, 11.0], [2.0, -7.0, 1.1, 30.0]);
    found.gram.g = DMatrix::from_diagonal(&DVector::from_column_slice(&g));
    found.gram.b = DVector::from_column_slice(&b);
    let unit = |group, columns| Unit { group, columns, cost: 1.0 };
    found.units = vec![unit(0, vec![0, 1]), unit(1, vec![2]), unit(1, vec![3])];
    found.families = vec![(swirl, Some(0)), (mass, Some(0)), (mass, Some(1))];
    let information = [3.0 + 4.0, 5.0 + 25.0, 0.7 + 0.25, 11.0 + 100.0];
    let worth = |i: usize| b[i] * b[i] / information[i];
    let lines = candidates(&found);
    assert!(lines.len() == 2 && lines[0].family == "mass" && lines[1].family == "swirl", "{lines:?}");
    assert!((lines[0].score - worth(3)).abs() < 1e-12 && (lines[1].score - worth(0) - worth(1)).abs() < 1e-12, "{lines:?}");
    let p = of_all((-0.5 * (worth(0) + worth(1))).exp());
    assert!((lines[1].p_value / p - 1.0).abs() < 1e-9, "{lines:?} {p}");
    let all = bounds(&found);
    let upper = |i: usize| b[i].abs() / information[i] + NORMAL_95 / information[i].sqrt();
    // The largest of a strength's forms; one that would be beyond what a model can have is under that.
    for (line, (family, expected)) in all.iter().zip([("swirl", upper(0).max(upper(1))), ("mass", upper(2).max(0.31))]) {
        assert!(line.family == family && (line.upper95 - expected).abs() < 1e-12, "{all:?} {expected}");
    }
    found.gram.numbers[2].range = [-0.3, 0.3];
    assert!((bounds(&found)[1].upper95 - 0.31).abs() < 1e-12);
}

/// A line that noise has with one chance in two hundred has 5.3 nats; a dependence is said from four.
#[test]
fn law_what_is_enough_to_be_said() {
    let c = sage(1.5);
    let (engine, mut found) = searched(&c);
    let options = Options { false_alarm: 0.005, ..Options::default() };
    let said = |found: &Discovery| unexplained(found, &[], &engine, &options).len();
    let lead = |gain, line_hz| Lead { channel: "Cm".to_owned(), gain, line_hz, ..Lead::default() };
    for (gain, lines) in [(5.2, 0), (5.4, 1)] {
        found.lines = vec![lead(gain, Some(3.0))];
        assert_eq!(said(&found), lines, "{gain}");
    }
    found.lines.clear();
    for (gain, leads) in [(3.9, 0), (4.1, 1)] {
        found.faint = vec![lead(gain, None)];
        assert_eq!(said(&found), leads, "{gain}");
    }
}
