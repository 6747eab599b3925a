//! scenarios tests: logs as they come. In: sound runs with what loggers and spreadsheets do to them. Out: the same record with one note, or one
//! sentence that names what is wrong.

mod common;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use windfall_model::Data;
use windfall_scenarios::{
    Piece, ReadError, columns_of_campaign, read_campaign_with_warnings, read_record_pieces, sensors_of_table_a3,
};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }
    fn put(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path
    }
    fn run(&self, text: &str) -> Result<Piece, ReadError> {
        read_record_pieces(&self.put("run.csv", text), &sensors_of_table_a3(), None).map(|mut all| all.swap_remove(0))
    }
    fn campaign(&self, text: &str) -> Result<(windfall_model::Campaign, Vec<String>), ReadError> {
        read_campaign_with_warnings(&self.put("campaign.toml", text))
    }
}

/// The sound run as text, line by line.
fn lines() -> Vec<String> {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let path = dir.path().join("run.csv");
    windfall_scenarios::write_record_csv(&path, &common::waves()).expect("writable");
    std::fs::read_to_string(&path).expect("just written").lines().map(str::to_owned).collect()
}

fn text(lines: &[String]) -> String {
    lines.join("\n") + "\n"
}

/// Appends a cell to every line: the header's, then what the row's number gives.
fn with_column(head: &str, cell: impl Fn(usize) -> String) -> String {
    let all = lines();
    let mut out = format!("{}{head}\n", all[0]);
    for (i, l) in all[1..].iter().enumerate() {
        let _ = writeln!(out, "{l}{}", cell(i));
    }
    out
}

/// Each is read as the sound run, and its oddity is said once.
#[test]
fn law_oddities_of_loggers_are_read_and_said_once() {
    let folder = Folder::new();
    let sound = folder.run(&text(&lines())).expect("sound");
    let (mut twice, mut again) = (lines(), lines());
    twice.insert(100, twice[99].clone());
    twice.insert(50, twice[49].clone());
    again.insert(200, again[0].clone());
    for (name, text, note) in [
        ("a column of words", with_column(",operator", |_| ",anna".to_owned()), "operator"),
        (
            "words now and then",
            with_column(",status", |i| if i % 7 == 0 { ",ERR".to_owned() } else { ",0".to_owned() }),
            "status (58 cells)",
        ),
        ("columns without a name", with_column(",,", |_| ",,".to_owned()), ""),
        ("an index without a name", with_column(",", |i| format!(",{i}")), "columns without a name left out: 1"),
        ("a separator at the end of rows", with_column("", |_| ",".to_owned()), ""),
        ("rows written twice", text(&twice), "2 rows written twice dropped"),
        ("the header again", text(&again), "rows that repeat the header skipped: 1"),
        ("a name that stands twice and nothing reads", with_column(",n,n", |i| format!(",{i},{i}")), "columns not used: n"),
        ("a spreadsheet's nothing", with_column(",note", |_| ",#N/A".to_owned()), "columns not used: note"),
    ] {
        let read = folder.run(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(read.record, sound.record, "{name}");
        let said = read.notes.iter().filter(|n| note.is_empty() || n.contains(note)).count();
        assert_eq!(said, usize::from(!note.is_empty()), "{name}: {:?}", read.notes);
    }
}

/// What is read must be numbers: cells of a column that is read, and names that stand twice, are faults by line.
#[test]
fn law_what_is_read_must_be_numbers() {
    let folder = Folder::new();
    let all = lines();
    let place = all[0].split(',').position(|n| n == "VW_m_s").expect("a speed");
    let mut bad = all.clone();
    for l in &mut bad[1..] {
        let mut cells: Vec<&str> = l.split(',').collect();
        cells[place] = "fast";
        *l = cells.join(",");
    }
    let said = folder.run(&text(&bad)).expect_err("words for a speed").to_string();
    assert!(said.contains("run.csv:2: VW_m_s = fast: is not a number") && said.contains("380 more cells"), "{said}");
    let said = folder.run(&with_column(",X_m", |_| ",0".to_owned())).expect_err("two X").to_string();
    assert!(said.contains("X_m") && said.contains("appears twice") && said.lines().count() == 1, "{said}");
    // Times that stand still or go back are one sentence each, with their number.
    let mut still = all.clone();
    for i in 100..130 {
        let (time, _) = still[99].clone().split_once(',').map(|(t, r)| (t.to_owned(), r.to_owned())).expect("cells");
        let rest = still[i].split_once(',').expect("cells").1.to_owned();
        still[i] = format!("{time},{rest}");
    }
    let said = folder.run(&text(&still)).expect_err("a time that stands").to_string();
    assert!(said.lines().count() == 1 && said.contains("30 rows"), "{said}");
}

/// A track of a point mass with another head, rows and [[run]].
fn point(head: &str, sensors: &str, run: &str) -> String {
    format!(
        "[campaign]\nname = \"c\"\n{head}[vehicle]\nmass_kg = 1.0\nreference_diameter_m = 0.1\n[axes]\ndown = \"-Z\"\n[environment]\n\
         gravity_m_s2 = 9.81\nair_density_kg_m3 = 1.2\n[sensors]\n{sensors}\n[aero.point_mass]\nCD = 0.5\n[[run]]\nfile = \"run.csv\"\nkind = \
         \"drop\"\nuse = \"identify\"\n{run}"
    )
}

fn falling(from_s: f64, from_m: f64, others: (&str, &str)) -> String {
    let mut out = format!("t_s,Z_m{}\n", others.0);
    for i in 0..60 {
        let t = 0.02 * f64::from(i);
        let _ = writeln!(out, "{},{}{}", from_s + t, from_m - 4.9 * t * t, others.1);
    }
    out
}

const POSITION: &str = "position_std_m = 0.01";

/// Unix times take a window, and a probe may be 150 km high.
#[test]
fn exact_unix_times_and_great_heights_are_read() {
    let folder = Folder::new();
    folder.put("run.csv", &falling(1_570_537_893.3, 146_797.0, ("", "")));
    let window = "window_s = [1570537893.49, 1570537894.21]\n";
    let (campaign, _) = folder.campaign(&point("", POSITION, window)).unwrap_or_else(|e| panic!("{e}"));
    let Data::Point(track) = &campaign.runs[0].data else { panic!("a track") };
    assert_eq!(track.t_s.len(), 36, "0.2 to 0.9 s of 50 a second, with both ends");
}

/// A specific force that a campaign cannot use is refused, in a track and beside a model in a tunnel; one that it can use is read.
#[test]
fn law_an_accelerometer_that_is_not_heard_is_refused() {
    let folder = Folder::new();
    folder.put("run.csv", &falling(0.0, 50.0, (",fZ_m_s2", ",-0.1")));
    let said = folder.campaign(&point("", POSITION, "")).expect_err("a force that nothing reads").to_string();
    assert!(said.contains("fZ_m_s2") && said.contains("specific_force_std_m_s2"), "{said}");
    let both = format!("{POSITION}\nspecific_force_std_m_s2 = 0.1");
    folder.campaign(&point("", &both, "")).unwrap_or_else(|e| panic!("{e}"));
    let said = folder.run(&with_column(",fX_m_s2", |_| ",9.8".to_owned())).expect_err("a force in a tunnel").to_string();
    assert!(said.contains("fX_m_s2") && said.contains("tunnel campaign"), "{said}");
}

/// Columns of a track that nothing reads are said, and what is done to each is told.
#[test]
fn law_every_column_is_told() {
    let folder = Folder::new();
    folder.put("run.csv", &falling(0.0, 50.0, (",gps,who", ",3,anna")).replace("Z_m", "height"));
    let head = "[columns]\nZ_m = { name = \"height\", unit = \"ft\" }\n";
    let (_, warnings) = folder.campaign(&point(head, POSITION, "")).unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.iter().any(|w| w.contains("columns not used: gps")), "{warnings:?}");
    let told = columns_of_campaign(Path::new(&folder.0.path().join("campaign.toml"))).expect("columns").join("\n");
    for words in ["columns of run", "t_s", "Z_m from height in ft", "not read: gps", "no plain numbers, not read: who"] {
        assert!(told.contains(words), "{words} in {told}");
    }
}

