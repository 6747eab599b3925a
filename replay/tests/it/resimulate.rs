//! replay tests: re-simulation. In: campaigns and known models, right and wrong. Out: whether flights meet the runs.

use crate::common::*;
use windfall_model::frames::{EulerXyz, Rotation};
use windfall_model::{Campaign, Data, Record, Release};
use windfall_pid::StopReason;
use windfall_pid::{DataSet, Estimate};
use windfall_replay::{HoldOut, Replay, ReplayError, campaign_of, estimate_initial, hold_out, resimulate};
use windfall_sim::{Seed, SimError, fly};

fn record(campaign: &Campaign, run: usize) -> &Record {
    match &campaign.runs[run].data {
        Data::Tunnel(r) => r,
        Data::Point(_) => panic!("a tunnel run"),
    }
}

/// Noise of Table A.3: √(0.0623² + 2·0.110²) = 0.1676° and √3·0.75 mm = 1.30 mm. A tenth on top for the noise of V_W, whose
/// integral moves the height by 2.57 mm/s·√(40 s/150 Hz) = 1.3 mm in the longest run.
#[test]
fn recover_trajectories_to_the_noise_floor() {
    let Some(campaign) = campaign("recover_trajectories_to_the_noise_floor", "open-00") else { return };
    let h = hold_out(&campaign, &with_table_5_5(&campaign), &[0, 1, 2, 3, 4], 1).expect("flies");
    for r in &h.runs {
        assert_eq!(r.initial, StopReason::Converged);
        assert!((0.15..0.18).contains(&r.trajectory.attitude_rms_deg), "{r:?}");
        assert!((1.2e-3..1.6e-3).contains(&r.trajectory.position_rms_m), "{r:?}");
        // Residuals are white sensor noise: their mean square is 1 within its scatter over 10,000 samples, plus V_W's noise.
        assert!(r.misfit.is_some_and(|m| (0.95..1.15).contains(&m)), "{r:?}");
        assert!(r.trajectory.attitude_rms_deg <= r.trajectory_from_first_sample.attitude_rms_deg);
    }
    // Mean and spread of the swinging: within a twentieth, what noise moves them by.
    for s in h.statistics.iter().filter(|s| s.statistic != "median") {
        assert!((s.simulation / s.test - 1.0).abs() < 0.05, "{s:?}");
    }
}

/// From the smoothed first state of an exact record with its recorded V_W, beside the independent simulator: what is left is the
/// smoothing's error at the end of the run, 1e-7 of the states there.
#[test]
fn recover_exact_campaign_from_its_first_states() {
    let Some(campaign) = campaign("recover_exact_campaign_from_its_first_states", "exact") else { return };
    let (plant, measured) = (with_table_5_5(&campaign), record(&campaign, 0));
    let replay = Replay::new(measured, &plant).expect("smooth");
    let flown = replay.fly(replay.first()).expect("flies");
    assert_eq!(flown.record.len(), measured.len());
    for k in 0..3 {
        let far = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
        let (p, a) = (
            far(&flown.record.position_m[k], &measured.position_m[k]),
            far(&flown.record.attitude_rad[k], &measured.attitude_rad[k]),
        );
        assert!(p < 1e-5 && a < 1e-5, "axis {k}: {p} m, {a} rad");
    }
}

/// A run recorded by a fast clock and a long ruler, flown again from its release with both known: the same record, to what smoothing
/// and interpolating V_W leave.
#[test]
fn recover_a_run_by_a_wrong_clock_and_ruler() {
    let s = bundled("sage-perturbed");
    let mut plant = s.plant.clone();
    (plant.sensors.time_base, plant.sensors.length_scale) = (0.03, -0.02);
    let mut order = s.flights[0].clone();
    (order.sensor_noise, order.duration_s) = (false, 8.0);
    let made = fly(&plant, &order, Seed { campaign: 5, run: 0 }).expect("flies").record;
    let far = |plant: &windfall_model::Plant| {
        let again = Replay::new(&made, plant).expect("smooth").fly(order.release).expect("flies").record;
        assert_eq!(again.len(), made.len());
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| (x - y).abs()).max_by(f64::total_cmp).unwrap_or(f64::NAN);
        let clock = apart(&again.t_s, &made.t_s);
        [clock, apart(&again.position_m[1], &made.position_m[1]), apart(&again.attitude_rad[1], &made.attitude_rad[1])]
    };
    let [clock, place, turn] = far(&plant);
    assert!(clock < 1e-12 && place < 1e-3 && turn < 1e-3, "{clock} s, {place} m, {turn} rad");
    let [_, wrong, _] = far(&s.plant);
    assert!(wrong > 20.0 * place, "{wrong} m without them, {place} m with");
}

