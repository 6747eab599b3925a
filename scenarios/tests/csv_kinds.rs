//! scenarios: text that is nearly the run file. In: one run with other separators, comments, units, encodings, packing, clocks, and files that
//! are none. Out: the same record with a note, or what the file is.

mod common;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use windfall_scenarios::{Piece, ReadError, read_campaign, read_record_pieces, sensors_of_table_a3, write_record_csv};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    /// Text of the run as the program writes it.
    fn text(&self) -> String {
        write_record_csv(&self.path("plain.csv"), &common::waves()).expect("writable");
        std::fs::read_to_string(self.path("plain.csv")).expect("just written")
    }
    fn read(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<Piece, ReadError> {
        std::fs::write(self.path(name), bytes).expect("writable");
        read_record_pieces(&self.path(name), &sensors_of_table_a3(), None).map(|mut all| all.swap_remove(0))
    }
}

fn utf16(text: &str, mark: bool, bytes: impl Fn(u16) -> [u8; 2]) -> Vec<u8> {
    mark.then_some('\u{feff}').into_iter().chain(text.chars()).collect::<String>().encode_utf16().flat_map(bytes).collect()
}

/// Each is the record of the plain file, and says so where it is not quite the run file.
#[test]
fn exact_relatives_of_the_run_file() {
    let folder = Folder::new();
    let text = folder.text();
    let plain = folder.read("run.csv", &text).expect("valid");
    assert_eq!(plain.notes, Vec::<String>::new());
    let semicolons = text.replace(',', ";");
    let (header, rows) = text.split_once('\n').expect("a header");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(text.as_bytes()).expect("in memory");
    let packed = packed.finish().expect("in memory");
    let kinds: [(&str, Vec<u8>, &str); 13] = [
        ("a.csv", semicolons.clone().into(), "semicolons"),
        ("b.csv", semicolons.replace('.', ",").into(), "decimal point"),
        ("c.tsv", text.replace(',', "\t").into(), "tabs"),
        ("d.csv", format!("# wind tunnel\n#\n{header}\n# begins\n{rows}# ends\n").into(), ""),
        ("e.txt", format!("# of the tracker\n# {header}\n{rows}").into(), ""),
        ("f.csv", format!("{header}\ns,m,m,m,deg,deg,deg,Pa,m/s,K\n{rows}").into(), "row of units"),
        ("g.csv", format!("\u{feff}{text}").into(), ""),
        ("h.csv", utf16(&text, true, u16::to_le_bytes), "UTF-16"),
        ("i.csv", utf16(&text, true, u16::to_be_bytes), "UTF-16"),
        ("j.csv", utf16(&text, false, u16::to_le_bytes), "UTF-16"),
        ("k.csv.gz", packed.clone(), ""),
        ("l.csv", packed.clone(), ""),
        ("m.csv", text.replace('\n', "\r\n").into(), ""),
    ];
    for (name, bytes, note) in kinds {
        let read = folder.read(name, bytes).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(read.record, plain.record, "{name}");
        assert_eq!(read.notes.len(), usize::from(!note.is_empty()), "{name}: {:?}", read.notes);
        assert!(read.notes.iter().all(|n| n.contains(note)), "{name}: {:?}", read.notes);
    }
    let cut = folder.read("k.csv.gz", &packed[..packed.len() / 2]).expect_err("cut short").to_string();
    assert!(cut.contains("gzip") && cut.contains("cut short"), "{cut}");
}

/// What cannot be read is named for what it is.
#[test]
fn law_what_is_no_text_is_named() {
    let folder = Folder::new();
    let text = folder.text();
    for (bytes, words) in [
        (Vec::new(), &["0 bytes", "is empty"][..]),
        (b"t_s,X_m\xb0\n0,1\n".to_vec(), &["is not UTF-8", "0xb0 in line 1", "Latin-1", "save it as CSV in UTF-8"]),
        (b"t_s,X\0,\0\0\n0,1\n".to_vec(), &["zero bytes"]),
        (b"PK\x03\x04 and so on".to_vec(), &["Excel", "export the sheet as CSV"]),
        (text.replace(',', " ").into_bytes(), &["separated by blanks", "commas, semicolons or tabs"]),
        (b"# only\n# comments\n".to_vec(), &["no rows"]),
    ] {
        let message = folder.read("run.csv", bytes).expect_err(words[0]).to_string();
        words.iter().for_each(|w| assert!(message.contains(w), "{w} not in: {message}"));
    }
}

