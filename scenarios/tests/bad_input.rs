//! scenarios: every case of the contract's "Bad input". In: files with one thing wrong. Out: the fault or the note that says so.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use windfall_model::{Campaign, Data, Record};
use windfall_scenarios::{
    ReadError, bundled, read_campaign, read_campaign_with_warnings, read_record_csv, read_scenario_file, read_structure,
    write_record_csv,
};

const CAMPAIGN: &str = r#"[campaign]
name = "test"

[vehicle]
mass_kg = 0.7873
inertia_kg_m2 = { xx = 0.02113, yy = 0.0138, zz = 0.01379, xy = 0.0, xz = 0.0, yz = 0.0 }
center_of_mass_m = [0.0, 0.0, 0.0]
reference_diameter_m = 0.2125

[tether]
attachment_m = [-0.25, 0.0, 0.0]
ring_m = [-3.0, 0.0, 0.0]
drag_area_m2 = 0.0013
effective_weight_n = 0.0165

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
file = "run.csv"
kind = "perturbed"
use = "identify"
"#;

const RATE_HZ: f64 = 150.0;

/// A smooth run with the noise of Table A.3 from a small generator (Park and Miller 1988; sum of twelve uniforms).
fn record(seconds: f64) -> Record {
    let n = (seconds * RATE_HZ) as usize + 1;
    let t_s: Vec<f64> = (0..n).map(|i| i as f64 / RATE_HZ).collect();
    let mut state = 12_345_u64;
    let mut uniform = || {
        state = state * 48_271 % 2_147_483_647;
        state as f64 / 2_147_483_647.0
    };
    let mut noise = |std: f64| std * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
    let decay = |t: f64| (-0.2 * t).exp();
    let mut series = |f: &dyn Fn(f64) -> f64, std: f64| t_s.iter().map(|t| f(*t) + noise(std)).collect::<Vec<f64>>();
    let position_m = [
        series(&|t| 0.1 * (0.5 * t).sin(), 7.5e-4),
        series(&|t| 0.05 * decay(t) * (6.0 * t).cos(), 7.5e-4),
        series(&|t| 0.05 * decay(t) * (6.0 * t).sin(), 7.5e-4),
    ];
    let angle = 0.11_f64.to_radians();
    let attitude_rad = [
        series(&|t| 0.9 + 0.15 * t, 0.0623_f64.to_radians()),
        series(&|t| 0.4 * decay(t) * (6.0 * t).cos(), angle),
        series(&|t| 0.4 * decay(t) * (6.0 * t).sin(), angle),
    ];
    let vw_m_s = series(&|t| 7.43 + 0.05 * (0.7 * t).sin(), 2.57e-3);
    let qw_pa = Some(vw_m_s.iter().map(|v| 0.5 * 101_325.0 / (287.05287 * 299.084) * v * v).collect());
    Record {
        position_m,
        attitude_rad,
        ps_pa: vec![101_325.0; n],
        ts_k: vec![299.084; n],
        vw_m_s,
        qw_pa,
        t_s,
        ..Record::default()
    }
}

struct Folder(tempfile::TempDir);