/// The estimated initial state of an own noisy run is the released one within four standard errors.
#[test]
fn recover_initial_state() {
    let s = bundled("sage-combined");
    for run in [0, 2] {
        let flight = &s.flights[run];
        let flown = fly(&s.plant, flight, Seed { campaign: 7, run: run as u64 }).expect("flies");
        let found = estimate_initial(&flown.record, &s.plant).expect("estimates");
        assert_eq!(found.stop, StopReason::Converged);
        let (a, b) = (found.release, flight.release);
        let turn = |r: Release| {
            let [rx_rad, ry_rad, rz_rad] = r.attitude_rad;
            EulerXyz { rx_rad, ry_rad, rz_rad }.r_tunnel_body()
        };
        for k in 0..3 {
            let near = |x: f64, y: f64, at: usize| {
                assert!((x - y).abs() < 4.0 * found.std_error[at], "run {run}, number {at}: {x} {y} ± {}", found.std_error[at]);
            };
            near(a.position_m[k], b.position_m[k], k);
            near(a.velocity_m_s[k], b.velocity_m_s[k], 3 + k);
            near(a.rates_rad_s[k], b.rates_rad_s[k], 9 + k);
        }
        let error: Rotation<_, _> = turn(a);
        let largest = found.std_error[6..9].iter().fold(0.0_f64, |m, s| m.max(*s));
        assert!(error.angle_to(turn(b)) < 4.0 * 3.0_f64.sqrt() * largest);
        assert!(found.std_error.iter().all(|s| *s > 0.0 && *s < 0.01), "{:?}", found.std_error);
    }
}

/// Models that are far off, unstable or explosive give numbers and a reason, not a panic and not a NaN; where a run cannot be flown to its
/// end there is no misfit.
#[test]
fn law_poor_models_are_compared_too() {
    let Some(campaign) = campaign("law_poor_models_are_compared_too", "open-00") else { return };
    let good = hold_out(&campaign, &with_table_5_5(&campaign), &[3], 1).expect("flies");
    for (name, value) in [("Cm_sin", 2.0), ("Cm_1", 40.0), ("Cn_2", 2000.0), ("CA_T0", 3.0), ("Cn_1", -400.0)] {
        let mut plant = with_table_5_5(&campaign);
        let i = plant.aero.structure.index(name).expect("known");
        plant.aero.values[i] = value;
        let h = hold_out(&campaign, &plant, &[3], 1).expect("compares");
        let t = h.trajectory;
        let r = &h.runs[0];
        assert!(
            [t.attitude_rms_deg, t.position_rms_m, t.rate_rms_deg_s].iter().chain(&r.misfit).all(|x| x.is_finite()),
            "{name}: {h:?}"
        );
        let (a, p) = (good.trajectory.attitude_rms_deg, good.trajectory.position_rms_m);
        assert!(t.attitude_rms_deg > 2.0 * a || t.position_rms_m > 2.0 * p, "{name}: {t:?}");
    }
}

