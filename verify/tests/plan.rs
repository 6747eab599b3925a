//! verify tests: what a plan promises is what flying it brings.

use windfall_model::{Campaign, Data, Flight, Knowledge, Run, Use};
use windfall_pid::output_error::{self, Options};
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
    let options = Options { combined_only: true, ..Options::default() };
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
