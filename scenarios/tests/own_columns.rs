//! scenarios: `[columns]`. In: a record written by the test in other names, units, axes, quaternions and Euler sequences. Out: the same
//! record within rounding; of a wrong table a fault that says key, value, what is allowed and what to try.
//!
//! The test turns by quaternions where the reader turns by matrices.

mod common;

use std::path::Path;
use windfall_model::{Campaign, Data, Record, Use};
use windfall_scenarios::{
    ReadError, RunLine, read_campaign_with_warnings, read_scenario_file, write_campaign_toml, write_columns_csv, write_record_csv,
};

/// Columns of a file: name and numbers.
type Table = Vec<(String, Vec<f64>)>;
type Quaternion = [f64; 4];

/// Slow waves with a roll that passes 180 deg, off the vertical: there some sequences tell two of their angles apart by nothing.
fn record() -> Record {
    let mut r = common::waves();
    r.attitude_rad[1].iter_mut().for_each(|x| *x += 0.1);
    r.attitude_rad[2].iter_mut().for_each(|x| *x += 0.3);
    r.attitude_rad[0] = r.t_s.iter().map(|t| 3.0 + 0.3 * t).collect();
    r.qw_pa = Some(r.vw_m_s.iter().map(|v| 0.5 * 101_325.0 / (287.052_87 * 299.0) * v * v).collect());
    r
}

fn product([a, b, c, d]: Quaternion, [w, x, y, z]: Quaternion) -> Quaternion {
    [a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w]
}

fn about(axis: usize, angle: f64) -> Quaternion {
    let mut q = [(0.5 * angle).cos(), 0.0, 0.0, 0.0];
    q[axis + 1] = (0.5 * angle).sin();
    q
}

fn inverse([w, x, y, z]: Quaternion) -> Quaternion {
    [w, -x, -y, -z]
}

/// Attitude of each sample, body to tunnel.
fn attitudes(r: &Record) -> Vec<Quaternion> {
    let [x, y, z] = &r.attitude_rad;
    (0..r.len()).map(|i| product(product(about(0, x[i]), about(1, y[i])), about(2, z[i]))).collect()
}

/// Columns of the rotation's matrix: where it takes the three axes.
fn matrix(q: Quaternion) -> [[f64; 3]; 3] {
    let column = |k: usize| {
        let mut v = [0.0; 4];
        v[k + 1] = 1.0;
        product(product(q, v), inverse(q))
    };
    let columns = [column(0), column(1), column(2)];
    std::array::from_fn(|i| std::array::from_fn(|k| columns[k][i + 1]))
}

/// Angles of a sequence whose product is the matrix (Diebel 2006, "Representing Attitude", section 8).
fn euler(m: &[[f64; 3]; 3], [i, j, k]: [usize; 3]) -> [f64; 3] {
    let other = 3 - i - j;
    let e = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
    if i == k {
        let b = m[i][j].hypot(m[i][other]).atan2(m[i][i]);
        [m[j][i].atan2(-e * m[other][i]), b, m[i][j].atan2(e * m[i][other])]
    } else {
        let b = (e * m[i][k]).atan2(m[i][i].hypot(m[i][j]));
        [(-e * m[j][k]).atan2(m[k][k]), b, (-e * m[i][j]).atan2(m[i][i])]
    }
}

/// The record as the program itself names it.
fn ours(r: &Record) -> Table {
    let degrees = |k: usize| r.attitude_rad[k].iter().map(|x| x.to_degrees()).collect::<Vec<f64>>();
    let mut all = vec![("t_s".to_owned(), r.t_s.clone())];
    all.extend(["X_m", "Y_m", "Z_m"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), r.position_m[k].clone())));
    all.extend(["Rx_deg", "Ry_deg", "Rz_deg"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), degrees(k))));
    all.extend([
        ("VW_m_s".to_owned(), r.vw_m_s.clone()),
        ("ps_Pa".to_owned(), r.ps_pa.clone()),
        ("Ts_K".to_owned(), r.ts_k.clone()),
    ]);
    all.push(("qW_Pa".to_owned(), r.qw_pa.clone().expect("the record has it")));
    all
}

/// Renames a column and changes its numbers.
fn change(table: &mut Table, from: &str, to: &str, f: impl Fn(f64) -> f64) {
    let (name, column) = table.iter_mut().find(|(n, _)| n == from).expect("a column");
    *name = to.to_owned();
    column.iter_mut().for_each(|x| *x = f(*x));
}