/// A quaternion whose names say that another part is the real one is named.
#[test]
fn law_names_of_a_quaternion_must_agree_with_scalar() {
    let folder = Folder::new();
    folder.put("run.csv", &text(&lines()));
    for (names, scalar, wrong) in [("qw", "last", true), ("qw", "first", false), ("Q_X", "last", false)] {
        let names = if names == "qw" { "\"qw\", \"qx\", \"qy\", \"qz\"" } else { "\"Q_X\", \"Q_Y\", \"Q_Z\", \"Q_W\"" };
        let own = format!("[columns.attitude]\nquaternion = [{names}]\nscalar = \"{scalar}\"\nrotates = \"body-to-world\"\n");
        let text = format!("{own}{}", TUNNEL);
        let said = folder.campaign(&text).expect_err("the file has no quaternion").to_string();
        assert_eq!(said.contains("real part"), wrong, "{said}");
    }
}

/// One fault in several runs is one sentence.
#[test]
fn law_one_fault_in_five_runs_is_one_sentence() {
    let folder = Folder::new();
    let kilo = text(&lines()).replace("101325", "101.325");
    let mut campaign = TUNNEL.split("[[run]]").next().expect("a head").to_owned();
    for i in 1..=5 {
        folder.put(&format!("run-{i}.csv"), &kilo);
        let _ = write!(campaign, "[[run]]\nfile = \"run-{i}.csv\"\nkind = \"perturbed\"\nuse = \"identify\"\n");
    }
    let said = folder.campaign(&campaign).expect_err("kPa for Pa").to_string();
    assert!(said.lines().count() == 1 && said.contains("ps_Pa") && said.contains("the same in run-2.csv, run-3.csv"), "{said}");
    // So are notes of them.
    for i in 1..=5 {
        folder.put(&format!("run-{i}.csv"), &with_column(",operator", |_| ",anna".to_owned()));
    }
    let (_, warnings) = folder.campaign(&campaign).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(warnings.iter().filter(|w| w.contains("operator")).count(), 1, "{warnings:?}");
}

const TUNNEL: &str = "
[campaign]
name = \"c\"
[vehicle]
mass_kg = 0.7873
inertia_kg_m2 = { xx = 0.02113, yy = 0.0138, zz = 0.01379, xy = 0.0, xz = 0.0, yz = 0.0 }
center_of_mass_m = [0.0, 0.0, 0.0]
reference_diameter_m = 0.2125
[environment]
gravity_m_s2 = 9.80665
gas_constant_j_kg_k = 287.05287
[sensors]
position_std_m = 7.5e-4
roll_std_deg = 0.0623
pitch_yaw_std_deg = 0.110
wind_std_m_s = 2.57e-3
[aero.axisymmetric]
CA_T0 = 6.6
CN_sin = 3.4
CN_sin3 = -1.5
Cl_0 = 0.01
Cl_p = -5.0
Cm_sin = -2.0
Cm_sin3 = 2.0
Cm_1 = -3.0
Cm_2 = -150.0
Cn_1 = -3.0
Cn_2 = -150.0
[[run]]
file = \"run.csv\"
kind = \"perturbed\"
use = \"identify\"
";
