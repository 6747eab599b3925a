//! discover bench: time of a search over the whole catalogue on one thread, and the largest memory of the process, with 67 s of the bundled
//! `sage-combined` flown once, four and sixteen times over, each time with noise of its own: with nothing undeclared, with an effect, in gusts.
//! `cargo bench -p windfall-discover --bench search`
use std::time::Instant;
use windfall_likelihood::{Engine, discover};
use windfall_model::{CATALOGUE, Campaign, Record, Use};
use windfall_replay::campaign_of;
use windfall_sim::{Seed, fly};

/// Runs of the scenario that make 67 s.
const RUNS: usize = 3;

/// A family of the catalogue and the values of its parameters.
type Undeclared<'a> = (&'a str, &'a [f64]);

fn flown(undeclared: Option<Undeclared<'_>>, times: usize) -> Option<Campaign> {
    let scenario = windfall_scenarios::read_bundled("sage-combined").ok()?.scenario;
    let flights: Vec<_> = scenario.flights.iter().take(RUNS).cycle().take(RUNS * times).collect();
    let mut plant = scenario.plant.clone();
    if let Some((family, values)) = undeclared {
        (CATALOGUE.iter().find(|e| e.family == family)?.apply)(&mut plant, values);
    }
    let one = |(k, flight)| fly(&plant, flight, Seed { campaign: 1, run: k as u64 }).ok().map(|f| f.record);
    let records: Vec<Record> = flights.iter().copied().enumerate().map(one).collect::<Option<_>>()?;
    let pairs: Vec<_> = flights.into_iter().zip(records).collect();
    let mut campaign = campaign_of(&scenario.plant, &pairs);
    campaign.runs.iter_mut().for_each(|r| r.used = Use::Identify);
    Some(campaign)
}

/// Largest memory of the process so far, MB; nothing where the system does not say.
fn memory_mb() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|l| l.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kb| kb / 1024.0)
}

fn searched(campaign: &Campaign) -> (f64, String) {
    let began = Instant::now();
    let all: Vec<usize> = (0..campaign.runs.len()).collect();
    let found = Engine::new(campaign, &all).map(|mut engine| discover(&mut engine));
    let names = match found {
        Some(Ok(d)) => d.after.model.members.iter().map(|m| m.effect.family).collect::<Vec<_>>().join("+"),
        Some(Err(words)) => words,
        None => "no tunnel runs".to_owned(),
    };
    (began.elapsed().as_secs_f64(), names)
}

fn main() {
    let Ok(one) = rayon::ThreadPoolBuilder::new().num_threads(1).build() else { return };
    let cases: [(&str, Option<Undeclared<'_>>, &[usize]); 3] = [
        ("nothing undeclared", None, &[1, 4, 16]),
        ("center-of-mass", Some(("center-of-mass", &[0.0, 0.002, -0.003])), &[1, 4, 16]),
        ("turbulence", Some(("turbulence", &[0.1, 0.1, 0.6, 0.6, 0.0])), &[1, 4]),
    ];
    one.install(|| {
        for (name, undeclared, times) in cases {
            let mut first = None;
            for &n in times {
                let Some(campaign) = flown(undeclared, n) else { continue };
                let (seconds, names) = searched(&campaign);
                let of = seconds / *first.get_or_insert(seconds);
                let memory = memory_mb().map_or(String::new(), |m| format!(", {m:.0} MB at most so far"));
                eprintln!("{name}, {n} × 67 s: {seconds:.1} s ({of:.2} of the first) [{names}]{memory}");
            }
        }
    });
}