fn drop_columns(table: &mut Table, names: &[&str]) {
    table.retain(|(n, _)| !names.contains(&n.as_str()));
}

/// A campaign in a folder, its one run the table, with text put before the run and after it.
fn read(table: &Table, columns: &str, of_run: &str) -> Result<(Campaign, Vec<String>), ReadError> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(&scenario, windfall_scenarios::bundled("sage-perturbed").expect("bundled")).expect("writable");
    let views: Vec<(&str, &[f64])> = table.iter().map(|(n, c)| (n.as_str(), c.as_slice())).collect();
    write_columns_csv(&folder.path().join("a.csv"), &views).expect("writable");
    campaign_file(folder.path(), columns, of_run);
    read_campaign_with_warnings(&folder.path().join("campaign.toml"))
}

fn campaign_file(folder: &Path, columns: &str, of_run: &str) {
    let file = read_scenario_file(&folder.join("scenario.toml")).expect("bundled");
    let path = folder.join("campaign.toml");
    let line = RunLine { file: "a.csv".to_owned(), kind: "perturbed".to_owned(), used: Use::Identify, window_s: None };
    write_campaign_toml(&path, &file, &[line]).expect("writable");
    let text = std::fs::read_to_string(&path).expect("just written").replacen("[[run]]", &format!("{columns}\n[[run]]"), 1);
    std::fs::write(&path, format!("{text}\n{of_run}\n")).expect("writable");
}

fn series(r: &Record) -> [&Vec<f64>; 11] {
    let ([x, y, z], [a, b, c]) = (&r.position_m, &r.attitude_rad);
    [&r.t_s, x, y, z, a, b, c, &r.vw_m_s, &r.ps_pa, &r.ts_k, r.qw_pa.as_ref().expect("the record has it")]
}

/// Each number within 1e-12 of itself, or of one where it is smaller: some ten roundings of 1.1e-16 of angles up to 180 deg. Roll may
/// come back a whole turn away.
fn is_same(table: &Table, columns: &str) -> Vec<String> {
    let (campaign, warnings) = read(table, columns, "").unwrap_or_else(|e| panic!("{columns}\n{e}"));
    let Data::Tunnel(found) = &campaign.runs[0].data else { panic!("a tunnel run") };
    let truth = record();
    let turn = std::f64::consts::TAU * ((found.attitude_rad[0][0] - truth.attitude_rad[0][0]) / std::f64::consts::TAU).round();
    assert_eq!(found.len(), truth.len(), "{warnings:?}\n{columns}");
    for (k, (a, b)) in series(found).into_iter().zip(series(&truth)).enumerate() {
        let shift = if k == 4 { turn } else { 0.0 };
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            assert!((a - shift - b).abs() < 1e-12 * b.abs().max(1.0), "channel {k}, sample {i}: {a} {b}\n{columns}");
        }
    }
    warnings
}

#[test]
fn exact_names_and_units() {
    let mut t = ours(&record());
    change(&mut t, "t_s", "time", |x| 1e3 * x);
    change(&mut t, "X_m", "pos.x", |x| x / 0.3048);
    change(&mut t, "Y_m", "pos y", |x| 1e3 * x);
    change(&mut t, "Rx_deg", "roll", f64::to_radians);
    change(&mut t, "VW_m_s", "V", |x| x / 0.514_444_444_444_444_4);
    change(&mut t, "ps_Pa", "p", |x| 1e-3 * x);
    change(&mut t, "Ts_K", "Ts_K", |x| 1.8 * x - 459.67);
    change(&mut t, "qW_Pa", "q", |x| x / 47.880_258_980_335_84);
    let columns = r#"[columns]
t_s = { name = "time", unit = "ms" }
X_m = { name = "pos.x", unit = "ft" }
Y_m = { name = "pos y", unit = "mm" }
Rx_deg = { name = "roll", unit = "rad" }
VW_m_s = { name = "V", unit = "kn" }
ps_Pa = { name = "p", unit = "kPa" }
Ts_K = { unit = "degF" }
qW_Pa = { name = "q", unit = "psf" }
"#;
    assert_eq!(is_same(&t, columns), Vec::<String>::new());
}

