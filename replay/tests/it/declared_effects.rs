//! replay tests: effects that a campaign declares act in every verb. In: flights whose truth has an effect that the declared model has too. Out: answers
//! with the declaration beside those without, and those with the same effect put into the plant by hand.

use windfall_model::{Campaign, Effect, Flight, Plant, Record, Use, effects};
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::plan::{Target, Wanted, plan};
use windfall_pid::plausible::plausible;
use windfall_pid::structure::{Criterion, choose};
use windfall_pid::{DataSet, Identification, Method, TURBULENCE, identifiability, identify_by};
use windfall_replay::{bootstrap, campaign_of, hold_out, resimulate};
use windfall_scenarios::read_bundled;
use windfall_sim::{Seed, fly};

/// A centre of mass a millimetre off.
const SHIFT: (&str, &[f64]) = ("center-of-mass", &[0.0, 0.0, 0.001]);
/// Gusts of a tenth of a metre a second.
const GUSTS: (&str, &[f64]) = (TURBULENCE, &[0.1, 0.1, 0.6, 0.6, 0.0]);

fn effect(family: &str) -> &'static Effect {
    effects::find(family, windfall_model::Acts::Lander).expect("in the catalogue")
}

fn with(plant: &Plant, (family, values): (&str, &[f64])) -> Plant {
    let mut own = plant.clone();
    (effect(family).apply)(&mut own, values);
    own
}

/// Two perturbed runs of ten seconds and one held out, whose truth has an effect that nothing declares.
fn flown(truth: (&str, &[f64])) -> Campaign {
    let scenario = read_bundled("sage-combined").expect("bundled").scenario;
    let mut flights: Vec<Flight> = [0, 1, 3].map(|i| scenario.flights[i].clone()).to_vec();
    flights.iter_mut().for_each(|f| f.duration_s = 10.0);
    let plant = with(&scenario.plant, truth);
    let record = |(k, f): (usize, &Flight)| fly(&plant, f, Seed { campaign: 77, run: k as u64 }).expect("flies").record;
    let records: Vec<Record> = flights.iter().enumerate().map(record).collect();
    let mut campaign = campaign_of(&scenario.plant, &flights.iter().zip(records).collect::<Vec<_>>());
    campaign.plant.aero.values.clone_from(&scenario.plant.aero.values);
    for (run, used) in campaign.runs.iter_mut().zip([Use::Identify, Use::Identify, Use::HoldOut]) {
        run.used = used;
    }
    campaign
}

/// The same campaign with an effect declared.
fn declared(campaign: &Campaign, (family, values): (&str, &[f64])) -> Campaign {
    let mut own = campaign.clone();
    own.knowledge.effects.push((effect(family), values.to_vec()));
    own
}

/// The same with the effect in its plant, by hand.
fn by_hand(campaign: &Campaign, truth: (&str, &[f64])) -> Campaign {
    Campaign { plant: with(&campaign.plant, truth), ..campaign.clone() }
}

fn combined(campaign: &Campaign, method: Method) -> Identification {
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    identify_by(campaign, method, &options).expect("identifies")
}

fn set(found: &Identification) -> &DataSet {
    found.of_all_runs().expect("all runs together")
}

/// Every method estimates what it does with the effect in the plant by hand, to the bit, and its model flies nearer to the run held out than that
/// of the same method without the declaration.
#[test]
fn law_a_declared_effect_acts_in_every_method_and_in_its_flights() {
    let bare = flown(SHIFT);
    let (own, hand) = (declared(&bare, SHIFT), by_hand(&bare, SHIFT));
    for method in Method::ALL {
        let [with, by_hand, without] = [&own, &hand, &bare].map(|c| combined(c, method));
        let estimates = |f: &Identification| set(f).parameters.iter().map(|p| (p.estimate, p.std_error)).collect::<Vec<_>>();
        assert_eq!(estimates(&with), estimates(&by_hand), "{method:?}");
        assert_eq!(set(&with).effects[0].family, "center-of-mass");
        assert!(set(&with).effects[0].parameters.iter().all(|p| p.std_error.is_none()), "held");
        let error = |c: &Campaign, f: &Identification| {
            let plant = set(f).plant_in(c).expect("of this campaign");
            hold_out(c, &plant, &[2], 1).expect("flies").trajectory.attitude_rms_deg
        };
        let (near, far) = (error(&own, &with), error(&bare, &without));
        assert!(near < 0.8 * far, "{method:?}: {near} deg with the declaration, {far} without");
        // Flown again on the same campaign it is the same plant, and it is said what was flown.
        let again = resimulate(&own, &with, 1).expect("flies");
        assert_eq!(again.runs[2].trajectory.attitude_rms_deg.to_bits(), near.to_bits(), "{method:?}");
        let said = again.parameters.iter().find(|p| p.name == "center-of-mass.z_m").expect("flown beside the parameters");
        assert!((said.value - 0.001).abs() < 1e-15 && !said.identified);
        // An identification of another campaign, which says nothing of it: the declared effect acts all the same.
        assert!((set(&without).plant_in(&own).expect("fits").vehicle.p_origin_cm.z() - 0.001).abs() < 1e-15);
    }
}

