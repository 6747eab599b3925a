//! replay tests: Appendix C. In: the program's own exact run and the shared campaigns. Out: whether parameters come back.

use crate::common::*;
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::smooth::Smoother;
use windfall_pid::{Method, identify};
use windfall_replay::{recover, recover_by, resimulate};
use windfall_sim::Seed;

/// 0.001 %: the bound for exact data; round-off of second derivatives leaves about 1e-8 %.
#[test]
fn recover_own_exact_run() {
    let s = bundled("appendix-c");
    let r = recover(&s.plant, &s.flights[0], Seed { campaign: s.seed, run: 0 }, Method::EquationError).expect("recovers");
    assert_eq!(r.parameters.len(), 13);
    for p in &r.parameters {
        assert!(p.percent_error.abs() < 1e-3, "{p:?}");
        assert!(p.thesis_percent_error.is_some());
    }
    // Fifth-degree splines of samples at 150 Hz: states to 1e-6 of their size, coefficients, from second derivatives, to 1e-3.
    for (list, bound) in [(&r.states, 1e-6), (&r.coefficients, 1e-3)] {
        for q in list {
            assert!(q.largest > 0.0 && q.largest_error < bound * q.largest, "{q:?}");
        }
    }
}

/// A run with products of inertia, c.m. offset and an oblique hook comes back as well: nothing hangs on the symmetric lander.
#[test]
fn recover_lopsided_lander() {
    let mut s = bundled("appendix-c");
    let v = &mut s.plant.vehicle;
    (v.inertia.xy, v.inertia.xz, v.inertia.yz) = (1e-3, -7e-4, 4e-4);
    v.p_origin_cm = windfall_model::frames::Vec3::new(0.004, -0.003, 0.002);
    let hook = &mut s.plant.tether.as_mut().expect("tethered").p_origin_hook;
    *hook += windfall_model::frames::Vec3::new(0.0, 0.02, -0.01);
    let r = recover(&s.plant, &s.flights[0], Seed::default(), Method::EquationError).expect("recovers");
    assert!(r.parameters.iter().all(|p| p.percent_error.abs() < 1e-3), "{r:?}");
}

/// Appendix C as the thesis has it: not smoothed, derivatives by quadratics through five samples. Table C.1 has 0 to 6.84 %; an independent
/// script 0 to 2.87 % on this run, here within its last digit.
#[test]
fn pub_thesis_method_on_exact_data_is_within_its_own_table() {
    let s = bundled("appendix-c");
    let options = EstimateOptions { smoother: Some(Smoother::Unsmoothed), ..EstimateOptions::default() };
    let r = recover_by(&s.plant, &s.flights[0], Seed::default(), Method::Thesis, &options).expect("recovers");
    let largest = r.parameters.iter().map(|p| p.percent_error.abs()).fold(0.0, f64::max);
    assert!((largest - 2.87).abs() < 0.01, "{largest}");
    for (coefficient, name, printed) in [("CN", "CN_sin3", 0.35), ("Cm", "Cm_2", -2.02), ("Cn", "Cn_2", -2.81)] {
        let p = r.parameters.iter().find(|p| p.coefficient == coefficient && p.name == name).expect("there");
        assert!((100.0 * (p.estimate / p.truth - 1.0) - printed).abs() < 0.01, "{p:?}");
    }
}

/// A record that begins at its largest angle, smoothed as it is: hundreds of percent on C_N,sin³. The thesis has no such record: it smooths
/// whole runs and crops then.
#[test]
fn pub_smoothing_what_begins_at_its_largest_angle_loses_the_cubic_terms() {
    let s = bundled("appendix-c");
    let r = recover(&s.plant, &s.flights[0], Seed::default(), Method::Thesis).expect("recovers");
    let error = |name| r.parameters.iter().find(|p| p.name == name).map_or(0.0, |p| p.percent_error);
    assert!(error("CN_sin3") < -300.0 || error("CN_sin3") > 300.0, "{r:?}");
    assert!(error("CA_T0").abs() < 0.1, "{r:?}");
}

/// The bound for a right standard error: at least 11 of 13 intervals of 95 % hold the truth.
#[test]
fn recover_open_00_inside_intervals() {
    let Some(campaign) = campaign("recover_open_00_inside_intervals", "open-00") else { return };
    let found = identify(&campaign, Method::EquationError).expect("identifies");
    let set = found.data_set("combined").expect("combined");
    assert_eq!(set.parameters.len(), 13);
    let truth = with_table_5_5(&campaign);
    let inside = set.parameters.iter().filter(|p| {
        let t = truth.aero.value(&p.name).expect("known");
        (p.ci95[0]..=p.ci95[1]).contains(&t)
    });
    assert!(inside.count() >= 11, "{:?}", set.parameters);
}

/// The whole way: identify on some runs, fly all of them. Attitude to the sensors' noise (0.168°) and a fifth.
#[test]
fn recover_identified_model_flies_the_runs() {
    let Some(campaign) = campaign("recover_identified_model_flies_the_runs", "open-00") else { return };
    let found = identify(&campaign, Method::EquationError).expect("identifies");
    let r = resimulate(&campaign, &found, 2).expect("flies");
    assert_eq!((r.runs.len(), r.seeds, r.warnings.len()), (5, 2, 0), "{:?}", r.warnings);
    assert!(r.parameters.iter().all(|p| p.identified));
    for run in &r.runs {
        assert!(run.trajectory.attitude_rms_deg < 0.2, "{run:?}");
    }
    assert!(r.statistics.iter().all(|s| s.simulation_std.is_some()));
}
