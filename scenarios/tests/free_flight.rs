//! scenarios tests: campaigns of rigid bodies in free flight. In: files as written by hand. Out: what is read of them, and faults by line.

use std::fmt::Write as _;
use std::path::Path;
use windfall_model::frames::{Body, Rotation, Tunnel};
use windfall_model::{Acts, Data, Measured, Setting};
use windfall_scenarios::{ReadError, read_campaign, read_campaign_with_warnings};

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
[[part]]
mass_kg = 0.05
place_m = ["slide_m", 0.0, 0.2]
[[thrust]]
size_n = "thrust_n"
direction = [2.0, 0.0, 0.0]
place_m = [0.0, 0.1, 0.2]
[environment]
gravity_m_s2 = 9.8
air_density_kg_m3 = 1.2
[sensors]
position_std_m = 0.002
roll_std_deg = 0.2
pitch_yaw_std_deg = 0.3
[uncertainty.free_flight]
buoyancy_kg = 0.001
part_shift_m = [0.002, 0.0, 0.0]
[uncertainty.aero.wings]
CL = 0.1
[aero.wings]
structure = "wings.toml"
CD = 0.3
CL = 0.5
[columns.axes]
tunnel = ["z", "x", "y"]
[columns.attitude]
quaternion = ["qw", "qx", "qy", "qz"]
scalar = "first"
rotates = "body-to-world"
[[run]]
file = "flight.csv"
kind = "glide"
use = "identify"
inputs = { slide_m = 0.07, thrust_n = 0.02 }
"#;

const WINGS: &str = "parameters = [\"CD\", \"CL\"]\n\
    [[term]]\ncoefficient = \"CA\"\nparameter = \"CD\"\nscale = 1.0\nfactors = []\n\
    [[term]]\ncoefficient = \"CN\"\nparameter = \"CL\"\nscale = 1.0\nfactors = [[\"alpha_rad\", 1]]\n";

/// Level and heading 90 deg of yaw about the room's z, which points down; one row lacks its attitude, one quaternion is none.
fn flight() -> String {
    let mut text = String::from("t_s,X_m,Y_m,Z_m,qw,qx,qy,qz\n");
    let half = std::f64::consts::FRAC_PI_4;
    for i in 0..40 {
        let (w, z) = (half.cos(), half.sin());
        let q = match i {
            7 => ",,,".to_owned(),
            9 => "2.0,0,0,0".to_owned(),
            _ => format!("{w},0,0,{z}"),
        };
        let _ = writeln!(text, "{},{},{},{},{q}", 0.1 * f64::from(i), 1.0, 0.5 * f64::from(i), -1.0 + 0.01 * f64::from(i));
    }
    text
}

fn written(dir: &Path, head: &str) -> std::path::PathBuf {
    std::fs::write(dir.join("wings.toml"), WINGS).expect("writable");
    std::fs::write(dir.join("flight.csv"), flight()).expect("writable");
    let path = dir.join("campaign.toml");
    std::fs::write(&path, head).expect("writable");
    path
}

#[test]
fn exact_a_campaign_is_read_into_tunnel_axes() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let c = read_campaign(&written(dir.path(), HEAD)).expect("well-formed");
    assert_eq!((c.body(), c.measured()), (Acts::FreeFlight, Measured::Pose));
    let free = c.plant.free_flight.as_ref().expect("in free flight");
    assert_eq!(c.inputs, ["slide_m", "thrust_n"]);
    assert_eq!(free.parts[0].place_m, [Setting::Input(0), Setting::Fixed(0.0), Setting::Fixed(0.2)]);
    assert_eq!((free.thrusts[0].size_n, free.thrusts[0].direction.to_array()), (Setting::Input(1), [1.0, 0.0, 0.0]));
    // Held but for the one with a prior; values stay.
    assert_eq!((c.declared.as_slice(), c.plant.aero.values.as_slice()), ([false, true].as_slice(), [0.3, 0.5].as_slice()));
    let names: Vec<String> = c.knowledge.constants.iter().map(windfall_model::Constant::name).collect();
    assert_eq!(names, ["free_flight.buoyancy_kg", "free_flight.part_shift_m.x"]);
    let Data::Point(track) = &c.runs[0].data else { panic!("a track") };
    assert_eq!((track.t_s.len(), track.attitude.len()), (38, 38));
    let first = track.position_m.each_ref().map(|s| s.as_ref().expect("measured")[1]);
    // Tunnel X is the file's Z, Y its X, Z its Y.
    assert!(first.iter().zip([-0.99, 1.0, 0.5]).all(|(a, b)| (a - b).abs() < 1e-15), "{first:?}");
    // The nose points along the file's y, tunnel Z; body z down, tunnel X: to rounding.
    let r = Rotation::<Tunnel, Body>::from_quaternion(track.attitude[0]).matrix;
    assert!((r[(2, 0)] - 1.0).abs() < 1e-15 && (r[(0, 2)] - 1.0).abs() < 1e-15, "{r}");
}

/// Faults name what is wrong: the text after the change, and a word of the message.
#[test]
fn law_faults_are_named() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    for (old, new, word) in [
        ("\"slide_m\", 0.0", "\"slid_m\", 0.0", "run input"),
        ("direction = [2.0, 0.0, 0.0]", "direction = [0.0, 0.0, 0.0]", "no direction"),
        ("coefficient_axes = \"wind\"", "coefficient_axes = \"tunnel\"", "must be one of"),
        ("buoyancy_kg = 0.09", "buoyancy_kg = -0.09", "buoyancy_kg"),
        (
            "[columns.attitude]\nquaternion = [\"qw\", \"qx\", \"qy\", \"qz\"]\nscalar = \"first\"\nrotates = \"body-to-world\"\n",
            "",
            "attitude",
        ),
        ("[columns.axes]", "[axes]\ndown = \"+Z\"\n[columns.axes]", "[columns.axes]"),
        ("[sensors]", "[pivot]\narm_m = 0.1\ninertia_kg_m2 = 0.1\nviscous_n_m_s = 0.0\n[sensors]", "without attitude"),
        ("inertia_kg_m2 = { xx = 0.02", "inertia_kg_m2 = { xx = -0.02", "xx"),
    ] {
        assert!(HEAD.contains(old), "{old}");
        match read_campaign(&written(dir.path(), &HEAD.replacen(old, new, 1))) {
            Err(ReadError::Faults(faults)) => {
                let all = faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
                assert!(all.contains(word), "{new}: {all}");
            }
            other => panic!("{new}: {other:?}"),
        }
    }
    let without = HEAD.replace("[free_flight]", "[free_fligh]");
    assert!(read_campaign(&written(dir.path(), &without)).is_err());
    // The air's share may be in an inertia that no rigid body has.
    let heavy = HEAD.replacen("xx = 0.02", "xx = 0.03", 1);
    let (_, warnings) = read_campaign_with_warnings(&written(dir.path(), &heavy)).expect("well-formed");
    assert!(warnings.iter().any(|w| w.contains("no rigid body's")), "{warnings:?}");
}
