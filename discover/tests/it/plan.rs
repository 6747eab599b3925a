//! discover tests: what a plan promises is what flying it brings.

use windfall_discover::separate::separate;
use windfall_model::effects::find;
use windfall_model::{Acts, Campaign, Data, Flight, Knowledge, Run, Use};
use windfall_pid::output_error::{self, EstimateOptions};
use windfall_pid::plan::{Target, Wanted, plan};
use windfall_scenarios::read_bundled;
use windfall_sim::{Seed, fly};

/// A campaign of two short runs; the plan for half the error of C_m,2 is flown by the simulator with a hand at the throttle, and the
/// campaign identified again. The plan flies at trim: with a speed that wanders by 2 % information wanders by 8 %, its root by 4 %, and
/// the first estimates' own error of some percent enters in both: 10 % is allowed.
#[test]
fn recover_the_error_that_was_planned() {
    let scenario = read_bundled("sage-combined").expect("bundled").scenario;
    let fly_run = |flight: &Flight, run: u64| Run {
        name: format!("run {run}"),
        kind: flight.kind.clone(),
        used: Use::Identify,
        inputs: Vec::new(),
        data: Data::Tunnel(fly(&scenario.plant, flight, Seed { campaign: 77, run }).expect("flies").record),
        notes: Vec::new(),
    };
    let mut campaign = Campaign {
        name: "before".to_owned(),
        declared: vec![true; scenario.plant.aero.values.len()],
        plant: scenario.plant.clone(),
        inputs: Vec::new(),
        runs: vec![fly_run(&scenario.flights[0], 0), fly_run(&scenario.flights[1], 1)],
        knowledge: Knowledge::default(),
    };
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    let error = |campaign: &Campaign| {
        let found = output_error::identify(campaign, &options).expect("identifies");
        found.data_set("combined").and_then(|d| d.get("Cm", "Cm_2")).expect("estimated").std_error
    };
    let now = error(&campaign);
    let target = Target { parameter: "Cm_2".to_owned(), error: Wanted::Absolute(0.5 * now) };
    let planned = plan(&campaign, &[target], 60.0).expect("plans");
    let t = &planned.targets[0];
    assert!((t.std_error_now / now - 1.0).abs() < 0.05, "the filter's information is output error's: {} {now}", t.std_error_now);
    let choice = t.options.iter().find(|o| o.release_deg < 31.0 && o.runs <= 12).expect("a few runs are enough");
    for i in 0..u64::from(choice.runs) {
        let mut flight = scenario.flights[0].clone();
        let half = choice.release_deg.to_radians().cos().sqrt().acos();
        (flight.release.attitude_rad, flight.release.rates_rad_s) = ([0.0, half, half], [0.0; 3]);
        (flight.release.position_m, flight.release.velocity_m_s) = ([0.0; 3], [0.0; 3]);
        flight.duration_s = choice.run_s;
        campaign.runs.push(fly_run(&flight, 2 + i));
    }
    let then = error(&campaign);
    assert!((then / choice.std_error - 1.0).abs() < 0.1, "{then} for {} planned, {now} before: {choice:?}", choice.std_error);
}

/// Two short runs in which a weak effect cannot be told from another: the run that is proposed, flown, decides for whichever is true as
/// it was expected to. Expected odds are those of a quadratic likelihood without noise: they are met to a factor of two in their logarithm
/// or to five, whichever is more.
#[test]
fn recover_the_odds_that_were_expected() {
    let mut scenario = read_bundled("sage-combined").expect("bundled").scenario;
    let declared = scenario.plant.clone();
    let effect = find("axial-speed", Acts::Lander).expect("of the catalogue");
    (effect.apply)(&mut scenario.plant, &[0.1, 7.5]);
    let runs = (0..2).map(|k| {
        let flight = Flight { duration_s: 8.0, ..scenario.flights[k].clone() };
        Run {
            name: format!("run {k}"),
            kind: flight.kind.clone(),
            used: Use::Identify,
            inputs: Vec::new(),
            data: Data::Tunnel(fly(&scenario.plant, &flight, Seed { campaign: 78, run: k as u64 }).expect("flies").record),
            notes: Vec::new(),
        }
    });
    let campaign = Campaign {
        name: "weak".to_owned(),
        declared: vec![true; declared.aero.values.len()],
        runs: runs.collect(),
        plant: declared,
        inputs: Vec::new(),
        knowledge: Knowledge::default(),
    };
    let found = separate(&campaign, 60.0, false).expect("closes");
    for p in &found.pairs {
        eprintln!("{:?} or {:?}: {:.2} {:?}", p.families, p.rival, p.log_odds_now, p.runs.first());
    }
    assert!(!found.pairs.is_empty(), "rivals");
    for best in found.pairs.iter().filter_map(|p| p.runs.first()) {
        let simulated = best.simulated.expect("flown");
        for (expected, simulated) in best.log_odds.into_iter().zip(simulated) {
            // One draw of noise: half the square of a normal number whose mean square is twice the odds.
            let scatter = (2.0 * expected.abs()).sqrt();
            let apart = (expected - simulated).abs();
            assert!(apart < (0.7 * expected.abs()).max(2.5 * scatter), "{expected} {simulated}");
        }
    }
}