/// A campaign flown in turbulence: the plant that has it brings the statistics near the test's, the one without does not, and
/// seeds give a spread.
#[test]
fn recover_statistics_of_a_turbulent_campaign() {
    let mut s = bundled("sage-combined");
    let calm = s.plant.clone();
    let t = &mut s.plant.turbulence;
    (t.axial_rms_m_s, t.lateral_rms_m_s, t.axial_scale_m, t.lateral_scale_m) = (0.1, 0.1, 0.6, 0.6);
    let flight = &s.flights[4];
    let flown = fly(&s.plant, flight, Seed { campaign: 11, run: 4 }).expect("flies");
    let campaign = campaign_of(&s.plant, &[(flight, flown.record)]);
    let mean = |h: &HoldOut, k: usize| (h.statistics[k].simulation, h.statistics[k].test, h.statistics[k].simulation_std);
    let (with, without) =
        (hold_out(&campaign, &s.plant, &[0], 12).expect("flies"), hold_out(&campaign, &calm, &[0], 12).expect("flies"));
    for k in [0, 3] {
        let (simulation, test, spread) = mean(&with, k);
        let spread = spread.expect("twelve seeds");
        // One draw beside a mean of twelve: four standard deviations.
        assert!((simulation - test).abs() < 4.0 * spread * (1.0 + 1.0 / 12.0_f64).sqrt(), "{simulation} {test} {spread}");
        assert!(mean(&without, k).0 < 0.7 * test, "{:?}", without.statistics[k]);
    }
    // Trajectories are those without chance, so gusts change nothing there.
    assert_eq!(with.trajectory, without.trajectory);
}

/// Equal bits whatever the number of threads.
#[test]
fn law_threads_do_not_matter() {
    let s = bundled("sage-perturbed");
    let flown = fly(&s.plant, &s.flights[0], Seed { campaign: 3, run: 0 }).expect("flies");
    let campaign = campaign_of(&s.plant, &[(&s.flights[0], flown.record)]);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| hold_out(&campaign, &s.plant, &[0], 3)).expect("flies")
    };
    assert_eq!(with(1), with(3));
}

/// The contract's names.
#[test]
fn frozen_names_of_the_hold_out_result() {
    let s = bundled("sage-perturbed");
    let flown = fly(&s.plant, &s.flights[0], Seed::default()).expect("flies");
    let campaign = campaign_of(&s.plant, &[(&s.flights[0], flown.record)]);
    let h = hold_out(&campaign, &s.plant, &[0], 1).expect("flies");
    let json = serde_json::to_value(&h).expect("serialises");
    for key in ["attitude_rms_deg", "position_rms_m", "rate_rms_deg_s"] {
        assert!(json["trajectory"][key].is_f64(), "{key}");
    }
    assert!(json["specific_force_rms"].is_array() && json["specific_moment_rms"].is_array());
    let lines = json["statistics"].as_array().expect("a list");
    assert_eq!(lines.len(), 6);
    for (k, line) in lines.iter().enumerate() {
        assert_eq!(line["quantity"], if k < 3 { "theta_deg" } else { "omega_qr_deg_s" });
        assert_eq!(line["statistic"], ["mean", "median", "std"][k % 3]);
        assert!(line["test"].is_f64() && line["simulation"].is_f64());
    }
    let back: HoldOut = serde_json::from_value(json).expect("reads back");
    assert_eq!(back.statistics.len(), 6);
}

fn estimate(coefficient: &str, name: &str, estimate: f64, std_error: f64) -> Estimate {
    let ci95 = [estimate - 2.0 * std_error, estimate + 2.0 * std_error];
    let (coefficient, name) = (coefficient.to_owned(), name.to_owned());
    Estimate { coefficient, name, estimate, std_error, rse_percent: Some(1.0), ci95, std_error_white: std_error }
}

fn set(parameters: Vec<Estimate>) -> DataSet {
    DataSet {
        refused: Vec::new(),
        envelope: None,
        name: "combined".into(),
        runs: vec![],
        parameters,
        fits: vec![],
        condition_number: 1.0,
        n_samples: 0,
        covariance: vec![],
        curves: vec![],
        held: vec![],
        constants: Vec::new(),
        effects: Vec::new(),
    }
}

