//! replay tests: intervals of equation error and of the thesis' method on each data set: unperturbed, perturbed, combined; in still air and in
//! gusts. Runs as the tunnel has them: the lander hovers, a pole pushes it over, and the window begins where the pole has left. The long
//! study writes the tables of docs/studies/identification.md.

use rayon::prelude::*;
use std::fmt::Write as _;
use windfall_model::frames::Vec3;
use windfall_model::{Campaign, Contact, Flight, Record, Release, Scenario, Turbulence};
use windfall_pid::{Estimate, Identification, Method, identify};
use windfall_replay::campaign_of;
use windfall_scenarios::read_bundled;
use windfall_sim::{Seed, fly};

/// Hover before the push, s, the push, and what the record has after the window.
const LEAD_S: f64 = 5.0;
const PUSH_S: f64 = 0.6;
const TAIL_S: f64 = 2.0;
/// Turning that each push gives, N m s about y and z: to 30° and more.
const PUSHES: [[f64; 2]; 2] = [[0.07, 0.03], [-0.04, 0.07]];
const DATA_SETS: [&str; 3] = ["unperturbed", "perturbed", "combined"];

/// The lander of Table 5.5 with two pushed runs (windows of 15 and 12 s) and one that is left alone (40 s), gusts of so many m/s.
fn scenario(gusts_m_s: f64) -> Scenario {
    let mut s = read_bundled("sage-combined").expect("bundled").scenario;
    s.flights.truncate(3);
    s.plant.turbulence = Turbulence {
        axial_rms_m_s: gusts_m_s,
        lateral_rms_m_s: gusts_m_s,
        axial_scale_m: 0.6,
        lateral_scale_m: 0.6,
        bandwidth: 0.0,
    };
    let hover = s.flights[2].release;
    for (run, flight) in s.flights.iter_mut().enumerate() {
        flight.release = Release { attitude_rad: hover.attitude_rad, ..hover };
        flight.duration_s += LEAD_S + PUSH_S + TAIL_S;
        flight.section = None;
        if let Some([y, z]) = PUSHES.get(run) {
            s.plant.contacts.push(Contact {
                run,
                start_s: LEAD_S,
                duration_s: PUSH_S,
                impulse: Vec3::zero(),
                angular_impulse: Vec3::new(0.0, *y, *z),
            });
        }
    }
    s
}

fn campaign(s: &Scenario, seed: u64) -> Campaign {
    let one = |(run, flight): (usize, &Flight)| {
        let whole = fly(&s.plant.for_run(run, &[]), flight, Seed { campaign: seed, run: run as u64 }).expect("flies").record;
        let row = |t_s: f64| whole.t_s.partition_point(|t| *t < t_s - 1e-9);
        let rows = row(LEAD_S + PUSH_S)..row(flight.duration_s - TAIL_S);
        whole.window(rows)
    };
    let records: Vec<(&Flight, Record)> = s.flights.iter().enumerate().map(|(i, f)| (f, one((i, f)))).collect();
    let mut plant = s.plant.clone();
    plant.turbulence = Turbulence::default();
    plant.contacts.clear();
    campaign_of(&plant, &records)
}

fn draws(s: &Scenario, method: Method, seeds: std::ops::Range<u64>) -> Vec<Identification> {
    seeds.into_par_iter().map(|seed| identify(&campaign(s, seed), method).expect("identifies")).collect()
}

/// One parameter of one data set over all draws.
struct Line {
    label: String,
    truth: f64,
    /// Of the draws in which it was estimated.
    found: Vec<Estimate>,
    refused: usize,
}

impl Line {
    fn covered(&self) -> usize {
        self.found.iter().filter(|p| p.ci95[0] <= self.truth && self.truth <= p.ci95[1]).count()
    }
    fn off_percent(&self) -> f64 {
        let mean = self.found.iter().map(|p| p.estimate).sum::<f64>() / self.found.len() as f64;
        100.0 * (mean / self.truth - 1.0)
    }
    fn error_percent(&self) -> f64 {
        let mut all: Vec<f64> = self.found.iter().map(|p| p.std_error).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).map_or(f64::NAN, |e| 100.0 * e / self.truth.abs())
    }
    fn cells(&self) -> String {
        match self.found.len() {
            0 => format!("refused {} of {}", self.refused, self.refused),
            n => format!(
                "{} of {n}{}, off {:+.2} %, σ {:.2} %",
                self.covered(),
                if self.refused > 0 { format!(" (refused {})", self.refused) } else { String::new() },
                self.off_percent(),
                self.error_percent()
            ),
        }
    }
}

