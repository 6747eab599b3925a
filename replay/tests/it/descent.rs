//! replay tests: descents of an identified model. In: the bundled planet scenario, a made posterior. Out: what the statistics say.

use std::path::Path;
use windfall_model::planet::{Dispersions, PlanetScenario};
use windfall_pid::{DataSet, Estimate, Identification};
use windfall_replay::descent::{Descended, DescentOrder, descend, steady_fall};
use windfall_scenarios::read_planet;

/// The bundled descent from 1.5 km.
fn scenario() -> PlanetScenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/planet/venus-dispersions.toml");
    let mut s = read_planet(&path).unwrap_or_else(|e| panic!("{e}")).scenario;
    s.flights[0].start.place.height_m = 1500.0;
    s.flights[0].start.v_ground.xyz.y = -2.0;
    s.flights[0].start.v_ground.xyz.z = 8.3;
    s.flights[0].duration_s = 400.0;
    s
}

fn found(parameters: &[(&str, &str, f64, f64)]) -> Identification {
    let estimate = |&(coefficient, name, estimate, std_error): &(&str, &str, f64, f64)| Estimate {
        coefficient: coefficient.to_owned(),
        name: name.to_owned(),
        estimate,
        std_error,
        rse_percent: None,
        ci95: [0.0; 2],
        std_error_white: std_error,
    };
    let n = parameters.len();
    let covariance = (0..n).map(|i| (0..n).map(|j| if i == j { parameters[i].3.powi(2) } else { 0.0 }).collect()).collect();
    let set = DataSet {
        refused: Vec::new(),
        envelope: None,
        name: "combined".to_owned(),
        runs: Vec::new(),
        parameters: parameters.iter().map(estimate).collect(),
        fits: Vec::new(),
        condition_number: 1.0,
        n_samples: 1,
        covariance,
        curves: Vec::new(),
        held: Vec::new(),
        constants: Vec::new(),
        effects: Vec::new(),
    };
    Identification {
        method: "made".to_owned(),
        reason: None,
        smoothing: None,
        identifiability: None,
        compatibility: None,
        data_sets: vec![set],
        envelopes: Vec::new(),
        warnings: Vec::new(),
    }
}

fn flown(s: &PlanetScenario, found: Option<&Identification>, draws: u64) -> Descended {
    descend(s, &s.flights[0], found, DescentOrder { draws, seed: 3 }, || {}).expect("flies")
}

/// Only C_A is uncertain, by 3 %, and the air is even: the speed on the ground is √(2mg/(ρSC_A)), so that its standard deviation is
/// 1.5 %, all of it the parameter's, and it falls as C_A grows. Bounds: four standard errors of 200 draws; curvature of the root, 3e-4.
#[test]
fn exact_speed_carries_the_error_of_drag() {
    let s = PlanetScenario { dispersions: Dispersions::default(), ..scenario() };
    let found = found(&[("CA", "CA_T0", 6.662, 0.2)]);
    let d = flown(&s, Some(&found), 200).summary;
    let line = d.touch_down.iter().find(|l| l.quantity == "descent_speed_m_s").expect("told");
    let terminal = steady_fall(&s, &s.body, &s.flights[0].start, 0.0).expect("air").terminal_speed_m_s;
    assert!((line.nominal.expect("landed") / terminal - 1.0).abs() < 1e-3, "{line:?} {terminal}");
    let relative = line.std / line.mean;
    assert!((relative / 0.015 - 1.0).abs() < 4.0 / 400.0_f64.sqrt(), "{relative}");
    assert!(line.share_of_parameters > 0.999 && line.share_linear > 0.995, "{line:?}");
    let most = &line.parameters[0];
    assert!(most.name == "CA_T0" && most.sign == -1 && (most.standardised + 1.0).abs() < 0.01, "{most:?}");
    assert!(!d.in_pairs && d.ends.landed == 200 && d.warnings.iter().any(|w| w.contains("Cl_p")), "{d:?}");
}

/// Same bytes on one thread and on three; another seed is another result. The ranking tells drag from chance.
#[test]
fn law_threads_change_nothing_and_pairs_part_the_sources() {
    let found = found(&[("CA", "CA_T0", 6.662, 0.2), ("Cl", "Cl_p", -5.68, 0.3)]);
    let s = scenario();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| flown(&s, Some(&found), 64))
    };
    let one = on(1);
    assert_eq!(one, on(3));
    let d = &one.summary;
    assert!(d.in_pairs && d.ends.landed == 64 && d.parameters.len() == 9, "{:?}", d.parameters);
    // Twins fly one model through other gusts.
    assert_eq!(one.rows[6].cells[1..11], one.rows[7].cells[1..11]);
    assert_ne!(one.rows[6].cells[13..], one.rows[7].cells[13..]);
    let line = |name: &str| d.touch_down.iter().find(|l| l.quantity == name).expect("told");
    let (speed, rate) = (line("descent_speed_m_s"), line("pitch_yaw_rate_deg_s"));
    assert_eq!(speed.parameters[0].name, "CA_T0");
    assert!(rate.share_of_parameters < 0.6 && rate.std_of_flight > rate.std_of_parameters, "{rate:?}");
    let roll = line("roll_rate_deg_s");
    assert!((roll.std_of_parameters.powi(2) + roll.std_of_flight.powi(2) - roll.std.powi(2)).abs() < 1e-12 * roll.std.powi(2));
    let other = descend(&s, &s.flights[0], Some(&found), DescentOrder { draws: 64, seed: 4 }, || {}).expect("flies");
    assert_ne!(other.rows, one.rows);
    // Bands hold their median, heights descend to the ground.
    for l in &d.over_height {
        assert!(l.height_m[0] > l.height_m[1] && l.height_m.last().is_some_and(|h| *h == 0.0));
        assert!((0..l.height_m.len()).all(|i| l.draws[i] == 64 && l.low[i] <= l.median[i] && l.median[i] <= l.high[i]), "{l:?}");
    }
}

/// A static moment that may have either sign: some descents tumble, and they are counted, not refused.
#[test]
fn law_tumbling_is_counted() {
    let s = scenario();
    let found = found(&[("Cm", "Cm_sin", 0.0, 2.0), ("Cm", "Cm_sin3", 0.0, 0.0)]);
    let d = flown(&s, Some(&found), 60).summary;
    assert!(d.ends.tumbled > 10 && d.ends.tumbled < 60, "{:?}", d.ends);
    assert_eq!(d.ends.landed + d.ends.aloft + d.ends.failed, 60);
}

#[test]
fn law_another_structure_is_refused_by_name() {
    let s = scenario();
    let wrong = found(&[("Cm", "Cm_q", -1.0, 0.1)]);
    let error =
        descend(&s, &s.flights[0], Some(&wrong), DescentOrder { draws: 2, seed: 1 }, || {}).expect_err("another structure");
    assert!(error.to_string().contains("Cm_q"), "{error}");
    let mut bare = found(&[("CA", "CA_T0", 6.0, 0.1)]);
    bare.data_sets[0].covariance.clear();
    let error = descend(&s, &s.flights[0], Some(&bare), DescentOrder { draws: 2, seed: 1 }, || {}).expect_err("no covariance");
    assert!(error.to_string().contains("covariance"), "{error}");
}
