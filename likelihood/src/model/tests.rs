//! likelihood tests: numbers of a model, and what they change.

use super::*;
use windfall_model::{Constant, Knowledge};

fn campaign(std: f64) -> Campaign {
    let file = windfall_scenarios::read_bundled("sage-perturbed").expect("a bundled scenario");
    let plant = file.declared_plant;
    let constant = Constant { key: "mass", component: "", unit: "kg", lens: |p| Some(&mut p.vehicle.mass_kg), std };
    let knowledge = Knowledge { constants: vec![constant], ..Knowledge::default() };
    let declared = vec![true; plant.aero.values.len()];
    Campaign::of_flights("numbers", &plant, &declared, &knowledge, Vec::new())
}

/// A number changes by as much as is asked for, up to the ends of its range, which for a constant lie as far below its declared
/// value as above.
#[test]
fn exact_changes_within_a_range() {
    let campaign = campaign(0.02);
    let mut model = Model::declared(&campaign);
    let mass = model.known(&campaign).into_iter().find(|n| n.id == Id::Constant(0)).expect("an uncertain constant");
    assert!(mass.range[1] > 0.5 && (mass.range[0] + mass.range[1]).abs() < 1e-15);
    for (by, value) in [(0.3, 0.3), (-0.1, 0.2), (1e3, mass.range[1]), (-0.25, mass.range[1] - 0.25), (-1e3, -mass.range[1])] {
        model.change(&mass, by);
        assert!((model.constants[0] - value).abs() < 1e-15, "{by}");
    }
}

/// A constant's number is what it is more than declared.
#[test]
fn exact_constant_is_a_departure() {
    let campaign = campaign(0.02);
    let model = Model { constants: vec![0.03], ..Model::declared(&campaign) };
    let mass_kg = campaign.plant.vehicle.mass_kg + 0.03;
    assert!((model.plant(&campaign).vehicle.mass_kg - mass_kg).abs() < 1e-15);
}

/// What is twice as large has a prior, a range and a step twice as large: declared parameters by their values, constants by their
/// standard uncertainty, shapes by their values, strengths by the end of their range.
#[test]
fn law_priors_ranges_and_steps_scale() {
    let twice = |one: &Number, two: &Number, range: bool| {
        let pairs = [(one.prior, two.prior), (one.step, two.step)];
        let ranges = [0, 1].map(|i| (one.range[i], two.range[i]));
        pairs.into_iter().chain(ranges.into_iter().filter(|_| range)).for_each(|(a, b)| {
            assert!((b / a - 2.0).abs() < 1e-14, "{one:?} {two:?}");
        });
    };
    let known = |value: f64, std: f64| {
        let campaign = campaign(std);
        Model { declared: vec![value; campaign.declared.len()], ..Model::declared(&campaign) }.known(&campaign)
    };
    // Larger than any declared value.
    let (one, two) = (known(700.0, 0.02), known(1400.0, 0.04));
    assert!(one.len() > 1);
    one.iter().zip(&two).for_each(|(a, b)| twice(a, b, matches!(a.id, Id::Constant(_))));

    let campaign = campaign(0.02);
    let effect = CATALOGUE.iter().find(|e| e.family == "damping-shape").expect("an effect of the catalogue");
    let shapes = |width: f64| {
        let member = Member { values: vec![3.0, width], ..Member::null(effect, &campaign) };
        Model { members: vec![member], ..Model::declared(&campaign) }.of_members(true)
    };
    let (one, two) = (shapes(0.1), shapes(0.2));
    assert_eq!((one.len(), one[1].id), (2, Id::Member(0, 1)));
    twice(&one[1], &two[1], false);

    let strength = |usual: f64| Parameter { usual, ..Member::null(effect, &campaign).parameters[0].clone() };
    assert!((strength_step(&strength(14.0)) / strength_step(&strength(7.0)) - 2.0).abs() < 1e-14);
}