impl Folder {
    /// A campaign with one run of ten seconds, its text and the run's lines changed.
    fn with(campaign: impl Fn(&str) -> String, lines: impl Fn(&mut Vec<String>)) -> Self {
        let folder = Self(tempfile::tempdir().expect("a temporary folder"));
        std::fs::write(folder.path("campaign.toml"), campaign(CAMPAIGN)).expect("writable");
        write_record_csv(&folder.path("run.csv"), &record(10.0)).expect("writable");
        let text = std::fs::read_to_string(folder.path("run.csv")).expect("just written");
        let mut all: Vec<String> = text.lines().map(str::to_owned).collect();
        lines(&mut all);
        std::fs::write(folder.path("run.csv"), all.join("\n")).expect("writable");
        folder
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn read(&self) -> Result<(Campaign, Vec<String>), ReadError> {
        read_campaign_with_warnings(&self.path("campaign.toml"))
    }
}

fn same(text: &str) -> String {
    text.to_owned()
}
fn keep(_: &mut Vec<String>) {}

/// Replaces cell `column` of file line `line` (1 is the header).
fn set(lines: &mut [String], line: usize, column: &str, value: &str) {
    let k = lines[0].split(',').position(|c| c == column).expect("a column of the run file");
    let mut cells: Vec<&str> = lines[line - 1].split(',').collect();
    cells[k] = value;
    lines[line - 1] = cells.join(",");
}

/// Multiplies a whole column.
fn scale(lines: &mut [String], column: &str, factor: f64) {
    let k = lines[0].split(',').position(|c| c == column).expect("a column of the run file");
    for line in &mut lines[1..] {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        cells[k] = (cells[k].parse::<f64>().expect("a number") * factor).to_string();
        *line = cells.join(",");
    }
}

fn tunnel(c: &Campaign, i: usize) -> &Record {
    match &c.runs[i].data {
        Data::Tunnel(r) => r,
        Data::Point(_) => panic!("a tunnel run"),
    }
}

/// The fault of a changed campaign text must name line, key and what is allowed.
fn campaign_fault(from: &str, to: &str, words: &[&str]) {
    assert!(CAMPAIGN.contains(from), "{from}");
    let folder = Folder::with(|t| t.replacen(from, to, 1), keep);
    let error = folder.read().expect_err(to);
    let line = CAMPAIGN[..CAMPAIGN.find(from).expect("checked above")].lines().count();
    let message = error.to_string();
    assert!(error.faults().iter().any(|f| f.line.is_some_and(|l| l >= line)), "{message}");
    for word in words {
        assert!(message.contains(word), "{word} not in: {message}");
    }
}

#[test]
fn law_a_valid_campaign_is_read() {
    let (campaign, warnings) = Folder::with(same, keep).read().expect("valid");
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(tunnel(&campaign, 0).len(), 1501);
    assert!(tunnel(&campaign, 0).bridged.is_empty(), "all was measured");
}

#[test]
fn law_campaign_faults_name_file_line_key_and_allowed() {
    campaign_fault("mass_kg = 0.7873", "mas_kg = 0.7873", &["campaign.toml:5", "mas_kg", "unknown key", "mass_kg"]);
    campaign_fault("mass_kg = 0.7873", "mass_kg = nan", &["campaign.toml:5", "mass_kg = nan", "finite", "kg"]);
    campaign_fault("mass_kg = 0.7873", "mass_kg = inf", &["mass_kg = inf", "finite"]);
    campaign_fault("mass_kg = 0.7873", "mass_kg = 0.0", &["mass_kg = 0.0"]);
    campaign_fault("mass_kg = 0.7873", "mass_kg = 1.0000001e7", &["1e7"]);
    campaign_fault("mass_kg = 0.7873", "mass_kg = \"0.79\"", &["must be a number"]);
    campaign_fault("mass_kg = 0.7873\n", "", &["mass_kg", "is missing", "kg", "no default"]);
    campaign_fault("xx = 0.02113", "xx = 0.2113", &["inertia", "real body"]);
    campaign_fault("[-3.0, 0.0, 0.0]", "[-3.0, 0.0]", &["ring_m", "3 numbers"]);
    campaign_fault("roll_std_deg = 0.0623", "roll_std_deg = 90.001", &["90.001", "deg"]);
    campaign_fault("roll_std_deg = 0.0623", "roll_std_rad = 0.001", &["roll_std_rad", "roll_std_deg"]);
    campaign_fault("Cm_2 = -150.0", "Cm2 = -150.0", &["Cm2", "unknown key", "Cm_2"]);
    campaign_fault("Cm_2 = -150.0", "Cm_2 = nan", &["Cm_2 = nan"]);
    campaign_fault("[aero.axisymmetric]", "[aero.axisymetric]", &["axisymetric", "axisymmetric"]);
    campaign_fault("CA_T0 = 6.6", "CA_T0 = 6.6\ndeclared = [\"CA\"]", &["declared", "CA", "is no parameter"]);
    campaign_fault("use = \"identify\"", "use = \"holdout\"", &["holdout", "hold-out"]);
    campaign_fault("file = \"run.csv\"", "file = \"runs.csv\"", &["runs.csv"]);
    campaign_fault("use = \"identify\"", "use = \"identify\"\nwindow_s = [5.0, 2.0]", &["window_s", "earlier to a later"]);
    campaign_fault("use = \"identify\"", "use = \"identify\"\ninputs = { wheel = nan }", &["wheel", "finite"]);
    campaign_fault("[environment]", "[enviroment]", &["enviroment", "environment"]);
    campaign_fault("[campaign]", "[campaign", &["campaign.toml:1", "TOML"]);
    campaign_fault("name = \"test\"", "name = \"test\"\nname = \"again\"", &["campaign.toml:3"]);
}

#[test]
fn law_all_faults_are_reported_at_once() {
    let folder = Folder::with(|t| t.replace("mass_kg", "mas_kg").replace("7.5e-4", "nan").replace("Cl_p = -5.0\n", ""), keep);
    let message = folder.read().expect_err("three faults").to_string();
    for word in ["mas_kg", "mass_kg", "position_std_m", "Cl_p"] {
        assert!(message.contains(word), "{word} not in: {message}");
    }
}

#[test]
fn law_undeclared_values_are_zero_and_said() {
    let (campaign, warnings) =
        Folder::with(|t| t.replace("CA_T0 = 6.6", "CA_T0 = 6.6\ndeclared = [\"CA_T0\"]"), keep).read().expect("valid");
    assert!(campaign.plant.aero.value("CN_sin").is_some_and(|v| v == 0.0));
    assert_eq!(campaign.declared.iter().filter(|d| **d).count(), 1);
    assert_eq!(warnings.len(), 10, "{warnings:?}");
}

/// Bridged values come within six standard deviations of the noise of what was there: the bridge's own error is below one.
#[test]
fn law_short_dropouts_are_bridged_and_counted() {
    let truth = record(10.0);
    let folder = Folder::with(same, |lines| {
        (500..515).for_each(|l| set(lines, l, "Ry_deg", "NaN"));
        set(lines, 700, "VW_m_s", "");
        set(lines, 800, "X_m", "inf");
        lines.drain(900..910);
    });
    let (campaign, warnings) = folder.read().expect("dropouts are no fault");
    let r = tunnel(&campaign, 0);
    assert_eq!(r.len(), truth.len());
    for i in 498..513 {
        let error = (r.attitude_rad[1][i] - truth.attitude_rad[1][i]).abs();
        assert!(error < 6.0 * 0.11_f64.to_radians(), "sample {i}: {error}");
    }
    for i in 899..909 {
        assert!((r.t_s[i] - truth.t_s[i]).abs() < 1e-12);
        assert!((r.position_m[1][i] - truth.position_m[1][i]).abs() < 6.0 * 7.5e-4);
    }
    let all = warnings.join("\n");
    assert!(all.contains("Ry_deg: 25 samples bridged") && all.contains("VW_m_s: 11 samples bridged"), "{all}");
    // Lines 500-514, 700 and 800 of the file, which has a header, and ten rows that are gone.
    let filled: Vec<usize> = (0..r.len()).filter(|i| !r.is_measured(*i)).collect();
    let expected: Vec<usize> = (498..513).chain([698, 798]).chain(899..909).collect();
    assert_eq!(filled, expected);
}

#[test]
fn law_long_gaps_split_the_run() {
    let folder = Folder::with(same, |lines| {
        lines.drain(1200..1216);
        (600..616).for_each(|l| set(lines, l, "Z_m", ""));
        lines.drain(1300..1320);
    });
    let (campaign, warnings) = folder.read().expect("gaps are no fault");
    let names: Vec<&str> = campaign.runs.iter().map(|r| r.name.as_str()).collect();
    assert_eq!(names, ["run-a", "run-b", "run-c"], "{warnings:?}");
    assert_eq!(tunnel(&campaign, 0).len(), 598);
    assert!(warnings.iter().any(|w| w.contains("split by gaps")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("dropped")), "a piece of 0.6 s is too short: {warnings:?}");
}

#[test]
fn law_spikes_are_removed_listed_and_nothing_else_is_touched() {
    let truth = record(10.0);
    let spikes =
        [(400, "X_m", "5.0"), (800, "Ry_deg", "-80"), (801, "Ry_deg", "-81"), (1000, "Rx_deg", "120"), (1100, "ps_Pa", "98000")];
    let folder = Folder::with(same, |lines| spikes.iter().for_each(|(l, c, v)| set(lines, *l, c, v)));
    let (campaign, warnings) = folder.read().expect("spikes are no fault");
    assert_eq!(warnings.iter().filter(|w| w.contains("spike")).count(), spikes.len(), "{warnings:?}");
    let r = tunnel(&campaign, 0);
    assert!((r.position_m[0][398] - truth.position_m[0][398]).abs() < 6.0 * 7.5e-4);
    for i in [798, 799] {
        assert!((r.attitude_rad[1][i] - truth.attitude_rad[1][i]).abs() < 6.0 * 0.11_f64.to_radians());
    }
    let touched = r.attitude_rad[1].iter().zip(&truth.attitude_rad[1]).filter(|(a, b)| (*a - *b).abs() > 1e-12).count();
    assert_eq!(touched, 2);
}

/// Seven declared standard deviations on top of a sample are above the limit of six by more than the sample's own noise may take away
/// (here checked to be small); five are below.
#[test]
fn law_the_limit_is_six_deviations() {
    let truth = record(10.0);
    let i = (300..900)
        .min_by(|a, b| {
            let wiggle = |i: usize| {
                let x = &truth.position_m[1];
                (x[i] - 0.5 * (x[i - 1] + x[i + 1])).abs()
            };
            wiggle(*a).total_cmp(&wiggle(*b))
        })
        .expect("six hundred samples");
    for (sigmas, removed) in [(4.5, 0), (9.0, 1)] {
        let value = (truth.position_m[1][i] + sigmas * 7.5e-4).to_string();
        let (_, warnings) = Folder::with(same, |lines| set(lines, i + 2, "Y_m", &value)).read().expect("no fault");
        assert_eq!(warnings.len(), removed, "{sigmas} deviations: {warnings:?}");
    }
}

fn run_fault(change: impl Fn(&mut Vec<String>), words: &[&str]) {
    let message = Folder::with(same, change).read().expect_err(words[0]).to_string();
    for word in words {
        assert!(message.contains(word), "{word} not in: {message}");
    }
}

#[test]
fn law_time_must_increase_and_be_uniform() {
    run_fault(|l| l.swap(100, 101), &["run.csv:10", "t_s", "goes backward", "sort"]);
    run_fault(
        |l| {
            let twice = l[100].clone();
            l.insert(100, twice);
            // A row that is the one before in every column is a copy; this one says something else of the same instant.
            set(l, 102, "X_m", "0.5");
        },
        &["run.csv:102", "appears twice"],
    );
    run_fault(|l| set(l, 100, "t_s", "0.6550"), &["uniform to 1 %", "resample"]);
}

#[test]
fn law_wrong_units_are_named() {
    let radians = 1.0_f64.to_radians();
    run_fault(|l| ["Rx_deg", "Ry_deg", "Rz_deg"].iter().for_each(|c| scale(l, c, radians)), &["Ry_deg", "radians", "57.29578"]);
    run_fault(|l| scale(l, "VW_m_s", 1.0 / 0.3048), &["VW_m_s", "ft/s", "0.3048"]);
    run_fault(|l| scale(l, "ps_Pa", 0.01), &["ps_Pa", "100 x hPa"]);
    run_fault(|l| scale(l, "ps_Pa", 0.001), &["ps_Pa", "1000 x kPa"]);
    run_fault(|l| (2..=l.len()).for_each(|i| set(l, i, "Ts_K", "25.9")), &["Ts_K", "273.15"]);
    run_fault(|l| scale(l, "qW_Pa", 1.0 / 47.88), &["qW_Pa", "lb/ft2"]);
    run_fault(|l| (2..=l.len()).for_each(|i| set(l, i, "Ry_deg", "150")), &["off the downward vertical"]);
    // Without q_W the weight tells.
    let no_q = |l: &mut Vec<String>| {
        scale(l, "VW_m_s", 1.0 / 0.3048);
        l[0] = l[0].replace("qW_Pa", "q_other");
    };
    run_fault(no_q, &["times the weight", "ft/s"]);
}

#[test]
fn law_columns_and_cells_are_checked() {
    run_fault(|l| l[0] = l[0].replace("Ts_K", "T_K"), &["run.csv:1", "Ts_K", "missing", "T_K"]);
    run_fault(|l| l[0] = l[0].replace("Y_m", "X_m"), &["X_m", "twice"]);
    run_fault(|l| set(l, 77, "X_m", "0,1"), &["run.csv:77", "cells"]);
    run_fault(|l| set(l, 77, "X_m", "abc"), &["run.csv:77", "X_m = abc", "not a number"]);
    run_fault(|l| l.truncate(1), &["no rows"]);
    run_fault(|l| l.truncate(20), &["samples"]);
    run_fault(|l| (2..=l.len()).for_each(|i| set(l, i, "Rx_deg", "")), &["Rx_deg", "no number"]);
}

#[test]
fn law_unknown_kinds_of_files_say_what_is_read() {
    let message = Folder::with(|t| t.replace("run.csv", "run.xlsx"), keep).read().expect_err("not read").to_string();
    assert!(message.contains(".xlsx") && message.contains(".parquet"), "{message}");
    assert!(
        read_campaign(Path::new("/nowhere/campaign.toml")).expect_err("absent").to_string().contains("/nowhere/campaign.toml")
    );
}

/// Any prefix or flipped byte of a file gives a result or an error, never a panic.
#[test]
fn law_broken_files_never_panic() {
    for cut in (0..CAMPAIGN.len()).step_by(7) {
        let _ = Folder::with(|t| t.get(..cut).unwrap_or("").to_owned(), |l| l.truncate(300)).read();
    }
    for at in (0..2000).step_by(41) {
        let _ = Folder::with(same, |lines| {
            let text = lines.join("\n");
            let mut bytes = text.into_bytes();
            bytes[at] = b"x,\n-\"9"[at % 6];
            *lines = String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect();
        })
        .read();
    }
}

#[test]
fn law_roll_is_unwrapped_and_records_round_trip() {
    let folder = Folder::with(same, |lines| {
        let n = lines.len();
        for (i, line) in (2..=n).enumerate() {
            let roll = 170.0 + i as f64 * 0.05;
            set(lines, line, "Rx_deg", &(if roll > 180.0 { roll - 360.0 } else { roll }).to_string());
        }
    });
    let (campaign, _) = folder.read().expect("valid");
    let r = tunnel(&campaign, 0);
    assert!((r.attitude_rad[0][1500] - 245.0_f64.to_radians()).abs() < 1e-12);
    write_record_csv(&folder.path("again.csv"), r).expect("writable");
    let again = read_record_csv(&folder.path("again.csv")).expect("valid");
    assert_eq!(again.position_m, r.position_m);
    assert_eq!(again.t_s, r.t_s);
    // Degrees and back: two roundings.
    let worst =
        again.attitude_rad.iter().flatten().zip(r.attitude_rad.iter().flatten()).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(worst < 4.0 * f64::EPSILON * 5.0);
}

fn scenario_fault(from: &str, to: &str, words: &[&str]) {
    let text = bundled("sage-perturbed").expect("bundled");
    assert!(text.contains(from), "{from}");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scenario.toml");
    std::fs::write(&path, text.replacen(from, to, 1)).expect("writable");
    let message = read_scenario_file(&path).expect_err(to).to_string();
    for word in words {
        assert!(message.contains(word), "{word} not in: {message}");
    }
}

#[test]
fn law_scenario_faults_name_file_line_key_and_allowed() {
    scenario_fault("seed = 3", "sead = 3", &["scenario.toml:1", "sead", "seed"]);
    scenario_fault("seed = 3", "seed = -3", &["seed = -3", "whole number"]);
    scenario_fault("duration_s = 18.3", "duration_s = nan", &["duration_s = nan"]);
    scenario_fault("duration_s = 18.3", "duration_s = 0.0099", &["duration_s = 0.0099", "s"]);
    scenario_fault("rate_hz = 150.0", "rate = 150.0", &["rate", "unknown key", "rate_hz"]);
    scenario_fault("lag_s = 0.4", "", &["lag_s", "is missing"]);
    scenario_fault("radius_m = 3.048", "radius_m = 0.0", &["radius_m = 0.0"]);
    scenario_fault("top_x_m = -3.81", "top_x_m = 4.0", &["top_x_m", "lower net"]);
    scenario_fault("method = \"dop853\"", "method = \"rk4\"", &["rk4", "dopri5"]);
    scenario_fault("sensor_noise = true", "sensor_noise = 1", &["true or false"]);
    scenario_fault("static_pressure_pa = 101325.0", "", &["static_pressure_pa", "is missing"]);
    let with = |t: &str| format!("[effects.{t}\n\n[section]");
    scenario_fault("[section]", &with("asymetry]\nCm_0 = 0.1"), &["asymetry", "asymmetry"]);
    scenario_fault("[section]", &with("asymmetry]\nCm0 = 0.1"), &["Cm0", "Cm_0"]);
    scenario_fault("[section]", &with("asymmetry]\nCm_0 = 0.5001"), &["Cm_0 = 0.5001", "5e-1"]);
    scenario_fault("[section]", &with("damping-shape]\nbump = 3.0"), &["width_rad", "is missing"]);
    scenario_fault("[section]", &with("asymmetry]\nCm_0 = nan"), &["Cm_0 = nan"]);
    let two = "[flight.speed.constant]\nvw_m_s = 7.0\n\n[flight.speed.operator]";
    scenario_fault("[flight.speed.operator]", two, &["exactly one", "operator", "constant"]);
}

#[test]
fn law_structure_files_are_checked_and_round_trip() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("axisymmetric.toml");
    let structure = windfall_model::Structure::axisymmetric();
    windfall_scenarios::write_structure(&path, &structure).expect("writable");
    assert_eq!(read_structure(&path).expect("valid"), structure);
    let text = std::fs::read_to_string(&path).expect("just written");
    for (from, to, words) in [
        ("\"sin_alpha_T\", 1", "\"sin_alfa\", 1", ["factors", "sin_alpha_T"]),
        ("\"sin_alpha_T\", 1", "\"sin_alpha_T\", 10", ["factors", "1 to 9"]),
        ("coefficient = \"CY\"", "coefficient = \"CZ\"", ["coefficient", "CN"]),
        ("parameter = \"Cl_p\"", "parameter = \"Clp\"", ["parameter", "Cl_p"]),
        ("scale = 1.0", "scale = nan", ["scale", "finite"]),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).expect("writable");
        let message = read_structure(&path).expect_err(to).to_string();
        words.iter().for_each(|w| assert!(message.contains(w), "{w} not in: {message}"));
    }
}