/// The static pair of C_m and C_n is one pair in the plant: weights 1/0.1² and 1/0.2² are 4 to 1, so (4·(−2) − 3)/5 = −2.2.
#[test]
fn exact_static_pair_is_the_weighted_mean() {
    let s = bundled("appendix-c");
    let campaign = campaign_of(&s.plant, &[]);
    let pair = set(vec![estimate("Cm", "Cm_sin", -2.0, 0.1), estimate("Cn", "Cm_sin", -3.0, 0.2)]);
    let plant = pair.plant(&campaign.plant).expect("fits");
    assert!((plant.aero.value("Cm_sin").expect("known") + 2.2).abs() < 1e-12);
    let other = set(vec![estimate("CA", "CD", 0.4, 0.1)]);
    assert!(matches!(other.plant(&campaign.plant), Err(windfall_pid::PidError::OtherStructure { name, .. }) if name == "CD"));
}

/// An identification without data sets and a campaign without runs are refused in words.
#[test]
fn law_nothing_to_fly_is_an_error() {
    let s = bundled("appendix-c");
    let campaign = campaign_of(&s.plant, &[]);
    let mut empty = windfall_pid::Identification {
        method: "x".into(),
        data_sets: vec![],
        envelopes: vec![],
        warnings: vec![],
        reason: None,
        smoothing: None,
        identifiability: None,
        compatibility: None,
    };
    assert!(matches!(resimulate(&campaign, &empty, 1), Err(ReplayError::NoDataSet)));
    empty.data_sets.push(set(vec![estimate("CA", "CA_T0", 6.6, 0.1)]));
    assert!(matches!(resimulate(&campaign, &empty, 1), Err(ReplayError::NoRuns { .. })));
}

/// Damping of the wrong sign feeds the spin: the flight is given up where it stops making sense, and flown as far as that.
#[test]
fn law_runaway_spin_ends_the_flight() {
    let mut s = bundled("appendix-c");
    let i = s.plant.aero.structure.index("Cl_p").expect("known");
    s.plant.aero.values[i] = 40.0;
    let error = fly(&s.plant, &s.flights[0], Seed::default()).expect_err("runs away");
    let SimError::Runaway { t_s, .. } = error else { panic!("{error}") };
    assert!(t_s > 0.1 && t_s < 15.0, "{t_s}");
    let good = fly(&bundled("appendix-c").plant, &s.flights[0], Seed::default()).expect("flies");
    let replay = Replay::new(&good.record, &s.plant).expect("smooth");
    let flown = replay.fly_as_far_as_it_goes(replay.first()).expect("flies a while");
    let end = flown.truth.t_s.last().copied().unwrap_or(0.0);
    assert!(end > 0.5 * t_s && end < t_s, "{end} of {t_s}");
}

/// A lander that swings by itself at small angles (`damping-shape`): the plant that has the effect follows every swing of a held-out
/// run to the sensors' noise, the one without does not.
#[test]
fn recover_limit_cycle_swing_by_swing() {
    let mut s = bundled("sage-combined");
    let declared = s.plant.clone();
    let effect = windfall_model::effects::find("damping-shape", windfall_model::Acts::Lander).expect("in the catalogue");
    (effect.apply)(&mut s.plant, &[7.0, 0.12]);
    let flight = &s.flights[4];
    let flown = fly(&s.plant, flight, Seed { campaign: 5, run: 4 }).expect("flies");
    let campaign = campaign_of(&s.plant, &[(flight, flown.record)]);
    let (with, without) =
        (hold_out(&campaign, &s.plant, &[0], 1).expect("flies"), hold_out(&campaign, &declared, &[0], 1).expect("flies"));
    // Noise of Table A.3 gives 0.168° and 1.30 mm; half as much again for the integral of the noise of V_W.
    let t = with.trajectory;
    assert!(t.attitude_rms_deg < 0.25 && t.position_rms_m < 2e-3, "{t:?}");
    assert!(with.runs[0].initial_span_s > 0.99 * with.runs[0].duration_s);
    assert!(without.trajectory.attitude_rms_deg > 10.0 * t.attitude_rms_deg, "{:?}", without.trajectory);
    let mean_theta = |h: &HoldOut| h.statistics[0].simulation / h.statistics[0].test;
    assert!(
        (mean_theta(&with) - 1.0).abs() < 0.01 && mean_theta(&without) < 0.5,
        "{} {}",
        mean_theta(&with),
        mean_theta(&without)
    );
}
