//! replay tests: what output error and filter error promise, on campaigns of the simulator with known parameters: bias, scatter
//! against the Cramér-Rao bound, coverage of their intervals; beside them equation error and the thesis' method on the same data.
//! The long studies write the tables of docs/studies/identification.md.

#![expect(clippy::print_stdout, reason = "a study prints its table")]

use rayon::prelude::*;
use std::fmt::Write as _;
use windfall_model::{Campaign, Flight, Record, Scenario, Turbulence};
use windfall_pid::output_error::{EstimateOptions, Handling, Prior};
use windfall_pid::{DataSet, Estimate, Method, PidError, identify_by, output_error};
use windfall_replay::{bootstrap, campaign_of, resimulate_with_draws};
use windfall_scenarios::read_bundled;
use windfall_sim::{Seed, fly};

/// Gusts of the study: 0.1 m/s along and across the stream, three diameters long.
const GUSTS: Turbulence =
    Turbulence { axial_rms_m_s: 0.1, lateral_rms_m_s: 0.1, axial_scale_m: 0.6, lateral_scale_m: 0.6, bandwidth: 0.0 };
/// By how much declared values are off: where a search starts.
const OFF: f64 = 1.2;

/// An integrated method under study, and the turbulence it is meant for.
#[derive(Clone, Copy)]
struct Study {
    method: Method,
    turbulence: Turbulence,
    seed: u64,
}

const OUTPUT_ERROR: Study = Study {
    method: Method::OutputError,
    turbulence: Turbulence { axial_rms_m_s: 0.0, lateral_rms_m_s: 0.0, axial_scale_m: 0.6, lateral_scale_m: 0.6, bandwidth: 0.0 },
    seed: 7_000,
};
const FILTER_ERROR: Study = Study { method: Method::FilterError, turbulence: GUSTS, seed: 9_000 };

/// The lander of Table 5.5 with two perturbed runs (15 and 12 s) and an unperturbed one (40 s), sensor noise of Table A.3.
fn scenario(study: Study) -> Scenario {
    let mut scenario = read_bundled("sage-combined").expect("bundled").scenario;
    scenario.flights.truncate(3);
    scenario.plant.turbulence = study.turbulence;
    scenario
}

/// Campaign number `draw`: own noise, own hand at the throttle. The declared model starts `factor` times off.
fn campaign(scenario: &Scenario, seed: u64, factor: f64) -> Campaign {
    let mut plant = scenario.plant.clone();
    plant.aero.values.iter_mut().for_each(|v| *v *= factor);
    plant.turbulence = Turbulence::default();
    let one = |(i, flight)| (flight, fly(&scenario.plant, flight, Seed { campaign: seed, run: i as u64 }).expect("flies").record);
    let records: Vec<(&Flight, Record)> = scenario.flights.iter().enumerate().map(one).collect();
    let flown = campaign_of(&plant, &records);
    Campaign { name: format!("seed {seed}"), plant, ..flown }
}

fn combined(campaign: &Campaign, method: Method) -> Result<DataSet, PidError> {
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    let found = identify_by(campaign, method, &options)?;
    Ok(found.data_set("combined").expect("there is one").clone())
}

fn truth(scenario: &Scenario, name: &str) -> f64 {
    let t = &scenario.plant.turbulence;
    match name {
        "axial_rms_m_s" => t.axial_rms_m_s,
        "lateral_rms_m_s" => t.lateral_rms_m_s,
        "axial_scale_m" => t.axial_scale_m,
        "lateral_scale_m" => t.lateral_scale_m,
        other => scenario.plant.aero.value(other).expect("a parameter of the structure"),
    }
}

/// One parameter over all draws: bias and scatter over the root mean square of its standard errors, share of intervals that cover.
#[derive(Debug)]
struct Line {
    std_error: f64,
    bias: f64,
    scatter: f64,
    covered: f64,
    /// The same by standard errors for white residuals.
    covered_white: f64,
}