fn lines(s: &Scenario, all: &[Identification], data_set: &str) -> Vec<Line> {
    let structure = &s.plant.aero;
    let mut keys: Vec<(String, String)> = Vec::new();
    let sets: Vec<_> = all.iter().map(|i| i.data_set(data_set).expect("every kind")).collect();
    for set in &sets {
        let found = set.parameters.iter().map(|p| (p.coefficient.clone(), p.name.clone()));
        for key in found.chain(set.refused.iter().map(|r| (r.coefficient.clone(), r.name.clone()))) {
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
    }
    let place =
        |(c, n): &(String, String)| (["CA", "CN", "Cl", "Cm", "Cn"].iter().position(|x| x == c), structure.structure.index(n));
    keys.sort_by_key(place);
    let one = |(c, n): (String, String)| Line {
        truth: structure.value(&n).expect("a parameter"),
        found: sets.iter().filter_map(|d| d.get(&c, &n).cloned()).collect(),
        refused: sets.iter().filter(|d| d.refused.iter().any(|r| r.coefficient == c && r.name == n)).count(),
        label: if c == "Cn" && n.starts_with("Cm") { format!("{n} (from Cn)") } else { n },
    };
    keys.into_iter().map(one).collect()
}

/// Fewest of `n` intervals of 95 % that hold the truth in all but one of ten thousand studies.
fn fewest(n: usize) -> usize {
    let mut below = 0.0;
    for k in 0..=n {
        let ways: f64 = (0..k).map(|i| (n - i) as f64 / (k - i) as f64).product();
        below += ways * 0.95_f64.powi(k as i32) * 0.05_f64.powi((n - k) as i32);
        if below > 1e-4 {
            return k;
        }
    }
    n
}

/// Every parameter of every data set, in still air and in gusts: as many intervals hold the truth as 95 % make likely, or it is refused.
/// Regressors taken as exact, C_N,sin of the unperturbed run is in none of them.
#[test]
fn recover_equation_error_covers_in_every_data_set() {
    for gusts in [0.0, 0.1] {
        let s = scenario(gusts);
        let all = draws(&s, Method::EquationError, 500..508);
        for data_set in DATA_SETS {
            let (mut covered, mut intervals) = (0, 0);
            for line in lines(&s, &all, data_set) {
                let n = line.found.len();
                let fewest = fewest(n);
                assert!(
                    line.covered() >= fewest,
                    "gusts {gusts}, {data_set}, {}: {}, at least {fewest}",
                    line.label,
                    line.cells()
                );
                covered += line.covered();
                intervals += n;
            }
            // Thirteen correlated intervals of a draw count as a fourth of their number.
            assert!(covered >= 4 * fewest(intervals / 4), "gusts {gusts}, {data_set}: {covered} of {intervals}");
        }
        if gusts == 0.0 {
            let set = all[0].of_all_runs().expect("all runs");
            assert_eq!((set.parameters.len(), set.refused.len()), (13, 0), "{:?}", set.refused);
        }
    }
}

/// `WINDFALL_DRAWS=40 cargo test -p windfall-replay --test it -- --ignored --nocapture study_of_data_sets`
#[test]
#[ignore = "slow: a second of processor time a campaign"]
fn study_of_data_sets() {
    let n: u64 = std::env::var("WINDFALL_DRAWS").ok().and_then(|d| d.parse().ok()).unwrap_or(40);
    let mut text = String::new();
    for gusts in [0.0, 0.1] {
        let s = scenario(gusts);
        let [own, thesis] = [Method::EquationError, Method::Thesis].map(|m| draws(&s, m, 500..500 + n));
        for data_set in DATA_SETS {
            let _ = writeln!(text, "\n### {data_set}, gusts of {gusts} m/s, {n} campaigns\n");
            let _ = writeln!(
                text,
                "| parameter | truth | equation error: 95 % covers | thesis' method: 95 % covers |\n|---|---|---|---|"
            );
            for (a, b) in lines(&s, &own, data_set).iter().zip(lines(&s, &thesis, data_set)) {
                let _ = writeln!(text, "| {} | {} | {} | {} |", a.label, a.truth, a.cells(), b.cells());
            }
        }
    }
    eprintln!("{text}");
}
