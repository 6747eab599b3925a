//! scenarios: run files in every format. In: files that scipy, h5py, polars and pyarrow wrote (`formats/make.py`). Out: one record, the
//! same bits from each; of damaged files an error that names the file.

use std::path::{Path, PathBuf};
use windfall_model::Record;
use windfall_scenarios::{FileKind, Piece, ReadError, kind_of, read_record_pieces, sensors_of_table_a3};

/// Every file that holds the run of `run.csv`.
const SAME: [&str; 13] = [
    "run.csv.gz",
    "v5.mat",
    "v5-compressed.mat",
    "v5-struct.mat",
    "v73.mat",
    "v73-struct.mat",
    "plain.h5",
    "polars-zstd.parquet",
    "pyarrow-zstd.parquet",
    "polars.arrow",
    "polars-lz4.arrow",
    "polars-zstd.arrow",
    "pyarrow-lz4.feather",
];

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats").join(name)
}

fn read(path: &Path) -> Result<Piece, ReadError> {
    read_record_pieces(path, &sensors_of_table_a3(), None).map(|mut all| {
        assert_eq!(all.len(), 1, "{}", path.display());
        all.swap_remove(0)
    })
}

fn bits(r: &Record) -> Vec<u64> {
    let one = [&r.t_s, &r.vw_m_s, &r.ps_pa, &r.ts_k, r.qw_pa.as_ref().expect("the file has q_W")];
    one.into_iter().chain(&r.position_m).chain(&r.attitude_rad).flatten().map(|x| x.to_bits()).collect()
}

fn message(path: &Path) -> String {
    read(path).expect_err("a fault").to_string()
}

#[test]
fn exact_every_format_gives_the_bits_of_the_csv() {
    let csv = read(&file("run.csv")).expect("valid");
    assert_eq!(csv.record.len(), 61);
    assert_eq!(csv.notes, ["Y_m: 1 samples bridged (dropouts up to 0.1 s)"], "the value that is missing on purpose");
    for name in SAME {
        let other = read(&file(name)).unwrap_or_else(|e| panic!("{e}"));
        assert!(bits(&other.record) == bits(&csv.record), "{name}");
        assert_eq!(other.record.bridged, csv.record.bridged, "{name}");
        assert!(matches!(kind_of(&file(name)), Ok(FileKind::Run)), "{name}");
        let extra: Vec<&String> = other.notes.iter().filter(|n| !csv.notes.contains(n)).collect();
        assert!(extra.iter().all(|n| n.contains("note (text)")), "{name}: {extra:?}");
    }
}

#[test]
fn law_what_is_no_run_says_what_it_holds() {
    for (name, words) in [
        ("v5-two-structs.mat", &["a, b", "which is the run"][..]),
        ("v5-complex.mat", &["X_m", "is missing", "Y_m"]),
        ("v5-matrix.mat", &["X_m", "is missing", "pose(:,1)"]),
        ("mixed.feather", &["X_m", "is missing", "t_s, n, f, hole, b"]),
        ("mixed.parquet", &["X_m", "is missing"]),
    ] {
        let message = message(&file(name));
        words.iter().for_each(|w| assert!(message.contains(w), "{w} not in: {message}"));
    }
}

/// A file of another kind than its ending says is named by what it is.
#[test]
fn law_a_wrong_ending_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = |name: &str| std::fs::read(file(name)).expect("a fixture");
    for (from, ending, word) in [
        ("v5.mat", "csv", "is MATLAB v5"),
        ("v73.mat", "csv", "is HDF5"),
        ("run.csv.gz", "mat", "gzip"),
        ("polars.arrow", "parquet", "is Arrow"),
        ("polars-zstd.parquet", "feather", "is Parquet"),
        ("run.csv", "mat", "no header of version 5"),
        ("run.csv", "h5", "cannot be read as HDF5"),
        ("run.csv", "arrow", "does not start with ARROW1"),
    ] {
        let path = folder.path().join(format!("run.{ending}"));
        std::fs::write(&path, bytes(from)).expect("writable");
        let message = message(&path);
        assert!(message.contains(word) && message.contains("try: "), "{word} not in: {message}");
    }
    for name in ["run.csv", "run.mat", "run.arrow", "run.parquet", "run.h5", "run.csv.gz"] {
        let path = folder.path().join(name);
        std::fs::write(&path, []).expect("writable");
        assert!(message(&path).contains("is empty"), "{name}");
    }
}

/// Files cut anywhere, and files with any byte turned, give a record or an error that names the file and what to try: no panic.
#[test]
fn law_damaged_files_are_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut read_anyway = 0;
    for name in SAME {
        let whole = std::fs::read(file(name)).expect("a fixture");
        let path = folder.path().join(name);
        let mut hold = |bytes: &[u8]| {
            std::fs::write(&path, bytes).expect("writable");
            match read_record_pieces(&path, &sensors_of_table_a3(), None) {
                Ok(_) => read_anyway += 1,
                Err(e) => {
                    let message = e.to_string();
                    assert!(message.contains(name) && message.contains("try: "), "{message}");
                }
            }
        };
        for cut in (0..whole.len()).step_by(whole.len() / 20) {
            hold(&whole[..cut]);
        }
        for at in (0..whole.len()).step_by(whole.len() / 100) {
            let mut turned = whole.clone();
            turned[at] ^= [0x01, 0x80, 0xff][at % 3];
            hold(&turned);
        }
    }
    assert!(read_anyway > 0, "a turned last digit is no fault");
}
