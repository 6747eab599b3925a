//! pid tests: the search on a problem that is linear, an error of an angle; its likelihood and noise by hand.

use super::super::run::tests::{SAMPLES, Shown, erring, flown};
use super::*;
use statrs::distribution::{Continuous, Normal as Gaussian};
use windfall_model::{CHANNELS, Freedom, Plant, Record, Unknown, UnknownId};

const STD: PerChannel<f64> = [7.5e-4, 8e-4, 9e-4, 1.1e-3, 1.9e-3, 2.1e-3, 2.6e-3];

/// Nothing but an error of R_y is free.
fn error(plant: &Plant, at: f64) -> Unknowns {
    let one = |(i, value): (usize, &f64)| Unknown::linear(UnknownId::Parameter(i), "", *value, Freedom::Held(*value));
    let mut all: Vec<Unknown> = plant.aero.values.iter().enumerate().map(one).collect();
    all.push(Unknown::linear(UnknownId::Nuisance("Ry_bias_rad"), "Ry_bias_rad", at, Freedom::Free(0)));
    Unknowns::from(all)
}

/// Records of a flight and of its first 19 samples.
fn records(plant: &Plant) -> [Record; 2] {
    let record = flown(plant, 0).record(plant, &Shown::default());
    let mut short = record.clone();
    let series = short.position_m.iter_mut().chain(&mut short.attitude_rad);
    series.chain([&mut short.t_s, &mut short.vw_m_s, &mut short.ps_pa, &mut short.ts_k]).for_each(|x| x.truncate(19));
    [record, short]
}

fn ready<'a>(records: &'a [Record; 2], plant: &'a Plant) -> [PreparedRun<'a>; 2] {
    records.each_ref().map(|r| PreparedRun::new("", r, plant).expect("it can be integrated"))
}

/// Nodes of the flight itself, every five samples.
fn nominals(plant: &Plant) -> Vec<Nominal> {
    let flight = flown(plant, 0);
    [SAMPLES, 19].map(|n| Nominal { nodes: (0..n).step_by(5).map(|i| flight.node(i)).collect() }).to_vec()
}

/// Where only a linear error `e` is wrong, a part f of its step leaves a merit of `D (1 - f)²`, `D = N e²/s²`. It must not grow by
/// more than one: of 6 and its halves, 1.5 lowers a large D; of D = 0.2, 3 makes 0.8, and of D = 0.5, 2.0. Before it a flight's
/// gaps, below 0.1.
#[test]
fn exact_descent_on_a_parabola() {
    let plant = erring();
    let records = records(&plant);
    let runs = ready(&records, &plant);
    let (off, count) = (0.01, (SAMPLES + 19) as f64);
    for (d, whole, expected) in [(4e5, 6.0, 1.5), (4e5, 0.7, 0.7), (0.2, 3.0, 3.0), (0.5, 3.0, 1.5)] {
        let std = [off * (count / d).sqrt(); CHANNELS];
        let mut search =
            Search { runs: &runs, unknowns: error(&plant, off), nominals: nominals(&plant), std, work: Transition::default() };
        let misfits = search.misfits(&search.unknowns.clone(), &search.nominals.clone()).expect("flies");
        let linear = search.linearise().expect("flies");
        let normal = Normal::new(&linear, &search.unknowns).expect("determined");
        let (after, fraction) = search.descend(&linear, &normal, &misfits, whole).expect("goes down");
        assert!((fraction - expected).abs() < 1e-15, "{d} {whole}: {fraction}");
        // The step's own error: the flight's, 1e-8 rad, times what the two cannot tell apart.
        let left = search.unknowns.values()[0] / off;
        assert!((left - (1.0 - expected)).abs() < 1e-3, "{d} {whole}: {left}");
        let merit = search.merit(&after, &search.unknowns);
        assert!((merit - d * (1.0 - expected).powi(2)).abs() < 0.1 + 0.01 * d, "{d} {whole}: {merit}");
    }
}

/// Steps of 0.8, 0.24, 0.072 shrink by 0.3: `0.072 × 0.3/0.7` is left. Nothing is taken to shrink after a short part of a step, or
/// slower than by halves.
#[test]
fn exact_what_is_left_is_a_geometric_series() {
    assert!((left(0.072, 0.24, 1.0) - 0.072 * 3.0 / 7.0).abs() < 1e-16);
    for (before_last, fraction) in [(0.24, 0.5), (0.13, 1.0), (0.0, 1.0)] {
        assert!((left(0.072, before_last, fraction) - 0.072).abs() < 1e-16);
    }
}

