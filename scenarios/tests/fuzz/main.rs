//! scenarios tests: every reader on files that are nearly right. In: small sound files of every kind, changed by chance. Out: no panic, no
//! input of 2 s, no memory beyond ten times the file and 100 MB. Totals of long runs: `docs/studies/fuzz.md`.

mod harness;
mod mutate;

use flate2::Compression;
use flate2::write::GzEncoder;
use harness::{Reader, Until, as_asked, run};
use mutate::Content::{Bytes, Table, Text};
use std::fmt::Display;
use std::io::Write as _;
use std::path::Path;
use windfall_scenarios as files;

/// Whether it was read; what it says otherwise is written out, for that is done with every message.
fn read<T, E: Display>(result: Result<T, E>) -> bool {
    result.map_err(|e| e.to_string()).is_ok()
}

fn run_file(path: &Path) -> bool {
    read(files::read_record_pieces(path, &files::sensors_of_table_a3(), None))
}
/// As a run, as a track, and as what `init` guesses a campaign from.
fn table(path: &Path) -> bool {
    let _ = read(files::draft_campaign(&[path.to_owned()], None));
    let _ = read(files::read_track(path, files::Down { axis: 2, negative: true }, 1e-3, None));
    run_file(path)
}
fn campaign(path: &Path) -> bool {
    read(files::kind_of(path)) && read(files::read_campaign_with_warnings(path))
}
/// What a folder says that its draws are of, beside what they are of.
fn study_folder(path: &Path) -> bool {
    let identity: files::Identity = serde_json::from_str(include_str!("corpus/study.json")).expect("sound");
    let folder = path.parent().expect("a folder");
    read(files::Store::open(folder, identity, &[], files::Shard::ALL, files::Opening::Resume).and_then(|s| s.wanted()))
}

fn packed(bytes: &[u8], level: Compression) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), level);
    packed.write_all(bytes).and_then(|()| packed.finish()).expect("written to memory")
}
fn gzip(bytes: Vec<u8>) -> Vec<u8> {
    packed(&bytes, Compression::fast())
}

macro_rules! corpus {
    ($($name:literal),*) => { &[$(concat!("scenarios/tests/fuzz/corpus/", $name)),*] };
}
macro_rules! formats {
    ($($name:literal),*) => { &[$(concat!("scenarios/tests/formats/", $name)),*] };
}

const BESIDE: &[&str] = corpus!["run.csv", "own.csv", "toss.csv", "drag.csv", "balance.csv", "vacuum.toml", "scenario.toml"];