fn line(truth: f64, sets: &[DataSet], name: &str) -> Option<Line> {
    let found: Vec<&Estimate> = sets.iter().filter_map(|d| d.parameters.iter().find(|p| p.name == name)).collect();
    if found.len() < 2 {
        return None;
    }
    let n = found.len() as f64;
    let std_error = (found.iter().map(|p| p.std_error.powi(2)).sum::<f64>() / n).sqrt();
    let mean = found.iter().map(|p| p.estimate - truth).sum::<f64>() / n;
    let variance = found.iter().map(|p| (p.estimate - truth - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let share = |covers: &dyn Fn(&Estimate) -> bool| found.iter().filter(|p| covers(p)).count() as f64 / n;
    Some(Line {
        std_error,
        bias: mean / std_error,
        scatter: variance.sqrt() / std_error,
        covered: share(&|p| p.ci95[0] <= truth && truth <= p.ci95[1]),
        covered_white: share(&|p| (p.estimate - truth).abs() <= 1.96 * p.std_error_white),
    })
}

/// Results of a study so far: the method's own, equation error, the thesis' method.
struct Results {
    scenario: Scenario,
    own: Vec<DataSet>,
    regressed: Vec<DataSet>,
    thesis: Vec<DataSet>,
    failed: Vec<String>,
}

impl Results {
    fn new(study: Study) -> Self {
        Self { scenario: scenario(study), own: Vec::new(), regressed: Vec::new(), thesis: Vec::new(), failed: Vec::new() }
    }
    /// Adds these draws; `beside`: the other methods too.
    fn add(&mut self, study: Study, draws: std::ops::Range<u64>, beside: bool) {
        let one = |draw: u64| {
            let campaign = campaign(&self.scenario, study.seed + draw, OFF);
            let other = |m| if beside { combined(&campaign, m).ok() } else { None };
            (combined(&campaign, study.method), other(Method::EquationError), other(Method::Thesis))
        };
        let all: Vec<_> = draws.into_par_iter().map(one).collect();
        for (own, regressed, thesis) in all {
            match own {
                Ok(set) => self.own.push(set),
                Err(e) => self.failed.push(e.to_string()),
            }
            self.regressed.extend(regressed);
            self.thesis.extend(thesis);
        }
    }
    fn lines<'s>(&'s self, sets: &'s [DataSet]) -> impl Iterator<Item = (&'s str, Line)> {
        let names = self.scenario.plant.aero.structure.parameters.iter().map(String::as_str);
        let gusts = ["axial_rms_m_s", "lateral_rms_m_s", "axial_scale_m", "lateral_scale_m"];
        names.chain(gusts).filter_map(move |n| Some((n, line(truth(&self.scenario, n), sets, n)?)))
    }
    fn table(&self) -> String {
        let mut text = format!(
            "{} campaigns; without an answer: {}\n\n| parameter | truth | standard error | scatter/bound | bias/σ | 95 % covers | \
             equation error: scatter/σ, bias/σ, covers (white) | thesis: the same |\n|---|---|---|---|---|---|---|---|\n",
            self.own.len() + self.failed.len(),
            self.failed.len()
        );
        for (name, l) in self.lines(&self.own) {
            let t = truth(&self.scenario, name);
            let other = |sets: &[DataSet]| {
                line(t, sets, name).map_or(String::from("–"), |l| {
                    format!("{:.2}, {:+.2}, {:.0} % ({:.0} %)", l.scatter, l.bias, 100.0 * l.covered, 100.0 * l.covered_white)
                })
            };
            let _ = writeln!(
                text,
                "| {name} | {t} | {:.2e} | {:.3} | {:+.3} | {:.1} % | {} | {} |",
                l.std_error,
                l.scatter,
                l.bias,
                100.0 * l.covered,
                other(&self.regressed),
                other(&self.thesis)
            );
        }
        text
    }
}

/// Bounds from the study's own size: a mean of n scatters by 1/√n standard errors, a ratio of standard deviations by 1/√(2n); the
/// largest of `m` such numbers stays within 3.5 of these in 99 % of studies with m up to 20. Intervals of one draw are correlated:
/// all of them together count as the draws times the fourth part of the parameters. Gusts are asked for within a tenth: the
/// simulator's are smooth within 5 ms, the filter's are not.
fn assert_honest(results: &Results) {
    assert!(results.failed.is_empty(), "{:?}", results.failed);
    let n = results.own.len() as f64;
    let (mut covered, mut m) = (0.0, 0.0);
    for (name, l) in results.lines(&results.own) {
        if name.ends_with("_m_s") || name.ends_with("_m") {
            let off = l.bias * l.std_error / truth(&results.scenario, name);
            assert!(off.abs() < 0.1, "{name}: off by {off}");
            continue;
        }
        assert!(l.bias.abs() < 3.5 / n.sqrt(), "{name}: bias {}", l.bias);
        assert!((l.scatter - 1.0).abs() < 3.5 / (2.0 * n).sqrt(), "{name}: scatter {}", l.scatter);
        covered += l.covered;
        m += 1.0;
    }
    let bound = 3.5 * (0.95 * 0.05 / (n * m / 4.0)).sqrt();
    assert!((covered / m - 0.95).abs() < bound, "intervals cover {}, bound {bound}", covered / m);
}

#[test]
fn recover_output_error_is_unbiased_and_as_scattered_as_it_says() {
    let mut results = Results::new(OUTPUT_ERROR);
    results.add(OUTPUT_ERROR, 0..20, false);
    assert_honest(&results);
}

#[test]
fn recover_filter_error_is_unbiased_and_as_scattered_as_it_says() {
    let mut results = Results::new(FILTER_ERROR);
    results.add(FILTER_ERROR, 0..6, false);
    assert_honest(&results);
}

/// Declared values twice and half the truth lead to one optimum: the search ends within a thousandth of a standard error, twice that is
/// allowed and as much for the smoothness at which likelihoods of 1e4 samples are compared.
#[test]
fn law_starting_values_off_by_two_lead_to_the_same_optimum() {
    let scenario = scenario(OUTPUT_ERROR);
    let from = |factor| combined(&campaign(&scenario, OUTPUT_ERROR.seed, factor), Method::OutputError).expect("converges");
    let (high, low) = (from(2.0), from(0.5));
    for (a, b) in high.parameters.iter().zip(&low.parameters) {
        let apart = (a.estimate - b.estimate).abs() / a.std_error;
        assert!(apart < 4e-3, "{}: {apart} standard errors apart", a.name);
    }
}

/// Draws of a long study, in portions so that what there is can be read before the end.
fn long(study: Study) {
    let draws: u64 = std::env::var("WINDFALL_DRAWS").ok().and_then(|d| d.parse().ok()).unwrap_or(500);
    let mut results = Results::new(study);
    for from in (0..draws).step_by(20) {
        results.add(study, from..draws.min(from + 20), true);
        eprintln!("{}", results.table());
    }
    eprintln!("{}", results.table());
    for failure in &results.failed {
        eprintln!("{failure}");
    }
    assert_honest(&results);
}

/// `WINDFALL_DRAWS=500 cargo test -p windfall-replay --test it -- --ignored --nocapture study_of_output_error`
#[test]
#[ignore = "slow: two seconds of processor time a campaign"]
fn study_of_output_error() {
    long(OUTPUT_ERROR);
}

/// `WINDFALL_DRAWS=500 cargo test -p windfall-replay --test it -- --ignored --nocapture study_of_filter_error`
#[test]
#[ignore = "slow: ten seconds of processor time a campaign"]
fn study_of_filter_error() {
    long(FILTER_ERROR);
}

/// Copies of an identified campaign scatter as the stated errors say: a ratio within 3.5/√(2(n − 1)), eleven of them counted as a fourth
/// part of their number because they are correlated.
#[test]
fn recover_stated_errors_by_bootstrap() {
    let scenario = scenario(OUTPUT_ERROR);
    let campaign = campaign(&scenario, 7_777, 1.0);
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    let found = output_error::identify(&campaign, &options).expect("identifies");
    let copies = bootstrap(&campaign, &found, Method::OutputError, &options, 16).expect("copies fly");
    assert!(copies.failed.is_empty(), "{:?}", copies.failed);
    let n = copies.parameters.len() as f64;
    let mean = copies.parameters.iter().map(|p| p.ratio).sum::<f64>() / n;
    assert!((mean - 1.0).abs() < 3.5 * copies.ratio_std_error / (n / 4.0).sqrt(), "{mean}: {:?}", copies.parameters);
}

/// Copies are identified with the campaign's ties and priors. A prior twenty times as narrow as the data is nearly all that is known of
/// its parameter: the copies' estimates of it scatter by it, or by nothing were it the same in all. Eight copies: within 3.5/√14.
#[test]
fn recover_copies_have_the_campaigns_ties_and_priors() {
    let scenario = scenario(OUTPUT_ERROR);
    let campaign = campaign(&scenario, 7_778, 1.0);
    let options = EstimateOptions {
        combined_only: true,
        handling: vec![("Cn_2".to_owned(), Handling::Tied { to: "Cm_2".to_owned() })],
        priors: vec![Prior { name: "Cl_p".to_owned(), mean: -5.6816, std: 0.001 }],
        ..EstimateOptions::default()
    };
    let found = output_error::identify(&campaign, &options).expect("identifies");
    let copies = bootstrap(&campaign, &found, Method::OutputError, &options, 8).expect("copies fly");
    assert!(copies.failed.is_empty(), "{:?}", copies.failed);
    let of = |name: &str| copies.parameters.iter().find(|p| p.name == name).expect("is estimated");
    let prior = of("Cl_p");
    assert!((prior.scatter / 0.001 - 1.0).abs() < 3.5 * copies.ratio_std_error, "{prior:?}");
    let bits = |name: &str| [of(name).scatter, of(name).flown].map(f64::to_bits);
    assert!(of("Cm_2").scatter > 0.0);
    assert_eq!(bits("Cm_2"), bits("Cn_2"));
}

/// Bands on flights of known parameters, over two campaigns of three runs: pointwise 95 % hold the noise-free flight. Samples of a run go
/// together: taken for six numbers a run, the share scatters by √(0.0475/36); 3.5 of these are allowed.
#[test]
fn recover_the_flight_inside_its_bands() {
    let scenario = scenario(OUTPUT_ERROR);
    let (mut inside, mut all) = (0.0, 0.0);
    for seed in 8_000..8_002 {
        let campaign = campaign(&scenario, seed, 1.0);
        let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
        let found = output_error::identify(&campaign, &options).expect("identifies");
        let flown = resimulate_with_draws(&campaign, &found, 1, 40).expect("flies");
        for (i, run) in flown.runs.iter().enumerate() {
            let exact = Flight { sensor_noise: false, ..scenario.flights[i].clone() };
            let truth = fly(&scenario.plant, &exact, Seed { campaign: seed, run: i as u64 }).expect("flies").record;
            let band = &run.bands[0];
            let every = (band.t_s[1] * exact.rate_hz).round() as usize;
            for (k, (low, high)) in band.low.iter().zip(&band.high).enumerate() {
                let [ry, rz] = [truth.attitude_rad[1][k * every], truth.attitude_rad[2][k * every]];
                let theta_deg = (ry.cos() * rz.cos()).acos().to_degrees();
                assert!(low < high, "a band has a width");
                inside += f64::from(u8::from(*low <= theta_deg && theta_deg <= *high));
                all += 1.0;
            }
        }
    }
    println!("{inside} of {all} inside");
    assert!(inside / all > 0.95 - 3.5 * (0.0475_f64 / 36.0).sqrt(), "{inside} of {all}");
}
