//! replay tests: joined comparisons by hand, and what a plant leaves of the forces of a run that another plant flew.

use super::*;
use windfall_model::{Coefficient, Knowledge, Record};
use windfall_sim::fly;

/// The bundled perturbed flight, so many seconds of it, with or without the noise of its instruments.
pub(super) fn flown(duration_s: f64, sensor_noise: bool) -> (Plant, Record) {
    let s = windfall_scenarios::read_bundled("sage-perturbed").expect("bundled").scenario;
    let flight = windfall_model::Flight { duration_s, sensor_noise, ..s.flights[0].clone() };
    let record = fly(&s.plant, &flight, Seed { campaign: 3, run: 0 }).expect("flies").record;
    (s.plant, record)
}

fn run(name: &str, flown_s: f64, force: [f64; 3], moment: [f64; 3]) -> RunComparison {
    RunComparison {
        name: name.to_owned(),
        kind: String::new(),
        used: String::new(),
        trajectory: TrajectoryError::default(),
        trajectory_from_first_sample: TrajectoryError::default(),
        statistics: Vec::new(),
        misfit: None,
        initial_span_s: 0.0,
        initial: StopReason::Converged,
        duration_s: 3.0,
        flown_s,
        specific_force_rms: force,
        specific_moment_rms: moment,
        bands: Vec::new(),
        test: Swing::default(),
        simulation: Swing::default(),
    }
}

/// Root mean squares 1 and 3 of 3 and 5 samples are √((3 + 45)/8) = √6 of all, whatever the axis.
#[test]
fn exact_joined_root_mean_squares() {
    let one = |samples, [a, b]: [f64; 2]| Compared {
        run: run("", 3.0, [a, 2.0 * a, 3.0 * a], [b, 5.0 * b, 7.0 * b]),
        squares: Squares::default(),
        draws: Vec::new(),
        drawn: Vec::new(),
        samples,
    };
    let j = join(vec![one(3, [1.0, 3.0]), one(5, [3.0, 1.0])]);
    let (force, moment) = (6_f64.sqrt(), 4_f64.sqrt());
    for (k, (f, m)) in [(1.0, 1.0), (2.0, 5.0), (3.0, 7.0)].into_iter().enumerate() {
        assert!((j.specific_force_rms[k] - f * force).abs() < 1e-14 && (j.specific_moment_rms[k] - m * moment).abs() < 1e-14);
    }
    assert_eq!(j.runs.len(), 2);
}

/// A run of which a thousandth and more cannot be flown is named: 2.99 s of 3 s, not 2.998 s.
#[test]
fn exact_runs_cut_short_are_named() {
    let (plant, _) = flown(0.1, false);
    let campaign = Campaign::of_flights("", &plant, &[], &Knowledge::default(), Vec::new());
    let runs = [run("whole", 2.998, [0.0; 3], [0.0; 3]), run("short", 2.99, [0.0; 3], [0.0; 3])];
    let all = warnings(&campaign, &[], &runs);
    assert!(all.len() == 1 && all[0].contains("run short"), "{all:?}");
}

/// A plant with more axial force and pitching moment than what flew leaves just these: q̄ S ΔC_A/m and q̄ S d ΔC_m/I_yy. Smoothing leaves
/// a hundredth of coefficients near 7 and 2.
#[test]
fn recover_what_a_plant_has_too_much() {
    let (plant, record) = flown(0.8, false);
    let replay = Replay::new(&record, &plant).expect("smooth");
    let mut other = plant.clone();
    other.aero.add(Coefficient::CA, 3.0, 1.0, &[]);
    other.aero.add(Coefficient::Cm, -1.7, 1.0, &[]);
    let rows = coefficients(replay.states(), &plant);
    let q = (rows.iter().map(|r| r.q_pa.powi(2)).sum::<f64>() / rows.len() as f64).sqrt();
    let v = &plant.vehicle;
    let (force, moment) = (q * v.area_m2() * 3.0 / v.mass_kg, q * v.area_m2() * v.diameter_m * 1.7 / v.inertia.yy);
    let (f, m) = specific_residual(&replay, &other);
    assert!((f[0] / force - 1.0).abs() < 0.02 && f[1].hypot(f[2]) < 0.02 * force, "{f:?} {force}");
    assert!((m[1] / moment - 1.0).abs() < 0.02 && m[0].hypot(m[2]) < 0.02 * moment, "{m:?} {moment}");
}