/// Lines are counted through comments and a row of units.
#[test]
fn law_faults_keep_their_lines() {
    let folder = Folder::new();
    let text = folder.text();
    let (header, rows) = text.split_once('\n').expect("a header");
    let rows = rows.replacen("299", "warm", 1);
    let message = folder.read("run.csv", format!("# one\n{header}\ns,m,m,m,deg,deg,deg,Pa,m/s,K\n{rows}")).expect_err("a word");
    assert!(message.to_string().contains("run.csv:4: Ts_K = warm"), "{message}");
}

/// A clock rounded to a millisecond at 150 Hz is read as the clock that it is, and that is said.
#[test]
fn recover_a_clock_rounded_to_a_millisecond() {
    let folder = Folder::new();
    let truth = common::waves();
    let mut rounded = truth.clone();
    rounded.t_s.iter_mut().for_each(|t| *t = (1e3 * *t).round() / 1e3);
    write_record_csv(&folder.path("run.csv"), &rounded).expect("writable");
    let bytes = std::fs::read(folder.path("run.csv")).expect("just written");
    let read = folder.read("run.csv", bytes).expect("a clock");
    assert!(read.notes.len() == 1 && read.notes[0].contains("rounded to 0.001 s"), "{:?}", read.notes);
    assert_eq!(read.record.len(), truth.len());
    assert!(read.record.t_s.iter().zip(&truth.t_s).all(|(a, b)| (a - b).abs() < 5e-4), "half of what they are rounded to");
}

/// Time of the quickest of three readings.
fn quickest(read: impl Fn()) -> f64 {
    let timed = || {
        let start = std::time::Instant::now();
        read();
        start.elapsed().as_secs_f64()
    };
    (0..3).map(|_| timed()).fold(f64::INFINITY, f64::min)
}

/// Eight times the rows, columns, faults or runs take some eight times the time, not 64 times. Both are timed here, one beside the other, so that a slow
/// machine slows both.
#[test]
fn law_reading_is_linear() {
    let folder = Folder::new();
    let long = |rows: u32| {
        let mut text = String::from("t_s,X_m,Y_m,Z_m,Rx_deg,Ry_deg,Rz_deg,VW_m_s,ps_Pa,Ts_K\n");
        for i in 0..rows {
            let t = f64::from(i) / 150.0;
            // A spike in every fortieth row: each once cost a look at all rows.
            let x = if i % 40 == 17 { 9.0 } else { 0.1 * t.sin() };
            let _ = writeln!(text, "{t},{x},{},0,{t},10,10,7.4,101325,299", 0.1 * t.cos());
        }
        quickest(|| {
            let read = folder.read("run.csv", &text).expect("valid");
            assert_eq!(read.notes.iter().filter(|n| n.contains("spike")).count(), rows as usize / 40);
        })
    };
    let wide = |columns: usize| {
        let names: Vec<String> = (0..columns).map(|i| format!("c{i}")).collect();
        let text = format!("{}\n{}\n", names.join(","), vec!["1"; columns].join(","));
        quickest(|| {
            let message = folder.read("wide.csv", &text).expect_err("no run").to_string();
            assert!(message.contains(&format!("c39 and {} more", columns - 40)));
        })
    };
    // A campaign with a fault in every line: each once counted all lines before it. And one of many runs: each was once held against all.
    let faulty = |keys: usize| {
        let lines: String = (0..keys).map(|i| format!("k{i} = 1\n")).collect();
        std::fs::write(folder.path("faults.toml"), format!("[vehicle]\n{lines}")).expect("writable");
        quickest(|| {
            let message = read_campaign(&folder.path("faults.toml")).expect_err("no campaign").to_string();
            assert!(message.contains(&format!("faults.toml:{}: [vehicle] k{}", keys + 1, keys - 1)));
        })
    };
    let runs = |count: usize| {
        let tables: String = (0..count).map(|i| format!("[[run]]\nfile = \"r{i}.csv\"\n")).collect();
        std::fs::write(folder.path("runs.toml"), tables).expect("writable");
        quickest(|| {
            let message = read_campaign(&folder.path("runs.toml")).expect_err("no such files").to_string();
            assert!(message.contains(&format!("r{}.csv", count - 1)) && !message.contains("appears twice"));
        })
    };
    let ratios =
        [long(64_000) / long(8_000), wide(100_000) / wide(12_500), faulty(40_000) / faulty(5_000), runs(9_600) / runs(1_200)];
    assert!(ratios.iter().all(|r| *r < 24.0), "{ratios:?}");
}