/// A run's own table stands in place of the campaign's; a constant fills a column that the file does not have.
#[test]
fn exact_constants_and_tables_of_one_run() {
    let mut t = ours(&record());
    drop_columns(&mut t, &["Ts_K", "ps_Pa"]);
    assert_eq!(is_same(&t, "[columns]\nTs_K = 299.0\nps_Pa = 101325\n"), Vec::<String>::new());
    change(&mut t, "X_m", "down", |x| x);
    let own = "[run.columns]\nTs_K = 299.0\nps_Pa = 101325.0\nX_m = \"down\"";
    let (campaign, _) = read(&t, "[columns]\nX_m = \"nowhere\"\n", own).expect("the run's table holds");
    let Data::Tunnel(r) = &campaign.runs[0].data else { panic!("a tunnel run") };
    assert_eq!(r.position_m[0], record().position_m[0]);
}

/// The owner's room has z up, his body x forward along the nose, y to the left, z up.
const AXES: &str = "[columns.axes]\ntunnel = [\"-z\", \"x\", \"-y\"]\nbody = [\"x\", \"-y\", \"-z\"]\n";

/// Our attitude as the owner's: his room from ours, times ours, times our body from his; both turns as quaternions.
fn theirs(r: &Record) -> (Vec<[f64; 3]>, Vec<Quaternion>) {
    // Ours X = -z, Y = x, Z = -y, so his x = Y, y = -Z, z = -X: a third of a turn about (-1, -1, 1) of ours, checked here.
    let position: Vec<[f64; 3]> = (0..r.len()).map(|i| [r.position_m[1][i], -r.position_m[2][i], -r.position_m[0][i]]).collect();
    let room = [0.5, -0.5, -0.5, 0.5];
    let room = [room, inverse(room)].into_iter().find(|q| room_of(*q)).expect("one of both turns is it");
    // His body is ours turned by half a turn about x.
    let body = about(0, std::f64::consts::PI);
    (position, attitudes(r).into_iter().map(|q| product(product(room, q), body)).collect())
}

/// Whether a rotation takes components (X, Y, Z) to (Y, -Z, -X).
fn room_of(q: Quaternion) -> bool {
    let expected = [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]];
    matrix(q).iter().flatten().zip(expected.iter().flatten()).all(|(a, b): (&f64, &f64)| (a - b).abs() < 1e-12)
}

/// The table with the owner's positions and without angles.
fn with_positions(r: &Record, position: &[[f64; 3]]) -> Table {
    let mut t = ours(r);
    drop_columns(&mut t, &["X_m", "Y_m", "Z_m", "Rx_deg", "Ry_deg", "Rz_deg"]);
    t.extend(["px", "py", "pz"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), position.iter().map(|p| p[k]).collect())));
    t
}

const POSITIONS: &str = "[columns]\nX_m = \"px\"\nY_m = \"py\"\nZ_m = \"pz\"\n";

#[test]
fn exact_quaternions_of_both_orders_and_directions() {
    let r = record();
    let (position, attitude) = theirs(&r);
    for (names, scalar) in [(["w", "i", "j", "k"], "first"), (["i", "j", "k", "w"], "last")] {
        for rotates in ["body-to-world", "world-to-body"] {
            let mut t = with_positions(&r, &position);
            // Of either sign and not quite of length one, as trackers write them.
            let q: Vec<Quaternion> = attitude
                .iter()
                .enumerate()
                .map(|(i, q)| {
                    if rotates == "body-to-world" { *q } else { inverse(*q) }.map(|x| if i % 2 == 0 { x } else { -1.001 * x })
                })
                .collect();
            t.extend(["w", "i", "j", "k"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), q.iter().map(|q| q[k]).collect())));
            let attitude =
                format!("[columns.attitude]\nquaternion = {names:?}\nscalar = \"{scalar}\"\nrotates = \"{rotates}\"\n");
            assert_eq!(is_same(&t, &format!("{POSITIONS}{AXES}{attitude}")), Vec::<String>::new());
        }
    }
}

#[test]
fn exact_all_twelve_sequences() {
    let r = record();
    let (position, attitude) = theirs(&r);
    for sequence in ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"] {
        let axes: Vec<usize> = sequence.bytes().map(|b| usize::from(b - b'x')).collect();
        for (unit, rotates) in [("deg", "body-to-world"), ("rad", "world-to-body")] {
            let mut t = with_positions(&r, &position);
            let of = |q: &Quaternion| {
                let q = if rotates == "body-to-world" { *q } else { inverse(*q) };
                euler(&matrix(q), [axes[0], axes[1], axes[2]]).map(|x| if unit == "deg" { x.to_degrees() } else { x })
            };
            let angles: Vec<[f64; 3]> = attitude.iter().map(of).collect();
            t.extend(["a", "b", "c"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), angles.iter().map(|q| q[k]).collect())));
            let attitude = format!(
                "[columns.attitude]\neuler = [\"a\", \"b\", \"c\"]\nsequence = \"{sequence}\"\nunit = \"{unit}\"\nrotates = \"{rotates}\"\n"
            );
            is_same(&t, &format!("{POSITIONS}{AXES}{attitude}"));
        }
    }
}