#[test]
fn law_another_vehicle_is_another_file() {
    let folder = Folder::with(
        |t| {
            let start = t.find("[aero").expect("present");
            let end = t.find("[[run]]").expect("present");
            let mut text = t.to_owned();
            let aero = "[aero.capsule]\nstructure = \"capsule.toml\"\nCA_0 = 1.2\nCl_fin = 0.1\nbump = 2.0\n\n";
            text.replace_range(start..end, aero);
            text
        },
        keep,
    );
    let mut text = String::from("parameters = [\"CA_0\", \"Cl_fin\", \"bump\"]\n");
    for (c, p, f) in [
        ("CA", "CA_0", "[]"),
        ("Cl", "Cl_fin", "[[\"sin_alpha_T\", 2], { sin_clock = 5 }]"),
        ("Cm", "bump", "[{ bump = \"alpha_rad\", width_rad = 0.1 }, [\"q_alpha_dot_hat\", 1]]"),
    ] {
        let _ = write!(text, "\n[[term]]\ncoefficient = \"{c}\"\nparameter = \"{p}\"\nscale = 1.0\nfactors = {f}\n");
    }
    std::fs::write(folder.path("capsule.toml"), text).expect("writable");
    let message = folder.read().expect_err("C_A of 1.2 does not carry the weight").to_string();
    assert!(message.contains("times the weight"), "{message}");
    let lighter = std::fs::read_to_string(folder.path("campaign.toml")).expect("there").replace("CA_0 = 1.2", "CA_0 = 6.6");
    std::fs::write(folder.path("campaign.toml"), lighter).expect("writable");
    let (campaign, _) = folder.read().expect("valid");
    assert_eq!(campaign.plant.aero.structure.parameters, ["CA_0", "Cl_fin", "bump"]);
    assert_eq!(campaign.plant.aero.structure.contributions.len(), 3);
}

#[test]
fn law_windows_cut_the_run_in_its_own_time() {
    let window =
        |text: &str| Folder::with(|t| t.replace("use = \"identify\"", &format!("use = \"identify\"\nwindow_s = {text}")), keep);
    let (campaign, _) = window("[2.0, 5.0]").read().expect("valid");
    let r = tunnel(&campaign, 0);
    assert_eq!((r.len(), r.t_s[0]), (451, 2.0));
    let message = window("[20.0, 25.0]").read().expect_err("outside").to_string();
    assert!(message.contains("the file runs from 0 to 10 s"), "{message}");
    assert!(window("[2.0, 2.5]").read().is_err(), "half a second is too short");
}

#[test]
fn law_a_folder_is_told_from_a_file() {
    let folder = Folder::with(str::to_owned, keep);
    let message = read_campaign(&folder.path("")).expect_err("a folder").to_string();
    assert!(message.contains("is a folder") && message.contains("campaign.toml"), "{message}");
}