fn readers() -> Vec<Reader> {
    vec![
        Reader {
            seeds: corpus!["run.csv", "own.csv", "toss.csv", "drag.csv", "balance.csv"],
            ..Reader::new("csv", "run.csv", Table, table)
        },
        Reader {
            seeds: &[
                "scenarios/tests/motion_capture/plain.csv",
                "scenarios/tests/motion_capture/vicon.csv",
                "scenarios/tests/motion_capture/motive.csv",
                "scenarios/tests/motion_capture/qualisys.tsv",
            ],
            ..Reader::new("motion-capture", "run.csv", Table, |p| read(files::draft_campaign(&[p.to_owned()], None)))
        },
        Reader { seeds: corpus!["run.csv"], finish: Some(gzip), ..Reader::new("csv-gz", "run.csv.gz", Table, run_file) },
        Reader { seeds: formats!["run.csv.gz"], ..Reader::new("csv-gz-bytes", "run.csv.gz", Bytes, run_file) },
        Reader {
            seeds: formats!["polars-zstd.parquet", "pyarrow-zstd.parquet", "mixed.parquet"],
            ..Reader::new("parquet", "run.parquet", Bytes, run_file)
        },
        Reader {
            seeds: formats!["polars.arrow", "polars-lz4.arrow", "polars-zstd.arrow", "pyarrow-lz4.feather", "mixed.feather"],
            ..Reader::new("arrow", "run.arrow", Bytes, run_file)
        },
        Reader {
            seeds: formats![
                "v5.mat",
                "v5-struct.mat",
                "v5-compressed.mat",
                "v5-matrix.mat",
                "v5-complex.mat",
                "v5-two-structs.mat"
            ],
            ..Reader::new("mat-v5", "run.mat", Bytes, run_file)
        },
        Reader { seeds: formats!["v73.mat", "v73-struct.mat"], ..Reader::new("mat-v73", "run.mat", Bytes, run_file) },
        Reader { seeds: formats!["plain.h5"], ..Reader::new("hdf5", "run.h5", Bytes, run_file) },
        Reader {
            seeds: corpus!["campaign.toml", "own.toml", "free.toml", "track.toml"],
            beside: BESIDE,
            ..Reader::new("campaign", "campaign.toml", Text, campaign)
        },
        Reader {
            seeds: corpus!["balance.csv", "drag.csv"],
            beside: corpus!["own.toml", "own.csv"],
            ..Reader::new("wind-tunnel", "balance.csv", Table, |p| campaign(&p.with_file_name("own.toml")))
        },
        Reader {
            seeds: corpus!["drag.csv"],
            beside: corpus!["track.toml", "toss.csv"],
            ..Reader::new("coefficient-table", "drag.csv", Table, |p| campaign(&p.with_file_name("track.toml")))
        },
        Reader {
            seeds: &[
                "scenarios/tests/fuzz/corpus/scenario.toml",
                "scenarios/bundled/sage-undeclared.toml",
                "scenarios/bundled/drop-test.toml",
                "scenarios/bundled/full-scale-venus-20km.toml",
            ],
            ..Reader::new("scenario", "scenario.toml", Text, |p| read(files::read_scenario_file(p)))
        },
        Reader {
            seeds: corpus!["throws.toml"],
            beside: &["scenarios/bundled/glider.toml"],
            ..Reader::new("free-scenario", "scenario.toml", Text, |p| read(files::read_free(p)))
        },
        Reader {
            seeds: &[
                "scenarios/planet/venus-dispersions.toml",
                "scenarios/planet/nesc-02.toml",
                "scenarios/planet/nesc-08.toml",
                "scenarios/planet/rate-damping.toml",
            ],
            beside: &["scenarios/planet/venus-wind.csv", "scenarios/planet/nesc-08-wind.csv"],
            ..Reader::new("planet", "scenario.toml", Text, |p| read(files::read_planet(p)))
        },
        Reader {
            seeds: &["scenarios/planet/venus-wind.csv"],
            beside: &["scenarios/planet/venus-dispersions.toml"],
            ..Reader::new("wind", "venus-wind.csv", Table, |p| {
                read(files::read_planet(&p.with_file_name("venus-dispersions.toml")))
            })
        },
        Reader {
            seeds: &[
                "scenarios/capsule/structure.toml",
                "scenarios/tests/fuzz/corpus/vacuum.toml",
                "scenarios/bundled/glider.toml",
            ],
            ..Reader::new("structure", "structure.toml", Text, |p| read(files::read_structure(p)))
        },
        Reader {
            seeds: corpus!["study.toml"],
            beside: BESIDE,
            ..Reader::new("study", "study.toml", Text, |p| read(files::read_study(p)))
        },
        Reader {
            seeds: &["scenarios/sage/table-5.6.toml"],
            ..Reader::new("statistics", "statistics.toml", Text, |p| read(files::read_statistics(p)))
        },
        Reader {
            seeds: corpus!["runs.parquet"],
            ..Reader::new("study-rows", "runs.parquet", Bytes, |p| read(files::read_runs(p)))
        },
        Reader { seeds: corpus!["study.json"], ..Reader::new("study-folder", "study.json", Text, study_folder) },
    ]
}

/// Few of what `fuzz_as_long_as_asked` does, the same every time.
#[test]
fn law_every_reader_answers_every_file() {
    let all: Vec<(&str, harness::Total)> = readers().iter().map(|r| (r.name, run(r, 0, 0, Until::Inputs(200)))).collect();
    let findings: Vec<&str> = all.iter().flat_map(|(_, t)| t.findings.iter().map(String::as_str)).collect();
    assert!(findings.is_empty(), "{}", findings.join("\n"));
    // A harness whose inputs are all refused at the door would find nothing.
    for (name, t) in all {
        assert!(t.inputs > 200 && t.accepted > 1 && t.accepted < t.inputs, "{name}: {} of {} accepted", t.accepted, t.inputs);
    }
}

/// 40 MB of rows in 40 kB are refused before they are in memory.
#[test]
fn law_little_that_unpacks_to_much_is_refused() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let path = dir.path().join("run.csv.gz");
    let bytes = packed(&b"0,0\n".repeat(10_000_000), Compression::best());
    assert!(bytes.len() < 50_000, "{} bytes", bytes.len());
    std::fs::write(&path, bytes).expect("the temporary folder is writable");
    let refused = files::read_record_pieces(&path, &files::sensors_of_table_a3(), None).err().map(|e| e.to_string());
    assert!(refused.as_ref().is_some_and(|e| e.contains("unpack to")), "{refused:?}");
}

#[test]
#[ignore = "as long as asked"]
fn fuzz_as_long_as_asked() {
    let findings = as_asked(&readers());
    assert!(findings.is_empty(), "{} findings", findings.len());
}