/// Axes alone: angles are of our own sequence, about the owner's axes.
#[test]
fn exact_axes_turn_our_own_sequence() {
    let r = record();
    let (position, attitude) = theirs(&r);
    let mut t = with_positions(&r, &position);
    let angles: Vec<[f64; 3]> = attitude.iter().map(|q| euler(&matrix(*q), [0, 1, 2]).map(f64::to_degrees)).collect();
    t.extend(
        ["Rx_deg", "Ry_deg", "Rz_deg"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), angles.iter().map(|q| q[k]).collect())),
    );
    is_same(&t, &format!("{POSITIONS}{AXES}"));
}

/// A dropout in one part of a quaternion is one of the whole attitude; many of another length are no quaternions.
#[test]
fn law_quaternions_are_of_length_one() {
    let r = record();
    let (position, attitude) = theirs(&r);
    let mut t = with_positions(&r, &position);
    t.extend(["w", "i", "j", "k"].iter().enumerate().map(|(k, n)| ((*n).to_owned(), attitude.iter().map(|q| q[k]).collect())));
    let columns = format!(
        "{POSITIONS}{AXES}[columns.attitude]\nquaternion = [\"w\", \"i\", \"j\", \"k\"]\nscalar = \"first\"\nrotates = \"body-to-world\"\n"
    );
    change(&mut t, "j", "j", |x| x);
    t.last_mut().expect("columns").1[200] += 0.5;
    let (_, warnings) = read(&t, &columns, "").expect("one is a dropout");
    assert!(warnings.iter().any(|w| w.contains("1 quaternions of another length")), "{warnings:?}");
    change(&mut t, "w", "w", |x| 2.0 * x);
    let message = read(&t, &columns, "").expect_err("all are too long").to_string();
    assert!(message.contains("unit quaternion") && message.contains("w, i, j, k"), "{message}");
}

/// The message of a wrong table has all these words.
fn refused(columns: &str, words: &[&str]) {
    let message = read(&ours(&record()), columns, "").expect_err(columns).to_string();
    words.iter().for_each(|w| assert!(message.contains(w), "{w} not in: {message}"));
}

#[test]
fn law_wrong_tables_say_what_is_allowed() {
    refused("[columns]\nx_m = \"a\"", &["campaign.toml:", "x_m", "unknown key", "X_m"]);
    refused("[columns]\nX_m = \"px\"", &["a.csv", "X_m = px", "the file has t_s", "one of these names"]);
    refused("[columns]\nX_m = { name = \"X_mm\" }", &["X_m = X_mm", "try: \"X_m\""]);
    refused("[columns]\nX_m = { unit = \"furlong\" }", &["furlong", "m, mm, cm", "try:"]);
    refused("[columns]\nps_Pa = { unit = \"kpa\" }", &["must be one of Pa, hPa", "try: kPa"]);
    refused("[columns]\nX_m = { naem = \"x\" }", &["naem", "unknown key", "name"]);
    refused("[columns]\nX_m = true", &["must be a name, a number or"]);
    refused("[columns]\nX_m = 1.0", &["only VW_m_s, ps_Pa, Ts_K"]);
    refused("[columns]\nTs_K = nan", &["Ts_K", "finite"]);
    refused("[columns]\nX_m = \"Z_m\"", &["is the name of another column", "Z_m = "]);
    refused("[columns]\nX_m = \"Y_m\"\nY_m = \"Y_m\"", &["read for two axes"]);
    refused("[columns.axes]\ntunnel = [\"z\", \"x\"]", &["tunnel = z, x", "each letter once", "try:"]);
    refused("[columns.axes]\ntunnel = [\"z\", \"x\", \"-x\"]", &["each letter once"]);
    refused("[columns.axes]\ntunnel = [\"-z\", \"x\", \"y\"]", &["left-handed", "sign of one axis"]);
    refused("[columns.attitude]\nrotates = \"body-to-world\"", &["exactly one of quaternion and euler"]);
    refused(
        "[columns.attitude]\nquaternion = [\"a\", \"b\"]\nscalar = \"last\"",
        &["4 different columns", "rotates", "is missing"],
    );
    let angles = "[columns.attitude]\nrotates = \"body-to-world\"\neuler = [\"Rx_deg\", \"Ry_deg\", \"Rz_deg\"]\n";
    refused(angles, &["sequence", "is missing; euler needs it", "unit"]);
    refused(&format!("{angles}unit = \"deg\"\nsequence = \"zyy\""), &["zyy", "\"zyx\""]);
    refused(&format!("{angles}unit = \"deg\"\nsequence = \"zyx\"\nscalar = \"last\""), &["scalar", "no part beside euler"]);
    refused(&format!("[columns]\nRx_deg = \"Rx_deg\"\n{angles}unit = \"deg\"\nsequence = \"xyz\""), &["stands beside"]);
}

