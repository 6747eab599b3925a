//! scenarios tests: exports of motion-capture programs. In: a small export of each, and the same numbers as a plain table. Out: the same
//! record, bit by bit.

use std::path::{Path, PathBuf};
use windfall_model::{Campaign, Data, PointRecord};
use windfall_scenarios::{ReadError, read_campaign_with_warnings};

const HEAD: &str = r#"[campaign]
name = "glider"
[vehicle]
mass_kg = 0.1
center_of_mass_m = [0.0, 0.0, 0.01]
reference_diameter_m = 1.0
inertia_kg_m2 = { xx = 0.02, yy = 0.015, zz = 0.01, xy = 0.0, xz = 0.0, yz = 0.0 }
[free_flight]
reference_area_m2 = 0.25
coefficient_axes = "wind"
coefficients = "held"
buoyancy_kg = 0.09
center_of_buoyancy_m = [0.0, 0.0, 0.0]
rate_damping_n_m_s = [-0.05, -0.03, -0.01]
[environment]
gravity_m_s2 = 9.8
air_density_kg_m3 = 1.2
[sensors]
position_std_m = 0.002
roll_std_deg = 0.2
pitch_yaw_std_deg = 0.3
[aero.wings]
structure = "wings.toml"
CD = 0.3
CL = 0.5
[columns.axes]
tunnel = ["-z", "x", "-y"]
body = ["x", "-y", "-z"]
"#;

const WINGS: &str = "parameters = [\"CD\", \"CL\"]\n\
    [[term]]\ncoefficient = \"CA\"\nparameter = \"CD\"\nscale = 1.0\nfactors = []\n\
    [[term]]\ncoefficient = \"CN\"\nparameter = \"CL\"\nscale = 1.0\nfactors = [[\"alpha_rad\", 1]]\n";

const VICON: &str = r#"[columns.attitude]
euler = ["RX", "RY", "RZ"]
sequence = "xyz"
unit = "deg"
rotates = "body-to-world"
[columns]
t_s = "t"
X_m = { name = "TX", unit = "mm" }
Y_m = { name = "TY", unit = "mm" }
Z_m = { name = "TZ", unit = "mm" }
"#;

const MOTIVE: &str = r#"[columns.attitude]
quaternion = ["qx", "qy", "qz", "qw"]
scalar = "last"
rotates = "body-to-world"
[columns]
t_s = "t"
X_m = { name = "X", unit = "mm" }
Y_m = { name = "Y", unit = "mm" }
Z_m = { name = "Z", unit = "mm" }
"#;

const QUALISYS: &str = r#"[columns.attitude]
euler = ["glider Roll", "glider Pitch", "glider Yaw"]
sequence = "xyz"
unit = "deg"
rotates = "body-to-world"
[columns]
t_s = "t"
X_m = { name = "glider X", unit = "mm" }
Y_m = { name = "glider Y", unit = "mm" }
Z_m = { name = "glider Z", unit = "mm" }
"#;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/motion_capture").join(name)
}

/// A campaign whose one run is that text.
fn read(file: &str, text: &str, columns: &str) -> Result<(Campaign, Vec<String>), ReadError> {
    let dir = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(dir.path().join("wings.toml"), WINGS).expect("writable");
    std::fs::write(dir.path().join(file), text).expect("writable");
    let run = format!("[[run]]\nfile = \"{file}\"\nkind = \"glide\"\nuse = \"identify\"\n");
    let path = dir.path().join("campaign.toml");
    std::fs::write(&path, format!("{HEAD}{columns}{run}")).expect("writable");
    read_campaign_with_warnings(&path)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(fixture(name)).expect("a fixture")
}

fn record(file: &str, columns: &str) -> (PointRecord, Vec<String>) {
    let (c, warnings) = read(file, &text(file), columns).unwrap_or_else(|e| panic!("{file}: {e}"));
    let Data::Point(r) = &c.runs[0].data else { panic!("a track with attitude") };
    let notes = c.runs[0].notes.clone();
    (r.clone(), warnings.into_iter().chain(notes).collect())
}

fn bits(r: &PointRecord) -> Vec<u64> {
    let positions = r.position_m.iter().flatten().flatten();
    r.t_s.iter().chain(positions).chain(r.attitude.iter().flatten()).map(|x| x.to_bits()).collect()
}

/// Frames, numbers and units come out as those of the plain table with the same `[columns]`; the frame that was not seen is none in both.
#[test]
fn exact_exports_are_the_plain_table_bit_by_bit() {
    for (file, columns) in [("vicon.csv", VICON), ("motive.csv", MOTIVE), ("qualisys.tsv", QUALISYS)] {
        let (found, notes) = record(file, columns);
        let (expected, _) = record("plain.csv", columns);
        assert_eq!(found.t_s.len(), expected.t_s.len(), "{file}: {notes:?}");
        assert_eq!(bits(&found), bits(&expected), "{file}");
        assert!(found.t_s.len() >= 23 && found.attitude.len() == found.t_s.len(), "{file}");
        assert!(notes.iter().any(|n| n.contains("export of ")), "{file}: {notes:?}");
    }
}

/// The units that an export says are held against those that the columns are read in.
#[test]
fn law_a_wrong_unit_of_an_export_is_refused() {
    for (file, columns) in [("vicon.csv", VICON), ("motive.csv", MOTIVE), ("qualisys.tsv", QUALISYS)] {
        let wrong = columns.replace("unit = \"mm\"", "unit = \"cm\"");
        let message = read(file, &text(file), &wrong).expect_err("millimetres").to_string();
        assert!(message.contains("mm") && message.contains("cm"), "{file}: {message}");
    }
}

#[test]
fn law_damaged_exports_say_what_is_wrong() {
    let cases = [
        ("vicon.csv", VICON, "Segments", "Devices", "\n\n", "Objects, Segments or Trajectories"),
        ("vicon.csv", VICON, "Frame,Sub Frame,RX", "RX,RY,RX", "", "Frame, Sub Frame"),
        ("motive.csv", MOTIVE, "Frame,Time (Seconds)", "a,b", "", "Frame, Time (Seconds)"),
        ("qualisys.tsv", QUALISYS, "glider X\tY\tZ", "a\tb\tc", "wall X\tY\tZ", "row of names"),
        ("qualisys.tsv", QUALISYS, "0.010000", "soon", "", "soon"),
    ];
    for (file, columns, from, to, also, expected) in cases {
        let mut damaged = text(file).replacen(from, to, 1);
        if file == "vicon.csv" && to == "Devices" {
            damaged = damaged.replace("Trajectories", "Joints");
        } else if !also.is_empty() {
            damaged = damaged.replacen(also, "d\te\tf", 1);
        }
        let message = read(file, &damaged, columns).expect_err(expected).to_string();
        assert!(message.contains(expected), "{file}: {message}");
    }
}
