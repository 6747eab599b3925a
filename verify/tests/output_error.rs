//! verify tests: what output error promises, on campaigns of the simulator with known parameters: bias, scatter against the
//! Cramér-Rao bound, coverage of its intervals. The long study writes docs/studies/output-error.md.

use rayon::prelude::*;
use std::fmt::Write as _;
use windfall_model::{Campaign, Data, Run, Scenario, Use};
use windfall_pid::DataSet;
use windfall_pid::output_error::{self, Options};
use windfall_scenarios::read_bundled;
use windfall_sim::{Seed, fly};

/// The lander of Table 5.5 with its two perturbed runs (15 and 12 s) and its unperturbed one (40 s), sensor noise of Table A.3.
fn scenario() -> Scenario {
    let mut scenario = read_bundled("sage-combined").expect("bundled").scenario;
    scenario.flights.truncate(3);
    scenario
}

/// Campaign number `draw`: own noise, own hand at the throttle. The declared model starts `factor` times off.
fn campaign(scenario: &Scenario, draw: u64, factor: f64) -> Campaign {
    let mut plant = scenario.plant.clone();
    plant.aero.values.iter_mut().for_each(|v| *v *= factor);
    plant.turbulence = windfall_model::Turbulence::default();
    let run = |(i, flight): (usize, &windfall_model::Flight)| Run {
        name: flight.name.clone(),
        kind: flight.kind.clone(),
        used: Use::Identify,
        inputs: Vec::new(),
        data: Data::Tunnel(fly(&scenario.plant, flight, Seed { campaign: 7_000 + draw, run: i as u64 }).expect("flies").record),
        notes: Vec::new(),
    };
    Campaign {
        name: format!("draw {draw}"),
        declared: vec![true; plant.aero.values.len()],
        plant,
        inputs: Vec::new(),
        runs: scenario.flights.iter().enumerate().map(run).collect(),
    }
}

fn combined(campaign: &Campaign) -> DataSet {
    let options = Options { combined_only: true, ..Options::default() };
    let found = output_error::identify(campaign, &options).expect("converges");
    found.data_set("combined").expect("there is one").clone()
}

/// One parameter over all draws.
struct Line {
    name: String,
    truth: f64,
    /// Mean error over the root mean square of the stated standard errors.
    bias: f64,
    /// Standard deviation of the estimates over the same.
    scatter: f64,
    covered: usize,
    std_error: f64,
}

/// Each parameter once, over data sets of independent draws.
fn lines(scenario: &Scenario, sets: &[DataSet]) -> Vec<Line> {
    let structure = &scenario.plant.aero.structure;
    let n = sets.len() as f64;
    let one = |(name, &truth): (&String, &f64)| {
        let found: Vec<_> = sets.iter().filter_map(|d| d.parameters.iter().find(|p| p.name == *name)).collect();
        assert_eq!(found.len(), sets.len(), "{name} in every draw");
        let std_error = (found.iter().map(|p| p.std_error.powi(2)).sum::<f64>() / n).sqrt();
        let mean = found.iter().map(|p| p.estimate - truth).sum::<f64>() / n;
        let variance = found.iter().map(|p| (p.estimate - truth - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Line {
            name: name.clone(),
            truth,
            bias: mean / std_error,
            scatter: variance.sqrt() / std_error,
            covered: found.iter().filter(|p| p.ci95[0] <= truth && truth <= p.ci95[1]).count(),
            std_error,
        }
    };
    structure.parameters.iter().zip(&scenario.plant.aero.values).map(one).collect()
}

fn table(lines: &[Line], draws: usize) -> String {
    let mut text = String::from(
        "| parameter | truth | standard error | bias/σ | scatter/bound | 95 % interval covers |\n|---|---|---|---|---|---|\n",
    );
    for l in lines {
        let percent = 100.0 * l.covered as f64 / draws as f64;
        let _ = writeln!(
            text,
            "| {} | {} | {:.2e} | {:+.3} | {:.3} | {percent:.1} % |",
            l.name, l.truth, l.std_error, l.bias, l.scatter
        );
    }
    text
}

fn study(draws: u64) -> Vec<Line> {
    let scenario = scenario();
    let sets: Vec<DataSet> = (0..draws).into_par_iter().map(|d| combined(&campaign(&scenario, d, 1.2))).collect();
    lines(&scenario, &sets)
}

/// 40 campaigns. A mean of 40 scatters by 0.158 σ and a ratio by 11.3 %; of 11 parameters the largest of 11 stays within 3.4
/// of these standard deviations in 99.3 % of such studies (this one is the same every time). All 440 intervals together cover
/// 95 % within 3.4 × 1.5 %, were parameters independent: some are not, so 6 % are allowed.
#[test]
fn recover_output_error_is_unbiased_and_as_scattered_as_it_says() {
    let draws = 40;
    let lines = study(draws);
    eprintln!("{}", table(&lines, 40));
    for l in &lines {
        assert!(l.bias.abs() < 3.4 * 0.158, "{}: bias {}", l.name, l.bias);
        assert!((l.scatter - 1.0).abs() < 3.4 * 0.113, "{}: scatter {}", l.name, l.scatter);
    }
    let covered: usize = lines.iter().map(|l| l.covered).sum();
    let share = covered as f64 / (draws as usize * lines.len()) as f64;
    assert!((share - 0.95).abs() < 0.06, "intervals cover {share}");
}

/// The long study: `WINDFALL_DRAWS=500 cargo test -p windfall-verify --test output_error -- --ignored study`.
#[test]
#[ignore = "slow: a second of processor time a campaign"]
fn study_of_output_error() {
    let draws = std::env::var("WINDFALL_DRAWS").ok().and_then(|d| d.parse().ok()).unwrap_or(60);
    let lines = study(draws);
    println!("{draws} campaigns\n\n{}", table(&lines, usize::try_from(draws).expect("few")));
    let covered = lines.iter().all(|l| l.covered > 0);
    assert!(covered, "some interval never covers");
}