/// A row of units in the file that says another unit than the column is read in is no matter of taste.
#[test]
fn law_units_in_the_file_must_agree() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(&scenario, windfall_scenarios::bundled("sage-perturbed").expect("bundled")).expect("writable");
    let path = folder.path().join("a.csv");
    write_record_csv(&path, &record()).expect("writable");
    let text = std::fs::read_to_string(&path).expect("just written");
    let with = |units: &str| text.replacen('\n', &format!("\n{units}\n"), 1);
    let campaign = folder.path().join("campaign.toml");
    campaign_file(folder.path(), "", "");
    std::fs::write(&path, with("s,[m],m,m,deg,deg,deg,Pa,Pa,m/s,K")).expect("writable");
    let (_, warnings) = read_campaign_with_warnings(&campaign).expect("the units agree");
    assert!(warnings.iter().any(|w| w.contains("row of units")), "{warnings:?}");
    std::fs::write(&path, with("s,[mm],m,m,deg,deg,deg,Pa,Pa,m/s,K")).expect("writable");
    let message = read_campaign_with_warnings(&campaign).expect_err("millimetres").to_string();
    assert!(message.contains("X_m = mm") && message.contains("unit = \"mm\""), "{message}");
    campaign_file(folder.path(), "[columns]\nX_m = { unit = \"mm\" }\n", "");
    assert!(read_campaign_with_warnings(&campaign).is_ok(), "now they agree");
}

const BALL: &str = r#"[campaign]
name = "ball"
[vehicle]
mass_kg = 2.3
reference_diameter_m = 0.2
[axes]
down = "-Z"
[environment]
gravity_m_s2 = 9.80665
air_density_kg_m3 = 1.19
[sensors]
position_std_m = 0.01
[aero.point_mass]
CD = 0.3
[columns]
t_s = { name = "ms", unit = "ms" }
Z_m = { name = "height", unit = "cm" }
[[run]]
file = "drop.csv"
kind = "drop"
use = "identify"
"#;

/// Tracks of a point mass have names and units of their own as well; axes are said by `[axes]`.
#[test]
fn exact_tracks_have_names_and_units() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let t: Vec<f64> = (0..20).map(|i| 50.0 * f64::from(i)).collect();
    let height: Vec<f64> = t.iter().map(|t| 500.0 - 490.0 * (1e-3 * t).powi(2)).collect();
    write_columns_csv(&folder.path().join("drop.csv"), &[("ms", &t), ("height", &height)]).expect("writable");
    let path = folder.path().join("campaign.toml");
    std::fs::write(&path, BALL).expect("writable");
    let (campaign, _) = read_campaign_with_warnings(&path).expect("valid");
    let Data::Point(track) = &campaign.runs[0].data else { panic!("a track") };
    let down = track.position_m[0].as_ref().expect("the file has heights");
    assert!(down.iter().zip(&height).all(|(x, h)| (x + 0.01 * h).abs() < 1e-14));
    assert!(track.t_s.iter().zip(&t).all(|(a, b)| (a - 1e-3 * b).abs() < 1e-15));
    std::fs::write(&path, BALL.replace("[[run]]", "[columns.axes]\ntunnel = [\"-z\", \"x\", \"-y\"]\n[[run]]"))
        .expect("writable");
    let message = read_campaign_with_warnings(&path).expect_err("axes").to_string();
    assert!(message.contains("[columns] axes") && message.contains("[axes] down"), "{message}");
}