/// Twice the logarithm of normal densities of all residuals, with 2π left out, less what gaps, jumps and a prior take; and the
/// noise that these residuals show, in angles and positions less two numbers a run.
#[test]
fn exact_likelihood_and_noise_by_hand() {
    let plant = erring();
    let records = records(&plant);
    let runs = ready(&records, &plant);
    let mut unknowns = error(&plant, 0.01);
    unknowns.know(plant.aero.values.len(), 0.016, 0.004);
    let residual = |run: usize, c: usize, i: usize| STD[c] * (1.0 + ((7 * run + 5 * c + 3 * i * i) as f64).sin());
    let misfit = |run: usize, n: usize, gaps: f64, jumps: f64| Misfit {
        residuals: std::array::from_fn(|c| (0..n).map(|i| residual(run, c, i)).collect()),
        gaps,
        jumps,
    };
    let misfits = vec![misfit(0, 5, 0.7, 1.9), misfit(1, 4, 2.3, 0.4)];
    let mut search = Search { runs: &runs, unknowns, nominals: nominals(&plant), std: STD, work: Transition::default() };
    search.update_noise(&misfits);
    let mut likelihood = 9.0 * CHANNELS as f64 * std::f64::consts::TAU.ln();
    for (c, found) in search.std.into_iter().enumerate() {
        let all: Vec<f64> = (0..5).map(|i| residual(0, c, i)).chain((0..4).map(|i| residual(1, c, i))).collect();
        let expected = (all.iter().map(|r| r * r).sum::<f64>() / if c < 6 { 5.0 } else { 9.0 }).sqrt();
        assert!((found / expected - 1.0).abs() < 1e-14, "{c}: {found} {expected}");
        let density = Gaussian::new(0.0, found).expect("positive");
        likelihood += 2.0 * all.iter().map(|r| density.ln_pdf(*r)).sum::<f64>();
    }
    // A prior 1.5 of its standard deviations away.
    likelihood -= 0.7 + 1.9 + 2.3 + 0.4 + 2.25;
    let linear = search.linearise().expect("flies");
    let normal = Normal::new(&linear, &search.unknowns).expect("determined");
    let Outcome::Solved(solved) = search.finish(&normal, DMatrix::default(), misfits, 3, StopReason::Converged) else {
        panic!("it flies")
    };
    assert!((solved.solution.log_likelihood2 - likelihood).abs() < 1e-10, "{} {likelihood}", solved.solution.log_likelihood2);
    assert_eq!((solved.solution.iterations, solved.linear.len(), solved.residuals[1][3].len()), (3, 2, 4));
}

/// An error of R_y in records with noise, found from zero: within four standard errors, where no step is left (a thousandth of a
/// standard error, and a little for the noise's variance, which ends as it is).
#[test]
fn recover_an_error_of_an_angle() {
    let plant = erring();
    let mut records = records(&plant);
    for (n, record) in records.iter_mut().enumerate() {
        record.attitude_rad[1].iter_mut().for_each(|ry| *ry += 0.05);
        let series = record.position_m.iter_mut().chain(&mut record.attitude_rad).chain([&mut record.vw_m_s]);
        for (c, x) in series.enumerate() {
            x.iter_mut().enumerate().for_each(|(i, x)| *x += STD[c] * ((5 * n + 11 * c + 7 * i * i) as f64).sin());
        }
    }
    let runs = ready(&records, &plant);
    let unknowns = error(&plant, 0.0);
    let Outcome::Solved(solved) = solve(&runs, unknowns, runs.iter().map(|r| r.smoothed.clone()).collect(), 30) else {
        panic!("an answer")
    };
    let s = &solved.solution;
    assert_eq!(s.stop, StopReason::Converged);
    let std_error = s.covariance[(0, 0)].sqrt();
    assert!(((s.estimates[0] - 0.05) / std_error).abs() < 4.0, "{:?} {std_error}", s.estimates);
    let glance = one_step(&runs, &solved.unknowns, &solved.nominals, &s.noise_std).expect("flies").expect("determined");
    assert!(glance.step[0].abs() < 2e-3 * std_error, "{} {std_error}", glance.step[0]);
}

/// A merit too large for a number cannot be lowered: no answer, but where a step is shorter than 0.03 standard errors, for which
/// rounding is to blame.
#[test]
fn law_no_descent_is_no_answer() {
    let plant = erring();
    let records = records(&plant);
    let mut runs = ready(&records, &plant);
    let mut wild = records[1].clone();
    wild.position_m[0][7] = 1.5e154;
    runs[1].record = &wild;
    let mut std = STD;
    std[0] = 1e153;
    let start = error(&plant, 0.0);
    let Some(Ok(glance)) = one_step(&runs, &start, &nominals(&plant), &std) else { panic!("it flies and is determined") };
    let (zero, std_error) = (glance.step[0], glance.covariance[(0, 0)].sqrt());
    for (off, answer) in [(0.02, true), (0.04, false), (50.0, false)] {
        // The step leads back to `zero`.
        let found = solve_from(&runs, error(&plant, zero + off * std_error), nominals(&plant), std, 5);
        match found {
            Outcome::Solved(s) => assert!(answer && s.solution.stop == StopReason::Converged, "{off}: {:?}", s.solution.stop),
            Outcome::Stopped(stop) => assert!(!answer && stop == StopReason::NoDescent, "{off}: {stop:?}"),
            Outcome::Undetermined { .. } => panic!("{off}: determined"),
        }
    }
}
