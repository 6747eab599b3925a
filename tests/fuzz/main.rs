//! tests: results, requests and verbs on files that are nearly right, by the harness of `scenarios/tests/fuzz`. In: small results and orders,
//! changed by chance. Out: no panic, no end that is not reached, no memory beyond bounds.

#[path = "../../scenarios/tests/fuzz/harness.rs"]
mod harness;
#[path = "../../scenarios/tests/fuzz/mutate.rs"]
mod mutate;

use harness::{Reader, Total, Until, as_asked, run};
use mutate::Content::Text;
use std::path::Path;
use windfall::files::read_json;
use windfall::results::{Figure, Identification, SignalTracks, SmoothingTracks};
use windfall::{Campaign, Drawing, Fly, Resimulate, ResultsFolder, Scenario};

/// Samples that a changed scenario may order; more are legal and long.
const SAMPLES: f64 = 5000.0;
/// Longest flight and draw, s of the processor: stiff ones end at the integrator's own limit.
const SECONDS: f64 = 20.0;

/// Whether it was done; what it says otherwise is written out.
fn well<T>(result: Result<T, impl std::fmt::Display>) -> bool {
    result.map_err(|e| e.to_string()).is_ok()
}

/// The page of the folder that the file lies in.
fn page(path: &Path) -> bool {
    well(ResultsFolder::read(path.parent().expect("a folder")).map(|r| r.page().len()))
}
fn request(path: &Path) -> bool {
    let bytes = std::fs::read(path).unwrap_or_default();
    let found = [
        serde_json::from_slice::<windfall::Identify>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Structure>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Plan>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Resimulate>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Descend>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Fly>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Study>(&bytes).is_ok(),
        serde_json::from_slice::<windfall::Each>(&bytes).is_ok(),
    ];
    found.contains(&true)
}
fn fly(path: &Path) -> bool {
    let flown = |s: Scenario| {
        let samples: f64 = s.file.scenario.flights.iter().map(|f| f.duration_s * f.rate_hz).sum();
        if samples < SAMPLES { s.fly(&Fly::default()).map(|f| f.summary(false).flights.len()) } else { Ok(0) }
    };
    well(Scenario::read(path).and_then(flown))
}
fn fly_free(path: &Path) -> bool {
    well(windfall::free::find(path).and_then(|file| {
        let Some(mut file) = file else { return Ok(0) };
        let samples: f64 = file.flights.iter().map(|f| f.duration_s * f.rate_hz).sum();
        if samples < SAMPLES { windfall::free::fly(&mut file, &Fly::default()).map(|f| f.len()) } else { Ok(0) }
    }))
}
fn draw(path: &Path) -> bool {
    let drawn = |d: Drawing| {
        let few = d.prepared().study().part_draws <= 4;
        if few { d.part(0).map(|bytes| bytes.len()) } else { Ok(0) }
    };
    well(Drawing::read(path).and_then(drawn))
}
fn resimulate(path: &Path) -> bool {
    let campaign = Campaign::read(&path.with_file_name("campaign.toml")).expect("sound");
    let found = read_json::<Identification>(path).map_err(windfall::Error::from);
    well(found.and_then(|found| campaign.resimulate(&found, &Resimulate::default())))
}

macro_rules! corpus {
    ($($name:literal),*) => { &[$(concat!("scenarios/tests/fuzz/corpus/", $name)),*] };
}

fn readers() -> Vec<Reader> {
    let verb = |name, file, read| Reader { seconds: SECONDS, ..Reader::new(name, file, Text, read) };
    vec![
        Reader { seeds: corpus!["identify.json"], ..Reader::new("requests", "request.json", Text, request) },
        Reader {
            seeds: corpus!["identification.json"],
            ..Reader::new("identification", "identification.json", Text, |p| well(read_json::<Identification>(p)) && page(p))
        },
        Reader { seeds: corpus!["resimulation.json"], ..Reader::new("resimulation", "resimulation.json", Text, page) },
        Reader { seeds: corpus!["close.json"], ..Reader::new("close", "close.json", Text, page) },
        Reader {
            seeds: corpus!["figures.json"],
            beside: corpus!["close.json"],
            ..Reader::new("figures", "figures.json", Text, |p| well(read_json::<Vec<Figure>>(p)) && page(p))
        },
        Reader {
            seeds: corpus!["tracks.json"],
            beside: corpus!["close.json"],
            ..Reader::new("tracks", "tracks.json", Text, |p| well(read_json::<SignalTracks>(p)) && page(p))
        },
        Reader {
            seeds: corpus!["smoothing.json"],
            beside: corpus!["close.json"],
            ..Reader::new("smoothing", "smoothing.json", Text, |p| well(read_json::<SmoothingTracks>(p)) && page(p))
        },
        Reader { seeds: corpus!["summary.json"], ..Reader::new("study-summary", "summary.json", Text, page) },
        Reader { seeds: corpus!["many.json"], ..Reader::new("many", "many.json", Text, page) },
        Reader { seeds: corpus!["scenario.toml"], ..verb("simulate", "scenario.toml", fly) },
        Reader {
            seeds: corpus!["throws.toml"],
            beside: &["scenarios/bundled/glider.toml"],
            ..verb("simulate-free", "scenario.toml", fly_free)
        },
        Reader { seeds: corpus!["study.toml"], beside: corpus!["scenario.toml"], ..verb("study-drawn", "study.toml", draw) },
        Reader {
            seeds: corpus!["identification.json"],
            beside: corpus!["campaign.toml", "run.csv"],
            ..verb("resimulate", "identification.json", resimulate)
        },
    ]
}

/// Few of what `fuzz_as_long_as_asked` does, the same every time.
#[test]
fn law_every_result_and_verb_answers_every_file() {
    let all: Vec<(&str, Total)> = readers().iter().map(|r| (r.name, run(r, 0, 0, Until::Inputs(20)))).collect();
    let findings: Vec<&str> = all.iter().flat_map(|(_, t)| t.findings.iter().map(String::as_str)).collect();
    assert!(findings.is_empty(), "{}", findings.join("\n"));
    for (name, t) in all {
        assert!(t.accepted > 0 && t.accepted < t.inputs, "{name}: {} of {} accepted", t.accepted, t.inputs);
    }
}

#[test]
#[ignore = "as long as asked"]
fn fuzz_as_long_as_asked() {
    let findings = as_asked(&readers());
    assert!(findings.is_empty(), "{} findings", findings.len());
}