/// What the runs can tell, plans and structure are those of the model with the effect, to the bit, and not those of the model without.
#[test]
fn law_a_declared_effect_acts_in_what_is_asked_of_runs() {
    let bare = flown(SHIFT);
    let (own, hand) = (declared(&bare, SHIFT), by_hand(&bare, SHIFT));
    let all = [&own, &hand, &bare];
    let [with, by_hand, without] = all.map(|c| identifiability(c, &EstimateOptions::default()).expect("can be integrated"));
    assert_eq!(with.expected, by_hand.expected);
    assert_ne!(with.expected, without.expected);
    let [with, by_hand, without] = all.map(|c| choose(c, Criterion::Subset).expect("chooses"));
    assert_eq!(with.coefficients, by_hand.coefficients);
    assert_ne!(with.coefficients, without.coefficients);
    let target = [Target { parameter: "Cm_2".to_owned(), error: Wanted::Percent(5.0) }];
    let [with, by_hand, without] = all.map(|c| plan(c, &target, 60.0).expect("plans"));
    assert_eq!(with.targets, by_hand.targets);
    assert!(with.method.contains("its residual is noise") && !without.method.contains("its residual is noise"));
}

/// Half as much mass again as the body has is a gross fault, and none where the campaign declares what is too much.
#[test]
fn law_a_declared_effect_acts_in_the_check_of_the_record() {
    let mut heavy = flown(("mass", &[0.0]));
    let mass_kg = heavy.plant.vehicle.mass_kg;
    heavy.plant.vehicle.mass_kg *= 1.5;
    assert!(plausible(&heavy).is_err_and(|e| e.to_string().contains("mass")));
    plausible(&declared(&heavy, ("mass", &[-0.5 * mass_kg]))).expect("declared");
}

/// A random effect is no load: each method says what becomes of it, and none flies it twice.
#[test]
fn law_a_declared_random_effect_is_said() {
    let own = declared(&flown(GUSTS), GUSTS);
    for method in Method::ALL {
        let found = combined(&own, method);
        let said: Vec<&String> = found.warnings.iter().filter(|w| w.contains("declared effect turbulence")).collect();
        assert_eq!(said.len(), 1, "{method:?}: {:?}", found.warnings);
        assert!(said[0].contains(method.name()), "{}", said[0]);
        let flown = set(&found).plant_in(&own).expect("of this campaign").turbulence;
        let gusts = set(&found).get(TURBULENCE, "lateral_rms_m_s").map_or(0.1, |p| p.estimate);
        assert!((flown.lateral_rms_m_s - gusts).abs() < 1e-15, "{method:?}: {} for {gusts}", flown.lateral_rms_m_s);
    }
    let chosen = choose(&own, Criterion::Subset).expect("chooses");
    assert!(chosen.warnings.iter().any(|w| w.contains("declared effect turbulence")), "{:?}", chosen.warnings);
}

/// Copies have the effect too: with declared gusts regression's estimates scatter over them by more than twice what they do without, where sensors'
/// noise alone is in the copies. The record that they are copies of is of still air, whose estimates are good.
#[test]
fn law_a_declared_effect_acts_in_copies() {
    let bare = flown(("mass", &[0.0]));
    let own = declared(&bare, GUSTS);
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    let scatter = |c: &Campaign| -> f64 {
        let found = combined(c, Method::EquationError);
        let copies = bootstrap(c, &found, Method::EquationError, &options, 12).expect("copies");
        copies.parameters.iter().find(|p| p.name == "Cm_sin").expect("declared").scatter
    };
    let (with, without) = (scatter(&own), scatter(&bare));
    assert!(with > 2.0 * without, "{with} with gusts in the copies, {without} without");
}
